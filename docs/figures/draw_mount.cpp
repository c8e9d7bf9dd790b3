// SPDX-License-Identifier: Apache-2.0
// Draws the parts of the scanner's mount, as `tuina export mount` writes them, and how they stand
// together. Usage: draw_mount OUT.svg
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "apps/tuina/mount/scanner_mount.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

constexpr double px_per_m = 2500.0;
constexpr int width_px = 760, height_px = 640;

/// A plate with its origin at a place of the page, y upwards.
struct Placed {
  Vector2 origin_px;
  double scale = px_per_m;
  [[nodiscard]] Vector2 at(const Vector2& point) const {
    return origin_px + scale * Vector2(point.x(), -point.y());
  }
};

std::string outline_of(const Placed& placed, const Plate& plate) {
  std::string path;
  const auto add = [&](const Outline& outline) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector2 at = placed.at(outline[i]);
      path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", at.x(), at.y());
    }
    path += "Z";
  };
  add(plate.outline);
  for (const Outline& window : plate.windows) add(window);
  return fmt::format(
      "<path d=\"{}\" fill=\"#eef2f6\" fill-rule=\"evenodd\" stroke=\"#1f232a\" "
      "stroke-width=\"1.2\"/>",
      path);
}

std::string word(const Vector2& at, const std::string& text, const char* style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>", at.x(), at.y(), style,
                     telemetry::escaped(text));
}

std::string line(const Vector2& from, const Vector2& to, const char* style) {
  return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" {}/>", from.x(), from.y(), to.x(),
                     to.y(), style);
}

/// A dimension between two points of a plate, drawn so far beside it.
std::string dimension(const Placed& placed, const Vector2& from, const Vector2& to,
                      const Vector2& aside_px, const std::string& text) {
  const char* thin = "stroke=\"#707680\" stroke-width=\"0.8\"";
  const Vector2 a = placed.at(from), b = placed.at(to);
  const Vector2 beyond = 1.0 / aside_px.norm() * 4.0 * aside_px;
  return line(a, a + aside_px + beyond, thin) + line(b, b + aside_px + beyond, thin) +
         line(a + aside_px, b + aside_px, thin) +
         word(0.5 * (a + b) + aside_px + Vector2(aside_px.x() != 0.0 ? 6.0 : 0.0, -4.0), text,
              aside_px.x() != 0.0 ? "" : "text-anchor=\"middle\"");
}

std::string draw_bar(const Plate& bar, const MountSizes& sizes) {
  const Placed placed{.origin_px = {380.0, 160.0}};
  const double half_m = 0.5 * sizes.baseline_m;
  const Vector2 camera(-half_m, 0.0), laser(half_m, 0.0);
  const Vector2 beam(-std::sin(sizes.lean_rad), std::cos(sizes.lean_rad));
  std::string svg = outline_of(placed, bar);
  svg += line(placed.at(camera), placed.at(camera + Vector2(0.0, 0.046)),
              "stroke=\"#2258c8\" stroke-dasharray=\"7 3 2 3\" stroke-width=\"1.6\"");
  svg += line(placed.at(laser - 0.016 * beam), placed.at(laser + 0.046 * beam),
              "stroke=\"#d8232f\" stroke-dasharray=\"7 3 2 3\" stroke-width=\"1.6\"");
  svg += word(placed.at(camera + Vector2(0.0, 0.05)), "the camera looks ahead",
              "text-anchor=\"middle\" fill=\"#2258c8\"");
  svg += word(placed.at(laser + 0.05 * beam),
              fmt::format("the laser leans by {:.0f}°", to_deg(sizes.lean_rad)),
              "text-anchor=\"middle\" fill=\"#d8232f\"");
  svg += word(placed.at({0.0, 0.025}), "bar, once", "text-anchor=\"middle\" font-weight=\"600\"");
  svg += dimension(placed, camera, Vector2::Zero(), {0.0, 104.0},
                   fmt::format("{:.0f}", to_mm(half_m)));
  svg +=
      dimension(placed, Vector2::Zero(), laser, {0.0, 104.0}, fmt::format("{:.0f}", to_mm(half_m)));
  const char* green = "text-anchor=\"middle\" fill=\"#1e8c3c\"";
  svg += word(placed.at({-0.5 * half_m, -0.028}), "in the middle the motor's axis", green);
  svg += word(placed.at({0.5 * half_m, -0.028}), "slots for M2, circle of 11 to 19", green);
  Vector2 end = Vector2::Zero();
  for (const Vector2& corner : bar.outline) end = end.cwiseMax(corner);
  const Vector2 left_end(-end.x(), -end.y()), right_end(end.x(), -end.y());
  svg += dimension(placed, left_end, right_end, {0.0, 82.0},
                   fmt::format("{:.0f}", to_mm(2.0 * end.x())));
  svg +=
      dimension(placed, right_end, end, {24.0, 0.0}, fmt::format("{:.0f}", to_mm(2.0 * end.y())));
  return svg;
}

std::string draw_ring(const Plate& ring, const MountSizes& sizes) {
  const Placed placed{.origin_px = {150.0, 460.0}};
  std::string svg = outline_of(placed, ring);
  svg += word(placed.at({0.0, 0.043}), "ring, twice", "text-anchor=\"middle\" font-weight=\"600\"");
  svg += dimension(placed, {0.015, 0.0}, {0.015, 0.02}, {24.0, 0.0}, "20");
  svg += dimension(placed, {-0.015, 0.0}, {0.015, 0.0}, {0.0, 42.0}, "30");
  svg += word(placed.at({0.0, -0.034}),
              fmt::format("hole {:.1f}: the laser's {:.1f} and {:.1f} of play",
                          to_mm(sizes.laser_diameter_m + sizes.play_m),
                          to_mm(sizes.laser_diameter_m), to_mm(sizes.play_m)),
              "text-anchor=\"middle\"");
  svg += word(placed.at({0.0, -0.042}), "its tab stands in a slot of the bar",
              "text-anchor=\"middle\"");
  return svg;
}

std::string draw_shelf(const Plate& shelf) {
  const Placed placed{.origin_px = {480.0, 460.0}};
  std::string svg = outline_of(placed, shelf);
  svg += word(placed.at({0.0, 0.05}), "shelf, once", "text-anchor=\"middle\" font-weight=\"600\"");
  svg += word(placed.at({0.0, 0.0}), "the motor,", "text-anchor=\"middle\"");
  svg += word(placed.at({0.0, -0.008}), "32 x 50", "text-anchor=\"middle\"");
  svg += dimension(placed, {-0.05, -0.045}, {0.05, -0.045}, {0.0, 22.0}, "100");
  svg += dimension(placed, {0.05, -0.045}, {0.05, 0.045}, {24.0, 0.0}, "90");
  return svg;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 1;
  const MountSizes sizes;
  const std::vector<Plate> plates = scanner_mount(sizes);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" aria-label=\"the parts of the scanner's mount\" "
      "font-family=\"Inter,system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif\" "
      "font-size=\"13\" fill=\"#1f232a\"><title>The parts of the scanner's mount</title>"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>",
      width_px, height_px);
  svg += draw_bar(plates[0], sizes) + draw_ring(plates[1], sizes) + draw_shelf(plates[2]);
  svg += word({380.0, 628.0},
              fmt::format("millimetres; the bar from above, the ring along the beam, the shelf "
                          "from the front; all are {:.0f} thick",
                          to_mm(sizes.thickness_m)),
              "text-anchor=\"middle\" fill=\"#707680\"");
  svg += "</svg>\n";
  const auto written = write_file(arguments[1], svg);
  if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return written ? 0 : 1;
}
