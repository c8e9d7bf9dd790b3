// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/mcap/summary.hpp"

#include <algorithm>

#include "tuina/telemetry/mcap/compression.hpp"

namespace tuina::telemetry::mcap {

std::optional<Record> record_at(std::string_view bytes, std::size_t at) {
  if (at + record_head_bytes > bytes.size()) return std::nullopt;
  FieldReader head(bytes.substr(at, record_head_bytes));
  std::uint8_t opcode = 0;
  std::uint64_t length = 0;
  head(opcode);
  head(length);
  if (length > bytes.size() - at - record_head_bytes) return std::nullopt;
  return Record{static_cast<Opcode>(opcode), bytes.substr(at + record_head_bytes, length)};
}

std::optional<Summary> read_summary(std::string_view bytes) {
  constexpr std::size_t footer_bytes = record_head_bytes + 20;
  const std::size_t tail = footer_bytes + magic.size();
  if (bytes.size() < magic.size() + tail || !bytes.ends_with(magic)) return std::nullopt;
  const std::size_t footer_at = bytes.size() - tail;
  const auto record = record_at(bytes, footer_at);
  if (!record || record->opcode != Opcode::footer) return std::nullopt;
  const auto footer = parse_record<Footer>(record->content);
  if (!footer) return std::nullopt;
  const std::uint64_t start = footer->summary_start == 0 ? footer_at : footer->summary_start;
  if (start < magic.size() || start > footer_at) return std::nullopt;
  const std::string_view covered =
      bytes.substr(start, footer_at + footer_bytes - sizeof footer->summary_crc - start);
  if (footer->summary_crc != 0 && footer->summary_crc != crc32(covered)) return std::nullopt;

  Summary summary{.start = start};
  const std::string_view within = bytes.substr(0, footer_at);
  for (std::size_t at = start; at < footer_at;) {
    const auto one = record_at(within, at);
    if (!one) return std::nullopt;
    if (one->opcode == Opcode::schema) {
      if (auto schema = parse_record<Schema>(one->content)) summary.schemas.push_back(*schema);
    } else if (one->opcode == Opcode::channel) {
      if (auto channel = parse_record<Channel>(one->content)) summary.channels.push_back(*channel);
    } else if (one->opcode == Opcode::chunk_index) {
      if (auto index = parse_record<ChunkIndex>(one->content))
        summary.offsets.push_back(index->offset);
    } else if (one->opcode == Opcode::attachment_index) {
      if (auto index = parse_record<AttachmentIndex>(one->content))
        summary.offsets.push_back(index->offset);
    } else if (one->opcode == Opcode::statistics) {
      summary.statistics = parse_record<Statistics>(one->content);
    }
    at += one->size();
  }
  std::sort(summary.offsets.begin(), summary.offsets.end());
  return summary;
}

}  // namespace tuina::telemetry::mcap
