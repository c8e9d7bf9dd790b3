// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/tuina/calibrate/figures.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/style.hpp"

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

std::string tile(const std::string& label, const std::string& value, const std::string& unit,
                 const std::string& remark) {
  return fmt::format(
      "<div class=\"tile\"><span "
      "class=\"label\">{}</span><b>{}<small>{}</small></b><i>{}</i></div>",
      label, value, unit, remark);
}

std::string tiles(const Calibrated& result) {
  std::string text;
  for (std::size_t i = 0; i < result.expected.size(); ++i) {
    const auto& error = result.expected[i];
    if (!error) continue;
    text += tile(fmt::format("Range error at {} m", told_depths_m[i]),
                 fmt::format("{:.2f}", to_mm(error->total_m())), "mm",
                 fmt::format("{:.2f} the same in every scan, {:.2f} noise of the line",
                             to_mm(error->systematic_m), to_mm(error->random_m)));
  }
  text += tile("Corners", fmt::format("{:.3f}", result.reprojection_px), "px", "RMS off the fit");
  text += tile("Line on boards", fmt::format("{:.2f}", to_mm(result.laser_rms_m)), "mm",
               "RMS off the light plane");
  text += tile("Latency",
               result.latency ? fmt::format("{:.1f}", 1e3 * result.latency->latency_s) : "?", "ms",
               result.latency ? fmt::format("&plusmn; {:.1f}", 1e3 * result.latency->deviation_s)
                              : "not measured");
  return "<div class=\"tiles\">" + text + "</div>";
}

std::string number_row(const char* name, double value, double deviation, const char* unit,
                       int digits) {
  return fmt::format("<tr><td>{}</td><td>{:.{}f}</td><td>{:.{}f}</td><td class=\"l\">{}</td></tr>",
                     name, value, digits, deviation, digits, unit);
}

std::string numbers_table(const Calibrated& result) {
  const auto& camera = result.calibration.camera;
  const auto of = [&](int i) { return std::sqrt(result.fit.covariance(i, i)); };
  std::string rows = number_row("Focal length along columns", camera.fx_px, of(fx), "px", 2) +
                     number_row("Focal length along rows", camera.fy_px, of(fy), "px", 2) +
                     number_row("Centre, column", camera.cx_px, of(cx), "px", 2) +
                     number_row("Centre, row", camera.cy_px, of(cy), "px", 2) +
                     number_row("Distortion k1", camera.distortion[0], of(k1), "", 4) +
                     number_row("Distortion k2", camera.distortion[1], of(k2), "", 4);
  const Matrix3 light = result.fit.covariance.block<3, 3>(light_x, light_x);
  const Vector3& normal = result.calibration.laser_normal_in_camera;
  const double d = result.calibration.laser_distance_m;
  rows += number_row("Light plane from the camera", to_mm(d),
                     to_mm(d * d * std::sqrt(normal.dot(light * normal))), "mm", 3);
  rows +=
      number_row("Yaw axis from the camera", to_mm(result.calibration.axis_point_in_camera.norm()),
                 to_mm(std::hypot(of(axis_shift_1), of(axis_shift_2))), "mm", 2);
  if (const auto& couch = result.couch) {
    rows += number_row("Camera over the couch", to_mm(couch->couch_from_camera.translation().z()),
                       to_mm(couch->height_deviation_m), "mm", 2);
    const double sight_up = couch->couch_from_camera.linear()(2, 2);
    rows += number_row("Its sight, off from straight down",
                       to_deg(std::acos(std::clamp(-sight_up, -1.0, 1.0))),
                       to_deg(couch->tilt_deviation_rad), "deg", 3);
  }
  return "<table><tr><th>Quantity</th><th>Value</th><th>Standard deviation</th><th class=\"l\">"
         "Unit</th></tr>" +
         rows + "</table>";
}

std::string poses_table(const Calibrated& result, const Views& views) {
  std::string rows;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    const Transform& pose = result.fit.geometry.camera_from_board[i];
    rows += fmt::format(
        "<tr><td>{:06}.png</td><td>{}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.0f}</td><td>{:.3f}"
        "</td><td>{}</td></tr>",
        views.views[i].frame, views.views[i].pose, to_deg(views.views[i].yaw_rad),
        pose.translation().z(), to_deg(std::acos(std::min(1.0, std::abs(pose.linear()(2, 2))))),
        residual.reprojection_px,
        residual.line_points > 0 ? fmt::format("{:.2f}", to_mm(residual.line_m)) : "&ndash;");
  }
  return "<details><summary>Every picture</summary><table><tr><th>Picture</th><th>Pose</th>"
         "<th>Yaw, deg</th><th>Distance, m</th><th>Tilt, deg</th><th>Corners, px</th>"
         "<th>Line, mm</th></tr>" +
         rows + "</table></details>";
}

}  // namespace

std::string calibration_report(const Calibrated& result, const Views& views,
                               const std::string& folder) {
  std::string next;
  for (const std::string& sentence : advice(result, views)) {
    next += "<li>" + telemetry::escaped(sentence) + "</li>";
  }
  if (next.empty()) {
    next =
        "<li>Nothing stands out. Scan an object of known size to be sure of sign and scale.</li>";
  }
  return fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>Calibration of {0}</title><style>{1}"
      "</style></head><body><main><div class=\"over\">tuina calibrate</div><h1>The scanner, "
      "measured</h1><p class=\"meta\">{0}: {2} poses with board and laser, {3} pictures of the "
      "board</p>{4}"
      "<section><h2>What to improve next</h2><ul>{5}</ul></section>"
      "<section><h2>Where the boards were</h2><p>Red boards were near, blue ones far. Left: what "
      "the camera saw, with the laser line dotted on the boards. Right: the same from above, with "
      "the light plane in red and the view of the camera dashed.</p><div class=\"even\">{6}{7}"
      "</div></section>"
      "<section><h2>How well each agrees</h2><p>One dot per picture. A dot far above the others "
      "is a picture to take again.</p><div class=\"even\">{8}{9}</div>{10}</section>"
      "<section><h2>What was found</h2><p>Each number with the standard deviation that the "
      "pictures leave.</p>{11}</section></main></body></html>\n",
      telemetry::escaped(folder), telemetry::report_style, result.poses, views.board_pictures,
      tiles(result), next, boards_in_image(result, views), boards_from_above(result, views),
      residual_figure(result, views, false), residual_figure(result, views, true),
      poses_table(result, views), numbers_table(result));
}

}  // namespace tuina::app
