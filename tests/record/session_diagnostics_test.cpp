// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_diagnostics.hpp"

#include <doctest/doctest.h>

#include <set>
#include <sstream>

#include "tests/record/told_session.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/event_fields.hpp"

using namespace tuina;
using record::SessionDiagnostics;
using test::tick_at;
namespace ros = telemetry::ros;
using Status = ros::DiagnosticStatus;

namespace {

const robot::RobotModel& thesis_robot() {
  static const robot::RobotModel model = robot::load_robot("thesis").value();
  return model;
}

SessionDiagnostics diagnostics_of_thesis() {
  SessionDiagnostics diagnostics(thesis_robot().name);
  diagnostics.note_place(robot::place_robot(thesis_robot(), BodyPosture::sitting));
  return diagnostics;
}

const Status& part(const ros::DiagnosticArray& all, const std::string& name) {
  for (const Status& one : all.status) {
    if (one.name == "tuina: " + name) return one;
  }
  FAIL("there is no " << name);
  return all.status.front();
}

std::string value(const Status& status, const std::string& key) {
  for (const ros::KeyValue& one : status.values) {
    if (one.key == key) return one.value;
  }
  return "";
}

/// A millisecond of arms that rest in the air, the left wrist feeling so much beside its tool.
session::Tick resting(std::uint64_t ms, double sideways_n = 0.0) {
  static const auto placement = robot::place_robot(thesis_robot(), BodyPosture::sitting);
  static const auto models = robot::both_models(placement.arm, placement.mount);
  session::Tick tick;
  tick.reading.tick = ms;
  tick.reading.time_s = 1e-3 * static_cast<double>(ms);
  for (const Arm arm : both_arms) {
    robot::ArmReading& reading = tick.reading.arms[arm];
    reading.q_rad = reading.dq_rad_per_s = JointVector::Zero(6);
    reading.wrench_time_s = tick.reading.time_s;
    const Vector3 weight_n(0.0, 0.0, -placement.arm.tool_mass_kg * gravity_m_per_s2);
    reading.wrench_in_tool.force_n =
        models[arm].base_from_tool(reading.q_rad, 0.0).linear().transpose() * weight_n;
  }
  tick.reading.arms[Arm::left].wrench_in_tool.force_n.x() += sideways_n;
  return tick;
}

}  // namespace

TEST_CASE("each part is told once a second, and in between nothing while nothing changes") {
  auto diagnostics = diagnostics_of_thesis();
  int told = 0;
  for (std::uint64_t ms = 0; ms < 5000; ++ms) {
    const auto* all = diagnostics.look(resting(ms), 0);
    if (all == nullptr) continue;
    ++told;
    CHECK(ms % 1000 == 0);
    CHECK(all->status.size() == 10);
    for (const Status& one : all->status) {
      CAPTURE(one.name);
      CHECK(one.level == Status::ok);
    }
    CHECK(part(*all, "left guard").hardware_id == thesis_robot().name);
  }
  CHECK(told == 5);
}

TEST_CASE("what a guard does is a warning, what it latches an error, of the part that it names") {
  auto diagnostics = diagnostics_of_thesis();
  REQUIRE(diagnostics.look(resting(0), 0) != nullptr);
  session::Tick tick = resting(1);
  // To clamp is a guard's daily work.
  tick.verdict.arms[Arm::right] = {.action = safety::Action::warn,
                                   .cause = safety::Cause::torque_rate_clamped};
  CHECK(diagnostics.look(tick, 0) == nullptr);
  tick.verdict.arms[Arm::right].action = safety::Action::freeze;
  tick.verdict.arms[Arm::right].cause = safety::Cause::force_stale;
  const auto* warned = diagnostics.look(tick, 0);
  REQUIRE(warned != nullptr);
  CHECK(part(*warned, "right guard").level == Status::warn);
  CHECK(value(part(*warned, "right guard"), "clamped_ms") == "1");
  CHECK(part(*warned, "right guard").message == "freeze: force sensor stale");
  CHECK(part(*warned, "right wrist sensor").level == Status::warn);
  CHECK(part(*warned, "right arm").level == Status::ok);
  CHECK(part(*warned, "left guard").level == Status::ok);
  // A guard that comes and goes a hundred times in a second is told once more in it, not
  // hundredfold.
  int told = 0;
  for (std::uint64_t ms = 2; ms < 1000; ++ms)
    told += diagnostics.look(ms % 10 == 0 ? tick : resting(ms), 0) != nullptr ? 1 : 0;
  CHECK(told <= 1);

  tick = resting(1000);
  tick.verdict.arms[Arm::left] = {
      .action = safety::Action::brake, .cause = safety::Cause::drive_amiss, .latched = true};
  tick.stopped = {.time_s = 1.0, .arm = Arm::left, .cause = safety::Cause::drive_amiss};
  const auto* stopped = diagnostics.look(tick, 0);
  REQUIRE(stopped != nullptr);
  CHECK(part(*stopped, "left guard").level == Status::error);
  CHECK(part(*stopped, "left arm").level == Status::error);
  CHECK(part(*stopped, "session").level == Status::error);
  CHECK(part(*stopped, "session").message == "stopped: " + session::explain(*tick.stopped).words);
}

TEST_CASE("a wrist that drifts by more than such sensors do is a warning, before a guard minds") {
  auto diagnostics = diagnostics_of_thesis();
  std::byte level{9};
  std::string drift_n;
  for (std::uint64_t ms = 0; ms <= 20'000; ++ms) {
    // 1 N a minute is borne, ten of them are not.
    const double s = 1e-3 * static_cast<double>(ms),
                 drift_n_now = ms < 10'000 ? s / 60.0 : 0.1 + s / 6.0;
    const auto* all = diagnostics.look(resting(ms, drift_n_now), 0);
    if (all == nullptr) continue;
    level = part(*all, "left wrist sensor").level;
    drift_n = value(part(*all, "left wrist sensor"), "drift_n");
    if (ms == 0) CHECK(drift_n == "unknown");
    if (ms < 10'000) CHECK(level == Status::ok);
    CHECK(part(*all, "right wrist sensor").level == Status::ok);
  }
  CHECK(level == Status::warn);
  CHECK(std::stod(drift_n) == doctest::Approx(3.2).epsilon(0.1));
}

TEST_CASE("tissue and decisions are told at once, with their numbers") {
  auto diagnostics = diagnostics_of_thesis();
  REQUIRE(diagnostics.look(resting(0), 0) != nullptr);
  diagnostics.note_tissue(
      {.path = "press GV4", .felt = {.tissue = {4.0, 250.0}, .presses = 2, .converged = true}});
  const auto* felt = diagnostics.look(resting(1), 0);
  REQUIRE(felt != nullptr);
  CHECK(value(part(*felt, "tissue"), "beta_per_mm") == "0.2500");
  CHECK(value(part(*felt, "tissue"), "converged") == "true");
  diagnostics.note_decision(
      {{.time_s = 0.002, .path = "press GV4", .rule = "A3", .reason = "hard", .to_n = 5.0}});
  const auto* decided = diagnostics.look(resting(2), 7);
  REQUIRE(decided != nullptr);
  CHECK(part(*decided, "steering").message == "hard");
  CHECK(value(part(*decided, "steering"), "to_n") == "5.0");
  CHECK(part(*decided, "session").level == Status::warn);  // 7 ms are missing
}

TEST_CASE(
    "each part that is told has a group in the monitor of ROS 2, and no group waits for another") {
  const std::string yaml =
      read_file(TUINA_SOURCE_DIR "/ros2/tuina_view/config/analyzers.yaml", 100'000).value();
  std::multiset<std::string> grouped, told;
  for (auto at = yaml.find("expected: ["); at != std::string::npos;
       at = yaml.find("expected: [", at + 1)) {
    std::istringstream names(yaml.substr(at, yaml.find(']', at) - at));
    std::string before, name;
    while (std::getline(names, before, '\'') && std::getline(names, name, '\''))
      grouped.insert(name);
  }
  SessionDiagnostics diagnostics = diagnostics_of_thesis();
  for (const Status& one : diagnostics.look(resting(0), 0)->status) told.insert(one.name);
  CHECK(grouped == told);
}
