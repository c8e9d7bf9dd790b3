// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "tuina/core/result.hpp"
#include "tuina/web/certificate.hpp"

namespace tuina::web {

/// Connections of a door at once, or fewer where the process may not open as many files; one that
/// has not yet said what it wants makes place for one that comes.
inline constexpr std::size_t max_links = 1280;

/// The door of a server that is at another port of this machine: takes connections, by TLS where it
/// has a certificate, and hands on what they say. The server can ask from where a connection comes
/// and refuse those that did not come through the door. It is there for what CivetWeb 1.15 as
/// Debian has it cannot do: it knows no OpenSSL of today, gives a thread to whoever connects and
/// says nothing, and takes as much memory for a message as that announces (`FrameGate`).
///
/// One thread serves all of them, each in turn: those that are in before those that come, of whom
/// each turn takes a few. Of a connection 16 KiB wait each way; who does not read is not read from.
/// Hands are shaken and the head of a request is said within 10 s; the server hears of nobody
/// before.
class Door {
 public:
  /// `address` as numbers; port 0 takes a free one. Fault::usage: it is no address. Fault::device:
  /// it is none of this machine, or the port is not free.
  [[nodiscard]] static Result<std::unique_ptr<Door>> open(const std::string& address, int port,
                                                          std::optional<Certificate> certificate,
                                                          int inner_port);
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  /// The machine whose connection the door hands on from this port; nothing: it is not the door's.
  [[nodiscard]] std::optional<std::string> caller(int inner_source_port) const;

  class Link;  ///< one connection

 private:
  Door(int listener, int port, std::optional<Certificate> certificate, int inner_port);
  void serve();
  [[nodiscard]] bool turn(double now_s, bool at_once);
  void let_in(double now_s);
  void make_place();
  [[nodiscard]] bool hand_on(Link& link);

  int listener_, port_, inner_port_;
  std::size_t links_at_once_;
  std::optional<Certificate> certificate_;
  std::map<std::uint64_t, std::unique_ptr<Link>> links_;  ///< by the order of their coming
  std::uint64_t last_ = 0;
  mutable std::mutex mutex_;
  std::map<int, std::string> callers_;  ///< by the port from which the door hands on
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::web
