// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/plot/svg_timeline.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/telemetry/words.hpp"

using namespace tuina::telemetry;
using tuina::tests::count;

TEST_CASE("the ticks of an axis are round numbers within it") {
  CHECK(ticks(0.0, 10.0, 5) == std::vector<double>{0.0, 2.0, 4.0, 6.0, 8.0, 10.0});
  CHECK(ticks(-1.0, 1.0, 4) == std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0});
  for (const double low : {-3e-7, 0.0, 17.3, 1e6}) {
    for (const double span : {1e-6, 0.37, 42.0, 1e9}) {
      const auto at = ticks(low, low + span, 5);
      CHECK(at.size() >= 2);
      CHECK(at.size() <= 12);
      CHECK(at.front() >= low - 1e-6 * span);
      CHECK(at.back() <= low + span * (1 + 1e-6));
    }
  }
}

TEST_CASE("a plot of a hundred thousand points is small and keeps a single spike") {
  Series series{.name = "force"};
  for (int k = 0; k < 100000; ++k) {
    series.x.push_back(k * 1e-3);
    series.y.push_back(k == 54321 ? 99.0 : std::sin(k * 1e-3));
  }
  const std::string svg = to_svg(Plot{.title = "t",
                                      .x_label = "time, s",
                                      .y_label = "force, N",
                                      .series = {series},
                                      .y_low = 0.0,
                                      .y_high = 100.0});
  CHECK(svg.size() < 100'000);
  // The spike is at 99 % of a frame that is 196 px high and begins at 24.
  CHECK(svg.find("26.0L") != std::string::npos);
}

TEST_CASE("a value that is not a number interrupts the line and appears nowhere") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Series series{.name = "", .x = {0, 1, 2, 3, 4}, .y = {1, 2, nan, 2, 1}};
  const std::string svg =
      to_svg(Plot{.title = "t", .x_label = "x", .y_label = "y", .series = {series}});
  CHECK(svg.find("nan") == std::string::npos);
  const auto path = svg.substr(svg.rfind("<path"));
  CHECK(count(path, "M") == 2);
}

TEST_CASE("a legend that does not fit beside the name of the y axis has a row of its own") {
  const auto drawn = [](const std::string& name) {
    return to_svg(Plot{.title = "t",
                       .x_label = "x",
                       .y_label = "true force, N",
                       .series = {{.name = name, .x = {0.0, 1.0}, .y = {0.0, 1.0}}}});
  };
  CHECK(drawn("short").find("translate(0 15)") == std::string::npos);
  CHECK(drawn(std::string(120, 'w')).find("translate(0 15)") != std::string::npos);
}

TEST_CASE("a dot on the edge of a plot is drawn whole") {
  Plot plot{.title = "t", .x_label = "x", .y_label = "y"};
  plot.series = {{.name = "s", .x = {0.0, 0.5, 1.0}, .y = {0.0, 1.0, 0.5}}};
  plot.series.front().dots = true;
  plot.y_low = 0.0, plot.y_high = 1.0;
  const std::string svg = to_svg(plot), clip = svg.substr(svg.rfind("<svg"));
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
  REQUIRE(std::sscanf(clip.c_str(), R"(<svg x="%lf" y="%lf" width="%lf" height="%lf")", &left, &top,
                      &width, &height) == 4);
  constexpr double rounding = 0.11;
  std::size_t dots = 0;
  for (auto at = clip.find("<circle"); at != clip.npos; at = clip.find("<circle", at + 1), ++dots) {
    double x = 0.0, y = 0.0, radius = 0.0;
    REQUIRE(std::sscanf(clip.c_str() + at, R"(<circle cx="%lf" cy="%lf" r="%lf")", &x, &y,
                        &radius) == 3);
    CHECK(x - radius > left - rounding);
    CHECK(x + radius < left + width + rounding);
    CHECK(y - radius > top - rounding);
    CHECK(y + radius < top + height + rounding);
  }
  CHECK(dots == 3);
}

TEST_CASE("plots without data, with one point and with equal values are still drawings") {
  for (const auto& y :
       {std::vector<double>{}, std::vector<double>{5.0}, std::vector<double>{0.0}}) {
    const std::vector<double> x(y.size(), 1.0);
    const std::string svg = to_svg(Plot{
        .title = "t", .x_label = "x", .y_label = "y", .series = {{.name = "s", .x = x, .y = y}}});
    CHECK(svg.starts_with("<svg"));
    CHECK(svg.ends_with("</svg>"));
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
  }
}

TEST_CASE("a timeline shows each span with its place in time, and a stop") {
  const Timeline timeline{
      .title = "arms",
      .end_s = 100.0,
      .rows = {{.name = "left", .spans = {{10.0, 20.0, "BL47 L", palette::press}}}},
      .marks = {{.x = 50.0, .text = "stop", .colour = palette::stop}}};
  const std::string svg = to_svg(timeline);
  CHECK(svg.find("BL47 L (10.0 – 20.0 s)") != std::string::npos);
  CHECK(svg.find(">stop<") != std::string::npos);
}

TEST_CASE("letters that mean something in HTML are written so that they do not") {
  CHECK(escaped("a < b & \"c\"") == "a &lt; b &amp; &quot;c&quot;");
  CHECK(escaped(std::string("\x01\x1b[31m\n")) == "[31m\n");
}

TEST_CASE("harder tissue is never shown lighter") {
  double last = 1.0;
  for (int k = 0; k <= 100; ++k) {
    const auto light = to_light(hardness_colour(k / 100.0));
    const double luminance = 0.2126 * static_cast<double>(light[0]) +
                             0.7152 * static_cast<double>(light[1]) +
                             0.0722 * static_cast<double>(light[2]);
    CHECK(luminance <= last + 0.002);
    last = luminance;
  }
}
