// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/massage/store.hpp"

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tuina/core/io/file.hpp"

namespace tuina::app {

using nlohmann::ordered_json;

template <typename Press, typename Visit>
static void visit_press(Press& press, const Visit& visit) {
  visit("place", press.place);
  visit("technique", press.technique);
  visit("index", press.index);
  visit("probing", press.probing);
  visit("foretold", press.foretold);
  visit("planned_n", press.planned_n);
  visit("asked_n", press.asked_n);
  visit("peak_n", press.peak_n);
  visit("held_n", press.held_n);
  visit("arm", press.arm);
  visit("contact_s", press.contact_s);
  visit("end_s", press.end_s);
}

// The JSON library finds these two by their names.
static void to_json(ordered_json& json, const GivenPress& press) {
  visit_press(press, [&](const char* key, const auto& value) { json[key] = value; });
}
static void from_json(const ordered_json& json, GivenPress& press) {
  visit_press(press, [&](const char* key, auto& value) { json.at(key).get_to(value); });
}

namespace {

std::string name_of(const SessionTrial& trial) {
  return fmt::format("{} {} {} {} {}", trial.order.person,
                     trial.order.position ? tuina::name_of(*trial.order.position) : "auto",
                     trial.order.programme, trial.order.adaptive ? "on" : "off", trial.seed);
}

/// Every value of an outcome with its key, for reading and for writing.
template <typename Outcome, typename Visit>
void visit_all(Outcome& outcome, const Visit& visit) {
  visit("refused", outcome.refused);
  visit("stops", outcome.stops);
  visit("troubles", outcome.troubles);
  visit("left_out", outcome.left_out);
  visit("beyond", outcome.beyond);
  visit("duration_s", outcome.duration_s);
  visit("rmse_n", outcome.rmse_n);
  visit("overshoot_n", outcome.overshoot_n);
  visit("bony_peak_n", outcome.bony_peak_n);
  visit("over_cap_n", outcome.over_cap_n);
  visit("over_trip_n", outcome.over_trip_n);
  visit("arm_distance_m", outcome.arm_distance_m);
  visit("tool_to_acupoint_m", outcome.tool_to_acupoint_m);
  visit("presses", outcome.presses);
  visit("scan_to_touch_s", outcome.scan_to_touch_s);
  visit("plan_ms", outcome.plan_ms);
  visit("real_time_factor", outcome.real_time_factor);
}

ordered_json header_of(const session::Config& config, const std::string& atlas) {
  return {{"sessions_of", TUINA_VERSION}, {"atlas", atlas}, {"config", session::to_toml(config)}};
}

Result<void> append(const std::filesystem::path& file, const ordered_json& line) {
  std::ofstream out(file, std::ios::app | std::ios::binary);
  out << line.dump() + "\n" << std::flush;
  if (!out) return fail(Fault::file, "{}: cannot be written", file.string());
  return {};
}

}  // namespace

Result<SessionStore> SessionStore::open(const std::filesystem::path& file,
                                        const session::Config& config, const std::string& atlas) {
  SessionStore store;
  store.file_ = file;
  const ordered_json header = header_of(config, atlas);
  if (!std::filesystem::exists(file)) {
    if (auto begun = append(file, header); !begun) return tl::unexpected(begun.error());
    return store;
  }
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  std::istringstream lines(*text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    try {
      const auto entry = ordered_json::parse(line);
      if (number == 1) {
        if (entry == header) continue;
        return fail(Fault::bad_input,
                    "{}:1: holds sessions of another version, atlas or configuration; name a new "
                    "file",
                    file.string());
      }
      constexpr double nothing = -std::numeric_limits<double>::infinity();
      SessionOutcome outcome{.over_cap_n = nothing, .over_trip_n = nothing};
      visit_all(outcome, [&](const char* key, auto& value) {
        // Where nothing was touched there is no largest force, and JSON has no word for that.
        if (!entry.at(key).is_null()) entry.at(key).get_to(value);
      });
      store.kept_[entry.at("session").get<std::string>()] = std::move(outcome);
    } catch (const ordered_json::exception&) {
      return fail(Fault::bad_input, "{}:{}: is not a session of `evaluate massage --keep`",
                  file.string(), number);
    }
  }
  return store;
}

const SessionOutcome* SessionStore::find(const SessionTrial& trial) const {
  const auto found = kept_.find(name_of(trial));
  return found == kept_.end() ? nullptr : &found->second;
}

Result<void> SessionStore::add(const SessionTrial& trial, const SessionOutcome& outcome) {
  ordered_json line = {{"session", name_of(trial)}};
  visit_all(outcome, [&](const char* key, const auto& value) { line[key] = value; });
  const std::lock_guard lock(*writing_);
  return append(file_, line);
}

}  // namespace tuina::app
