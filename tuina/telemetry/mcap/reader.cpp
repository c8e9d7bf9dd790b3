// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/mcap/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "tuina/telemetry/mcap/compression.hpp"
#include "tuina/telemetry/mcap/record_bytes.hpp"
#include "tuina/telemetry/mcap/summary.hpp"

namespace tuina::telemetry::mcap {
namespace {

constexpr std::uint64_t max_chunk_bytes = std::uint64_t{256} << 20;
constexpr std::size_t max_sentences = 100;  // more of them tell nobody anything

class Reading {
 public:
  Reading(std::string_view bytes, const OnMessage& on_message)
      : bytes_(bytes), on_message_(on_message), summary_(read_summary(bytes)) {
    end_ = summary_ ? summary_->start : bytes_.size();
  }

  Contents run() {
    if (summary_) {
      for (const Schema& schema : summary_->schemas) out_.schemas.emplace(schema.id, schema);
      for (const Channel& channel : summary_->channels) out_.channels.emplace(channel.id, channel);
    } else {
      lose(fmt::format("byte {}: no good summary at the end of the file", bytes_.size()));
    }
    for (std::size_t at = magic.size(); at < end_ && !ended_;) {
      const auto record = record_at(bytes_.substr(0, end_), at);
      if (record && take(*record, at)) {
        at += record->size();
        continue;
      }
      const std::size_t next = next_good(at + 1);
      lose(fmt::format("bytes {} to {}: damaged or cut off", at, next));
      at = next;
    }
    compare_with_summary();
    return std::move(out_);
  }

 private:
  void lose(std::string sentence) {
    if (out_.lost.size() < max_sentences) out_.lost.push_back(std::move(sentence));
  }

  /// False where the bytes are no record that may stand there.
  bool take(const Record& record, std::size_t at) {
    switch (record.opcode) {
      case Opcode::header:
        return at == magic.size() && keep(parse_record<Header>(record.content), out_.header);
      case Opcode::chunk:
        return take_chunk(record.content, at);
      case Opcode::message_index:
        return parse_record<MessageIndex>(record.content).has_value();
      case Opcode::attachment:
        return take_attachment(record.content);
      case Opcode::metadata:
        return keep(parse_record<Metadata>(record.content), out_.metadata.emplace_back()) ||
               (out_.metadata.pop_back(), false);
      case Opcode::data_end:
        return take_data_end(record.content, at);
      case Opcode::schema:
      case Opcode::channel:
      case Opcode::message:
        // Without a checksum these are believed only in files that have none at all.
        return !has_chunks() && take_inner(record);
      default:
        lose(fmt::format("byte {}: a record of unknown kind 0x{:02x} is passed over", at,
                         static_cast<int>(record.opcode)));
        return static_cast<std::uint8_t>(record.opcode) >= 0x80;
    }
  }

  template <typename T>
  static bool keep(std::optional<T> parsed, T& in) {
    if (parsed) in = std::move(*parsed);
    return parsed.has_value();
  }

  [[nodiscard]] bool has_chunks() const {
    return out_.chunks > 0 ||
           (summary_ && summary_->statistics && summary_->statistics->chunks > 0);
  }

  /// Schema, channel or message.
  bool take_inner(const Record& record) {
    if (record.opcode == Opcode::schema) {
      const auto schema = parse_record<Schema>(record.content);
      if (schema) out_.schemas.emplace(schema->id, *schema);
      return schema.has_value();
    }
    if (record.opcode == Opcode::channel) {
      const auto channel = parse_record<Channel>(record.content);
      if (channel) out_.channels.emplace(channel->id, *channel);
      return channel.has_value();
    }
    if (record.opcode != Opcode::message) return true;  // kinds of a later version
    Message message;
    FieldReader reader(record.content);
    MessageHead::fields(reader, message);
    if (!reader.fits()) return false;
    if (!out_.channels.contains(message.channel_id)) {
      ++homeless_;
      return true;
    }
    message.data = reader.rest();
    const bool first = out_.messages++ == 0;
    ++out_.channel_messages[message.channel_id];
    out_.begin_ns = first ? message.log_time_ns : std::min(out_.begin_ns, message.log_time_ns);
    out_.end_ns = std::max(out_.end_ns, message.log_time_ns);
    if (on_message_) on_message_(out_, message);
    return true;
  }

  /// The records of a chunk, where its checksum fits.
  static std::optional<std::string> records_of(const Chunk& chunk) {
    std::optional<std::string> records;
    if (chunk.uncompressed_size > max_chunk_bytes) return std::nullopt;
    if (chunk.compression == "zstd") {
      records = decompress(chunk.records.bytes, chunk.uncompressed_size);
    } else if (chunk.compression.empty() && chunk.records.bytes.size() == chunk.uncompressed_size) {
      records = std::string(chunk.records.bytes);
    }
    const bool good =
        records && (chunk.uncompressed_crc == 0 || chunk.uncompressed_crc == crc32(*records));
    return good ? std::move(records) : std::nullopt;
  }

  bool take_chunk(std::string_view content, std::size_t at) {
    const auto chunk = parse_record<Chunk>(content);
    if (!chunk) return false;
    const auto records = records_of(*chunk);
    if (!records) {
      const bool known = chunk->compression.empty() || chunk->compression == "zstd";
      const bool small = chunk->uncompressed_size <= max_chunk_bytes;
      lose(fmt::format("byte {}: a chunk of {} bytes is lost: {}", at, content.size(),
                       !small  ? "it is too large"
                       : known ? "its checksum does not fit"
                               : "its compression is not known"));
      return true;
    }
    ++out_.chunks;
    for (std::size_t i = 0; i < records->size();) {
      const auto record = record_at(*records, i);
      if (!record || !take_inner(*record)) {
        lose(fmt::format("byte {}: the rest of a chunk, from its byte {}, is no records", at, i));
        break;
      }
      i += record->size();
    }
    return true;
  }

  bool take_attachment(std::string_view content) {
    const auto attachment = parse_record<Attachment>(content);
    if (!attachment) return false;
    const std::string_view covered = content.substr(0, content.size() - sizeof attachment->crc);
    if (attachment->crc != 0 && attachment->crc != crc32(covered)) return false;
    out_.attachments.push_back(*attachment);
    return true;
  }

  bool take_data_end(std::string_view content, std::size_t at) {
    const auto end = parse_record<DataEnd>(content);
    const std::size_t after = at + record_head_bytes + content.size();
    if (!end || (summary_ && after != end_)) return false;
    ended_ = true;
    if (end->data_section_crc != 0 && end->data_section_crc != crc32(bytes_.substr(0, at)))
      lose(fmt::format("bytes 0 to {}: the checksum of the data section does not fit", at));
    return true;
  }

  /// Where the next chunk or attachment begins, or the end: by the summary if there is one, else by
  /// looking for one whose lengths agree.
  [[nodiscard]] std::size_t next_good(std::size_t from) const {
    if (summary_) {
      const auto next = std::lower_bound(summary_->offsets.begin(), summary_->offsets.end(), from);
      return next == summary_->offsets.end() ? end_ : std::min<std::size_t>(*next, end_);
    }
    for (std::size_t at = from; at < end_; ++at) {
      const auto opcode = static_cast<Opcode>(bytes_[at]);
      if (opcode != Opcode::chunk && opcode != Opcode::attachment) continue;
      const auto record = record_at(bytes_.substr(0, end_), at);
      if (!record) continue;
      const bool begins = opcode == Opcode::chunk
                              ? parse_record<Chunk>(record->content).has_value()
                              : parse_record<Attachment>(record->content).has_value();
      if (begins) return at;
    }
    return end_;
  }

  void compare_with_summary() {
    if (!ended_) lose(fmt::format("byte {}: the data section does not end", end_));
    if (homeless_ > 0) lose(fmt::format("{} messages are on channels that are lost", homeless_));
    if (!summary_ || !summary_->statistics) return;
    const Statistics& said = *summary_->statistics;
    const auto compare = [&](const char* what, std::uint64_t found, std::uint64_t written) {
      if (found != written) lose(fmt::format("{} of {} {} are left", found, written, what));
    };
    compare("chunks", out_.chunks, said.chunks);
    compare("messages", out_.messages, said.messages);
    compare("attachments", out_.attachments.size(), said.attachments);
    compare("metadata records", out_.metadata.size(), said.metadata);
  }

  std::string_view bytes_;
  const OnMessage& on_message_;
  std::optional<Summary> summary_;
  std::size_t end_ = 0;  ///< of the data section, as far as is known
  bool ended_ = false;
  std::uint64_t homeless_ = 0;
  Contents out_;
};

}  // namespace

const Attachment* Contents::attachment(std::string_view name) const {
  const auto found = std::find_if(attachments.begin(), attachments.end(),
                                  [&](const Attachment& one) { return one.name == name; });
  return found == attachments.end() ? nullptr : &*found;
}

Result<Contents> read(std::string_view bytes, const OnMessage& on_message) {
  if (!bytes.starts_with(magic)) {
    return fail(Fault::bad_input, "is no MCAP file: it does not begin with the bytes of one");
  }
  return Reading(bytes, on_message).run();
}

}  // namespace tuina::telemetry::mcap
