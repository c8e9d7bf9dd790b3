// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_table.hpp"

#include <cassert>
#include <string>
#include <vector>

#include "tuina/core/io/csv.hpp"

namespace tuina::sim {

namespace {

constexpr std::size_t offsets = 5;  // columns before those of the build

const CsvTable& phantom_table() {
  static const CsvTable table = [] {
    std::vector<std::string> columns = {"mean", "woman", "per_10_bmi", "prone", "arms_up"};
    for (std::size_t i = 0; i < PhantomShape{}.build.size(); ++i)
      columns.push_back(fmt::format("build_{}", i + 1));
    return parse_csv(phantom_csv(), "models/phantom.csv", columns).value();
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
