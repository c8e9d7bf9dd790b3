// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/link.hpp"

#include <fcntl.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace tuina::safety {
namespace {

struct Head {
  std::uint64_t layout = 0;
  std::uint64_t bytes = 0;
};

/// What one role writes.
template <typename Frame>
struct Page {
  Head head;
  Slot<Frame> slot;
};

struct Bells {
  Head head;
  std::array<sem_t, roles> of;
};

/// One mapped piece of shared memory; unmapped, and where it was made taken away, with its end.
template <typename Content>
class Mapped {
 public:
  Mapped() = default;
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  ~Mapped() {
    if (content_ != nullptr) munmap(content_, sizeof(Content));
    if (made_) shm_unlink(name_.c_str());
  }

  [[nodiscard]] Result<void> map(const std::string& name, bool make, bool writes) {
    name_ = name;
    constexpr mode_t only_me = 0600;
    const int access = writes ? O_RDWR : O_RDONLY;
    const int file = shm_open(name.c_str(), make ? O_RDWR | O_CREAT | O_TRUNC : access, only_me);
    if (file < 0)
      return fail(Fault::device, "the link {}: {}", name, std::strerror(errno));
    made_ = make;
    struct stat status {};
    const bool fits = make ? ftruncate(file, sizeof(Content)) == 0
                           : fstat(file, &status) == 0 &&
                                 status.st_size == static_cast<off_t>(sizeof(Content));
    void* at = fits ? mmap(nullptr, sizeof(Content), writes || make ? PROT_READ | PROT_WRITE : PROT_READ,
                           MAP_SHARED, file, 0)
                    : MAP_FAILED;
    close(file);
    if (at == MAP_FAILED)
      return fail(Fault::device, "the link {} is not one of this version of tuina", name);
    content_ = static_cast<Content*>(at);
    if (make) {
      new (content_) Content{};
      content_->head = {wire::layout, sizeof(Content)};
    } else if (content_->head.layout != wire::layout || content_->head.bytes != sizeof(Content)) {
      return fail(Fault::device, "the link {} is not one of this version of tuina", name);
    }
    return {};
  }

  [[nodiscard]] Content* operator->() const noexcept { return content_; }

 private:
  std::string name_;
  Content* content_ = nullptr;
  bool made_ = false;
};

}  // namespace

struct Link::Memory {
  Role role = Role::controller;
  Mapped<Page<wire::SensorFrame>> sensors;
  Mapped<Page<wire::ProposalFrame>> proposal;
  Mapped<Page<wire::DriveFrame>> drive;
  Mapped<Bells> bells;

  [[nodiscard]] Result<void> map(const std::string& name, bool make) {
    const std::string prefix = "/tuina-" + name + "-";
    if (auto done = sensors.map(prefix + "sensors", make, role == Role::drives); !done) return done;
    if (auto done = proposal.map(prefix + "proposal", make, role == Role::controller); !done)
      return done;
    if (auto done = drive.map(prefix + "drive", make, role == Role::guard); !done) return done;
    if (auto done = bells.map(prefix + "bells", make, true); !done) return done;
    if (!make) return {};
    for (sem_t& bell : bells->of) {
      if (sem_init(&bell, 1, 0) != 0)
        return fail(Fault::device, "the link {}: {}", name, std::strerror(errno));
    }
    return {};
  }

  void ring() noexcept {
    constexpr int enough = 8;  // nobody counts them
    for (std::size_t i = 0; i < roles; ++i) {
      int waiting = 0;
      if (i == static_cast<std::size_t>(role)) continue;
      if (sem_getvalue(&bells->of[i], &waiting) == 0 && waiting < enough) sem_post(&bells->of[i]);
    }
  }
};

Link::Link(std::unique_ptr<Memory> memory) : memory_(std::move(memory)) {}
Link::Link(Link&&) noexcept = default;
Link& Link::operator=(Link&&) noexcept = default;
Link::~Link() = default;

Result<Link> Link::create(const std::string& name, Role role) {
  auto memory = std::make_unique<Memory>();
  memory->role = role;
  if (auto mapped = memory->map(name, true); !mapped) return tl::unexpected(mapped.error());
  return Link(std::move(memory));
}

Result<Link> Link::open(const std::string& name, Role role) {
  auto memory = std::make_unique<Memory>();
  memory->role = role;
  if (auto mapped = memory->map(name, false); !mapped) return tl::unexpected(mapped.error());
  return Link(std::move(memory));
}

void Link::write(const wire::SensorFrame& frame) noexcept {
  memory_->sensors->slot.write(frame);
  memory_->ring();
}
void Link::write(const wire::ProposalFrame& frame) noexcept {
  memory_->proposal->slot.write(frame);
  memory_->ring();
}
void Link::write(const wire::DriveFrame& frame) noexcept {
  memory_->drive->slot.write(frame);
  memory_->ring();
}

std::optional<wire::SensorFrame> Link::sensors() const noexcept {
  return memory_->sensors->slot.read();
}
std::optional<wire::ProposalFrame> Link::proposal() const noexcept {
  return memory_->proposal->slot.read();
}
std::optional<wire::DriveFrame> Link::drive() const noexcept { return memory_->drive->slot.read(); }

void Link::wait(std::chrono::steady_clock::time_point deadline) noexcept {
  const auto since = std::chrono::duration_cast<std::chrono::nanoseconds>(deadline.time_since_epoch());
  constexpr long second_ns = 1'000'000'000;
  const timespec until = {.tv_sec = since.count() / second_ns, .tv_nsec = since.count() % second_ns};
  // An interrupted wait is a short one.
  (void)sem_clockwait(&memory_->bells->of[static_cast<std::size_t>(memory_->role)], CLOCK_MONOTONIC,
                      &until);
}

}  // namespace tuina::safety
