// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/heat_map.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace tuina::telemetry;

TEST_CASE("a map writes each value into its cell and `stop` where there is no end to it") {
  const HeatMap map{.title = "five & more",
                    .x_label = "x",
                    .y_label = "y",
                    .x_ticks = {"1", "2"},
                    .y_ticks = {"a", "b"},
                    .values = {0.04, 12.3, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()}};
  const std::string svg = to_svg({map, map});
  const auto has = [&](const char* words) { return svg.find(words) != std::string::npos; };
  CHECK(has(">0.0<"));
  CHECK(has(">12<"));
  CHECK(has(">stop<"));
  CHECK(has("five &amp; more"));
  CHECK_FALSE(has("nan"));
  std::size_t cells = 0;
  for (std::size_t at = svg.find("<rect"); at != std::string::npos; at = svg.find("<rect", at + 1))
    ++cells;
  CHECK(cells == 6);
}
