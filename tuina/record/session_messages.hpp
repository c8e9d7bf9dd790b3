// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/description.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/telemetry/mcap/ros_markers.hpp"

/// What a session is made of, as messages of ROS 2. Frames: `base`, `couch`, and the parts of the
/// robot with its tools (docs/record.md).
namespace tuina::record {

namespace ros = telemetry::ros;

/// Session time as messages and files state it.
[[nodiscard]] std::uint64_t to_ns(double time_s);
/// The head of a message at a time of the session.
[[nodiscard]] ros::Header header_of(double time_s, const char* frame);
/// A transform as a message, metres and quaternion.
[[nodiscard]] ros::Transform message_of(const Transform& to_from);

/// Points with normals left out and the brightness as `intensity`.
[[nodiscard]] ros::PointCloud2 cloud_message(double time_s, const PointCloud& cloud_in_couch);
/// A sphere with the name above it for each acupoint.
[[nodiscard]] ros::MarkerArray acupoint_markers(double time_s, std::span<const Acupoint> acupoints);
/// A line or, where the tool stays in place, a sphere for each path, in the colour of its
/// technique.
[[nodiscard]] ros::MarkerArray plan_markers(double time_s, const massage::Plan& plan);

/// Turns milliseconds into the messages that tell of both arms. Values are rounded to steps near
/// what sensors can tell, and change by a step at least (docs/record.md), since the rest would be
/// noise that takes space.
class RobotMessages {
 public:
  /// The robot as it stands at this couch.
  explicit RobotMessages(const robot::RobotPlacement& placement);

  /// The robot as a tree of parts, for viewers.
  [[nodiscard]] const robot::Description& description() const { return whole_.description; }
  /// The joints of rail and arms with the torques that the robot was told. Lives until the next
  /// call, as the others do.
  const ros::JointState& joints(const robot::RobotReading& reading,
                                const robot::RobotCommand& command);
  /// Poses of both tools in `base`, and what their wrist sensors say, in the frame of the tool.
  const ros::MultiDOFJointState& tools(const robot::RobotReading& reading);
  /// What does not move: the couch in `base`, tools and shoulders in the parts that carry them.
  [[nodiscard]] ros::TFMessage still(double time_s, const Transform& base_from_couch) const;
  /// Every part of the robot in the one that carries it.
  const ros::TFMessage& parts(const robot::RobotReading& reading);
  /// @{
  /// Of one arm what `tools` has told last: the wrench in its tool, and its pose in base.
  [[nodiscard]] ros::WrenchStamped wrench(Arm arm) const;
  [[nodiscard]] ros::PoseStamped pose(Arm arm) const;
  /// @}

  static constexpr std::array<const char*, 2> tool_frames = {"left_tool", "right_tool"};

 private:
  [[nodiscard]] Transform base_from_tool(const robot::RobotReading& reading, Arm arm) const;

  robot::WholeRobot whole_;
  PerArm<robot::ArmModel> models_;
  std::size_t rail_ = 0;                        ///< index of the part
  PerArm<std::vector<std::size_t>> arm_parts_;  ///< indexes of the parts that joints move
  ros::JointState joints_;
  ros::MultiDOFJointState tools_;
  ros::TFMessage parts_;
};

}  // namespace tuina::record
