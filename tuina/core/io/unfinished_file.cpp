// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/unfinished_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace {

constexpr int max_links = 40;  // as the kernel follows

}  // namespace

bool is_written_in_place(const std::filesystem::path& path) {
  if (open_descriptor_of(path)) return true;
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

std::optional<int> open_descriptor_of(std::filesystem::path path) {
  std::error_code ignored;
  const auto descriptors = std::filesystem::canonical("/proc/self/fd", ignored);
  for (int i = 0; i < max_links && !descriptors.empty(); ++i) {
    const auto number = to_number<int>(path.filename().native());
    if (number && std::filesystem::canonical(path.parent_path(), ignored) == descriptors)
      return number;
    std::error_code no_link;
    const auto target = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = path.parent_path() / target;
  }
  return std::nullopt;
}

std::filesystem::path behind_links(std::filesystem::path path) {
  for (int i = 0; i < max_links; ++i) {
    std::error_code no_link;
    const auto target = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = path.parent_path() / target;
  }
  return path;
}

std::filesystem::path part_of(const std::filesystem::path& target) {
  return target.native() + ".part";
}

Error left_there(const std::filesystem::path& part) {
  return {Fault::file,
          fmt::format("{}: is there already, left by a command that was killed or by another "
                      "program; move it away, or remove it",
                      part.string())};
}

Result<int> begin_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const fs::path part = part_of(folder);
  std::error_code error;
  if (part.has_parent_path()) fs::create_directories(part.parent_path(), error);
  if (!fs::create_directory(part, error)) {
    if (error && error != std::errc::file_exists)
      return fail(Fault::file, "{}: it cannot be made: {}", part.string(), error.message());
    if (is_being_written(folder))
      return fail(Fault::file, "{}: another program is writing it", folder.string());
    return tl::unexpected(left_there(part));
  }
  const int lock = ::open(part.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (lock >= 0) (void)::flock(lock, LOCK_EX | LOCK_NB);  // some file systems know no locks
  return lock;
}

bool is_empty_and_own(const struct stat& found) {
  return S_ISREG(found.st_mode) && found.st_size == 0 && found.st_uid == ::geteuid() &&
         found.st_nlink == 1;
}

Result<void> check_can_begin(const std::filesystem::path& path) {
  if (is_written_in_place(path)) return {};
  const auto part = part_of(behind_links(path));
  struct stat found {};
  if (::lstat(part.c_str(), &found) == 0) {
    if (is_being_written(path))
      return fail(Fault::file, "{}: another program is writing it", path.string());
    if (is_empty_and_own(found)) return {};
    return tl::unexpected(left_there(part));
  }
  if (errno != ENAMETOOLONG) return {};
  return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
}

}  // namespace tuina
