// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/programme.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"

using namespace tuina;
using namespace tuina::massage;

namespace {

std::string fault_of(const std::string& parts) {
  const auto programme = parse_programme("name = \"x\"\n" + parts, "my.toml");
  REQUIRE_FALSE(programme.has_value());
  CHECK(programme.error().fault == Fault::config);
  return programme.error().message;
}

bool says(const std::string& message, const char* what) {
  CAPTURE(message);
  CAPTURE(what);
  return message.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "every shipped programme reads, says what it does in two lines, and is the file of its name") {
  CHECK(shipped_programmes().size() >= 5);
  for (const ShippedProgramme& shipped : shipped_programmes()) {
    CAPTURE(shipped.name);
    const auto programme = load_programme(std::string(shipped.name));
    REQUIRE_MESSAGE(programme.has_value(), test::reason(programme));
    CHECK(programme->name == shipped.name);
    CHECK_FALSE(programme->parts.empty());
    CHECK(std::count(programme->description.begin(), programme->description.end(), '\n') == 1);
    const std::string file =
        fmt::format("{}/config/programmes/{}.toml", TUINA_SOURCE_DIR, shipped.name);
    CHECK(read_file(file).value() == shipped.toml);
  }
}

TEST_CASE("a programme file says what it means") {
  const auto programme = parse_programme(
      "name = \"mine\"\nintensity = 5\n[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\", "
      "\"BL50_L\"]\n"
      "force_n = 12\nradius_mm = 20\nrate_hz = 0.5\ntime_s = 8\nside = \"left\"\norder = "
      "\"upward\"\n"
      "together = false\n[[part]]\ntechnique = \"stroke\"\nline = \"loin\"\nspeed_mm_per_s = 40\n",
      "mine.toml");
  REQUIRE_MESSAGE(programme.has_value(), test::reason(programme));
  CHECK(programme->intensity == 5);
  CHECK(force_scale_of(programme->intensity) == doctest::Approx(1.4));
  CHECK(force_scale_of(3) == doctest::Approx(1.0));
  const Part& rub = programme->parts.at(0);
  CHECK(rub.technique == Technique::rub);
  CHECK(rub.points == std::vector<std::string>{"BL47", "BL50_L"});
  CHECK(rub.radius_m == doctest::Approx(0.020));
  CHECK(rub.rate_hz == 0.5);
  CHECK(rub.time_s == 8.0);
  CHECK_FALSE(rub.repeats.has_value());
  CHECK(rub.side == Side::left);
  CHECK(rub.order == Order::upward);
  CHECK_FALSE(rub.together);
  CHECK(programme->parts.at(1).line == "loin");
  CHECK(programme->parts.at(1).speed_m_per_s == doctest::Approx(0.040));
}

TEST_CASE("all faults of a programme are reported at once, each with its line") {
  const std::string message = fault_of(
      "intensity = 9\n"
      "[[part]]\ntechnique = \"press\"\npoints = [\"BL74\"]\nforce_n = 80\nrate_hz = 1\n"
      "[[part]]\ntechnique = \"rubb\"\n"
      "[[part]]\ntechnique = \"tap\"\npoints = [\"BL47\"]\nforce_n = nan\nsied = \"both\"\n");
  CHECK(says(message, "my.toml:2: intensity = 9 is not a whole number from 1 to 5"));
  CHECK(says(message, "my.toml:5: the point `BL74` is unknown; is `BL47` meant?"));
  CHECK(says(message, "my.toml:6: force_n = 80 is not a number from 3 to 45"));
  CHECK(says(message, "my.toml:7: press has no `rate_hz`"));
  CHECK(says(message, "my.toml:9: technique = \"rubb\" is unknown; is `rub` meant?"));
  CHECK(says(message, "my.toml:13: force_n = nan is not a number"));
  CHECK(says(message, "my.toml:14: tap has no `sied`; is `side` meant?"));
}

TEST_CASE("what a body would not bear is refused before anyone moves") {
  CHECK(says(fault_of("[[part]]\ntechnique = \"rub\"\npoints = [\"GV4\"]\n"), "lies on the spine"));
  CHECK(
      says(fault_of("[[part]]\ntechnique = \"press\"\npoints = [\"GV6\"]\n"), "lies on the spine"));
  CHECK(says(
      fault_of(
          "[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\"]\nradius_mm = 40\nrate_hz = 0.5\n"),
      "slides with 126 mm/s, 80 allowed"));
  CHECK(says(
      fault_of("[[part]]\ntechnique = \"tap\"\npoints = [\"BL47\"]\nrate_hz = 5\nforce_n = 20\n"),
      "at this rate 19.5 N are allowed"));
  CHECK(says(fault_of("intensity = 5\n[[part]]\ntechnique = \"tap\"\npoints = [\"BL47\"]\n"
                      "rate_hz = 3\nforce_n = 27\n"),
             "at this rate and intensity 5 21.8 N are allowed"));
}

TEST_CASE("a knead has a small circle and a swelling force, and refuses what is beyond them") {
  const std::string knead = "[[part]]\ntechnique = \"knead\"\n";
  const auto plain = parse_programme("name = \"x\"\n" + knead + "points = [\"SI11\"]\n", "my.toml");
  REQUIRE_MESSAGE(plain.has_value(), test::reason(plain));
  CHECK(plain->parts.at(0).technique == Technique::knead);
  CHECK(plain->parts.at(0).radius_m == doctest::Approx(0.015));
  CHECK(plain->parts.at(0).rate_hz == 0.8);
  CHECK(plain->parts.at(0).force_n == 18.0);

  const std::string si11 = knead + "points = [\"SI11\"]\n";
  CHECK(says(fault_of(si11 + "radius_mm = 30\n"), "is not a number from 10 to 20"));
  CHECK(says(fault_of(si11 + "radius_mm = 5\n"), "is not a number from 10 to 20"));
  CHECK(says(fault_of(si11 + "rate_hz = 2\n"), "is not a number from 0.5 to 1.25"));
  CHECK(says(fault_of(si11 + "rate_hz = 0.3\n"), "is not a number from 0.5 to 1.25"));
  CHECK(says(fault_of(si11 + "radius_mm = 20\n"), "slides with 101 mm/s, 80 allowed"));
  CHECK(says(fault_of(si11 + "force_n = 40\n"), "at this rate 30.8 N are allowed"));
  CHECK(says(fault_of(si11 + "spiral = true\n"), "knead has no `spiral`"));
  CHECK(says(fault_of(si11 + "hold_s = 2\n"), "knead has no `hold_s`"));
  CHECK(says(fault_of(knead + "points = [\"GV4\"]\n"), "lies on the spine"));
  CHECK(says(fault_of(knead), "knead needs points"));
}

TEST_CASE("what is missing or contradicts itself is refused") {
  CHECK(says(fault_of(""), "at least one [[part]]"));
  CHECK(says(fault_of("[[part]]\nforce_n = 10\n"), "needs a technique"));
  CHECK(says(fault_of("[[part]]\ntechnique = \"press\"\n"), "press needs points"));
  CHECK(
      says(fault_of("[[part]]\ntechnique = \"press\"\npoints = []\n"), "not a list of acupoints"));
  CHECK(says(fault_of("[[part]]\ntechnique = \"stroke\"\npoints = [\"BL47\"]\n"),
             "two points at least"));
  CHECK(says(
      fault_of(
          "[[part]]\ntechnique = \"stroke\"\npoints = [\"BL47\", \"BL50\"]\nline = \"loin\"\n"),
      "either points, a line or places"));
  const std::string stroke = "[[part]]\ntechnique = \"stroke\"\n";
  CHECK(says(fault_of(stroke + "places = [[3.0, 0.8]]\n"), "not a list of 2 to 100 places"));
  CHECK(says(fault_of(stroke + "places = [[3.0, 0.8], [0.1, 0.2]]\n"), "0.5 to 8 cun"));
  CHECK(says(fault_of(stroke + "places = [[3.0, 0.8], [nan, 0.2]]\n"), "0.5 to 8 cun"));
  CHECK(says(fault_of(stroke + "line = \"loin\"\nplaces = [[3.0, 0.8], [3.0, 0.1]]\n"),
             "either points, a line or places"));
  CHECK(says(
      fault_of("[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\nrepeats = 2\ntime_s = 9\n"),
      "exclude each other"));
  CHECK(says(
      fault_of(
          "[[part]]\ntechnique = \"press\"\npoints = [\"GV4\", \"BL47_R\"]\nside = \"left\"\n"),
      "my.toml:5: BL47_R does not lie on the left"));
  for (const char* points : {"\"BL47_L\", \"BL50_R\"", "\"BL47\", \"BL50_R\""}) {
    CHECK(says(fault_of(fmt::format("{}points = [{}]\n", stroke, points)),
               "stroke between points of different sides would cross the spine"));
  }
  const std::string one_side = stroke + "points = [\"BL47_L\", \"BL50_L\"]\n";
  CHECK(parse_programme("name = \"x\"\n" + one_side, "my.toml").has_value());
  CHECK(says(fault_of("[[part]]\ntechnique = 3\n"), "is not a text"));
  CHECK(says(fault_of("part = 3\n"), "at least one [[part]]"));
  CHECK(says(fault_of("[[part]\n"), "my.toml:2: "));
  CHECK(says(fault_of("[[part]]\ntechnique = \"press\"\npoints = [[1], {a = 2}]\n"), "unknown"));
}

TEST_CASE("sides that cannot take turns are refused with the line that says so") {
  const auto fault = [](const std::string& rest) {
    return fault_of("[[part]]\ntechnique = \"press\"\nalternating = true\n" + rest);
  };
  CHECK(says(fault("points = [\"BL47\"]\nside = \"left\"\n"),
             "my.toml:4: alternating needs both sides"));
  CHECK(says(fault("points = [\"BL47_L\"]\n"), "points of both sides, without _L or _R"));
  CHECK(says(fault("points = [\"BL47\"]\ntogether = true\n"), "exclude each other"));
  CHECK(says(fault("points = [\"BL47\"]\ntime_s = 9\n"), "needs repeats"));
  CHECK(says(fault_of("[[part]]\ntechnique = \"tap\"\npoints = [\"SI11\"]\nalternating = true\n"),
             "tap has no `alternating`"));
  const auto hands = [](const std::string& rest) {
    return fault_of("[[part]]\ntechnique = \"stroke\"\nhand_over_hand = true\n" + rest);
  };
  CHECK(says(hands("line = \"loin\"\nside = \"left\"\n"),
             "my.toml:4: hand_over_hand needs both sides"));
  CHECK(says(hands("line = \"loin\"\ntogether = false\n"),
             "hand_over_hand and together = false exclude each other"));
  CHECK(says(hands("line = \"loin\"\nalternating = true\n"),
             "alternating and hand_over_hand exclude each other"));
  CHECK(says(fault_of("[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\"]\nhand_over_hand = "
                      "true\n"),
             "rub has no `hand_over_hand`"));
}

TEST_CASE("a programme that does not exist is answered with what might be meant") {
  CHECK(says(load_programme("relaks").error().message, "is `relax` meant?"));
  CHECK(says(load_programme("zzzzzzzzzzzzz").error().message, "known: relax"));
  CHECK(load_programme("/nowhere/at/all.toml").error().fault == Fault::file);
}
