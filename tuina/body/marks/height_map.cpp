// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/marks/height_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuina::body {
namespace {

constexpr double near_skin_m = 15_mm;

}  // namespace

HeightMap::HeightMap(const PointCloud& scan_in_couch, const BackSurface& back) {
  for (const Vector3& normal : back.points().normals) out_ += normal;
  out_.normalize();
  across_ = out_.unitOrthogonal();
  along_ = out_.cross(across_);
  std::vector<Vector3> seen;  // across, along, height
  Vector3 least = Vector3::Constant(std::numeric_limits<double>::max());
  Vector3 most = -least;
  for (const Vector3& point : scan_in_couch.points) {
    const Vector3& skin = back.points().points[back.closest(point)];
    if ((point - skin).squaredNorm() > near_skin_m * near_skin_m) continue;
    seen.emplace_back(across_.dot(point), along_.dot(point), out_.dot(point));
    least = least.cwiseMin(seen.back());
    most = most.cwiseMax(seen.back());
  }
  if (seen.empty()) return;
  corner_ = least;
  columns_ = static_cast<int>((most.x() - least.x()) / cell_m) + 1;
  rows_ = static_cast<int>((most.y() - least.y()) / cell_m) + 1;
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  std::vector<double> front(cells, std::numeric_limits<double>::lowest());
  for (const Vector3& at : seen) front[cell_of(at)] = std::max(front[cell_of(at)], at.z());
  heights_.assign(cells, 0.0);
  std::vector<int> points(cells, 0);
  for (const Vector3& at : seen) {
    if (at.z() < front[cell_of(at)] - near_skin_m) continue;
    heights_[cell_of(at)] += at.z();
    ++points[cell_of(at)];
  }
  for (std::size_t i = 0; i < cells; ++i)
    heights_[i] = points[i] > 0 ? heights_[i] / points[i] : std::nan("");
  spacing_m_ = spacing_of(seen);
}

double HeightMap::at(int column, int row) const {
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return std::nan("");
  return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
}

Vector3 HeightMap::place(double column, double row, double height_m) const {
  return (corner_.x() + (column + 0.5) * cell_m) * across_ +
         (corner_.y() + (row + 0.5) * cell_m) * along_ + height_m * out_;
}

std::size_t HeightMap::cell_of(const Vector3& seen) const {
  const auto column = static_cast<std::size_t>((seen.x() - corner_.x()) / cell_m);
  const auto row = static_cast<std::size_t>((seen.y() - corner_.y()) / cell_m);
  return row * static_cast<std::size_t>(columns_) + column;
}

// Side of the square that each point has to itself, over squares of four by four cells with any.
double HeightMap::spacing_of(const std::vector<Vector3>& seen) const {
  constexpr std::size_t block = 4;
  const auto width = static_cast<std::size_t>(columns_);
  const auto height = static_cast<std::size_t>(rows_);
  std::vector<bool> taken((width / block + 1) * (height / block + 1));
  for (const Vector3& at : seen) {
    const std::size_t cell = cell_of(at);
    taken[cell / width / block * (width / block + 1) + cell % width / block] = true;
  }
  const auto squares = static_cast<double>(std::count(taken.begin(), taken.end(), true));
  return block * cell_m * std::sqrt(squares / static_cast<double>(seen.size()));
}

}  // namespace tuina::body
