// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "tests/folder.hpp"
#include "tuina/core/random.hpp"

namespace tuina::test {

/// A network between a program and the server of `empty_database` that is cut again and again: each
/// connection ends for both sides after a drawn number of bytes, wherever that falls.
class Relay {
 public:
  Relay(const std::string& address, std::uint64_t seed);
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;
  ~Relay();

  /// The way to the same database through this network.
  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] int cuts() const { return cuts_; }
  /// No cable is pulled from now on.
  void mend() { cutting_ = false; }

 private:
  void listen();
  void carry(int program);

  Folder folder_;
  std::string server_, address_;
  Random random_;
  int listening_ = -1;
  std::atomic<int> cuts_ = 0;
  std::atomic<bool> cutting_ = true, ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::test
