// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/ros2/node.hpp"
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
  /// Goes on with a log that is there. From further away than this machine only `/tuina/stop` is
  /// offered: nobody can tell who asks. The node must outlive the desk.
  [[nodiscard]] static Result<std::unique_ptr<Ros2Desk>> open(ros2::Node& node, ros2::Reach reach,
                                                              const std::filesystem::path& log);
  ~Ros2Desk();
  Ros2Desk(const Ros2Desk&) = delete;
  Ros2Desk& operator=(const Ros2Desk&) = delete;

  /// What the session asks of it; the desk must outlive the session.
  [[nodiscard]] Attendant attendant();

 private:
  /// A program of ROS 2, with all its clients.
  struct Program {
    web::ClientId id = 0;
    std::uint64_t sequence = 0;
    double heard_s = 0.0;
  };
  Ros2Desk(std::vector<web::Ask> asks, std::unique_ptr<ros2::Services> services,
           web::AuditLog audit);
  void serve();
  void serve(const ros2::Request& request);
  [[nodiscard]] std::string decide(const ros2::Request& request, web::Ask ask);
  [[nodiscard]] std::string obey(web::Ask ask);
  [[nodiscard]] Program* program_of(const std::string& name, double now_s);
  void pause_without_operator();
  void note(const std::string& who, const std::string& what, const std::string& outcome);
  [[nodiscard]] std::optional<session::LiveCommand> next_command() noexcept;

  std::vector<web::Ask> asks_;  ///< of the services, in their order
  std::unique_ptr<ros2::Services> services_;
  web::AuditLog audit_;
  bool audit_fails_ = false;
  Stopwatch clock_;
  web::Desk desk_;
  std::map<std::string, Program> programs_;
  web::ClientId last_id_ = 0;
  bool operated_ = false;  ///< somebody took control and has not handed it over
  /// Written by the thread of the desk, read by the session.
  session::CommandQueue commands_;
  std::atomic<bool> running_ = false, ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::app
