// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/simulated/session_order.hpp"

namespace tuina::app {

/// A session in its folder, ready to be given once more. Files that its order names are not copied.
struct RecordedSession {
  SessionOrder order;
  session::Config config;
  std::uint64_t seed = 0;
  std::string json;  ///< text of session.json
};

/// From session.json, config.toml and consent.toml. Refused: what is missing or of another kind,
/// with file and key.
[[nodiscard]] Result<RecordedSession> read_session(const std::filesystem::path& folder);

/// Keys in which two sessions differ, with both values; times of computing do not count.
[[nodiscard]] std::vector<std::string> differences(const std::string& recorded_json,
                                                   const std::string& json);

}  // namespace tuina::app
