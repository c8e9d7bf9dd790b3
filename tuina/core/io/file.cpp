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

#include "tuina/core/io/unfinished_file.hpp"

namespace tuina {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

/// Rights of a file that is written: those that it has, for its owner alone where that is wanted.
mode_t rights_of(const std::filesystem::path& target, Readers readers) {
  const mode_t wanted = readers == Readers::owner ? 0600 : 0644;
  struct stat before {};
  if (::stat(target.c_str(), &before) != 0) return wanted;
  const mode_t rights = before.st_mode & 0777;
  return readers == Readers::owner ? rights & wanted : rights;
}

/// A name outlives a loss of power only when its folder is on the disk, too.
void sync_folder_of(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const Descriptor opened{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (opened.fd >= 0) (void)::fsync(opened.fd);  // some file systems know no such thing
}

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
  const bool in_place = is_written_in_place(path);
  const std::filesystem::path target = in_place ? path : behind_links(path);
  const std::filesystem::path written_to = in_place ? path : part_of(target);
  std::error_code ignored;
  if (std::filesystem::is_symlink(target, ignored))
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(ELOOP));
  const mode_t rights = rights_of(target, readers);
  const int no_link = in_place ? 0 : O_NOFOLLOW;
  const int descriptor =
      ::open(written_to.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | no_link, rights);
  if (descriptor < 0) {
    if (errno == ELOOP) return tl::unexpected(left_there(written_to));
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
  }
  FileWriter writer(target, written_to, descriptor);
  if (in_place) return writer;
  // What another program writes at this moment is not cut off. Some file systems know no locks.
  struct stat found {};
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    writer.leave_part();
    return fail(Fault::file, "{}: another program is writing it", path.string());
  }
  // It may be all that is left of a session.
  if (::fstat(descriptor, &found) != 0 || !S_ISREG(found.st_mode) || found.st_size > 0) {
    writer.leave_part();
    return tl::unexpected(left_there(written_to));
  }
  if (readers == Readers::owner || std::filesystem::exists(target, ignored))
    (void)::fchmod(descriptor, rights);  // some file systems know no rights
  return writer;
}

bool is_being_written(const std::filesystem::path& path) {
  const auto name = part_of(behind_links(path));
  const Descriptor part{::open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW)};
  return part.fd >= 0 && ::flock(part.fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
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
  const bool synced = in_place() || ::fsync(descriptor_) == 0 || errno == EINVAL;
  const int not_synced = errno;
  // A file system over a network may say only now that it is full.
  const bool whole = ::close(std::exchange(descriptor_, -1)) == 0 && synced;
  if (whole && in_place()) return {};
  if (whole && ::rename(written_to_.c_str(), path_.c_str()) == 0) {
    sync_folder_of(path_);
    return {};
  }
  const int cause = synced ? errno : not_synced;
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
