// SPDX-License-Identifier: Apache-2.0
// A flood at the live page's port, from a program of its own that costs little: requests, sixteen
// at a time on each of 32 connections; a thousand connections that say a byte now and then; and a
// page that announces messages of 1 GB and sends as much of them as is taken. One thread, by epoll.
// Prints what came of it as one JSON object when it is ended by SIGTERM.
// Usage: flood PORT COOKIE requests,slow,message
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr int askers = 32, pipelined = 16, slow_ones = 1000;
constexpr double slow_every_s = 3.0, message_every_s = 0.1;
volatile std::sig_atomic_t ended = 0;

double now_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

enum class Kind { asker, slow, message };

struct Connection {
  Kind kind;
  int socket = -1;
  bool told = false;  ///< the first thing has been said
  bool answered = false;
  double next_s = 0.0;    ///< when to say more, or to come again
  std::string rest = {};  ///< left to say
};

class Flood {
 public:
  Flood(int port, std::string cookie, std::string_view kinds) : cookie_(std::move(cookie)) {
    at_.sin_family = AF_INET;
    at_.sin_port = htons(static_cast<std::uint16_t>(port));
    at_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    host_ = "127.0.0.1:" + std::to_string(port);
    const std::string one = "GET /api/choices HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n";
    for (int i = 0; i < pipelined; ++i) requests_ += one;
    const auto add = [&](std::string_view name, Kind kind, int many) {
      if (kinds.find(name) != std::string_view::npos)
        all_.insert(all_.end(), static_cast<std::size_t>(many), Connection{.kind = kind});
    };
    add("requests", Kind::asker, askers);
    add("slow", Kind::slow, slow_ones);
    add("message", Kind::message, 1);
  }

  void run() {
    const double began_s = now_s();
    std::array<epoll_event, 256> ready{};
    while (ended == 0) {
      const double time_s = now_s();
      if (time_s >= look_s_) look(time_s);
      const int many = epoll_wait(epoll_, ready.data(), static_cast<int>(ready.size()), 20);
      for (int i = 0; i < many; ++i) {
        auto& event = ready.at(static_cast<std::size_t>(i));
        serve(*static_cast<Connection*>(event.data.ptr), event.events);
      }
    }
    std::printf(
        "{\"seconds\": %.3f, \"requests_sent\": %lld, \"requests_answered\": %lld, "
        "\"slow_opened\": %lld, \"slow_most\": %lld, \"messages\": %lld, \"messages_cut\": %lld, "
        "\"message_bytes\": %lld}\n",
        now_s() - began_s, sent_, answered_, slow_opened_, slow_most_, messages_, messages_cut_,
        message_bytes_);
  }

 private:
  void look(double time_s) {
    constexpr double look_every_s = 0.02;
    look_s_ = time_s + look_every_s;
    for (Connection& one : all_) {
      if (one.socket < 0 && time_s >= one.next_s)
        open(one);
      else if (one.kind == Kind::slow && one.told && time_s >= one.next_s)
        say_a_byte(one, time_s);
    }
  }

  void open(Connection& one) {
    one.socket = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (one.socket < 0) return;
    one.told = one.answered = false;
    if (::connect(one.socket, reinterpret_cast<const sockaddr*>(&at_), sizeof at_) != 0 &&
        errno != EINPROGRESS)
      return close(one, 0.05);
    epoll_event event{.events = EPOLLIN | EPOLLOUT, .data = {.ptr = &one}};
    epoll_ctl(epoll_, EPOLL_CTL_ADD, one.socket, &event);
  }

  void close(Connection& one, double again_in_s) {
    if (one.kind == Kind::slow && one.told) --slow_now_;
    if (one.kind == Kind::message && one.answered) ++messages_cut_;
    ::close(one.socket);
    one.socket = -1;
    one.rest.clear();
    one.next_s = now_s() + again_in_s;
  }

  void say_a_byte(Connection& one, double time_s) {
    if (::send(one.socket, ".", 1, MSG_NOSIGNAL) != 1) return close(one, 0.0);
    one.next_s = time_s + slow_every_s;
  }

  void wait_for(Connection& one, std::uint32_t events) const {
    epoll_event event{.events = events, .data = {.ptr = &one}};
    epoll_ctl(epoll_, EPOLL_CTL_MOD, one.socket, &event);
  }

  void serve(Connection& one, std::uint32_t events) {
    if (one.socket < 0) return;
    if ((events & EPOLLOUT) != 0U && (events & (EPOLLERR | EPOLLHUP)) == 0U) say(one);
    if (one.socket < 0 || (events & ~static_cast<std::uint32_t>(EPOLLOUT)) == 0U) return;
    std::array<char, 16384> bytes;
    const auto got = ::recv(one.socket, bytes.data(), bytes.size(), 0);
    if (got < 0 && errno == EAGAIN) return;
    if (got <= 0) return close(one, one.kind == Kind::message ? message_every_s : 0.0);
    if (!one.answered && one.kind == Kind::asker) ++answered_;
    if (!one.answered && one.kind == Kind::message) begin_message(one);
    one.answered = true;
  }

  void say(Connection& one) {
    if (!one.told) {
      one.told = true;
      one.rest = first_words(one.kind);
      if (one.kind == Kind::slow) {
        ++slow_opened_;
        slow_most_ = std::max(slow_most_, ++slow_now_);
        one.next_s = now_s() + slow_every_s;
      }
    }
    if (one.kind == Kind::message && one.answered) one.rest.resize(1 << 16, 'x');
    const auto sent = ::send(one.socket, one.rest.data(), one.rest.size(), MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN ? void() : close(one, message_every_s);
    if (one.kind == Kind::asker && static_cast<std::size_t>(sent) == one.rest.size())
      sent_ += pipelined;
    if (one.kind == Kind::message && one.answered) message_bytes_ += sent;
    one.rest.erase(0, static_cast<std::size_t>(sent));
    if (one.rest.empty() && !(one.kind == Kind::message && one.answered)) wait_for(one, EPOLLIN);
  }

  [[nodiscard]] std::string first_words(Kind kind) const {
    if (kind == Kind::asker) return requests_;
    if (kind == Kind::slow) return "GET / HTTP/1.1\r\nHost: 127.0";
    return "GET /live HTTP/1.1\r\nHost: " + host_ + "\r\nOrigin: http://" + host_ +
           "\r\nCookie: " + cookie_ +
           "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dHVpbmEgaXMgYSBmbG9vZA==\r\n\r\n";
  }

  void begin_message(Connection& one) {
    ++messages_;
    one.rest = std::string("\x81\xff\0\0\0\0\x40\0\0\0mask", 14);
    wait_for(one, EPOLLIN | EPOLLOUT);
  }

  int epoll_ = epoll_create1(EPOLL_CLOEXEC);
  sockaddr_in at_{};
  std::string cookie_, host_, requests_;
  std::vector<Connection> all_;
  double look_s_ = 0.0;
  long long sent_ = 0, answered_ = 0, slow_opened_ = 0, slow_now_ = 0, slow_most_ = 0;
  long long messages_ = 0, messages_cut_ = 0, message_bytes_ = 0;
};

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fputs("flood PORT COOKIE requests,slow,message\n", stderr);
    return 1;
  }
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 4096);
  setrlimit(RLIMIT_NOFILE, &files);
  std::signal(SIGTERM, [](int) { ended = 1; });
  Flood(std::atoi(words[1]), words[2], words[3]).run();
  return 0;
}
