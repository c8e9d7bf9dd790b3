// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/plant.hpp"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include "tuina/robot/description.hpp"

namespace tuina::sim {
namespace {

constexpr double tick_s = 1e-3;
constexpr double rail_stiffness_per_s2 = 60.0 * 60.0;  // a servo of 60 rad/s, critically damped
constexpr double rail_speed_m_per_s = 0.1;
constexpr double rail_acceleration_m_per_s2 = 0.3;
constexpr double windup_damping_ratio = 0.2;  // of a rotor on the spring of its gear

struct Free {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPointer = std::unique_ptr<mjModel, Free>;
using DataPointer = std::unique_ptr<mjData, Free>;

// MuJoCo's own handler writes a file beside the program; the plant reads the counters instead.
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

/// Share of the way a first-order low-pass goes towards its input in one step.
double low_pass_share(double cutoff_hz, double step_s) {
  return cutoff_hz > 0.0 ? 1.0 - std::exp(-2.0 * pi * cutoff_hz * step_s) : 1.0;
}

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// What one arm has besides its bodies: drives, gears, sensors.
struct ArmDevices {
  int joints = 0;
  std::array<int, most_joints> dof =
      {};  // in qvel; every joint before it is a hinge or slide, so in qpos too
  int site = -1;
  int tool_body = -1;
  double tool_mass_kg = 0.0;
  std::array<double, most_joints> torque_limit_nm = {}, coulomb_nm = {}, viscous = {};
  std::array<double, most_joints> windup_damping = {};

  std::array<double, most_joints> torque_nm = {};    // out of the amplifiers
  std::array<double, most_joints> friction_nm = {};  // Coulomb part, kept wound up
  std::array<double, most_joints> encoder_rad = {}, velocity_rad_per_s = {};
  Vector3 last_velocity = Vector3::Zero();
  Vector6 felt = Vector6::Zero();     // in the tool frame, behind the sensor's low-pass
  Vector6 sampled = Vector6::Zero();  // a millisecond ago
};

}  // namespace

struct Plant::World {
  PlantOptions options;
  Transform couch_from_base;
  BackContact* person = nullptr;
  ModelPointer model;
  DataPointer data;
  Random noise;
  int substeps = 4;
  double step_s = 0.0;
  PerArm<ArmDevices> arms;
  PerArm<Wrench> hands;
  struct Held {
    int dof = 0;
    double q = 0.0;
    double effort_limit = 0.0;  ///< 0: none is known
  };
  std::vector<Held> held;
  int rail_dof = 0;
  double rail_wanted_m = 0.0, rail_now_m = 0.0, rail_speed = 0.0;
  double moving_kg = 0.0;
  std::uint64_t tick = 0;
  bool started = false;
  const char* broken = nullptr;
  PlantTruth truth;

  void look() noexcept;
  void touch(Arm arm) noexcept;
  void drive(ArmDevices& arm) noexcept;
  void drive_rail() noexcept;
  void hold(const Held& held) noexcept;
  void step() noexcept;
  void read_encoders(ArmDevices& arm) noexcept;
  [[nodiscard]] Wrench sample_wrist(ArmDevices& arm) noexcept;
  void judge() noexcept;
};

robot::ArmTable draw_arm(const robot::ArmTable& believed, const TableErrors& errors,
                         Random& random) {
  robot::ArmTable arm = believed;
  const auto near_one = [&random](double spread) { return 1.0 + uniform(random, -spread, spread); };
  for (int i = 0; i < arm.joints; ++i) {
    robot::Link& link = arm.links[static_cast<std::size_t>(i)];
    const double mass = errors.mass_scale * near_one(errors.mass_spread);
    link.mass_kg *= mass;
    for (double& inertia : link.inertia_kg_m2) inertia *= mass;
    link.rotor_inertia_kg_m2 *= near_one(errors.rotor_spread);
    const double friction = errors.friction_scale * near_one(errors.friction_spread);
    link.coulomb_nm *= friction;
    link.viscous_nm_s_per_rad *= friction;
  }
  return arm;
}

Result<std::unique_ptr<Plant>> Plant::make(const robot::RobotMount& mount,
                                           const PerArm<robot::ArmTable>& arms, const Start& start,
                                           BackContact* person, const PlantOptions& options) {
  return make(robot::Standing{.arm = arms[Arm::left], .mount = mount}, arms, start, person,
              options);
}

Result<std::unique_ptr<Plant>> Plant::make(const robot::Standing& standing,
                                           const PerArm<robot::ArmTable>& arms, const Start& start,
                                           BackContact* person, const PlantOptions& options) {
  const robot::WholeRobot whole = robot::whole_of(standing, arms);
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
  // Friction is ours (below): MuJoCo's is a constraint that costs more than the rest of the arm.
  std::fill_n(m->dof_frictionloss, m->nv, 0.0);
  std::fill_n(m->dof_damping, m->nv, 0.0);

  world->couch_from_base = standing.mount.base_from_couch.inverse();
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
    arm.joints = table.joints;
    arm.site = mj_name2id(m, mjOBJ_SITE, fmt::format("{}_tool", name_of(side)).c_str());
    arm.tool_body = m->site_bodyid[arm.site];
    arm.tool_mass_kg = table.tool_mass_kg;
    for (int i = 0; i < table.joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const robot::Link& link = table.links[k];
      const int joint =
          mj_name2id(m, mjOBJ_JOINT, fmt::format("{}_{}", name_of(side), link.name).c_str());
      arm.dof[k] = m->jnt_dofadr[joint];
      arm.torque_limit_nm[k] = link.torque_limit_nm;
      arm.coulomb_nm[k] = link.coulomb_nm;
      arm.viscous[k] = link.viscous_nm_s_per_rad;
      arm.windup_damping[k] =
          2.0 * windup_damping_ratio *
          std::sqrt(link.coulomb_nm / options.friction_windup_rad * link.rotor_inertia_kg_m2);
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
  for (const Arm side : both_arms) {
    ArmDevices& arm = world->arms[side];
    // The sensor has hung there long before the start and feels the tool's weight.
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d->site_xmat +
                                                                              9 * arm.site);
    arm.felt.head<3>() = turn.transpose() * Vector3(0, 0, -gravity_m_per_s2 * arm.tool_mass_kg);
    arm.sampled = arm.felt;
    world->read_encoders(arm);
    arm.velocity_rad_per_s = {};
    if (world->person != nullptr) world->touch(side);
  }
  world->look();
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
const PlantTruth& Plant::truth() const noexcept {
  return world_->truth;
}

void Plant::apply(const robot::RobotCommand& command) noexcept {
  World& world = *world_;
  const double levels = std::ldexp(1.0, world.options.dac_bits - 1);
  for (const Arm side : both_arms) {
    ArmDevices& arm = world.arms[side];
    const JointVector& wanted = command.torque_nm[side];
    for (int i = 0; i < arm.joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
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

robot::RobotReading Plant::read() noexcept {
  World& world = *world_;
  if (world.started) {
    for (int i = 0; i < world.substeps; ++i) world.step();
    ++world.tick;
    for (const Arm side : both_arms) world.read_encoders(world.arms[side]);
    world.look();
    world.judge();
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
  }
  world.started = true;
  return reading;
}

void Plant::World::step() noexcept {
  mjModel* m = model.get();
  mjData* d = data.get();
  mj_step1(m, d);  // positions and velocities of now
  mju_zero(d->qfrc_applied, m->nv);
  for (const Arm side : both_arms) {
    drive(arms[side]);
    touch(side);
  }
  drive_rail();
  for (const Held& joint : held) hold(joint);
  mj_step2(m, d);
}

void Plant::World::drive(ArmDevices& arm) noexcept {
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
    const double speed = data->qvel[arm.dof[k]];
    // Dahl's friction, [dahl1968]: a gear winds up like a spring before it slips, so a resting arm
    // truly sticks. What the gear dissipates while wound keeps a sticking arm from ringing on that
    // spring, as in [canudas1995].
    double friction = 0.0;
    if (arm.coulomb_nm[k] > 0.0) {
      const double most = arm.coulomb_nm[k];
      const double spring = most / options.friction_windup_rad;
      const double wound = arm.friction_nm[k] / most * (speed > 0.0 ? 1.0 : -1.0);
      arm.friction_nm[k] =
          std::clamp(arm.friction_nm[k] + spring * speed * step_s * (1.0 - wound), -most, most);
      friction = std::clamp(arm.friction_nm[k] + arm.windup_damping[k] * speed, -most, most);
    }
    data->qfrc_applied[arm.dof[k]] += arm.torque_nm[k] - friction - arm.viscous[k] * speed;
  }
}

void Plant::World::touch(Arm side) noexcept {
  ArmDevices& arm = arms[side];
  const Eigen::Map<const Vector3> at_in_base(data->site_xpos + 3 * arm.site);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> base_from_tool(
      data->site_xmat + 9 * arm.site);
  double motion[6];  // rotation first
  mj_objectVelocity(model.get(), data.get(), mjOBJ_SITE, arm.site, motion, 0);
  const Vector3 velocity_in_base(motion[3], motion[4], motion[5]);

  Wrench on_tool_in_base;
  if (person != nullptr) {
    const Matrix3 turn = couch_from_base.linear();
    const ContactTruth& contact =
        person->touch(side, data->time, couch_from_base * at_in_base, turn * velocity_in_base);
    on_tool_in_base.force_n = turn.transpose() * contact.on_tool_in_couch.force_n;
    on_tool_in_base.torque_nm = turn.transpose() * contact.on_tool_in_couch.torque_nm;
    if (contact.force_n > 0.0) {
      mj_applyFT(model.get(), data.get(), on_tool_in_base.force_n.data(),
                 on_tool_in_base.torque_nm.data(), at_in_base.data(), arm.tool_body,
                 data->qfrc_applied);
    }
  }
  const Wrench& hand = hands[side];
  mj_applyFT(model.get(), data.get(), hand.force_n.data(), hand.torque_nm.data(), at_in_base.data(),
             arm.tool_body, data->qfrc_applied);
  // The sensor carries the tool: it feels the contact, the tool's weight, and what it takes to move
  // the tool.
  const Vector3 acceleration = (velocity_in_base - arm.last_velocity) / step_s;
  arm.last_velocity = velocity_in_base;
  Vector6 felt;
  felt.head<3>() = base_from_tool.transpose() *
                   (on_tool_in_base.force_n +
                    arm.tool_mass_kg * (Vector3(0.0, 0.0, -gravity_m_per_s2) - acceleration));
  felt.tail<3>() = base_from_tool.transpose() * on_tool_in_base.torque_nm;
  arm.felt += low_pass_share(options.wrist_low_pass_hz, step_s) * (felt - arm.felt);
}

void Plant::World::drive_rail() noexcept {
  // The set point runs to where it is wanted with bounded speed and acceleration, the servo follows
  // it.
  const double left = rail_wanted_m - rail_now_m;
  const double fastest =
      std::min(rail_speed_m_per_s, std::sqrt(2.0 * rail_acceleration_m_per_s2 * std::abs(left)));
  const double change = rail_acceleration_m_per_s2 * step_s;
  rail_speed += std::clamp(std::copysign(fastest, left) - rail_speed, -change, change);
  if (std::abs(left) < 1e-6 && std::abs(rail_speed) <= change) {
    rail_speed = 0.0;
    rail_now_m = rail_wanted_m;
  }
  rail_now_m += rail_speed * step_s;
  const double rate = std::sqrt(rail_stiffness_per_s2);
  data->qfrc_applied[rail_dof] +=
      moving_kg * (rail_stiffness_per_s2 * (rail_now_m - data->qpos[rail_dof]) +
                   2.0 * rate * (rail_speed - data->qvel[rail_dof]));
}

/// A position drive like that of the rail, which knows what gravity asks of it.
void Plant::World::hold(const Held& joint) noexcept {
  const double inertia = data->qM[model->dof_Madr[joint.dof]];
  const double rate = std::sqrt(rail_stiffness_per_s2);
  double effort = data->qfrc_bias[joint.dof] +
                  inertia * (rail_stiffness_per_s2 * (joint.q - data->qpos[joint.dof]) -
                             2.0 * rate * data->qvel[joint.dof]);
  if (joint.effort_limit > 0.0)
    effort = std::clamp(effort, -joint.effort_limit, joint.effort_limit);
  data->qfrc_applied[joint.dof] += effort;
}

void Plant::World::read_encoders(ArmDevices& arm) noexcept {
  const double share = low_pass_share(options.velocity_low_pass_hz, tick_s);
  const double count = options.encoder_counts > 0.0 ? 2.0 * pi / options.encoder_counts : 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
    const double angle = data->qpos[arm.dof[k]];
    const double seen = count > 0.0 ? std::round(angle / count) * count : angle;
    const double difference = (seen - arm.encoder_rad[k]) / tick_s;
    arm.velocity_rad_per_s[k] += share * (difference - arm.velocity_rad_per_s[k]);
    arm.encoder_rad[k] = seen;
  }
}

Wrench Plant::World::sample_wrist(ArmDevices& arm) noexcept {
  const Vector6 late = arm.sampled;  // a sample is on the bus for one millisecond
  for (int i = 0; i < 3; ++i) {
    arm.sampled[i] = arm.felt[i] + gaussian(noise, options.wrist_noise_n);
    arm.sampled[i + 3] = arm.felt[i + 3] + gaussian(noise, options.wrist_noise_nm);
  }
  return {late.head<3>(), late.tail<3>()};
}

void Plant::World::look() noexcept {
  // After the last step the places are a quarter of a millisecond old; they are brought up to date.
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
  }
}

void Plant::World::judge() noexcept {
  if (broken != nullptr) return;
  for (int kind = 0; kind < mjNWARNING; ++kind) {
    if (data->warning[kind].number == 0) continue;
    broken = mju_warningText(kind, data->warning[kind].lastinfo);
    return;
  }
}

}  // namespace tuina::sim
