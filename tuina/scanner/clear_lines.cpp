// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/clear_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/scanner/clear_row.hpp"
#include "tuina/scanner/line_fit.hpp"

namespace tuina::scanner {
namespace {

class ClearRows {
 public:
  ClearRows(const LineScene& scene, const LineKernel& kernel, LineMethod method)
      : reader_(row_reader()),
        span_{scene.first_column, scene.last_column, scene.beside_px,
              static_cast<int>(std::ceil(scene.background_dn + least_pixel_snr * scene.noise_dn))},
        scene_(scene),
        kernel_(kernel),
        spike_share_(spike_share(scene)),
        steps_(method == LineMethod::centroid ? 2 : 3) {}

  // Takes the rows [first, first + count): the points of the clear ones are added, the numbers of
  // those in doubt too.
  void take(const ImageView& image, int first, int count, std::vector<LinePoint>& points,
            std::vector<int>& in_doubt) {
    RowBatch rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = image.row(first + std::min(static_cast<int>(i), count - 1));
    }
    std::array<RowFacts, rows_at_once> facts;
    reader_.read(rows, span_, hint_, facts);
    hint_ = facts.back().at;
    RowBatch clear = rows;
    LineWalk walk;
    walk.column_px.fill(static_cast<float>(span_.first + span_.margin_px()));
    std::array<int, rows_at_once> row_of;
    std::size_t lines = 0;
    for (int i = 0; i < count; ++i) {
      const RowFacts& fact = facts[static_cast<std::size_t>(i)];
      const Verdict verdict = judge(fact);
      if (verdict == Verdict::in_doubt) in_doubt.push_back(first + i);
      if (verdict != Verdict::one_line) continue;
      clear[lines] = rows[static_cast<std::size_t>(i)];
      walk.column_px[lines] = static_cast<float>(fact.at);
      row_of[lines++] = i;
    }
    if (lines == 0) return;
    reader_.walk(clear, kernel_, steps_, walk);
    const float least_dn = least_amplitude_snr * kernel_.height_factor * scene_.noise_dn;
    for (std::size_t k = 0; k < lines; ++k) {
      const int at = facts[static_cast<std::size_t>(row_of[k])].at;
      const float column = walk.column_px[k];
      const float height = walk.height_dn[k];
      if (height < least_dn || std::abs(column - static_cast<float>(at)) > 2.0F + scene_.width_px) {
        continue;
      }
      points.push_back({.row = first + row_of[k],
                        .column_px = column,
                        .amplitude_dn = height,
                        .deviation_px = kernel_.deviation_factor * scene_.noise_dn / height});
    }
  }

 private:
  enum class Verdict : std::uint8_t { nothing, one_line, in_doubt };

  [[nodiscard]] Verdict judge(const RowFacts& facts) const {
    if (facts.most < span_.least_dn) return Verdict::nothing;
    const auto most = static_cast<float>(facts.most);
    const float least = least_pixel_snr * scene_.noise_dn;
    const float beside_dn = 0.125F * static_cast<float>(std::max(facts.left_sum, facts.right_sum));
    const float height = most - beside_dn;
    const bool clear =
        (most < scene_.saturated_dn) & span_.has_margin(facts.at) & (height >= least) &
        (static_cast<float>(facts.neighbour) - beside_dn >= 0.25F * height) &
        (static_cast<float>(facts.rival) <= beside_dn + std::max(rival_share * height, least)) &
        (static_cast<float>(facts.spike) <=
         least_spike_over_noise * scene_.noise_dn + spike_share_ * height);
    return clear ? Verdict::one_line : Verdict::in_doubt;
  }

  const RowReader& reader_;
  RowSpan span_;
  LineScene scene_;
  const LineKernel& kernel_;
  float spike_share_;
  int steps_;
  int hint_ = 0;
};

}  // namespace

void find_clear_lines(ImageView image, const LineScene& scene, const LineKernel& kernel,
                      LineMethod method, std::vector<LinePoint>& points,
                      std::vector<int>& in_doubt) {
  ClearRows rows(scene, kernel, method);
  constexpr int batch = rows_at_once;
  // A picture that comes from main memory is asked for a few rows ahead, or the sums would wait.
  const auto fetch = [&](int from, int count) {
    for (int y = from; y < std::min(image.height, from + count); ++y) {
      for (int x = scene.first_column; x <= scene.last_column; x += 64) {
        __builtin_prefetch(image.row(y) + x);
      }
    }
  };
  fetch(0, 2 * batch);
  for (int y = 0; y < image.height; y += batch) {
    fetch(y + 2 * batch, batch);
    rows.take(image, y, std::min(batch, image.height - y), points, in_doubt);
  }
}

}  // namespace tuina::scanner
