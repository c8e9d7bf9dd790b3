// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_table.hpp"

#include <cassert>
#include <string>
#include <vector>

#include "tuina/core/io/csv.hpp"

namespace tuina::sim {

/// Text of models/phantom.csv, which is built in: proportions of the phantoms and their spread, in
/// lengths C7-S2. Means of sitting men of BMI 22, offsets for women, per 10 of BMI, prone, and
/// prone with the arms up, and loadings of twelve principal components, of 160 synthetic people
/// made with MakeHuman (CC0 1.0), half of each sex, BMI 16 to 34, half sitting and half prone.
/// Distances between landmarks, heights of the spinous processes, and depth of the back at 22
/// heights in 9 directions, left and right averaged. docs/bodies.md compares them with
/// anthropometry.
extern const char* const phantom_csv;

namespace {

constexpr std::size_t offsets = 5;  // columns before those of the build

const CsvTable& phantom_table() {
  static const CsvTable table = [] {
    std::vector<std::string> columns = {"mean", "woman", "per_10_bmi", "prone", "arms_up"};
    for (std::size_t i = 0; i < PhantomShape{}.build.size(); ++i)
      columns.push_back(fmt::format("build_{}", i + 1));
    return parse_csv(phantom_csv, "models/phantom.csv", columns).value();
  }();
  assert(table.rows() == table_rows);
  return table;
}

}  // namespace

Proportions proportions_of(const PhantomShape& shape, BodyPosture position) {
  const double prone = position == BodyPosture::prone ? 1.0 : 0.0;
  const double arms_up = shape.arms_up ? prone : 0.0;
  const auto& columns = phantom_table().columns;
  const auto value = [&](std::size_t row) {
    double sum = columns[0][row] + columns[1][row] * (shape.woman ? 1.0 : 0.0) +
                 columns[2][row] * (shape.bmi - 22.0) / 10.0 + columns[3][row] * prone +
                 columns[4][row] * arms_up;
    for (std::size_t i = 0; i < shape.build.size(); ++i)
      sum += columns[offsets + i][row] * shape.build[i];
    return sum;
  };
  Proportions proportions;
  for (std::size_t i = 0; i < measure_count; ++i) proportions.of[i] = value(i);
  std::size_t row = measure_count;
  for (auto& section : proportions.section) {
    for (double& radius : section) radius = value(row++);
  }
  return proportions;
}

}  // namespace tuina::sim
