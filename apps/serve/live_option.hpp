// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "apps/cli/options.hpp"
#include "apps/serve/live_site.hpp"
#include "apps/simulated/ros2_option.hpp"

namespace tuina::app {

/// The option `--live` of a verb that runs one session: the live page on it, where nothing moves
/// before somebody has looked at the plan and armed it there.
class LiveOption {
 public:
  /// `--live`, and `--port` with it.
  Option describe(Options& options);
  [[nodiscard]] bool asked() const { return asked_; }
  /// Opens the page, with the audit log in `folder`, that of the session; prints its address, to
  /// stderr beside JSON. A node of ROS 2 that was begun without a folder is steered by its rules.
  [[nodiscard]] Result<void> begin(const SessionOrder& order, const session::Config& config,
                                   const CommonOptions& common, const Ros2Option& ros2,
                                   const std::filesystem::path& folder);
  /// Who watches and steers the session that begins now; nobody where none was asked for.
  [[nodiscard]] Attendant attendant();
  /// Tells the pages how the session has ended (`LiveSession::State::outcome`), and waits until the
  /// last one has gone, or Ctrl-C.
  void end(const std::string& outcome, std::vector<SentenceLine> said);

 private:
  bool asked_ = false;
  int port_ = 8642;
  std::unique_ptr<LiveSite> site_;
};

}  // namespace tuina::app
