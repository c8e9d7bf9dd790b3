// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_folder.hpp"

#include "tuina/core/io/file.hpp"
#include "tuina/telemetry/mcap/compression.hpp"

namespace tuina::record {
namespace {

namespace mcap = telemetry::mcap;

constexpr std::string_view compressed = ".zst";

Result<void> unpack(const mcap::Attachment& attachment, const std::filesystem::path& folder,
                    const std::string& file) {
  const std::filesystem::path name = attachment.name;
  if (name.empty() || name != name.filename() || name == "." || name == "..") {
    return fail(Fault::bad_input, "{}: attachment `{}` is no name of a file", file,
                attachment.name);
  }
  const auto content = content_of(attachment, file);
  if (!content) return tl::unexpected(content.error());
  return write_file(folder / (attachment.name.ends_with(compressed) ? name.stem() : name),
                    *content);
}

}  // namespace

Result<std::string> content_of(const mcap::Attachment& attachment, std::string_view file) {
  constexpr std::uint64_t max_bytes = std::uint64_t{1} << 30;
  const std::string_view data = attachment.data.bytes;
  if (!attachment.name.ends_with(compressed)) return std::string(data);
  const auto size = mcap::stated_size(data);
  auto content = size && *size <= max_bytes ? mcap::decompress(data, *size) : std::nullopt;
  if (content) return std::move(*content);
  return fail(Fault::bad_input, "{}: attachment {} is no zstd frame of at most {} bytes", file,
              attachment.name, max_bytes);
}

Result<RecordFile> read_record_file(const std::filesystem::path& file,
                                    const mcap::OnMessage& each) {
  constexpr std::size_t max_bytes = std::size_t{4} << 30;
  auto bytes = read_file(file, max_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  RecordFile record{.bytes = std::move(*bytes)};
  auto contents = mcap::read(record.bytes, each);
  if (!contents) {
    return fail(contents.error().fault, "{}: {}", file.string(), contents.error().message);
  }
  record.contents = std::move(*contents);
  return record;
}

Result<SessionFolder> SessionFolder::open(const std::filesystem::path& folder_or_mcap) {
  const std::string file = folder_or_mcap.string();
  std::error_code none;
  if (!std::filesystem::is_regular_file(folder_or_mcap, none)) return SessionFolder(folder_or_mcap);
  const auto record = read_record_file(folder_or_mcap);
  if (!record) return tl::unexpected(record.error());
  if (record->contents.attachment("session.json.zst") == nullptr) {
    return fail(Fault::bad_input,
                "{}: holds no session.json, so the session did not come to its end; `tuina record "
                "show` says what it holds",
                file);
  }
  auto unpacked = ScratchFolder::make();
  if (!unpacked) return tl::unexpected(unpacked.error());
  SessionFolder session(unpacked->path());
  session.mcap_ = file;
  session.unpacked_.emplace(std::move(*unpacked));
  for (const mcap::Attachment& attachment : record->contents.attachments) {
    if (auto done = unpack(attachment, session.path_, file); !done)
      return tl::unexpected(done.error());
  }
  return session;
}

Error SessionFolder::explained(Error error) const {
  const std::string folder = path_.string() + "/";
  for (std::size_t at = 0;
       !mcap_.empty() && (at = error.message.find(folder, at)) != std::string::npos;
       at += mcap_.size() + 1)
    error.message.replace(at, folder.size(), mcap_ + ":");
  return error;
}

}  // namespace tuina::record
