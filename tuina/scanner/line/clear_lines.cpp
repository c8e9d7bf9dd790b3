// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/clear_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/scanner/line/clear_row.hpp"
#include "tuina/scanner/line/line_fit.hpp"

namespace tuina::scanner {
namespace {

RowRule rule_of(const LineScene& scene) {
  return {
      .first = scene.first_column,
      .last = scene.last_column,
      .beside_px = scene.beside_px,
      .min_dn = static_cast<int>(std::ceil(scene.background_dn + min_pixel_snr * scene.noise_dn)),
      .min_height_dn = min_pixel_snr * scene.noise_dn,
      .saturated_dn = scene.saturated_dn,
      .min_spike_dn = min_spike_over_noise * scene.noise_dn,
      .spike_share = spike_share(scene)};
}

class ClearRows {
 public:
  ClearRows(const LineScene& scene, const LineKernel& kernel, LineMethod method)
      : reader_(row_reader()),
        rule_(rule_of(scene)),
        kernel_(kernel),
        min_amplitude_dn_(min_amplitude_snr * kernel.height_factor * scene.noise_dn),
        max_distance_px_(2.0F + scene.width_px),
        deviation_px_dn_(kernel.deviation_factor * scene.noise_dn),
        steps_(method == LineMethod::centroid ? 2 : 3),
        hint_(scene.hint_column) {}

  // Processes the rows [first, first + count): appends points of clear rows and numbers of doubtful
  // ones.
  void take(const ImageView& image, int first, int count, std::vector<LinePoint>& points,
            std::vector<int>& in_doubt) {
    RowBatch rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = image.row(first + std::min(static_cast<int>(i), count - 1));
    }
    BatchView seen;
    reader_.classify(rows, rule_, hint_, seen);
    LineWalk walk = {};
    int lines = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool clear = seen.view[i] == RowView::one_line;
      lines += clear ? 1 : 0;
      walk.column_px[i] =
          static_cast<float>(clear ? seen.brightest[i] : rule_.first + rule_.margin_px());
    }
    if (lines > 0) reader_.walk(rows, kernel_, steps_, walk);
    std::array<LinePoint, rows_at_once> found;
    std::size_t next = 0;
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const float column = walk.column_px[k];
      const float height = walk.height_dn[k];
      found[next] = {.row = first + i,
                     .column_px = column,
                     .amplitude_dn = height,
                     .deviation_px = deviation_px_dn_ / height};
      const bool clear = seen.view[k] == RowView::one_line;
      const float moved_px = std::abs(column - static_cast<float>(seen.brightest[k]));
      const bool counts = clear & (height >= min_amplitude_dn_) & (moved_px <= max_distance_px_);
      next += counts ? 1 : 0;
      hint_ = clear ? seen.brightest[k] : hint_;
      if (seen.view[k] == RowView::in_doubt) in_doubt.push_back(first + i);
    }
    points.insert(points.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(next));
  }

 private:
  const RowReader& reader_;
  RowRule rule_;
  const LineKernel& kernel_;
  float min_amplitude_dn_;
  float max_distance_px_;  // from the brightest pixel to the line
  float deviation_px_dn_;  // standard deviation of the column times the amplitude
  int steps_;
  int hint_;
};

}  // namespace

void find_clear_lines(ImageView image, const LineScene& scene, const LineKernel& kernel,
                      LineMethod method, std::vector<LinePoint>& points,
                      std::vector<int>& in_doubt) {
  ClearRows rows(scene, kernel, method);
  constexpr int batch = rows_at_once;
  for (int y = 0; y < image.height; y += batch) {
    rows.take(image, y, std::min(batch, image.height - y), points, in_doubt);
  }
}

}  // namespace tuina::scanner
