// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/atlas/picture.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/grid.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/picture/picture_element.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

namespace palette = telemetry::palette;
using Eigen::Index;

constexpr int tile_px = 150;
constexpr int row_px = 250;
constexpr int shown_modes = 3;
constexpr double deviations = 2.0;

/// The skin between the model's points, as a grid seen from behind.
Mesh grid_over(const body::Places& skin, const body::Places& normals, BodyPosture position) {
  constexpr double cell_m = 4_mm;
  PointCloud cloud;
  for (Index i = 0; i < skin.cols(); ++i) {
    cloud.points.emplace_back(skin.col(i));
    cloud.normals.emplace_back(normals.col(i));
  }
  const body::BackSurface back(std::move(cloud), position, 13_mm);
  const Vector3 low = skin.rowwise().minCoeff();
  const Vector3 high = skin.rowwise().maxCoeff();
  const int columns = static_cast<int>((high.x() - low.x()) / cell_m) + 1;
  const int rows = static_cast<int>((high.z() - low.z()) / cell_m) + 1;
  std::vector<int> number(grid_cells(rows, columns), -1);
  Mesh mesh;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const Vector3 above(low.x() + cell_m * c, 0.8, low.z() + cell_m * r);
      const auto hit = back.along(above, -Vector3::UnitY());
      if (!hit) continue;
      number[grid_index(r, columns, c)] = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(hit->at_in_couch);
    }
  }
  const auto at = [&](int r, int c) { return number[grid_index(r, columns, c)]; };
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      if (std::min({at(r, c), at(r, c + 1), at(r + 1, c), at(r + 1, c + 1)}) < 0) continue;
      // Seen from behind, x runs to the right and z up: counter-clockwise is x before z.
      mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r, c + 1)});
      mesh.triangles.push_back({at(r, c + 1), at(r + 1, c), at(r + 1, c + 1)});
    }
  }
  return mesh;
}

std::string tile(const body::ShapeModel& shape, Index mode, double weight) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(mode + 1);
  weights[mode] = weight;
  const Index n = shape.skin_points();
  telemetry::Scene scene;
  scene.surface = telemetry::mesh_for_picture(
      grid_over(placed(shape, weights, 0, n), shape.normals, shape.position));
  const body::Places points = placed(shape, weights, n, shape.acupoints);
  for (Index i = 0; i < points.cols(); ++i) {
    const bool seven = i < static_cast<Index>(seven_acupoints.size());
    scene.beads.push_back({.at = points.col(i),
                           .radius_m = seven ? 8_mm : 5_mm,
                           .colour = seven ? palette::press : palette::ink});
  }
  // A little from the side, so that depth shows.
  const auto picture = telemetry::shade(scene, {.toward_eye = Vector3(0.25, 1.0, 0.15).normalized(),
                                                .up = Vector3::UnitZ(),
                                                .width_px = 2 * tile_px,
                                                .height_px = 2 * (row_px - 70)});
  return telemetry::picture_element(picture, 0.5 * (tile_px - 0.5 * picture.projection.width_px()));
}

std::string words(double x, double y, std::string_view text, bool strong = false) {
  return fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" fill=\"{}\"{}>{}</text>", x, y,
      telemetry::css(strong ? palette::ink : palette::grey), strong ? " font-weight=\"600\"" : "",
      telemetry::escaped(text));
}

std::string row(const body::ShapeModel& shape, int top_px) {
  const Index modes = std::min<Index>(shown_modes, shape.modes.cols());
  std::string drawn = fmt::format("<g transform=\"translate(0 {})\">", top_px);
  const auto put = [&](int column, Index mode, double weight, const std::string& label) {
    drawn += fmt::format("<g transform=\"translate({} 40)\">{}</g>", column * tile_px,
                         tile(shape, mode, weight));
    drawn += words((column + 0.5) * tile_px, row_px - 12, label);
  };
  drawn += words(0.5 * tile_px, 22,
                 fmt::format("{}, {} bodies", name_of(shape.position), shape.bodies), true);
  put(0, 0, 0.0, "mean");
  for (Index k = 0; k < modes; ++k) {
    const int column = 1 + 2 * static_cast<int>(k);
    const double rms_mm =
        to_mm(shape.modes.col(k).norm() / std::sqrt(static_cast<double>(shape.mean.cols())));
    drawn += words((column + 1) * tile_px, 22,
                   fmt::format("mode {}: {:.0f} mm each standard deviation", k + 1, rms_mm), true);
    put(column, k, -deviations, "\u2212 2 deviations");
    put(column + 1, k, deviations, "+ 2 deviations");
  }
  return drawn + "</g>";
}

}  // namespace

std::string atlas_picture(const body::Atlas& atlas) {
  const int width = (1 + 2 * shown_modes) * tile_px;
  const int height = static_cast<int>(atlas.positions.size()) * row_px;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" "
      "font-size=\"13\"><title>What an atlas knows: {}</title><rect width=\"{}\" height=\"{}\" "
      "fill=\"{}\"/>",
      width, height, telemetry::escaped(atlas.made), width, height, telemetry::css(palette::paper));
  for (std::size_t i = 0; i < atlas.positions.size(); ++i) {
    svg += row(atlas.positions[i].shape, static_cast<int>(i) * row_px);
  }
  return svg + "</svg>\n";
}

}  // namespace tuina::app
