// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "tuina/core/result.hpp"
#include "tuina/web/certificate.hpp"

namespace tuina::web {

/// Connections of a door at once; one that has not shaken hands makes place for one that comes.
inline constexpr int max_links = 256;

/// The door to a network: takes connections by TLS and hands what they say, decrypted, to a server
/// at a port of this machine, which can ask from where a connection comes and refuse those that did
/// not come through the door. (CivetWeb as Debian has it knows no OpenSSL of today.)
///
/// One thread serves all of them, each in turn: those that are in before those that come, of whom
/// each turn takes a few. Of a connection 16 KiB wait each way; who does not read is not read from.
/// Hands are shaken within 10 s.
class TlsDoor {
 public:
  /// `address` as numbers; port 0 takes a free one. Fault::usage: it is no address. Fault::device:
  /// it is none of this machine, or the port is not free.
  [[nodiscard]] static Result<std::unique_ptr<TlsDoor>> open(const std::string& address, int port,
                                                             Certificate certificate,
                                                             int inner_port);
  ~TlsDoor();
  TlsDoor(const TlsDoor&) = delete;
  TlsDoor& operator=(const TlsDoor&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  /// The machine whose connection the door hands on from this port; nothing: it is not the door's.
  [[nodiscard]] std::optional<std::string> caller(int inner_source_port) const;

  class Link;  ///< one connection

 private:
  TlsDoor(int listener, int port, Certificate certificate, int inner_port);
  void serve();
  [[nodiscard]] bool turn(double now_s, bool at_once);
  void let_in(double now_s);
  void make_place();
  [[nodiscard]] bool hand_on(Link& link);

  int listener_, port_, inner_port_;
  Certificate certificate_;
  std::map<std::uint64_t, std::unique_ptr<Link>> links_;  ///< by the order of their coming
  std::uint64_t last_ = 0;
  mutable std::mutex mutex_;
  std::map<int, std::string> callers_;  ///< by the port from which the door hands on
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::web
