// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/plant.hpp"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include "tuina/robot/description.hpp"
#include "tuina/sim/robot/plant_world.hpp"

namespace tuina::sim {
namespace {

constexpr double windup_damping_ratio = 0.2;  // rotor on the spring of its gear

// MuJoCo's own handler writes a log file; the plant reads the counters instead.
void keep_quiet(const char*) {}

Result<ModelPointer> load(const std::string& mjcf) {
  mju_user_warning = keep_quiet;
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* name = "tuina.xml";
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(mjcf.size())) != 0) {
    return fail(Fault::device, "MuJoCo has no memory for a description of {} bytes", mjcf.size());
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], mjcf.data(), mjcf.size());
  char error[400] = "";
  ModelPointer model(mj_loadXML(name, files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) return fail(Fault::device, "MuJoCo refuses the robot: {}", error);
  return model;
}

/// Drives and gears of an arm by its table, and where MuJoCo has its joints and tool.
ArmDevices devices_of(const mjModel& model, Arm side, const robot::ArmTable& table,
                      double friction_windup_rad) {
  ArmDevices arm;
  arm.joints = table.joints;
  arm.site = mj_name2id(&model, mjOBJ_SITE, fmt::format("{}_tool", name_of(side)).c_str());
  arm.tool_body = model.site_bodyid[arm.site];
  arm.tool_mass_kg = table.tool_mass_kg;
  for (int i = 0; i < table.joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const robot::Link& link = table.links[k];
    const int joint =
        mj_name2id(&model, mjOBJ_JOINT, fmt::format("{}_{}", name_of(side), link.name).c_str());
    arm.dof[k] = model.jnt_dofadr[joint];
    arm.torque_limit_nm[k] = link.torque_limit_nm;
    arm.coulomb_nm[k] = link.coulomb_nm;
    arm.viscous[k] = link.viscous_nm_s_per_rad;
    arm.windup_damping[k] =
        2.0 * windup_damping_ratio *
        std::sqrt(link.coulomb_nm / friction_windup_rad * link.rotor_inertia_kg_m2);
  }
  return arm;
}

}  // namespace

void FreeModel::operator()(mjModel_* model) const {
  mj_deleteModel(model);
}
void FreeData::operator()(mjData_* data) const {
  mj_deleteData(data);
}

robot::ArmTable draw_arm(const robot::ArmTable& believed, const TableErrors& errors,
                         Random& random) {
  robot::ArmTable arm = believed;
  const auto near_one = [&random](double spread) { return 1.0 + uniform(random, -spread, spread); };
  for (int i = 0; i < arm.joints; ++i) {
    robot::Link& link = arm.links[static_cast<std::size_t>(i)];
    const double mass = errors.mass_scale * near_one(errors.mass_spread);
    link.mass_kg *= mass;
    for (double& inertia : link.inertia_kg_m2) inertia *= mass;
    for (double& product : link.inertia_products_kg_m2) product *= mass;
    link.rotor_inertia_kg_m2 *= near_one(errors.rotor_spread);
    const double friction = errors.friction_scale * near_one(errors.friction_spread);
    link.coulomb_nm *= friction;
    link.viscous_nm_s_per_rad *= friction;
  }
  if (errors.tool_mass_share > 0.0)
    arm.tool_mass_kg *=
        1.0 + (uniform(random, -1.0, 1.0) < 0.0 ? -1.0 : 1.0) * errors.tool_mass_share;
  return arm;
}

Result<std::unique_ptr<Plant>> Plant::make(const robot::RobotMount& mount,
                                           const PerArm<robot::ArmTable>& arms, const Start& start,
                                           BackContact* person, const PlantOptions& options) {
  return make(robot::RobotPlacement{.arm = arms[Arm::left], .mount = mount}, arms, start, person,
              options);
}

Result<std::unique_ptr<Plant>> Plant::make(const robot::RobotPlacement& placement,
                                           const PerArm<robot::ArmTable>& arms, const Start& start,
                                           BackContact* person, const PlantOptions& options) {
  const robot::WholeRobot whole = robot::whole_of(placement, arms);
  auto world = std::make_unique<World>();
  world->options = options;
  world->substeps = std::max(1, static_cast<int>(std::lround(options.physics_hz * tick_s)));
  world->step_s = tick_s / world->substeps;
  auto model = load(robot::to_mjcf(whole.description, world->step_s));
  if (!model) return tl::unexpected(model.error());
  world->model = std::move(*model);
  world->data.reset(mj_makeData(world->model.get()));
  if (!world->data) return fail(Fault::device, "MuJoCo has no memory for the robot");
  mjModel* m = world->model.get();
  mjData* d = world->data.get();
  // Friction is modelled in plant_devices.cpp: MuJoCo's constraint would cost more than the rest of
  // the arm.
  std::fill_n(m->dof_frictionloss, m->nv, 0.0);
  std::fill_n(m->dof_damping, m->nv, 0.0);

  world->couch_from_base = placement.mount.base_from_couch.inverse();
  world->person = person;
  world->noise = make_random(options.seed, "robot sensors");
  world->rail_wanted_m = world->rail_now_m = start.rail_m;
  std::set<int> of_arms;
  for (const Arm side : both_arms) {
    ArmDevices& arm = world->arms[side];
    const robot::ArmTable& table = arms[side];
    if (start.q_rad[side].size() != table.joints) {
      return fail(Fault::usage, "the {} arm has {} joints, its start {}", name_of(side),
                  table.joints, start.q_rad[side].size());
    }
    arm = devices_of(*m, side, table, options.friction_windup_rad);
    for (int i = 0; i < table.joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      of_arms.insert(arm.dof[k]);
      d->qpos[arm.dof[k]] = arm.encoder_rad[k] = start.q_rad[side][i];
    }
  }
  for (std::size_t i = 0; i < whole.q.size(); ++i) {
    const robot::Part& part = whole.description.parts[i];
    if (part.motion == robot::Part::Motion::fixed) continue;
    world->moving_kg += part.mass_kg;
    const int dof = m->jnt_dofadr[mj_name2id(m, mjOBJ_JOINT, part.name.c_str())];
    if (of_arms.contains(dof)) continue;
    d->qpos[dof] = whole.q[i];
    if (part.name == whole.rail) {
      world->rail_dof = dof;
      d->qpos[dof] = start.rail_m;
    } else {
      world->held.push_back({dof, whole.q[i], part.effort_limit});
    }
  }
  mj_forward(m, d);
  Random gears = make_random(options.seed, "gears");
  Random wrist_errors = make_random(options.seed, "wrist sensors");
  for (const Arm side : both_arms) {
    ArmDevices& arm = world->arms[side];
    world->soften_gears(arm, arms[side], gears);
    // The sensor starts in steady state under the tool's weight.
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d->site_xmat +
                                                                              9 * arm.site);
    arm.felt.head<3>() = turn.transpose() * Vector3(0, 0, -gravity_m_per_s2 * arm.tool_mass_kg);
    arm.sampled = arm.felt;
    world->spoil_wrist(arm, wrist_errors);
    world->read_encoders(arm);
    arm.velocity_rad_per_s = {};
    if (world->person != nullptr) world->touch(side);
  }
  world->spoil_currents();
  world->sample_truth();
  return std::unique_ptr<Plant>(new Plant(std::move(world)));
}

Plant::Plant(std::unique_ptr<World> world) : world_(std::move(world)) {}
Plant::~Plant() = default;
const char* Plant::fault() const noexcept {
  return world_->broken;
}
void Plant::push(Arm arm, const Wrench& hand_in_base) noexcept {
  world_->hands[arm] = hand_in_base;
}
void Plant::cut_power(Arm arm) noexcept {
  world_->arms[arm].powered = false;
}
const PlantTruth& Plant::truth() const noexcept {
  return world_->truth;
}

void Plant::apply(const robot::RobotCommand& command) noexcept {
  World& world = *world_;
  world.unanswered = 0;
  const double levels = std::ldexp(1.0, world.options.dac_bits - 1);
  for (const Arm side : both_arms) {
    ArmDevices& arm = world.arms[side];
    arm.brake_wanted = command.brake[side];
    const JointVector& wanted = command.torque_nm[side];
    for (int i = 0; i < arm.joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      arm.gravity_nm[k] = world.data->qfrc_bias[arm.dof[k]];
      if (i >= wanted.size() || !std::isfinite(wanted[i])) {
        if (world.broken == nullptr) world.broken = "a torque command was not a number";
        arm.torque_nm[k] = 0.0;
        continue;
      }
      const double limit = arm.torque_limit_nm[k];
      const double level =
          std::clamp(std::round(wanted[i] / limit * levels), -levels, levels - 1.0);
      arm.torque_nm[k] = level * limit / levels;
    }
  }
  if (std::isfinite(command.rail_m)) {
    const mjtNum* range = world.model->jnt_range + 2 * world.model->dof_jntid[world.rail_dof];
    world.rail_wanted_m = std::clamp(command.rail_m, range[0], range[1]);
  }
}

std::optional<robot::RobotReading> Plant::read() noexcept {
  World& world = *world_;
  if (world.started) {
    for (ArmDevices& arm : world.arms.of) world.choose_drive(arm);
    ++world.unanswered;
    for (int i = 0; i < world.substeps; ++i) world.step();
    ++world.tick;
    for (const Arm side : both_arms) world.read_encoders(world.arms[side]);
    world.sample_truth();
    world.check_physics();
  }
  robot::RobotReading reading;
  reading.time_s = world.truth.time_s;
  reading.tick = world.tick;
  reading.rail_m = world.truth.rail_m;
  for (const Arm side : both_arms) {
    ArmDevices& arm = world.arms[side];
    robot::ArmReading& seen = reading.arms[side];
    seen.q_rad = Eigen::Map<const Eigen::VectorXd>(arm.encoder_rad.data(), arm.joints);
    seen.dq_rad_per_s =
        Eigen::Map<const Eigen::VectorXd>(arm.velocity_rad_per_s.data(), arm.joints);
    seen.wrench_in_tool = world.sample_wrist(arm);
    seen.wrench_time_s = reading.time_s - tick_s;
    seen.measured_torque_nm = world.measure_currents(arm);
  }
  world.started = true;
  return reading;
}

void Plant::World::step() noexcept {
  mjModel* m = model.get();
  mjData* d = data.get();
  mj_step1(m, d);  // present positions and velocities
  mju_zero(d->qfrc_applied, m->nv);
  for (const Arm side : both_arms) {
    drive(arms[side]);
    touch(side);
  }
  drive_rail();
  for (const Held& joint : held) hold(joint);
  mj_step2(m, d);
}

void Plant::World::sample_truth() noexcept {
  // After the last substep the kinematics are a quarter of a millisecond old, so they are updated.
  mj_kinematics(model.get(), data.get());
  mj_comPos(model.get(), data.get());
  mj_comVel(model.get(), data.get());
  truth.time_s = static_cast<double>(tick) * tick_s;
  truth.rail_m = data->qpos[rail_dof];
  for (const Arm side : both_arms) {
    const ArmDevices& arm = arms[side];
    ArmTruth& seen = truth.arms[side];
    seen.q_rad.resize(arm.joints);
    seen.dq_rad_per_s.resize(arm.joints);
    for (int i = 0; i < arm.joints; ++i) {
      seen.q_rad[i] = data->qpos[arm.dof[static_cast<std::size_t>(i)]];
      seen.dq_rad_per_s[i] = data->qvel[arm.dof[static_cast<std::size_t>(i)]];
    }
    double motion[6];
    mj_objectVelocity(model.get(), data.get(), mjOBJ_SITE, arm.site, motion, 0);
    seen.velocity_in_couch = couch_from_base.linear() * Vector3(motion[3], motion[4], motion[5]);
    Transform base_from_tool;
    base_from_tool.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
        data->site_xmat + 9 * arm.site);
    base_from_tool.translation() = Eigen::Map<const Vector3>(data->site_xpos + 3 * arm.site);
    base_from_tool.makeAffine();
    seen.couch_from_tool = couch_from_base * base_from_tool;
    if (person != nullptr) seen.contact = person->truth(side);
    seen.drive = arm.drive;
  }
}

void Plant::World::check_physics() noexcept {
  for (int kind = 0; broken == nullptr && kind < mjNWARNING; ++kind) {
    if (data->warning[kind].number == 0) continue;
    const bool wild = kind >= mjWARN_BADQPOS && kind <= mjWARN_BADQACC;
    broken = wild ? ran_off : mju_warningText(kind, data->warning[kind].lastinfo);
  }
}

}  // namespace tuina::sim
