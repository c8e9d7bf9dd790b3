// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// What is known of a whole image before its rows are judged one by one.
struct LineScene {
  int width = 0;
  int first_column = 0;
  int last_column = 0;
  float saturated_dn = 255.0F;
  float noise_dn = 1.0F;
  float background_dn = 0.0F;  ///< of a usual pixel
  float width_px = 2.5F;       ///< standard deviation across the line
  int beside_px = 9;           ///< from here on a pixel beside the line shows background
  int hint_column = 0;         ///< where the line may begin; it only saves time
};

/// A line must stand this many standard deviations above the noise: the brightest pixel of a row to
/// be looked at, and the fitted amplitude to be believed (of 10^5 rows without a line none passes).
inline constexpr float min_pixel_snr = 4.5F;
inline constexpr float min_amplitude_snr = 6.5F;
/// A second line counts as a rival of the first from this share of its height.
inline constexpr float rival_share = 0.5F;

/// Learns noise, background and width of the line from a few rows of the image.
class SceneSample {
 public:
  SceneSample(const LineScene& scene, std::size_t rows);
  void add(const std::uint8_t* row, int y);
  void add(const float* row, int y);
  /// Fills in the scene; values above zero are taken instead of estimates.
  void judge(LineScene& scene, double noise_dn, double width_px) const;

 private:
  template <typename Sample>
  void add_row(const Sample* row, int y);

  LineScene scene_;
  int first_peak_ = -1;
  std::vector<float> means_;      ///< of short segments
  std::vector<float> spreads_;    ///< standard deviation of the noise in the same segments
  std::vector<float> brightest_;  ///< of each row
  std::vector<float> widths_;     ///< of each row at half the height of its brightest place
};

/// A place in a row that looks like a line.
struct Candidate {
  float column_px = 0.0F;
  float height_dn = 0.0F;
};

struct CandidateRow {
  int y = 0;
  std::vector<Candidate> candidates;  ///< brightest first
};

/// All places in a row where a ridge stands above what is on both sides of it, at most four.
[[nodiscard]] std::vector<Candidate> find_candidates(const std::uint8_t* row,
                                                     const LineScene& scene);
[[nodiscard]] std::vector<Candidate> find_candidates(const float* row, const LineScene& scene);

/// Moves to the front of each row the candidate that continues the line best, the clear rows being
/// given.
void choose_by_continuity(const std::vector<LinePoint>& clear, std::vector<CandidateRow>& unclear);

}  // namespace tuina::scanner
