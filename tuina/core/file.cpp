// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tuina {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

}  // namespace

Result<std::string> read_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.fd < 0)
    return fail(Fault::file, "{}: cannot be read: {}", path.string(), std::strerror(errno));
  struct stat status {};
  if (::fstat(file.fd, &status) != 0 || S_ISDIR(status.st_mode)) {
    return fail(Fault::file, "{}: is a folder, a file is needed", path.string());
  }
  // A size beyond the limit is refused before memory is taken for it.
  if (static_cast<std::size_t>(status.st_size) > limit_bytes) {
    return fail(Fault::bad_input, "{}: {} bytes, at most {} are read", path.string(),
                status.st_size, limit_bytes);
  }
  // What tells no size (a pipe, a device) grows by doubling, so it may only become this large.
  constexpr std::size_t most_without_size = std::size_t{128} << 20;
  if (!S_ISREG(status.st_mode)) limit_bytes = std::min(limit_bytes, most_without_size);
  std::string content;
  std::size_t size = 0;
  content.resize(static_cast<std::size_t>(status.st_size) + 1);
  // A pipe has no size to trust, so the end of the data decides, not the status.
  while (true) {
    const ssize_t got = ::read(file.fd, content.data() + size, content.size() - size);
    if (got < 0)
      return fail(Fault::file, "{}: cannot be read: {}", path.string(), std::strerror(errno));
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (size > limit_bytes) {
      return fail(Fault::bad_input, "{}: larger than {} bytes", path.string(), limit_bytes);
    }
    if (size == content.size()) content.resize(std::min(2 * content.size(), limit_bytes + 1));
  }
  content.resize(size);
  return content;
}

Result<void> write_file(const std::filesystem::path& path, std::string_view content) {
  // A device or a pipe (/dev/stdout) is written in place: there is nothing to rename over.
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool in_place =
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  const std::string beside = in_place ? path.string() : path.string() + ".part";
  {
    const Descriptor file{::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (file.fd < 0) {
      return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
    }
    while (!content.empty()) {
      const ssize_t put = ::write(file.fd, content.data(), content.size());
      if (put < 0) {
        const int cause = errno;
        if (!in_place) ::unlink(beside.c_str());
        return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(cause));
      }
      content.remove_prefix(static_cast<std::size_t>(put));
    }
  }
  if (!in_place && ::rename(beside.c_str(), path.c_str()) != 0) {
    const int cause = errno;
    ::unlink(beside.c_str());
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(cause));
  }
  return {};
}

}  // namespace tuina
