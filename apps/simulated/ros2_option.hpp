// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "apps/cli/options.hpp"
#include "apps/simulated/ros2_desk.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "tuina/ros2/node.hpp"

namespace tuina::app {

/// The options `--ros2` and `--lan` of a verb, and the node that they ask for.
class Ros2Option {
 public:
  void describe(Options& options, const std::string& what_is_told);
  /// Opens the node in the domain of ROS_DOMAIN_ID, where one is asked for. With the folder of a
  /// session that one may be steered by services, and the audit log lies there.
  [[nodiscard]] Result<void> begin(const std::filesystem::path& folder = {});
  /// Null where none was asked for.
  [[nodiscard]] ros2::Node* node() const { return node_.get(); }
  [[nodiscard]] ros2::Reach reach() const { return lan_ ? ros2::Reach::lan : ros2::Reach::host; }
  /// Who is told of the session that begins now, and steers it; nobody where none was asked for.
  [[nodiscard]] Attendant attendant();
  /// There is nothing left to steer.
  void end_session() { desk_.reset(); }
  /// What became of its messages, in a line for people; `untold_ms` of the session never reached
  /// it.
  [[nodiscard]] std::string text(std::uint64_t untold_ms = 0) const;

 private:
  bool asked_ = false;
  bool lan_ = false;
  std::unique_ptr<ros2::Node> node_;
  std::unique_ptr<Ros2Desk> desk_;  ///< ends before the node
};

}  // namespace tuina::app
