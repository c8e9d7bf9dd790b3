// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/shaded_picture.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "tuina/telemetry/picture/raster.hpp"

namespace tuina::telemetry {
namespace {

using Light = Eigen::Vector3f;

constexpr int samples_per_pixel = 3;  // across and down
constexpr int shadow_size = 1024;

/// Where the light comes from, in the picture's axes: x right, y up, z towards the eye.
const Eigen::Vector3f key_direction = Eigen::Vector3f(-0.72F, 0.58F, 0.46F).normalized();
const Eigen::Vector3f fill_direction = Eigen::Vector3f(0.85F, 0.05F, 0.50F).normalized();
const Light key_light(2.05F, 1.95F, 1.82F);
const Light fill_light(0.52F, 0.50F, 0.52F);
const Light sky_light(0.50F, 0.52F, 0.56F);
const Light ground_light(0.30F, 0.25F, 0.22F);

/// Everything in the axes of the picture, ready to be rastered.
struct Prepared {
  std::vector<RasterVertex> vertices;
  std::vector<RasterBall> balls;
};

Prepared prepare(const Scene& scene, const Projection& projection) {
  Prepared ready;
  const auto& mesh = scene.surface.mesh;
  ready.vertices.reserve(mesh.vertices.size());
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const auto light = to_light(scene.colours.empty() ? scene.colour : scene.colours[k]);
    ready.vertices.push_back({.at = projection(mesh.vertices[k]).cast<float>(),
                              .normal = projection.turned(scene.surface.normals[k]).cast<float>(),
                              .albedo = Light(light[0], light[1], light[2]),
                              .inside = scene.surface.inside[k]});
  }
  const auto add_ball = [&](const Vector3& at, double radius_m, Colour colour) {
    const auto light = to_light(colour);
    ready.balls.push_back({.at = projection(at).cast<float>(),
                           .radius_px = static_cast<float>(radius_m * projection.px_per_m()),
                           .radius_m = static_cast<float>(radius_m),
                           .albedo = Light(light[0], light[1], light[2])});
  };
  for (const Thread& thread : scene.threads) {
    for (std::size_t k = 0; k + 1 < thread.points.size(); ++k) {
      const Vector3 along = thread.points[k + 1] - thread.points[k];
      // Balls as close as this look like one smooth thread, thick or thin.
      const double apart_m =
          std::min(0.5 * thread.radius_m, std::max(0.0015, 0.1 * thread.radius_m));
      const int balls = std::clamp(static_cast<int>(along.norm() / apart_m) + 1, 1, 2000);
      for (int ball = 0; ball < balls; ++ball) {
        add_ball(thread.points[k] + along * (static_cast<double>(ball) / balls), thread.radius_m,
                 thread.colour);
      }
    }
    if (!thread.points.empty()) add_ball(thread.points.back(), thread.radius_m, thread.colour);
  }
  for (const Bead& bead : scene.beads) add_ball(bead.at, bead.radius_m, bead.colour);
  return ready;
}

/// The scene's depth as the key light sees it. A place is turned into the light's own axes first.
class Shadow {
 public:
  Shadow(const Prepared& ready, const std::vector<std::array<int, 3>>& triangles, float px_per_m)
      : px_per_m_(px_per_m) {
    const Eigen::Vector3f right = Eigen::Vector3f::UnitY().cross(key_direction).normalized();
    light_from_picture_ << right.transpose(), key_direction.cross(right).transpose(),
        key_direction.transpose();
    Eigen::AlignedBox3f box;
    for (const auto& vertex : ready.vertices) box.extend(turned(vertex.at));
    low_ = box.min();
    texels_per_m_ = (shadow_size - 4) / std::max(1e-6F, box.sizes().head<2>().maxCoeff());
    Raster raster(0, shadow_size, shadow_size);
    std::vector<RasterVertex> vertices = ready.vertices;
    for (auto& vertex : vertices) vertex.at = in_map(vertex.at);
    for (const auto& triangle : triangles) raster.draw(vertices, triangle);
    for (RasterBall ball : ready.balls) {
      ball.at = in_map(ball.at);
      ball.radius_px = ball.radius_m * texels_per_m_;
      raster.draw(ball);
    }
    depth_ = std::move(raster.depth);
  }

  /// The share of the key light that reaches a place, 0 to 1; the edge is soft over a few
  /// millimetres.
  [[nodiscard]] float lit(const Eigen::Vector3f& at) const {
    static constexpr std::array<std::array<float, 2>, 12> taps = {{{-0.326F, -0.406F},
                                                                   {-0.840F, -0.074F},
                                                                   {-0.696F, 0.457F},
                                                                   {-0.203F, 0.621F},
                                                                   {0.962F, -0.195F},
                                                                   {0.473F, -0.480F},
                                                                   {0.519F, 0.767F},
                                                                   {0.185F, -0.893F},
                                                                   {0.507F, 0.064F},
                                                                   {0.896F, 0.412F},
                                                                   {-0.322F, -0.933F},
                                                                   {-0.792F, -0.598F}}};
    const float spread = 0.0035F * texels_per_m_;
    const Eigen::Vector3f p = in_map(at);
    float sum = 0.F;
    for (const auto& tap : taps) {
      const int x = static_cast<int>(p.x() + spread * tap[0]);
      const int y = static_cast<int>(p.y() + spread * tap[1]);
      const bool outside = x < 0 || y < 0 || x >= shadow_size || y >= shadow_size;
      const float blocker =
          outside ? no_depth : depth_[static_cast<std::size_t>(y * shadow_size + x)];
      // A little slack keeps a surface from shading itself; the shadow sets in over two
      // millimetres.
      sum += std::clamp(1.F - (blocker - p.z() - 0.0025F) / 0.002F, 0.F, 1.F);
    }
    return sum / static_cast<float>(taps.size());
  }

 private:
  [[nodiscard]] Eigen::Vector3f turned(const Eigen::Vector3f& at) const {
    const Eigen::Vector3f metres(at.x() / px_per_m_, -at.y() / px_per_m_, at.z());
    return light_from_picture_ * metres;
  }
  [[nodiscard]] Eigen::Vector3f in_map(const Eigen::Vector3f& at) const {
    const Eigen::Vector3f p = turned(at);
    return {(p.x() - low_.x()) * texels_per_m_ + 2.F, (p.y() - low_.y()) * texels_per_m_ + 2.F,
            p.z()};
  }

  float px_per_m_;
  Eigen::Matrix3f light_from_picture_;
  Eigen::Vector3f low_;
  float texels_per_m_;
  std::vector<float> depth_;
};

/// How hollow each pixel is at three scales: the mean depth around it against its own, in metres.
/// After T. Luft et al., Image Enhancement by Unsharp Masking the Depth Buffer (2006), which stands
/// in for ambient occlusion.
std::vector<float> hollowness(const Raster& surface, float px_per_m) {
  const std::size_t pixels = surface.depth.size();
  std::vector<float> hollow(pixels, 0.F);
  struct Scale {
    float radius_m, gain;
  };
  for (const Scale scale : {Scale{0.006F, 110.F}, Scale{0.018F, 60.F}, Scale{0.05F, 20.F}}) {
    std::vector<float> mean(pixels);
    std::vector<float> weight(pixels);
    for (std::size_t k = 0; k < pixels; ++k) {
      weight[k] = surface.depth[k] == no_depth ? 0.F : 1.F;
      mean[k] = weight[k] * (weight[k] > 0.F ? surface.depth[k] : 0.F);
    }
    const int radius = std::max(1, static_cast<int>(scale.radius_m * px_per_m));
    for (int pass = 0; pass < 2; ++pass) {
      box_blur(mean, surface.width, surface.height, radius);
      box_blur(weight, surface.width, surface.height, radius);
    }
    for (std::size_t k = 0; k < pixels; ++k) {
      if (surface.depth[k] == no_depth || weight[k] <= 0.F) continue;
      const float relative = mean[k] / weight[k] - surface.depth[k];
      hollow[k] += std::clamp(scale.gain * relative, -0.16F, 0.45F);
    }
  }
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
  const float rim = std::pow(1.F - std::clamp(normal.z(), 0.F, 1.F), 3.F) * 0.10F * open;
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
  Painter(const Scene& scene, const Projection& projection, const Prepared& ready)
      : px_per_m_(static_cast<float>(projection.px_per_m())),
        width_(projection.width_px()),
        shadow_(ready, scene.surface.mesh.triangles, px_per_m_) {
    Raster coarse(0, projection.width_px(), projection.height_px());
    for (const auto& triangle : scene.surface.mesh.triangles) coarse.draw(ready.vertices, triangle);
    hollow_ = hollowness(coarse, px_per_m_);
    for (const Disc& disc : scene.discs) {
      const auto light = to_light(disc.colour);
      discs_.push_back({projection(disc.at).cast<float>(), static_cast<float>(disc.radius_m),
                        Light(light[0], light[1], light[2])});
    }
  }

  /// `raster` holds `samples_per_pixel` squared samples of each pixel.
  [[nodiscard]] Colour pixel(const Raster& raster, int x, int y) const {
    constexpr int all = samples_per_pixel * samples_per_pixel;
    std::array<Sample, all> samples;
    int seen = 0;
    int skin = 0;
    float nearest = no_depth;
    float farthest = -no_depth;
    for (int k = 0; k < all; ++k) {
      const int sx = x * samples_per_pixel + k % samples_per_pixel;
      const int sy = y * samples_per_pixel + k / samples_per_pixel - raster.top;
      const std::size_t at = static_cast<std::size_t>(sy) * static_cast<std::size_t>(raster.width) +
                             static_cast<std::size_t>(sx);
      if (raster.depth[at] == no_depth) continue;
      Sample& sample = samples[static_cast<std::size_t>(seen++)];
      const float column = (static_cast<float>(sx) + 0.5F) / samples_per_pixel;
      const float row = (static_cast<float>(sy + raster.top) + 0.5F) / samples_per_pixel;
      sample = {.at = {column, row, raster.depth[at]},
                .normal = raster.normal[at],
                .albedo = raster.albedo[at],
                .cover = raster.inside[at],
                .skin = raster.skin[at] != 0};
      if (sample.skin) tint(sample);
      skin += sample.skin ? 1 : 0;
      nearest = std::max(nearest, sample.at.z());
      farthest = std::min(farthest, sample.at.z());
    }
    const float hollow = hollow_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                 static_cast<std::size_t>(x)];
    Light sum = Light::Zero();
    float covered = 0.F;
    // Where all samples are one piece of skin the light is worked out once, which is most of the
    // picture.
    const bool smooth = skin == all && nearest - farthest < 0.004F;
    if (smooth) {
      Sample mean = samples[all / 2];
      for (const Sample& sample : samples) {
        if (&sample == &samples[all / 2]) continue;
        mean.normal += sample.normal;
        mean.albedo += sample.albedo;
        covered += sample.cover;
      }
      covered += mean.cover;
      mean.albedo /= all;
      sum = covered * lit(mean, hollow);
    }
    for (int k = 0; k < seen && !smooth; ++k) {
      const Sample& sample = samples[static_cast<std::size_t>(k)];
      sum += sample.cover * lit(sample, sample.skin ? hollow : 0.F);
      covered += sample.cover;
    }
    sum = sum / all + Light::Constant(1.F - covered / all);
    return from_light({sum.x(), sum.y(), sum.z()});
  }

 private:
  struct Sample {
    Eigen::Vector3f at;
    Eigen::Vector3f normal;
    Light albedo;
    float cover = 0.F;
    bool skin = false;
  };
  struct FlatDisc {
    Eigen::Vector3f at;
    float radius_m;
    Light tint;
  };

  void tint(Sample& sample) const {
    for (const FlatDisc& disc : discs_) {
      const Eigen::Vector2f across = (sample.at - disc.at).head<2>() / px_per_m_;
      if (across.squaredNorm() > disc.radius_m * disc.radius_m) continue;
      const float d = std::hypot(across.norm(), 0.7F * (sample.at.z() - disc.at.z()));
      if (d > disc.radius_m) continue;
      const float share = d > disc.radius_m - 0.0012F ? 0.8F : 0.30F;
      sample.albedo += share * (disc.tint - sample.albedo);
    }
  }
  [[nodiscard]] Light lit(const Sample& sample, float hollow) const {
    return lit_colour(sample.normal.normalized(), sample.albedo, sample.skin,
                      shadow_.lit(sample.at), hollow)
        .unaryExpr(&exposed);
  }

  float px_per_m_;
  int width_;
  Shadow shadow_;
  std::vector<float> hollow_;
  std::vector<FlatDisc> discs_;
};

}  // namespace

Projection::Projection(const View& view, const std::vector<Vector3>& seen)
    : distance_m_(view.distance_m) {
  const Vector3 forward = view.toward_eye.normalized();
  const Vector3 right = view.up.cross(forward).normalized();
  view_from_world_ << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  Eigen::AlignedBox3d around;
  for (const Vector3& place : seen) around.extend(place);
  if (!seen.empty()) centre_ = around.center();
  // The eye stays well in front of whatever is seen.
  distance_m_ = std::max(distance_m_, 1.2 * around.sizes().norm());
  Eigen::AlignedBox2d on_screen;
  for (const Vector3& place : seen) {
    const Vector3 p = view_from_world_ * (place - centre_);
    on_screen.extend(Vector2(p.x(), -p.y()) / (distance_m_ - p.z()));
  }
  const Vector2 size = seen.empty() ? Vector2(1, 1) : Vector2(on_screen.sizes().cwiseMax(1e-9));
  scale_ = std::min((view.width_px - 2 * view.margin_px) / size.x(),
                    (view.height_px - 2 * view.margin_px) / size.y());
  if (!seen.empty()) shift_px_ = Vector2::Constant(view.margin_px) - scale_ * on_screen.min();
  width_px_ = static_cast<int>(std::ceil(scale_ * size.x() + 2 * view.margin_px));
  height_px_ = static_cast<int>(std::ceil(scale_ * size.y() + 2 * view.margin_px));
}

Vector3 Projection::operator()(const Vector3& place) const {
  const Vector3 p = view_from_world_ * (place - centre_);
  const Vector2 at = shift_px_ + scale_ * Vector2(p.x(), -p.y()) / (distance_m_ - p.z());
  return {at.x(), at.y(), p.z()};
}

ShadedPicture shade(const Scene& scene, const View& view) {
  assert(!scene.surface.mesh.triangles.empty());
  std::vector<Vector3> seen = scene.in_frame;
  for (std::size_t k = 0; k < scene.surface.mesh.vertices.size(); ++k) {
    if (scene.surface.inside[k] >= 0.5F) seen.push_back(scene.surface.mesh.vertices[k]);
  }
  ShadedPicture picture{.image = {}, .projection = Projection(view, seen)};
  const int width = picture.projection.width_px();
  const int height = picture.projection.height_px();
  const auto& triangles = scene.surface.mesh.triangles;
  Prepared ready = prepare(scene, picture.projection);
  const Painter painter(scene, picture.projection, ready);

  // The picture is made in strips, so that its many samples never need much memory at once.
  picture.image = Image(width, height, 3);
  constexpr int strip_rows = 64;
  for (auto& vertex : ready.vertices) vertex.at.head<2>() *= samples_per_pixel;
  for (auto& ball : ready.balls) {
    ball.at.head<2>() *= samples_per_pixel;
    ball.radius_px *= samples_per_pixel;
  }
  for (int top = 0; top < height; top += strip_rows) {
    const int rows = std::min(strip_rows, height - top);
    Raster raster(top * samples_per_pixel, width * samples_per_pixel, rows * samples_per_pixel);
    for (const auto& triangle : triangles) raster.draw(ready.vertices, triangle);
    for (const RasterBall& ball : ready.balls) raster.draw(ball);
    for (int y = top; y < top + rows; ++y) {
      std::uint8_t* out = picture.image.row(y);
      for (int x = 0; x < width; ++x) {
        const Colour colour = painter.pixel(raster, x, y);
        out[3 * x] = colour.red;
        out[3 * x + 1] = colour.green;
        out[3 * x + 2] = colour.blue;
      }
    }
  }
  return picture;
}

}  // namespace tuina::telemetry
