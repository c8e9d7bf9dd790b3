// SPDX-License-Identifier: Apache-2.0
// Gears that give way and wrist sensors that drift, at a robot that only holds its arms.
#include <doctest/doctest.h>

#include "tests/allocation.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/sim/robot/plant.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const robot::ArmTable believed = robot::thesis_arm();
const robot::ArmModel left_arm(believed, mount, Arm::left);
const robot::ArmModel right_arm(believed, mount, Arm::right);

PerArm<JointVector> bent() {
  JointVector q(6);
  q << 0.5, 0.4, 0.3, 0.2, -0.3, 0.4;
  return {.of = {q, robot::mirrored(believed, mount, q)}};
}

std::unique_ptr<Plant> plant_with(const DeviceFlaws& flaws, double friction_scale = 1.0,
                                  double wrist_noise_n = 0.0) {
  Random random = make_random(0, "none");
  const robot::ArmTable arm = draw_arm(
      believed,
      {.mass_spread = 0, .friction_spread = 0, .rotor_spread = 0, .friction_scale = friction_scale},
      random);
  auto plant = Plant::make(mount, {.of = {arm, arm}}, {.q_rad = bent()}, nullptr,
                           {.wrist_noise_n = wrist_noise_n, .wrist_noise_nm = 0.0, .flaws = flaws});
  REQUIRE(plant.has_value());
  return std::move(*plant);
}

/// One millisecond of holding against the weight, with `extra_nm` on the second joint.
robot::RobotReading hold(Plant& plant, double extra_nm = 0.0) {
  const robot::RobotReading reading = *plant.read();
  robot::RobotCommand command;
  for (const Arm arm : both_arms) {
    const robot::ArmModel& model = arm == Arm::left ? left_arm : right_arm;
    command.torque_nm[arm] = model.gravity_nm(reading.arms[arm].q_rad);
  }
  command.torque_nm[Arm::left][1] += extra_nm;
  plant.apply(command);
  return reading;
}

}  // namespace

TEST_CASE("an elastic gear shows the motor where it stands and the joint hangs from it") {
  const auto plant = plant_with({.gear_softness = 2.0, .gear_spread = 0.0});
  robot::RobotReading reading;
  for (int ms = 0; ms < 1000; ++ms) reading = hold(*plant);
  const JointVector weight_nm = left_arm.gravity_nm(bent()[Arm::left]);
  const ArmTruth& truth = plant->truth().arms[Arm::left];
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double wound_rad = reading.arms[Arm::left].q_rad[i] - truth.q_rad[i];
    const double nm_per_rad = 0.5 * believed.links[k].gear_nm_per_rad;
    CAPTURE(i);
    CHECK(wound_rad == doctest::Approx(weight_nm[i] / nm_per_rad).epsilon(0.1).scale(1e-3));
  }
  CHECK(std::abs(weight_nm[1]) > 1.0);
  CHECK(truth.dq_rad_per_s.norm() < 1e-3);
  CHECK(plant->fault() == nullptr);
}

TEST_CASE("behind backlash a joint moves freely, and a rigid gear has none") {
  constexpr double play_rad = 3e-3;
  // Without friction, so that a push to either side lets the motor run through its play.
  const auto slack_rad = [](double backlash_rad) {
    const auto wound = [&](double extra_nm) {
      const auto plant =
          plant_with({.gear_softness = 1.0, .gear_spread = 0.0, .backlash_rad = backlash_rad}, 0.0);
      robot::RobotReading reading;
      for (int ms = 0; ms < 100; ++ms) reading = hold(*plant, extra_nm);
      return reading.arms[Arm::left].q_rad[1] - plant->truth().arms[Arm::left].q_rad[1];
    };
    constexpr double more_than_its_weight_nm = 20.0;
    return std::abs(wound(more_than_its_weight_nm) - wound(-more_than_its_weight_nm));
  };
  const double tight = slack_rad(0.0);
  CHECK(tight < 3e-3);
  CHECK(slack_rad(play_rad) > tight + 0.5 * play_rad);
}

TEST_CASE("a motor whose torque ripples moves an arm without friction, a steady one does not") {
  const auto moved_rad = [](const DeviceFlaws& flaws) {
    const auto plant = plant_with(flaws, 0.0);
    for (int ms = 0; ms < 300; ++ms) (void)hold(*plant);
    return (plant->truth().arms[Arm::left].q_rad - bent()[Arm::left]).norm();
  };
  CHECK(moved_rad({.torque_ripple_share = 0.1}) > 3.0 * moved_rad({}));
}

TEST_CASE("a wrist sensor drifts by no more than it may, and one without flaws does not") {
  const auto drift_n = [](double n_per_s) {
    const auto plant = plant_with({.wrist_drift_n_per_s = n_per_s});
    for (int ms = 0; ms < 500; ++ms) (void)hold(*plant);
    const Vector3 before = hold(*plant).arms[Arm::left].wrench_in_tool.force_n;
    for (int ms = 0; ms < 1000; ++ms) (void)hold(*plant);
    return Vector3(hold(*plant).arms[Arm::left].wrench_in_tool.force_n - before);
  };
  CHECK(drift_n(0.0).norm() < 0.01);
  CHECK(drift_n(1.0).norm() > 0.1);
  CHECK(drift_n(1.0).cwiseAbs().maxCoeff() < 1.02);
}

TEST_CASE("crosstalk and hysteresis stay within their shares of what is felt") {
  const auto plant =
      plant_with({.wrist_hysteresis_share = 0.02, .wrist_crosstalk_share = 0.02}, 1.0);
  const auto good = plant_with({});
  for (int ms = 0; ms < 300; ++ms) (void)hold(*plant), (void)hold(*good);
  const auto felt = [](Plant& one) { return hold(one).arms[Arm::left].wrench_in_tool.force_n; };
  const Vector3 wrong = felt(*plant) - felt(*good);
  CHECK(wrong.norm() > 1e-4);
  CHECK(wrong.cwiseAbs().maxCoeff() < 0.08 * felt(*good).norm());
}

TEST_CASE("flawed devices take nothing from the heap") {
  const auto plant = plant_with({.gear_softness = 1.0,
                                 .backlash_rad = 1e-4,
                                 .torque_ripple_share = 0.02,
                                 .friction_drift_share = 0.2,
                                 .wrist_drift_n_per_s = 0.01,
                                 .wrist_hysteresis_share = 0.01,
                                 .wrist_crosstalk_share = 0.01});
  robot::RobotCommand command;
  for (const Arm arm : both_arms) command.torque_nm[arm] = JointVector::Zero(6);
  (void)plant->read();
  const auto before = test::allocations();
  for (int ms = 0; ms < 50; ++ms) {
    plant->apply(command);
    (void)plant->read();
  }
  CHECK(test::allocations() == before);
}

TEST_CASE("a tool that is heavier than believed by a share weighs just that") {
  Random random = make_random(3, "tool");
  const robot::ArmTable arm = draw_arm(believed, {.tool_mass_share = 0.05}, random);
  CHECK(std::abs(arm.tool_mass_kg / believed.tool_mass_kg - 1.0) == doctest::Approx(0.05));
}
