// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/shared_page.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace tuina::link {

namespace {

/// Whether its maker still lives, who holds the lock of it to the end, however that comes.
bool made_by_the_living(int file) {
  if (flock(file, LOCK_SH | LOCK_NB) != 0) return true;
  (void)flock(file, LOCK_UN);
  return false;
}

/// Takes away what a process has left that was killed; false where its maker lives.
bool clear(const std::string& name) {
  const int left = shm_open(name.c_str(), O_RDWR, 0);
  const bool lives = left >= 0 && made_by_the_living(left);
  if (left >= 0) close(left);
  if (!lives) shm_unlink(name.c_str());
  return !lives;
}

}  // namespace

Result<SharedMemory> SharedMemory::map(const std::string& name, std::size_t bytes, Use use) {
  constexpr mode_t only_me = 0600;
  const bool make = use == Use::make;
  const int access = make ? O_RDWR | O_CREAT | O_EXCL : use == Use::write ? O_RDWR : O_RDONLY;
  if (make && !clear(name))
    return fail(Fault::device, "the link {}: a session of this name runs; give another by --link",
                name);
  SharedMemory memory;
  memory.file_ = shm_open(name.c_str(), access, only_me);
  const bool there = memory.file_ >= 0 || errno != ENOENT;
  // Somebody else was first.
  if (make && memory.file_ < 0 && errno == EEXIST)
    return fail(Fault::device, "the link {}: a session of this name runs; give another by --link",
                name);
  if (there && memory.file_ < 0)
    return fail(Fault::device, "the link {}: {}", name, std::strerror(errno));
  if (!there || (!make && !made_by_the_living(memory.file_)))
    return fail(Fault::device, "the link {}: nobody has made it; the session does, when it begins",
                name);
  memory.name_ = name;
  memory.bytes_ = bytes;
  memory.made_ = make;
  struct stat status = {};
  const bool fits =
      make ? flock(memory.file_, LOCK_EX) == 0 &&
                 ftruncate(memory.file_, static_cast<off_t>(bytes)) == 0
           : fstat(memory.file_, &status) == 0 && status.st_size == static_cast<off_t>(bytes);
  const int rights = use == Use::read ? PROT_READ : PROT_READ | PROT_WRITE;
  void* begin = fits ? mmap(nullptr, bytes, rights, MAP_SHARED, memory.file_, 0) : MAP_FAILED;
  if (begin == MAP_FAILED)
    return fail(Fault::device, "the link {} is not one of this version of tuina", name);
  memory.begin_ = begin;
  return memory;
}

bool SharedMemory::maker_lives() const noexcept {
  return made_ || made_by_the_living(file_);
}

void SharedMemory::clear_left(const std::string& name) noexcept {
  (void)clear(name);
}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(begin_, other.begin_);
  std::swap(bytes_, other.bytes_);
  std::swap(made_, other.made_);
  std::swap(file_, other.file_);
  return *this;
}

SharedMemory::~SharedMemory() {
  if (begin_ != nullptr) munmap(begin_, bytes_);
  if (made_) shm_unlink(name_.c_str());
  if (file_ >= 0) close(file_);
}

}  // namespace tuina::link
