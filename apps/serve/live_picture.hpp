// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/cli/options.hpp"
#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// The options `--live` and `--port` of a verb that looks through a camera: what it sees and says,
/// picture after picture, in a browser of this machine. Nothing is steered there.
class LivePicture {
 public:
  LivePicture();
  ~LivePicture();
  LivePicture(const LivePicture&) = delete;
  LivePicture& operator=(const LivePicture&) = delete;

  /// `--live`, and `--port` with it; `shown` says what the page has.
  Option describe(Options& options, const char* shown);
  [[nodiscard]] bool asked() const { return asked_; }
  /// Opens the page where it was asked for, and prints its address to stderr.
  [[nodiscard]] Result<void> begin();
  /// Grey or RGB. Waits for no browser.
  void show(Image picture, std::string told);

 private:
  class Page;
  bool asked_ = false;
  int port_ = 8643;
  std::unique_ptr<Page> page_;
};

}  // namespace tuina::app
