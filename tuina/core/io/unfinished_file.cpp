// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/unfinished_file.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "tuina/core/io/file.hpp"

namespace tuina {

bool is_written_in_place(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

std::filesystem::path behind_links(std::filesystem::path path) {
  constexpr int max_links = 40;  // as the kernel follows
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

Result<void> check_can_begin(const std::filesystem::path& path) {
  if (is_written_in_place(path)) return {};
  const auto part = part_of(behind_links(path));
  struct stat found {};
  if (::lstat(part.c_str(), &found) == 0) {
    if (is_being_written(path))
      return fail(Fault::file, "{}: another program is writing it", path.string());
    if (S_ISREG(found.st_mode) && found.st_size == 0) return {};
    return tl::unexpected(left_there(part));
  }
  if (errno != ENAMETOOLONG) return {};
  return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
}

}  // namespace tuina
