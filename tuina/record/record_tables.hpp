// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::record {

/// What `write_tables` has made of a record.
struct RecordTables {
  /// One file of CSV.
  struct Made {
    std::string file;  ///< name in the folder
    std::uint64_t rows = 0;
  };
  std::vector<Made> made;
  std::vector<std::string> left_out;  ///< topics that are no tables: clouds, markers, frames
  std::vector<std::string> lost;      ///< what is damaged in the record
};

/// Writes the channels of an MCAP record as CSV files into a folder that exists, one for each
/// channel of JSON, of JointState and of MultiDOFJointState (docs/record.md). Fails with the topic
/// and the time of a message that is not what its channel says; then no file is written.
[[nodiscard]] Result<RecordTables> write_tables(const std::filesystem::path& mcap,
                                                const std::filesystem::path& folder);

}  // namespace tuina::record
