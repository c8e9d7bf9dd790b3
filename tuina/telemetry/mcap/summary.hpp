// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/telemetry/mcap/record_bytes.hpp"
#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::telemetry::mcap {

/// A record as it lies in a file.
struct Record {
  Opcode opcode;
  std::string_view content;
  /// Bytes of the record with its head.
  [[nodiscard]] std::size_t size() const { return record_head_bytes + content.size(); }
};

/// The record that begins there, if it ends within the bytes.
[[nodiscard]] std::optional<Record> record_at(std::string_view bytes, std::size_t at);

/// What a summary with a good checksum says.
struct Summary {
  std::size_t start = 0;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<std::size_t> offsets;  ///< of chunks and attachments, rising
  std::optional<Statistics> statistics;
};

/// The summary at the end of a file; nothing where there is none or its checksum does not fit.
[[nodiscard]] std::optional<Summary> read_summary(std::string_view bytes);

}  // namespace tuina::telemetry::mcap
