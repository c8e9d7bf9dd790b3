// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/web/certificate.hpp"
#include "tuina/web/desk.hpp"
#include "tuina/web/outbox.hpp"
#include "tuina/web/request.hpp"

namespace tuina::web {

/// What a server asks of whom it serves, on threads of its own.
struct Site {
  /// Nothing: a WebSocket may open.
  std::function<std::optional<Reply>(const Request&)> answer;
  std::function<void(ClientId, const Request&)> come;
  std::function<void(ClientId)> go;
  std::function<void(ClientId, const Frame&)> hear;          ///< a page
  std::function<void(ClientId, const Frame&)> hear_program;  ///< another program
  /// More than `max_message_bytes` at once, which nobody has read; the client goes.
  std::function<void(ClientId)> say_too_much;
};

/// WebSockets of the page open here, those of other programs at `foxglove::path`.
inline constexpr const char* page_path = "/live";
/// Clients that may be there at once; what comes on top is sent away with 503.
inline constexpr int max_clients = 64;

/// Where a server is reached.
struct Place {
  std::string address = "127.0.0.1";
  int port = 0;  ///< 0 takes a free one
  /// By TLS alone where it is given, and by HTTP where not.
  std::optional<Certificate> certificate = {};
};

/// HTTP and WebSocket at one port, behind a `Door`. Each client has a thread that reads and one
/// that writes, so that none waits for another. A header has 8 KiB at most and 10 s to arrive; a
/// message of a client, max_message_bytes, or its connection is closed. A page sends text alone.
class Server {
 public:
  /// Without a certificate the address is one of `loopback_address`. Fault::device when the port is
  /// not free.
  [[nodiscard]] static Result<std::unique_ptr<Server>> start(const Place& place, Site site);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const noexcept;  ///< where it listens
  /// Nothing of these waits for the client, or fails when it has just gone (`Outbox`).
  void put(ClientId client, Outbox::Slot slot, Frame frame, std::size_t keep = 1);
  /// @{
  /// Takes back what waits in a slot, or sends a frame that must not be left out.
  void drop(ClientId client, Outbox::Slot slot);
  void reply(ClientId client, Frame frame);
  /// @}
  /// Nothing is sent to the client any more, and what it says next ends its connection unheard.
  void dismiss(ClientId client);

  struct Hall;  ///< the connections

 private:
  explicit Server(std::unique_ptr<Hall> hall);
  std::unique_ptr<Hall> hall_;
};

}  // namespace tuina::web
