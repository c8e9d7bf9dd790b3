// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "tuina/scanner/triangulation.hpp"
#include "tuina/telemetry/plot/colours.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using namespace calibration;
using telemetry::Colour;
using telemetry::css;
namespace palette = telemetry::palette;

// The corners of the printed squares of one view, in the frame of the camera.
std::array<Vector3, 4> outline(const Transform& camera_from_board, const Board& board) {
  const double right = board.columns * board.square_m;
  const double below = board.rows * board.square_m;
  const double first = -board.square_m;
  return {camera_from_board * Vector3(first, first, 0.0),
          camera_from_board * Vector3(right, first, 0.0),
          camera_from_board * Vector3(right, below, 0.0),
          camera_from_board * Vector3(first, below, 0.0)};
}

Vector3 middle_of(const std::array<Vector3, 4>& corners) {
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

// Near boards warm, far ones cold.
Colour colour_at(double depth_m) {
  const double part = std::clamp((depth_m - 0.5) / 1.25, 0.0, 1.0);
  return telemetry::mix(palette::press, palette::rub, part);
}

std::string polygon(const std::vector<Vector2>& points, Colour colour, double opacity) {
  std::string at;
  for (const Vector2& point : points) at += fmt::format("{:.1f},{:.1f} ", point.x(), point.y());
  return fmt::format(
      "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\" stroke=\"{}\" "
      "stroke-width=\"1\" stroke-opacity=\"0.7\"/>",
      at, css(colour), opacity, css(colour));
}

std::string line(const Vector2& from, const Vector2& to, Colour colour, double width,
                 const char* more = "") {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
      "stroke-width=\"{}\" {}/>",
      from.x(), from.y(), to.x(), to.y(), css(colour), width, more);
}

std::string words(const Vector2& at, const std::string& text, const char* anchor = "start") {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"13\" fill=\"{}\">{}</text>",
      at.x(), at.y(), anchor, css(palette::grey), telemetry::escaped(text));
}

std::string svg(double width, double height, const std::string& title, const std::string& body) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "role=\"img\" font-family=\"system-ui,sans-serif\"><title>{2}</title>"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{3}</svg>",
      width, height, telemetry::escaped(title), body);
}

}  // namespace

std::string boards_in_image(const Calibrated& result, const Views& views) {
  const double scale = 480.0 / std::max(views.width_px, views.height_px);
  const double width = scale * views.width_px;
  const double height = scale * views.height_px;
  std::string body =
      fmt::format("<rect width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#fbfaf8\" stroke=\"{}\"/>",
                  width, height, css(palette::hairline));
  std::string lines;
  std::set<int> drawn;  // a standing board once, however often the unit turned before it
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    if (!drawn.insert(views.views[i].pose).second) continue;
    const auto corners = outline(result.fit.geometry.camera_from_board[i], views.board);
    std::vector<Vector2> seen;
    seen.reserve(corners.size());
    for (const Vector3& corner : corners) {
      seen.emplace_back(scale * scanner::project(result.calibration.camera, corner));
    }
    body += polygon(seen, colour_at(middle_of(corners).z()), 0.02);
    const auto& on_board = views.views[i].line;
    for (std::size_t k = 0; k < on_board.size(); k += 12) {
      lines +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.2\"/>",
                      scale * static_cast<double>(on_board[k].column_px), scale * on_board[k].row);
    }
  }
  body += fmt::format("<g fill=\"{}\">{}</g>", css(palette::ink), lines);
  return svg(width, height, "boards in the image", body);
}

std::string boards_from_above(const Calibrated& result, const Views& views) {
  constexpr double scale = 230.0;  // px per metre
  const auto& calibration = result.calibration;
  double far_m = 1.0;
  double low_m = -0.1;
  double high_m = 0.25;
  std::vector<std::array<Vector3, 4>> boards;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    boards.push_back(outline(result.fit.geometry.camera_from_board[i], views.board));
    for (const Vector3& corner : boards.back()) {
      far_m = std::max(far_m, corner.z() + 0.05);
      low_m = std::min(low_m, corner.x() - 0.03);
      high_m = std::max(high_m, corner.x() + 0.03);
    }
  }
  const double left = 52.0;
  const auto at = [&](double x, double z) {
    return Vector2(left + scale * (x - low_m), 34.0 + scale * (far_m - z));
  };
  const double width = left + scale * (high_m - low_m) + 90.0;
  std::string body;
  for (int quarter = 0; 0.25 * quarter < far_m; ++quarter) {
    const double z = 0.25 * quarter;
    body += line(at(low_m, z), at(high_m, z), palette::hairline, 1.0);
    body += words(at(low_m, z) + Vector2(-8.0, 4.0), fmt::format("{:.2f}", z), "end");
  }
  body += words({4.0, 18.0}, "depth, m");
  for (const auto& corners : boards) {
    std::vector<Vector2> seen;
    seen.reserve(corners.size());
    for (const Vector3& corner : corners) seen.push_back(at(corner.x(), corner.z()));
    body += polygon(seen, colour_at(middle_of(corners).z()), 0.04);
  }
  // Where the light plane cuts the plane of the drawing (y = 0).
  const Vector3& normal = calibration.laser_normal_in_camera;
  const auto light_x_at = [&](double z) {
    return (calibration.laser_distance_m - normal.z() * z) / normal.x();
  };
  body += line(at(light_x_at(0.0), 0.0), at(light_x_at(far_m), far_m), palette::stop, 2.0);
  body += words(at(light_x_at(0.0), 0.0) + Vector2(8.0, 16.0), "laser");
  const auto& camera = calibration.camera;
  for (const double column : {0.0, camera.width_px - 1.0}) {
    const Vector3 ray = scanner::ray_through(camera, column, camera.cy_px);
    body += line(at(0.0, 0.0), at(far_m * ray.x(), far_m), palette::grey, 1.0,
                 "stroke-dasharray=\"4 4\"");
  }
  const Vector2 eye = at(0.0, 0.0);
  body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>", eye.x(), eye.y(),
                      css(palette::ink));
  body += words(eye + Vector2(-6.0, 18.0), "camera", "end");
  const Vector3& axis = calibration.axis_point_in_camera;
  const Vector2 hub = at(axis.x(), axis.z());
  body += fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"white\" stroke=\"{}\" "
      "stroke-width=\"2\"/>",
      hub.x(), hub.y(), css(palette::tap));
  body += words(hub + Vector2(0.0, 18.0), "axis", "middle");
  return svg(width, 34.0 + scale * far_m + 40.0, "boards, light plane and axis from above", body);
}

}  // namespace tuina::app
