// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <map>

#include "tests/safety/scene.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A number of any bits, or one of those that are hard to handle.
double wild(Random& random) {
  const std::array hard = {not_a_number, infinity, -infinity, 0.0, 1e308, -1e308, 1e-320};
  if (random() % 2 == 0) return hard[random() % hard.size()];
  const std::uint64_t bits = random();
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// One input that is nonsense.
void spoil(Scene& scene, Random& random) {
  const auto joint = static_cast<Eigen::Index>(random() % 6);
  Observation& seen = scene.seen;
  Proposal& proposal = scene.proposal;
  switch (random() % 14) {
    case 0:
      seen.q_rad[joint] = wild(random);
      break;
    case 1:
      seen.dq_rad_per_s[joint] = wild(random);
      break;
    case 2:
      seen.force_in_base_n[joint % 3] = wild(random);
      break;
    case 3:
      seen.time_s = wild(random);
      break;
    case 4:
      seen.wrench_time_s = wild(random);
      break;
    case 5:
      seen.tick = random();
      break;
    case 6:
      proposal.torque_nm[joint] = wild(random);
      break;
    case 7:
      proposal.normal_in_base[joint % 3] = wild(random);
      break;
    case 8:
      proposal.virtual_target_in_base[joint % 3] = wild(random);
      break;
    case 9:
      proposal.stiffness_n_per_m = wild(random);
      break;
    case 10:
      seen.tool_velocity_m_per_s[joint % 3] = wild(random);
      break;
    case 11:
      seen.gravity_nm[joint] = wild(random);
      break;
    case 12:
      seen.jacobian(joint % 3, joint) = wild(random);
      break;
    default:
      proposal.torque_nm = JointVector::Zero(static_cast<Eigen::Index>(random() % 8));
  }
}

/// A sequence of milliseconds that a session could see: the arm wanders, the force too, ticks are
/// late now and then.
struct Sequence {
  Scene scene;
  Random& random;
  double force_n = uniform(random, 0.0, 40.0);

  explicit Sequence(Random& of) : random(of) {}

  void next() {
    Observation& seen = scene.seen;
    seen.tick += random() % 40 == 0 ? 1 + random() % 8 : 1;
    seen.time_s += 1e-3;
    if (random() % 30 != 0) seen.wrench_time_s = seen.time_s;
    force_n = std::max(0.0, force_n + gaussian(random, 1.0));
    seen.force_in_base_n = (random() % 100 == 0 ? 10.0 : 1.0) * force_n * scene.normal();
    for (Eigen::Index joint = 0; joint < 6; ++joint) {
      seen.q_rad[joint] += gaussian(random, 1.3e-3);
      scene.proposal.torque_nm[joint] = seen.gravity_nm[joint] + gaussian(random, 0.25);
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      seen.tool_velocity_m_per_s[axis] = gaussian(random, 0.07);
      seen.tool_in_base[axis] += 1e-3 * seen.tool_velocity_m_per_s[axis];
    }
    scene.proposal.virtual_target_in_base =
        seen.tool_in_base - uniform(random, 0.0, 0.05) * scene.normal();
  }
};

}  // namespace

TEST_CASE(
    "whatever comes in, what goes out is finite, within limits, not sudden, and no stop ends by "
    "itself") {
  Random random = make_random(11, "guard");
  std::map<Action, int> seen;
  for (int run = 0; run < 600; ++run) {
    Sequence sequence(random);
    Guard& guard = sequence.scene.guard;
    JointVector last_nm = sequence.scene.seen.gravity_nm;
    Verdict before;
    const int length = 20 + static_cast<int>(random() % 150);
    for (int i = 0; i < length; ++i) {
      sequence.next();
      Scene input = sequence.scene;
      // Half of the runs end in nonsense.
      if (run % 2 == 0 && i > length / 2 && random() % 10 == 0) spoil(input, random);
      const Verdict verdict = guard.check(input.seen, input.proposal);
      ++seen[verdict.action];
      REQUIRE(verdict.allowed_nm.size() == 6);
      REQUIRE(verdict.allowed_nm.allFinite());
      REQUIRE(verdict.allowed_nm.cwiseAbs().maxCoeff() <= 50.0);
      REQUIRE((verdict.allowed_nm - last_nm).cwiseAbs().maxCoeff() <= 10.0 + 1e-9);
      if (verdict.action == Action::pass) REQUIRE(verdict.allowed_nm == input.proposal.torque_nm);
      REQUIRE((verdict.action == Action::pass) == (verdict.cause == Cause::none));
      if (before.latched) {
        REQUIRE(verdict.latched);
        REQUIRE(verdict.cause == before.cause);
        REQUIRE(verdict.action >= before.action);
      }
      last_nm = verdict.allowed_nm, before = verdict;
    }
  }
  // Every action is met often enough for this to say something of it.
  for (const Action action :
       {Action::pass, Action::warn, Action::freeze, Action::comply, Action::retract}) {
    CAPTURE(std::string(name_of(action)));
    CAPTURE(seen[action]);
    CHECK(seen[action] > 1000);
  }
  CHECK(seen[Action::brake] > 100);
}
