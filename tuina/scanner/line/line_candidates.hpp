// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// Image-wide parameters of the line search.
struct LineScene {
  int width = 0;
  int first_column = 0;
  int last_column = 0;
  float saturated_dn = 255.0F;
  float noise_dn = 1.0F;
  float background_dn = 0.0F;  ///< level of a usual pixel
  float width_px = 2.5F;       ///< standard deviation across the line
  bool no_line = false;        ///< what is brightest is too wide for a laser line
  int beside_px = 9;           ///< distance at which a pixel beside the line shows background
  int hint_column = 0;         ///< start of the search, for speed only
};

/// Thresholds in standard deviations of the noise: brightest pixel of a row to be examined, and
/// fitted amplitude to be accepted (no false line in 10^5 dark rows).
inline constexpr float min_pixel_snr = 4.5F;
inline constexpr float min_amplitude_snr = 6.5F;
/// Minimum height ratio at which a second line counts as ambiguous.
inline constexpr float rival_share = 0.5F;

/// Estimates noise, background and line width from a sample of rows.
class SceneSample {
 public:
  /// For frames of so many rows.
  SceneSample(const LineScene& scene, std::size_t rows);
  /// @{
  /// Takes the row at height `y` of the picture into the sample.
  void add(const std::uint8_t* row, int y);
  void add(const float* row, int y);
  /// @}
  /// Fills in the scene; arguments above zero replace estimates.
  void estimate(LineScene& scene, double noise_dn, double width_px) const;

 private:
  template <typename Sample>
  void add_row(const Sample* row, int y);

  LineScene scene_;
  int first_peak_ = -1;
  std::vector<float> means_;      ///< means of short segments
  std::vector<float> spreads_;    ///< noise standard deviation in the same segments
  std::vector<float> brightest_;  ///< brightest pixel of each row
  std::vector<float> widths_;     ///< width of each row's line at half height
};

/// A possible line position in a row.
struct Candidate {
  float column_px = 0.0F;
  float height_dn = 0.0F;
};

/// Where the line may be in one row.
struct CandidateRow {
  int y = 0;
  std::vector<Candidate> candidates;  ///< brightest first
};

/// Up to four ridges of a row that stand above both sides.
[[nodiscard]] std::vector<Candidate> find_candidates(const std::uint8_t* row,
                                                     const LineScene& scene);
[[nodiscard]] std::vector<Candidate> find_candidates(const float* row, const LineScene& scene);

}  // namespace tuina::scanner
