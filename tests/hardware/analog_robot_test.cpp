// SPDX-License-Identifier: Apache-2.0
// Arms of amplifiers with an analog input, on a card that is here a few numbers.
#include "tuina/hardware/analog_robot.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "tests/allocation.hpp"
#include "tests/reason.hpp"

using namespace tuina;
using namespace tuina::hardware;

namespace {

constexpr double volts_per_nm = 0.08, counts_per_rad = 65'190.0;
constexpr std::int64_t zero_count = 1000;
const robot::RobotMount mount = [] {
  robot::RobotMount standing = robot::mount_for(BodyPosture::sitting);
  standing.min_rail_m = standing.max_rail_m = 0.0;
  return standing;
}();
const robot::ArmTable table = robot::thesis_arm();

/// Joint 2 of each arm turns the other way; each joint bears Coulomb friction as its table says.
PerArm<std::vector<AnalogJoint>> joints() {
  std::vector<AnalogJoint> arm(6, {volts_per_nm, counts_per_rad, zero_count});
  arm[1] = {-volts_per_nm, -counts_per_rad, zero_count};
  return {.of = {arm, arm}};
}

class Card final : public DacEncoder {
 public:
  void write(std::span<const double> volts, const PerArm<bool>& powered) noexcept override {
    std::copy(volts.begin(), volts.end(), volts_.begin());
    powered_ = powered;
    ++writes;
  }
  bool read(std::span<std::int64_t> counts) noexcept override {
    if (silent) return false;
    for (const Arm arm : both_arms) move(arm);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double sign = i % 6 == 1 ? -1.0 : 1.0;
      const double q_rad = q_rad_.of[i / 6][static_cast<Eigen::Index>(i % 6)];
      counts[i] = zero_count + std::llround(sign * q_rad * counts_per_rad);
    }
    return true;
  }
  [[nodiscard]] double volts(std::size_t channel) const { return volts_[channel]; }
  [[nodiscard]] bool powered(Arm arm) const { return powered_[arm]; }
  bool silent = false;
  int writes = 0;

 private:
  /// An arm by its table, its joints rubbing as the table says.
  void move(Arm arm) {
    JointVector& speed = speed_[arm];
    if (!powered_[arm]) speed.setZero();
    if (!powered_[arm]) return;
    JointVector given_nm(6);
    for (int i = 0; i < 6; ++i)
      given_nm[i] = volts(static_cast<std::size_t>(arm == Arm::left ? i : 6 + i)) / volts_per_nm *
                    (i == 1 ? -1.0 : 1.0);
    const auto dynamics = models_[arm].evaluate(q_rad_[arm], speed, 0.0);
    const JointVector left_nm = given_nm - dynamics.gravity_nm - dynamics.coriolis_nm;
    speed += 1e-3 * dynamics.mass_kg_m2.ldlt().solve(left_nm);
    for (int i = 0; i < 6; ++i) {
      const double rubbed =
          1e-3 * table.links[static_cast<std::size_t>(i)].coulomb_nm / dynamics.mass_kg_m2(i, i);
      speed[i] = std::abs(speed[i]) < rubbed ? 0.0 : speed[i] - std::copysign(rubbed, speed[i]);
    }
    q_rad_[arm] += 1e-3 * speed;
  }

  PerArm<robot::ArmModel> models_ = robot::both_models(table, mount);
  std::array<double, 12> volts_ = {};
  PerArm<JointVector> q_rad_ = {.of = {JointVector::Zero(6), JointVector::Zero(6)}};
  PerArm<JointVector> speed_ = q_rad_;
  PerArm<bool> powered_ = {};
};

robot::ReadyPose ready() {
  return {.q_rad = {.of = {JointVector::Constant(6, 4_deg), JointVector::Constant(6, -4_deg)}}};
}

std::unique_ptr<AnalogRobot> standing(Card& card) {
  auto robot = AnalogRobot::open(card, joints(), table, mount, AnalogRobot::Clock::card);
  REQUIRE_MESSAGE(robot.has_value(), test::reason(robot));
  const auto stands = (*robot)->stand_ready(ready());
  REQUIRE_MESSAGE(stands.has_value(), test::reason(stands));
  return std::move(*robot);
}

robot::RobotCommand torques(double nm) {
  return {.torque_nm = {.of = {JointVector::Constant(6, nm), JointVector::Constant(6, nm)}}};
}

}  // namespace

TEST_CASE("arms on a card stand ready within a degree, on their brakes, whatever their friction") {
  Card card;
  const auto robot = standing(card);
  CHECK_FALSE(card.powered(Arm::left));
  CHECK(card.volts(0) == 0.0);
  const auto reading = robot->read();
  REQUIRE(reading.has_value());
  for (const Arm arm : both_arms)
    CHECK((reading->arms[arm].q_rad - ready().q_rad[arm]).cwiseAbs().maxCoeff() < 1_deg);
}

TEST_CASE("torques become volts of the right sign, ten at the most, without heap") {
  Card card;
  const auto robot = standing(card);
  robot::RobotCommand command = torques(5.0);
  command.brake[Arm::right] = true;
  REQUIRE(robot->read().has_value());
  const std::size_t before = test::allocations();
  robot->apply(command);
  REQUIRE(robot->read().has_value());
  CHECK(test::allocations() == before);
  CHECK(card.volts(0) == doctest::Approx(0.4));
  CHECK(card.volts(1) == doctest::Approx(-0.4));
  CHECK(card.volts(6) == 0.0);
  CHECK(card.powered(Arm::left));
  CHECK_FALSE(card.powered(Arm::right));
  robot->apply(torques(1e6));
  CHECK(card.volts(0) == doctest::Approx(120.0 * volts_per_nm));
}

TEST_CASE("a card without counts, and a torque that is no number, put the arms on their brakes") {
  Card card, other;  // which outlive their robots
  auto robot = standing(card);
  robot->apply(torques(0.0));
  card.silent = true;
  for (int i = 0; i < 3; ++i) CHECK_FALSE(robot->read().has_value());
  REQUIRE(robot->fault() != nullptr);
  CHECK(std::string(robot->fault()) == "the card gives no counts");
  CHECK_FALSE(card.powered(Arm::left));
  robot = standing(other);
  robot->apply(torques(std::numeric_limits<double>::quiet_NaN()));
  REQUIRE(robot->fault() != nullptr);
  CHECK_FALSE(other.powered(Arm::left));
  CHECK(other.volts(0) == 0.0);
}

TEST_CASE("joints that the table does not describe are refused") {
  Card card;
  const auto said = [&](const PerArm<std::vector<AnalogJoint>>& wrong) {
    const auto robot = AnalogRobot::open(card, wrong, table, mount);
    REQUIRE_FALSE(robot.has_value());
    return robot.error().message;
  };
  auto wrong = joints();
  wrong[Arm::right].pop_back();
  CHECK(said(wrong) == "the right arm has 5 joints on the card, the table has 6");
  wrong = joints();
  wrong[Arm::left][0].volts_per_nm = 0.1;
  CHECK(said(wrong).find("for the 120 Nm of the table it needs") != std::string::npos);
  wrong = joints();
  wrong[Arm::left][3].counts_per_rad = 0.0;
  CHECK(said(wrong).find("the left elbow has") != std::string::npos);
  CHECK(card.writes == 0);
  CHECK_FALSE(
      AnalogRobot::open(card, joints(), table, robot::mount_for(BodyPosture::sitting)).has_value());
}
