// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/latency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"
#include "tuina/scanner/recording.hpp"

namespace tuina::calibration {
namespace {

constexpr double count_rad = from_deg(300.0 / 1024.0);
constexpr double min_swing_rad = 5.0_deg;
constexpr double step_rad = 0.1_deg;  // sampling of yaw; a sweep has a frame per 0.2
constexpr double max_s = 1.0;
constexpr double unsure_s = 0.02;
// A line that moves farther between neighbouring frames belongs to two surfaces.
constexpr double same_surface_px = 4.0;
constexpr std::size_t min_pairs = 500;
constexpr double min_true_share = 0.2;  // share of the squared slopes that is not noise

// Line column over yaw, for one image row of one sweep.
struct Trace {
  std::vector<double> yaw_rad;  // rising
  std::vector<double> column_px;

  // Column and slope per radian at a yaw; NaN at gaps and edges.
  [[nodiscard]] Vector2 at(double yaw) const {
    Vector2 nothing = Vector2::Constant(std::nan(""));
    const auto above = std::upper_bound(yaw_rad.begin(), yaw_rad.end(), yaw);
    if (above == yaw_rad.begin() || above == yaw_rad.end()) return nothing;
    const auto i = static_cast<std::size_t>(above - yaw_rad.begin());
    const double gap = yaw_rad[i] - yaw_rad[i - 1];
    const double change = column_px[i] - column_px[i - 1];
    if (!(gap > 0.0) || gap > 1.0_deg || std::abs(change) > same_surface_px) return nothing;
    const double part = (yaw - yaw_rad[i - 1]) / gap;
    return {column_px[i - 1] + part * change, change / gap};
  }
};

std::vector<double> times_of(const Sweep& sweep) {
  std::vector<double> times_s;
  times_s.reserve(sweep.lines.size());
  for (const auto& line : sweep.lines) times_s.push_back(line.time_s);
  return times_s;
}

Result<std::vector<Trace>> traces_of(const Sweep& sweep, double latency_s) {
  const auto yaw = scanner::yaw_at(times_of(sweep), sweep.readings, latency_s);
  if (!yaw) return tl::unexpected(yaw.error());
  const bool rising = yaw->back() > yaw->front();
  std::vector<Trace> traces;
  for (std::size_t n = 0; n < sweep.lines.size(); ++n) {
    const std::size_t i = rising ? n : sweep.lines.size() - 1 - n;
    for (const auto& point : sweep.lines[i].line.points) {
      const auto row = static_cast<std::size_t>(point.row);
      if (traces.size() <= row) traces.resize(row + 1);
      traces[row].yaw_rad.push_back((*yaw)[i]);
      traces[row].column_px.push_back(static_cast<double>(point.column_px));
    }
  }
  return traces;
}

double turned_rad(const Sweep& sweep) {
  const auto yaw = scanner::yaw_at(times_of(sweep), sweep.readings, sweep.nominal.latency_s);
  return yaw && !yaw->empty() ? yaw->back() - yaw->front() : 0.0;
}

double duration_s(const Sweep& sweep) {
  return sweep.lines.back().time_s - sweep.lines.front().time_s;
}

// Correction of the latency from both sweeps, and their disagreement.
struct Step {
  double by_s = 0.0;
  double deviation_s = 0.0;
  double disagreement = 0.0;  ///< mean squared difference, clipped at one pixel
};

// The same image row at the same yaw in both sweeps.
struct Pair {
  double difference, slope;
  double slope2;  // product of both sweeps' slopes, free of noise bias
};

std::vector<Pair> pairs_of(const std::vector<Trace>& left, const std::vector<Trace>& right,
                           double apart_rad_per_s) {
  std::vector<Pair> pairs;
  for (std::size_t row = 0; row < std::min(left.size(), right.size()); ++row) {
    const Trace& a = left[row];
    const Trace& b = right[row];
    if (a.yaw_rad.size() < 2 || b.yaw_rad.size() < 2) continue;
    const double first_rad = std::max(a.yaw_rad.front(), b.yaw_rad.front());
    const double last_rad = std::min(a.yaw_rad.back(), b.yaw_rad.back());
    const int steps = static_cast<int>(std::ceil((last_rad - first_rad) / step_rad));
    for (int step = 0; step < steps; ++step) {
      const double yaw = first_rad + step * step_rad;
      const Vector2 seen_left = a.at(yaw);
      const Vector2 seen_right = b.at(yaw);
      const double difference = seen_right.x() - seen_left.x();
      if (!(std::abs(difference) < 3.0 * same_surface_px)) continue;
      pairs.push_back({difference, 0.5 * (seen_left.y() + seen_right.y()) * apart_rad_per_s,
                       seen_left.y() * seen_right.y() * apart_rad_per_s * apart_rad_per_s});
    }
  }
  return pairs;
}

struct DelayFit {
  double by_s = 0.0;
  double spread = 1.0;
  double information = 0.0;
  double true_information = 0.0;  // without the part that noise of the slopes adds
};

// Robust least squares (Tukey) of difference + slope * by = 0.
DelayFit fit(const std::vector<Pair>& pairs) {
  DelayFit fit;
  for (int i = 0; i < 12; ++i) {
    std::vector<double> sizes;
    sizes.reserve(pairs.size());
    for (const Pair& pair : pairs)
      sizes.push_back(std::abs(pair.difference + pair.slope * fit.by_s));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    fit.spread = std::max(1e-3, 1.4826 * *middle);
    fit.information = 0.0;
    fit.true_information = 0.0;
    double moment = 0.0;
    for (const Pair& pair : pairs) {
      const double size = (pair.difference + pair.slope * fit.by_s) / (4.7 * fit.spread);
      if (std::abs(size) >= 1.0) continue;
      const double weight = std::pow(1.0 - size * size, 2);
      fit.information += weight * pair.slope * pair.slope;
      fit.true_information += weight * pair.slope2;
      moment -= weight * pair.slope * pair.difference;
    }
    if (!(fit.information > 0.0)) break;
    fit.by_s = moment / fit.information;
  }
  return fit;
}

Result<Step> compare(const Sweep& falling, const Sweep& rising, double latency_s) {
  const auto left = traces_of(falling, latency_s);
  if (!left) return tl::unexpected(left.error());
  const auto right = traces_of(rising, latency_s);
  if (!right) return tl::unexpected(right.error());
  // yaw(t - latency): more latency moves each trace by minus its speed, so their difference changes
  // by the difference of the speeds.
  const double left_rad_per_s = turned_rad(falling) / duration_s(falling);
  const double right_rad_per_s = turned_rad(rising) / duration_s(rising);
  const std::vector<Pair> pairs = pairs_of(*left, *right, right_rad_per_s - left_rad_per_s);
  if (pairs.size() < min_pairs) {
    return fail(Fault::bad_input,
                "the two sweeps see the same surface in {} places, {} needed: sweep the same still "
                "scene both ways",
                pairs.size(), min_pairs);
  }
  const DelayFit found = fit(pairs);
  // Without slanted surfaces the slopes are noise, which is independent in both sweeps.
  if (!(found.true_information > min_true_share * found.information) ||
      !(found.information > 0.0)) {
    return fail(Fault::bad_input,
                "the scene of the sweeps is too flat to tell the latency: sweep a scene with "
                "slanted surfaces, such as boxes standing askew");
  }
  double disagreement = 0.0;
  for (const Pair& pair : pairs) disagreement += std::min(1.0, pair.difference * pair.difference);
  // Neighbouring samples share frames: about one in three is independent.
  return Step{
      .by_s = found.by_s,
      .deviation_s = found.spread * std::sqrt(3.0 * found.information) / found.true_information,
      .disagreement = disagreement / static_cast<double>(pairs.size())};
}

// Coarse grid search of the latency.
double first_latency_s(const Sweep& falling, const Sweep& rising) {
  double best_s = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int k = -10; k <= 10; ++k) {
    const double latency_s = 0.04 * k;
    // Latencies at which readings do not cover the frames are skipped.
    const auto step = compare(falling, rising, latency_s);
    if (!step || step->disagreement >= least) continue;
    least = step->disagreement;
    best_s = latency_s;
  }
  return best_s;
}

}  // namespace

Result<Sweep> read_sweep(const std::filesystem::path& folder, const scanner::CameraModel& camera,
                         const Progress& progress) {
  auto recording = scanner::Recording::open(folder);
  if (!recording) return tl::unexpected(recording.error());
  Sweep sweep;
  sweep.nominal = recording->calibration();
  const auto readings = recording->readings();
  if (!readings) return tl::unexpected(readings.error());
  sweep.readings = *readings;
  for (int i = 0; i < recording->frames(); ++i) {
    const auto frame = recording->next_frame(scanner::frame_timeout_s);
    if (!frame) return tl::unexpected(frame.error());
    for (const Image* picture : {&frame->image, &frame->dark}) {
      const bool fits = picture->width == camera.width_px && picture->height == camera.height_px;
      if (fits || picture->data.empty()) continue;
      return fail(
          Fault::bad_input,
          "{}: picture {} has {} x {} pixels, those of the board have {} x {}; all come from "
          "one camera",
          folder.string(), i, picture->width, picture->height, camera.width_px, camera.height_px);
    }
    sweep.lines.push_back(
        {frame->time_s, scanner::find_laser_line(
                            frame->image, {.method = scanner::LineMethod::likelihood},
                            frame->dark.data.empty() ? ImageView() : ImageView(frame->dark))});
    if (progress) progress(static_cast<double>(i + 1) / recording->frames());
  }
  return sweep;
}

Result<Latency> find_latency(const Sweep& falling, const Sweep& rising) {
  const double left_rad = turned_rad(falling);
  const double right_rad = turned_rad(rising);
  if (!(left_rad < -min_swing_rad && right_rad > min_swing_rad)) {
    return fail(Fault::bad_input,
                "the yaw of sweep_left must fall and that of sweep_right rise, by {:.0f} deg at "
                "least; it changes by {:.1f} and {:.1f} deg",
                to_deg(min_swing_rad), to_deg(left_rad), to_deg(right_rad));
  }
  Latency latency{.latency_s = first_latency_s(falling, rising)};
  for (int i = 0; i < 10; ++i) {
    const auto step = compare(falling, rising, latency.latency_s);
    if (!step) return tl::unexpected(step.error());
    latency.latency_s += step->by_s;
    latency.deviation_s = step->deviation_s;
    if (std::abs(latency.latency_s) > max_s) {
      return fail(Fault::bad_input,
                  "the two sweeps do not agree at any latency up to {:.0f} s: did the scene move, "
                  "or do the clocks of camera and motor differ between them?",
                  max_s);
    }
    if (std::abs(step->by_s) < 1e-5) break;
  }
  // Readings are rounded to counts: the mean of n is known to count / sqrt(12 n).
  const auto rounding_s = [](const Sweep& sweep, double rad) {
    const double rad_per_s = std::abs(rad) / duration_s(sweep);
    return count_rad / std::sqrt(12.0 * static_cast<double>(sweep.readings.size())) / rad_per_s;
  };
  const double clocks_s =
      0.5 * std::hypot(rounding_s(falling, left_rad), rounding_s(rising, right_rad));
  latency.deviation_s = std::hypot(latency.deviation_s, clocks_s);
  if (latency.deviation_s > unsure_s) {
    return fail(Fault::bad_input,
                "the latency is known to {:.0f} ms only, {:.0f} needed: sweep a scene with more "
                "slanted surfaces, such as boxes standing askew",
                1e3 * latency.deviation_s, 1e3 * unsure_s);
  }
  return latency;
}

}  // namespace tuina::calibration
