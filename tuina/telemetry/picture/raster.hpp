// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace tuina::telemetry {

inline constexpr float no_depth = -std::numeric_limits<float>::infinity();

/// A corner of a triangle: x and y in pixels, z towards the eye in metres.
struct RasterVertex {
  Eigen::Vector3f at;
  Eigen::Vector3f normal;
  Eigen::Vector3f albedo;
  float inside = 1.F;
};

struct RasterBall {
  Eigen::Vector3f at;
  float radius_px = 1.F;
  float radius_m = 0.001F;
  Eigen::Vector3f albedo;
};

/// What is foremost at each pixel of a strip that begins at row `top`.
struct Raster {
  Raster(int first_row, int columns, int rows);

  void draw(const std::vector<RasterVertex>& vertices, const std::array<int, 3>& triangle);
  void draw(const RasterBall& ball);

  int top;
  int width;
  int height;
  std::vector<float> depth;  ///< metres towards the eye, or `no_depth`
  std::vector<float> inside;
  std::vector<Eigen::Vector3f> normal;
  std::vector<Eigen::Vector3f> albedo;
  std::vector<unsigned char> skin;  ///< 1 where a triangle is foremost, 0 where a ball is
};

/// The mean over a square of 2 radius + 1 pixels, in place.
void box_blur(std::vector<float>& values, int width, int height, int radius);

}  // namespace tuina::telemetry
