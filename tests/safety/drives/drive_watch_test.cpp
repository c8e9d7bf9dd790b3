// SPDX-License-Identifier: Apache-2.0
// Whether drives that measure their torques are believed, and what the guard makes of it.
#include "tuina/safety/drive_watch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// Three joints, the second of which is asked for something.
struct Joints {
  DriveWatch watch{JointVector::Constant(3, 100.0)};
  JointVector measured_nm = JointVector::Zero(3), commanded_nm = JointVector::Zero(3);

  double take(double measured, double commanded, int ticks = 1, bool begins = false) {
    measured_nm[1] = measured, commanded_nm[1] = commanded;
    for (int i = 0; i < ticks; ++i) watch.compare(measured_nm, commanded_nm, begins);
    return watch.misfit();
  }
};

}  // namespace

TEST_CASE("a drive may measure a tenth more or less, and 1.5 % of its limit") {
  for (const double commanded_nm : {20.0, -20.0}) {
    for (const double direction : {1.0, -1.0}) {
      CHECK(Joints().take(commanded_nm + direction * 3.49, commanded_nm, 2000) == 0.0);
      CHECK(Joints().take(commanded_nm + direction * 3.51, commanded_nm, 2000) > 1.0);
    }
  }
  CHECK(Joints().take(1.49, 0.0, 2000) == 0.0);
  CHECK(Joints().take(1.51, 0.0, 2000) > 1.0);
}

TEST_CASE("what a drive measures wrong as a rule is learnt; a change of 1.2 % is not believed") {
  for (const double direction : {1.0, -1.0}) {
    for (const double change_nm : {1.19, 1.25}) {
      Joints joints;
      CHECK(joints.take(21.0, 20.0, 3000) == 0.0);
      CHECK((joints.take(21.0 + direction * change_nm, 20.0, 4000) > 1.0) == (change_nm > 1.2));
    }
  }
  Joints drifts;  // in a second two thirds of a change are learnt
  drifts.take(0.0, 0.0, 3000);
  CHECK(drifts.take(1.0, 0.0, 1000) == 0.0);
  CHECK(drifts.take(-0.7, 0.0, 500) > 1.0);
  // With the command its error may grow by a tenth of it.
  for (const double measured_nm : {30.0 + 1.2 + 2.9, 30.0 + 1.2 + 3.1}) {
    Joints joints;
    CHECK(joints.take(0.0, 0.0, 1000) == 0.0);
    for (int ms = 0; ms <= 100; ++ms) joints.take(measured_nm * 0.01 * ms, 0.3 * ms);
    CHECK((joints.take(measured_nm, 30.0, 1500) > 1.0) == (measured_nm > 34.2));
  }
}

TEST_CASE("a dead drive, a reversed one and one that gives half are noticed in 3 ms") {
  for (const double gain : {0.0, -1.0, 0.5}) {
    Joints joints;
    CHECK(joints.take(40.0, 40.0, 60) == 0.0);
    // Each millisecond counts twice at the most.
    CHECK(joints.take(gain * 40.0, 40.0) == 0.5);
    CHECK(joints.take(gain * 40.0, 40.0) == 1.0);
    CHECK(joints.take(gain * 40.0, 40.0) == 1.5);
    CHECK(joints.watch.reversed_joint() == -1);
    joints.take(gain * 40.0, 40.0, 5);
    CHECK(joints.watch.reversed_joint() == (gain < 0.0 ? 1 : -1));
  }
  for (const double measured_nm : {0.02, -0.02}) {  // the sign tells, however small
    Joints joints;
    joints.take(40.0, 40.0, 60);
    joints.take(measured_nm, 40.0, 100);
    CHECK(joints.watch.reversed_joint() == (measured_nm < 0.0 ? 1 : -1));
  }
  Joints slight;  // of a change of 1.4 Nm a fifth is seen, then more; 1.2 are borne
  slight.take(0.0, 0.0, 3000);
  CHECK(slight.take(1.4, 0.0, 8) == 0.0);
  CHECK(slight.take(1.4, 0.0, 3) > 0.0);
}

TEST_CASE(
    "for 50 ms nobody knows what a drive measures wrong as a rule, and its bounds are judged") {
  for (const int known_ms : {50, 51}) {
    Joints joints;
    CHECK(joints.take(20.0, 20.0, known_ms - 1) == 0.0);
    // A fifth of this is no more than it may be off by, and far more than that changes by.
    CHECK((joints.take(35.0, 20.0) > 0.0) == (known_ms > 50));
  }
  Joints dead;
  CHECK(dead.take(0.0, 40.0, 2) < 1.0);
  CHECK(dead.take(0.0, 40.0) > 1.0);
}

TEST_CASE("sound drives are switched on two thousand times, and believed") {
  Random random = make_random(1, "drives switched on");
  int stopped = 0;
  for (int start = 0; start < 2'000; ++start) {
    Joints joints;
    double worst = 0.0;
    const double offset_nm = uniform(random, -0.5, 0.5);
    for (int ms = 0; ms < 100; ++ms) {
      for (double& one : joints.measured_nm) one = offset_nm + gaussian(random, 0.8);
      joints.watch.compare(joints.measured_nm, joints.commanded_nm, false);
      worst = std::max(worst, joints.watch.misfit());
    }
    stopped += worst > 1.0 ? 1 : 0;
  }
  CHECK(stopped == 0);
}

TEST_CASE("a drive that gives again what it is told is believed again") {
  Joints joints;
  joints.take(40.0, 40.0, 60);
  CHECK(joints.take(0.0, 40.0, 5) > 1.0);
  CHECK(joints.take(40.0, 40.0, 100) == 0.0);
}

TEST_CASE("each joint is held against its own limit, and the worst of them counts") {
  for (Eigen::Index joint = 0; joint < 3; ++joint) {
    const JointVector limits_nm = JointVector::LinSpaced(3, 100.0, 20.0);
    for (const double share : {0.0149, 0.0151}) {
      DriveWatch watch(limits_nm);
      JointVector measured_nm = JointVector::Zero(3);
      measured_nm[joint] = share * limits_nm[joint];
      for (int i = 0; i < 2000; ++i) watch.compare(measured_nm, JointVector::Zero(3), false);
      CHECK((watch.misfit() > 1.0) == (share > 0.015));
    }
  }
}

TEST_CASE("what is measured two milliseconds late is believed, five are not") {
  for (const int late : {1, 2, 5}) {
    Joints joints;
    double worst = 0.0;
    for (int ms = 0; ms < 2000; ++ms) {
      const auto wanted_nm = [](int at) {
        return at < 100 ? 0.0 : 60.0 * std::sin(2.0 * pi * 20.0 * 1e-3 * (at - 100));
      };
      worst = std::max(worst, joints.take(wanted_nm(ms - late), wanted_nm(ms)));
    }
    CHECK((late == 5 ? worst > 1.0 : worst == 0.0));
  }
}

TEST_CASE(
    "noise of 0.8 % of the limit, and an offset of half a per cent, are borne for ten minutes") {
  Joints joints;
  Random random = make_random(1, "drive noise");
  double worst = 0.0;
  for (int ms = 0; ms < 600'000; ++ms) {
    for (double& one : joints.measured_nm) one = 0.5 + gaussian(random, 0.8);
    joints.watch.compare(joints.measured_nm, joints.commanded_nm, false);
    worst = std::max(worst, joints.watch.misfit());
  }
  CHECK(worst < 1.0);
}

TEST_CASE("two measurements that are no numbers are borne, a third is not") {
  constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
  Joints joints;
  joints.take(20.0, 20.0, 10);
  CHECK(joints.take(no_number, 20.0, 2) == 1.0);
  CHECK(joints.take(no_number, 20.0) == 1.5);
  CHECK(joints.take(20.0, 20.0, 10) == 0.0);  // and leave nothing behind
  CHECK(joints.take(0.0, 20.0, 10) > 1.0);
  Joints first;
  CHECK(first.take(no_number, 20.0) == 0.5);
  CHECK(first.take(20.0, 20.0, 10) == 0.0);
}

TEST_CASE("where nothing is measured or commanded there is nothing to compare") {
  Joints joints;
  CHECK(joints.watch.misfit() == 0.0);
  CHECK(joints.watch.reversed_joint() == -1);
  joints.watch.compare({}, JointVector::Constant(3, 50.0), false);
  joints.watch.compare(JointVector::Constant(3, 50.0), {}, false);
  joints.watch.compare(JointVector::Constant(4, 50.0), JointVector::Zero(3), false);
  joints.watch.compare(JointVector::Zero(3), JointVector::Constant(4, 50.0), false);
  CHECK(joints.watch.misfit() == 0.0);
}

TEST_CASE("after milliseconds that nobody saw it begins anew, and what it knew stays") {
  Joints joints;
  joints.take(21.0, 20.0, 100);
  Joints other;
  other.take(22.4, 20.0, 300);
  CHECK(other.take(22.4, 20.0, 1, true) == 0.0);
  CHECK(joints.take(61.0, 60.0, 1, true) == 0.0);
  CHECK(joints.take(61.0, 60.0, 5000) == 0.0);
  // So small a change is seen from the third millisecond on, and never where each is the first.
  CHECK(joints.take(63.0, 60.0, 20, true) == 0.0);
  CHECK(joints.take(63.0, 60.0, 20) > 1.0);
}

TEST_CASE("the guard's eyes hold what an arm measures against what it was told") {
  const auto misfit = [](double more_nm, bool measures, std::uint64_t tick_step) {
    Standing arm;
    arm.stiffness_n_per_m = 1.0;
    const JointVector told_nm = arm.model.gravity_nm(arm.arm().q_rad);
    double worst = 0.0;
    for (int ms = 0; ms < 200; ++ms) {
      arm.reading.tick += tick_step - 1;
      if (measures) arm.arm().measured_torque_nm = told_nm;
      if (measures && ms > 100) arm.arm().measured_torque_nm[1] += more_nm;
      worst = std::max(worst, arm.observe().drive_misfit);
    }
    return worst;
  };
  CHECK(misfit(0.0, true, 1) == 0.0);
  CHECK(misfit(4.0, true, 1) > 1.0);
  CHECK(misfit(4.0, false, 1) == 0.0);
  CHECK(misfit(4.0, true, 0) == 0.0);  // the same tick again and again
  CHECK(misfit(4.0, true, 2) == 0.0);  // each second one was missed
  Standing arm;
  arm.arm().measured_torque_nm = arm.model.gravity_nm(arm.arm().q_rad);
  arm.observe_for(60);
  arm.arm().measured_torque_nm[0] *= -1.0;
  REQUIRE(std::abs(arm.arm().measured_torque_nm[0]) > 2.0);
  CHECK(arm.observe_for(20).reversed_joint == 0);
}

TEST_CASE("a drive that measures another torque than it was told is blamed, whatever moves") {
  const auto blamed = [](double felt_n, double misfit) {
    Scene scene;
    scene.force_n = felt_n;
    scene.tick(10);
    scene.seen.drive_misfit = misfit;
    return scene.tick();
  };
  CHECK(Observation{}.drive_misfit == 0.0);
  for (const double felt_n : {4.99, 5.01}) {
    CHECK(blamed(felt_n, 1.0).action == Action::pass);
    CHECK(blamed(felt_n, 1.001).action == (felt_n < 5.0 ? Action::brake : Action::comply));
    CHECK(blamed(felt_n, 1.001).cause == Cause::drive_amiss);
    CHECK(blamed(felt_n, 1.001).latched);
  }
  Scene scene;  // one that has come off a person is braked on its way back only
  scene.tick(10);
  scene.seen.drive_misfit = 2.0;
  scene.tick();
  scene.force_n = 0.0;
  CHECK(scene.tick(200).action == Action::comply);
  // Told nothing, a drive gives what it is told, and is no better for that.
  scene.seen.drive_misfit = 0.0;
  CHECK(scene.tick(200).action == Action::comply);
  scene.seen.tool_velocity_m_per_s = -0.06 * scene.normal();
  CHECK(scene.tick(5).action == Action::comply);
  CHECK(scene.tick().action == Action::brake);
  for (const Cause cause : {Cause::asked_to, Cause::no_proposal}) {
    Scene other;
    other.force_n = 0.0;
    other.proposal.phase = Phase::free;
    other.tick(10);
    other.guard.stop(Action::comply, cause);
    other.seen.tool_velocity_m_per_s = -0.06 * other.normal();
    CHECK(other.tick(20).action == Action::comply);
  }
}

TEST_CASE("a drive that turns the other way is told nothing once it is not believed") {
  for (const double misfit : {0.9, 1.0, 1.001}) {
    for (const int joint : {-1, 0, 4}) {
      Scene scene;
      scene.tick(10);
      scene.comply();
      scene.seen.drive_misfit = misfit;
      scene.seen.reversed_joint = joint;
      JointVector expected_nm = scene.seen.gravity_nm;
      if (joint >= 0 && misfit > 1.0) expected_nm[joint] = 0.0;
      CHECK((scene.tick().allowed_nm - expected_nm).cwiseAbs().maxCoeff() < 1e-9);
    }
  }
  CHECK(Observation{}.reversed_joint == -1);
}
