// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/faulty_scanner.hpp"

#include <algorithm>
#include <utility>

namespace tuina::sim {
namespace {

constexpr std::uint8_t grey = 128;

std::uint8_t brighter(std::uint8_t pixel, double by_dn) {
  return static_cast<std::uint8_t>(std::min(255.0, pixel + by_dn));
}

/// Mean over so many pixels of a row.
void blur(Image& image, int over_px) {
  const Image sharp = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int first = std::max(x - over_px / 2, 0);
      const int last = std::min(x + over_px / 2, image.width - 1);
      int sum = 0;
      for (int k = first; k <= last; ++k) sum += sharp.row(y)[k * image.channels];
      for (int c = 0; c < image.channels; ++c)
        image.row(y)[x * image.channels + c] = static_cast<std::uint8_t>(sum / (last - first + 1));
    }
  }
}

/// The brighter of a picture and the same picture so many pixels aside.
void reflect(Image& image, int aside_px) {
  const int samples = image.width * image.channels, aside = aside_px * image.channels;
  for (int y = 0; y < image.height; ++y) {
    for (int x = samples - 1; x >= aside; --x)
      image.row(y)[x] = std::max(image.row(y)[x], image.row(y)[x - aside]);
  }
}

void fill_rows(Image& image, int from, int to, std::uint8_t value) {
  for (int y = std::max(0, from); y < std::min(image.height, to); ++y)
    std::fill_n(image.row(y), image.width * image.channels, value);
}

}  // namespace

Result<scanner::Frame> FaultyScanner::next_frame(double timeout_s) {
  if (held_) return *std::exchange(held_, std::nullopt);
  auto frame = camera_.next_frame(timeout_s);
  if (!frame) return frame;
  if (!first_s_) first_s_ = frame->time_s;
  now_s_ = frame->time_s - *first_s_;
  if (acts() && lit_) lit_after_onset_s_ = now_s_ - fault_.onset_s;
  if (!acts()) return frame;
  if (fault_.kind == ScanFault::camera_silent) {
    lit_after_onset_s_ += timeout_s;
    return fail(Fault::device, "no frame within {:.1f} s", timeout_s);
  }
  const auto over = turntable_.arrived();
  const bool last = over && *over;
  if (fault_.kind == ScanFault::frames_lost && !last && uniform(random_, 0.0, 1.0) < fault_.size)
    return next_frame(timeout_s);
  if (fault_.kind == ScanFault::frames_swapped && !last) {
    auto later = camera_.next_frame(timeout_s);
    if (!later) return later;
    held_ = std::move(*frame);
    return later;
  }
  spoil(frame->image);
  return frame;
}

void FaultyScanner::spoil(Image& image) {
  const int size_px = static_cast<int>(fault_.size);
  switch (fault_.kind) {
    case ScanFault::frames_frozen:
      if (!acts_for_size()) return;
      if (frozen_.data.empty()) frozen_ = image;
      image = frozen_;
      return;
    case ScanFault::frames_cut:
      if (acts_for_size()) fill_rows(image, image.height / 2, image.height, grey);
      return;
    case ScanFault::blurred:
      return blur(image, size_px);
    case ScanFault::lamp:
      for (int y = image.height / 4; y < image.height / 2; ++y) {
        for (int x = 0; x < image.width * image.channels; ++x)
          image.row(y)[x] = brighter(image.row(y)[x], fault_.size);
      }
      return;
    case ScanFault::second_line:
      return reflect(image, size_px);
    case ScanFault::covered: {
      const int half = static_cast<int>(0.5 * fault_.size * image.height);
      return fill_rows(image, image.height / 2 - half, image.height / 2 + half, 0);
    }
    default:
      return;
  }
}

Result<void> FaultyScanner::sweep(double from_rad, double to_rad, double rad_per_s) {
  first_s_.reset();
  return turntable_.sweep(from_rad, to_rad, rad_per_s);
}

Result<void> FaultyScanner::step(double from_rad, double to_rad, double step_rad) {
  first_s_.reset();
  return turntable_.step(from_rad, to_rad, step_rad);
}

Result<bool> FaultyScanner::arrived() const {
  if (acts() && fault_.kind == ScanFault::motor_silent)
    return fail(Fault::device, "the motor does not answer");
  if (held_) return false;
  return turntable_.arrived();
}

Result<void> FaultyScanner::switch_laser(bool on) {
  lit_ = on;
  return turntable_.switch_laser(on);
}

Result<std::vector<scanner::YawReading>> FaultyScanner::readings() const {
  auto readings = turntable_.readings();
  if (!readings || !acts() || readings->empty()) return readings;
  const double begin_s = readings->front().time_s + fault_.onset_s;
  std::optional<double> stuck_rad;
  for (scanner::YawReading& one : *readings) {
    if (one.time_s < begin_s) continue;
    if (fault_.kind == ScanFault::yaw_skips) one.yaw_rad += fault_.size;
    if (fault_.kind != ScanFault::yaw_stuck || one.time_s >= begin_s + fault_.size) continue;
    if (!stuck_rad) stuck_rad = one.yaw_rad;
    one.yaw_rad = *stuck_rad;
  }
  return readings;
}

}  // namespace tuina::sim
