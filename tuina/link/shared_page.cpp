// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/shared_page.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace tuina::link {

Result<SharedMemory> SharedMemory::map(const std::string& name, std::size_t bytes, Use use) {
  constexpr mode_t only_me = 0600;
  const bool make = use == Use::make;
  const int access = make ? O_RDWR | O_CREAT | O_EXCL : use == Use::write ? O_RDWR : O_RDONLY;
  if (make) shm_unlink(name.c_str());  // of a process that was killed
  const int file = shm_open(name.c_str(), access, only_me);
  if (file < 0 && errno == ENOENT)
    return fail(Fault::device, "the link {}: nobody has made it; the session does, when it begins",
                name);
  if (file < 0) return fail(Fault::device, "the link {}: {}", name, std::strerror(errno));
  SharedMemory memory;
  memory.name_ = name;
  memory.bytes_ = bytes;
  memory.made_ = make;
  struct stat status = {};
  const bool fits = make ? ftruncate(file, static_cast<off_t>(bytes)) == 0
                         : fstat(file, &status) == 0 && status.st_size == static_cast<off_t>(bytes);
  const int rights = use == Use::read ? PROT_READ : PROT_READ | PROT_WRITE;
  void* begin = fits ? mmap(nullptr, bytes, rights, MAP_SHARED, file, 0) : MAP_FAILED;
  close(file);
  if (begin == MAP_FAILED)
    return fail(Fault::device, "the link {} is not one of this version of tuina", name);
  memory.begin_ = begin;
  return memory;
}

SharedMemory& SharedMemory::operator=(SharedMemory&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(begin_, other.begin_);
  std::swap(bytes_, other.bytes_);
  std::swap(made_, other.made_);
  return *this;
}

SharedMemory::~SharedMemory() {
  if (begin_ != nullptr) munmap(begin_, bytes_);
  if (made_) shm_unlink(name_.c_str());
}

}  // namespace tuina::link
