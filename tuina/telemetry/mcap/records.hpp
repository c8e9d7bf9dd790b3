// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The records of an MCAP file, [mcap] "Records". The fields of each are named once, in the order
/// of the file; `record_bytes.hpp` writes and reads by that list. Times are nanoseconds, offsets
/// count from the first byte of the file.
namespace tuina::telemetry::mcap {

/// The first and the last bytes of every file.
inline constexpr std::string_view magic("\x89MCAP0\r\n", 8);

/// Number of each kind of record, [mcap] "Opcodes".
enum class Opcode : std::uint8_t {
  header = 0x01,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  attachment,
  attachment_index,
  statistics,
  metadata,
  metadata_index,
  summary_offset,
  data_end,
};

/// Bytes after a length of eight bytes; they lie elsewhere.
struct LongBytes {
  std::string_view bytes;
};

/// The first record: who has written the file.
struct Header {
  static constexpr Opcode opcode = Opcode::header;
  std::string profile, library;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.profile);
    visit(it.library);
  };
};

/// The last record: where the summary begins; 0: there is none.
struct Footer {
  static constexpr Opcode opcode = Opcode::footer;
  std::uint64_t summary_start = 0, summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.summary_start);
    visit(it.summary_offset_start);
    visit(it.summary_crc);
  };
};

/// The definition of a kind of message.
struct Schema {
  static constexpr Opcode opcode = Opcode::schema;
  std::uint16_t id = 0;
  std::string name, encoding, data;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.id);
    visit(it.name);
    visit(it.encoding);
    visit(it.data);
  };
};

/// A topic and how its messages are written.
struct Channel {
  static constexpr Opcode opcode = Opcode::channel;
  std::uint16_t id = 0, schema_id = 0;
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.id);
    visit(it.schema_id);
    visit(it.topic);
    visit(it.message_encoding);
    visit(it.metadata);
  };
};

/// What stands before the data of a message; the data take the rest of the record.
struct MessageHead {
  static constexpr Opcode opcode = Opcode::message;
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0, publish_time_ns = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.channel_id);
    visit(it.sequence);
    visit(it.log_time_ns);
    visit(it.publish_time_ns);
  };
};

/// Messages, compressed together.
struct Chunk {
  static constexpr Opcode opcode = Opcode::chunk;
  std::uint64_t begin_ns = 0, end_ns = 0, uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;
  LongBytes records;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.begin_ns);
    visit(it.end_ns);
    visit(it.uncompressed_size);
    visit(it.uncompressed_crc);
    visit(it.compression);
    visit(it.records);
  };
};

/// Where the messages of one channel are in the chunk before it.
struct MessageIndex {
  static constexpr Opcode opcode = Opcode::message_index;
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> records = {};  ///< time, offset in the chunk
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.channel_id);
    visit(it.records);
  };
};

/// Where a chunk is, and what times and channels are in it.
struct ChunkIndex {
  static constexpr Opcode opcode = Opcode::chunk_index;
  std::uint64_t begin_ns = 0, end_ns = 0, offset = 0, length = 0;
  std::map<std::uint16_t, std::uint64_t> message_index_offsets = {};
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.begin_ns);
    visit(it.end_ns);
    visit(it.offset);
    visit(it.length);
    visit(it.message_index_offsets);
    visit(it.message_index_length);
    visit(it.compression);
    visit(it.compressed_size);
    visit(it.uncompressed_size);
  };
};

/// `crc` is of all fields before it.
struct Attachment {
  static constexpr Opcode opcode = Opcode::attachment;
  std::uint64_t log_time_ns = 0, create_time_ns = 0;
  std::string name, media_type;
  LongBytes data;
  std::uint32_t crc = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.log_time_ns);
    visit(it.create_time_ns);
    visit(it.name);
    visit(it.media_type);
    visit(it.data);
    visit(it.crc);
  };
};

/// Where an attachment is.
struct AttachmentIndex {
  static constexpr Opcode opcode = Opcode::attachment_index;
  std::uint64_t offset = 0, length = 0, log_time_ns = 0, create_time_ns = 0, data_size = 0;
  std::string name, media_type;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.offset);
    visit(it.length);
    visit(it.log_time_ns);
    visit(it.create_time_ns);
    visit(it.data_size);
    visit(it.name);
    visit(it.media_type);
  };
};

/// Names and values about the file.
struct Metadata {
  static constexpr Opcode opcode = Opcode::metadata;
  std::string name;
  std::map<std::string, std::string> metadata = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.name);
    visit(it.metadata);
  };
};

/// Where a record of metadata is.
struct MetadataIndex {
  static constexpr Opcode opcode = Opcode::metadata_index;
  std::uint64_t offset = 0, length = 0;
  std::string name;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.offset);
    visit(it.length);
    visit(it.name);
  };
};

/// How much is in the file.
struct Statistics {
  static constexpr Opcode opcode = Opcode::statistics;
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0, attachments = 0, metadata = 0, chunks = 0;
  std::uint64_t begin_ns = 0, end_ns = 0;
  std::map<std::uint16_t, std::uint64_t> channel_messages = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.messages);
    visit(it.schemas);
    visit(it.channels);
    visit(it.attachments);
    visit(it.metadata);
    visit(it.chunks);
    visit(it.begin_ns);
    visit(it.end_ns);
    visit(it.channel_messages);
  };
};

/// Where the records of one kind are in the summary.
struct SummaryOffset {
  static constexpr Opcode opcode = Opcode::summary_offset;
  std::uint8_t group = 0;
  std::uint64_t start = 0, length = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit(it.group);
    visit(it.start);
    visit(it.length);
  };
};

/// End of the data, with the check sum of all before it.
struct DataEnd {
  static constexpr Opcode opcode = Opcode::data_end;
  std::uint32_t data_section_crc = 0;
  static constexpr auto fields = [](auto& visit, auto& it) { visit(it.data_section_crc); };
};

}  // namespace tuina::telemetry::mcap
