// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tuina/history/person_history.hpp"

namespace tuina::history {

/// What went into an archive.
struct Archived {
  std::int64_t sessions = 0;  ///< with their folders
  std::int64_t files = 0;
  std::vector<std::string> missing;  ///< sessions without their folder: which, and why
};

/// Writes one ZIP file with everything that is kept of somebody: `README.txt`, `history.json`,
/// `tissue.csv`, and below `sessions/` the folders of the sessions as they are. A folder that is
/// not there, or holds another session by now, is left out and named in the README. `at` is the
/// time that the README tells. The file is written whole or not at all, and only its owner may read
/// it. Fails (Fault::usage) when it is to lie in one of the folders, and (Fault::file) when
/// something cannot be read or written.
[[nodiscard]] Result<Archived> write_archive(const PersonHistory& person, const std::string& at,
                                             const std::filesystem::path& file);

}  // namespace tuina::history
