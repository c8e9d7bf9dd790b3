// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tuina/core/image.hpp"

namespace tuina::scanner {

enum class LineMethod : std::uint8_t {
  centroid,    ///< centroid of what rises above the local background, for a line of any shape
  likelihood,  ///< Gauss-Newton steps to the most likely place of a Gaussian line
  thesis,  ///< [thesis] (4.10): centroid of all pixels above a threshold; a baseline for comparison
};

/// By its name on the command line and in config files; nothing for any other word.
[[nodiscard]] std::optional<LineMethod> line_method(std::string_view name);

/// Where the laser line crosses one row of the image. Pixel centres are whole numbers.
struct LinePoint {
  int row = 0;
  float column_px = 0.0F;
  float amplitude_dn = 0.0F;  ///< height above the local background
  float deviation_px =
      0.0F;  ///< standard deviation of column_px that the noise of the image causes
};

struct LaserLine {
  std::vector<LinePoint>
      points;  ///< at most one per row, rows rising; a row without a line has none
  int ambiguous_rows =
      0;                  ///< rows that showed a second line nearly as bright, as a reflection does
  double noise_dn = 0.0;  ///< the noise that was assumed
  double width_px = 0.0;  ///< standard deviation of the line across its length
};

struct LineOptions {
  LineMethod method = LineMethod::centroid;
  double noise_dn = 0.0;  ///< of one pixel; 0: estimated from the image
  double width_px = 0.0;  ///< standard deviation across the line; 0: estimated from the image
  double saturated_dn =
      0.0;  ///< pixels at or above it are clipped; 0: the largest of the sample type
  double thesis_threshold_dn = 100.0;  ///< used by LineMethod::thesis only
  int first_column = 0;                ///< where the laser plane can appear in the image
  int last_column = -1;                ///< negative: the last of the image
};

/// Finds the laser line, one place per row, to a fraction of a pixel. `dark` is the same picture
/// with the laser off, or empty. Lines cut by the image border, gaps, saturation, single hot
/// pixels, room light and a second, reflected line are dealt with row by row; what cannot be told
/// from noise yields no point.
[[nodiscard]] LaserLine find_laser_line(ImageView image, const LineOptions& options = {},
                                        ImageView dark = {});
[[nodiscard]] LaserLine find_laser_line(ImageView16 image, const LineOptions& options = {},
                                        ImageView16 dark = {});

}  // namespace tuina::scanner
