// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tuina/core/stopwatch.hpp"
#include "tuina/ros2/node.hpp"
#include "tuina/web/desk.hpp"

namespace tuina::app {

/// The services of a node of ROS 2, as a door to a desk: whoever asks there is a client of it, as
/// pages and other programs are (`web::Desk`). A stop is done before anything else, whatever its
/// request looks like.
class Ros2Door {
 public:
  /// What one program asks for.
  struct Asked {
    web::ClientId client = 0;
    web::Ask ask = web::Ask::stop;
    std::uint64_t sequence = 0;
    double age_s = 0.0;
  };
  /// What is behind the door, which alone calls it, one call at a time.
  struct Desk {
    std::function<void()> stop;
    std::function<void(web::ClientId)> come, go;
    std::function<std::string(const Asked&)> decide;  ///< "done", or why not
    /// A line of the audit log.
    std::function<void(const std::string& who, const std::string& what, const std::string& outcome)>
        note;
    std::function<void()> look = [] {};  ///< is its operator still there? Ten times a second
  };
  /// Nine services `/tuina/<ask>` of the node, which must outlive the door. From further away than
  /// this machine only `/tuina/stop` is offered: nobody can tell who asks.
  [[nodiscard]] static Result<std::unique_ptr<Ros2Door>> open(ros2::Node& node, ros2::Reach reach,
                                                              Desk desk);
  ~Ros2Door();
  Ros2Door(const Ros2Door&) = delete;
  Ros2Door& operator=(const Ros2Door&) = delete;

 private:
  /// A program of ROS 2, with all its clients.
  struct Program {
    web::ClientId id = 0;
    std::uint64_t sequence = 0;
    double heard_s = 0.0;
  };
  Ros2Door(std::vector<web::Ask> asks, std::unique_ptr<ros2::Services> services, Desk desk);
  void serve();
  void serve(const ros2::Request& request);
  [[nodiscard]] std::string decide(const ros2::Request& request, web::Ask ask);
  [[nodiscard]] Program* program_of(const std::string& name);
  void forget_the_silent();

  std::vector<web::Ask> asks_;  ///< of the services, in their order
  std::unique_ptr<ros2::Services> services_;
  Desk desk_;
  Stopwatch clock_;
  std::map<std::string, Program> programs_;
  web::ClientId last_id_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::app
