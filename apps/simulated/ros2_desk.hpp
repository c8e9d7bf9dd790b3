// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/simulated/ros2_door.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/session/command_queue.hpp"
#include "tuina/web/audit.hpp"
#include "tuina/web/desk.hpp"

namespace tuina::app {

/// Steers the one session of a terminal from ROS 2, by the services and the rules that the live
/// page has for other programs (`web::Desk`): one is in control at a time, whoever asks may stop,
/// and each ask is a line of the audit log. Whoever took control and falls silent leaves the
/// massage paused; as long as nobody did, it goes on as the terminal began it.
class Ros2Desk {
 public:
  /// Goes on with a log that is there. The node must outlive the desk.
  [[nodiscard]] static Result<std::unique_ptr<Ros2Desk>> open(ros2::Node& node, ros2::Reach reach,
                                                              const std::filesystem::path& log);
  Ros2Desk(const Ros2Desk&) = delete;
  Ros2Desk& operator=(const Ros2Desk&) = delete;

  /// What the session asks of it; the desk must outlive the session.
  [[nodiscard]] Attendant attendant();

 private:
  explicit Ros2Desk(web::AuditLog audit) : audit_(std::move(audit)) {}
  [[nodiscard]] std::string decide(const Ros2Door::Asked& asked);
  [[nodiscard]] std::string obey(web::Ask ask);
  void pause_without_operator();
  void note(const std::string& who, const std::string& what, const std::string& outcome);
  [[nodiscard]] std::optional<session::LiveCommand> next_command() noexcept;

  web::AuditLog audit_;
  bool audit_fails_ = false;
  Stopwatch clock_;
  web::Desk desk_;
  bool operated_ = false;  ///< somebody took control and has not handed it over
  /// Written by the thread of the door, read by the session.
  session::CommandQueue commands_;
  std::atomic<bool> running_ = false;
  std::unique_ptr<Ros2Door> door_;  ///< ends before all else
};

}  // namespace tuina::app
