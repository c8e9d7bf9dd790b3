// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// The focal length of a camera that is not calibrated yet, from the boards that it has seen:
/// square pixels, the axis through the middle of the picture [zhang2000, section 3.1]. A lens of
/// the usual width until a tilted board was seen; then good to a tenth.
class FocalGuess {
 public:
  FocalGuess(int width_px, int height_px);
  /// Learns from one more board.
  void see(const SeenBoard& seen, const Board& board);
  [[nodiscard]] double focal_px() const;
  /// Middle of the picture.
  [[nodiscard]] const Vector2& middle_px() const { return middle_px_; }

 private:
  Vector2 middle_px_;
  double usual_px_;
  double slopes_, values_;  ///< sums of the normal equation for (usual / focal) squared
};

/// What a picture tells of a board that somebody holds, before the camera is calibrated.
struct HeldBoard {
  double distance_m = 0.0;
  /// Tilt of the board against the picture, and where its far side is: the angle from right, over
  /// down, in the picture.
  double tilt_rad = 0.0, far_side_rad = 0.0;
  double blur_px = 0.0;      ///< width of an edge between two squares, median over the corners
  double contrast_dn = 0.0;  ///< of white and black squares, median
};

/// Looks at the board where it was found.
[[nodiscard]] HeldBoard look_at_board(const SeenBoard& seen, ImageView image, const Board& board,
                                      const FocalGuess& camera);

/// Root mean square of how far the corners that both pictures show lie apart, in pixels; infinite
/// where they share none.
[[nodiscard]] double moved_px(const SeenBoard& one, const SeenBoard& other);

/// The poses of a good set: a board at three distances, its far side to the left, to the right, up
/// and down, each of them equally often.
class WantedPoses {
 public:
  static constexpr int kinds = 12;
  /// `poses`: how many in all, a multiple of `kinds`.
  explicit WantedPoses(int poses) : of_each_(poses / kinds) {}

  /// Why this board adds nothing; empty where it is wanted.
  [[nodiscard]] std::string judge(const HeldBoard& board) const;
  /// Counts a board that was judged as wanted and photographed.
  void keep(const HeldBoard& board);
  [[nodiscard]] int kept() const;
  [[nodiscard]] bool complete() const { return kept() == kinds * of_each_; }
  /// What to do next, for who holds the board; empty when all is there.
  [[nodiscard]] std::string next() const;

 private:
  int of_each_;
  std::array<int, kinds> kept_ = {};
};

}  // namespace tuina::calibration
