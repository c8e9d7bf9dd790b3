// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/force_errors.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tuina::session;

TEST_CASE("a force one newton low everywhere has an RMSE of one newton and no overshoot") {
  ForceErrorSum sum;
  sum.begin();
  for (int i = 0; i < 1000; ++i) sum.add(i * 1e-3, 20.0, 19.0);
  const ForceErrors errors = sum.errors();
  CHECK(errors.rmse_n == doctest::Approx(1.0));
  CHECK(errors.settled_rmse_n.value() == doctest::Approx(1.0));
  CHECK(errors.overshoot_n == 0.0);
  CHECK(errors.peak_n == 19.0);
}

TEST_CASE("settled errors leave out 0.3 s after each change of target") {
  ForceErrorSum sum;
  sum.begin();
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 1e-3;
    const double since_change = std::fmod(t, 1.0);
    sum.add(t, t < 1.0 ? 20.0 : 10.0, (t < 1.0 ? 20.0 : 10.0) + (since_change < 0.299 ? 5.0 : 0.5));
  }
  const ForceErrors errors = sum.errors();
  CHECK(errors.settled_rmse_n.value() == doctest::Approx(0.5));
  CHECK(errors.rmse_n > 2.0);
  CHECK(errors.overshoot_n == doctest::Approx(5.0));
}

TEST_CASE("a target that never rests has no settled error") {
  ForceErrorSum sum;
  sum.begin();
  for (int i = 1; i < 500; ++i) sum.add(i * 1e-3, 0.01 * i, 0.01 * i);
  CHECK_FALSE(sum.errors().settled_rmse_n.has_value());
}

TEST_CASE("where nothing was touched no error is known") {
  const ForceErrors errors = ForceErrorSum().errors();
  CHECK(std::isnan(errors.rmse_n));
  CHECK(errors.peak_n == 0.0);
}
