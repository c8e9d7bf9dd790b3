// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/scan_watch.hpp"

#include <algorithm>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::scanner {

ScanWatch::ScanWatch(double rad_per_s, double latency_s)
    : patience_s_(std::max(max_blind_s, 3.0 * yaw_count_rad / rad_per_s)), latency_s_(latency_s) {}

Result<void> ScanWatch::see(double frame_s, bool new_picture,
                            std::span<const YawReading> readings) {
  if (!first_s_) first_s_ = frame_s;
  if (new_picture || frame_s == *first_s_) new_picture_s_ = frame_s;
  if (frame_s - new_picture_s_ > max_blind_s) {
    return fail(Fault::device, "the camera has given the same picture for {:.2f} s: it hangs",
                frame_s - new_picture_s_);
  }
  if (frame_s - *first_s_ < patience_s_) return {};
  const double to_s = frame_s - latency_s_;
  const double from_s = to_s - patience_s_;
  double low_rad = std::numeric_limits<double>::infinity();
  double high_rad = -low_rad;
  // The newest are at the end; a simulated motor has told its future.
  for (auto reading = readings.rbegin(); reading != readings.rend(); ++reading) {
    if (reading->time_s > to_s) continue;
    if (reading->time_s < from_s) break;
    low_rad = std::min(low_rad, reading->yaw_rad);
    high_rad = std::max(high_rad, reading->yaw_rad);
  }
  if (low_rad > high_rad)
    return fail(Fault::device, "the motor has told no angle for {:.2f} s", patience_s_);
  // A standing motor may flicker between two counts.
  if (high_rad - low_rad > 1.5 * yaw_count_rad) return {};
  return fail(Fault::device,
              "the motor stands still at {:.1f} degrees, for {:.2f} s within the turn: it is "
              "stalled",
              to_deg(low_rad), patience_s_);
}

}  // namespace tuina::scanner
