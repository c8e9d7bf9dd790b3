// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/stickers/label_dots.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::scanner {

/// A coloured sticker on the skin: mean of its laser points in space.
struct Sticker {
  StickerColour colour = StickerColour::blue;
  Vector3 at_in_couch = Vector3::Zero();
  int dots = 0;
  double spread_m = 0.0;  ///< RMS distance of the points from their mean
};

/// Passes a camera through and records where the laser crosses stickers, so that one sweep gives
/// cloud and stickers. Fails on grey frames.
class StickerWatch final : public Camera {
 public:
  /// The camera must outlive it; stickers are looked for between these depths.
  StickerWatch(Camera& camera, const ScannerCalibration& calibration, double near_m, double far_m);

  [[nodiscard]] Result<Frame> next_frame(double timeout_s) override;

  /// Clusters the points of the sweep; small clusters are dropped. Fails when the readings do not
  /// cover the frames.
  [[nodiscard]] Result<std::vector<Sticker>> stickers(std::span<const YawReading> readings) const;

 private:
  Camera* camera_;
  ScannerCalibration calibration_;
  LineOptions line_options_;
  std::vector<double> times_s_;
  std::vector<std::vector<LabelDot>> dots_;  ///< points of each frame
};

}  // namespace tuina::scanner
