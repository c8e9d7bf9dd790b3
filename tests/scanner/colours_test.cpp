// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/colours.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/scanner/lit_scene.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

double laser_column(int y) {
  return 200.37 + 0.2931 * y;
}
double white_column(int y) {
  return 430.0 + 0.05 * y;
}

/// What a colour camera sees of a laser line, a white one and a scene of this contrast.
Image coloured(double laser_dn, double white_dn, double contrast_dn, double green = 0.85,
               double chroma = 0.0) {
  return test::coloured(640, 480,
                        {.laser_dn = laser_dn,
                         .white_dn = white_dn,
                         .contrast_dn = contrast_dn,
                         .green = green,
                         .chroma = chroma},
                        laser_column, white_column);
}

struct Found {
  int right = 0, wrong = 0;
};

Found in(const Image& picture) {
  Found found;
  for (const LinePoint& point : find_red_line(picture).points) {
    const double off_px = static_cast<double>(point.column_px) - laser_column(point.row);
    ++(std::abs(off_px) < 0.5 ? found.right : found.wrong);
  }
  return found;
}

}  // namespace

TEST_CASE("of two lines in a lit, textured scene the red one is the laser's, brighter or not") {
  for (const double white_dn : {0.0, 60.0, 130.0}) {
    CAPTURE(white_dn);
    const Found found = in(coloured(90.0, white_dn, 40.0));
    CHECK(found.right == 480);
    CHECK(found.wrong == 0);
  }
}

TEST_CASE("without a laser a coloured scene and a white line in it show none, whatever the lamp") {
  for (const double white_dn : {0.0, 130.0}) {
    for (const double green : {0.6, 0.85, 1.0, 1.3}) {
      for (const double chroma : {0.0, 0.05}) {
        CAPTURE(white_dn);
        CAPTURE(green);
        CAPTURE(chroma);
        const Found found = in(coloured(0.0, white_dn, 25.0, green, chroma));
        CHECK(found.right + found.wrong == 0);
      }
    }
  }
}

TEST_CASE("a laser so bright that its middle is white is still its line") {
  const Found found = in(coloured(2500.0, 0.0, 5.0));
  CHECK(found.right > 470);
  CHECK(found.wrong == 0);
}

TEST_CASE("a dark room's line is found in red alone, colours or not") {
  Image dark(640, 480, 3);
  const Image grey = test::seen(Image(640, 480), 150.0, laser_column, 2);
  for (std::size_t i = 0; i < grey.data.size(); ++i) dark.data[3 * i] = grey.data[i];
  const LaserLine of_colours = find_red_line(dark);
  const LaserLine of_red = find_laser_line(grey);
  REQUIRE(of_colours.points.size() == of_red.points.size());
  for (std::size_t i = 0; i < of_red.points.size(); ++i)
    CHECK(of_colours.points[i].column_px == of_red.points[i].column_px);
}
