// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <map>
#include <string>

#include "tests/safety/oracle.hpp"
#include "tests/safety/scene.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// A number of any bits, or one of those that are hard to handle.
double wild(Random& random) {
  const std::array hard = {not_a_number, infinity, -infinity, 0.0, 1e308, -1e308, 1e-320};
  if (random() % 2 == 0) return hard[random() % hard.size()];
  return std::bit_cast<double>(random());
}

/// One input that is nonsense.
void spoil(Scene& scene, Random& random) {
  const auto joint = static_cast<Eigen::Index>(random() % 6);
  Observation& seen = scene.seen;
  Proposal& proposal = scene.proposal;
  const std::array numbers = {&seen.q_rad[joint],
                              &seen.dq_rad_per_s[joint],
                              &seen.force_in_base_n[joint % 3],
                              &seen.time_s,
                              &seen.wrench_time_s,
                              &seen.tool_velocity_m_per_s[joint % 3],
                              &seen.tool_in_base[joint % 3],
                              &seen.torque_misfit,
                              &proposal.torque_nm[joint],
                              &proposal.normal_in_base[joint % 3],
                              &proposal.virtual_target_in_base[joint % 3],
                              &proposal.stiffness_n_per_m,
                              &proposal.set_force_n};
  const std::size_t what = random() % (numbers.size() + 6);
  if (what < numbers.size()) {
    *numbers[what] = wild(random);
    return;
  }
  switch (what - numbers.size()) {
    case 0:
      seen.tick = random();
      return;
    case 1:
      proposal.zone = static_cast<Zone>(random());
      return;
    case 2:
      proposal.phase = static_cast<Phase>(random());
      return;
    case 3:
      seen.gravity_nm[joint] = not_a_number;
      return;
    case 4:
      seen.jacobian(joint % 3, joint) = not_a_number;
      return;
    default:
      proposal.torque_nm = JointVector::Zero(static_cast<Eigen::Index>(random() % 8));
  }
}

/// A sequence of milliseconds that a session could see: the arm wanders, the force too, ticks are
/// late now and then.
struct Sequence {
  Scene scene;
  Random& random;
  ZoneField::Cell skin;
  double force_n = uniform(random, 0.0, 40.0);

  explicit Sequence(Random& of) : random(of) {
    skin = {Zone::muscle, scene.normal().cast<float>()};
    scene.seen.skin = &skin;
  }

  void next() {
    Observation& seen = scene.seen;
    const int missed = random() % 40 == 0 ? static_cast<int>(random() % 8) : 0;
    scene.miss(missed);
    seen.tick += 1;
    seen.time_s += 1e-3;
    if (random() % 30 != 0) seen.wrench_time_s = seen.time_s;
    force_n = std::max(0.0, force_n + gaussian(random, 1.0));
    seen.force_in_base_n = (random() % 100 == 0 ? 10.0 : 1.0) * force_n * scene.normal();
    for (Eigen::Index joint = 0; joint < 6; ++joint) {
      seen.dq_rad_per_s[joint] = gaussian(random, 0.4);
      seen.q_rad[joint] += 1e-3 * seen.dq_rad_per_s[joint] + gaussian(random, 0.25e-3);
      scene.proposal.torque_nm[joint] = seen.gravity_nm[joint] + gaussian(random, 0.25);
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      seen.tool_velocity_m_per_s[axis] = gaussian(random, 0.06);
      seen.tool_in_base[axis] += 1e-3 * seen.tool_velocity_m_per_s[axis];
    }
    scene.proposal.virtual_target_in_base =
        seen.tool_in_base - uniform(random, 0.0, 0.05) * scene.normal();
    if (random() % 50 == 0) scene.pull(-uniform(random, 0.0, 1000.0) * scene.normal());
  }
};

}  // namespace

TEST_CASE(
    "whatever comes in, what goes out is finite, within limits, not sudden, and no stop ends by "
    "itself") {
  Random random = make_random(11, "guard");
  std::map<Action, int> seen;
  for (int run = 0; run < 150; ++run) {
    Sequence sequence(random);
    Oracle oracle;
    const int length = 20 + static_cast<int>(random() % 150);
    for (int i = 0; i < length; ++i) {
      sequence.next();
      Scene input = sequence.scene;
      // Half of the runs end in nonsense.
      if (run % 2 == 0 && i > length / 2 && random() % 10 == 0) spoil(input, random);
      const Verdict verdict = sequence.scene.guard.check(input.seen, input.proposal);
      ++seen[verdict.action];
      if (const char* fault = oracle.judge(input.seen, input.proposal, verdict)) {
        CAPTURE(run);
        CAPTURE(i);
        FAIL(fault);
      }
    }
  }
  // Every action is met often enough for this to say something of it.
  for (const Action action :
       {Action::pass, Action::warn, Action::freeze, Action::comply, Action::retract}) {
    CAPTURE(std::string(name_of(action)));
    CAPTURE(seen[action]);
    CHECK(seen[action] > 150);
  }
  CHECK(seen[Action::brake] > 150);
}
