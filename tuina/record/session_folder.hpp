// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/io/scratch_folder.hpp"
#include "tuina/core/result.hpp"
#include "tuina/telemetry/mcap/reader.hpp"

namespace tuina::record {

/// The file of a record, with what is in it but the messages; its attachments lie in `bytes`.
struct RecordFile {
  std::string bytes;
  telemetry::mcap::Contents contents;
};
/// Fails where there is no such file or it does not begin as an MCAP file. What is damaged stands
/// in `contents.lost`.
[[nodiscard]] Result<RecordFile> read_record_file(const std::filesystem::path& file,
                                                  const telemetry::mcap::OnMessage& each = {});

/// What is attached, unpacked where its name ends in .zst; `file` is named in the error.
[[nodiscard]] Result<std::string> content_of(const telemetry::mcap::Attachment& attachment,
                                             std::string_view file);

/// A recorded session for reading: the folder that `tuina massage --out` leaves, or the
/// session.mcap in it, whose attachments are then laid into a folder that goes with this object.
class SessionFolder {
 public:
  /// Fails for an MCAP file without session.json, which the record of a session that has not come
  /// to its end is; an attachment that would not be a plain file of the folder is refused.
  [[nodiscard]] static Result<SessionFolder> open(const std::filesystem::path& folder_or_mcap);

  /// The folder itself, or the scratch folder of an opened record.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// An error about a file of the folder, named as the user knows it.
  [[nodiscard]] Error explained(Error error) const;

 private:
  explicit SessionFolder(std::filesystem::path folder) : path_(std::move(folder)) {}

  std::filesystem::path path_;
  std::string mcap_;                       ///< the file that was unpacked; empty: nothing was
  std::optional<ScratchFolder> unpacked_;  ///< what is in it
};

}  // namespace tuina::record
