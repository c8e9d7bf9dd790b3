// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/fixed_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/cli/command_line.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

std::optional<Vector3> place_in(std::string_view numbers) {
  Vector3 at;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = axis < 2 ? numbers.find(',') : numbers.size();
    if (comma == std::string_view::npos) return std::nullopt;
    const auto value = to_number<double>(numbers.substr(0, comma));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    at[axis] = *value;
    numbers.remove_prefix(std::min(numbers.size(), comma + 1));
  }
  return at;
}

}  // namespace

void FixedPoints::describe(Options& options) {
  auto fix = options
                 .add("--fix", words,
                      "NAME=x,y,z: where a finger has found this point, in metres and the "
                      "frame of the scan; the other points follow; may be repeated")
                 .one_word_each();
  options
      .add("--fix-error-mm", error_mm,
           "standard deviation of the finger in each direction of the skin")
      .between(0.0, 30.0)
      .needs(fix)
      .show_default();
}

Result<std::vector<body::PalpatedPoint>> FixedPoints::read() const {
  std::vector<body::PalpatedPoint> points;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const auto at = equals == std::string::npos
                        ? std::nullopt
                        : place_in(std::string_view(word).substr(equals + 1));
    if (!at || equals == 0) {
      return fail(Fault::usage, "--fix {}: NAME=x,y,z is needed, such as BL18_L=0.056,0.055,0.449",
                  in_quotes(word));
    }
    const std::string name = word.substr(0, equals);
    if (std::any_of(points.begin(), points.end(), [&](const auto& p) { return p.name == name; }))
      return fail(Fault::usage, "--fix: {} is fixed twice", in_quotes(name));
    points.push_back({.name = name, .at_in_couch = *at, .error_m = from_mm(error_mm)});
  }
  return points;
}

}  // namespace tuina::app
