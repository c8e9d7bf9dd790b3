// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "tuina/web/tls_door.hpp"

struct ssl_st;  // of OpenSSL

namespace tuina::web {

/// A connection from elsewhere, by TLS, and that to the server within. Nothing of it waits.
class TlsDoor::Link {
 public:
  /// Takes the socket. Whoever has not shaken hands by `now_s` and 10 s is to be dropped.
  Link(const Certificate& certificate, int outer, std::string caller, double now_s);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  enum class State : std::uint8_t { shaking, shaken, open, over };
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const std::string& caller() const { return caller_; }
  [[nodiscard]] int inner_source_port() const { return source_port_; }
  [[nodiscard]] bool late(double now_s) const { return now_s > until_s_; }

  /// What the two sockets wait for.
  [[nodiscard]] std::array<pollfd, 2> waits_for() const;
  /// A step of shaking hands.
  void shake();
  /// Connects to the server, from a port that is known before the server sees it.
  [[nodiscard]] bool reserve();
  [[nodiscard]] bool connect(int inner_port);
  /// Moves what there is, both ways; true where more could be moved at once.
  [[nodiscard]] bool move(double now_s);

 private:
  /// Bytes on their way; filled again when all have gone.
  struct Piece {
    std::array<char, 16384> bytes;
    std::size_t begin = 0, end = 0;
    [[nodiscard]] bool empty() const { return begin == end; }
  };
  [[nodiscard]] bool read_outer();
  [[nodiscard]] bool write_inner();
  [[nodiscard]] bool read_inner();
  [[nodiscard]] bool write_outer();
  void answer_plain();

  std::unique_ptr<ssl_st, void (*)(ssl_st*)> tls_;
  int outer_, inner_ = -1, source_port_ = 0;
  std::string caller_;
  double until_s_;
  State state_ = State::shaking;
  bool wants_write_ = false;  ///< TLS, while hands are shaken
  bool outer_ended_ = false, inner_ended_ = false;
  Piece inwards_, outwards_;
};

}  // namespace tuina::web
