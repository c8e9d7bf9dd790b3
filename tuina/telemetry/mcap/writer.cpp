// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/mcap/writer.hpp"

#include <algorithm>

#include "tuina/telemetry/mcap/record_bytes.hpp"

namespace tuina::telemetry::mcap {

Writer::Writer(Sink sink, const WriterOptions& options)
    : sink_(std::move(sink)), options_(options), compressor_(options.search) {
  std::string front(magic);
  append_record(front, Header{.profile = options.profile, .library = options.library});
  put(front);
}

void Writer::put(std::string_view bytes) {
  if (!state_) return;
  state_ = sink_(bytes);
  bytes_ += bytes.size();
  crc_ = crc32(bytes, crc_);
}

std::uint16_t Writer::add_channel(std::string topic, std::string message_encoding, Schema schema,
                                  std::map<std::string, std::string> metadata) {
  auto known = std::find_if(schemas_.begin(), schemas_.end(), [&](const Schema& one) {
    return one.name == schema.name && one.encoding == schema.encoding;
  });
  if (known == schemas_.end()) {
    schema.id = static_cast<std::uint16_t>(schemas_.size() + 1);
    schemas_.push_back(std::move(schema));
    known = schemas_.end() - 1;
  }
  const auto id = static_cast<std::uint16_t>(streams_.size() + 1);
  streams_.push_back({.channel = {.id = id,
                                  .schema_id = known->id,
                                  .topic = std::move(topic),
                                  .message_encoding = std::move(message_encoding),
                                  .metadata = std::move(metadata)},
                      .index = {.channel_id = id}});
  return id;
}

void Writer::announce(Stream& stream) {
  // Within a chunk, for there a checksum covers them.
  stream.known = true;
  append_record(chunk_, schemas_[stream.channel.schema_id - std::size_t{1}]);
  append_record(chunk_, stream.channel);
}

Result<void> Writer::write(std::uint16_t channel, std::uint64_t log_time_ns,
                           std::string_view data) {
  if (!chunk_.empty() && (log_time_ns >= first_ns_ + options_.max_chunk_ns ||
                          chunk_.size() + data.size() > options_.max_chunk_bytes)) {
    if (auto ended = end_chunk(); !ended) return ended;
  }
  if (chunk_.empty()) first_ns_ = begin_ns_ = end_ns_ = log_time_ns;
  Stream& stream = streams_[channel - std::size_t{1}];
  if (!stream.known) announce(stream);
  stream.index.records.emplace_back(log_time_ns, chunk_.size());
  // No number in the sequence: MCAP lets it be zero, as rosbag2 does, and it takes space.
  const MessageHead head{
      .channel_id = channel, .log_time_ns = log_time_ns, .publish_time_ns = log_time_ns};
  constexpr std::size_t head_bytes = 22;
  chunk_.push_back(static_cast<char>(Opcode::message));
  FieldWriter fields(chunk_);
  fields(static_cast<std::uint64_t>(head_bytes + data.size()));
  MessageHead::fields(fields, head);
  chunk_.append(data);
  begin_ns_ = std::min(begin_ns_, log_time_ns);
  end_ns_ = std::max(end_ns_, log_time_ns);
  ++stream.messages;
  return state_;
}

Result<void> Writer::end_chunk() {
  if (chunk_.empty()) return state_;
  const std::string_view records = compressor_.compress(chunk_);
  ChunkIndex index{.begin_ns = begin_ns_,
                   .end_ns = end_ns_,
                   .offset = bytes_,
                   .compression = "zstd",
                   .compressed_size = records.size(),
                   .uncompressed_size = chunk_.size()};
  std::string out;
  append_record(out, Chunk{.begin_ns = begin_ns_,
                           .end_ns = end_ns_,
                           .uncompressed_size = chunk_.size(),
                           .uncompressed_crc = crc32(chunk_),
                           .compression = index.compression,
                           .records = {records}});
  index.length = out.size();
  const bool first = statistics_.messages == 0;
  for (Stream& stream : streams_) {
    if (stream.index.records.empty()) continue;
    index.message_index_offsets[stream.channel.id] = bytes_ + out.size();
    append_record(out, stream.index);
    statistics_.messages += stream.index.records.size();
    stream.index.records.clear();
  }
  index.message_index_length = out.size() - index.length;
  statistics_.begin_ns = first ? begin_ns_ : std::min(statistics_.begin_ns, begin_ns_);
  statistics_.end_ns = std::max(statistics_.end_ns, end_ns_);
  chunks_.push_back(std::move(index));
  chunk_.clear();
  put(out);
  return state_;
}

Result<void> Writer::attach(Attachment attachment) {
  if (auto ended = end_chunk(); !ended) return ended;
  std::string out;
  append_record(out, attachment);
  const std::size_t before_crc = out.size() - sizeof attachment.crc;
  attachment.crc =
      crc32(std::string_view(out).substr(record_head_bytes, before_crc - record_head_bytes));
  out.resize(before_crc);
  FieldWriter{out}(attachment.crc);
  attachments_.push_back({.offset = bytes_,
                          .length = out.size(),
                          .log_time_ns = attachment.log_time_ns,
                          .create_time_ns = attachment.create_time_ns,
                          .data_size = attachment.data.bytes.size(),
                          .name = attachment.name,
                          .media_type = attachment.media_type});
  put(out);
  return state_;
}

Result<void> Writer::add_metadata(const Metadata& metadata) {
  if (auto ended = end_chunk(); !ended) return ended;
  std::string out;
  append_record(out, metadata);
  metadata_.push_back({.offset = bytes_, .length = out.size(), .name = metadata.name});
  put(out);
  return state_;
}

std::string Writer::summary() const {
  Statistics statistics = statistics_;
  statistics.schemas = static_cast<std::uint16_t>(schemas_.size());
  statistics.channels = static_cast<std::uint32_t>(streams_.size());
  statistics.attachments = static_cast<std::uint32_t>(attachments_.size());
  statistics.metadata = static_cast<std::uint32_t>(metadata_.size());
  statistics.chunks = static_cast<std::uint32_t>(chunks_.size());
  std::vector<Channel> channels;
  for (const Stream& stream : streams_) {
    statistics.channel_messages[stream.channel.id] = stream.messages;
    channels.push_back(stream.channel);
  }
  std::string out, offsets;
  const auto group = [&]<typename Record>(const std::vector<Record>& records) {
    if (records.empty()) return;
    const std::size_t begin = out.size();
    for (const Record& record : records) append_record(out, record);
    append_record(offsets, SummaryOffset{.group = static_cast<std::uint8_t>(Record::opcode),
                                         .start = bytes_ + begin,
                                         .length = out.size() - begin});
  };
  group(schemas_);
  group(channels);
  group(std::vector{statistics});
  group(chunks_);
  group(attachments_);
  group(metadata_);
  const std::uint64_t offset_start = bytes_ + out.size();
  out += offsets;
  append_record(out, Footer{.summary_start = bytes_, .summary_offset_start = offset_start});
  out.resize(out.size() - sizeof(Footer::summary_crc));
  FieldWriter{out}(crc32(out));
  return out.append(magic);
}

Result<void> Writer::finish() {
  if (auto ended = end_chunk(); !ended) return ended;
  std::string end;
  append_record(end, DataEnd{.data_section_crc = crc_});
  put(end);
  put(summary());
  return state_;
}

}  // namespace tuina::telemetry::mcap
