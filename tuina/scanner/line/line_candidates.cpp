// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "tuina/scanner/line/line_kernel.hpp"

namespace tuina::scanner {
namespace {

constexpr int segment = 16;
constexpr int lag = 4;
constexpr float mean_difference_per_deviation = 1.1284F;  // of two equal Gaussians
constexpr std::size_t max_candidates = 4;
constexpr float min_snr = 5.0F;

float median_of(std::vector<float> values) {
  if (values.empty()) return 0.0F;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Interquartile mean: steadier than the median for integer samples.
float middle_mean(std::vector<float> values) {
  if (values.empty()) return 0.0F;
  std::sort(values.begin(), values.end());
  const std::size_t from = values.size() / 4;
  const std::size_t to = values.size() - from;
  float sum = 0.0F;
  for (std::size_t i = from; i < to; ++i) sum += values[i];
  return sum / static_cast<float>(to - from);
}

// 84th percentile minus median.
template <typename Sample>
float upper_spread(const Sample* pixels) {
  std::array<float, segment> values;
  std::copy_n(pixels, segment, values.begin());
  std::sort(values.begin(), values.end());
  return values[13] - 0.5F * (values[7] + values[8]);
}

const std::uint8_t* brightest_of(const std::uint8_t* row, int first, int last) {
  const int count = last - first + 1;
  return static_cast<const std::uint8_t*>(
      std::memchr(row + first, largest(row + first, count), static_cast<std::size_t>(count)));
}
const float* brightest_of(const float* row, int first, int last) {
  return std::find(row + first, row + last, largest(row + first, last - first + 1));
}

template <typename Sample>
Sample smallest(const Sample* samples, int count) {
  Sample least = samples[0];
  for (int i = 1; i < count; ++i) least = samples[i] < least ? samples[i] : least;
  return least;
}

/// Height of each pixel's surroundings, as wide as the line, above both sides.
template <typename Sample>
std::vector<float> ridge_heights(const Sample* row, const LineScene& scene, int core) {
  const int first = scene.first_column;
  const int count = scene.last_column - first + 1;
  // Clamps each pixel to its brighter neighbour plus noise: removes hot pixels, keeps lines.
  std::vector<float> sums(static_cast<std::size_t>(count) + 1, 0.0F);
  for (int i = 0; i < count; ++i) {
    const auto value = static_cast<float>(row[first + i]);
    const float left = i > 0 ? static_cast<float>(row[first + i - 1]) : value;
    const float right = i + 1 < count ? static_cast<float>(row[first + i + 1]) : value;
    sums[static_cast<std::size_t>(i) + 1] =
        sums[static_cast<std::size_t>(i)] +
        std::min(value, std::max(left, right) + 4.0F * scene.noise_dn);
  }
  const auto mean = [&](int from, int to) {
    from = std::max(from, 0);
    to = std::min(to, count - 1);
    return (sums[static_cast<std::size_t>(to) + 1] - sums[static_cast<std::size_t>(from)]) /
           static_cast<float>(to - from + 1);
  };
  const int side = scene.beside_px;
  std::vector<float> ridge(static_cast<std::size_t>(count), 0.0F);
  const auto ridge_near_border = [&](int i) {
    const float left = i - side >= 0 ? mean(i - side - 2 * core, i - side) : -1e9F;
    const float right = i + side < count ? mean(i + side, i + side + 2 * core) : -1e9F;
    return mean(i - core, i + core) - std::max(left, right);
  };
  const int border = std::min(count, side + 2 * core);
  for (int i = 0; i < border; ++i) ridge[static_cast<std::size_t>(i)] = ridge_near_border(i);
  // Away from the borders no mean is cut short, so that the compiler can vectorise.
  const float per_width = 1.0F / static_cast<float>(2 * core + 1);
  const float* sum = sums.data();
  for (int i = border; i < count - border; ++i) {
    const float left = sum[i - side + 1] - sum[i - side - 2 * core];
    const float right = sum[i + side + 2 * core + 1] - sum[i + side];
    const float middle = sum[i + core + 1] - sum[i - core];
    ridge[static_cast<std::size_t>(i)] = per_width * (middle - (left > right ? left : right));
  }
  for (int i = std::max(border, count - border); i < count; ++i)
    ridge[static_cast<std::size_t>(i)] = ridge_near_border(i);
  return ridge;
}

template <typename Sample>
std::vector<Candidate> ridges(const Sample* row, const LineScene& scene) {
  const int first = scene.first_column;
  const int count = scene.last_column - first + 1;
  const int core = std::max(1, static_cast<int>(std::lround(scene.width_px)));
  const int side = scene.beside_px;
  const std::vector<float> ridge = ridge_heights(row, scene, core);
  const float level = min_snr * scene.noise_dn * std::sqrt(2.0F / static_cast<float>(2 * core + 1));
  std::vector<Candidate> found;
  const int apart = side / 2 + 1;
  for (int i = 0; i < count; ++i) {
    const float here = ridge[static_cast<std::size_t>(i)];
    if (here < level) continue;
    // Most places have a higher neighbour, which spares the search below.
    if (i > 0 && ridge[static_cast<std::size_t>(i) - 1] >= here) continue;
    if (i + 1 < count && ridge[static_cast<std::size_t>(i) + 1] > here) continue;
    const int from = std::max(0, i - apart);
    const int to = std::min(count - 1, i + apart);
    const auto best = std::max_element(ridge.begin() + from, ridge.begin() + to + 1);
    if (best != ridge.begin() + i) continue;
    // The centre of a clipped, flat ridge.
    int end = i;
    while (end < to && ridge[static_cast<std::size_t>(end) + 1] >= here) ++end;
    found.push_back({static_cast<float>(first) + 0.5F * static_cast<float>(i + end), here});
  }
  std::sort(found.begin(), found.end(),
            [](const Candidate& a, const Candidate& b) { return a.height_dn > b.height_dn; });
  if (found.size() > max_candidates) found.resize(max_candidates);
  while (found.size() > 1 && found.back().height_dn < 0.35F * found.front().height_dn)
    found.pop_back();
  return found;
}

}  // namespace

template <typename Sample>
void SceneSample::add_row(const Sample* row, int y) {
  const int first = scene_.first_column;
  const int last = scene_.last_column;
  if (last - first + 1 >= segment + lag) {
    // The segment moves with the row so that no column is preferred. Differences over a few columns
    // separate noise from gradients of the room light, also when the camera blends neighbours.
    const int start = first + (y * 211) % (last - first - segment - lag + 2);
    // Integer sums are exact in any order, so the compiler can vectorise.
    using Sum = std::conditional_t<std::is_floating_point_v<Sample>, float, int>;
    Sum sum = 0;
    Sum differences = 0;
    int black = 0;
    for (int i = start; i < start + segment; ++i) {
      sum += row[i];
      differences += row[i] > row[i + lag] ? row[i] - row[i + lag] : row[i + lag] - row[i];
      black += row[i] == Sample{} ? 1 : 0;
    }
    means_.push_back(static_cast<float>(sum) / segment);
    spreads_.push_back(static_cast<float>(differences) / (segment * mean_difference_per_deviation));
    // A black row clips half of the noise; the upper half determines it.
    if (black > segment / 8) spreads_.back() = upper_spread(row + start);
  }
  const Sample* brightest = brightest_of(row, first, last);
  int peak = static_cast<int>(brightest - row);
  auto most = static_cast<float>(*brightest);
  const auto value = [&](int x) { return static_cast<float>(row[std::clamp(x, first, last)]); };
  if (std::max(value(peak - 1), value(peak + 1)) < 0.5F * most) {
    // Probably a hot pixel: the dimmer one of the brightest pair is the line.
    most = 0.0F;
    for (int x = first; x < last; ++x) {
      const float dimmer = std::min(value(x), value(x + 1));
      if (dimmer <= most) continue;
      most = dimmer;
      peak = x;
    }
  }
  const int from = std::max(first, peak - 40);
  const Sample lowest = smallest(row + from, std::min(last, peak + 40) - from + 1);
  const float half = 0.5F * (most + std::min(most, static_cast<float>(lowest)));
  int left = peak;
  int right = peak;
  while (left > first && static_cast<float>(row[left]) > half) --left;
  while (right<last&& static_cast<float>(row[right])> half) ++right;
  const auto crossing = [&](int outside, int inside) {
    const auto low = static_cast<float>(row[outside]);
    const auto high = static_cast<float>(row[inside]);
    return high > low ? (half - low) / (high - low) : 0.5F;
  };
  if (first_peak_ < 0) first_peak_ = peak;
  brightest_.push_back(most);
  widths_.push_back(right - left < 2 ? 0.0F
                                     : static_cast<float>(right - left) - crossing(left, left + 1) -
                                           crossing(right, right - 1));
}

SceneSample::SceneSample(const LineScene& scene, std::size_t rows) : scene_(scene) {
  for (auto* values : {&means_, &spreads_, &brightest_, &widths_}) values->reserve(rows);
}

void SceneSample::add(const std::uint8_t* row, int y) {
  add_row(row, y);
}
void SceneSample::add(const float* row, int y) {
  add_row(row, y);
}

void SceneSample::estimate(LineScene& scene, double noise_dn, double width_px) const {
  // Background of the darker parts, where a line is visible even if a lamp or white wall fills the
  // rest.
  if (!means_.empty()) {
    auto sorted = means_;
    std::sort(sorted.begin(), sorted.end());
    scene.background_dn = sorted[sorted.size() / 4];
  }
  // Rounding alone is 0.29 DN of noise, so a lower estimate is implausible.
  scene.noise_dn =
      noise_dn > 0.0 ? static_cast<float>(noise_dn) : std::max(0.5F, middle_mean(spreads_));
  const float usual_dn = median_of(means_);
  std::vector<float> lit;
  for (std::size_t i = 0; i < widths_.size(); ++i) {
    if (brightest_[i] > usual_dn + 8.0F * scene.noise_dn && widths_[i] > 1.0F) {
      lit.push_back(widths_[i]);
    }
  }
  const float full_width_per_deviation = 2.3548F;
  if (width_px > 0.0) {
    scene.width_px = static_cast<float>(width_px);
  } else if (!lit.empty()) {
    // What is wider is no laser line but the scene, which may be brighter than the line in most
    // rows, but not in nearly all.
    constexpr float widest_px = 12.0F, widest_share = 1.0F / 200.0F;
    const float max_width_px = std::max(widest_px, widest_share * static_cast<float>(scene.width));
    const auto wide = std::partition(lit.begin(), lit.end(), [&](float full_px) {
      return full_px < full_width_per_deviation * max_width_px;
    });
    const auto narrow = wide - lit.begin();
    scene.no_line = 4 * narrow < std::ssize(lit);
    lit.erase(wide, lit.end());
    scene.width_px =
        scene.no_line ? max_width_px : std::max(0.5F, median_of(lit) / full_width_per_deviation);
  }
  scene.hint_column = std::max(0, first_peak_);
  scene.beside_px = static_cast<int>(std::ceil(3.2F * scene.width_px)) + 1;
}

std::vector<Candidate> find_candidates(const std::uint8_t* row, const LineScene& scene) {
  return ridges(row, scene);
}

std::vector<Candidate> find_candidates(const float* row, const LineScene& scene) {
  return ridges(row, scene);
}

}  // namespace tuina::scanner
