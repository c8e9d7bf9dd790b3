// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

/// Backs whose shape is an equation, as a scanner would see them, and seven points on them.
namespace tuina::test {

/// A sitting back: y over x and z. Points every 4 mm, moved along y by `noise_m`.
inline body::BackSurface back_of(const std::function<double(double x, double z)>& y_of,
                                 double noise_m = 0.0, std::uint64_t seed = 1) {
  constexpr double step = 4_mm;
  Random random = make_random(seed, "noise of a test back");
  PointCloud cloud;
  for (double x = -0.24; x <= 0.24; x += step) {
    for (double z = 0.05; z <= 0.75; z += step) {
      const double y = y_of(x, z);
      const Vector3 slope(-(y_of(x + 1e-5, z) - y) / 1e-5, 1.0, -(y_of(x, z + 1e-5) - y) / 1e-5);
      cloud.points.emplace_back(x, y + (noise_m > 0.0 ? gaussian(random, noise_m) : 0.0), z);
      cloud.normals.push_back(slope.normalized());
    }
  }
  return {std::move(cloud), BodyPosture::sitting, step};
}

inline body::BackSurface wall(double noise_m = 0.0) {
  return back_of([](double, double) { return 0.1; }, noise_m);
}

/// A barrel of 0.25 m radius about a vertical axis, leaning forward by 10 degrees.
inline double barrel_y(double x, double z) {
  return std::sqrt(0.25 * 0.25 - std::min(x * x, 0.055)) - 0.17 * (z - 0.3);
}

inline std::vector<Acupoint> seven_points(const body::BackSurface& back,
                                          double uncertainty_m = 0.0) {
  const std::vector<std::pair<const char*, Vector2>> places = {
      {"SI11_L", {0.12, 0.55}},  {"SI11_R", {-0.12, 0.55}}, {"BL47_L", {0.08, 0.43}},
      {"BL47_R", {-0.08, 0.43}}, {"BL50_L", {0.08, 0.34}},  {"BL50_R", {-0.08, 0.34}},
      {"GV4", {0.0, 0.28}}};
  std::vector<Acupoint> points;
  for (const auto& [name, at] : places) {
    const auto met = back.along({at.x(), 1.0, at.y()}, -Vector3::UnitY());
    points.push_back({name, met->at_in_couch, met->normal_in_couch, uncertainty_m});
  }
  return points;
}

/// The paired points 1.5 cun beside the spine that a map adds to the seven.
inline std::vector<Acupoint> inner_points(const body::BackSurface& back,
                                          double uncertainty_m = 0.0) {
  const std::vector<std::pair<const char*, double>> heights = {
      {"BL13", 0.57}, {"BL15", 0.52},  {"BL17", 0.48}, {"BL18", 0.43},
      {"BL20", 0.37}, {"BL21", 0.345}, {"BL23", 0.28}};
  std::vector<Acupoint> points;
  for (const auto& [name, z] : heights) {
    for (const double side : {1.0, -1.0}) {
      const auto met = back.along({side * 0.042, 1.0, z}, -Vector3::UnitY());
      points.push_back({std::string(name) + (side > 0.0 ? "_L" : "_R"), met->at_in_couch,
                        met->normal_in_couch, uncertainty_m});
    }
  }
  return points;
}

/// Landmarks of an upright man on the wall, without the outline.
inline std::vector<Landmark> landmarks_of_a_man() {
  std::vector<Landmark> landmarks = {{"C7", {0, 0.1, 0.65}},   {"T3", {0, 0.1, 0.585}},
                                     {"T7", {0, 0.1, 0.49}},   {"T9", {0, 0.1, 0.445}},
                                     {"T12", {0, 0.1, 0.355}}, {"L2", {0, 0.1, 0.295}},
                                     {"L4", {0, 0.1, 0.25}},   {"sacrum_S2", {0, 0.1, 0.165}}};
  for (const double side : {1.0, -1.0}) {
    const std::string end = side > 0.0 ? "_L" : "_R";
    landmarks.push_back({"scapula_root" + end, {side * 0.084, 0.1, 0.586}});
    landmarks.push_back({"scapula_inferior_angle" + end, {side * 0.099, 0.1, 0.485}});
    landmarks.push_back({"scapula_spine_mid" + end, {side * 0.135, 0.1, 0.581}});
    landmarks.push_back({"acromial_angle" + end, {side * 0.184, 0.1, 0.567}});
    landmarks.push_back({"axillary_fold" + end, {side * 0.163, 0.1, 0.474}});
    landmarks.push_back({"waist" + end, {side * 0.138, 0.1, 0.254}});
    landmarks.push_back({"psis" + end, {side * 0.043, 0.1, 0.16}});
  }
  return landmarks;
}

}  // namespace tuina::test
