// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/person_history.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/telemetry/report/figures.hpp"

namespace tuina::history {
namespace {

using Json = nlohmann::ordered_json;

/// Null where a number is not known.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

/// What was said by hand; as it stands there where it cannot be read.
Json said_of(const Visit& visit) {
  if (visit.said.empty()) return {};
  Json said = Json::parse(visit.said, nullptr, false);
  return said.is_discarded() ? Json(visit.said) : said;
}

Json json_of(const Visit& visit) {
  Json tissue = Json::array();
  for (const VisitTissue& felt : visit.tissue) {
    tissue.push_back({{"name", felt.name},
                      {"alpha_n", number(felt.alpha_n)},
                      {"beta_per_mm", number(1e-3 * felt.beta_per_m)},
                      {"ci95",
                       {{"alpha_n", number(felt.alpha_ci95_n)},
                        {"beta_per_mm", number(1e-3 * felt.beta_ci95_per_m)}}},
                      {"stiffness_n_per_mm", number(felt.stiffness_n_per_mm)},
                      {"stiffness_ci95_n_per_mm", number(felt.stiffness_ci95_n_per_mm)},
                      {"presses", felt.presses},
                      {"converged", felt.converged}});
  }
  Json points = Json::array();
  for (const Acupoint& point : visit.acupoints) {
    points.push_back(
        {{"name", point.name},
         {"position_m", {point.at_in_couch.x(), point.at_in_couch.y(), point.at_in_couch.z()}},
         {"uncertainty_mm", number(1e3 * point.uncertainty_m)}});
  }
  return {
      {"session_id", visit.id},
      {"began", visit.began},
      {"ended", visit.ended},
      {"folder", visit.folder},
      {"position", visit.position},
      {"programme", visit.programme},
      {"robot", visit.robot},
      {"realism", visit.realism},
      {"version", visit.version},
      {"duration_s", number(visit.duration_s)},
      {"force", {{"rmse_n", number(visit.force_rmse_n)}, {"peak_n", number(visit.force_peak_n)}}},
      {"softer", visit.softer},
      {"firmer", visit.firmer},
      {"intensity", number(visit.intensity)},
      {"stops", visit.stops},
      {"stop_cause", visit.stop_cause},
      {"consent", {{"answered_by", visit.consent_by}}},
      {"said", said_of(visit)},
      {"acupoints", points},
      {"tissue", tissue}};
}

Json json_of(const Change& change) {
  return {{"name", change.name},
          {"before_alpha_n", change.before_n},
          {"after_alpha_n", change.after_n},
          {"change_percent", 100.0 * change.change},
          {"low_percent", 100.0 * change.low},
          {"high_percent", 100.0 * change.high},
          {"p", change.p},
          {"real", change.real}};
}

Json json_of(const LastChange& last) {
  Json places = Json::array();
  for (const Change& place : last.changes.places) places.push_back(json_of(place));
  return {{"before", last.before->id},
          {"after", last.after->id},
          {"scatter_percent", 100.0 * last.changes.scatter},
          {"scatter_assumed", last.changes.scatter_assumed},
          {"whole", last.changes.whole ? json_of(*last.changes.whole) : Json()},
          {"places", places}};
}

}  // namespace

std::optional<LastChange> last_change(std::span<const Visit> visits) {
  for (std::size_t last = visits.size(); last-- > 1;) {
    if (visits[last].tissue.empty()) continue;
    for (std::size_t before = last; before-- > 0;) {
      if (visits[before].tissue.empty() || visits[before].position != visits[last].position)
        continue;
      auto changes = changes_between(visits[before], visits[last], visits.first(last));
      if (changes.places.empty()) continue;
      return LastChange{&visits[before], &visits[last], std::move(changes)};
    }
    return std::nullopt;
  }
  return std::nullopt;
}

std::string day_and_time(const std::string& stamp) {
  if (stamp.size() < 16) return stamp;
  return stamp.substr(0, 10) + " " + stamp.substr(11, 5);
}

std::vector<Sentence> sentences_of(const LastChange& change) {
  const std::string since = day_and_time(change.before->began);
  std::vector<Sentence> said;
  if (const auto& whole = change.changes.whole; whole && whole->real) {
    const double percent = 100.0 * whole->change, low = 100.0 * whole->low,
                 high = 100.0 * whole->high;
    said.push_back(percent < 0.0
                       ? sentence("changed_whole_softer",
                                  "Softer as a whole since {}: {:+.0f} % ({:+.0f} to {:+.0f} %).",
                                  since, percent, low, high)
                       : sentence("changed_whole_harder",
                                  "Harder as a whole since {}: {:+.0f} % ({:+.0f} to {:+.0f} %).",
                                  since, percent, low, high));
  }
  for (const bool softer : {true, false}) {
    std::string spoken, named;
    for (const Change& place : change.changes.places) {
      if (!place.real || (place.change < 0.0) != softer) continue;
      const std::string by = fmt::format(" ({:+.0f} %)", 100.0 * place.change);
      spoken += (spoken.empty() ? "" : ", ") + telemetry::figures::spoken(place.name) + by;
      named += (named.empty() ? "" : ", ") + place.name + by;
    }
    if (named.empty()) continue;
    said.push_back(
        {.words = fmt::format("{} since {}: {}.", softer ? "Softer" : "Harder", since, spoken),
         .key = softer ? "changed_softer" : "changed_harder",
         .values = {since, named}});
  }
  if (said.empty()) {
    said.push_back(sentence(
        "changed_nothing", "No change that could be told from chance at any of {} places since {}.",
        change.changes.places.size(), since));
  }
  return said;
}

std::string sentence_of(const LastChange& change) {
  std::string text;
  for (const Sentence& one : sentences_of(change)) text += (text.empty() ? "" : " ") + one.words;
  return text;
}

std::string to_json(const PersonHistory& person) {
  Json sessions = Json::array(), notes = Json::array();
  for (const Visit& visit : person.visits) sessions.push_back(json_of(visit));
  for (const Note& note : person.notes) notes.push_back({{"at", note.at}, {"words", note.words}});
  const auto last = last_change(person.visits);
  return Json{{"who", person.who},
              {"sessions", sessions},
              {"notes", notes},
              {"change", last ? json_of(*last) : Json()}}
      .dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string to_csv(const PersonHistory& person) {
  std::string csv =
      "session_id,began,place,alpha_n,alpha_ci95_n,beta_per_mm,beta_ci95_per_mm,"
      "stiffness_n_per_mm,stiffness_ci95_n_per_mm,presses,converged\n";
  for (const Visit& visit : person.visits) {
    for (const VisitTissue& felt : visit.tissue) {
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", visit.id, visit.began, felt.name,
                         felt.alpha_n, felt.alpha_ci95_n, 1e-3 * felt.beta_per_m,
                         1e-3 * felt.beta_ci95_per_m, felt.stiffness_n_per_mm,
                         felt.stiffness_ci95_n_per_mm, felt.presses, felt.converged ? 1 : 0);
    }
  }
  return csv;
}

}  // namespace tuina::history
