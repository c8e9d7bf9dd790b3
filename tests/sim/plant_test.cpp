// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/plant.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/allocation.hpp"
#include "tests/reason.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using namespace tuina::sim;
using robot::ArmModel;
using robot::ArmTable;

namespace {

const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const ArmTable believed = robot::thesis_arm();
const std::array<ArmModel, 2> models = {ArmModel(believed, mount, Arm::left),
                                        ArmModel(believed, mount, Arm::right)};

PerArm<JointVector> bent() {
  JointVector q(6);
  q << 0.5, 0.4, 0.3, 0.2, -0.3, 0.4;
  return {.of = {q, robot::mirrored(believed, mount, q)}};
}

ArmTable without_friction(double mass_scale = 1.0) {
  Random random = make_random(0, "none");
  return draw_arm(believed,
                  {.mass_spread = 0,
                   .friction_spread = 0,
                   .rotor_spread = 0,
                   .mass_scale = mass_scale,
                   .friction_scale = 0},
                  random);
}

std::unique_ptr<Plant> make(const ArmTable& arm, BackContact* person = nullptr,
                            const PlantOptions& options = {}) {
  auto plant = Plant::make(mount, {.of = {arm, arm}}, {.q_rad = bent()}, person, options);
  REQUIRE(plant.has_value());
  return std::move(*plant);
}

/// Holds the arms against their weight, with `extra_nm` on one joint, and damps what moves.
robot::RobotCommand hold(const robot::RobotReading& reading, int joint = 0, double extra_nm = 0.0) {
  robot::RobotCommand command;
  for (const Arm arm : both_arms) {
    command.torque_nm[arm] =
        models[static_cast<std::size_t>(arm)].gravity_nm(reading.arms[arm].q_rad);
    command.torque_nm[arm][joint] += extra_nm;
  }
  return command;
}

double farthest(const Plant& plant) {
  return (plant.truth().arms[Arm::left].q_rad - bent()[Arm::left]).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE(
    "the model's gravity holds an arm without friction, and that of a lighter arm lets it sink") {
  const auto right = make(without_friction());
  const auto heavy = make(without_friction(1.1));
  for (int ms = 0; ms < 500; ++ms) {
    right->apply(hold(*right->read()));
    heavy->apply(hold(*heavy->read()));
  }
  CHECK(farthest(*right) < 0.01);
  CHECK(farthest(*heavy) > 0.05);
  CHECK(right->fault() == nullptr);
}

TEST_CASE("a joint sticks below its friction, gives way above it, and does not creep") {
  Random random = make_random(0, "none");
  const ArmTable sticky =
      draw_arm(believed, {.mass_spread = 0, .friction_spread = 0, .rotor_spread = 0}, random);
  const auto below = make(sticky);
  const auto above = make(sticky);
  double after_half_s = 0.0;
  for (int ms = 0; ms < 1000; ++ms) {
    below->apply(hold(*below->read(), 1, 0.6 * believed.links[1].coulomb_nm));
    above->apply(hold(*above->read(), 1, 1.6 * believed.links[1].coulomb_nm));
    if (ms == 500) after_half_s = farthest(*below);
  }
  CHECK(farthest(*below) < 2e-3);
  CHECK(farthest(*below) - after_half_s < 1e-4);
  CHECK(farthest(*above) > 0.1);
}

TEST_CASE("the same seed gives the same millisecond bit for bit, another seed another noise") {
  const auto run = [](std::uint64_t seed) {
    const Mesh mesh = make_patch({.centre_in_couch = {0.1, 0.1, 0.3}});
    BackContact person(
        mesh, std::vector<TangentTissue>(mesh.vertices.size(), {.alpha_n = 4, .beta_per_m = 150}));
    const auto plant = make(believed, &person, {.seed = seed});
    double sum = 0.0;
    for (int ms = 0; ms < 200; ++ms) {
      const auto reading = *plant->read();
      sum += reading.arms[Arm::left].q_rad.sum() +
             reading.arms[Arm::right].wrench_in_tool.force_n.sum();
      plant->apply(hold(reading));
    }
    return sum;
  };
  CHECK(run(7) == run(7));
  CHECK(run(7) != run(8));
}

TEST_CASE("the resting wrist feels the tool's weight, a millisecond late and with its noise") {
  const auto plant = make(believed);
  double sum_n = 0.0, squares = 0.0;
  constexpr int samples = 400;
  for (int ms = 0; ms < samples; ++ms) {
    const auto reading = *plant->read();
    const auto& arm = reading.arms[Arm::right];
    const Matrix3 turn = models[1].base_from_tool(arm.q_rad, 0.0).linear();
    const Vector3 force_in_base = turn * arm.wrench_in_tool.force_n;
    sum_n += force_in_base.z();
    squares += force_in_base.x() * force_in_base.x();
    CHECK(arm.wrench_time_s == doctest::Approx(reading.time_s - 1e-3));
    plant->apply(hold(reading));
  }
  CHECK(sum_n / samples == doctest::Approx(-believed.tool_mass_kg * 9.81).epsilon(0.02));
  CHECK(std::sqrt(squares / samples) == doctest::Approx(0.05).epsilon(0.25));
}

TEST_CASE(
    "a pressed patch answers: the sensor comes to the true force and both to the torque that "
    "presses") {
  const Transform tool_in_base = models[0].base_from_tool(bent()[Arm::left], 0.0);
  const Vector3 tool_in_couch = mount.base_from_couch.inverse() * tool_in_base.translation();
  // The skin stands a sphere's radius and 1 mm in front of the left tool; the right tool is beside
  // it.
  const Mesh mesh =
      make_patch({.centre_in_couch = tool_in_couch - Vector3(-0.1, 18_mm, 0.0), .size_m = 0.3});
  BackContact person(mesh, std::vector<TangentTissue>(mesh.vertices.size(),
                                                      {.alpha_n = 9.786, .beta_per_m = 185.4}));
  const auto plant = make(without_friction(), &person, {.wrist_noise_n = 0.0});
  constexpr double push_n = 20.0;
  Vector3 felt_in_base = Vector3::Zero();
  for (int ms = 0; ms < 1500; ++ms) {
    const auto reading = *plant->read();
    robot::RobotCommand command = hold(reading);
    const auto& arm = reading.arms[Arm::left];
    const auto dynamics = models[0].evaluate(arm.q_rad, arm.dq_rad_per_s, reading.rail_m);
    Eigen::Matrix<double, 6, 1> wrench = Eigen::Matrix<double, 6, 1>::Zero();
    // Held sideways by a spring, pushed ahead by a constant force, damped all ways.
    const Vector3 off = dynamics.base_from_tool.translation() - tool_in_base.translation();
    wrench.head<3>() = Vector3(push_n, -2000.0 * off.y(), -2000.0 * off.z());
    wrench.head<3>() -= 80.0 * (dynamics.jacobian * arm.dq_rad_per_s).head<3>();
    command.torque_nm[Arm::left] += dynamics.jacobian.transpose() * wrench - 1.0 * arm.dq_rad_per_s;
    plant->apply(command);
    felt_in_base = dynamics.base_from_tool.linear() * arm.wrench_in_tool.force_n +
                   Vector3(0, 0, 9.81 * believed.tool_mass_kg);
  }
  const ContactTruth& truth = plant->truth().arms[Arm::left].contact;
  CHECK(truth.force_n == doctest::Approx(push_n).epsilon(0.02));
  CHECK(-felt_in_base.x() == doctest::Approx(truth.force_n).epsilon(0.02));
  CHECK(truth.depth_m > 4_mm);
  CHECK(plant->truth().arms[Arm::right].contact.force_n == 0.0);
}

TEST_CASE("amplifiers have steps and an end") {
  const auto plant = make(without_friction());
  const auto limited = make(without_friction());
  for (int ms = 0; ms < 30; ++ms) {
    robot::RobotCommand huge = hold(*plant->read()), most = hold(*limited->read());
    huge.torque_nm[Arm::left][5] = 1e9;
    most.torque_nm[Arm::left][5] = believed.links[5].torque_limit_nm;
    plant->apply(huge);
    limited->apply(most);
  }
  CHECK(farthest(*plant) == farthest(*limited));
}

TEST_CASE("a torque that is no number is a fault, and nothing else moves for it") {
  const auto plant = make(believed);
  robot::RobotCommand command = hold(*plant->read());
  command.torque_nm[Arm::left][2] = std::numeric_limits<double>::quiet_NaN();
  plant->apply(command);
  CHECK(std::isfinite(plant->read()->arms[Arm::left].q_rad.sum()));
  CHECK(std::string(plant->fault()) == "a torque command was not a number");
}

TEST_CASE("the linear base goes where it is wanted, without haste, and stays") {
  const auto plant = make(believed);
  double fastest = 0.0, last_m = 0.0;
  for (int ms = 0; ms < 3000; ++ms) {
    const auto reading = *plant->read();
    fastest = std::max(fastest, std::abs(reading.rail_m - last_m) / 1e-3);
    last_m = reading.rail_m;
    robot::RobotCommand command = hold(reading);
    command.rail_m = 0.1;
    plant->apply(command);
  }
  CHECK(last_m == doctest::Approx(0.1).epsilon(0.01));
  CHECK(fastest < 0.15);
}

TEST_CASE("a thousand milliseconds of reading and applying take nothing from the heap") {
  const Mesh mesh = make_patch({.centre_in_couch = {0.1, 0.1, 0.4}});
  BackContact person(
      mesh, std::vector<TangentTissue>(mesh.vertices.size(), {.alpha_n = 4, .beta_per_m = 150}));
  const auto plant = make(believed, &person);
  const auto before = test::allocations();
  for (int ms = 0; ms < 1000; ++ms) plant->apply(hold(*plant->read()));
  CHECK(test::allocations() == before);
  CHECK(plant->fault() == nullptr);
}

TEST_CASE("an arm that breaks loose from the numbers is reported, not hidden") {
  // Without rotors the wrist is so light that full torque to and fro throws it out of the
  // integrator.
  ArmTable light = without_friction();
  for (auto& link : light.links) {
    link.rotor_inertia_kg_m2 = 0.0;
    link.inertia_kg_m2 = {1e-9, 1e-9, 1e-9};
    link.com_in_joint = {0, 0, 0};
    link.torque_limit_nm = 1e6;
  }
  const auto plant = make(light);
  for (int ms = 0; ms < 2000 && plant->fault() == nullptr; ++ms) {
    robot::RobotCommand command = hold(*plant->read());
    for (int i = 0; i < 6; ++i) command.torque_nm[Arm::left][i] = 1e6;
    plant->apply(command);
  }
  CHECK(plant->fault() != nullptr);
}

TEST_CASE(
    "while the successor's arms are held against their weight, waist and wheels stand still") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    CAPTURE(name_of(position));
    const robot::RobotPlacement placement =
        robot::place_robot(robot::load_robot("successor").value(), position);
    const auto its = robot::both_models(placement.arm, placement.mount);
    const auto ready = robot::ready_posture(placement.arm, placement.mount);
    auto made =
        Plant::make(placement, {.of = {placement.arm, placement.arm}}, {.q_rad = ready}, nullptr);
    REQUIRE_MESSAGE(made.has_value(), test::reason(made));
    Plant& plant = **made;
    for (int ms = 0; ms < 1'000; ++ms) {
      const robot::RobotReading reading = *plant.read();
      robot::RobotCommand command;
      for (const Arm arm : both_arms)
        command.torque_nm[arm] = its[arm].gravity_nm(reading.arms[arm].q_rad);
      plant.apply(command);
    }
    CHECK(plant.fault() == nullptr);
    const Transform base_from_couch = placement.mount.base_from_couch;
    for (const Arm arm : both_arms) {
      const Transform tool = base_from_couch * plant.truth().arms[arm].couch_from_tool;
      const Transform wanted = its[arm].base_from_tool(ready[arm], 0.0);
      CHECK((tool.translation() - wanted.translation()).norm() < 0.5e-3);
    }
  }
}

TEST_CASE("drives tell their currents: errors of scale and offset, noise, and none when braked") {
  const auto plant = make(believed);
  auto reading = plant->read();
  CHECK(reading->arms[Arm::left].measured_torque_nm.size() == 0);  // before the first command
  for (const bool braked : {false, true}) {
    JointVector sum_nm = JointVector::Zero(6), squares = sum_nm, told_nm;
    constexpr int ticks = 400;
    for (int i = -20; i < ticks; ++i) {
      robot::RobotCommand command = hold(*reading);
      command.brake = {.of = {braked, braked}};
      told_nm = command.torque_nm[Arm::left];
      plant->apply(command);
      reading = plant->read();
      const JointVector off_nm = reading->arms[Arm::left].measured_torque_nm - told_nm;
      REQUIRE(off_nm.size() == 6);
      if (i >= 0) sum_nm += off_nm, squares += off_nm.cwiseAbs2();
    }
    const JointVector limit_nm = believed.torque_limits_nm(), mean_nm = sum_nm / ticks;
    for (int i = 0; i < 6; ++i) {
      const double mean = braked ? mean_nm[i] + told_nm[i] : mean_nm[i];
      CHECK(std::abs(mean) < (braked ? 0.0 : 0.03 * std::abs(told_nm[i])) + 6.5e-3 * limit_nm[i]);
      const double spread = std::sqrt(squares[i] / ticks - mean_nm[i] * mean_nm[i]);
      CHECK(spread == doctest::Approx(5e-3 * limit_nm[i]).epsilon(0.15));
    }
  }
  const auto mute = make(believed, nullptr, {.drives_tell = false});
  (void)mute->read();
  mute->apply(hold(*reading));
  CHECK(mute->read()->arms[Arm::left].measured_torque_nm.size() == 0);
}
