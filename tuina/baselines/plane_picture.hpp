// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/field_morphing.hpp"
#include "tuina/body/outline.hpp"
#include "tuina/core/image.hpp"

namespace tuina::baselines {

/// A back projected on its plane, seen from behind ([thesis] 5.3): what [thesis] 5.2 warps. Points
/// that are answered with are red in it.
struct PlanePicture {
  Image image;                  ///< RGB; background white
  std::vector<int> marked;      ///< of each pixel, the number of the mark it shows; else -1
  Vector2 corner = {0.0, 0.0};  ///< place of the upper left pixel on the plane of the outline
  double pixel_m = 2e-3;

  [[nodiscard]] Vector2 place_of(int column, int row) const {
    // Seen from behind, the person's left is on the left.
    return corner - pixel_m * Vector2(column, row);
  }
  [[nodiscard]] Vector2 pixel_of(const Vector2& place) const { return (corner - place) / pixel_m; }
};

/// The back from the neck to the lower end of the midline, with marks painted on it as round red
/// stickers.
[[nodiscard]] PlanePicture project(const body::BackSurface& back, const body::Outline& outline,
                                   const std::vector<Vector2>& marks, double pixel_m = 2e-3);

/// Algorithm 2: every pixel of the person's picture is given the pixel of the standard that the
/// lines bring there, and dissolved into the person by (5.6): `alpha` 0 shows the person, 1 the
/// standard in the person's shape.
[[nodiscard]] PlanePicture morph(const PlanePicture& standard,
                                 const std::vector<body::FeatureLine>& standard_lines,
                                 const PlanePicture& person,
                                 const std::vector<body::FeatureLine>& person_lines,
                                 double alpha = 0.5);

/// (5.7): of the candidates, the pixels that show the mark, the one nearest to their mean; nothing
/// where none shows it.
[[nodiscard]] std::optional<Vector2> found_mark(const PlanePicture& morphed, int mark);

}  // namespace tuina::baselines
