// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "apps/evaluation/safety/sessions.hpp"

namespace tuina::app {

/// Every value of a trial with its key, but for its curve.
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, TrialOutcome>
void visit_fields(Outcome& outcome, const Visit& visit) {
  visit("tried", outcome.tried);
  visit("set_force_n", outcome.set_force_n);
  visit("worst_force_n", outcome.worst_force_n);
  visit("over_seldom_s", outcome.over_seldom_s);
  visit("first_action_ms", outcome.first_action_ms);
  visit("released_ms", outcome.released_ms);
  visit("further_m", outcome.further_m);
  visit("apart_m", outcome.apart_m);
  visit("rmse_n", outcome.rmse_n);
  visit("stopped", outcome.stopped);
  visit("by_guard", outcome.by_guard);
  visit("cause", outcome.cause);
  visit("end", outcome.end);
  visit("end_force_n", outcome.end_force_n);
  visit("end_m_per_s", outcome.end_m_per_s);
}

template <typename Session, typename Visit>
requires std::is_same_v<std::remove_const_t<Session>, CleanSession>
void visit_fields(Session& session, const Visit& visit) {
  visit("person", session.person);
  visit("massage_s", session.massage_s);
  visit("max_force_n", session.max_force_n);
  visit("stops", session.stops);
}

/// The sessions or the scans of a campaign are one cell together.
struct SessionCells {
  std::vector<SessionCell> all;
};
inline void to_json(nlohmann::ordered_json& json, const SessionCell& cell) {
  json = {{"number", cell.number}, {"name", cell.name},   {"state", cell.state},
          {"person", cell.person}, {"found", cell.found}, {"broken", cell.broken}};
}
inline void from_json(const nlohmann::ordered_json& json, SessionCell& cell) {
  json.at("number").get_to(cell.number);
  json.at("name").get_to(cell.name);
  json.at("state").get_to(cell.state);
  json.at("person").get_to(cell.person);
  json.at("found").get_to(cell.found);
  json.at("broken").get_to(cell.broken);
}
template <typename Sessions, typename Visit>
requires std::is_same_v<std::remove_const_t<Sessions>, SessionCells>
void visit_fields(Sessions& sessions, const Visit& visit) {
  visit("sessions", sessions.all);
}

}  // namespace tuina::app
