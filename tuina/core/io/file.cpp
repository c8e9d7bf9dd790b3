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

/// A descriptor of this process takes more at its own end, as the shell has opened it.
int open_in_place(const std::filesystem::path& path) {
  if (const auto own = open_descriptor_of(path)) return ::fcntl(*own, F_DUPFD_CLOEXEC, 0);
  return ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

/// Whether the file that was opened still has that name: its writer may have renamed it since.
bool is_still(const std::filesystem::path& name, const struct stat& opened) {
  struct stat now {};
  return ::lstat(name.c_str(), &now) == 0 && now.st_dev == opened.st_dev &&
         now.st_ino == opened.st_ino;
}

/// Opens and locks the part of a file. It is made here, or it is empty and of this user: what is in
/// it may be all that is left of a session, and what is somebody else's may be read by them.
Result<int> open_part(const std::filesystem::path& path, const std::filesystem::path& part,
                      mode_t rights) {
  constexpr int max_tries = 1000;  // each of them lost to another program that was done with it
  // A pipe of that name would be waited for.
  constexpr int anyhow = O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  for (int i = 0; i < max_tries; ++i) {
    int descriptor = ::open(part.c_str(), anyhow | O_CREAT | O_EXCL, rights);
    const bool made = descriptor >= 0;
    if (!made && errno != EEXIST)
      return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
    if (!made) descriptor = ::open(part.c_str(), anyhow);
    if (descriptor < 0 && errno == ENOENT) continue;
    if (descriptor < 0) return tl::unexpected(left_there(part));
    // What another program writes at this moment is not cut off. Some file systems know no locks.
    const bool taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    struct stat found {};
    const bool known = ::fstat(descriptor, &found) == 0;
    const bool is_there = known && is_still(part, found);
    // Of one that was made here the file system may say another user.
    if (!taken && is_there && (is_empty_and_own(found) || (made && found.st_size == 0)))
      return descriptor;
    ::close(descriptor);
    if (taken) return fail(Fault::file, "{}: another program is writing it", path.string());
    if (is_there) return tl::unexpected(left_there(part));
  }
  return fail(Fault::file, "{}: other programs write it again and again", path.string());
}

/// Whether what was written is on the disk. A file system over a network may say only when a
/// descriptor is closed that it is full, and the file is still needed for its lock.
bool is_on_disk(int descriptor) {
  if (::fsync(descriptor) != 0 && errno != EINVAL) return false;
  const int again = ::dup(descriptor);
  return again >= 0 && ::close(again) == 0;
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

// The name goes before the lock does: whoever comes next then finds its own file, not this one.
FileWriter::~FileWriter() {
  if (descriptor_ < 0) return;
  if (!in_place()) ::unlink(written_to_.c_str());
  close();
}

void FileWriter::close() {
  ::close(std::exchange(descriptor_, -1));
}

void FileWriter::leave_part() {
  if (descriptor_ >= 0) close();
}

Result<FileWriter> FileWriter::open(const std::filesystem::path& path, Readers readers) {
  if (is_written_in_place(path)) {
    const int descriptor = open_in_place(path);
    if (descriptor < 0)
      return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(errno));
    return FileWriter(path, path, descriptor);
  }
  const std::filesystem::path target = behind_links(path);
  std::error_code ignored;
  if (std::filesystem::is_symlink(target, ignored))
    return fail(Fault::file, "{}: cannot be written: {}", path.string(), std::strerror(ELOOP));
  const std::filesystem::path written_to = part_of(target);
  const mode_t rights = rights_of(target, readers);
  const auto part = open_part(path, written_to, rights);
  if (!part) return tl::unexpected(part.error());
  FileWriter writer(target, written_to, *part);
  if (readers == Readers::owner || std::filesystem::exists(target, ignored))
    (void)::fchmod(*part, rights);  // some file systems know no rights
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
  if (in_place()) {
    if (::close(std::exchange(descriptor_, -1)) == 0) return {};
    return fail(Fault::file, "{}: cannot be written: {}", path_.string(), std::strerror(errno));
  }
  const bool whole = is_on_disk(descriptor_) && ::rename(written_to_.c_str(), path_.c_str()) == 0;
  const int cause = errno;
  // It may be all there is of a session, and most of it can be read.
  leave_part();
  if (!whole)
    return fail(Fault::file, "{}: cannot be written: {}; what could be is left as {}",
                path_.string(), std::strerror(cause), written_to_);
  sync_folder_of(path_);
  return {};
}

Result<void> write_file(const std::filesystem::path& path, std::string_view content,
                        Readers readers) {
  auto file = FileWriter::open(path, readers);
  if (!file) return tl::unexpected(file.error());
  if (auto written = file->append(content); !written) return written;
  return file->finish();
}

}  // namespace tuina
