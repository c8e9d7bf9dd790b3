// SPDX-License-Identifier: Apache-2.0
// Each limit, its number written out once more: at the limit nothing happens, above it the guard
// acts.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// Nothing is judged before the third sample, so a scene may begin with any force.
Scene pressing(double force_n, Zone zone = Zone::muscle) {
  Scene scene;
  scene.force_n = force_n;
  scene.proposal.zone = zone;
  scene.proposal.set_force_n = 0.0;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  return scene;
}

}  // namespace

TEST_CASE("the ceilings are those of docs/safety.md") {
  const std::array<ForceLimits, 7> force = {{{45.0, 60.0},
                                             {15.0, 25.0},
                                             {20.0, 30.0},
                                             {10.0, 15.0},
                                             {0.0, 10.0},
                                             {0.0, 10.0},
                                             {60.0, 90.0}}};
  REQUIRE(zones == force.size());
  for (std::size_t i = 0; i < zones; ++i) {
    CHECK(ceiling_of(static_cast<Zone>(i)).set_n == force[i].set_n);
    CHECK(ceiling_of(static_cast<Zone>(i)).trip_n == force[i].trip_n);
  }
  CHECK(ceilings.tool_speed_m_per_s == std::array<double, 4>{0.30, 0.15, 0.25, 0.30});
  CHECK(ceilings.inward_m_per_s == 0.15);
  CHECK(ceilings.pushed_out_m_per_s == 0.12);
  CHECK(ceilings.force_rate_n_per_s == 2000.0);
  CHECK(ceilings.over_cap_n == 10.0);
  CHECK(ceilings.torque_rate_nm_per_s == 1000.0);
  CHECK(ceilings.encoder_jump_rad == 5e-3);
  CHECK(ceilings.joint_speed_rad_per_s == 3.0);
  CHECK(ceilings.stale_freeze_s == 3e-3);
  CHECK(ceilings.stale_retract_s == 5e-3);
  CHECK(ceilings.pressing_n == 20.0);
  CHECK(ceilings.over_trip_n == 10.0);
  CHECK(ceilings.free_inward_n == 60.0);
}

TEST_CASE("options lower every ceiling, raise none, and what is no number or below zero is none") {
  const auto each = [](Guard::Options& options, auto&& visit) {
    for (auto& force : options.force) visit(force.set_n), visit(force.trip_n);
    for (double& speed : options.limits.tool_speed_m_per_s) visit(speed);
    Ceilings& limits = options.limits;
    for (double* limit :
         {&limits.inward_m_per_s, &limits.pushed_out_m_per_s, &limits.force_rate_n_per_s,
          &limits.over_cap_n, &limits.torque_rate_nm_per_s, &limits.encoder_jump_rad,
          &limits.joint_speed_rad_per_s, &limits.stale_freeze_s, &limits.stale_retract_s,
          &limits.pressing_n, &limits.over_trip_n, &limits.free_inward_n, &options.period_s})
      visit(*limit);
  };
  const auto as_guarded = [&](double factor, double shift) {
    Guard::Options options = six_joints();
    each(options, [&](double& limit) { limit = limit * factor + shift; });
    options = Guard(options).options();
    std::vector<double> limits;
    each(options, [&](double limit) { limits.push_back(limit); });
    return limits;
  };
  const std::vector<double> compiled = as_guarded(1.0, 0.0);
  CHECK(as_guarded(1.01, 1e-6) == compiled);
  CHECK(as_guarded(0.0, infinity) == compiled);
  CHECK(as_guarded(0.0, not_a_number) == compiled);
  CHECK(as_guarded(0.0, -100.0) == std::vector<double>(compiled.size(), 0.0));
  const std::vector<double> lower = as_guarded(0.99, 0.0);
  for (std::size_t i = 0; i < compiled.size(); ++i) {
    CHECK(lower[i] <= 0.99 * compiled[i]);
    CHECK(lower[i] >= 0.98 * compiled[i]);
  }
}

TEST_CASE("a set force that is lowered lowers its trip by as much") {
  const std::array<double, 7> trip_n = {20.0, 15.0, 15.0, 10.0, 10.0, 10.0, 35.0};
  Guard::Options options = six_joints();
  for (ForceLimits& limits : options.force) limits.set_n = std::min(limits.set_n, 5.0);
  const Guard guard(options);
  for (std::size_t i = 0; i < zones; ++i) CHECK(guard.options().force[i].trip_n == trip_n[i]);
  options.force[0].trip_n = 12.0;
  CHECK(Guard(options).options().force[0].trip_n == 12.0);
  // So much is borne and no more.
  for (const double force_n : {15.0, 20.001}) {
    Scene scene(options);
    scene.proposal.zone = Zone::bench;
    scene.proposal.set_force_n = 5.0;
    scene.force_n = force_n + 15.0;
    CHECK((scene.tick(3).cause == Cause::force_over_trip) == (force_n > 20.0));
  }
}

TEST_CASE("a period or a torque limit that is no number lets nothing sudden or large out") {
  for (const double bad : {not_a_number, infinity, 1.0}) {
    Guard::Options options = six_joints();
    options.period_s = bad;
    Scene scene(options);
    scene.tick(10);
    const double before_nm = scene.verdict.allowed_nm[4];
    scene.proposal.torque_nm[4] -= 45.0;
    CHECK(scene.tick().allowed_nm[4] == doctest::Approx(before_nm - 1.0));
    CHECK(scene.verdict.cause == Cause::torque_rate_clamped);
  }
  for (const double bad : {not_a_number, infinity, -infinity, -50.0}) {
    Guard::Options options = six_joints();
    options.torque_limit_nm[2] = bad;
    CHECK(Guard(options).options().torque_limit_nm[2] == 0.0);
    Scene scene(options);
    scene.proposal.torque_nm[2] = 30.0;
    CHECK(scene.tick(99).allowed_nm[2] == 0.0);
    CHECK(scene.tick().cause == Cause::torque_saturated);
    CHECK(scene.tick(10).allowed_nm[2] == 0.0);
  }
}

TEST_CASE("what nobody has filled in asks for nothing and allows nothing") {
  CHECK(Observation{}.tick == 0);
  CHECK(Observation{}.time_s == 0.0);
  CHECK(Observation{}.wrench_time_s == 0.0);
  CHECK(Proposal{}.phase == Phase::free);
  CHECK(Proposal{}.zone == Zone::denied);
  CHECK(Proposal{}.set_force_n == 0.0);
  CHECK(Proposal{}.stiffness_n_per_m == 0.0);
  CHECK(Proposal{}.age_ticks == 0);
  CHECK(Observation{}.torque_misfit == 0.0);
  CHECK(Observation{}.zero_jump_n == 0.0);
  CHECK(Verdict{}.action == Action::pass);
  CHECK(Verdict{}.cause == Cause::none);
  CHECK_FALSE(Verdict{}.latched);
}

TEST_CASE("actions, causes and zones have names of their own") {
  CHECK(std::string(name_of(Action::brake)) == "brake");
  CHECK(std::string(name_of(Cause::not_as_planned)) == "does not stand as planned");
  CHECK(std::string(name_of(Cause::force_over_trip)) == "force over the trip");
  CHECK(std::string(name_of(Cause::no_proposal)) == "controller is silent");
  CHECK(std::string(name_of(Zone::bench)) == "bench");
  std::set<std::string> names;
  for (int cause = 0; cause <= static_cast<int>(Cause::guard_silent); ++cause)
    names.insert(name_of(static_cast<Cause>(cause)));
  CHECK(names.size() == 37);
}

TEST_CASE("nothing wrong passes in every zone and phase, up to what may be asked for there") {
  for (std::size_t zone = 0; zone < zones; ++zone) {
    for (int phase = 0; phase < 4; ++phase) {
      const ForceLimits limits = force_ceilings[zone];
      Scene scene =
          pressing(std::min(limits.set_n + 9.0, limits.trip_n - 0.1), static_cast<Zone>(zone));
      scene.proposal.phase = static_cast<Phase>(phase);
      scene.proposal.set_force_n = limits.set_n;
      CHECK(scene.tick(150).action == Action::pass);
    }
  }
}

TEST_CASE("the trip of each zone is borne, more retracts at once") {
  for (std::size_t zone = 0; zone < zones; ++zone) {
    const double trip_n = force_ceilings[zone].trip_n;
    CHECK(pressing(trip_n, static_cast<Zone>(zone)).tick(3).action == Action::pass);
    CHECK(pressing(trip_n + 0.001, static_cast<Zone>(zone)).tick(2).action == Action::pass);
    const Verdict verdict = pressing(trip_n + 0.001, static_cast<Zone>(zone)).tick(3);
    CHECK(verdict.action == Action::retract);
    CHECK(verdict.latched);
    CHECK(verdict.cause == Cause::force_over_trip);
  }
}

TEST_CASE("it is the median of three samples that counts") {
  for (const double middle_n : {59.9, 60.1}) {
    std::array<double, 3> samples_n = {50.0, middle_n, 70.0};
    do {
      Scene scene = pressing(50.0);
      scene.tick(3);
      for (const double sample_n : samples_n) scene.force_n = sample_n, scene.tick();
      CHECK((scene.verdict.action == Action::retract) == (middle_n > 60.0));
    } while (std::next_permutation(samples_n.begin(), samples_n.end()));
  }
}

TEST_CASE("ten newton over the ceiling are borne for ever, more for a tenth of a second") {
  CHECK(pressing(55.0).tick(200).action == Action::pass);
  Scene scene = pressing(55.001);
  scene.tick(2);
  CHECK(scene.ticks_until_it_acts() == 99);
  CHECK(scene.verdict.action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_over_cap);
  CHECK(scene.verdict.latched);
  Scene twice = pressing(55.001);
  CHECK(twice.tick(100).action == Action::pass);
  twice.force_n = 54.0;
  CHECK(twice.tick(3).action == Action::pass);
  twice.force_n = 55.001;
  twice.tick();  // the median takes a second sample
  CHECK(twice.ticks_until_it_acts() == 99);
}

TEST_CASE(
    "a force that rises by 2000 N/s is followed, one that rises faster ends the contact in seven "
    "milliseconds") {
  const auto rising = [](double step_n) {
    Scene scene = pressing(0.0);
    scene.tick(20);
    int ticks = 0;
    for (; ticks < 25 && scene.verdict.action < Action::freeze; ++ticks)
      scene.force_n += step_n, scene.tick();
    CHECK((scene.verdict.cause == Cause::force_rising) ==
          (scene.verdict.action == Action::retract));
    CHECK(scene.verdict.latched == (scene.verdict.action == Action::retract));
    return ticks;
  };
  CHECK(rising(2.0) == 25);
  CHECK(rising(1.99) == 25);
  // The median is a millisecond late, five steps of it are judged, and three judgements must agree.
  CHECK(rising(2.01) == 8);
  CHECK(rising(3.0) == 7);
  CHECK(rising(6.0) == 5);
}

TEST_CASE("a rise of two milliseconds is forgotten") {
  Scene scene = pressing(0.0);
  scene.tick(20);
  for (int rise = 0; rise < 3; ++rise) {
    for (const double step_n : {4.0, 4.0, 3.0}) scene.force_n += step_n, scene.tick();
    scene.force_n -= 9.0;
    CHECK(scene.tick().action == Action::pass);
    CHECK(scene.tick(6).action == Action::pass);
  }
}

TEST_CASE("each phase has its speed, and noise of two milliseconds is not speed") {
  const std::array<double, 4> limit_m_per_s = {0.30, 0.15, 0.25, 0.30};
  for (std::size_t phase = 0; phase < 4; ++phase) {
    Scene scene;
    scene.proposal.phase = static_cast<Phase>(phase);
    scene.seen.tool_velocity_m_per_s = {limit_m_per_s[phase], 0.0, 0.0};
    CHECK(scene.proposal.normal_in_base.x() * limit_m_per_s[phase] <= 0.12);  // no person gets up
    CHECK(scene.tick(100).action == Action::pass);
    for (int i = 0; i < 3; ++i) {
      scene.seen.tool_velocity_m_per_s = {1.001 * limit_m_per_s[phase], 0.0, 0.0};
      CHECK(scene.tick(2).action == Action::pass);
      scene.seen.tool_velocity_m_per_s.setZero();
      CHECK(scene.tick().action == Action::pass);
    }
    scene.seen.tool_velocity_m_per_s = {-1.001 * limit_m_per_s[phase], 0.0, 0.0};
    CHECK(scene.ticks_until_it_acts() == 2);
    CHECK(scene.verdict.action == Action::comply);
    CHECK(scene.verdict.cause == Cause::tool_too_fast);
  }
}

TEST_CASE(
    "a guard counts from nothing: what lasts one tick less than it may is borne from the first") {
  Scene repeated;
  repeated.tick();
  for (int again = 0; again < 2; ++again) {
    repeated.seen.tick -= 1;
    repeated.tick_at(repeated.seen.time_s);
  }
  CHECK_FALSE(repeated.verdict.latched);
  repeated.seen.tick -= 1;
  CHECK(repeated.tick_at(repeated.seen.time_s).latched);
  Scene clock;
  clock.tick();
  CHECK(clock.tick_at(clock.seen.time_s).action == Action::pass);
  CHECK(clock.tick_at(clock.seen.time_s).action == Action::pass);
  CHECK(clock.tick_at(clock.seen.time_s).cause == Cause::clock);
  Scene inward;
  inward.force_n = inward.proposal.set_force_n = 0.0;
  inward.proposal.virtual_target_in_base = inward.seen.tool_in_base;
  inward.pull(-29.0 * inward.normal());
  CHECK(inward.ticks_until_it_acts() == 99);
  CHECK(inward.verdict.cause == Cause::inward_force);
}
