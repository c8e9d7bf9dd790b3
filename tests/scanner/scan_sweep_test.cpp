// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <string>

#include "tests/fake_scanner.hpp"
#include "tuina/scanner/sweep.hpp"

using namespace tuina;
using namespace tuina::scanner;
using tests::FakeScanner;

namespace {

std::string refusal(const FakeScanner::Script& script, const SweepOptions& options = {}) {
  FakeScanner fake(script);
  const auto scan = scan_sweep(fake, fake, tests::calibration_of_fake(), options);
  REQUIRE_FALSE(scan.has_value());
  CHECK_FALSE(fake.lit());
  return scan.error().message;
}

bool says(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the laser is lit for the scan alone") {
  FakeScanner fake;
  CHECK(scan_sweep(fake, fake, tests::calibration_of_fake(), {.near_m = 0.3}).has_value());
  CHECK_FALSE(fake.lit());
}

TEST_CASE("a scanner that fails ends the scan with its cause, and the laser goes out") {
  CHECK(says(refusal({.silent_from = 7}), "no frame within 0.1 s"));
  CHECK(says(refusal({.wrong_size_at = 3}), "72 x 96"));
  CHECK(says(refusal({.motor_lost_at = 5}), "the motor does not answer"));
  CHECK(says(refusal({.laser_is_dead = true}), "the laser does not answer"));
}

TEST_CASE("a motor that hangs is told from one that is slow") {
  // Half a turn of 36 degrees takes 6 s; the fake goes on giving frames for ever.
  CHECK(says(refusal({.never_arrives = true}), "the motor has not arrived after 17.0 s"));
}

TEST_CASE("a camera that hangs and a motor that stands put the laser out within 0.2 s") {
  constexpr double max_lit_s = 0.2;
  const auto lit_for_s = [](const FakeScanner::Script& script, int from_frame, const char* cause) {
    FakeScanner fake(script);
    const auto scan = scan_sweep(fake, fake, tests::calibration_of_fake());
    REQUIRE_FALSE(scan.has_value());
    CHECK(scan.error().fault == Fault::device);
    CHECK_MESSAGE(says(scan.error().message, cause), scan.error().message);
    CHECK_FALSE(fake.lit());
    return fake.last_lit_s() - from_frame / 30.0;
  };
  CHECK(lit_for_s({.same_picture_from = 9}, 9, "the camera has given the same picture") <
        max_lit_s);
  CHECK(lit_for_s({.motor_stands_from = 9}, 9, "the motor stands still at") < max_lit_s);
  // What waits for a frame waits with the laser lit.
  CHECK(lit_for_s({.silent_from = 9}, 8, "no frame") + frame_timeout_s < max_lit_s);
}

TEST_CASE("a motor that skips by two degrees leaves no cloud") {
  FakeScanner skips({.skip_deg = 2.0}), good({.skip_deg = 0.2});
  const auto refused = scan_sweep(skips, skips, tests::calibration_of_fake());
  REQUIRE_FALSE(refused.has_value());
  CHECK_MESSAGE(says(refused.error().message, "the motor skips"), refused.error().message);
  CHECK(scan_sweep(good, good, tests::calibration_of_fake()).has_value());
}
