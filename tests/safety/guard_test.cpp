// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/guard.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/allocation.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Guard::Options six_joints() {
  Guard::Options options;
  options.torque_limit_nm = JointVector::Constant(6, 50.0);
  return options;
}

// An arm that stands still and presses upward skin with 20 N, all sensors well; tests spoil one
// thing.
struct Scene {
  Observation seen;
  Proposal proposal;
  Guard guard = Guard(six_joints());
  double force_n = 20.0;
  bool sensor_alive = true;
  Verdict verdict;

  Scene() {
    seen.q_rad = seen.dq_rad_per_s = JointVector::Zero(6);
    seen.gravity_nm = JointVector::Constant(6, 2.0);
    seen.jacobian = Eigen::Matrix<double, 3, 6>::Constant(0.2);
    proposal = {.torque_nm = JointVector::Constant(6, 2.0),
                .phase = Phase::contact,
                .zone = Zone::muscle,
                .set_force_n = 20.0,
                .normal_in_base = Vector3::UnitZ(),
                .virtual_target_in_base = Vector3(0.0, 0.0, -0.02),
                .stiffness_n_per_m = 1000.0};
  }

  const Verdict& tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      seen.tick += 1;
      seen.time_s += 1e-3;
      if (sensor_alive) seen.wrench_time_s = seen.time_s - 1e-3;
      seen.force_in_base_n = Vector3(0.0, 0.0, force_n);
      verdict = guard.check(seen, proposal);
    }
    return verdict;
  }
};

}  // namespace

TEST_CASE("a quiet contact passes for ever and its torques come out unchanged") {
  Scene scene;
  for (int i = 0; i < 5000; ++i) {
    REQUIRE(scene.tick().action == Action::pass);
    REQUIRE(scene.verdict.allowed_nm == scene.proposal.torque_nm);
  }
}

TEST_CASE(
    "the torque of joint, zone and phase that nothing is wrong with passes in every combination") {
  for (std::size_t zone = 0; zone < zones; ++zone) {
    for (int phase = 0; phase < 4; ++phase) {
      Scene scene;
      scene.proposal.zone = static_cast<Zone>(zone);
      scene.proposal.phase = static_cast<Phase>(phase);
      const ForceLimits limits = ceiling_of(scene.proposal.zone);
      scene.force_n = std::min(limits.set_n + 9.0, limits.trip_n - 0.1);
      scene.proposal.set_force_n = limits.set_n;
      scene.proposal.virtual_target_in_base.z() = -1e-3 * limits.set_n;
      CHECK(scene.tick(2000).action == Action::pass);
    }
  }
}

TEST_CASE("force over the trip of each zone retracts within three milliseconds and stays latched") {
  for (std::size_t i = 0; i < zones; ++i) {
    Scene scene;
    scene.proposal.zone = static_cast<Zone>(i);
    const ForceLimits limits = ceiling_of(scene.proposal.zone);
    scene.proposal.set_force_n = limits.set_n;
    scene.proposal.virtual_target_in_base.setZero();
    scene.force_n = std::min(limits.trip_n - 1.0, limits.set_n + 5.0);
    CHECK(scene.tick(50).action == Action::pass);
    scene.force_n = limits.trip_n + 1.0;
    scene.tick(5);
    CHECK(scene.verdict.action == Action::retract);
    CHECK(scene.verdict.latched);
    scene.force_n = 0.0;
    CHECK(scene.tick(1000).action == Action::retract);
    scene.guard.reset();
    CHECK(scene.tick(10).action == Action::pass);
  }
}

TEST_CASE("force between ceiling and trip is borne for a tenth of a second") {
  Scene scene;
  scene.tick(10);
  for (; scene.force_n < 56.0; scene.force_n += 1.0) scene.tick();
  CHECK(scene.tick(90).action < Action::freeze);
  CHECK(scene.tick(20).cause == Cause::force_over_cap);
}

TEST_CASE("one wild sample of 500 N, or two, are ridden through; five in a second are a fault") {
  Scene scene;
  scene.tick(100);
  for (int spike = 0; spike < 4; ++spike) {
    scene.force_n = 500.0;
    CHECK(scene.tick(1 + spike % 2).action == Action::warn);
    scene.force_n = 20.0;
    CHECK(scene.tick(100).action == Action::pass);
  }
  scene.force_n = 500.0;
  CHECK(scene.tick().cause == Cause::force_spikes);
  CHECK(scene.verdict.action == Action::retract);
}

TEST_CASE("500 N that stay are believed at the third sample") {
  Scene scene;
  scene.tick(100);
  scene.force_n = 500.0;
  CHECK(scene.tick(2).action == Action::warn);
  scene.tick(2);
  CHECK(scene.verdict.action == Action::retract);
}

TEST_CASE("a force sensor that falls silent freezes the arm at 4 ms and makes it leave at 6 ms") {
  Scene scene;
  scene.tick(100);
  scene.sensor_alive = false;  // its last sample is one millisecond old
  CHECK(scene.tick(2).action == Action::pass);
  scene.tick();
  CHECK(scene.verdict.action == Action::freeze);
  CHECK_FALSE(scene.verdict.latched);
  scene.tick(2);
  CHECK(scene.verdict.action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_stale);
  CHECK(scene.verdict.latched);
}

TEST_CASE("a force sensor that says NaN counts as silent") {
  for (const double bad : {not_a_number, infinity}) {
    Scene scene;
    scene.tick(100);
    scene.force_n = bad;
    CHECK(scene.tick(2).action == Action::pass);
    CHECK(scene.tick(6).action == Action::retract);
  }
}

TEST_CASE("the same sample sent again and again is an old sample, and so is one from the future") {
  Scene scene;
  scene.tick(100);
  scene.sensor_alive = false;
  scene.seen.wrench_time_s = 1e6;
  CHECK(scene.tick(10).cause == Cause::force_stale);
}

TEST_CASE("one or two missed ticks warn, three freeze for a while, ten end the contact") {
  Scene scene;
  scene.tick(100);
  scene.seen.tick += 2;
  CHECK(scene.tick().action == Action::warn);
  CHECK(scene.tick().action == Action::pass);
  scene.seen.tick += 3;
  CHECK(scene.tick().action == Action::freeze);
  CHECK(scene.tick(50).action == Action::freeze);
  CHECK(scene.tick(60).action <= Action::warn);
  scene.seen.tick += 10;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.latched);
}

TEST_CASE("ticks that repeat or run backwards end the contact") {
  Scene scene;
  scene.tick(100);
  scene.seen.tick -= 1;
  CHECK(scene.tick().action == Action::retract);
}

TEST_CASE("joint angles that are not numbers leave only the brakes, with the last known gravity") {
  for (int what = 0; what < 4; ++what) {
    Scene scene;
    scene.tick(100);
    if (what == 0) scene.seen.q_rad[3] = not_a_number;
    if (what == 1) scene.seen.dq_rad_per_s[0] = infinity;
    if (what == 2) scene.seen.jacobian(1, 1) = not_a_number;
    if (what == 3) scene.seen.gravity_nm[5] = not_a_number;
    CHECK(scene.tick(20).action == Action::brake);
    CHECK(scene.verdict.allowed_nm == JointVector::Constant(6, 2.0));
    CHECK(scene.verdict.cause == Cause::state_not_finite);
  }
}

TEST_CASE("an encoder that jumps makes the arm comply") {
  Scene scene;
  scene.tick(100);
  scene.seen.q_rad[2] += 4.9e-3;
  CHECK(scene.tick().action == Action::pass);
  scene.seen.q_rad[2] += 5.1e-3;
  CHECK(scene.tick().cause == Cause::encoder_jump);
  CHECK(scene.verdict.action == Action::comply);
}

TEST_CASE("an elbow that swings makes the arm comply, however still the tool is") {
  Scene scene;
  scene.tick(100);
  scene.seen.dq_rad_per_s[5] = 10.0;  // a hand that turns
  scene.seen.dq_rad_per_s[2] = -0.99 * ceilings.joint_speed_rad_per_s;
  CHECK(scene.tick(20).action == Action::pass);
  scene.seen.dq_rad_per_s[2] = -1.01 * ceilings.joint_speed_rad_per_s;
  CHECK(scene.tick(2).action == Action::pass);
  CHECK(scene.tick().action == Action::comply);
  CHECK(scene.verdict.cause == Cause::joint_too_fast);
}

TEST_CASE("each phase has its speed, and noise of two milliseconds is not speed") {
  for (int phase = 0; phase < 4; ++phase) {
    Scene scene;
    scene.proposal.phase = static_cast<Phase>(phase);
    const double limit = ceilings.tool_speed_m_per_s[static_cast<std::size_t>(phase)];
    scene.seen.tool_velocity_m_per_s = Vector3(0.99 * limit, 0.0, 0.0);
    CHECK(scene.tick(100).action == Action::pass);
    scene.seen.tool_velocity_m_per_s = Vector3(1.01 * limit, 0.0, 0.0);
    CHECK(scene.tick(2).action == Action::pass);
    CHECK(scene.tick().action == Action::comply);
    CHECK(scene.verdict.cause == Cause::tool_too_fast);
  }
}

TEST_CASE("a person who gets up is let go") {
  Scene scene;
  scene.tick(10);
  scene.seen.tool_velocity_m_per_s = Vector3(0.0, 0.0, 0.15);
  CHECK(scene.tick(5).cause == Cause::pushed_out);
  Scene inward;
  inward.seen.tool_velocity_m_per_s = Vector3(0.0, 0.0, -0.15);
  CHECK(inward.tick(5).action == Action::pass);
}

TEST_CASE("a force that rises by more than 2000 N/s ends the contact before it is high") {
  Scene scene;
  scene.tick(100);
  double worst_n = 0.0;
  while (scene.tick().action < Action::freeze && scene.force_n < 100.0) {
    scene.force_n += 2.5;
    worst_n = scene.force_n;
  }
  CHECK(scene.verdict.cause == Cause::force_rising);
  CHECK(worst_n < 48.0);
}

TEST_CASE("a leash that could press harder than the trip is cut") {
  Scene scene;
  scene.proposal.virtual_target_in_base.z() = -0.0599;
  CHECK(scene.tick(10).action == Action::pass);
  scene.proposal.virtual_target_in_base.z() = -0.0601;
  CHECK(scene.tick().cause == Cause::leash_too_long);
  CHECK(scene.verdict.action == Action::retract);
}

TEST_CASE("a set force over the ceiling, or none, is not pressed") {
  for (const double force_n : {45.1, not_a_number, infinity}) {
    Scene scene;
    scene.proposal.set_force_n = force_n;
    CHECK(scene.tick().cause == Cause::set_force_too_high);
    CHECK(scene.verdict.action == Action::retract);
  }
}

TEST_CASE("a proposal with a broken normal, target, stiffness, zone or phase is refused") {
  for (int what = 0; what < 6; ++what) {
    Scene scene;
    if (what == 0) scene.proposal.normal_in_base = Vector3::Zero();
    if (what == 1) scene.proposal.normal_in_base.x() = not_a_number;
    if (what == 2) scene.proposal.virtual_target_in_base.y() = infinity;
    if (what == 3) scene.proposal.stiffness_n_per_m = -1.0;
    if (what == 4) scene.proposal.zone = static_cast<Zone>(99);
    if (what == 5) scene.proposal.phase = static_cast<Phase>(99);
    CHECK(scene.tick().cause == Cause::bad_proposal);
    CHECK(scene.verdict.allowed_nm.allFinite());
  }
}

TEST_CASE(
    "a torque that is no number is replaced in the same tick; three of them end the contact") {
  Scene scene;
  scene.tick(10);
  scene.proposal.torque_nm[4] = not_a_number;
  CHECK(scene.tick(2).action == Action::warn);
  CHECK(scene.verdict.allowed_nm == JointVector::Constant(6, 2.0));
  CHECK(scene.tick().action == Action::retract);
}

TEST_CASE(
    "torque is clamped in size and in rate, and saturation for a tenth of a second is a stop") {
  Scene scene;
  scene.tick(10);
  scene.proposal.torque_nm[1] = 80.0;
  CHECK(scene.tick().allowed_nm[1] == doctest::Approx(3.0));
  CHECK(scene.verdict.action == Action::warn);
  CHECK(scene.tick(80).allowed_nm[1] == doctest::Approx(50.0));
  CHECK(scene.tick(30).cause == Cause::torque_saturated);
}

TEST_CASE("options may lower a ceiling but never raise it") {
  Guard::Options options = six_joints();
  for (auto& force : options.force) force = {1000.0, not_a_number};
  options.limits.tool_speed_m_per_s.fill(9.0);
  options.limits.stale_retract_s = 1.0;
  options.limits.torque_rate_nm_per_s = infinity;
  const Guard raised(options);
  for (std::size_t i = 0; i < zones; ++i) {
    CHECK(raised.options().force[i].set_n == force_ceilings[i].set_n);
    CHECK(raised.options().force[i].trip_n == force_ceilings[i].trip_n);
  }
  CHECK(raised.options().limits.tool_speed_m_per_s == ceilings.tool_speed_m_per_s);
  CHECK(raised.options().limits.stale_retract_s == ceilings.stale_retract_s);
  CHECK(raised.options().limits.torque_rate_nm_per_s == ceilings.torque_rate_nm_per_s);
  options.force[0] = {12.0, 20.0};
  CHECK(Guard(options).options().force[0].set_n == 12.0);
}

TEST_CASE("while it retracts, the guard pushes the tool outward") {
  Scene scene;
  scene.tick(10);
  scene.force_n = 70.0;
  scene.tick(300);  // the tool does not move: the spring of the retreat winds up
  const JointVector push_nm = scene.verdict.allowed_nm - scene.seen.gravity_nm;
  CHECK(push_nm.minCoeff() > 0.0);  // J^T times an outward force, all entries of J positive
  CHECK(push_nm.maxCoeff() <= 0.2 * 80.0 + 1e-9);
}

TEST_CASE("a retreat does not brake the tool that a person pushes out, only the free one") {
  Scene pressed, released;
  for (Scene* scene : {&pressed, &released}) {
    scene->tick(10);
    scene->force_n = 70.0;
    scene->tick(20);
    scene->seen.tool_velocity_m_per_s = Vector3(0.0, 0.0, 0.28);  // faster than it would push
  }
  pressed.tick(20);
  released.force_n = 0.0;
  released.tick(20);
  REQUIRE(pressed.verdict.action == Action::retract);
  const auto push_nm = [](const Scene& scene) {
    return (scene.verdict.allowed_nm - scene.seen.gravity_nm).maxCoeff();
  };
  CHECK(push_nm(pressed) >= 0.0);
  CHECK(push_nm(released) < 0.0);
}

TEST_CASE("a controller may let go ten times as suddenly as it may press") {
  for (const double direction : {1.0, -1.0}) {
    Scene scene;
    scene.tick(10);
    // All entries of J are alike, so equal changes of all joints are a force along the normal.
    scene.proposal.torque_nm.setConstant(2.0 + direction * 40.0);
    const double step_nm = direction * (scene.tick().allowed_nm[0] - 2.0);
    CHECK(step_nm == doctest::Approx(direction > 0.0 ? 10.0 : 1.0));
    scene.proposal.phase = Phase::free;
    CHECK(direction * (scene.tick().allowed_nm[0] - 2.0) == doctest::Approx(step_nm + 1.0));
  }
}

TEST_CASE("the strongest action wins and one more fault never lowers it") {
  for (int first = 0; first < 6; ++first) {
    for (int second = 0; second < 6; ++second) {
      const auto spoil = [](Scene& scene, int fault) {
        if (fault == 0) scene.seen.tick += 1;
        if (fault == 1) scene.seen.tick += 4;
        if (fault == 2) scene.seen.q_rad[0] += 0.1;
        if (fault == 3) scene.proposal.set_force_n = 99.0;
        if (fault == 4) scene.seen.dq_rad_per_s[1] = not_a_number;
        if (fault == 5) scene.proposal.torque_nm[0] = not_a_number;
      };
      Scene a, both;
      a.tick(10);
      both.tick(10);
      spoil(a, first);
      spoil(both, first);
      spoil(both, second);
      CHECK(both.tick().action >= a.tick().action);
    }
  }
}

TEST_CASE("whatever bytes come in, what goes out is finite, within limits and not sudden") {
  Random random = make_random(11, "bytes");
  Scene scene;
  JointVector last = scene.tick().allowed_nm;
  const auto wild = [&] {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  for (int i = 0; i < 50000; ++i) {
    Scene fresh;
    if (i % 100 == 0) scene.guard.reset(), last = JointVector();
    scene.seen = fresh.seen;
    scene.proposal = fresh.proposal;
    for (int k = 0; k < 3; ++k) {
      const auto joint = static_cast<Eigen::Index>(random() % 6);
      switch (random() % 14) {
        case 0:
          scene.seen.q_rad[joint] = wild();
          break;
        case 1:
          scene.seen.dq_rad_per_s[joint] = wild();
          break;
        case 2:
          scene.seen.force_in_base_n[joint % 3] = wild();
          break;
        case 3:
          scene.seen.time_s = wild();
          break;
        case 4:
          scene.seen.wrench_time_s = wild();
          break;
        case 5:
          scene.seen.tick = random();
          break;
        case 6:
          // An earlier spoiling may have left a torque of fewer joints.
          if (joint < scene.proposal.torque_nm.size()) scene.proposal.torque_nm[joint] = wild();
          break;
        case 7:
          scene.proposal.normal_in_base[joint % 3] = wild();
          break;
        case 8:
          scene.proposal.virtual_target_in_base[joint % 3] = wild();
          break;
        case 9:
          scene.proposal.stiffness_n_per_m = wild();
          break;
        case 10:
          scene.seen.tool_velocity_m_per_s[joint % 3] = wild();
          break;
        case 11:
          scene.seen.gravity_nm[joint] = wild();
          break;
        case 12:
          scene.seen.jacobian(joint % 3, joint) = wild();
          break;
        default:
          scene.proposal.torque_nm = JointVector::Zero(static_cast<Eigen::Index>(random() % 8));
      }
    }
    const Verdict verdict = scene.guard.check(scene.seen, scene.proposal);
    REQUIRE(verdict.allowed_nm.size() == 6);
    REQUIRE(verdict.allowed_nm.allFinite());
    REQUIRE(verdict.allowed_nm.cwiseAbs().maxCoeff() <= 50.0);
    if (last.size() == 6) {
      REQUIRE((verdict.allowed_nm - last).cwiseAbs().maxCoeff() <= 10.0 + 1e-9);
    }
    last = verdict.allowed_nm;
  }
}

TEST_CASE("judging takes no memory from the heap") {
  Scene scene;
  const auto before = test::allocations();
  scene.tick(100);
  scene.force_n = 90.0;
  scene.tick(100);
  CHECK(test::allocations() == before);
}
