// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/telemetry/mcap/compression.hpp"
#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::telemetry::mcap {

/// Profile and compression of a file.
struct WriterOptions {
  std::string profile = "ros2";
  std::string library = "tuina";
  Search search = rows;
  /// A chunk ends when a message comes that is so much later than its first, or with so many bytes.
  std::uint64_t max_chunk_ns = 1'000'000'000;
  std::size_t max_chunk_bytes = std::size_t{4} << 20;
};

/// Writes one MCAP file [mcap] from its front to its back: messages in zstd chunks, each whole in
/// the sink when it ends, with checksums, indexes and a summary. A sink that fails is not asked
/// again; its error is the answer to every later call.
class Writer {
 public:
  /// Takes the next bytes of the file.
  using Sink = std::function<Result<void>(std::string_view)>;

  /// Writes the head of the file.
  explicit Writer(Sink sink, const WriterOptions& options = {});

  /// `schema.id` is given here; a schema of the same name and encoding is used again. Returns the
  /// id of the channel.
  std::uint16_t add_channel(std::string topic, std::string message_encoding, Schema schema,
                            std::map<std::string, std::string> metadata = {});
  /// A message on a channel that was added. Times need not rise.
  [[nodiscard]] Result<void> write(std::uint16_t channel, std::uint64_t log_time_ns,
                                   std::string_view data);
  /// What was written so far is in the sink afterwards.
  [[nodiscard]] Result<void> end_chunk();
  /// `crc` is computed here.
  [[nodiscard]] Result<void> attach(Attachment attachment);
  /// Names and values about the file. Fails as the sink does.
  [[nodiscard]] Result<void> add_metadata(const Metadata& metadata);
  /// Summary, footer and magic; nothing may be written afterwards.
  [[nodiscard]] Result<void> finish();

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  ///< bytes that went to the sink

 private:
  struct Stream {
    Channel channel;
    std::uint64_t messages = 0;
    MessageIndex index;  ///< of the chunk that is open
    bool known = false;  ///< a chunk holds its channel and schema
  };

  void announce(Stream& stream);
  void put(std::string_view bytes);
  [[nodiscard]] std::string summary() const;

  Sink sink_;
  WriterOptions options_;
  Compressor compressor_;
  Result<void> state_ = {};
  std::vector<Schema> schemas_;
  std::vector<Stream> streams_;  ///< the channel with id n is the one at n - 1
  std::string chunk_;            ///< records of the chunk that is open
  std::uint64_t begin_ns_ = 0, end_ns_ = 0, first_ns_ = 0;  ///< of the messages in it
  std::uint64_t bytes_ = 0;
  std::uint32_t crc_ = 0;  ///< of all bytes so far
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::vector<MetadataIndex> metadata_;
  Statistics statistics_;
};

}  // namespace tuina::telemetry::mcap
