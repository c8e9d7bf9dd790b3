// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/tuina/calibrate/figures.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using namespace calibration;
namespace palette = telemetry::palette;

std::string residual_figure(const Calibrated& result, const Views& views, bool of_line) {
  telemetry::Series dots{
      .name = {}, .colour = of_line ? palette::stop : palette::rub, .dots = true};
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    if (of_line && residual.line_points == 0) continue;
    dots.x.push_back(result.fit.geometry.camera_from_board[i].translation().z());
    dots.y.push_back(of_line ? to_mm(residual.line_m) : residual.reprojection_px);
  }
  return to_svg(
      telemetry::Plot{.title = of_line ? "line of each pose" : "corners of each picture",
                      .x_label = "distance of the board, m",
                      .y_label = of_line ? "line off the light plane, mm RMS" : "corners, px RMS",
                      .series = {dots},
                      .y_low = 0.0,
                      .width_px = 520,
                      .height_px = 230});
}

std::vector<telemetry::KeyNumber> tiles(const Calibrated& result) {
  std::vector<telemetry::KeyNumber> tiles;
  for (std::size_t i = 0; i < result.expected.size(); ++i) {
    const auto& error = result.expected[i];
    if (!error) continue;
    tiles.push_back({fmt::format("Range error at {} m", reported_depths_m[i]),
                     fmt::format("{:.2f}", to_mm(error->total_m())), "mm",
                     fmt::format("{:.2f} the same in every scan, {:.2f} noise of the line",
                                 to_mm(error->systematic_m), to_mm(error->random_m))});
  }
  tiles.push_back(
      {"Corners", fmt::format("{:.3f}", result.reprojection_px), "px", "RMS off the fit"});
  tiles.push_back({"Line on boards", fmt::format("{:.2f}", to_mm(result.laser_rms_m)), "mm",
                   "RMS off the light plane"});
  const auto& latency = result.latency;
  tiles.push_back({"Latency", latency ? fmt::format("{:.1f}", 1e3 * latency->latency_s) : "?", "ms",
                   latency ? fmt::format("± {:.1f}", 1e3 * latency->deviation_s) : "not measured"});
  return tiles;
}

telemetry::Table numbers_table(const Calibrated& result) {
  telemetry::Table table{.columns = {{.head = "Quantity"},
                                     {.head = "Value"},
                                     {.head = "Standard deviation"},
                                     {.head = "Unit"}}};
  const auto add = [&](const char* name, double value, double deviation, const char* unit,
                       int digits) {
    table.add({name, fmt::format("{:.{}f}", value, digits),
               fmt::format("{:.{}f}", deviation, digits), unit});
  };
  const auto& camera = result.calibration.camera;
  const auto of = [&](int i) { return std::sqrt(result.fit.covariance(i, i)); };
  add("Focal length along columns", camera.fx_px, of(fx), "px", 2);
  add("Focal length along rows", camera.fy_px, of(fy), "px", 2);
  add("Centre, column", camera.cx_px, of(cx), "px", 2);
  add("Centre, row", camera.cy_px, of(cy), "px", 2);
  add("Distortion k1", camera.distortion[0], of(k1), "", 4);
  add("Distortion k2", camera.distortion[1], of(k2), "", 4);
  const Matrix3 light = result.fit.covariance.block<3, 3>(light_x, light_x);
  const Vector3& normal = result.calibration.laser_normal_in_camera;
  const double d = result.calibration.laser_distance_m;
  add("Light plane from the camera", to_mm(d), to_mm(d * d * std::sqrt(normal.dot(light * normal))),
      "mm", 3);
  add("Yaw axis from the camera", to_mm(result.calibration.axis_point_in_camera.norm()),
      to_mm(std::hypot(of(axis_shift_1), of(axis_shift_2))), "mm", 2);
  if (const auto& couch = result.couch) {
    add("Camera over the couch", to_mm(couch->couch_from_camera.translation().z()),
        to_mm(couch->height_deviation_m), "mm", 2);
    const double sight_up = couch->couch_from_camera.linear()(2, 2);
    add("Its sight, off from straight down", to_deg(std::acos(std::clamp(-sight_up, -1.0, 1.0))),
        to_deg(couch->tilt_deviation_rad), "deg", 3);
  }
  return table;
}

telemetry::Table poses_table(const Calibrated& result, const Views& views) {
  telemetry::Table table{.columns = {{.head = "Picture"},
                                     {.head = "Pose"},
                                     {.head = "Yaw, deg", .digits = 1},
                                     {.head = "Distance, m", .digits = 2},
                                     {.head = "Tilt, deg", .digits = 0},
                                     {.head = "Corners, px", .digits = 3},
                                     {.head = "Line, mm", .digits = 2}}};
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    const Transform& pose = result.fit.geometry.camera_from_board[i];
    table.add({fmt::format("{:06}.png", views.views[i].frame), views.views[i].pose,
               to_deg(views.views[i].yaw_rad), pose.translation().z(),
               to_deg(std::acos(std::min(1.0, std::abs(pose.linear()(2, 2))))),
               residual.reprojection_px,
               residual.line_points > 0 ? to_mm(residual.line_m) : std::nan("")});
  }
  return table;
}

}  // namespace

std::string calibration_report(const Calibrated& result, const Views& views,
                               const std::string& folder) {
  telemetry::Page page({.title = "Calibration of " + folder,
                        .over = "tuina calibrate",
                        .heading = "The scanner, measured",
                        .meta = fmt::format("{}: {} poses with board and laser, {} pictures of the "
                                            "board",
                                            folder, result.poses, views.board_pictures)});
  page.opening().tiles(tiles(result));
  page.section("What to improve next").list(advice(result, views));
  page.section(
          "Where the boards were",
          "Red boards were near, blue ones far. Left: what the camera saw, with the laser line "
          "dotted on the boards. Right: the same from above, with the light plane in red and "
          "the view of the camera dashed.")
      .figures(
          {{.svg = boards_in_image(result, views)}, {.svg = boards_from_above(result, views)}});
  page.section("How well each agrees",
               "One dot per picture. A dot far above the others is a picture to take again.")
      .figures({{.svg = residual_figure(result, views, false)},
                {.svg = residual_figure(result, views, true)}})
      .folded("Every picture", telemetry::Part().table(poses_table(result, views)));
  page.section("What was found", "Each number with the standard deviation that the pictures leave.")
      .table(numbers_table(result));
  return page.str();
}

}  // namespace tuina::app
