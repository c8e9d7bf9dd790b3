// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/link.hpp"

#include <cerrno>

namespace tuina::link {
namespace {

constexpr std::array called = {"operating", "hand-stop"};  // by those who watch

std::string prefix_of(const std::string& name) {
  return "/tuina-" + name + "-";
}

}  // namespace

Result<Link> Link::map(const std::string& name, Role role, bool make) {
  using Use = SharedMemory::Use;
  constexpr const char* letters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  if (name.empty() || name.find_first_not_of(letters) != std::string::npos)
    return fail(Fault::usage, "--link `{}`: letters, digits, - and _ are needed", name);
  Link link;
  link.role_ = role;
  const std::string prefix = prefix_of(name);
  const auto use = [&](Role writer) {
    return make ? Use::make : role == writer ? Use::write : Use::read;
  };
  auto drives = SharedPage<Drives>::map(prefix + "drives", use(Role::drives));
  if (!drives) return tl::unexpected(drives.error());
  auto controller = SharedPage<Controller>::map(prefix + "controller", use(Role::controller));
  if (!controller) return tl::unexpected(controller.error());
  auto guard = SharedPage<Guard>::map(prefix + "guard", use(Role::guard));
  if (!guard) return tl::unexpected(guard.error());
  constexpr std::array watching = {Role::operating, Role::hand_stop};
  for (std::size_t i = 0; i < safety::watchers; ++i) {
    auto watch = SharedPage<Watch>::map(prefix + called[i], use(watching[i]));
    if (!watch) return tl::unexpected(watch.error());
    link.watchers_[i] = std::move(*watch);
  }
  auto bells = SharedPage<Bells>::map(prefix + "bells", make                     ? Use::make
                                                        : role == Role::onlooker ? Use::read
                                                                                 : Use::write);
  if (!bells) return tl::unexpected(bells.error());
  link.drives_ = std::move(*drives);
  link.controller_ = std::move(*controller);
  link.guard_ = std::move(*guard);
  link.bells_ = std::move(*bells);
  if (!make) return link;
  for (sem_t& bell : link.bells_->of) {
    if (sem_init(&bell, 1, 0) != 0)
      return fail(Fault::device, "the link {}: {}", name, std::strerror(errno));
  }
  return link;
}

Result<Link> Link::create(const std::string& name, Role role) {
  return map(name, role, true);
}

Result<Link> Link::open(const std::string& name, Role role) {
  return map(name, role, false);
}

void Link::clear_left(const std::string& name) {
  for (const char* page : {"drives", "controller", "guard", "bells"})
    SharedMemory::clear_left(prefix_of(name) + page);
  for (const char* page : called) SharedMemory::clear_left(prefix_of(name) + page);
}

void Link::ring() noexcept {
  constexpr int enough = 8;  // nobody counts them
  for (std::size_t i = 0; i < roles; ++i) {
    sem_t& bell = bells_->of[i];
    int waiting = 0;
    if (i == static_cast<std::size_t>(role_)) continue;
    if (sem_getvalue(&bell, &waiting) == 0 && waiting < enough) sem_post(&bell);
  }
}

void Link::write(const wire::SensorFrame& frame) noexcept {
  drives_->sensors.write(frame);
  ring();
}
void Link::write(const wire::ProposalFrame& frame) noexcept {
  controller_->proposal.write(frame);
  ring();
}
void Link::write(const wire::StandFrame& frame) noexcept {
  controller_->stand.write(frame);
  ring();
}
void Link::write(const wire::DriveFrame& frame) noexcept {
  guard_->drive.write(frame);
  ring();
}

void Link::write(const wire::WatchFrame& frame) noexcept {
  watchers_[role_ == Role::hand_stop ? 1 : 0]->watch.write(frame);
  ring();
}

void Link::wait(Deadline deadline) noexcept {
  using std::chrono::duration_cast, std::chrono::nanoseconds, std::chrono::seconds;
  const auto since = deadline.time_since_epoch();
  const timespec until = {.tv_sec = duration_cast<seconds>(since).count(),
                          .tv_nsec = duration_cast<nanoseconds>(since % seconds(1)).count()};
  // A wait that is interrupted is a short one.
  (void)sem_clockwait(&bells_->of[static_cast<std::size_t>(role_)], CLOCK_MONOTONIC, &until);
}

}  // namespace tuina::link
