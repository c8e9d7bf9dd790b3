// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/record/json_schema.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/record/shared_fields.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/telemetry/report/report_data.hpp"

/// What happens in a session, as the JSON channels of its record tell it. Each event knows its
/// topic and its fields; the JSON and its schema come from these.
namespace tuina::record {

/// What was ordered, once at the start.
struct OrderEvent {
  static constexpr const char* topic = "/tuina/order";
  std::uint64_t seed = 1;
  std::string version;
  SessionOrder order;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("seed", it.seed);
    visit("version", it.version);
    visit.object("order", [&](auto& inside) { order_fields(inside, it.order); });
  };
};

/// That the questions about health were answered, once at the start.
struct ConsentEvent {
  static constexpr const char* topic = "/tuina/consent";
  std::string answered_by;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("answered_by", it.answered_by);
    visit("questions", session::health_questions.size());
  };
};

/// What is going to be done, once a plan is made.
struct PlanEvent {
  static constexpr const char* topic = "/tuina/plan";
  std::string programme;
  std::size_t paths = 0;
  double duration_s = 0.0;
  std::vector<Sentence> notes;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("programme", it.programme);
    visit("paths", it.paths);
    visit("duration_s", it.duration_s);
    english_fields(visit, "notes", it.notes);
  };
};

/// What an arm is doing, twenty times a second.
struct ArmEvent {
  static constexpr const char* topic = "/tuina/arms";
  Arm arm = Arm::left;
  std::string phase, path, technique;
  double target_n = 0.0, measured_n = 0.0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("arm", it.arm);
    visit("phase", it.phase);
    visit("path", it.path);
    visit("technique", it.technique);
    visit("target_n", it.target_n);
    visit("measured_n", it.measured_n);
  };
};

/// A path that has ended.
struct ContactEvent {
  static constexpr const char* topic = "/tuina/contacts";
  std::string path;
  Arm arm = Arm::left;
  double begin_s = 0.0, end_s = 0.0;
  std::string contact_fault;
  bool whole = true;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("path", it.path);
    visit("arm", it.arm);
    visit("begin_s", it.begin_s);
    visit("end_s", it.end_s);
    visit("trouble", it.contact_fault);
    visit("whole", it.whole);
  };
};

/// Tissue as the presses of a path that has ended felt it.
struct TissueEvent {
  static constexpr const char* topic = "/tuina/tissue";
  std::string path;
  TissueEstimate felt;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("path", it.path);
    tangent_fields(visit, it.felt.tissue);
    visit("alpha_ci95_n", it.felt.alpha_ci95_n);
    visit("beta_ci95_per_mm", it.felt.beta_ci95_per_m, per_mm);
    visit("presses", it.felt.presses);
    visit("converged", it.felt.converged);
  };
};

/// The steering lowers a force, and why.
struct DecisionEvent : telemetry::SteeringDecision {
  static constexpr const char* topic = "/tuina/decisions";
  static constexpr auto fields = decision_fields;
};

/// The guard stops an arm, and why.
struct StopEvent : telemetry::Stop {
  static constexpr const char* topic = "/tuina/stops";
  static constexpr auto fields = stop_fields;
};

/// What somebody told the running session.
struct CommandEvent {
  static constexpr const char* topic = "/tuina/commands";
  session::LiveCommand command = session::LiveCommand::pause;
  static constexpr auto fields = [](auto& visit, auto& it) { visit("command", it.command); };
};

/// The guard of an arm thinks otherwise than a millisecond before.
struct GuardEvent {
  static constexpr const char* topic = "/tuina/guard";
  Arm arm = Arm::left;
  std::string action, cause;
  bool latched = false;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("arm", it.arm);
    visit("action", it.action);
    visit("cause", it.cause);
    visit("latched", it.latched);
  };
};

/// Milliseconds that are not in the record: the recorder was too slow, or the robot gave no
/// reading.
struct GapEvent {
  static constexpr const char* topic = "/tuina/gaps";
  std::uint64_t missing_ms = 0;
  static constexpr auto fields = [](auto& visit, auto& it) { visit("missing_ms", it.missing_ms); };
};

}  // namespace tuina::record
