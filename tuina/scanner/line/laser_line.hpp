// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/core/image.hpp"

namespace tuina::scanner {

/// How the laser line is found in a row of a picture.
enum class LineMethod : std::uint8_t {
  centroid,    ///< centroid above the local background, for a line of any shape
  likelihood,  ///< Gauss-Newton to the maximum-likelihood position of a Gaussian line
  thesis,      ///< [thesis] (4.10): centroid of all pixels above a threshold, as baseline
};

/// Parses a method name; nothing for any other word.
[[nodiscard]] std::optional<LineMethod> line_method(std::string_view name);

/// Intersection of the laser line with one image row. Pixel centres are integers.
struct LinePoint {
  int row = 0;
  float column_px = 0.0F;
  float amplitude_dn = 0.0F;  ///< height above the local background
  float deviation_px = 0.0F;  ///< standard deviation of column_px from image noise
};

/// The laser line in one frame.
struct LaserLine {
  std::vector<LinePoint>
      points;              ///< at most one per row, rows rising; rows without a line are absent
  int ambiguous_rows = 0;  ///< rows with a second line nearly as bright, such as a reflection
  double noise_dn = 0.0;   ///< noise that was assumed
  double width_px = 0.0;   ///< standard deviation across the line
};

/// How the line is looked for.
struct LineOptions {
  LineMethod method = LineMethod::centroid;
  double noise_dn = 0.0;      ///< noise of one pixel; 0: estimated from the image
  double width_px = 0.0;      ///< standard deviation across the line; 0: estimated from the image
  double saturated_dn = 0.0;  ///< clipping level; 0: maximum of the sample type
  double thesis_threshold_dn = 100.0;  ///< LineMethod::thesis only
  int first_column = 0;                ///< first column where the laser plane can appear
  int last_column = -1;                ///< negative: the last of the image
};

/// Finds the laser line with sub-pixel accuracy, one position per row. `dark`: the same view with
/// the laser off, or empty. Handles lines cut by the border, gaps, saturation, hot pixels, room
/// light and a second, reflected line; rows whose signal is within the noise yield no point.
[[nodiscard]] LaserLine find_laser_line(ImageView image, const LineOptions& options = {},
                                        ImageView dark = {});
[[nodiscard]] LaserLine find_laser_line(ImageView16 image, const LineOptions& options = {},
                                        ImageView16 dark = {});

}  // namespace tuina::scanner
