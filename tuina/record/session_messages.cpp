// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tuina::record {
namespace {

constexpr const char* base_frame = "base";
constexpr const char* couch_frame = "couch";

// Steps to which values are rounded: powers of two, so that their last bits are zero and take no
// space. Poses of the tools follow from the joints, which are finer.
constexpr double angle_step = 0x1p-14;        // 61 microradians; a count of 17 bits is 48
constexpr double rail_step = 0x1p-13;         // 0.12 mm
constexpr double speed_step = 0x1p-6;         // 16 mrad/s
constexpr double motor_torque_step = 0x1p-3;  // 125 mNm
constexpr double force_step = 0x1p-4;         // 63 mN; the noise of a usual wrist sensor is 50 mN
constexpr double torque_step = 0x1p-8;        // 4 mNm
constexpr double place_step = 0x1p-12;        // 0.24 mm
constexpr double turn_step = 0x1p-11;         // of a quaternion; 0.06 degrees

double rounded(double value, double step) {
  return std::nearbyint(value / step) * step + 0.0;  // never minus zero
}

// What has changed by less than a step stands as it was told before: noise at the edge between two
// steps would take a third of the record. What is told is within a step of what was read.
void settle(double& told, double value, double step) {
  if (!(std::abs(value - told) < step)) told = rounded(value, step);
}

template <typename Message>
void settle(Message& told, const Vector3& v, double step) {
  settle(told.x, v.x(), step);
  settle(told.y, v.y(), step);
  settle(told.z, v.z(), step);
}

template <typename Message>
Message three(const Vector3& v, double step) {
  return {rounded(v.x(), step), rounded(v.y(), step), rounded(v.z(), step)};
}

Eigen::Quaterniond quaternion_of(const Transform& to_from) {
  Eigen::Quaterniond q(to_from.linear());
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  return q;
}

ros::ColorRGBA colour_of(const Colour& colour, float opacity) {
  const auto share = [](std::uint8_t value) { return static_cast<float>(value) / 255.0F; };
  return {.r = share(colour.red), .g = share(colour.green), .b = share(colour.blue), .a = opacity};
}

// Kinds of visualization_msgs/Marker.
constexpr std::int32_t sphere = 2, line_strip = 4, text_facing = 9;

ros::Marker marker_at(const ros::Header& header, const char* ns, std::size_t id, std::int32_t kind,
                      const Vector3& at, double size_m) {
  return {.header = header,
          .ns = ns,
          .id = static_cast<std::int32_t>(id),
          .kind = kind,
          .pose = {.position = {at.x(), at.y(), at.z()}},
          .scale = {size_m, size_m, size_m}};
}

}  // namespace

std::uint64_t to_ns(double time_s) {
  return static_cast<std::uint64_t>(std::llround(std::max(0.0, time_s) * 1e9));
}

ros::Header header_of(double time_s, const char* frame) {
  constexpr std::uint64_t ns_per_s = 1'000'000'000;
  const std::uint64_t ns = to_ns(time_s);
  return {.stamp = {.sec = static_cast<std::int32_t>(ns / ns_per_s),
                    .nanosec = static_cast<std::uint32_t>(ns % ns_per_s)},
          .frame_id = frame};
}

ros::Transform message_of(const Transform& to_from) {
  const Eigen::Quaterniond q = quaternion_of(to_from);
  return {.translation = three<ros::Vector3>(to_from.translation(), place_step),
          .rotation = {.x = rounded(q.x(), turn_step),
                       .y = rounded(q.y(), turn_step),
                       .z = rounded(q.z(), turn_step),
                       .w = rounded(q.w(), turn_step)}};
}

ros::PointCloud2 cloud_message(double time_s, const PointCloud& cloud_in_couch) {
  constexpr std::uint32_t floats = 4;
  const std::size_t count = cloud_in_couch.size();
  ros::PointCloud2 message{.header = header_of(time_s, couch_frame),
                           .width = static_cast<std::uint32_t>(count),
                           .point_step = floats * sizeof(float)};
  const char* names[floats] = {"x", "y", "z", "intensity"};
  for (std::uint32_t i = 0; i < floats; ++i) {
    message.point_fields.push_back(
        {.name = names[i], .offset = i * static_cast<std::uint32_t>(sizeof(float))});
  }
  message.row_step = message.width * message.point_step;
  message.data.resize(message.row_step);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3f at = cloud_in_couch.points[i].cast<float>();
    const float amplitude = cloud_in_couch.amplitude.empty() ? 0.0F : cloud_in_couch.amplitude[i];
    const std::array<float, floats> point = {at.x(), at.y(), at.z(), amplitude};
    std::memcpy(message.data.data() + i * sizeof point, point.data(), sizeof point);
  }
  return message;
}

ros::MarkerArray acupoint_markers(double time_s, std::span<const Acupoint> acupoints) {
  const ros::Header header = header_of(time_s, couch_frame);
  constexpr double size_m = 12e-3, letter_m = 15e-3, above_m = 20e-3;
  ros::MarkerArray all;
  for (std::size_t i = 0; i < acupoints.size(); ++i) {
    const Acupoint& point = acupoints[i];
    ros::Marker dot = marker_at(header, "acupoints", i, sphere, point.at_in_couch, size_m);
    dot.color = colour_of({214, 40, 40}, 1.0F);
    ros::Marker name = marker_at(header, "names", i, text_facing,
                                 point.at_in_couch + above_m * point.normal_in_couch, letter_m);
    name.color = colour_of({255, 255, 255}, 1.0F);
    name.text = point.name;
    all.markers.push_back(std::move(dot));
    all.markers.push_back(std::move(name));
  }
  return all;
}

ros::MarkerArray plan_markers(double time_s, const massage::Plan& plan) {
  constexpr double line_m = 4e-3, dot_m = 18e-3;
  constexpr std::size_t every = 20;  // points of a path are a few milliseconds apart
  const ros::Header header = header_of(time_s, couch_frame);
  ros::MarkerArray all;
  for (std::size_t i = 0; i < plan.paths.size(); ++i) {
    const ContactPath& path = plan.paths[i].path;
    if (path.points.empty()) continue;
    const bool moves = slides(path.technique);
    ros::Marker marker =
        moves ? marker_at(header, "plan", i, line_strip, Vector3::Zero(), line_m)
              : marker_at(header, "plan", i, sphere, path.points.front().at_in_couch, dot_m);
    marker.color = colour_of(row_of(path.technique).colour, 0.6F);
    for (std::size_t k = 0; moves && k < path.points.size(); k += every)
      marker.points.push_back(three<ros::Point>(path.points[k].at_in_couch, place_step));
    all.markers.push_back(std::move(marker));
  }
  return all;
}

RobotMessages::RobotMessages(const robot::RobotPlacement& placement)
    : whole_(robot::whole_of(placement, {.of = {placement.arm, placement.arm}})),
      models_(robot::both_models(placement.arm, placement.mount)) {
  const auto& parts = whole_.description.parts;
  const auto index_of = [&](const std::string& name) {
    const auto found = std::find_if(parts.begin(), parts.end(),
                                    [&](const robot::Part& part) { return part.name == name; });
    return static_cast<std::size_t>(found - parts.begin());
  };
  const auto joint_of = [&](std::size_t part) {
    joints_.name.push_back(parts[part].name + "_joint");  // as the URDF calls it
    return part;
  };
  rail_ = joint_of(index_of(whole_.rail));
  for (const Arm arm : both_arms) {
    for (int i = 0; i < placement.arm.joints; ++i) {
      const auto& link = placement.arm.links[static_cast<std::size_t>(i)];
      arm_parts_[arm].push_back(joint_of(index_of(fmt::format("{}_{}", name_of(arm), link.name))));
    }
  }
  for (auto* values : {&joints_.position, &joints_.velocity, &joints_.effort})
    values->assign(joints_.name.size(), 0.0);
  tools_.joint_names.assign(tool_frames.begin(), tool_frames.end());
  tools_.transforms.resize(tool_frames.size());
  tools_.wrench.resize(tool_frames.size());
  for (const robot::Part& part : parts) {
    const std::string parent =
        part.parent < 0 ? base_frame : parts[static_cast<std::size_t>(part.parent)].name;
    parts_.transforms.push_back({.header = {.frame_id = parent}, .child_frame_id = part.name});
  }
}

ros::TFMessage RobotMessages::still(double time_s, const Transform& base_from_couch) const {
  ros::TFMessage message{.transforms = {{.header = header_of(time_s, base_frame),
                                         .child_frame_id = couch_frame,
                                         .transform = message_of(base_from_couch)}}};
  for (const robot::Marker& marker : whole_.description.markers) {
    const auto& part = whole_.description.parts[static_cast<std::size_t>(marker.part)];
    message.transforms.push_back({.header = header_of(time_s, part.name.c_str()),
                                  .child_frame_id = marker.name,
                                  .transform = message_of(marker.part_from_marker)});
  }
  return message;
}

Transform RobotMessages::base_from_tool(const robot::RobotReading& reading, Arm arm) const {
  return models_[arm].base_from_tool(reading.arms[arm].q_rad, reading.rail_m);
}

const ros::JointState& RobotMessages::joints(const robot::RobotReading& reading,
                                             const robot::RobotCommand& command) {
  joints_.header = header_of(reading.time_s, base_frame);
  std::size_t at = 0;
  settle(joints_.position[at++], reading.rail_m, rail_step);
  for (const Arm arm : both_arms) {
    const robot::ArmReading& seen = reading.arms[arm];
    for (Eigen::Index i = 0; i < seen.q_rad.size(); ++i, ++at) {
      settle(joints_.position[at], seen.q_rad[i], angle_step);
      settle(joints_.velocity[at], seen.dq_rad_per_s[i], speed_step);
      settle(joints_.effort[at], command.torque_nm[arm][i], motor_torque_step);
    }
  }
  return joints_;
}

const ros::MultiDOFJointState& RobotMessages::tools(const robot::RobotReading& reading) {
  tools_.header = header_of(reading.time_s, base_frame);
  for (const Arm arm : both_arms) {
    const auto at = static_cast<std::size_t>(arm);
    const Transform pose = base_from_tool(reading, arm);
    const Eigen::Quaterniond turned = quaternion_of(pose);
    settle(tools_.transforms[at].translation, pose.translation(), place_step);
    settle(tools_.transforms[at].rotation, turned.vec(), turn_step);
    settle(tools_.transforms[at].rotation.w, turned.w(), turn_step);
    settle(tools_.wrench[at].force, reading.arms[arm].wrench_in_tool.force_n, force_step);
    settle(tools_.wrench[at].torque, reading.arms[arm].wrench_in_tool.torque_nm, torque_step);
  }
  return tools_;
}

const ros::TFMessage& RobotMessages::parts(const robot::RobotReading& reading) {
  whole_.q[rail_] = reading.rail_m;
  for (const Arm arm : both_arms) {
    for (std::size_t i = 0; i < arm_parts_[arm].size(); ++i)
      whole_.q[arm_parts_[arm][i]] = reading.arms[arm].q_rad[static_cast<Eigen::Index>(i)];
  }
  const std::vector<Transform> poses = robot::base_from_parts(whole_.description, whole_.q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const int parent = whole_.description.parts[i].parent;
    ros::TransformStamped& told = parts_.transforms[i];
    told.header.stamp = header_of(reading.time_s, base_frame).stamp;
    told.transform = message_of(
        parent < 0 ? poses[i] : poses[static_cast<std::size_t>(parent)].inverse() * poses[i]);
  }
  return parts_;
}

ros::WrenchStamped RobotMessages::wrench(Arm arm) const {
  const auto at = static_cast<std::size_t>(arm);
  return {.header = {.stamp = tools_.header.stamp, .frame_id = tool_frames[at]},
          .wrench = tools_.wrench[at]};
}

ros::PoseStamped RobotMessages::pose(Arm arm) const {
  const ros::Transform& told = tools_.transforms[static_cast<std::size_t>(arm)];
  return {.header = tools_.header,
          .pose = {.position = {told.translation.x, told.translation.y, told.translation.z},
                   .orientation = told.rotation}};
}

}  // namespace tuina::record
