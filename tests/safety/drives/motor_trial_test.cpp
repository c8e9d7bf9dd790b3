// SPDX-License-Identifier: Apache-2.0
// A motor that turns the other way is told from somebody who pushes.
#include "tuina/safety/motor_trial.hpp"

#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// Three joints, one of which is told something and does not move by it.
struct Missing {
  MotorTrial trial;
  int joint = 0;
  JointVector unexplained_nm = JointVector::Zero(3), told_nm = JointVector::Zero(3);

  /// After 400 ms, when all means have settled.
  Missing(int which, double told, double missing_share) : joint(which) {
    told_nm[joint] = told;
    look(missing_share * told, 400, -1);
  }
  int look(double missing, int ticks, int suspect) {
    unexplained_nm[joint] = missing;
    for (int i = 0; i < ticks; ++i) trial.look(unexplained_nm, told_nm, suspect);
    return trial.silenced_joint();
  }
  /// One millisecond with this joint to blame.
  int blame(double missing) { return look(missing, 1, joint); }
};

}  // namespace

TEST_CASE("a motor that stops when it is told nothing is told nothing any more") {
  for (const int joint : {0, 1}) {
    for (const double told : {10.0, -10.0}) {
      Missing reversed(joint, told, 2.0);
      CHECK(reversed.trial.silenced_joint() == -1);
      CHECK(reversed.blame(2.0 * told) == joint);
      // Speeds and torques need some milliseconds.
      CHECK(reversed.look(2.0 * told, 4, joint) == joint);
      CHECK(reversed.look(0.0, 6, joint) == joint);
      CHECK(reversed.look(2.0 * told, 1000, joint) == joint);
    }
  }
}

TEST_CASE("somebody goes on pushing, and gets the torque of the joint back after 10 ms") {
  for (const int joint : {0, 1}) {
    for (const double told : {10.0, -10.0}) {
      for (const bool turned : {true, false}) {
        Missing pushed(joint, told, 2.0);
        pushed.blame(2.0 * told);
        CHECK(pushed.look(2.0 * told, 9, joint) == joint);
        CHECK(pushed.blame(2.0 * told) == -1);
        for (int ms = 0; ms < 1000; ++ms)
          CHECK(pushed.blame(2.0 * told) == -1);  // a joint is tried once
        // Another one is tried on its own account.
        pushed.unexplained_nm[2] = 10.0, pushed.told_nm[2] = 5.0;
        pushed.look(2.0 * told, 400, -1);
        CHECK(pushed.look(2.0 * told, 1, 2) == 2);
        if (turned) pushed.unexplained_nm[2] = 0.0;
        CHECK(pushed.look(2.0 * told, 9, 2) == 2);
        CHECK(pushed.look(2.0 * told, 1000, 2) == (turned ? 2 : -1));
      }
    }
  }
}

TEST_CASE("only a joint that lacks 1.3 to 3 times its torque is tried") {
  for (const double told : {10.0, -10.0}) {
    for (const double share : {1.301, 2.999})
      CHECK(Missing(1, told, share).blame(share * told) == 1);
    for (const double share : {-2.0, 0.0, 1.299, 3.001, 20.0})
      CHECK(Missing(1, told, share).blame(share * told) == -1);
  }
  CHECK(Missing(1, 0.0, 0.0).blame(5.0) == -1);  // it is told nothing already
  CHECK(Missing(1, 0.0, 0.0).blame(0.0) == -1);
}

TEST_CASE("a motor has stopped when less than two fifths are missing, or the other way") {
  for (const double told : {10.0, -10.0}) {
    for (const double left_share : {-2.0, 0.399, 0.401}) {
      Missing one(1, told, 2.0);
      one.look(2.0 * told, 5, 1);
      CHECK(one.look(left_share * 2.0 * told, 6, 1) == (left_share < 0.4 ? 1 : -1));
    }
    Missing mean(1, told, 2.0);
    mean.look(2.0 * told, 5, 1);
    mean.look(0.0, 3, 1);
    CHECK(mean.look(0.7 * 2.0 * told, 3, 1) == 1);
  }
}

TEST_CASE("what is missing, and what was told, are means of ten milliseconds") {
  // 34.39 % of what is missing all at once count after four milliseconds: 1.3 times the 10 Nm.
  for (const double missing : {37.78, 37.82}) {
    Missing begins(1, 10.0, 0.0);
    CHECK(begins.look(missing, 3, 1) == -1);
    CHECK(begins.blame(missing) == (missing > 37.8 ? 1 : -1));
  }
  // 2 Nm are told instead of 10: they count as 7.25 after four milliseconds.
  for (const double missing : {9.42, 9.43}) {
    Missing told(1, 10.0, 0.1 * missing);
    told.told_nm[1] = 2.0;
    CHECK(told.look(missing, 3, 1) == -1);
    CHECK(told.blame(missing) == (missing > 9.424 ? 1 : -1));
  }
}

TEST_CASE("nothing is learnt where joints are not told of") {
  Missing reversed(1, 10.0, 2.0);
  MotorTrial new_one;
  for (int ms = 0; ms < 100; ++ms) {
    for (MotorTrial* trial : {&reversed.trial, &new_one}) {
      trial->look({}, reversed.told_nm, 1);
      trial->look(reversed.unexplained_nm, {}, 1);
      CHECK(trial->silenced_joint() == -1);
    }
  }
}

TEST_CASE(
    "the guard tries a joint to blame once it has the arm, and tells a turned motor nothing") {
  for (const int joint : {0, 4}) {
    for (const bool turned : {true, false}) {
      for (const double misfit : {1.0, 1.001}) {
        Scene scene;
        JointVector& missing_nm = scene.seen.unexplained_nm;
        missing_nm = 2.0 * scene.seen.gravity_nm;
        scene.seen.weak_joint = joint;
        scene.tick(100);
        CHECK(scene.verdict.action == Action::pass);
        scene.seen.torque_misfit = misfit;
        scene.guard.stop(Action::comply, Cause::asked_to);
        JointVector without_nm = scene.seen.gravity_nm;
        if (misfit > 1.0) without_nm[joint] = 0.0;
        CHECK((scene.tick().allowed_nm - without_nm).cwiseAbs().maxCoeff() < 1e-9);
        if (turned) missing_nm.setZero();
        scene.seen.torque_misfit = 0.0;
        CHECK((scene.tick(9).allowed_nm - without_nm).cwiseAbs().maxCoeff() < 1e-9);
        if (!turned) without_nm = scene.seen.gravity_nm;
        CHECK((scene.tick(100).allowed_nm - without_nm).cwiseAbs().maxCoeff() < 1e-9);
        // With a motor dead for good no way leads back to the person.
        scene.force_n = 0.0;
        scene.tick(5);
        scene.seen.tool_velocity_m_per_s = -0.0499 * scene.normal();
        CHECK(scene.tick(20).action == Action::comply);
        scene.seen.tool_velocity_m_per_s = -0.0501 * scene.normal();
        CHECK(scene.tick(5).action == Action::comply);
        CHECK(scene.tick().action == (turned && misfit > 1.0 ? Action::brake : Action::comply));
      }
    }
  }
  Scene sound;  // nobody is to blame, so nothing is tried
  sound.seen.unexplained_nm = 2.0 * sound.seen.gravity_nm;
  sound.tick(5);
  sound.seen.unexplained_nm.setZero();
  sound.tick(20);
  sound.comply();
  CHECK((sound.tick().allowed_nm - sound.seen.gravity_nm).cwiseAbs().maxCoeff() < 1e-9);
  Scene working;  // a trial would disturb whoever works
  working.seen.unexplained_nm = 2.0 * working.seen.gravity_nm;
  working.seen.weak_joint = 4;
  working.tick(100);
  working.seen.torque_misfit = 2.0;
  working.tick();
  CHECK(working.verdict.allowed_nm[4] == doctest::Approx(working.seen.gravity_nm[4]));
  working.tick();
  CHECK(working.verdict.allowed_nm[4] == 0.0);
  CHECK(Observation{}.unexplained_nm.size() == 0);
}
