// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina {

/// The whole of a file; fails with what was wrong and the path. `limit_bytes` bounds the memory it
/// may take.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::size_t limit_bytes = std::size_t{256} << 20);

/// Writes a file piece by piece, beside the target, and renames it when it is whole, so a reader or
/// a crash never sees half a file. A writer that goes without `finish` leaves nothing behind.
class FileWriter {
 public:
  [[nodiscard]] static Result<FileWriter> open(const std::filesystem::path& path);
  FileWriter(FileWriter&& other) noexcept;
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;
  FileWriter& operator=(FileWriter&&) = delete;
  ~FileWriter();

  [[nodiscard]] Result<void> append(std::string_view content);
  [[nodiscard]] Result<void> finish();

 private:
  FileWriter(std::filesystem::path path, std::string written_to, int descriptor);
  [[nodiscard]] bool in_place() const { return written_to_ == path_.native(); }
  void close();

  std::filesystem::path path_;
  std::string written_to_;
  int descriptor_;
};

/// The same for content that is in memory already.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace tuina
