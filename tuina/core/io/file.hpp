// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina {

/// Reads a whole file of at most `limit_bytes`. Fails with the cause and the path.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::size_t limit_bytes = std::size_t{256} << 20);

/// Who may read a file that is written anew; one that is there keeps its rights.
enum class Readers : std::uint8_t { everybody, owner };

/// Writes a temporary file beside the target and renames it in `finish`, so that neither a reader
/// nor a crash or a loss of power sees half a file. A link stays, and what it leads to is written.
/// Without `finish` or `leave_part` nothing is left behind.
class FileWriter {
 public:
  /// Begins a file beside its final place. Fails with Fault::file, also where another program is
  /// writing the same, or something is left at the `.part`. A path that stands for a descriptor of
  /// this process, as /dev/stdout does, is added to.
  [[nodiscard]] static Result<FileWriter> open(const std::filesystem::path& path,
                                               Readers readers = Readers::everybody);
  FileWriter(FileWriter&& other) noexcept;
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;
  FileWriter& operator=(FileWriter&&) = delete;
  ~FileWriter();

  /// Adds to the end. Fails with Fault::file.
  [[nodiscard]] Result<void> append(std::string_view content);
  /// Puts the whole file at its place. Fails with Fault::file, and leaves the `.part` then, since
  /// it may be all there is of a session.
  [[nodiscard]] Result<void> finish();
  /// Ends, and leaves what was written as the `.part` beside the final place.
  void leave_part();

 private:
  FileWriter(std::filesystem::path path, std::string written_to, int descriptor);
  [[nodiscard]] bool in_place() const { return written_to_ == path_.native(); }
  void close();

  std::filesystem::path path_;
  std::string written_to_;
  int descriptor_;
};
/// Whether a `FileWriter` of some program has begun this file and not ended.
[[nodiscard]] bool is_being_written(const std::filesystem::path& path);

/// Writes content in memory as `FileWriter` does.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::string_view content,
                                      Readers readers = Readers::everybody);

}  // namespace tuina
