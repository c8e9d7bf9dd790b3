// SPDX-License-Identifier: Apache-2.0
// What a guard sees of an arm, by a model and a zero of its own.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/safety/scene.hpp"
#include "tests/safety/two_arms.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// The balance of momentum of an arm once more, joint by joint.
struct Balance {
  const robot::ArmModel& model;
  bool begun = false, driven = false;
  std::uint64_t tick = 0;
  std::array<double, 6> dq = {}, lagged_nm = {}, ahead = {}, back = {}, wrench = {};
  /// Lagged torque and unexplained momentum of each joint, one for each time.
  std::array<std::vector<double>, 6> torques_nm = {}, sums_nms = {};
  double misfit = 0.0;
  int weak_joint = -1;
  std::array<double, 6> unexplained_nm = {};

  void feel(const std::array<double, 6>& felt) {
    for (const double value : felt)
      if (!std::isfinite(value)) return;
    for (std::size_t k = 0; k < 6; ++k) {
      const double most = k < 3 ? 10.0 : 1.0;
      wrench[k] = begun ? std::clamp(felt[k], wrench[k] - most, wrench[k] + most) : felt[k];
    }
  }
  /// Greatest rise within the last 16 steps of what is `sign` times these values.
  static double rise(const std::vector<double>& values, double sign) {
    double greatest = 0.0;
    const std::size_t first = values.size() > 17 ? values.size() - 17 : 0;
    for (std::size_t from = first; from < values.size(); ++from)
      for (std::size_t to = from; to < values.size(); ++to)
        greatest = std::max(greatest, sign * (values[to] - values[from]));
    return greatest;
  }
  void take(const robot::ArmReading& arm, std::uint64_t now, const Vector3& force_n,
            const JointVector& applied_nm, double share) {
    const auto dynamics = model.evaluate(arm.q_rad, arm.dq_rad_per_s, 0.0);
    const Vector3 torque_nm = dynamics.base_from_tool.linear() * arm.wrench_in_tool.torque_nm;
    feel({force_n.x(), force_n.y(), force_n.z(), torque_nm.x(), torque_nm.y(), torque_nm.z()});
    const auto passed = now - tick;
    const double passed_s = passed > 10 ? 10e-3 : 1e-3 * static_cast<double>(passed);
    tick = now;
    std::array<double, 6> gained = {};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; begun && j < 6; ++j)
        gained[std::size_t(i)] +=
            dynamics.mass_kg_m2(i, j) * (arm.dq_rad_per_s[j] - dq[std::size_t(j)]);
    for (int i = 0; i < 6; ++i) dq[std::size_t(i)] = arm.dq_rad_per_s[i];
    begun = true;
    if (applied_nm.size() != 6) return;
    std::array<double, 6> shares = {};
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const robot::Link& link = model.table().links[k];
      if (!driven) lagged_nm[k] = applied_nm[i], torques_nm[k] = {applied_nm[i]}, sums_nms[k] = {0};
      lagged_nm[k] += (applied_nm[i] - lagged_nm[k]) / 3.0;  // 1 ms of 1 ms and 2 ms
      torques_nm[k].push_back(lagged_nm[k]);
      double nm = lagged_nm[k] - dynamics.coriolis_nm[i] - dynamics.gravity_nm[i];
      for (int row = 0; row < 6; ++row) nm += dynamics.jacobian(row, i) * wrench[std::size_t(row)];
      const double missing = passed_s * nm - gained[k];
      sums_nms[k].push_back(sums_nms[k].back() + missing);
      if (passed > 0) unexplained_nm[k] = missing / passed_s;
      const double friction_nm =
          link.coulomb_nm + link.viscous_nm_s_per_rad * std::abs(arm.dq_rad_per_s[i]);
      const double allowed = passed_s * (1.5 * friction_nm + share * link.torque_limit_nm);
      ahead[k] = std::max(0.0, ahead[k] + missing - allowed);
      back[k] = std::max(0.0, back[k] - missing - allowed);
      if (arm.q_rad[i] < link.min_rad + 0.02 || arm.q_rad[i] > link.max_rad - 0.02)
        ahead[k] = back[k] = 0.0;
      const double raised = rise(torques_nm[k], 1.0), lowered = rise(torques_nm[k], -1.0);
      const double borne = 0.05 * dynamics.mass_kg_m2(i, i) + 0.25e-3 * link.torque_limit_nm +
                           2.0 * std::min(rise(sums_nms[k], 1.0), rise(sums_nms[k], -1.0)) +
                           1e-3 * std::max(raised, lowered);
      const double moved_kg_m2 = dynamics.mass_kg_m2(i, i) - link.rotor_inertia_kg_m2;
      const double ahead_s = std::min(4e-3 * moved_kg_m2 / link.rotor_inertia_kg_m2, 16e-3);
      shares[k] =
          std::max(ahead[k] / (borne + ahead_s * lowered), back[k] / (borne + ahead_s * raised));
    }
    driven = true;
    const auto worst = static_cast<std::size_t>(
        std::distance(shares.begin(), std::max_element(shares.begin(), shares.end())));
    misfit = shares[worst];
    bool alone = (lagged_nm[worst] > 0.0 ? ahead : back)[worst] > 0.0;
    for (std::size_t k = 0; k < 6; ++k) alone = alone && (k == worst || misfit > 2.0 * shares[k]);
    weak_joint = alone ? static_cast<int>(worst) : -1;
  }
};

}  // namespace

TEST_CASE("an arm is seen where its own model says, with the weight of the tool taken off") {
  Standing arm;
  arm.arm().dq_rad_per_s = JointVector::LinSpaced(6, -0.2, 0.3);
  arm.pushed_n = {3.0, -5.0, 20.0};
  arm.reading.tick = 41;
  const Observation seen = arm.observe();
  const auto dynamics = arm.model.evaluate(bent(), arm.arm().dq_rad_per_s, 0.0);
  CHECK(seen.tick == 42);
  CHECK(seen.time_s == arm.reading.time_s);
  CHECK(seen.wrench_time_s == arm.arm().wrench_time_s);
  CHECK(seen.q_rad == bent());
  CHECK(seen.dq_rad_per_s == arm.arm().dq_rad_per_s);
  CHECK((seen.force_in_base_n - arm.pushed_n).norm() < 0.01);
  CHECK(seen.tool_in_base == dynamics.base_from_tool.translation());
  CHECK(seen.jacobian == dynamics.jacobian.topRows<3>());
  CHECK((seen.tool_velocity_m_per_s - seen.jacobian * seen.dq_rad_per_s).norm() < 1e-12);
  CHECK(seen.gravity_nm == dynamics.gravity_nm);
  CHECK(seen.mass_kg_m2 == dynamics.mass_kg_m2);
  CHECK((seen.tip_in_base - seen.tool_in_base - 17e-3 * dynamics.base_from_tool.linear().col(0))
            .norm() < 1e-12);
  CHECK(seen.skin == nullptr);
}

TEST_CASE("an arm on a linear base is where the base has brought it") {
  Standing arm;
  const Vector3 before = arm.observe().tool_in_base;
  arm.reading.rail_m = 0.2;
  CHECK((arm.observe().tool_in_base - before - 0.2 * Vector3::UnitX()).norm() < 1e-12);
}

TEST_CASE("joints of another number are passed on as they are") {
  for (const Eigen::Index joints : {5, 7}) {
    for (const bool speeds : {false, true}) {
      Standing arm;
      (speeds ? arm.arm().dq_rad_per_s : arm.arm().q_rad).setZero(joints);
      const Observation seen = arm.watch.observe(arm.reading, Arm::left, {}, JointVector::Zero(6));
      CHECK(seen.q_rad.size() + seen.dq_rad_per_s.size() == 6 + joints);
      CHECK(seen.jacobian.cols() == 0);
    }
    Standing arm;  // torques of other joints are none
    arm.observe_for(5);
    CHECK(arm.watch.observe(arm.reading, Arm::left, {}, JointVector::Constant(joints, 1e6))
              .torque_misfit == 0.0);
  }
}

TEST_CASE("a wrist that says NaN is seen to, be it in its forces or its torques") {
  for (const bool of_torques : {false, true}) {
    Standing arm;
    arm.pushed_n = {0.0, 0.0, 5.0};
    arm.observe_for(50);
    auto& wrench = arm.arm().wrench_in_tool;
    (of_torques ? wrench.torque_nm : wrench.force_n).y() = not_a_number;
    CHECK_FALSE(arm.look().force_in_base_n.allFinite());
    arm.observe_for(50, Phase::approach);  // which is zeroed by what it felt before
    CHECK(arm.observe().force_in_base_n.allFinite());
  }
}

TEST_CASE("the milliseconds between two readings that came are watched too") {
  Standing arm;
  arm.pushed_n = {0.0, 0.0, 9.0};
  for (int i = 0; i < 6000; ++i) {
    arm.reading.tick += 9;
    arm.observe();
  }
  CHECK(arm.observe(Phase::approach).force_in_base_n.z() ==
        doctest::Approx(9.0 - 3.0 - 1.0).epsilon(1e-3));
}

TEST_CASE("the zero is what was felt in the last tenth of a second, not one sample") {
  Standing arm;
  arm.observe_for(1000);
  arm.pushed_n = {0.0, 0.0, 2.0};
  CHECK(arm.observe(Phase::approach).force_in_base_n.z() == doctest::Approx(0.99 * 2.0));
  Standing slow;
  slow.observe_for(1000);
  slow.pushed_n = {0.0, 0.0, 2.0};
  slow.observe_for(99);
  CHECK(slow.observe(Phase::approach).force_in_base_n.z() ==
        doctest::Approx(2.0 * std::pow(0.99, 100)));
  Standing first;  // the first sample is all that is known
  first.pushed_n = {0.0, 0.0, 2.0};
  CHECK(first.observe(Phase::approach).force_in_base_n.norm() < 1e-9);
}

TEST_CASE(
    "a first reading repeats none and blames no drive, be the wrist at nothing to the last bit") {
  Standing arm;
  const Observation seen = arm.look();
  CHECK(seen.wrist_repeats == 0);
  CHECK(seen.weak_joint == -1);
  CHECK(seen.torque_misfit == 0.0);
}

TEST_CASE("samples of the wrist that repeat the one before are counted, the same sent again not") {
  Standing arm;
  CHECK(arm.observe().wrist_repeats == 0);
  CHECK(arm.observe_for(5).wrist_repeats == 5);
  arm.pushed_n.x() += 1e-9;
  CHECK(arm.observe().wrist_repeats == 0);
  CHECK(arm.observe_for(3).wrist_repeats == 3);
  arm.arm().wrench_in_tool.torque_nm.z() += 1e-12;
  CHECK(arm.look().wrist_repeats == 0);
  for (int ms = 0; ms < 3; ++ms) {  // with an old stamp
    arm.reading.tick += 1;
    CHECK(arm.watch.observe(arm.reading, Arm::left, {}, {}).wrist_repeats == 0);
  }
  arm.pushed_n.setZero();
  arm.observe();
  arm.arm().dq_rad_per_s.setConstant(0.1);  // it may move meanwhile
  for (int ms = 0; ms < 20; ++ms) arm.look();
  CHECK(arm.look().wrist_repeats == 21);
  arm.reading.time_s -= 1.0;  // a clock that was set back
  CHECK(arm.look().wrist_repeats == 22);
}

TEST_CASE("the misfit is the balance of momentum, and of whom it complains, whatever comes") {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  const auto one_in = [&](int n) { return between(0.0, 1.0) * n < 1.0; };
  int blamed = 0, sound = 0;
  for (int arm = 0; arm < 20; ++arm) {
    robot::ArmTable table = six_joint_arm();
    // Of some arms nobody has said what their rotors are.
    for (robot::Link& one : table.links)
      if (arm % 2 == 0) one.rotor_inertia_kg_m2 = 0.0;
    Standing standing(table);
    Balance balance{standing.model};
    robot::ArmReading& raw = standing.arm();
    const robot::Link& link = standing.model.table().links[3];
    for (int ms = 0; ms < 200; ++ms) {
      standing.reading.tick += one_in(30) ? 3U : one_in(60) ? 40U : one_in(60) ? 0U : 1U;
      raw.q_rad = bent();
      if (one_in(20)) raw.q_rad[3] = link.max_rad - between(0.0, 0.04);
      if (one_in(20)) raw.q_rad[3] = link.min_rad + between(0.0, 0.04);
      for (int i = 0; i < 6; ++i) raw.dq_rad_per_s[i] += between(-0.01, 0.01);
      const double wild = one_in(10) || ms == 0 ? 20.0 : 1.0;
      for (int i = 0; i < 3; ++i) {
        raw.wrench_in_tool.force_n[i] = wild * between(-20.0, 20.0);
        raw.wrench_in_tool.torque_nm[i] = wild * between(-2.0, 2.0);
      }
      if (one_in(30)) raw.wrench_in_tool.torque_nm.z() = not_a_number;
      const auto dynamics = standing.model.evaluate(raw.q_rad, raw.dq_rad_per_s, 0.0);
      JointVector applied_nm = dynamics.gravity_nm + dynamics.coriolis_nm;
      for (int i = 0; i < 6; ++i)
        if (one_in(3)) applied_nm[i] += between(-0.3, 0.3) * link.torque_limit_nm;
      if (ms == 0 || one_in(50)) applied_nm.resize(0);
      const bool led = one_in(2);
      const Observation seen = standing.watch.observe(
          standing.reading, Arm::left, {.stiffness_n_per_m = led ? 0.0 : 500.0}, applied_nm);
      balance.take(raw, standing.reading.tick, seen.force_in_base_n, applied_nm, led ? 0.1 : 0.04);
      CHECK(seen.torque_misfit == doctest::Approx(balance.misfit).epsilon(1e-9));
      CHECK(seen.weak_joint == balance.weak_joint);
      CHECK((seen.unexplained_nm.size() > 0) == balance.driven);
      for (int i = 0; i < 6 && balance.driven; ++i) {
        const double nm = balance.unexplained_nm[static_cast<std::size_t>(i)];
        CHECK(seen.unexplained_nm[i] == doctest::Approx(nm).epsilon(1e-6));
      }
      (balance.weak_joint >= 0 ? blamed : sound) += 1;
    }
  }
  CHECK(blamed > 400);
  CHECK(sound > 400);
}

TEST_CASE(
    "a gear that rings after a step of torque is no fault, a drive that does not give the step "
    "is") {
  constexpr double swings_hz = 160.0, damping_ratio = 0.05, rate = 2.0 * pi * swings_hz;
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    for (const bool given : {true, false}) {
      Standing arm;
      (void)arm.observe_for(50);
      const double step_nm = 0.8 * arm.model.table().torque_limits_nm()[joint];
      const auto mass = arm.model.evaluate(arm.arm().q_rad, JointVector::Zero(6), 0.0).mass_kg_m2;
      JointVector momentum = JointVector::Zero(6);
      double seen_nms = 0.0, max_misfit = 0.0;
      int ms = 0;
      for (; ms < 30 && max_misfit < 1.0; ++ms) {
        const double t = 1e-3 * ms;
        const double swung = std::exp(-damping_ratio * rate * t) * std::sin(rate * t) / rate;
        seen_nms += (step_nm * (t - swung) - seen_nms) / 3.0;  // speeds are filtered
        momentum[joint] = given ? seen_nms : 0.0;
        arm.arm().dq_rad_per_s = mass.llt().solve(momentum);
        arm.extra_nm[joint] = step_nm;
        max_misfit = std::max(max_misfit, arm.observe().torque_misfit);
      }
      INFO("joint ", joint);
      if (given) CHECK(max_misfit < 1.0);
      if (!given) CHECK(ms <= 10);
    }
  }
}
