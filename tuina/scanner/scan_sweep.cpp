// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::scanner {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// The laser is red: a colour picture becomes its first channel.
void keep_red(Image& image) {
  if (image.channels == 1) return;
  Image red(image.width, image.height);
  const auto channels = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i < red.data.size(); ++i) red.data[i] = image.data[i * channels];
  image = std::move(red);
}

Result<void> check_size(const Image& image, const CameraModel& camera, const char* what) {
  if (image.width == camera.width_px && image.height == camera.height_px) return {};
  return fail(Fault::bad_input,
              "a {} of {} x {} pixels does not belong to a calibration for {} x {}", what,
              image.width, image.height, camera.width_px, camera.height_px);
}

}  // namespace

Result<Scan> scan_sweep(Camera& camera, Turntable& turntable, const ScannerCalibration& calibration,
                        const SweepOptions& options, const Progress& progress) {
  const auto started = turntable.sweep(options.from_rad, options.to_rad, options.speed_rad_per_s);
  if (!started) return tl::unexpected(started.error());

  const auto [first_column, last_column] =
      columns_between(calibration, options.near_m, options.far_m);
  const LineOptions line_options{
      .method = options.method, .first_column = first_column, .last_column = last_column};
  const double frames =
      options.expected_frames > 0
          ? options.expected_frames
          : 30.0 * std::abs(options.to_rad - options.from_rad) / options.speed_rad_per_s;
  std::vector<TimedLine> lines;
  Image before;
  int repeated = 0;
  double compute_ms = 0.0;
  for (;;) {
    auto frame = camera.next_frame();
    if (!frame && frame.error().fault == Fault::not_found) break;
    if (!frame) return tl::unexpected(frame.error());
    const auto start = Clock::now();
    if (const auto good = check_size(frame->image, calibration.camera, "frame"); !good) {
      return tl::unexpected(good.error());
    }
    const bool has_dark = !frame->dark.data.empty();
    if (has_dark) {
      if (const auto good = check_size(frame->dark, calibration.camera, "dark frame"); !good) {
        return tl::unexpected(good.error());
      }
    }
    keep_red(frame->image);
    keep_red(frame->dark);
    lines.push_back(
        {frame->time_s, find_laser_line(frame->image, line_options,
                                        has_dark ? ImageView(frame->dark) : ImageView())});
    // Sensor noise makes every picture a new one; the same picture twice is a camera that hangs.
    if (!lines.back().line.points.empty() && frame->image.data == before.data) ++repeated;
    before = std::move(frame->image);
    compute_ms += ms_since(start);
    if (progress) progress(std::min(0.99, static_cast<double>(lines.size()) / frames));
  }
  if (lines.empty()) return fail(Fault::not_found, "the camera gave no frame");
  if (20 * repeated > static_cast<int>(lines.size())) {
    return fail(Fault::bad_input,
                "{} of {} frames repeat the one before bit for bit: the camera hangs", repeated,
                lines.size());
  }
  const auto readings = turntable.readings();
  if (!readings) return tl::unexpected(readings.error());

  const auto start = Clock::now();
  auto scan = make_cloud(lines, *readings, calibration);
  if (!scan) return tl::unexpected(scan.error());
  scan->compute_ms = compute_ms + ms_since(start);
  if (progress) progress(1.0);
  return scan;
}

}  // namespace tuina::scanner
