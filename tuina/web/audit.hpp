// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/web/rate.hpp"

namespace tuina::web {

/// What was asked, by whom, in which phase of a session, and what became of it.
struct AuditEntry {
  std::string who;
  std::string what;
  std::string phase;
  std::string outcome;  ///< "done", or why not
};

/// Content of an audit log, as far as its chain holds.
struct AuditSummary {
  std::uint64_t lines = 0;
  std::string last_hash;
};

/// A line for everything that was asked of a server, in the order in which it came. A line is a
/// JSON object that ends in the SHA-256 of itself and of the hash of the line before: a line that
/// is changed, left out, added or moved breaks the chain. Lines cut off at the end are not noticed
/// but by who knows the last hash.
class AuditLog {
 public:
  /// Goes on with a log that is there. Refused: one whose chain does not hold, with its first bad
  /// line, and one that another server writes. A last line that does not end is cut off, which the
  /// next line tells.
  [[nodiscard]] static Result<AuditLog> open(const std::filesystem::path& file);
  AuditLog(AuditLog&& other) noexcept;
  AuditLog& operator=(AuditLog&&) = delete;
  ~AuditLog();

  /// `now_s` is of a monotonic clock. A flood of what is refused does not fill the disk: beyond 20
  /// a second they are counted, and the next line says how many were left out.
  [[nodiscard]] Result<void> add(const AuditEntry& entry, double now_s);
  /// The same for what was refused.
  [[nodiscard]] Result<void> add_refused(const AuditEntry& entry, double now_s);

 private:
  AuditLog(std::filesystem::path file, int descriptor, AuditSummary end);

  std::filesystem::path file_;
  int descriptor_;
  AuditSummary end_;
  std::uint64_t left_out_ = 0, torn_bytes_ = 0;
  Rate requests_{200.0, 20.0};
};

/// Whether the chain of a log holds; else the number of the first line that breaks it.
[[nodiscard]] Result<AuditSummary> check_audit(std::string_view text, std::string_view name);

}  // namespace tuina::web
