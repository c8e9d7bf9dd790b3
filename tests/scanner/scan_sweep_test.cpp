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
  CHECK(says(refusal({.silent_from = 7}), "no frame within 1.0 s"));
  CHECK(says(refusal({.wrong_size_at = 3}), "72 x 96"));
  CHECK(says(refusal({.motor_lost_at = 5}), "the motor does not answer"));
  CHECK(says(refusal({.laser_is_dead = true}), "the laser does not answer"));
}

TEST_CASE("a motor that hangs is told from one that is slow") {
  // Half a turn of 36 degrees takes 6 s; the fake goes on giving frames for ever.
  CHECK(says(refusal({.never_arrives = true}), "the motor has not arrived after 17.0 s"));
}
