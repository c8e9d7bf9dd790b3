// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/beat_correction.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/units.hpp"

using namespace tuina;

namespace {

/// Peaks of twelve taps at 3 Hz in which so much of what is commanded above 3 N is felt.
std::vector<double> felt_peaks_n(double wanted_n, double share_felt) {
  constexpr double kept_n = 3.0, rate_hz = 3.0, dt_s = 1e-3;
  control::BeatCorrection beats;
  beats.begin(wanted_n);
  std::vector<double> peaks_n;
  double felt_n = kept_n, peak_n = 0.0, last_n = kept_n;
  for (double t = 0.0; t < 12.0 / rate_hz; t += dt_s) {
    const double swell = 0.5 * (1.0 - std::cos(2.0 * pi * rate_hz * t));
    const double command_n = beats.command_n(kept_n + (wanted_n - kept_n) * swell, felt_n);
    CHECK(std::abs(command_n - last_n) <= 2.0);  // no jump where a beat is corrected
    last_n = command_n;
    felt_n = kept_n + share_felt * (command_n - kept_n);
    peak_n = std::max(peak_n, felt_n);
    const int taps = static_cast<int>(t * rate_hz),
              taps_next = static_cast<int>((t + dt_s) * rate_hz);
    if (taps_next > taps) {
      peaks_n.push_back(peak_n);
      peak_n = 0.0;
    }
  }
  return peaks_n;
}

}  // namespace

TEST_CASE("taps begin light, at most double, and reach what is wanted of soft and hard tissue") {
  for (const double share_felt : {0.6, 1.0, 1.4}) {
    CAPTURE(share_felt);
    const std::vector<double> peaks_n = felt_peaks_n(27.0, share_felt);
    REQUIRE(peaks_n.size() >= 11);
    CHECK(peaks_n[0] <= 3.0 + share_felt * 7.01);
    for (std::size_t i = 1; i < peaks_n.size(); ++i) {
      CHECK(peaks_n[i] <= 27.5);
      if (peaks_n[i] > 9.0) CHECK(peaks_n[i] <= 2.5 * peaks_n[i - 1]);
    }
    for (std::size_t i = 5; i < peaks_n.size(); ++i)
      CHECK(peaks_n[i] == doctest::Approx(27.0).epsilon(0.02));
  }
}

TEST_CASE("after one beat that somebody left the tool for, the next is as it was") {
  for (const double left_share : {0.0, 0.2, 0.5}) {
    control::BeatCorrection beats;
    beats.begin(14.0);
    constexpr double kept_n = 3.0, dt_s = 1e-3;
    double felt_n = kept_n, highest_n = 0.0;
    for (double t = 0.0; t < 4.0; t += dt_s) {
      const double swell = 0.5 * (1.0 - std::cos(2.0 * pi * 3.0 * t));
      const double command_n = beats.command_n(kept_n + (14.0 - kept_n) * swell, felt_n);
      const bool left = t > 5.0 / 3.0 && t < 6.0 / 3.0;
      felt_n = kept_n + (left ? left_share : 1.0) * (command_n - kept_n);
      highest_n = std::max(highest_n, felt_n);
    }
    CAPTURE(left_share);
    CHECK(highest_n < 1.2 * 14.0);
  }
}

TEST_CASE("a tap of ten newtons on tissue that is as believed is never more than that") {
  for (const double peak_n : felt_peaks_n(10.0, 1.0)) {
    CHECK(peak_n <= 10.0);
    CHECK(peak_n >= 9.0);
  }
}
