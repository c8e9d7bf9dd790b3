// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/laser_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>

#include "tuina/scanner/line/clear_lines.hpp"
#include "tuina/scanner/line/line_candidates.hpp"
#include "tuina/scanner/line/line_continuity.hpp"
#include "tuina/scanner/line/line_fit.hpp"
#include "tuina/scanner/line/line_kernel.hpp"
#include "tuina/scanner/line/line_rows.hpp"

namespace tuina::scanner {
namespace {

// Maximum width of a clipped line: this and eight line widths.
constexpr float max_plateau_px = 16.0F;
// Of the rows with a line, the share that may show several: more are the texture of a lit scene.
constexpr float max_unclear_share = 0.25F;
// Number of rows that suffices to estimate noise and line width.
constexpr int sampled_rows = 20;

// A row as it is where nothing is taken off it, else as numbers.
template <typename Sample, typename Pixel>
const Sample* samples(LineRows<Pixel>& rows, int y) {
  if constexpr (std::is_same_v<Sample, Pixel>) {
    return rows.image().row(y);
  } else {
    return rows.row(y);
  }
}

enum class Shows : std::uint8_t { nothing, one_line, several };

// Classification of a row: its brightest position, and what else it shows.
struct RowContent {
  Shows shows = Shows::nothing;
  Candidate brightest;
};

const std::uint8_t* where_is(std::uint8_t value, const std::uint8_t* from, const std::uint8_t* to) {
  return static_cast<const std::uint8_t*>(
      std::memchr(from, value, static_cast<std::size_t>(to - from)));
}
const float* where_is(float value, const float* from, const float* to) {
  return std::find(from, to, value);
}

template <typename Sample>
RowContent inspect(const Sample* row, const LineScene& scene) {
  const int first = scene.first_column;
  const int last = scene.last_column;
  const auto most = largest(row + first, last - first + 1);
  if (static_cast<float>(most) < scene.background_dn + min_pixel_snr * scene.noise_dn) return {};

  const Sample* at = where_is(most, row + first, row + last + 1);
  int left = static_cast<int>(at - row);
  int right = left;
  // The centre of a clipped line is the centre of its plateau, not the first of equal pixels.
  if (static_cast<float>(most) >= scene.saturated_dn) {
    while (right < last && static_cast<float>(row[right + 1]) >= scene.saturated_dn) ++right;
    if (static_cast<float>(right - left) > max_plateau_px + 8.0F * scene.width_px) {
      return {Shows::several, {}};  // a lamp or a white field
    }
  }
  const int reach = scene.beside_px + (right - left) / 2;
  const int middle = (left + right) / 2;
  const auto mean = [&](int from, int to) {
    from = std::max(from, first);
    to = std::min(to, last);
    float sum = 0.0F;
    for (int x = from; x <= to; ++x) sum += static_cast<float>(row[x]);
    return to >= from ? sum / static_cast<float>(to - from + 1) : -1.0F;
  };
  const float left_dn = mean(middle - reach - 7, middle - reach);
  const float right_dn = mean(middle + reach, middle + reach + 7);
  const float beside_dn = std::max(left_dn, right_dn);
  const float height = static_cast<float>(most) - beside_dn;
  if (height < min_pixel_snr * scene.noise_dn)
    return {Shows::several, {}};  // an edge, or a bright field

  // A hot pixel has dark neighbours; even a sharp line is wider.
  const auto above = [&](int x) {
    return x < first || x > last ? 0.0F : static_cast<float>(row[x]) - beside_dn;
  };
  if (left == right && std::max(above(left - 1), above(left + 1)) < 0.25F * height) {
    return {Shows::several, {}};
  }
  const float rival = beside_dn + std::max(rival_share * height, min_pixel_snr * scene.noise_dn);
  const int until = middle - reach;
  const int from = middle + reach;
  if ((until > first && static_cast<float>(largest(row + first, until - first)) > rival) ||
      (from<last&& static_cast<float>(largest(row + from, last - from + 1))> rival)) {
    return {Shows::several, {}};
  }
  // The brightest pixel of a wide line may be anywhere in its middle; its flanks tell more.
  if (scene.width_px > static_cast<float>(max_kernel_px)) {
    const float half = beside_dn + 0.5F * height;
    while (left > first && static_cast<float>(row[left - 1]) > half) --left;
    while (right<last&& static_cast<float>(row[right + 1])> half) ++right;
  }
  return {Shows::one_line,
          {.column_px = 0.5F * static_cast<float>(left + right), .height_dn = height}};
}

[[nodiscard]] bool kernel_fits(float column_px, const LineScene& scene) {
  const int start = static_cast<int>(std::floor(column_px + 0.5F)) - LineKernel::before;
  return start >= scene.first_column && start + LineKernel::taps <= scene.last_column + 1;
}

// The kernels of the slow rows take floats.
const float* window_of(const float* samples, std::array<float, LineKernel::taps>&) {
  return samples;
}
const float* window_of(const std::uint8_t* samples, std::array<float, LineKernel::taps>& room) {
  std::copy_n(samples, LineKernel::taps, room.begin());
  return room.data();
}

// Three kernel steps from a pixel near the line; nothing if they diverge.
template <typename Sample>
std::optional<LinePoint> weigh_line(const Sample* row, float column_px, const LineKernel& kernel,
                                    const LineScene& scene) {
  std::array<float, LineKernel::taps> room;
  float column = column_px;
  float height = 0.0F;
  for (int step = 0; step < 3; ++step) {
    const float nearest = std::floor(column + 0.5F);
    if (!kernel_fits(column, scene)) return {};
    const int start = static_cast<int>(nearest) - LineKernel::before;
    const float part = column - nearest + 0.5F;
    const int phase = std::min(static_cast<int>(part * LineKernel::phases), LineKernel::phases - 1);
    const LineStep sums =
        weigh(window_of(row + start, room), kernel.of_phase[static_cast<std::size_t>(phase)]);
    if (sums.height <= 0.0F) return {};
    height = sums.height;
    const float middle = nearest + LineKernel::centre_of(phase);
    const float move = sums.offset / sums.height;
    if (std::abs(move) > 4.0F) return {};
    const bool settled = std::abs(middle + move - column) < 0.02F && step > 0;
    column = middle + move;
    if (settled) break;
  }
  if (std::abs(column - column_px) > 2.0F + static_cast<float>(scene.width_px)) return {};
  return LinePoint{.row = 0,
                   .column_px = column,
                   .amplitude_dn = height,
                   .deviation_px = kernel.deviation_factor * scene.noise_dn / height};
}

// Sub-pixel position near a candidate. Lines that are clipped, cut by the border, wider than the
// kernels or next to a hot pixel are fitted to the usable pixels.
template <typename Sample>
std::optional<LinePoint> measure(const Sample* row, int y, const Candidate& candidate,
                                 const LineKernel& kernel, const LineScene& scene) {
  const int middle = static_cast<int>(std::lround(candidate.column_px));
  const bool plain = static_cast<float>(row[middle]) < scene.saturated_dn &&
                     scene.width_px <= max_kernel_px && kernel_fits(candidate.column_px, scene) &&
                     !has_spike(row, middle, candidate.height_dn, scene);
  std::optional<LinePoint> point = plain ? weigh_line(row, candidate.column_px, kernel, scene)
                                         : fit_line(row, candidate.column_px, scene);
  if (!point) return {};
  if (point->amplitude_dn < min_amplitude_snr * kernel.height_factor * scene.noise_dn) return {};
  point->row = y;
  return point;
}

template <typename Sample, typename Pixel>
LaserLine find_in(LineRows<Pixel>& rows, const LineScene& scene, const LineOptions& options) {
  const int height = rows.height();
  const LineKernel& kernel = options.method == LineMethod::centroid
                                 ? centroid_kernel(scene.width_px)
                                 : gaussian_kernel(scene.width_px);
  LaserLine line;
  line.noise_dn = scene.noise_dn;
  line.width_px = scene.width_px;
  line.points.reserve(static_cast<std::size_t>(height));
  std::vector<CandidateRow> unclear;
  // A wide line is fitted slowly, so only where it is kept.
  const bool wide = scene.width_px > static_cast<float>(max_kernel_px);
  const auto measure_at = [&](int y, const Candidate& candidate) {
    return measure(samples<Sample>(rows, y), y, candidate, kernel, scene);
  };
  const auto inspect_row = [&](int y) {
    const auto* row = samples<Sample>(rows, y);
    const RowContent content = inspect(row, scene);
    if (content.shows == Shows::one_line && wide) {
      line.points.push_back({y, content.brightest.column_px, content.brightest.height_dn});
    } else if (content.shows == Shows::one_line) {
      if (const auto point = measure(row, y, content.brightest, kernel, scene))
        line.points.push_back(*point);
    } else if (content.shows == Shows::several) {
      auto found = find_candidates(row, scene);
      if (!found.empty()) unclear.push_back({y, std::move(found)});
    }
  };
  std::vector<int> in_doubt;
  int inspected = 0;
  if constexpr (std::is_same_v<Sample, std::uint8_t>) {
    if (!wide) {
      find_clear_lines(rows.image(), scene, kernel, options.method, line.points, in_doubt);
      inspected = height;
      for (const int y : in_doubt) inspect_row(y);
    }
  }
  for (int y = inspected; y < height; ++y) inspect_row(y);
  const auto by_row = [](const LinePoint& a, const LinePoint& b) { return a.row < b.row; };
  if (!in_doubt.empty()) std::sort(line.points.begin(), line.points.end(), by_row);

  for (const CandidateRow& row : unclear) line.ambiguous_rows += row.candidates.size() > 1 ? 1 : 0;
  if (!unclear.empty()) choose_by_continuity(line.points, unclear);
  if (static_cast<float>(unclear.size()) >
      max_unclear_share * static_cast<float>(unclear.size() + line.points.size()))
    keep_what_continues(line.points, unclear, height);
  std::vector<LinePoint> rough;
  if (wide) rough.swap(line.points);
  for (const LinePoint& at : rough) {
    if (const auto point = measure_at(at.row, {at.column_px, at.amplitude_dn}))
      line.points.push_back(*point);
  }
  for (const CandidateRow& row : unclear) {
    if (const auto point = measure_at(row.y, row.candidates.front())) line.points.push_back(*point);
  }
  if (!unclear.empty()) std::sort(line.points.begin(), line.points.end(), by_row);
  drop_lone_rows(line.points, height);
  return line;
}

template <typename Sample, typename Pixel>
LaserLine find_as_thesis(LineRows<Pixel>& rows, const LineScene& scene, double threshold_dn) {
  LaserLine line;
  line.noise_dn = scene.noise_dn;
  line.width_px = scene.width_px;
  const auto threshold = static_cast<float>(threshold_dn);
  for (int y = 0; y < rows.height(); ++y) {
    const auto* row = samples<Sample>(rows, y);
    float light = 0.0F;
    float moment = 0.0F;
    float most = 0.0F;
    for (int x = scene.first_column; x <= scene.last_column; ++x) {
      const auto value = static_cast<float>(row[x]);
      if (value < threshold) continue;
      light += value;
      moment += value * static_cast<float>(x);
      most = std::max(most, value);
    }
    if (light <= 0.0F) continue;
    line.points.push_back(
        {.row = y,
         .column_px = moment / light,
         .amplitude_dn = most,
         .deviation_px = gaussian_kernel(scene.width_px).deviation_factor * scene.noise_dn / most});
  }
  return line;
}

template <typename Sample, typename Pixel>
LaserLine find_by(LineRows<Pixel>& rows, const LineOptions& options) {
  LineScene scene;
  scene.width = rows.width();
  scene.first_column = std::clamp(options.first_column, 0, rows.width() - 1);
  scene.last_column = options.last_column < 0
                          ? rows.width() - 1
                          : std::clamp(options.last_column, scene.first_column, rows.width() - 1);
  scene.saturated_dn = rows.saturated_dn();
  const int step = std::max(1, rows.height() / sampled_rows);
  SceneSample sample(scene, static_cast<std::size_t>(rows.height() / step) + 1);
  for (int y = step / 2; y < rows.height(); y += step) sample.add(samples<Sample>(rows, y), y);
  sample.estimate(scene, options.noise_dn, options.width_px);
  if (options.method == LineMethod::thesis)
    return find_as_thesis<Sample>(rows, scene, options.thesis_threshold_dn);
  if (scene.no_line) return LaserLine{.noise_dn = scene.noise_dn, .width_px = scene.width_px};
  return find_in<Sample>(rows, scene, options);
}

}  // namespace

template <typename Pixel>
LaserLine find_laser_line(LineRows<Pixel> rows, const LineOptions& options) {
  if (rows.width() <= 0 || rows.height() <= 0) return {};
  if constexpr (std::is_same_v<Pixel, std::uint8_t>) {
    if (rows.plain()) return find_by<std::uint8_t>(rows, options);
  }
  return find_by<float>(rows, options);
}

template LaserLine find_laser_line(LineRows<std::uint8_t>, const LineOptions&);
template LaserLine find_laser_line(LineRows<std::uint16_t>, const LineOptions&);

LaserLine find_laser_line(ImageView image, const LineOptions& options, ImageView dark) {
  return find_laser_line(LineRows<std::uint8_t>(image, dark, options.saturated_dn), options);
}

LaserLine find_laser_line(ImageView16 image, const LineOptions& options, ImageView16 dark) {
  return find_laser_line(LineRows<std::uint16_t>(image, dark, options.saturated_dn), options);
}

std::optional<LineMethod> line_method(std::string_view name) {
  if (name == "centroid") return LineMethod::centroid;
  if (name == "likelihood") return LineMethod::likelihood;
  if (name == "thesis") return LineMethod::thesis;
  return std::nullopt;
}

}  // namespace tuina::scanner
