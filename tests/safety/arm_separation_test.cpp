// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/arm_separation.hpp"

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"
#include "tuina/robot/clearance.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

robot::RobotReading both_at_zero() {
  robot::RobotReading reading;
  for (const Arm arm : both_arms)
    reading.arms[arm] = {.q_rad = JointVector::Zero(6), .dq_rad_per_s = JointVector::Zero(6)};
  return reading;
}

/// A box below both forearms, so far from their surface.
robot::Obstacle box_below(double apart_m) {
  const Vector3 edges_m(2.0, 2.0, 0.1);
  const Vector3 tool =
      two_arms()[Arm::left].base_from_tool(JointVector::Zero(6), 0.0).translation();
  robot::Obstacle box{.edges_m = edges_m};
  box.base_from_box.translation() = Vector3(0.2, 0.0, tool.z() - 0.05 - apart_m - 0.05);
  return box;
}

/// How near the arms, or the arm and a box, are when motion at that speed is no longer allowed.
struct Approach {
  double gap_m = 0.0, speed_m_per_s = 0.0;
};
Approach approach_each_other(double rad_per_s, bool both) {
  ArmSeparation separation(two_arms(0.25));
  robot::RobotReading reading = both_at_zero();
  double before_m = 0.0;
  for (int ms = 0; ms < 5000; ++ms) {
    const bool keeps = separation.keeps(reading);
    const Approach now{separation.apart_m(), (before_m - separation.apart_m()) / 1e-3};
    if (!keeps) {
      CHECK_FALSE(separation.arms_keep());
      return now;
    }
    CHECK(separation.arms_keep());
    before_m = separation.apart_m();
    reading.arms[Arm::left].q_rad[1] += 1e-3 * rad_per_s;
    if (both) reading.arms[Arm::right].q_rad[1] -= 1e-3 * rad_per_s;
  }
  return {};
}

}  // namespace

TEST_CASE("readings that were missed take their time: arms stop as near as if none was") {
  const auto nearest_m = [](std::uint64_t every) {
    ArmSeparation separation(two_arms(0.25));
    robot::RobotReading reading = both_at_zero();
    while (reading.tick < 5000 && separation.keeps(reading)) {
      reading.tick += every;
      reading.arms[Arm::left].q_rad[1] += 1e-3 * static_cast<double>(every);
    }
    return separation.apart_m();
  };
  CHECK(std::abs(nearest_m(4) - nearest_m(1)) < 2e-3);
  CHECK(std::abs(nearest_m(30) - nearest_m(1)) < 15e-3);
}

TEST_CASE("arms that stand 25 mm apart keep, nearer they do not") {
  for (const double gap_m : {0.0251, 0.0249}) {
    ArmSeparation separation(two_arms(0.1 + gap_m));
    for (int i = 0; i < 3; ++i) CHECK(separation.keeps(both_at_zero()) == (gap_m > 0.025));
    CHECK(separation.apart_m() == doctest::Approx(gap_m));
    CHECK(separation.arms_keep() == (gap_m > 0.025));
  }
}

TEST_CASE("before the first reading nobody is near and nothing is violated") {
  const ArmSeparation separation(two_arms());
  CHECK(separation.arms_keep());
  CHECK(separation.apart_m() == 0.0);
}

TEST_CASE("arms stop when braking by 2 m/s2 each would end nearer than 25 mm") {
  for (const double rad_per_s : {0.1, 0.5, 1.0}) {
    const Approach one = approach_each_other(rad_per_s, false);
    REQUIRE(one.speed_m_per_s > 0.2 * rad_per_s);
    const double way_m = one.speed_m_per_s * one.speed_m_per_s / 4.0;
    CHECK(one.gap_m == doctest::Approx(0.025 + way_m).epsilon(0.05).scale(1e-6));
    // Two that share a closing speed have half the way.
    const Approach two = approach_each_other(0.5 * rad_per_s, true);
    CHECK(two.gap_m == doctest::Approx(0.025 + 0.5 * way_m).epsilon(0.05).scale(1e-6));
  }
}

TEST_CASE("arms that part need no way to brake, and a jump of an encoder is no speed") {
  ArmSeparation separation(two_arms(0.15));
  robot::RobotReading reading = both_at_zero();
  for (int ms = 0; ms < 200; ++ms) {
    REQUIRE(separation.keeps(reading));
    reading.arms[Arm::left].q_rad[1] -= 2e-3;
  }
  ArmSeparation jumping(two_arms(0.2));
  reading = both_at_zero();
  CHECK(jumping.keeps(reading));
  reading.arms[Arm::left].q_rad[1] += 5e-3;
  CHECK(jumping.keeps(reading));  // 3 m/s in one millisecond, a twentieth of it after smoothing
}

TEST_CASE("arms that stand 25 mm from couch or body keep, nearer they do not") {
  for (const double gap_m : {0.0251, 0.0249}) {
    ArmSeparation separation(two_arms(), {box_below(gap_m)});
    for (int i = 0; i < 3; ++i) CHECK(separation.keeps(both_at_zero()) == (gap_m > 0.025));
    CHECK(separation.arms_keep());  // it is not the arms
  }
}

TEST_CASE("an arm that nears the couch stops when braking by 2 m/s2 would end within 25 mm") {
  for (const Arm arm : both_arms) {
    ArmSeparation separation(two_arms(), {box_below(0.3)});
    robot::RobotReading reading = both_at_zero();
    const auto model = two_arms()[arm];
    double before_m = 0.0, gap_m = 0.0, speed_m_per_s = 0.0;
    const auto lowest_m = [&] {
      return model.base_from_tool(reading.arms[arm].q_rad, 0.0).translation().z();
    };
    const double floor_m = lowest_m() - 0.05 - 0.3;
    for (int ms = 0; ms < 5000; ++ms) {
      gap_m = lowest_m() - 0.05 - floor_m;
      speed_m_per_s = (before_m - gap_m) / 1e-3;
      before_m = gap_m;
      if (!separation.keeps(reading)) break;
      reading.arms[arm].q_rad[3] -= 0.5e-3;
    }
    CHECK(separation.arms_keep());
    REQUIRE(std::abs(speed_m_per_s) > 0.1);
    CHECK(gap_m ==
          doctest::Approx(0.025 + speed_m_per_s * speed_m_per_s / 4.0).epsilon(0.1).scale(1e-6));
  }
}

TEST_CASE("nothing keeps clear of an arm that nobody can place; a moment later all is as before") {
  const std::vector<void (*)(robot::RobotReading&)> faults = {
      [](robot::RobotReading& r) { r.arms[Arm::left].q_rad[2] = not_a_number; },
      [](robot::RobotReading& r) { r.arms[Arm::right].q_rad[5] = not_a_number; },
      [](robot::RobotReading& r) { r.arms[Arm::right].q_rad.setZero(5); },
      [](robot::RobotReading& r) { r.arms[Arm::left].q_rad.setZero(0); },
      [](robot::RobotReading& r) { r.arms[Arm::left].q_rad.setZero(7); },
      [](robot::RobotReading& r) { r.rail_m = not_a_number; }};
  for (const auto& spoil : faults) {
    ArmSeparation separation(two_arms(), {box_below(0.1)});
    for (int ms = 0; ms < 5; ++ms) CHECK(separation.keeps(both_at_zero()));
    robot::RobotReading bad = both_at_zero();
    spoil(bad);
    CHECK_FALSE(separation.keeps(bad));
    CHECK_FALSE(separation.arms_keep());
    for (int ms = 0; ms < 100; ++ms) CHECK(separation.keeps(both_at_zero()));
    CHECK(separation.apart_m() == doctest::Approx(0.3));
  }
}

TEST_CASE("tools that part quickly, 26 mm from each other, keep") {
  const auto models = two_arms(0.25);
  const auto turned = [](double in_rad) {
    robot::RobotReading reading = both_at_zero();
    reading.arms[Arm::left].q_rad[1] = in_rad;
    return reading;
  };
  const auto apart_m = [&](double in_rad) {
    return robot::distance_between_m(
        models[Arm::left], models[Arm::left].kinematics(turned(in_rad).arms[Arm::left].q_rad, 0.0),
        models[Arm::right], models[Arm::right].kinematics(JointVector::Zero(6), 0.0));
  };
  double in_rad = 0.0;
  while (apart_m(in_rad) > 0.026) in_rad += 1e-4;
  ArmSeparation separation(models);
  for (int ms = 0; ms < 100; ++ms) REQUIRE(separation.keeps(turned(in_rad - 2e-3 * ms)));
  CHECK(separation.apart_m() > 0.05);
}

TEST_CASE("arms may stand or part as near as 25 mm, in the first reading and later") {
  ArmSeparation separation(two_arms(0.1 + 0.0255));
  robot::RobotReading reading = both_at_zero();
  for (int ms = 0; ms < 100; ++ms) {
    REQUIRE(separation.keeps(reading));
    reading.arms[Arm::left].q_rad[1] -= 3e-3;
    reading.arms[Arm::right].q_rad[1] += 3e-3;
  }
}

TEST_CASE("closing speeds are smoothed over 20 ms, and braked by 2 m/s2") {
  // The left arm begins to turn at once; how near the arms may then be is found to a micrometre.
  constexpr std::array seen_at = {7, 8, 9, 10, 14, 15, 45, 46, 47};  // others were missed
  constexpr double turn_rad = 2e-3;
  const auto at = [](int tick) {
    robot::RobotReading reading = both_at_zero();
    reading.tick = static_cast<std::uint64_t>(tick);
    reading.arms[Arm::left].q_rad[1] = turn_rad * tick;
    return reading;
  };
  double near_m = 0.12, far_m = 0.4;
  while (far_m - near_m > 1e-7) {
    const double apart_m = 0.5 * (near_m + far_m);
    ArmSeparation separation(two_arms(apart_m));
    bool keeps = true;
    for (const int tick : seen_at) keeps = separation.keeps(at(tick));
    (keeps ? far_m : near_m) = apart_m;
  }
  const auto models = two_arms(far_m);
  const auto distance_m = [&](int left, int right) {
    return robot::distance_between_m(
        models[Arm::left], models[Arm::left].kinematics(at(left).arms[Arm::left].q_rad, 0),
        models[Arm::right], models[Arm::right].kinematics(at(right).arms[Arm::right].q_rad, 0));
  };
  double speed_m_per_s = 0.0;
  for (std::size_t i = 1; i < seen_at.size(); ++i) {
    const int before = seen_at[i - 1], now = seen_at[i], ms = now - before;
    const double closing = (distance_m(before, now) - distance_m(now, now)) / (1e-3 * ms);
    speed_m_per_s = (20.0 * speed_m_per_s + ms * closing) / (20.0 + ms);
  }
  REQUIRE(speed_m_per_s > 0.2);
  const double way_m = speed_m_per_s * speed_m_per_s / (2.0 * 2.0);
  CHECK(distance_m(seen_at.back(), seen_at.back()) - way_m ==
        doctest::Approx(0.025).epsilon(1e-6).scale(1.0));
}
