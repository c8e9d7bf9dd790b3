// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

namespace tuina::tests {

/// A serial line that no hardware has: a host opens its address, an emulated device has its other
/// end, which never blocks.
class PseudoTerminal {
 public:
  /// False below a root folder without a /dev/pts, for one; says so on the standard error.
  static bool exist() {
    static const bool there = [] {
      try {
        PseudoTerminal();
        return true;
      } catch (const std::runtime_error& why) {
        std::fprintf(stderr, "tests of serial lines are skipped: %s\n", why.what());
        return false;
      }
    }();
    return there;
  }

  PseudoTerminal() : end_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    const char* name = ::grantpt(end_) == 0 && ::unlockpt(end_) == 0 ? ::ptsname(end_) : nullptr;
    if (name == nullptr)
      throw std::runtime_error("there are no pseudo terminals here; is /dev/pts mounted?");
    address_ = name;
    // While nobody else has it open, its other end would say that it hangs up.
    keep_ = ::open(name, O_RDWR | O_NOCTTY);
  }
  ~PseudoTerminal() { unplug(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] int end() const { return end_; }  ///< below 0 once it is unplugged
  void unplug() {
    for (int* number : {&end_, &keep_})
      if (*number >= 0) ::close(std::exchange(*number, -1));
  }

 private:
  int end_, keep_ = -1;
  std::string address_;
};

}  // namespace tuina::tests
