// SPDX-License-Identifier: Apache-2.0
// Draws docs/figures/scanner.svg: the scanner seen along its yaw axis, with the dimensions and the
// equations that the code uses. Usage: draw_scanner OUT.svg
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

using namespace tuina;

namespace {

constexpr double px_per_m = 470.0;
constexpr double left_px = 250.0;
constexpr double top_px = 70.0;

// Camera x runs to the right of the drawing, z downwards.
Vector2 on_page(double x_m, double z_m) {
  return {left_px + px_per_m * x_m, top_px + px_per_m * z_m};
}

std::string line(const Vector2& from, const Vector2& to, const char* style) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" {}/>", from.x(), from.y(), to.x(),
                     to.y(), style);
}

std::string word(const Vector2& at, const std::string& text, const char* style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>", at.x(), at.y(), style,
                     telemetry::escaped(text));
}

std::string dot(const Vector2& at, double radius_px, const char* colour) {
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>", at.x(),
                     at.y(), radius_px, colour);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 1;
  const auto unit = sim::true_calibration(BodyPosture::sitting);
  const auto& camera = unit.camera;
  const Vector3& n = unit.laser_normal_in_camera;
  const auto light_x = [&](double z_m) { return (unit.laser_distance_m - n.z() * z_m) / n.x(); };
  const auto ray_x = [&](double column, double z_m) {
    return (column - camera.cx_px) / camera.fx_px * z_m;
  };
  constexpr double wall_m = 1.1;
  const double column = scanner::project(camera, {light_x(wall_m), 0.0, wall_m}).x();
  const Vector2 eye = on_page(0.0, 0.0);
  const Vector2 laser = on_page(light_x(0.0), 0.0);
  const Vector2 axis = on_page(unit.axis_point_in_camera.x(), unit.axis_point_in_camera.z());
  const Vector2 point = on_page(light_x(wall_m), wall_m);

  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 640\" width=\"760\" "
      "height=\"640\" role=\"img\" aria-label=\"the scanner seen along its axis\" "
      "font-family=\"Inter,system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif\" "
      "font-size=\"13\" fill=\"#1f232a\"><title>The scanner seen along its yaw axis</title>"
      "<rect width=\"760\" height=\"640\" fill=\"#fff\"/>";
  // What the camera sees, the light plane, and the wall.
  svg += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" fill=\"#eef2f6\"/>",
                     eye.x(), eye.y(), on_page(ray_x(0.0, wall_m), 0).x(), on_page(0, wall_m).y(),
                     on_page(ray_x(camera.width_px - 1.0, wall_m), 0).x(), on_page(0, wall_m).y());
  svg +=
      line(on_page(-0.36, wall_m), on_page(0.36, wall_m), "stroke=\"#8a929c\" stroke-width=\"6\"");
  svg += word(on_page(0.375, wall_m) + Vector2(0, 4), fmt::format("wall at z = {:.1f} m", wall_m));
  svg += line(eye, on_page(0.0, wall_m), "stroke=\"#8a929c\" stroke-dasharray=\"7 3 2 3\"");
  svg += line(laser, on_page(light_x(wall_m + 0.08), wall_m + 0.08),
              "stroke=\"#d8232f\" stroke-width=\"2.4\"");
  svg += line(eye, point, "stroke=\"#2258c8\" stroke-width=\"1.8\"");
  svg += line(eye, laser, "stroke=\"#1f232a\"");
  svg += dot(eye, 6, "#2258c8") + dot(laser, 6, "#d8232f") + dot(point, 5, "#1f232a");
  svg += fmt::format(
      "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7\" fill=\"#fff\" stroke=\"#1e8c3c\" "
      "stroke-width=\"2\"/><circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"2.2\" fill=\"#1e8c3c\"/>"
      "<path d=\"M{2:.1f} {3:.1f}a26 26 0 0 1 44 0\" fill=\"none\" stroke=\"#1e8c3c\" "
      "stroke-width=\"1.6\"/>",
      axis.x(), axis.y(), axis.x() - 22, axis.y() - 14);
  // Names and sizes.
  const char* middle = "text-anchor=\"middle\"";
  const char* right = "text-anchor=\"end\"";
  svg += word(eye + Vector2(-12, 4), "camera", right);
  svg += word(laser + Vector2(12, 4),
              fmt::format("laser, {:.0f} mm aside, the axis half way", to_mm(light_x(0.0))));
  svg += word(axis + Vector2(0, -32), "yaw axis, psi", middle);
  svg += word(laser + Vector2(-22, 62), "73°", right);
  svg += word(on_page(0.0, 0.62) + Vector2(-8, 0), "z", right);
  svg += word(0.5 * (eye + point) + Vector2(-14, 30), "ray r of column u", right);
  svg += word(on_page(light_x(0.5), 0.5) + Vector2(12, 0), "light plane n · X = d",
              "fill=\"#d8232f\"");
  svg += word(point + Vector2(-10, 24),
              fmt::format("X, column {:.0f} of {}", column, camera.width_px), right);
  // The equations, in the order in which a pixel becomes a point.
  const double per_px_m = scanner::range_m_per_px(unit, {light_x(wall_m), 0.0, wall_m});
  const std::vector<std::string> equations = {
      "r = ((u - cx)/fx, (v - cy)/fy, 1)",
      "X = r d / (n · r)",
      "P = couch_from_camera · turn(psi) · X",
      fmt::format("one pixel is {:.1f} mm of range here", to_mm(per_px_m)),
      fmt::format("fx = fy = {:.1f} px, d = {:.1f} mm", camera.fx_px, to_mm(unit.laser_distance_m)),
      fmt::format("n = ({:.3f}, {:.0f}, {:.3f})", n.x(), n.y(), n.z())};
  for (std::size_t i = 0; i < equations.size(); ++i) {
    svg += word({480.0, 150.0 + 26.0 * static_cast<double>(i)}, equations[i],
                i < 3 ? "font-size=\"14\"" : "fill=\"#707680\"");
  }
  svg += "</svg>\n";
  const auto written = write_file(arguments[1], svg);
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written ? 0 : 1;
}
