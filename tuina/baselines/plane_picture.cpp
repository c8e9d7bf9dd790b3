// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/plane_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tuina/core/grid.hpp"
#include "tuina/core/units.hpp"

namespace tuina::baselines {

using namespace body;
namespace {

constexpr double sticker_radius_m = 7_mm;
constexpr double beyond_m = 20_mm;  // of the back, above the neck and below the midline
using Rgb = std::array<std::uint8_t, 3>;
constexpr Rgb red = {200, 30, 30};

/// Skin as it looks in light from the upper left.
Rgb skin(const Vector3& normal_in_back) {
  const Vector3 light = Vector3(0.45, 0.75, 0.5).normalized();
  const double share = 0.35 + 0.65 * std::max(0.0, normal_in_back.dot(light));
  return {static_cast<std::uint8_t>(226.0 * share), static_cast<std::uint8_t>(180.0 * share),
          static_cast<std::uint8_t>(154.0 * share)};
}

void put(Image& image, int column, int row, const Rgb& colour) {
  std::copy(colour.begin(), colour.end(), image.row(row) + 3 * column);
}

std::size_t index_of(const Image& image, int column, int row) {
  return grid_index(row, image.width, column);
}

}  // namespace

PlanePicture project(const BackSurface& back, const Outline& outline,
                     const std::vector<Vector2>& marks, double pixel_m) {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::max());
  Vector2 high = -low;
  for (const Vector3& p : back.points().points) {
    low = low.cwiseMin(outline.plane(p));
    high = high.cwiseMax(outline.plane(p));
  }
  low.y() = std::max(low.y(), outline.bottom.y() - beyond_m);
  high.y() = std::min(high.y(), outline.neck[left].y() + beyond_m);
  PlanePicture picture;
  picture.pixel_m = pixel_m;
  picture.corner = high;
  const Vector2 size = (high - low) / pixel_m;
  picture.image = Image(static_cast<int>(size.x()) + 1, static_cast<int>(size.y()) + 1, 3);
  std::fill(picture.image.data.begin(), picture.image.data.end(), std::uint8_t{255});
  picture.marked.assign(picture.image.data.size() / 3, -1);
  const Transform couch_from_back = outline.back_from_couch.inverse();
  for (int row = 0; row < picture.image.height; ++row) {
    for (int column = 0; column < picture.image.width; ++column) {
      const Vector2 at = picture.place_of(column, row);
      const auto hit = back.along(couch_from_back * Vector3(at.x(), 0.6, at.y()),
                                  -couch_from_back.linear().col(1));
      if (!hit) continue;
      put(picture.image, column, row,
          skin(outline.back_from_couch.linear() * hit->normal_in_couch));
      for (std::size_t i = 0; i < marks.size(); ++i) {
        if ((marks[i] - at).norm() > sticker_radius_m) continue;
        put(picture.image, column, row, red);
        picture.marked[index_of(picture.image, column, row)] = static_cast<int>(i);
      }
    }
  }
  return picture;
}

PlanePicture morph(const PlanePicture& standard, const std::vector<FeatureLine>& standard_lines,
                   const PlanePicture& person, const std::vector<FeatureLine>& person_lines,
                   double alpha) {
  PlanePicture morphed = person;
  for (int row = 0; row < person.image.height; ++row) {
    for (int column = 0; column < person.image.width; ++column) {
      // The background shows through: only skin is mapped onto skin.
      std::uint8_t* pixel = morphed.image.row(row) + 3 * column;
      const Vector2 source =
          standard.pixel_of(warp(person.place_of(column, row), person_lines, standard_lines));
      const auto from_column = static_cast<int>(std::lround(source.x()));
      const auto from_row = static_cast<int>(std::lround(source.y()));
      if (from_column < 0 || from_row < 0 || from_column >= standard.image.width ||
          from_row >= standard.image.height) {
        continue;
      }
      const std::uint8_t* from = standard.image.row(from_row) + 3 * from_column;
      const int mark = standard.marked[index_of(standard.image, from_column, from_row)];
      morphed.marked[index_of(person.image, column, row)] = mark;
      // (5.6), but a mark stays red whatever alpha is.
      const double share = mark >= 0 ? 1.0 : alpha;
      for (int channel = 0; channel < 3; ++channel) {
        pixel[channel] = static_cast<std::uint8_t>(
            std::lround((1.0 - share) * pixel[channel] + share * from[channel]));
      }
    }
  }
  return morphed;
}

std::optional<Vector2> found_mark(const PlanePicture& morphed, int mark) {
  std::vector<Vector2> candidates;
  Vector2 mean = Vector2::Zero();
  for (int row = 0; row < morphed.image.height; ++row) {
    for (int column = 0; column < morphed.image.width; ++column) {
      if (morphed.marked[index_of(morphed.image, column, row)] != mark) continue;
      candidates.push_back(morphed.place_of(column, row));
      mean += candidates.back();
    }
  }
  if (candidates.empty()) return {};
  mean /= static_cast<double>(candidates.size());
  return *std::min_element(candidates.begin(), candidates.end(),
                           [&](const Vector2& a, const Vector2& b) {
                             return (a - mean).squaredNorm() < (b - mean).squaredNorm();
                           });
}

}  // namespace tuina::baselines
