// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/room_light.hpp"

#include <algorithm>
#include <utility>

#include "tuina/core/grid.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::sim {
namespace {

constexpr Rgb skin_albedo = {0.72F, 0.53F, 0.43F};
constexpr Rgb couch_albedo = {0.30F, 0.30F, 0.32F};
constexpr Rgb room_albedo = {0.06F, 0.06F, 0.06F};  // far and dark surroundings
constexpr double from_all_sides = 0.6;  // share of diffuse light; the rest comes from the camera

constexpr Rgb albedo_of(scanner::StickerColour colour) {
  switch (colour) {
    case scanner::StickerColour::yellow:
      return {0.80F, 0.70F, 0.12F};
    case scanner::StickerColour::green:
      return {0.15F, 0.55F, 0.22F};
    case scanner::StickerColour::blue:
      return {0.12F, 0.28F, 0.65F};
    default:
      return {0.70F, 0.14F, 0.50F};
  }
}

}  // namespace

RoomLight::RoomLight(std::vector<SkinSticker> stickers, double white_dn)
    : stickers_(std::move(stickers)), white_dn_(white_dn) {}

const SkinSticker* RoomLight::sticker_at(const Vector3& on_skin_in_couch) const {
  for (const SkinSticker& sticker : stickers_) {
    if ((on_skin_in_couch - sticker.at_in_couch).squaredNorm() <
        sticker.radius_m * sticker.radius_m) {
      return &sticker;
    }
  }
  return nullptr;
}

Rgb RoomLight::albedo(const Vector3& on_skin_in_couch) const {
  const SkinSticker* sticker = sticker_at(on_skin_in_couch);
  return sticker ? albedo_of(sticker->colour) : skin_albedo;
}

std::optional<double> RoomLight::sticker_laser_share(const Vector3& on_skin_in_couch) const {
  const SkinSticker* sticker = sticker_at(on_skin_in_couch);
  if (!sticker) return {};
  return static_cast<double>(albedo_of(sticker->colour)[0] / skin_albedo[0]);
}

RoomPicture RoomLight::render(const RayScene& skin, const RayScene& couch,
                              const scanner::CameraModel& camera,
                              const Transform& couch_from_camera,
                              const Vector3& skin_shift_in_couch) const {
  const Vector3 eye = couch_from_camera.translation();
  const auto seen = [&](int column, int row) {
    const Vector3 direction =
        (couch_from_camera.linear() * scanner::ray_through(camera, column, row)).normalized();
    const auto on_skin = skin.first_hit(eye - skin_shift_in_couch, direction);
    const auto on_couch = couch.first_hit(eye, direction);
    Rgb colour = room_albedo;
    double facing = 1.0;
    if (on_skin && (!on_couch || on_skin->distance_m < on_couch->distance_m)) {
      colour = albedo(eye - skin_shift_in_couch + on_skin->distance_m * direction);
      facing = std::abs(on_skin->normal.dot(direction));
    } else if (on_couch) {
      colour = couch_albedo;
      facing = std::abs(on_couch->normal.dot(direction));
    }
    const double light = white_dn_ * (from_all_sides + (1.0 - from_all_sides) * facing);
    for (float& channel : colour) channel *= static_cast<float>(light);
    return colour;
  };
  const int columns = camera.width_px / 2 + 1;
  const int rows = camera.height_px / 2 + 1;
  RoomPicture coarse;
  coarse.reserve(grid_cells(rows, columns));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) coarse.push_back(seen(2 * column, 2 * row));
  }
  const auto at = [&](int column, int row) -> const Rgb& {
    return coarse[grid_index(row, columns, column)];
  };
  RoomPicture picture(grid_cells(camera.height_px, camera.width_px));
  for (int row = 0; row < camera.height_px; ++row) {
    for (int column = 0; column < camera.width_px; ++column) {
      Rgb& pixel = picture[grid_index(row, camera.width_px, column)];
      for (std::size_t k = 0; k < 3; ++k) {
        pixel[k] =
            0.25F * (at(column / 2, row / 2)[k] + at((column + 1) / 2, row / 2)[k] +
                     at(column / 2, (row + 1) / 2)[k] + at((column + 1) / 2, (row + 1) / 2)[k]);
      }
    }
  }
  return picture;
}

}  // namespace tuina::sim
