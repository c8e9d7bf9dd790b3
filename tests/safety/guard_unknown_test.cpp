// SPDX-License-Identifier: Apache-2.0
// An arm of which nothing is known any more, while it presses somebody.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

constexpr int push_ticks = 60;
constexpr double push_n = 40.0;

/// What an arm is told that pressed with `felt_n` until its second encoder went blind.
struct Blind : Scene {
  JointVector gravity_nm;

  explicit Blind(double felt_n = 20.0) {
    force_n = felt_n;
    tick(10);
    gravity_nm = seen.gravity_nm;
    lose();
  }
  void lose() { seen.q_rad[1] = not_a_number; }
  void find() { seen.q_rad = standing_arm().q_rad; }
  /// By the levers that were known, whatever is told now.
  [[nodiscard]] Vector3 pushed_n() const {
    return (verdict.allowed_nm - gravity_nm).head<3>() / 0.2;
  }
};

}  // namespace

TEST_CASE("an arm that pressed and is unknown is pushed off the skin for 60 ms, then braked") {
  Blind blind;
  blind.seen.gravity_nm.array() += 5.0;  // of unknown joints nothing is believed
  blind.seen.jacobian *= -1.0;
  for (int ms = 0; ms < push_ticks; ++ms) {
    CHECK(blind.tick().action == Action::retract);
    CHECK(blind.verdict.cause == Cause::state_not_finite);
    CHECK(blind.verdict.latched);
    check_same(blind.pushed_n(), push_n * blind.normal());
  }
  for (int ms = 0; ms < 100; ++ms) {
    CHECK(blind.tick().action == Action::brake);
    check_same(blind.pushed_n(), Vector3::Zero());
  }
}

TEST_CASE("an arm that touches with 5 N at most is braked at once when it is unknown") {
  CHECK(Blind(4.99).tick().action == Action::brake);
  CHECK(Blind(5.01).tick().action == Action::retract);
  Scene exactly;
  exactly.face(Vector3::UnitZ());
  exactly.force_n = 5.0;
  exactly.noise_n = 0.0;
  exactly.tick(10);
  exactly.seen.q_rad[1] = not_a_number;
  CHECK(exactly.tick().action == Action::brake);
  Scene leaving;  // what was felt a moment ago does not count
  leaving.tick(10);
  leaving.force_n = 0.0;
  leaving.tick(4);
  leaving.seen.q_rad[1] = not_a_number;
  CHECK(leaving.tick().action == Action::brake);
  Scene never;
  never.seen.q_rad[1] = not_a_number;
  CHECK(never.tick().action == Action::brake);
}

TEST_CASE("milliseconds in which the joints are unknown add up, whatever lies between them") {
  Blind blind;
  blind.tick(push_ticks - 1);
  blind.find();
  CHECK(blind.tick(30).action == Action::retract);
  blind.lose();
  CHECK(blind.tick().action == Action::retract);
  CHECK(blind.tick().action == Action::brake);
}

TEST_CASE("joints that were in doubt before are no measure of the way out") {
  Scene scene;
  scene.tick(10);
  const JointVector gravity_nm = scene.seen.gravity_nm;
  scene.seen.q_rad[0] += 0.1;
  scene.tick();
  REQUIRE(scene.verdict.cause == Cause::encoder_jump);
  scene.seen.jacobian *= -1.0;
  scene.tick(5);
  scene.seen.q_rad[1] = not_a_number;
  CHECK(scene.tick(2).action == Action::retract);
  check_same((scene.verdict.allowed_nm - gravity_nm).head<3>() / 0.2, push_n * scene.normal());
}

TEST_CASE("a stop that lasts is no milder for joints that are unknown, and the push is the same") {
  Blind blind;
  blind.guard.stop(Action::retract, Cause::asked_to);
  for (int ms = 0; ms < push_ticks; ++ms) {
    CHECK(blind.tick().action == Action::retract);
    CHECK(blind.verdict.cause == Cause::asked_to);
    check_same(blind.pushed_n(), push_n * blind.normal());
  }
  CHECK(blind.tick().action == Action::brake);
}
