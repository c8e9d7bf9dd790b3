// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/shaded_picture.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "tuina/core/grid.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/telemetry/picture/ray_picture.hpp"

namespace tuina::telemetry {
namespace {

using Light = Eigen::Vector3f;

constexpr int samples_per_pixel = 3;  // across and down

/// Where the light comes from, in the picture's axes: x right, y up, z towards the eye.
const Eigen::Vector3f key_direction = Eigen::Vector3f(-0.72F, 0.58F, 0.46F).normalized();
const Eigen::Vector3f fill_direction = Eigen::Vector3f(0.85F, 0.05F, 0.50F).normalized();
const Light key_light(2.05F, 1.95F, 1.82F);
const Light fill_light(0.52F, 0.50F, 0.52F);
const Light sky_light(0.50F, 0.52F, 0.56F);
const Light ground_light(0.30F, 0.25F, 0.22F);

/// Means over squares of those pixels that have a value, each from four sums over corners.
class SquareMean {
 public:
  SquareMean(int width, int height) : width_(width), height_(height) {
    sums_.resize(index(0, height + 1), Eigen::Vector2d::Zero());
  }
  /// Pixels come row by row, each once.
  void add(int x, int y, std::optional<float> value) {
    const Eigen::Vector2d here(value.value_or(0.F), value ? 1.0 : 0.0);
    sums_[index(x + 1, y + 1)] =
        here + sums_[index(x, y + 1)] + sums_[index(x + 1, y)] - sums_[index(x, y)];
  }
  /// Of the squares of this half width and of half of it, which nears a Gaussian.
  [[nodiscard]] float around(int x, int y, int radius) const {
    return 0.5F * (square(x, y, radius) + square(x, y, (radius + 1) / 2));
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const { return grid_index(y, width_ + 1, x); }
  [[nodiscard]] float square(int x, int y, int radius) const {
    const int left = std::max(0, x - radius), right = std::min(width_, x + radius + 1);
    const int top = std::max(0, y - radius), bottom = std::min(height_, y + radius + 1);
    const Eigen::Vector2d sum = sums_[index(right, bottom)] - sums_[index(left, bottom)] -
                                sums_[index(right, top)] + sums_[index(left, top)];
    return sum.y() > 0.5 ? static_cast<float>(sum.x() / sum.y()) : 0.F;
  }

  int width_, height_;
  std::vector<Eigen::Vector2d> sums_;  // of values and of how many there are, up to each pixel
};

/// What is around a pixel, the same for all samples of it.
struct Surroundings {
  std::array<float, 3> depth_m;  ///< mean depth at three scales
  float key_share;               ///< of the key light
};

struct Scale {
  float radius_m, gain;
};
constexpr std::array scales = {Scale{0.010F, 110.F}, Scale{0.030F, 60.F}, Scale{0.08F, 20.F}};

/// How hollow a place is at three scales: the mean depth around it against its own, in metres.
/// After T. Luft et al., Image Enhancement by Unsharp Masking the Depth Buffer (2006), which stands
/// in for ambient occlusion.
float hollowness(const Surroundings& around, float here) {
  float hollow = 0.F;
  for (std::size_t k = 0; k < scales.size(); ++k)
    hollow += std::clamp(scales[k].gain * (around.depth_m[k] - here), -0.16F, 0.45F);
  return hollow;
}

/// The light that one sample sends to the eye.
Light lit_colour(const Eigen::Vector3f& normal, const Light& albedo, bool skin, float key_share,
                 float hollow) {
  const Eigen::Vector3f to_eye = Eigen::Vector3f::UnitZ();
  const float open = std::clamp(1.F - hollow, 0.25F, 1.25F);
  // Skin lets red light creep round into the shade, so its terminator is wide and warm.
  const Light wrap = skin ? Light(0.28F, 0.14F, 0.10F) : Light(0.1F, 0.1F, 0.1F);
  const float key_angle = normal.dot(key_direction);
  const Light key =
      (((Light::Constant(key_angle) + wrap).array() / (1.F + wrap.array())).max(0.F)).matrix();
  // Where the surface turns away from the light by itself no shadow need fall on it.
  const float facing = std::clamp(key_angle / 0.3F, 0.F, 1.F);
  key_share = 1.F - facing * (1.F - key_share);
  const float fill = std::max(0.F, (normal.dot(fill_direction) + 0.3F) / 1.3F);
  const float up = 0.5F + 0.5F * normal.y();
  const Light shade =
      key_share * Light::Ones() +
      (1.F - key_share) * (skin ? Light(0.16F, 0.07F, 0.05F) : Light(0.06F, 0.06F, 0.06F));
  Light light = key_light.cwiseProduct(key).cwiseProduct(shade) + fill * fill_light +
                open * (up * sky_light + (1.F - up) * ground_light);
  light *= 0.55F + 0.45F * open;
  const Eigen::Vector3f half_way = (key_direction + to_eye).normalized();
  const float gloss = std::pow(std::max(0.F, normal.dot(half_way)), skin ? 14.F : 40.F) *
                      key_share * (skin ? 0.055F : 0.16F);
  const float away = 1.F - std::clamp(normal.z(), 0.F, 1.F);
  const float rim = away * away * away * 0.10F * open;
  return 0.60F * light.cwiseProduct(albedo) + Light::Constant(gloss) +
         rim * Light(1.F, 0.96F, 0.92F);
}

/// Bright light is rolled off instead of cut.
float exposed(float light) {
  return light < 0.6F ? light : 0.6F + 0.4F * (1.F - std::exp(-(light - 0.6F) / 0.4F));
}

/// Turns the samples of a pixel into its colour.
class Painter {
 public:
  Painter(const Scene& scene, const Projection& projection)
      : rays_(scene, projection),
        width_(projection.width_px()),
        height_(projection.height_px()),
        px_per_m_(static_cast<float>(projection.px_per_m())),
        depth_(width_, height_),
        key_(width_, height_) {
    for (const Disc& disc : scene.discs) {
      const auto light = to_light(disc.colour);
      discs_.push_back({projection.in_view(disc.at).cast<float>(),
                        static_cast<float>(disc.radius_m), Light(light[0], light[1], light[2])});
    }
    first_.resize(grid_cells(height_, width_));
    std::vector<std::optional<float>> key_shares(first_.size());
    for_each_in_parallel(static_cast<std::size_t>(height_), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width_; ++x) {
        auto& sample = first_[index(x, y)];
        sample = rays_.seen_through(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        if (sample && sample->skin) key_shares[index(x, y)] = key_share(sample->at);
      }
    });
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const auto& sample = first_[index(x, y)];
        const bool skin = sample && sample->skin;
        depth_.add(x, y, skin ? std::optional(sample->at.z()) : std::nullopt);
        key_.add(x, y, key_shares[index(x, y)]);
      }
    }
  }

  [[nodiscard]] Colour pixel(int x, int y) const {
    Light sum = Light::Zero();
    float covered = 0.F;
    std::optional<Surroundings> around;
    const auto add = [&](const std::optional<Sample>& sample, float share) {
      if (!sample) return;
      if (sample->skin && !around) around = around_pixel(x, y);
      sum += share * sample->cover * (sample->skin ? lit_skin(*sample, *around) : lit(*sample));
      covered += share * sample->cover;
    };
    constexpr int all = samples_per_pixel * samples_per_pixel;
    const auto at_sample = [](int pixel, int sample) {
      return static_cast<float>(pixel) + (static_cast<float>(sample) + 0.5F) / samples_per_pixel;
    };
    const bool smooth = is_smooth(x, y);
    for (int k = 0; k < all && !smooth; ++k) {
      const int column = k % samples_per_pixel, row = k / samples_per_pixel;
      add(rays_.seen_through(at_sample(x, column), at_sample(y, row)), 1.F / all);
    }
    if (smooth) add(first_[index(x, y)], 1.F);
    sum += Light::Constant(1.F - covered);  // paper
    return from_light({sum.x(), sum.y(), sum.z()});
  }

 private:
  struct FlatDisc {
    Eigen::Vector3f at;
    float radius_m;
    Light tint;
  };

  [[nodiscard]] std::size_t index(int x, int y) const { return grid_index(y, width_, x); }

  /// One ray is enough where a pixel and its neighbours show one piece of skin, or nothing.
  [[nodiscard]] bool is_smooth(int x, int y) const {
    const std::optional<Sample>& here = first_[index(x, y)];
    for (int k = 0; k < 9; ++k) {
      const std::optional<Sample>& there = first_[index(std::clamp(x + k % 3 - 1, 0, width_ - 1),
                                                        std::clamp(y + k / 3 - 1, 0, height_ - 1))];
      if (here.has_value() != there.has_value()) return false;
      if (!here) continue;
      if (!there->skin || there->cover < 1.F || std::abs(here->at.z() - there->at.z()) > 0.006F)
        return false;
    }
    return true;
  }

  [[nodiscard]] float key_share(const Eigen::Vector3f& at) const {
    return rays_.in_shadow(at, key_direction) ? 0.F : 1.F;
  }

  /// How much a disc tints a place of the skin: more in its rim, and softly over a pixel.
  [[nodiscard]] float share_of(const FlatDisc& disc, const Eigen::Vector3f& at) const {
    const Eigen::Vector3f away = at - disc.at;
    const float reaches_m = disc.radius_m + 0.5F / px_per_m_;
    if (away.head<2>().squaredNorm() > reaches_m * reaches_m) return 0.F;
    const float inward_m = disc.radius_m - std::hypot(away.head<2>().norm(), 0.7F * away.z());
    const auto past = [&](float m) {
      return std::clamp((inward_m - m) * px_per_m_ + 0.5F, 0.F, 1.F);
    };
    return 0.8F * past(0.F) - 0.5F * past(0.0012F);
  }

  [[nodiscard]] Light lit(const Sample& sample) const {
    return lit_colour(sample.normal, sample.albedo, false, key_share(sample.at), 0.F)
        .unaryExpr(&exposed);
  }

  [[nodiscard]] Surroundings around_pixel(int x, int y) const {
    const auto pixels = [&](float m) { return std::max(1, static_cast<int>(m * px_per_m_)); };
    // The edge of a shadow is soft over a few millimetres, as of a wide lamp.
    Surroundings around{.depth_m = {}, .key_share = key_.around(x, y, pixels(0.004F))};
    for (std::size_t k = 0; k < scales.size(); ++k)
      around.depth_m[k] = depth_.around(x, y, pixels(scales[k].radius_m));
    return around;
  }

  [[nodiscard]] Light lit_skin(const Sample& sample, const Surroundings& around) const {
    Light albedo = sample.albedo;
    for (const FlatDisc& disc : discs_) albedo += share_of(disc, sample.at) * (disc.tint - albedo);
    return lit_colour(sample.normal, albedo, true, around.key_share,
                      hollowness(around, sample.at.z()))
        .unaryExpr(&exposed);
  }

  RayPicture rays_;
  int width_, height_;
  float px_per_m_;
  std::vector<FlatDisc> discs_;
  std::vector<std::optional<Sample>> first_;  // through the middle of each pixel
  SquareMean depth_, key_;  // of the skin: metres towards the eye, share of the key light
};

}  // namespace

ShadedPicture shade(const Scene& scene, const View& view) {
  assert(!scene.surface.mesh.triangles.empty());
  std::vector<Vector3> seen = scene.in_frame;
  for (std::size_t k = 0; k < scene.surface.mesh.vertices.size(); ++k) {
    if (scene.surface.inside[k] >= 0.5F) seen.push_back(scene.surface.mesh.vertices[k]);
  }
  ShadedPicture picture{.image = {}, .projection = Projection(view, seen)};
  const int width = picture.projection.width_px();
  const int height = picture.projection.height_px();
  const Painter painter(scene, picture.projection);
  picture.image = Image(width, height, 3);
  for_each_in_parallel(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    std::uint8_t* out = picture.image.row(y);
    for (int x = 0; x < width; ++x) {
      const Colour colour = painter.pixel(x, y);
      *out++ = colour.red;
      *out++ = colour.green;
      *out++ = colour.blue;
    }
  });
  return picture;
}

}  // namespace tuina::telemetry
