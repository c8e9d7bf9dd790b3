// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/stickers/sticker_watch.hpp"

#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/scanner/line/colours.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::scanner {
namespace {

// Frames of a usual sweep are 4 mm apart at 1.1 m; points of one sticker are nearer than three of
// those.
constexpr double together_m = 12_mm;
constexpr int enough_dots = 3;

struct PlacedDot {
  StickerColour colour;
  Vector3 at_in_couch;
};

/// Takes the cluster around the first remaining point.
std::vector<std::size_t> take_group(const std::vector<PlacedDot>& dots, std::size_t first,
                                    std::vector<bool>& taken) {
  std::vector<std::size_t> group = {first};
  taken[first] = true;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const PlacedDot& from = dots[group[k]];
    for (std::size_t j = 0; j < dots.size(); ++j) {
      if (taken[j] || dots[j].colour != from.colour) continue;
      if ((dots[j].at_in_couch - from.at_in_couch).norm() > together_m) continue;
      taken[j] = true;
      group.push_back(j);
    }
  }
  return group;
}

}  // namespace

StickerWatch::StickerWatch(Camera& camera, const ScannerCalibration& calibration, double near_m,
                           double far_m)
    : camera_(&camera), calibration_(calibration) {
  const auto [first, last] = columns_between(calibration, near_m, far_m);
  line_options_ = {.method = LineMethod::likelihood, .first_column = first, .last_column = last};
}

Result<Frame> StickerWatch::next_frame(double timeout_s) {
  auto frame = camera_->next_frame(timeout_s);
  if (!frame) return frame;
  if (frame->image.channels != 3) {
    return fail(Fault::bad_input,
                "frame {} is grey, and only a colour frame tells a sticker from skin; record with "
                "a colour camera and the light of the room on",
                times_s_.size());
  }
  times_s_.push_back(frame->time_s);
  const Image dark = red_of(frame->dark);
  const LaserLine line = find_laser_line(red_of(frame->image), line_options_,
                                         dark.data.empty() ? ImageView() : ImageView(dark));
  dots_.push_back(find_label_dots(frame->image, line));
  return frame;
}

Result<std::vector<Sticker>> StickerWatch::stickers(std::span<const YawReading> readings) const {
  const auto yaw = yaw_at(times_s_, readings, calibration_.latency_s);
  if (!yaw) return tl::unexpected(yaw.error());
  std::vector<PlacedDot> dots;
  for (std::size_t i = 0; i < dots_.size(); ++i) {
    const Transform couch_from_camera = calibration_.couch_from_camera_at((*yaw)[i]);
    for (const LabelDot& dot : dots_[i]) {
      const auto point = triangulate(calibration_, dot.column_px, dot.row);
      if (point) dots.push_back({dot.colour, couch_from_camera * *point});
    }
  }
  std::vector<Sticker> found;
  std::vector<bool> taken(dots.size(), false);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    if (taken[i]) continue;
    const auto group = take_group(dots, i, taken);
    if (static_cast<int>(group.size()) < enough_dots) continue;
    Sticker sticker{.colour = dots[i].colour, .dots = static_cast<int>(group.size())};
    const auto count = static_cast<double>(group.size());
    for (const std::size_t k : group) sticker.at_in_couch += dots[k].at_in_couch / count;
    for (const std::size_t k : group) {
      sticker.spread_m += (dots[k].at_in_couch - sticker.at_in_couch).squaredNorm() / count;
    }
    sticker.spread_m = std::sqrt(sticker.spread_m);
    found.push_back(sticker);
  }
  return found;
}

}  // namespace tuina::scanner
