// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

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
  // An oversized file is refused before memory is allocated.
  if (static_cast<std::size_t>(status.st_size) > limit_bytes) {
    return fail(Fault::bad_input, "{}: {} bytes, at most {} are read", path.string(),
                status.st_size, limit_bytes);
  }
  // A pipe or device has no size and is read into a doubling buffer, so its limit is lower.
  constexpr std::size_t max_without_size = std::size_t{128} << 20;
  if (!S_ISREG(status.st_mode)) limit_bytes = std::min(limit_bytes, max_without_size);
  std::string content;
  std::size_t size = 0;
  content.resize(static_cast<std::size_t>(status.st_size) + 1);
  // Reading ends at the end of the data, because the size of a pipe is unknown.
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

FileWriter::FileWriter(std::filesystem::path path, std::string written_to, int descriptor)
    : path_(std::move(path)), written_to_(std::move(written_to)), descriptor_(descriptor) {}

FileWriter::FileWriter(FileWriter&& other) noexcept
    : path_(std::move(other.path_)),
      written_to_(std::move(other.written_to_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

FileWriter::~FileWriter() {
  if (descriptor_ < 0) return;
  close();
  if (!in_place()) ::unlink(written_to_.c_str());
}

void FileWriter::close() {
  ::close(std::exchange(descriptor_, -1));
}

void FileWriter::leave_part() {
  if (descriptor_ >= 0) close();
}

Result<FileWriter> FileWriter::open(const std::filesystem::path& path, Readers readers) {
  // A device or a pipe (/dev/stdout) is written in place: it cannot be renamed over.
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool in_place =
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  std::string written_to = in_place ? path.string() : path.string() + ".part";
  const mode_t mode = readers == Readers::owner ? 0600 : 0644;
  const int descriptor = ::open(written_to.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, mode);
  if (descriptor < 0) {
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
  }
  // What another program writes at this moment is not cut off. Some file systems know no locks.
  if (!in_place && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor);
    return fail(Fault::file, "{}: another program is writing it", path.string());
  }
  if (!in_place && ::ftruncate(descriptor, 0) != 0) {
    const int cause = errno;
    ::close(descriptor);
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(cause));
  }
  return FileWriter(path, std::move(written_to), descriptor);
}

bool is_being_written(const std::filesystem::path& path) {
  const int part = ::open((path.string() + ".part").c_str(), O_RDONLY | O_CLOEXEC);
  if (part < 0) return false;
  const bool held = ::flock(part, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(part);
  return held;
}

Result<void> FileWriter::append(std::string_view content) {
  while (!content.empty()) {
    const ssize_t put = ::write(descriptor_, content.data(), content.size());
    if (put < 0) {
      return fail(Fault::file, "{}: cannot be written: {}", path_.string(), std::strerror(errno));
    }
    content.remove_prefix(static_cast<std::size_t>(put));
  }
  return {};
}

Result<void> FileWriter::finish() {
  // A file system over a network may say only now that it is full.
  const bool whole = ::close(std::exchange(descriptor_, -1)) == 0;
  if (whole && (in_place() || ::rename(written_to_.c_str(), path_.c_str()) == 0)) return {};
  const int cause = errno;
  if (!in_place()) ::unlink(written_to_.c_str());
  return fail(Fault::file, "{}: cannot be written: {}", path_.string(), std::strerror(cause));
}

Result<void> write_file(const std::filesystem::path& path, std::string_view content,
                        Readers readers) {
  auto file = FileWriter::open(path, readers);
  if (!file) return tl::unexpected(file.error());
  if (auto written = file->append(content); !written) return written;
  return file->finish();
}

}  // namespace tuina
