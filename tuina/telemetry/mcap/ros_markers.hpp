// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/telemetry/mcap/ros_messages.hpp"

/// What viewers of ROS 2 draw, likewise.
namespace tuina::telemetry::ros {

/// A picture as the bytes of its file.
struct CompressedImage {
  static constexpr const char* type = "sensor_msgs/CompressedImage";
  Header header = {};
  std::string format = {};
  std::vector<std::uint8_t> data = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("format", it.format);
    visit("data", it.data);
  };
};

/// A place on a texture, 0 to 1.
struct UVCoordinate {
  static constexpr const char* type = "visualization_msgs/UVCoordinate";
  float u = 0.0F;
  float v = 0.0F;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("u", it.u);
    visit("v", it.v);
  };
};

/// A mesh as the bytes of its file.
struct MeshFile {
  static constexpr const char* type = "visualization_msgs/MeshFile";
  std::string filename = {};
  std::vector<std::uint8_t> data = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("filename", it.filename);
    visit("data", it.data);
  };
};

/// A shape that viewers draw, metres.
struct Marker {
  static constexpr const char* type = "visualization_msgs/Marker";
  Header header = {};
  std::string ns = {};
  std::int32_t id = 0;
  std::int32_t kind = 0;
  std::int32_t action = 0;
  Pose pose = {};
  Vector3 scale = {};
  ColorRGBA color = {};
  Duration lifetime = {};
  bool frame_locked = false;
  std::vector<Point> points = {};
  std::vector<ColorRGBA> colors = {};
  std::string texture_resource = {};
  CompressedImage texture = {};
  std::vector<UVCoordinate> uv_coordinates = {};
  std::string text = {};
  std::string mesh_resource = {};
  MeshFile mesh_file = {};
  bool mesh_use_embedded_materials = false;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("ns", it.ns);
    visit("id", it.id);
    visit("type", it.kind);
    visit("action", it.action);
    visit("pose", it.pose);
    visit("scale", it.scale);
    visit("color", it.color);
    visit("lifetime", it.lifetime);
    visit("frame_locked", it.frame_locked);
    visit("points", it.points);
    visit("colors", it.colors);
    visit("texture_resource", it.texture_resource);
    visit("texture", it.texture);
    visit("uv_coordinates", it.uv_coordinates);
    visit("text", it.text);
    visit("mesh_resource", it.mesh_resource);
    visit("mesh_file", it.mesh_file);
    visit("mesh_use_embedded_materials", it.mesh_use_embedded_materials);
  };
};

/// Shapes that are drawn together.
struct MarkerArray {
  static constexpr const char* type = "visualization_msgs/MarkerArray";
  std::vector<Marker> markers = {};
  static constexpr auto fields = [](auto& visit, auto& it) { visit("markers", it.markers); };
};

}  // namespace tuina::telemetry::ros
