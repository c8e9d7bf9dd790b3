// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tuina/web/door.hpp"
#include "tuina/web/frame_gate.hpp"

struct ssl_st;  // of OpenSSL

namespace tuina::web {

/// A connection from elsewhere, by TLS where there is a certificate, and that to the server within.
/// Nothing of it waits.
class Door::Link {
 public:
  /// Takes the socket. Whoever has not said what it wants by `now_s` and 10 s is to be dropped.
  Link(const std::optional<Certificate>& certificate, int outer, std::string caller, double now_s);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Hands are shaken, the head of a request comes, it is there, its answer comes, all is said.
  enum class State : std::uint8_t { shaking, heading, ready, open, over };
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const std::string& caller() const { return caller_; }
  [[nodiscard]] int inner_source_port() const { return source_port_; }
  [[nodiscard]] bool late(double now_s) const { return now_s > until_s_; }

  /// What the two sockets wait for.
  [[nodiscard]] std::array<pollfd, 2> waits_for() const;
  /// A step of shaking hands.
  void shake();
  /// What has come of the head of the request.
  void hear_head();
  /// Connects to the server, from a port that is known before the server sees it.
  [[nodiscard]] bool reserve();
  [[nodiscard]] bool connect(int inner_port);
  /// Moves what there is, both ways; true where more could be moved at once.
  [[nodiscard]] bool move(double now_s);

 private:
  /// Bytes on their way; filled again when all have gone.
  struct Piece {
    std::string bytes;
    std::size_t sent = 0;
    [[nodiscard]] bool empty() const { return sent == bytes.size(); }
    [[nodiscard]] std::string_view left() const { return std::string_view(bytes).substr(sent); }
  };
  /// The next bytes of the client, put into `room`; empty: there are none now, or it has ended.
  [[nodiscard]] std::string_view hear_outer(std::span<char> room);
  [[nodiscard]] std::size_t tell_outer(std::string_view bytes);
  [[nodiscard]] bool read_outer();
  [[nodiscard]] bool write_inner();
  [[nodiscard]] bool read_inner();
  [[nodiscard]] bool write_outer();
  void answer_plain();

  std::unique_ptr<ssl_st, void (*)(ssl_st*)> tls_;  ///< or null
  int outer_, inner_ = -1, source_port_ = 0;
  std::string caller_;
  double until_s_;
  State state_ = State::shaking;
  bool wants_write_ = false;  ///< TLS, while hands are shaken
  bool outer_ended_ = false, inner_ended_ = false;
  Piece inwards_, outwards_;
  bool posts_ = false;  ///< a form follows the head, which is no WebSocket's
  FrameGate gate_;
};

}  // namespace tuina::web
