// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/raster.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::telemetry {

Raster::Raster(int first_row, int columns, int rows)
    : top(first_row), width(columns), height(rows) {
  const auto pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  depth.assign(pixels, no_depth);
  inside.assign(pixels, 0.F);
  normal.assign(pixels, Eigen::Vector3f::UnitZ());
  albedo.assign(pixels, Eigen::Vector3f::Zero());
  skin.assign(pixels, 0);
}

void Raster::draw(const std::vector<RasterVertex>& vertices, const std::array<int, 3>& triangle) {
  const RasterVertex& a = vertices[static_cast<std::size_t>(triangle[0])];
  const RasterVertex& b = vertices[static_cast<std::size_t>(triangle[1])];
  const RasterVertex& c = vertices[static_cast<std::size_t>(triangle[2])];
  const auto first = static_cast<float>(top);
  const float low_y = std::min({a.at.y(), b.at.y(), c.at.y()}) - first;
  const float high_y = std::max({a.at.y(), b.at.y(), c.at.y()}) - first;
  if (high_y < 0.F || low_y > static_cast<float>(height)) return;
  const Eigen::Vector2f ab = (b.at - a.at).head<2>();
  const Eigen::Vector2f ac = (c.at - a.at).head<2>();
  const float area = ab.x() * ac.y() - ab.y() * ac.x();
  if (std::abs(area) < 1e-12F) return;
  const float low_x = std::min({a.at.x(), b.at.x(), c.at.x()});
  const float high_x = std::max({a.at.x(), b.at.x(), c.at.x()});
  const int x_begin = std::max(0, static_cast<int>(std::floor(low_x)));
  const int x_end = std::min(width - 1, static_cast<int>(std::ceil(high_x)));
  const int y_begin = std::max(0, static_cast<int>(std::floor(low_y)));
  const int y_end = std::min(height - 1, static_cast<int>(std::ceil(high_y)));
  for (int y = y_begin; y <= y_end; ++y) {
    for (int x = x_begin; x <= x_end; ++x) {
      const Eigen::Vector2f p(static_cast<float>(x) + 0.5F - a.at.x(),
                              static_cast<float>(y) + 0.5F + first - a.at.y());
      const float v = (p.x() * ac.y() - p.y() * ac.x()) / area;
      const float w = (ab.x() * p.y() - ab.y() * p.x()) / area;
      const float u = 1.F - v - w;
      if (u < 0.F || v < 0.F || w < 0.F) continue;
      const float z = u * a.at.z() + v * b.at.z() + w * c.at.z();
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x);
      if (z <= depth[at]) continue;
      const float mask = u * a.inside + v * b.inside + w * c.inside;
      // The edge of what was seen is where the mask passes its middle; a narrow ramp there is one
      // pixel or two.
      const float cover = std::clamp((mask - 0.46F) / 0.08F, 0.F, 1.F);
      if (cover <= 0.F) continue;
      depth[at] = z;
      inside[at] = cover;
      normal[at] = u * a.normal + v * b.normal + w * c.normal;
      albedo[at] = u * a.albedo + v * b.albedo + w * c.albedo;
      skin[at] = 1;
    }
  }
}

void Raster::draw(const RasterBall& ball) {
  const float centre_y = ball.at.y() - static_cast<float>(top);
  if (centre_y + ball.radius_px < 0.F || centre_y - ball.radius_px > static_cast<float>(height))
    return;
  const int x_begin = std::max(0, static_cast<int>(ball.at.x() - ball.radius_px));
  const int x_end = std::min(width - 1, static_cast<int>(ball.at.x() + ball.radius_px));
  const int y_begin = std::max(0, static_cast<int>(centre_y - ball.radius_px));
  const int y_end = std::min(height - 1, static_cast<int>(centre_y + ball.radius_px));
  for (int y = y_begin; y <= y_end; ++y) {
    for (int x = x_begin; x <= x_end; ++x) {
      const float dx = (static_cast<float>(x) + 0.5F - ball.at.x()) / ball.radius_px;
      const float dy = (static_cast<float>(y) + 0.5F - centre_y) / ball.radius_px;
      const float rest = 1.F - dx * dx - dy * dy;
      if (rest < 0.F) continue;
      const float up = std::sqrt(rest);
      const float z = ball.at.z() + up * ball.radius_m;
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(x);
      if (z <= depth[at]) continue;
      depth[at] = z;
      inside[at] = 1.F;
      normal[at] = Eigen::Vector3f(dx, -dy, up);
      albedo[at] = ball.albedo;
      skin[at] = 0;
    }
  }
}

void box_blur(std::vector<float>& values, int width, int height, int radius) {
  const auto blur = [radius](float* first, int count, int stride, std::vector<float>& line) {
    line.resize(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) line[static_cast<std::size_t>(k)] = first[k * stride];
    double sum = 0.0;
    for (int k = 0; k < std::min(radius, count); ++k)
      sum += static_cast<double>(line[static_cast<std::size_t>(k)]);
    for (int k = 0; k < count; ++k) {
      if (k + radius < count)
        sum += static_cast<double>(line[static_cast<std::size_t>(k + radius)]);
      if (k - radius > 0)
        sum -= static_cast<double>(line[static_cast<std::size_t>(k - radius - 1)]);
      first[k * stride] = static_cast<float>(sum / (2 * radius + 1));
    }
  };
  std::vector<float> line;
  for (int y = 0; y < height; ++y)
    blur(values.data() + static_cast<std::ptrdiff_t>(y) * width, width, 1, line);
  for (int x = 0; x < width; ++x) blur(values.data() + x, height, width, line);
}

}  // namespace tuina::telemetry
