// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/stickers/sticker_watch.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

namespace tuina::sim {

TEST_CASE("laser dots on a sticker, averaged in space, find its middle, [thesis] 5.1") {
  const Person person = make_phantom(draw_phantom(BodyType::medium, 4), BodyPosture::sitting);
  using scanner::StickerColour;
  const std::map<std::string, StickerColour> worn = {{"GV4", StickerColour::green},
                                                     {"BL50_L", StickerColour::blue},
                                                     {"BL50_R", StickerColour::yellow},
                                                     {"BL47_L", StickerColour::magenta}};
  LaserScannerOptions options;
  std::map<StickerColour, Vector3> truth;
  for (const Acupoint& point : person.acupoints) {
    const auto colour = worn.find(point.name);
    if (colour == worn.end()) continue;
    options.stickers.push_back({.at_in_couch = point.at_in_couch, .colour = colour->second});
    truth[colour->second] = point.at_in_couch;
  }
  LaserScanner unit(person.skin_in_couch, person.position, {}, 4, options);
  const auto calibration = unit.true_calibration();
  scanner::StickerWatch watch(unit, calibration, 0.3, 4.0);
  const auto scan =
      scanner::scan_sweep(watch, unit, calibration, {.from_rad = -8.0_deg, .to_rad = 5.0_deg});
  REQUIRE_MESSAGE(scan.has_value(), test::reason(scan));
  const auto found = watch.stickers(*unit.readings());
  REQUIRE(found.has_value());
  REQUIRE(found->size() == worn.size());
  double sum_mm = 0.0;
  for (const scanner::Sticker& sticker : *found) {
    const double off_mm = to_mm((sticker.at_in_couch - truth.at(sticker.colour)).norm());
    INFO(scanner::name_of(sticker.colour), ": ", sticker.dots, " dots, ", off_mm, " mm off");
    CHECK(sticker.dots >= 3);
    CHECK(off_mm < 3.0);
    sum_mm += off_mm;
  }
  MESSAGE("stickers are ", sum_mm / 4.0, " mm off");
  CHECK(sum_mm / 4.0 < 1.5);
}

}  // namespace tuina::sim
