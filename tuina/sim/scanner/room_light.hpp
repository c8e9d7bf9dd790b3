// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/stickers/label_dots.hpp"
#include "tuina/sim/scanner/ray_scene.hpp"

namespace tuina::sim {

/// A round coloured sticker on the skin.
struct SkinSticker {
  Vector3 at_in_couch = Vector3::Zero();
  scanner::StickerColour colour = scanner::StickerColour::blue;
  double radius_m = 12.5e-3;
};

/// Red, green and blue of every pixel, row by row, without noise.
using Rgb = std::array<float, 3>;
/// Such pixels of a whole picture.
using RoomPicture = std::vector<Rgb>;

/// Picture of skin, stickers and couch (matt) by a colour camera in room light. A colour sensor has
/// each colour at every second pixel only, so rays are cast at every second row and column.
class RoomLight {
 public:
  /// `white_dn`: level of a white wall facing the camera.
  RoomLight(std::vector<SkinSticker> stickers, double white_dn);

  /// The picture of that camera; `skin_shift_in_couch` is displacement by breathing.
  [[nodiscard]] RoomPicture render(const RayScene& skin, const RayScene& couch,
                                   const scanner::CameraModel& camera,
                                   const Transform& couch_from_camera,
                                   const Vector3& skin_shift_in_couch) const;

  /// Reflectance of the sticker at this place for the red laser, relative to bare fair skin;
  /// nothing where there is no sticker.
  [[nodiscard]] std::optional<double> sticker_laser_share(const Vector3& on_skin_in_couch) const;

 private:
  [[nodiscard]] const SkinSticker* sticker_at(const Vector3& on_skin_in_couch) const;
  [[nodiscard]] Rgb albedo(const Vector3& on_skin_in_couch) const;

  std::vector<SkinSticker> stickers_;
  double white_dn_;
};

}  // namespace tuina::sim
