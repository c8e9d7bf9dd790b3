// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibration_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/telemetry/report_style.hpp"
#include "tuina/telemetry/svg_plot.hpp"

namespace tuina::app {
namespace {

using namespace calibration;
using telemetry::Colour;
using telemetry::css;
namespace palette = telemetry::palette;

constexpr int good_poses = 30;
constexpr int coverage_columns = 3;
constexpr int coverage_rows = 4;
constexpr double odd_one_out = 2.5;  // times the median residual
constexpr double nearest_scan_m = 0.65;
constexpr double farthest_scan_m = 1.75;

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

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string polygon(const std::vector<Vector2>& points, Colour colour, double opacity) {
  std::string at;
  for (const Vector2& point : points) at += fmt::format("{:.1f},{:.1f} ", point.x(), point.y());
  return fmt::format(
      "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\" stroke=\"{}\" stroke-width=\"1.2\"/>",
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
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" role=\"img\" "
      "font-family=\"system-ui,sans-serif\"><title>{2}</title>{3}</svg>",
      width, height, telemetry::escaped(title), body);
}

// Every board as the camera saw it, and the line on it.
std::string image_figure(const Calibrated& result, const Views& views) {
  const double scale = 480.0 / std::max(views.width_px, views.height_px);
  const double width = scale * views.width_px;
  const double height = scale * views.height_px;
  std::string body =
      fmt::format("<rect width=\"{:.0f}\" height=\"{:.0f}\" fill=\"#fbfaf8\" stroke=\"{}\"/>",
                  width, height, css(palette::hairline));
  std::string lines;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const auto corners = outline(result.fit.geometry.camera_from_board[i], views.board);
    std::vector<Vector2> seen;
    for (const Vector3& corner : corners) {
      seen.emplace_back(scale * scanner::project(result.calibration.camera, corner));
    }
    body += polygon(seen, colour_at(middle_of(corners).z()), 0.03);
    const auto& on_board = views.views[i].line;
    for (std::size_t k = 0; k < on_board.size(); k += 12) {
      lines +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"0.9\"/>",
                      scale * static_cast<double>(on_board[k].column_px), scale * on_board[k].row);
    }
  }
  body += fmt::format("<g fill=\"{}\">{}</g>", css(palette::ink), lines);
  return svg(width, height, "boards in the image", body);
}

// Camera, axis, light plane and boards seen along the rows of the image (from above a scanner that
// stands upright).
std::string plan_figure(const Calibrated& result, const Views& views) {
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
  for (double z = 0.0; z < far_m; z += 0.25) {
    body += line(at(low_m, z), at(high_m, z), palette::hairline, 1.0);
    body += words(at(low_m, z) + Vector2(-8.0, 4.0), fmt::format("{:.2f}", z), "end");
  }
  body += words({4.0, 18.0}, "depth, m");
  for (const auto& corners : boards) {
    std::vector<Vector2> seen;
    for (const Vector3& corner : corners) seen.push_back(at(corner.x(), corner.z()));
    body += polygon(seen, colour_at(middle_of(corners).z()), 0.06);
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

// Parts of the image in which no corner was ever seen.
std::string uncovered(const Views& views) {
  std::array<std::array<bool, coverage_columns>, coverage_rows> seen{};
  for (const View& view : views.views) {
    for (const Vector2& corner : view.corners_px) {
      const auto part = [](double at, int size, int parts) {
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>(at * parts / size), 0, parts - 1));
      };
      seen[part(corner.y(), views.height_px, coverage_rows)]
          [part(corner.x(), views.width_px, coverage_columns)] = true;
    }
  }
  constexpr std::array<const char*, coverage_rows> heights = {"top", "upper middle", "lower middle",
                                                              "bottom"};
  constexpr std::array<const char*, coverage_columns> sides = {"left", "middle", "right"};
  std::string missing;
  for (std::size_t y = 0; y < seen.size(); ++y) {
    for (std::size_t x = 0; x < seen[y].size(); ++x) {
      if (seen[y][x]) continue;
      missing += fmt::format("{}{} {}", missing.empty() ? "" : ", ", heights[y], sides[x]);
    }
  }
  return missing;
}

}  // namespace

std::vector<std::string> advice(const Calibrated& result, const Views& views) {
  std::vector<std::string> sentences;
  std::vector<double> depths;
  std::vector<double> corners;
  std::vector<double> lines;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    corners.push_back(residual.reprojection_px);
    if (residual.line_points == 0) continue;
    lines.push_back(residual.line_px);
    depths.push_back(result.fit.geometry.camera_from_board[i].translation().z());
  }
  std::set<int> odd;
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const ViewResidual& residual = result.fit.residuals[i];
    if (residual.reprojection_px > odd_one_out * median(corners) ||
        residual.line_px > odd_one_out * median(lines)) {
      odd.insert(views.views[i].pose);
    }
  }
  if (!odd.empty()) {
    sentences.push_back(
        fmt::format("Pose {} agrees with the rest less than it should: blurred, moved between its "
                    "two pictures, "
                    "or another lamp? Take it again.",
                    fmt::join(odd, ", ")));
  }
  if (result.poses < good_poses) {
    sentences.push_back(fmt::format(
        "{} poses with board and laser; the error shrinks with their number, 40 are good.",
        result.poses));
  }
  const auto [near, far] = std::minmax_element(depths.begin(), depths.end());
  if (*near > nearest_scan_m) {
    sentences.push_back(fmt::format("No board was nearer than {:.2f} m: hold some at {} m.", *near,
                                    nearest_scan_m));
  }
  if (*far < 0.9 * farthest_scan_m) {
    sentences.push_back(fmt::format(
        "No board was farther than {:.2f} m: beyond it the range is only a guess.", *far));
  }
  if (const std::string missing = uncovered(views); !missing.empty()) {
    sentences.push_back(
        fmt::format("No corner was ever seen in these parts of the image: {}.", missing));
  }
  const auto lost = static_cast<std::size_t>(views.board_pictures) - views.views.size();
  if (lost > 0) {
    sentences.push_back(fmt::format("The board was not found in {} of {} pictures of it.", lost,
                                    views.board_pictures));
  }
  sentences.insert(sentences.end(), result.remarks.begin(), result.remarks.end());
  return sentences;
}

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
      tiles(result), next, image_figure(result, views), plan_figure(result, views),
      residual_figure(result, views, false), residual_figure(result, views, true),
      poses_table(result, views), numbers_table(result));
}

}  // namespace tuina::app
