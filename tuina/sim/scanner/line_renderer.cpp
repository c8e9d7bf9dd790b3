// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/line_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::sim {
namespace {

constexpr double amplitude_at_m = 1.1;  // where LaserScannerOptions::amplitude_dn holds
constexpr double fan_half_rad = 20.0_deg;
constexpr int fan_rays = 1601;  // more than two for each of 640 rows
constexpr double fan_step_rad = 2.0 * fan_half_rad / (fan_rays - 1);
constexpr double sheet_deviation_m = 0.7_mm;  // half the 1/e^2 width of a cheap line laser at 1 m
// A Gaussian sheet as three thin ones (Gauss-Hermite), since a depth edge cuts off a part of the
// light.
constexpr std::array<double, 3> sheet_aside = {-1.7320508, 0.0, 1.7320508};
constexpr std::array<double, 3> sheet_share = {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};
constexpr std::size_t noise_samples = std::size_t{1} << 19;
constexpr float leak = 0.04F;
constexpr std::size_t speckle_rows = std::size_t{1} << 16;

// Light per pixel of line of one fan ray on a Lambertian surface: proportional to the viewing
// cosine over the squared distance.
double light_of(double cosine_to_eye, double distance_to_eye_m) {
  return cosine_to_eye / (distance_to_eye_m * distance_to_eye_m);
}

// SplitMix64, one per frame, selects places in the noise table.
std::uint64_t next(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace

LineRenderer::LineRenderer(const Mesh& skin_in_couch, const Mesh& couch,
                           const scanner::ScannerCalibration& truth,
                           const LaserScannerOptions& options, std::uint64_t seed)
    : skin_(skin_in_couch), couch_(couch), truth_(truth), options_(options), seed_(seed) {
  if (!options_.stickers.empty()) room_light_.emplace(options_.stickers, options_.room_white_dn);
  // Reference: a white wall facing the camera gives the amplitude of the options.
  const Vector3& normal = truth_.laser_normal_in_camera;
  const double slant = amplitude_at_m / std::abs(normal.x());  // distance along the leaning laser
  const double pixels_per_ray = truth_.camera.fy_px * slant * fan_step_rad / amplitude_at_m;
  light_at_reference_ = light_of(1.0, amplitude_at_m) / pixels_per_ray;
  const double sheet_px =
      truth_.camera.fx_px * sheet_deviation_m / std::abs(normal.x()) / amplitude_at_m;
  spot_width_px_ =
      std::sqrt(std::max(0.25, options_.width_px * options_.width_px - sheet_px * sheet_px));

  // Half a million draws made once; each row of each frame reads from another place.
  Random random = make_random(seed, "camera noise");
  noise_.reserve(noise_samples);
  for (std::size_t i = 0; i < noise_samples; ++i) {
    noise_.push_back(static_cast<float>(gaussian(random, options_.noise_dn)));
  }
  if (options_.speckle_px <= 0.0) return;
  // Grains of about three rows: Gaussian draws smoothed with 1, 2, 1.
  Random grains = make_random(seed, "speckle");
  double before[2] = {gaussian(grains, 1.0), gaussian(grains, 1.0)};
  for (std::size_t i = 0; i < speckle_rows; ++i) {
    const double next_one = gaussian(grains, 1.0);
    const double sum = before[0] + 2.0 * before[1] + next_one;
    speckle_.push_back(static_cast<float>(options_.speckle_px * sum / std::sqrt(6.0)));
    before[0] = before[1];
    before[1] = next_one;
  }
}

void LineRenderer::displace(Strokes& strokes, std::uint64_t state) const {
  if (speckle_.empty()) return;
  const float* by_px = speckle_.data() + next(state) % (speckle_.size() - strokes.size());
  for (auto& row : strokes) {
    for (Stroke& stroke : row) stroke.column_px += *by_px;
    ++by_px;
  }
}

LineRenderer::Spot LineRenderer::trace(const Vector3& laser, const Vector3& direction,
                                       const Vector3& eye, const Transform& camera_from_couch,
                                       const Vector3& shift) const {
  // The person moves with the breath; the rays are moved the other way instead.
  auto hit = skin_.first_hit(laser - shift, direction);
  const auto on_couch = couch_.first_hit(laser, direction);
  const bool on_skin = hit && (!on_couch || hit->distance_m <= on_couch->distance_m);
  if (!on_skin) hit = on_couch;
  if (!hit || hit->normal.dot(direction) >= 0.0) return {};
  Spot spot;
  spot.point = laser + hit->distance_m * direction;
  LeftSkin left;
  const auto sticker_share =
      room_light_ && on_skin ? room_light_->sticker_laser_share(spot.point - shift) : std::nullopt;
  // A sticker sends back what falls on it before it enters the skin.
  if (sticker_share) {
    left.share = *sticker_share;
  } else if (on_skin && options_.flaws.of_skin()) {
    left = leave_skin(options_.flaws, spot.point - shift, direction, hit->normal, seed_);
    spot.point += left.by;
  }
  const Vector3 to_eye = eye - spot.point;
  const double distance_m = to_eye.norm();
  const double cosine = hit->normal.dot(to_eye) / distance_m;
  if (cosine < 0.02) return {};
  const Vector3 off = spot.point + 1e-4 * hit->normal;
  if (skin_.blocks(off - shift, eye - shift) || couch_.blocks(off, eye)) return {};
  const Vector3 point_in_camera = camera_from_couch * spot.point;
  if (point_in_camera.z() < 0.05) return {};
  spot.pixel = scanner::project(truth_.camera, point_in_camera);
  spot.light = left.share * light_of(cosine, distance_m);
  spot.spread_px = truth_.camera.fx_px * left.spread_m / point_in_camera.z();
  spot.visible = true;
  return spot;
}

void LineRenderer::join(const Spot& a, const Spot& b, double share, Strokes& strokes) const {
  if (!a.visible || !b.visible) return;
  // Adjacent rays that land far apart have hit two surfaces, with a depth edge between.
  constexpr double steepest = 10.0;
  const double apart_m = (a.point - b.point).norm();
  if (apart_m > steepest * 3.0 * fan_step_rad) return;
  const Vector2 step = b.pixel - a.pixel;
  const double length_px = step.norm();
  if (length_px < 1e-6 || std::abs(step.y()) < 1e-6) return;
  const double light = 0.5 * (a.light + b.light) / length_px / light_at_reference_;
  // A line oblique to the rows is wider along each of them.
  const double askew = std::min(4.0, length_px / std::abs(step.y()));
  const double width_px = std::hypot(spot_width_px_, 0.5 * (a.spread_px + b.spread_px));
  const double narrowing = options_.width_px / width_px;  // the same light in another width
  const int first = std::max(0, static_cast<int>(std::ceil(std::min(a.pixel.y(), b.pixel.y()))));
  const double end = std::max(a.pixel.y(), b.pixel.y());
  for (int row = first; row < end && row < truth_.camera.height_px; ++row) {
    const double part = (row - a.pixel.y()) / step.y();
    strokes[static_cast<std::size_t>(row)].push_back(
        {static_cast<float>(a.pixel.x() + part * step.x()),
         static_cast<float>(options_.amplitude_dn * share * light * narrowing),
         static_cast<float>(width_px * askew)});
  }
}

void LineRenderer::draw_sheet(const Sheet& sheet, Strokes& strokes) const {
  const Vector3& normal = truth_.laser_normal_in_camera;
  // The laser is on the baseline, where its plane cuts the camera's x axis, and shines forward.
  const Vector3 laser_in_camera =
      Vector3(truth_.laser_distance_m / normal.x(), 0.0, 0.0) + sheet.aside_m * normal;
  const Vector3 down = (Vector3::UnitY() - normal.y() * normal).normalized();
  Vector3 ahead = normal.cross(down);
  if (ahead.z() < 0.0) ahead = -ahead;
  Transform couch_from_camera = truth_.couch_from_camera_at(sheet.yaw_rad);
  // Rows of the image that a ray's height over the middle makes, for a shutter that rolls.
  const double rows_per_height = truth_.camera.fy_px / std::abs(normal.x());
  Spot before;
  for (int i = 0; i < fan_rays; ++i) {
    const double angle = -fan_half_rad + i * fan_step_rad;
    if (sheet.yaw_per_row_rad != 0.0) {
      const double rows = rows_per_height * std::tan(angle);
      couch_from_camera = truth_.couch_from_camera_at(sheet.yaw_rad + rows * sheet.yaw_per_row_rad);
    }
    const Vector3 direction =
        couch_from_camera.linear() * (std::cos(angle) * ahead + std::sin(angle) * down);
    const Spot spot =
        trace(couch_from_camera * laser_in_camera, direction, couch_from_camera.translation(),
              couch_from_camera.inverse(), sheet.shift_in_couch);
    join(before, spot, sheet.share, strokes);
    before = spot;
  }
}

Image LineRenderer::render(double yaw_rad, const Vector3& skin_shift_in_couch, std::uint64_t frame,
                           std::vector<bool>* visible, const RoomPicture& room,
                           const Readout& readout) const {
  Strokes strokes(static_cast<std::size_t>(truth_.camera.height_px));
  const auto row_sees = [this](const std::vector<Stroke>& row) {
    return std::any_of(row.begin(), row.end(), [this](const Stroke& stroke) {
      return stroke.column_px >= 0.0F &&
             stroke.column_px <= static_cast<float>(truth_.camera.width_px - 1);
    });
  };
  for (std::size_t i = 0; i < sheet_aside.size(); ++i) {
    const Sheet sheet{.yaw_rad = yaw_rad,
                      .yaw_per_row_rad = readout.yaw_per_row_rad,
                      .shift_in_couch = skin_shift_in_couch,
                      .aside_m = sheet_aside[i] * sheet_deviation_m,
                      .share = sheet_share[i]};
    // A row counts as visible by the centre of the sheet.
    if (visible != nullptr && sheet.aside_m == 0.0) {
      Strokes middle(strokes.size());
      draw_sheet(sheet, middle);
      visible->resize(middle.size());
      for (std::size_t row = 0; row < strokes.size(); ++row) {
        (*visible)[row] = row_sees(middle[row]);
        strokes[row].insert(strokes[row].end(), middle[row].begin(), middle[row].end());
      }
    } else {
      draw_sheet(sheet, strokes);
    }
  }
  const std::uint64_t state = seed_ * 0xD1342543DE82EF95ULL + frame * 0x2545F4914F6CDD1DULL;
  displace(strokes, state ^ 0x5BECC1EULL);
  return expose(strokes, room, readout, state);
}

Image LineRenderer::render_dark(std::uint64_t frame, const RoomPicture& room,
                                const Readout& readout) const {
  const Strokes none(static_cast<std::size_t>(truth_.camera.height_px));
  return expose(none, room, readout,
                ~seed_ * 0xD1342543DE82EF95ULL + frame * 0x2545F4914F6CDD1DULL);
}

RoomPicture LineRenderer::room(double yaw_rad, const Vector3& skin_shift_in_couch) const {
  if (!room_light_) return {};
  return room_light_->render(skin_, couch_, truth_.camera, truth_.couch_from_camera_at(yaw_rad),
                             skin_shift_in_couch);
}

void LineRenderer::add_line(const std::vector<Stroke>& strokes, float share,
                            std::vector<float>& light) const {
  const int width = truth_.camera.width_px;
  for (const Stroke& stroke : strokes) {
    const float reach = 5.0F * stroke.width_px;
    const int from = std::max(0, static_cast<int>(std::ceil(stroke.column_px - reach)));
    const int to = std::min(width - 1, static_cast<int>(std::floor(stroke.column_px + reach)));
    for (int x = from; x <= to; ++x) {
      const float u = (static_cast<float>(x) - stroke.column_px) / stroke.width_px;
      light[static_cast<std::size_t>(x)] += share * stroke.amplitude_dn * std::exp(-0.5F * u * u);
    }
  }
}

void LineRenderer::add_noise(const std::vector<float>& light, std::uint64_t& state,
                             std::uint8_t* pixels, int stride) const {
  const float* noise = noise_.data() + next(state) % (noise_samples - light.size());
  for (std::size_t x = 0; x < light.size(); ++x) {
    const float value = light[x] + noise[x] + 0.5F;
    pixels[x * static_cast<std::size_t>(stride)] =
        static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
  }
}

Image LineRenderer::expose(const Strokes& strokes, const RoomPicture& room, const Readout& readout,
                           std::uint64_t state) const {
  if (!room.empty()) return expose_colour(strokes, room, state);
  Image image(truth_.camera.width_px, truth_.camera.height_px);
  std::vector<float> light(static_cast<std::size_t>(image.width));
  for (int y = 0; y < image.height; ++y) {
    const double lamp = std::sin(readout.lamp_rad + y * readout.lamp_per_row_rad);
    const double dark = options_.room_light_dn * (1.0 + options_.flaws.flicker_share * lamp);
    std::fill(light.begin(), light.end(), static_cast<float>(dark));
    add_line(strokes[static_cast<std::size_t>(y)], 1.0F, light);
    add_noise(light, state, image.row(y), 1);
  }
  return image;
}

Image LineRenderer::expose_colour(const Strokes& strokes, const RoomPicture& room,
                                  std::uint64_t state) const {
  Image image(truth_.camera.width_px, truth_.camera.height_px, 3);
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<float> light(width);
  for (int y = 0; y < image.height; ++y) {
    const Rgb* behind = room.data() + static_cast<std::size_t>(y) * width;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      for (std::size_t x = 0; x < width; ++x) light[x] = behind[x][channel];
      // Green and blue filters of a sensor transmit a little of the red laser.
      add_line(strokes[static_cast<std::size_t>(y)], channel == 0 ? 1.0F : leak, light);
      add_noise(light, state, image.row(y) + channel, 3);
    }
  }
  return image;
}

}  // namespace tuina::sim
