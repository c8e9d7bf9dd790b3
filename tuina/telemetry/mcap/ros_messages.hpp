// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// Messages of ROS 2, as its packages of release Humble define them, constants left out. The fields
/// of each are named once: `cdr.hpp` writes and reads by that list, `ros_schema.hpp` makes the
/// definition of it.
namespace tuina::telemetry::ros {

/// A time since the epoch of the clock, s and ns.
struct Time {
  static constexpr const char* type = "builtin_interfaces/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("sec", it.sec);
    visit("nanosec", it.nanosec);
  };
};

/// A length of time, s and ns.
struct Duration {
  static constexpr const char* type = "builtin_interfaces/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("sec", it.sec);
    visit("nanosec", it.nanosec);
  };
};

/// What the clock says, for who follows simulated time.
struct Clock {
  static constexpr const char* type = "rosgraph_msgs/Clock";
  Time clock = {};
  static constexpr auto fields = [](auto& visit, auto& it) { visit("clock", it.clock); };
};

/// When, and in which frame.
struct Header {
  static constexpr const char* type = "std_msgs/Header";
  Time stamp = {};
  std::string frame_id = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("stamp", it.stamp);
    visit("frame_id", it.frame_id);
  };
};

/// A text.
struct String {
  static constexpr const char* type = "std_msgs/String";
  std::string data = {};
  static constexpr auto fields = [](auto& visit, auto& it) { visit("data", it.data); };
};

/// A colour with opacity, 0 to 1 each.
struct ColorRGBA {
  static constexpr const char* type = "std_msgs/ColorRGBA";
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
  float a = 1.0F;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("r", it.r);
    visit("g", it.g);
    visit("b", it.b);
    visit("a", it.a);
  };
};

/// A free vector, in the unit of what holds it.
struct Vector3 {
  static constexpr const char* type = "geometry_msgs/Vector3";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("x", it.x);
    visit("y", it.y);
    visit("z", it.z);
  };
};

/// A place, m.
struct Point {
  static constexpr const char* type = "geometry_msgs/Point";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("x", it.x);
    visit("y", it.y);
    visit("z", it.z);
  };
};

/// A rotation as a unit quaternion.
struct Quaternion {
  static constexpr const char* type = "geometry_msgs/Quaternion";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("x", it.x);
    visit("y", it.y);
    visit("z", it.z);
    visit("w", it.w);
  };
};

/// A translation in m and a rotation.
struct Transform {
  static constexpr const char* type = "geometry_msgs/Transform";
  Vector3 translation = {};
  Quaternion rotation = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("translation", it.translation);
    visit("rotation", it.rotation);
  };
};

/// A frame in another one.
struct TransformStamped {
  static constexpr const char* type = "geometry_msgs/TransformStamped";
  Header header = {};
  std::string child_frame_id = {};
  Transform transform = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("child_frame_id", it.child_frame_id);
    visit("transform", it.transform);
  };
};

/// Frames that are told together.
struct TFMessage {
  static constexpr const char* type = "tf2_msgs/TFMessage";
  std::vector<TransformStamped> transforms = {};
  static constexpr auto fields = [](auto& visit, auto& it) { visit("transforms", it.transforms); };
};

/// A place and an orientation.
struct Pose {
  static constexpr const char* type = "geometry_msgs/Pose";
  Point position = {};
  Quaternion orientation = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("position", it.position);
    visit("orientation", it.orientation);
  };
};

/// A pose with its time and frame.
struct PoseStamped {
  static constexpr const char* type = "geometry_msgs/PoseStamped";
  Header header = {};
  Pose pose = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("pose", it.pose);
  };
};

/// A speed and a rate of turning, m/s and rad/s.
struct Twist {
  static constexpr const char* type = "geometry_msgs/Twist";
  Vector3 linear = {};
  Vector3 angular = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("linear", it.linear);
    visit("angular", it.angular);
  };
};

/// A force and a torque, N and Nm.
struct Wrench {
  static constexpr const char* type = "geometry_msgs/Wrench";
  Vector3 force = {};
  Vector3 torque = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("force", it.force);
    visit("torque", it.torque);
  };
};

/// A wrench with its time and frame.
struct WrenchStamped {
  static constexpr const char* type = "geometry_msgs/WrenchStamped";
  Header header = {};
  Wrench wrench = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("wrench", it.wrench);
  };
};

/// Angles, speeds and torques of joints by name: rad, rad/s, Nm; of a rail m, m/s, N.
struct JointState {
  static constexpr const char* type = "sensor_msgs/JointState";
  Header header = {};
  std::vector<std::string> name = {};
  std::vector<double> position = {};
  std::vector<double> velocity = {};
  std::vector<double> effort = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("name", it.name);
    visit("position", it.position);
    visit("velocity", it.velocity);
    visit("effort", it.effort);
  };
};

/// The same for joints with more than one degree of freedom.
struct MultiDOFJointState {
  static constexpr const char* type = "sensor_msgs/MultiDOFJointState";
  Header header = {};
  std::vector<std::string> joint_names = {};
  std::vector<Transform> transforms = {};
  std::vector<Twist> twist = {};
  std::vector<Wrench> wrench = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("joint_names", it.joint_names);
    visit("transforms", it.transforms);
    visit("twist", it.twist);
    visit("wrench", it.wrench);
  };
};

/// One value that each point of a cloud has.
struct PointField {
  static constexpr const char* type = "sensor_msgs/PointField";
  std::string name = {};
  std::uint32_t offset = 0;
  std::uint8_t datatype = 7;
  std::uint32_t count = 1;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("name", it.name);
    visit("offset", it.offset);
    visit("datatype", it.datatype);
    visit("count", it.count);
  };
};

/// A cloud; the fields say what the bytes mean.
struct PointCloud2 {
  static constexpr const char* type = "sensor_msgs/PointCloud2";
  Header header = {};
  std::uint32_t height = 1;
  std::uint32_t width = 0;
  std::vector<PointField> point_fields = {};
  bool is_bigendian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::vector<std::uint8_t> data = {};
  bool is_dense = true;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("height", it.height);
    visit("width", it.width);
    visit("fields", it.point_fields);
    visit("is_bigendian", it.is_bigendian);
    visit("point_step", it.point_step);
    visit("row_step", it.row_step);
    visit("data", it.data);
    visit("is_dense", it.is_dense);
  };
};

}  // namespace tuina::telemetry::ros
