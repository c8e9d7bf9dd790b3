// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/door.hpp"

#include <netdb.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <vector>

#include "tuina/core/stopwatch.hpp"
#include "tuina/web/door_link.hpp"

namespace tuina::web {
namespace {

// A turn does no more of what is dear, so that those who are in wait some milliseconds at most.
constexpr int max_shakes_a_turn = 4, max_new_a_turn = 16;
constexpr int look_every_ms = 200;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses resolve(const std::string& address, int port) {
  addrinfo wanted{};
  wanted.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  wanted.ai_socktype = SOCK_STREAM;
  std::string bare = address;
  if (bare.starts_with('[') && bare.ends_with(']')) bare = bare.substr(1, bare.size() - 2);
  addrinfo* found = nullptr;
  if (getaddrinfo(bare.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0)
    found = nullptr;
  return {found, &freeaddrinfo};
}

std::string host_of(const sockaddr_storage& at, socklen_t size) {
  std::array<char, NI_MAXHOST> host{};
  if (getnameinfo(reinterpret_cast<const sockaddr*>(&at), size, host.data(), host.size(), nullptr,
                  0, NI_NUMERICHOST) != 0)
    return "?";
  const std::string_view shown = host.data(), mapped = "::ffff:";  // IPv4 through a socket of IPv6
  return std::string(shown.starts_with(mapped) ? shown.substr(mapped.size()) : shown);
}

int port_of(int socket) {
  sockaddr_storage at{};
  socklen_t size = sizeof at;
  std::array<char, NI_MAXSERV> port{};
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size) != 0 ||
      getnameinfo(reinterpret_cast<const sockaddr*>(&at), size, nullptr, 0, port.data(),
                  port.size(), NI_NUMERICSERV) != 0)
    return 0;
  return std::stoi(port.data());
}

// Two files each; some are left for sessions and their records.
std::size_t links_of_this_process() {
  constexpr rlim_t others = 256, fewest = 64;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return fewest;
  const rlim_t left = std::max(files.rlim_cur, others + 2 * fewest) - others;
  return std::min<std::size_t>(max_links, left / 2);
}

}  // namespace

Door::Door(int listener, int port, std::optional<Certificate> certificate, int inner_port)
    : listener_(listener),
      port_(port),
      inner_port_(inner_port),
      links_at_once_(links_of_this_process()),
      certificate_(std::move(certificate)),
      thread_([this] { serve(); }) {}

Result<std::unique_ptr<Door>> Door::open(const std::string& address, int port,
                                         std::optional<Certificate> certificate, int inner_port) {
  const Addresses at = resolve(address, port);
  if (!at) return fail(Fault::usage, "--listen {}: an address in numbers is needed", address);
  const int listener =
      ::socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, at->ai_protocol);
  const int yes = 1;
  ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (listener < 0 || ::bind(listener, at->ai_addr, at->ai_addrlen) != 0 ||
      ::listen(listener, SOMAXCONN) != 0) {
    if (listener >= 0) ::close(listener);
    return fail(Fault::device,
                "{}:{}: cannot be listened at; is another program there already, and is the "
                "address one of this machine?",
                address, port);
  }
  return std::unique_ptr<Door>(
      new Door(listener, port_of(listener), std::move(certificate), inner_port));
}

Door::~Door() {
  ends_ = true;
  thread_.join();
  ::close(listener_);
}

std::optional<std::string> Door::caller(int inner_source_port) const {
  const std::lock_guard lock(mutex_);
  const auto found = callers_.find(inner_source_port);
  return found == callers_.end() ? std::nullopt : std::optional(found->second);
}

void Door::serve() {
  // Who has gone is told by what a write returns.
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
  const Stopwatch clock;
  for (bool at_once = false; !ends_;) at_once = turn(clock.seconds(), at_once);
}

// Waits until a socket is ready, and serves each that is; true where something is left to do.
bool Door::turn(double now_s, bool at_once) {
  std::vector<pollfd> sockets{{.fd = listener_, .events = POLLIN, .revents = 0}};
  std::vector<std::uint64_t> of;
  for (const auto& [number, link] : links_) {
    for (const pollfd& socket : link->waits_for()) sockets.push_back(socket);
    of.push_back(number);
  }
  ::poll(sockets.data(), sockets.size(), at_once ? 0 : look_every_ms);
  bool more = false;
  int shakes = 0;
  std::vector<std::uint64_t> over;
  for (std::size_t i = 0; i < of.size(); ++i) {
    Link& link = *links_[of[i]];
    const bool ready = (sockets[1 + 2 * i].revents | sockets[2 + 2 * i].revents) != 0;
    if (link.state() == Link::State::shaking && ready && shakes++ < max_shakes_a_turn) link.shake();
    if (link.state() == Link::State::heading && ready) link.hear_head();
    const bool fresh = link.state() == Link::State::ready;
    if (fresh && !hand_on(link)) over.push_back(of[i]);
    if (link.state() == Link::State::open && (ready || fresh || at_once) && link.move(now_s))
      more = true;
    if (link.state() == Link::State::over || link.late(now_s)) over.push_back(of[i]);
  }
  for (const std::uint64_t number : over) {
    const auto gone = links_.find(number);
    if (gone == links_.end()) continue;
    const std::lock_guard lock(mutex_);
    callers_.erase(gone->second->inner_source_port());
    links_.erase(gone);
  }
  if (sockets.front().revents != 0) let_in(now_s);
  return more;
}

// The server asks whose connection it is as soon as it is there, so it is written down before.
bool Door::hand_on(Link& link) {
  if (!link.reserve()) return false;
  {
    const std::lock_guard lock(mutex_);
    callers_[link.inner_source_port()] = link.caller();
  }
  return link.connect(inner_port_);
}

void Door::let_in(double now_s) {
  for (int i = 0; i < max_new_a_turn; ++i) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    const int outer = ::accept4(listener_, reinterpret_cast<sockaddr*>(&from), &size,
                                SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (outer < 0) return;
    if (links_.size() >= links_at_once_) make_place();
    if (links_.size() >= links_at_once_) {
      ::close(outer);
      continue;
    }
    links_[++last_] = std::make_unique<Link>(certificate_, outer, host_of(from, size), now_s);
  }
}

// The one that has been there longest without saying what it wants goes.
void Door::make_place() {
  for (auto link = links_.begin(); link != links_.end(); ++link) {
    if (link->second->state() > Link::State::heading) continue;
    links_.erase(link);
    return;
  }
}

}  // namespace tuina::web
