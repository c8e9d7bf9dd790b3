// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "apps/evaluation/massage/trials.hpp"

namespace tuina::app {

/// Judged sessions in a file, a line each, so that a long evaluation may be done in pieces: what is
/// in the file is not done again. The first line says under which settings they were judged.
class SessionStore {
 public:
  /// Reads what is there, or begins a file. Refused, with file and line: another kind of file, and
  /// sessions under other settings.
  [[nodiscard]] static Result<SessionStore> open(const std::filesystem::path& file,
                                                 const session::Config& config,
                                                 const std::string& atlas);

  [[nodiscard]] const SessionOutcome* find(const SessionTrial& trial) const;
  /// At once and whole, from any thread.
  [[nodiscard]] Result<void> add(const SessionTrial& trial, const SessionOutcome& outcome);

 private:
  std::filesystem::path file_;
  std::map<std::string, SessionOutcome> kept_;
  std::unique_ptr<std::mutex> writing_ = std::make_unique<std::mutex>();
};

}  // namespace tuina::app
