// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "tuina/scanner/line/laser_line.hpp"
#include "tuina/scanner/line/line_candidates.hpp"

namespace tuina::scanner {

/// Hot-pixel criterion: exceeds both neighbours by this many times the noise plus `spike_share` of
/// the line's height. On a line of width w the step between pixels is at most 0.61 / w of its
/// height.
inline constexpr float min_spike_over_noise = 8.0F;
[[nodiscard]] float spike_share(const LineScene& scene);

/// True when a single pixel near the line is a hot pixel.
[[nodiscard]] bool has_spike(const std::uint8_t* row, int column, float height_dn,
                             const LineScene& scene);
[[nodiscard]] bool has_spike(const float* row, int column, float height_dn, const LineScene& scene);

/// Fits amplitude, position, width and background of a Gaussian line to the pixels around
/// `column_px`, without clipped, hot or outside pixels. Nothing when less than half of the line is
/// left or the fit fails.
[[nodiscard]] std::optional<LinePoint> fit_line(const std::uint8_t* row, float column_px,
                                                const LineScene& scene);
[[nodiscard]] std::optional<LinePoint> fit_line(const float* row, float column_px,
                                                const LineScene& scene);

}  // namespace tuina::scanner
