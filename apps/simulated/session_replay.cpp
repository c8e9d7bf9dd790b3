// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"

namespace tuina::app {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

ordered_json order_json(const SessionOrder& order) {
  const auto or_null = [](const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json();
  };
  return {{"person", order.person},
          {"position", order.position ? name_of(*order.position) : "auto"},
          {"programme", order.programme},
          {"robot", order.robot},
          {"method", name_of(order.method)},
          {"atlas", order.atlas},
          {"no_go", order.no_go},
          {"robot_pose", order.robot_pose},
          {"body_mass_index", or_null(order.facts.mass_index)},
          {"body_fat_percent", or_null(order.facts.fat_percent)},
          {"adaptive", order.adaptive}};
}

namespace {

Result<std::vector<std::pair<double, session::LiveCommand>>> commands_of(const json& list,
                                                                         const std::string& file) {
  std::vector<std::pair<double, session::LiveCommand>> commands;
  for (const json& entry : list) {
    const std::string name = entry.at("command").get<std::string>();
    const auto& names = session::live_command_names;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      return fail(Fault::bad_input, "{}: no command is called `{}`", file, name);
    }
    commands.emplace_back(entry.at("time_s").get<double>(),
                          static_cast<session::LiveCommand>(found - names.begin()));
  }
  return commands;
}

}  // namespace

Result<RecordedSession> read_session(const fs::path& folder) {
  const std::string file = (folder / "session.json").string();
  auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  auto config = session::load_config(folder / "config.toml");
  if (!config) return tl::unexpected(config.error());
  try {
    const json recorded = json::parse(*text);
    const json& order = recorded.at("order");
    const auto word = [&](const char* key) { return order.at(key).get<std::string>(); };
    const auto method = body::parse_method(word("method"));
    if (!method) {
      return fail(Fault::bad_input, "{}: order.method: no method is called `{}`", file,
                  word("method"));
    }
    const auto fact = [&](const char* key) {
      const json& value = order.at(key);
      return value.is_null() ? std::nullopt : std::optional(value.get<double>());
    };
    auto commands = commands_of(recorded.at("commands"), file);
    if (!commands) return tl::unexpected(commands.error());
    RecordedSession session;
    session.order.person = word("person");
    session.order.programme = word("programme");
    session.order.method = *method;
    session.order.robot = order.value("robot", "thesis");
    session.order.atlas = word("atlas");
    session.order.no_go = word("no_go");
    session.order.consent = (folder / "consent.toml").string();
    session.order.robot_pose = word("robot_pose");
    session.order.adaptive = order.at("adaptive").get<bool>();
    session.order.facts = {fact("body_mass_index"), fact("body_fat_percent")};
    session.order.commands = std::move(*commands);
    session.config = *config;
    session.seed = recorded.at("seed").get<std::uint64_t>();
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      if (word("position") == name_of(position)) session.order.position = position;
    }
    session.json = std::move(*text);
    return session;
  } catch (const json::exception& fault) {
    return tl::unexpected(json_fault(fault, *text, file, "a session to give once more"));
  }
}

std::vector<std::string> differences(const std::string& recorded_json,
                                     const std::string& json_now) {
  const json before = json::parse(recorded_json).flatten(), now = json::parse(json_now).flatten();
  const auto counts = [](const std::string& key) {
    return key.find("compute_ms") == std::string::npos &&
           key.find("real_time_factor") == std::string::npos;
  };
  std::vector<std::string> found;
  for (const auto& [key, value] : before.items()) {
    if (!counts(key)) continue;
    const auto other = now.find(key);
    const std::string became = other == now.end() ? "nothing" : other->dump();
    if (became != value.dump())
      found.push_back(fmt::format("{}: {} -> {}", key, value.dump(), became));
  }
  for (const auto& [key, value] : now.items()) {
    if (counts(key) && !before.contains(key))
      found.push_back(fmt::format("{}: nothing -> {}", key, value.dump()));
  }
  return found;
}

}  // namespace tuina::app
