// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuina::scanner {
namespace {

template <typename Sample>
bool spike_at(const Sample* row, int x, float min_dn, const LineScene& scene) {
  const auto here = static_cast<float>(row[x]);
  const float left = x > scene.first_column ? static_cast<float>(row[x - 1]) : 0.0F;
  const float right = x < scene.last_column ? static_cast<float>(row[x + 1]) : 0.0F;
  return here - std::max(left, right) > min_dn;
}

template <typename Sample>
bool spike_near(const Sample* row, int column, float height_dn, const LineScene& scene) {
  const float least = min_spike_over_noise * scene.noise_dn + height_dn * spike_share(scene);
  const int from = std::max(scene.first_column, column - scene.beside_px);
  const int to = std::min(scene.last_column, column + scene.beside_px);
  for (int x = from; x <= to; ++x) {
    if (spike_at(row, x, least, scene)) return true;
  }
  return false;
}

// Farthest pixel that is looked at beside a line or its clipped middle, and room for all of them.
constexpr int max_reach_px = 255;
using Values = Eigen::Array<float, Eigen::Dynamic, 1, 0, 2 * max_reach_px + 1, 1>;

// Pixels that tell of a line. Columns count from `origin`, so that floats resolve them.
struct Usable {
  int origin = 0;
  Values column_px;
  Values light_dn;
};

// A Gaussian line on an even background.
struct Bell {
  double centre_px;  // from the origin
  double amplitude_dn;
  double width_px;  // standard deviation
  double background_dn;
};

// Least squares of amplitude, place, background and width, linear about the last of them.
struct Normal {
  Eigen::Matrix4d matrix;
  Eigen::Vector4d right;
};

Normal normal_of(const Usable& pixels, const Bell& bell) {
  const auto width = static_cast<float>(bell.width_px);
  const auto amplitude = static_cast<float>(bell.amplitude_dn);
  const Values u = (pixels.column_px - static_cast<float>(bell.centre_px)) / width;
  // Far from the line g is nothing, and its square would be too small for processors to be quick.
  const Values g = (-0.5F * u.square()).max(-40.0F).exp();
  // Slopes by place and width, but for the factor amplitude / width.
  const Values gu = g * u;
  const Values guu = gu * u;
  const Values error = pixels.light_dn - amplitude * g - static_cast<float>(bell.background_dn);
  const auto dot = [](const Values& a, const Values& b) {
    return static_cast<double>(a.matrix().dot(b.matrix()));
  };
  const auto sum = [](const Values& a) { return static_cast<double>(a.sum()); };
  const double k = bell.amplitude_dn / bell.width_px;
  const auto count = static_cast<double>(u.size());
  const double by_place_and_width = k * k * dot(gu, guu);
  const double by_amplitude_and_width = k * dot(gu, gu);  // g * guu is gu * gu
  Normal normal;
  normal.matrix << dot(g, g), k * dot(g, gu), sum(g), by_amplitude_and_width,       //
      k * dot(g, gu), k * by_amplitude_and_width, k * sum(gu), by_place_and_width,  //
      sum(g), k * sum(gu), count, k * sum(guu),                                     //
      by_amplitude_and_width, by_place_and_width, k * sum(guu), k * k * dot(guu, guu);
  normal.right << dot(g, error), k * dot(gu, error), sum(error), k * dot(guu, error);
  return normal;
}

struct Plateau {
  int left, right;
};

// The clipped pixels around a column, or the column alone.
template <typename Sample>
Plateau plateau_at(const Sample* row, int column, const LineScene& scene) {
  const auto clipped = [&](int x) { return static_cast<float>(row[x]) >= scene.saturated_dn; };
  Plateau plateau{column, column};
  if (!clipped(column)) return plateau;
  while (plateau.left > scene.first_column && clipped(plateau.left - 1)) --plateau.left;
  while (plateau.right < scene.last_column && clipped(plateau.right + 1)) ++plateau.right;
  return plateau;
}

template <typename Sample>
Usable usable_around(const Sample* row, const Plateau& plateau, const LineScene& scene) {
  const int reach = std::min(scene.beside_px + 6, max_reach_px);
  const int from = std::max(scene.first_column, plateau.left - reach);
  const int to = std::min(scene.last_column, plateau.right + reach);
  const float least = min_spike_over_noise * scene.noise_dn +
                      static_cast<float>(row[plateau.left]) * spike_share(scene);
  Usable usable{.origin = plateau.left,
                .column_px = Values(2 * max_reach_px + 1),
                .light_dn = Values(2 * max_reach_px + 1)};
  Eigen::Index count = 0;
  for (int x = from; x <= to; ++x) {
    const auto light = static_cast<float>(row[x]);
    if (light >= scene.saturated_dn) continue;
    if (plateau.left == plateau.right && spike_at(row, x, least, scene)) continue;
    usable.column_px(count) = static_cast<float>(x - usable.origin);
    usable.light_dn(count) = light;
    ++count;
  }
  usable.column_px.conservativeResize(count);
  usable.light_dn.conservativeResize(count);
  return usable;
}

// The width and height at which a bell is clipped over `plateau` and lit by half of that beyond it.
// Its height is at most twenty times what is seen of it.
void complete_clipped(Bell& bell, const Plateau& plateau, const Usable& pixels,
                      double saturated_dn) {
  const double seen_dn = saturated_dn - bell.background_dn;
  const double clipped_px = plateau.right - plateau.left + 1;
  const auto half_dn = static_cast<float>(bell.background_dn + 0.5 * seen_dn);
  const double flanks_px = static_cast<double>((pixels.light_dn > half_dn).count());
  const double lit_px = clipped_px + flanks_px;
  const double width_px =
      std::sqrt((lit_px * lit_px - clipped_px * clipped_px) / (8.0 * std::numbers::ln2));
  bell.width_px = std::clamp(width_px, 0.3 * bell.width_px, 1.5 * bell.width_px);
  const double u = 0.5 * clipped_px / bell.width_px;
  bell.amplitude_dn = seen_dn * std::exp(std::min(3.0, 0.5 * u * u));
}

// Covariance of amplitude, place, background and width after Gauss-Newton steps from `bell` to the
// least squares; nothing if they leave for somewhere else.
std::optional<Eigen::Matrix4d> adjust(Bell& bell, const Usable& pixels, const LineScene& scene,
                                      double max_move_px) {
  const double start_px = bell.centre_px;
  const auto usual_width_px = static_cast<double>(scene.width_px);
  const double variance = static_cast<double>(scene.noise_dn) * static_cast<double>(scene.noise_dn);
  Eigen::LLT<Eigen::Matrix4d> solver;
  for (int step = 0; step < 10; ++step) {
    Normal normal = normal_of(pixels, bell);
    // The flanks of a clipped line hardly separate height from width; a prior of the usual width
    // within a third keeps the fit plausible.
    const double trust = variance / std::pow(0.33 * usual_width_px, 2);
    normal.matrix(3, 3) += trust;
    normal.right(3) += trust * (usual_width_px - bell.width_px);
    solver.compute(normal.matrix);
    if (solver.info() != Eigen::Success) return {};
    const Eigen::Vector4d move = solver.solve(normal.right);
    if (!move.allFinite()) return {};
    bell.amplitude_dn =
        std::clamp(bell.amplitude_dn + move(0), 0.5 * bell.amplitude_dn, 2.0 * bell.amplitude_dn);
    bell.centre_px += std::clamp(move(1), -bell.width_px, bell.width_px);
    bell.background_dn += move(2);
    bell.width_px = std::clamp(bell.width_px + move(3), 0.7 * bell.width_px, 1.4 * bell.width_px);
    if (std::abs(bell.centre_px - start_px) > max_move_px) return {};
    if (std::abs(move(1)) < 1e-3 && std::abs(move(3)) < 0.02 * bell.width_px) break;
  }
  return variance * solver.solve(Eigen::Matrix4d::Identity());
}

template <typename Sample>
std::optional<LinePoint> fit(const Sample* row, float column_px, const LineScene& scene) {
  const int nearest =
      std::clamp(static_cast<int>(std::lround(column_px)), scene.first_column, scene.last_column);
  const Plateau plateau = plateau_at(row, nearest, scene);
  const bool clipped = static_cast<float>(row[nearest]) >= scene.saturated_dn;
  const Usable usable = usable_around(row, plateau, scene);
  if (usable.light_dn.size() < 6) return {};

  const auto lowest = static_cast<double>(usable.light_dn.minCoeff());
  const double middle_px = 0.5 * (plateau.left + plateau.right);
  Bell bell{.centre_px = (clipped ? middle_px : static_cast<double>(column_px)) - usable.origin,
            .amplitude_dn = static_cast<double>(usable.light_dn.maxCoeff()) - lowest,
            .width_px = static_cast<double>(scene.width_px),
            .background_dn = lowest};
  if (clipped) complete_clipped(bell, plateau, usable, static_cast<double>(scene.saturated_dn));
  const double max_move_px =
      2.0 + 0.5 * (plateau.right - plateau.left) + static_cast<double>(scene.width_px);
  const auto covariance = adjust(bell, usable, scene, max_move_px);
  if (!covariance) return {};

  // Half of the line must be in the image.
  const double column = usable.origin + bell.centre_px;
  if (column < scene.first_column + 0.5 * bell.width_px ||
      column > scene.last_column - 0.5 * bell.width_px)
    return {};
  // A narrow fit to a few noisy pixels is high but uncertain.
  if (!clipped && bell.amplitude_dn < 5.0 * std::sqrt((*covariance)(0, 0))) return {};
  const double deviation_px = std::sqrt((*covariance)(1, 1));
  if (deviation_px > bell.width_px) return {};
  return LinePoint{.row = 0,
                   .column_px = static_cast<float>(column),
                   .amplitude_dn = static_cast<float>(bell.amplitude_dn),
                   .deviation_px = static_cast<float>(deviation_px)};
}

}  // namespace

float spike_share(const LineScene& scene) {
  return std::min(0.8F, 0.61F / scene.width_px);
}

bool has_spike(const std::uint8_t* row, int column, float height_dn, const LineScene& scene) {
  return spike_near(row, column, height_dn, scene);
}

bool has_spike(const float* row, int column, float height_dn, const LineScene& scene) {
  return spike_near(row, column, height_dn, scene);
}

std::optional<LinePoint> fit_line(const std::uint8_t* row, float column_px,
                                  const LineScene& scene) {
  return fit(row, column_px, scene);
}

std::optional<LinePoint> fit_line(const float* row, float column_px, const LineScene& scene) {
  return fit(row, column_px, scene);
}

}  // namespace tuina::scanner
