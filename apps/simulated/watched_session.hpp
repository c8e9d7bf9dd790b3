// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/session/run.hpp"

namespace tuina::app {

/// What a session is begun with, beside its devices.
struct WatchedOrder {
  const SessionOrder& given;
  session::Order& read;             ///< what `given` names; commands and review are put in
  const std::string& consent_toml;  ///< answers as they were given
  const session::Config& config;
  const CommonOptions& common;
  const std::filesystem::path& record_file;  ///< empty: no record
  const Attendant& attendant;
  /// The robot waits for nobody: what a slow record has no room for is left out.
  bool real_pace = false;
};

/// `session::run` with all who watch: the terminal, the record, an attendant, and `judges`, who are
/// told within the millisecond, before the others. What the session did, its joints and its record
/// are left in `result`.
[[nodiscard]] Result<void> run_watched(const session::Devices& devices, WatchedOrder order,
                                       const std::vector<session::Observer*>& judges,
                                       SessionResult& result);

/// The same who attend, and Ctrl-C: it ends a scan, or stops the massage as they might
/// (`end_when_asked`).
[[nodiscard]] Attendant until_asked_to_end(Attendant attendant);

}  // namespace tuina::app
