// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/tables.hpp"

#include <fmt/format.h>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using telemetry::Cell;
using telemetry::Column;
using telemetry::Table;

std::vector<Column> back_columns(Column first) {
  return {std::move(first),
          {.head = "RMS, mm", .key = "rms_mm", .digits = 2},
          {.head = "bias, mm", .key = "bias_mm", .digits = 2},
          {.head = "the scan expects, mm", .key = "expected_mm", .digits = 2},
          {.head = "outliers, %", .key = "outliers_percent", .digits = 3},
          {.head = "seen, %", .key = "seen_percent", .digits = 2},
          {.head = "acupoints covered, %", .key = "acupoints_covered_percent", .digits = 1},
          {.key = "refused"},
          {.head = " "}};
}

void add_back(Table& table, Cell first, const BackTrial& back) {
  if (back.refused) {
    table.add({std::move(first), {}, {}, {}, {}, {}, {}, true, "refused"});
  } else {
    table.add({std::move(first),
               to_mm(back.rms_m),
               to_mm(back.bias_m),
               to_mm(back.expected_m),
               100.0 * back.outlier_share,
               100.0 * back.seen_share,
               100.0 * back.covered_points,
               {},
               {}});
  }
}

}  // namespace

Table wall_table(const std::vector<WallTrial>& walls) {
  Table table{.title = "A wall, near and far",
              .columns = {{.head = "distance, m", .key = "depth_m", .digits = 2},
                          {.head = "nominal, mm", .key = "nominal.rms_mm", .digits = 2},
                          {.key = "nominal.systematic_mm"},
                          {.key = "nominal.random_mm"},
                          {.head = "fitted, mm", .key = "fitted.rms_mm", .digits = 2},
                          {.key = "fitted.systematic_mm"},
                          {.key = "fitted.random_mm"},
                          {.head = "tuina, mm", .key = "tuina.rms_mm", .digits = 2},
                          {.head = "systematic, mm", .key = "tuina.systematic_mm", .digits = 2},
                          {.head = "random, mm", .key = "tuina.random_mm", .digits = 2},
                          {.head = "predicted, mm", .key = "predicted_random_mm", .digits = 2},
                          {.head = "line, px", .key = "line_px", .digits = 3},
                          {.head = "bound, px", .key = "bound_px", .digits = 3}}};
  for (const WallTrial& wall : walls) {
    table.add({wall.depth_m, to_mm(wall.nominal.rms_m), to_mm(wall.nominal.systematic_m),
               to_mm(wall.nominal.random_m), to_mm(wall.fitted.rms_m),
               to_mm(wall.fitted.systematic_m), to_mm(wall.fitted.random_m), to_mm(wall.ours.rms_m),
               to_mm(wall.ours.systematic_m), to_mm(wall.ours.random_m), to_mm(wall.predicted_m),
               wall.line_px, wall.bound_px});
  }
  return table;
}

Table back_table(const std::map<std::string, BackTrial>& backs) {
  Table table{.title = "A back at 1.1 m", .columns = back_columns({.head = "condition"})};
  for (const auto& [name, back] : backs) add_back(table, name, back);
  return table;
}

Table curve_table(const Curve& curve) {
  Table table{.title = curve.name, .columns = back_columns({.head = curve.x_label, .key = "x"})};
  for (std::size_t i = 0; i < curve.x.size(); ++i) add_back(table, curve.x[i], curve.y[i]);
  return table;
}

Table target_table(const std::vector<Target>& targets) {
  Table table{.title = "What was wanted",
              .columns = {{.head = "target", .key = "name"},
                          {.head = "at least", .key = "at_least"},
                          {.head = "at most", .key = "at_most"},
                          {.head = "measured", .key = "measured", .digits = 3},
                          {.key = "reached"},
                          {.head = " "}}};
  for (const Target& target : targets) {
    table.add({target.name, target.at_least ? Cell(target.wanted) : Cell(),
               target.at_least ? Cell() : Cell(target.wanted), target.measured, target.reached(),
               target.reached() ? "reached" : "NOT REACHED"});
  }
  return table;
}

std::string sentence_of(const scanner::FoundBox& box) {
  return fmt::format(
      "The box of the thesis, 150 x 150 x 200 mm, a corner towards the scanner at 1 m: edges "
      "{:.2f}, {:.2f} and {:.2f} mm, angles {:.2f}, {:.2f} and {:.2f} degrees, faces flat to "
      "{:.2f} mm.",
      to_mm(box.edges_m[0]), to_mm(box.edges_m[1]), to_mm(box.edges_m[2]),
      to_deg(box.angles_rad[0]), to_deg(box.angles_rad[1]), to_deg(box.angles_rad[2]),
      to_mm(box.flatness_m));
}

std::string sentence_of(const scanner::FoundSphere& sphere) {
  return fmt::format("A sphere of 75 mm radius at 1 m: radius {:.2f} mm, round to {:.2f} mm.",
                     to_mm(0.5 * sphere.diameter_m), to_mm(sphere.rms_m));
}

}  // namespace tuina::app
