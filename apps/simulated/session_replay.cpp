// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_replay.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"

namespace tuina::app {

using nlohmann::json;

Result<RecordedSession> read_session(const std::filesystem::path& folder_or_mcap) {
  auto folder = record::SessionFolder::open(folder_or_mcap);
  if (!folder) return tl::unexpected(folder.error());
  const std::string name = folder->path() / "session.json";
  auto text = read_file(name);
  if (!text) return tl::unexpected(folder->explained(text.error()));
  auto config = session::load_config(folder->path() / "config.toml");
  if (!config) return tl::unexpected(folder->explained(config.error()));
  auto recorded = record::parse_session(*text, name);
  if (!recorded) return tl::unexpected(folder->explained(recorded.error()));
  if (!recorded->simulated())
    return fail(
        Fault::bad_input,
        "{}: was a session with devices of one's own; only a simulated one can be given once "
        "more",
        name);
  recorded->order.consent = folder->path() / "consent.toml";
  return RecordedSession{.order = std::move(recorded->order),
                         .config = std::move(*config),
                         .seed = recorded->seed,
                         .json = std::move(*text),
                         .folder = std::move(*folder)};
}

std::vector<std::string> differences(const std::string& recorded_json,
                                     const std::string& json_now) {
  const json before = json::parse(recorded_json).flatten(), now = json::parse(json_now).flatten();
  const auto counts = [](const std::string& key) {
    // Computing times, and whose session it was: the same one given once more is nobody's.
    return key.find("compute_ms") == std::string::npos &&
           key.find("real_time_factor") == std::string::npos &&
           key.find("/late_ms") == std::string::npos && key != "/who" && key != "/session_id" &&
           key != "/began" && !key.starts_with("/devices/");
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
