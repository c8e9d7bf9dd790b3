// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/simulated/session_order.hpp"
#include "tuina/record/session_folder.hpp"

namespace tuina::app {

/// A session in its folder, ready to be given once more. Files that its order names are not copied.
struct RecordedSession {
  SessionOrder order;
  session::Config config;
  std::uint64_t seed = 0;
  std::string json;              ///< text of session.json
  record::SessionFolder folder;  ///< its files, which the order may name
};

/// From session.json, config.toml and consent.toml in the folder of a session or in its
/// session.mcap. Refused: what is missing or of another kind, with file and key.
[[nodiscard]] Result<RecordedSession> read_session(const std::filesystem::path& folder_or_mcap);

/// Keys in which two sessions differ, with both values; times of computing, and what came
/// over a network, do not count.
[[nodiscard]] std::vector<std::string> differences(const std::string& recorded_json,
                                                   const std::string& json);

}  // namespace tuina::app
