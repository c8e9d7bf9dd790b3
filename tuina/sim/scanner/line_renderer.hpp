// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/ray_scene.hpp"

namespace tuina::sim {

/// How a picture comes about that is read row by row; a moment is that of the middle row.
struct Readout {
  double yaw_per_row_rad = 0.0;
  double lamp_rad = 0.0, lamp_per_row_rad = 0.0;  ///< phase of the lamps' flicker
};

/// Renders the picture of the scanner's camera at one moment. Thread-safe.
class LineRenderer {
 public:
  /// `truth` is what the scanner is like; the seed draws hair, moles and noise.
  LineRenderer(const Mesh& skin_in_couch, const Mesh& couch,
               const scanner::ScannerCalibration& truth, const LaserScannerOptions& options,
               std::uint64_t seed);

  /// `skin_shift_in_couch`: displacement by breathing. Equal `frame`, equal noise. `visible`, if
  /// given, receives the rows with a line.
  [[nodiscard]] Image render(double yaw_rad, const Vector3& skin_shift_in_couch,
                             std::uint64_t frame, std::vector<bool>* visible = nullptr,
                             const RoomPicture& room = {}, const Readout& readout = {}) const;
  /// The same moment with the laser off, with its own noise.
  [[nodiscard]] Image render_dark(std::uint64_t frame, const RoomPicture& room = {},
                                  const Readout& readout = {}) const;
  /// Room-light picture of that moment, input of the two functions above, which then render colour.
  /// Empty without stickers.
  [[nodiscard]] RoomPicture room(double yaw_rad, const Vector3& skin_shift_in_couch) const;

 private:
  // A piece of the line in one image row.
  struct Stroke {
    float column_px;
    float amplitude_dn;
    float width_px;
  };
  using Strokes = std::vector<std::vector<Stroke>>;

  // Intersection of a ray of the laser's fan with a surface, if the camera sees it.
  struct Spot {
    bool visible = false;
    Vector3 point = Vector3::Zero();
    Vector2 pixel = Vector2::Zero();
    double light = 0.0;      ///< per length on the image, before spreading along the line
    double spread_px = 0.0;  ///< by light inside the skin
  };

  [[nodiscard]] Spot trace(const Vector3& laser, const Vector3& direction, const Vector3& eye,
                           const Transform& camera_from_couch, const Vector3& shift) const;
  /// One thin sheet of light.
  struct Sheet {
    double yaw_rad, yaw_per_row_rad;
    Vector3 shift_in_couch;
    double aside_m, share;
  };
  void draw_sheet(const Sheet& sheet, Strokes& strokes) const;
  [[nodiscard]] Image expose(const Strokes& strokes, const RoomPicture& room,
                             const Readout& readout, std::uint64_t state) const;
  /// In colour, over the room-light picture.
  [[nodiscard]] Image expose_colour(const Strokes& strokes, const RoomPicture& room,
                                    std::uint64_t state) const;
  void add_line(const std::vector<Stroke>& strokes, float share, std::vector<float>& light) const;
  void add_noise(const std::vector<float>& light, std::uint64_t& state, std::uint8_t* pixels,
                 int stride) const;
  void displace(Strokes& strokes, std::uint64_t state) const;
  void join(const Spot& a, const Spot& b, double share, Strokes& strokes) const;

  RayScene skin_;
  RayScene couch_;
  scanner::ScannerCalibration truth_;
  LaserScannerOptions options_;
  std::optional<RoomLight> room_light_;  // set with stickers: frames in colour
  std::uint64_t seed_;
  double light_at_reference_;
  double spot_width_px_;
  std::vector<float> noise_;
  std::vector<float> speckle_;  // line displacement from row to row; empty: none
};

}  // namespace tuina::sim
