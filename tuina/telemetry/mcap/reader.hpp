// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::telemetry::mcap {

/// One message of a record, with its channel and times.
struct Message : MessageHead {
  std::string_view data;  ///< lives while the message is looked at
};

/// All of a file but its messages.
struct Contents {
  Header header;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::map<std::uint16_t, std::uint64_t> channel_messages;
  std::uint64_t messages = 0, chunks = 0;
  std::uint64_t begin_ns = 0, end_ns = 0;
  std::vector<Attachment> attachments;  ///< their data lie in the bytes that were read
  /// Neither header nor metadata have a checksum of their own: where `lost` is not empty, they may
  /// be wrong.
  std::vector<Metadata> metadata;
  /// One sentence for each thing that is damaged or missing, with its place in the file; empty
  /// where the file is whole.
  std::vector<std::string> lost;

  /// The attachment of that name, or null.
  [[nodiscard]] const Attachment* attachment(std::string_view name) const;
};

/// Called for each message, with what the file has said before it.
using OnMessage = std::function<void(const Contents&, const Message&)>;

/// Reads an MCAP file [mcap] from its front to its back, also one that is cut off or damaged: a
/// chunk or attachment counts when its checksum fits, and what does not is named in `lost`.
/// Messages come in the order of the file. Fails only where the bytes do not begin as an MCAP file
/// does. Limits: chunks are plain or zstd, of 256 MB at most; records with fields that [mcap] does
/// not know count as damaged.
[[nodiscard]] Result<Contents> read(std::string_view bytes, const OnMessage& on_message = {});

}  // namespace tuina::telemetry::mcap
