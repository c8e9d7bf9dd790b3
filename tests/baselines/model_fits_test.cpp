// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/model_fits.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::baselines;
using namespace tuina::tissue;

namespace {

/// Down and up again at a constant speed; force by `law` of depth and its rate.
template <typename Law>
std::vector<TimedPress> pressed(const Law& law, double deepest_m, double speed, double noise_n) {
  Random random = make_random(6, "laws");
  std::vector<TimedPress> record;
  const double half_s = (deepest_m + 1_mm) / speed;
  for (double t = 0.0; t < 2.0 * half_s; t += 1e-3) {
    const bool down = t < half_s;
    const double x = deepest_m - speed * std::abs(t - half_s);
    const double force_n = x > 0.0 ? law(x, down ? speed : -speed) : 0.0;
    record.push_back({t, {x + 0.4_mm, force_n + gaussian(random, noise_n)}});
  }
  return record;
}

TissueLaw best_law(const std::vector<TimedPress>& record) {
  TissueLaw best = TissueLaw::linear;
  for (const TissueLaw law : tissue_laws) {
    if (fit_law(record, law).aic < fit_law(record, best).aic) best = law;
  }
  return best;
}

}  // namespace

TEST_CASE("[thesis] Table 6-1: the tangent is found again, with the noise as its only error") {
  for (const TangentTissue& truth :
       {TangentTissue{4.559, 263.2}, TangentTissue{9.786, 185.4}, TangentTissue{4.275, 143.6}}) {
    const auto record = pressed([&](double x, double) { return force_at_depth(truth, x); },
                                depth_at_force(truth, 20.0), 20_mm, 0.2);
    const LawFit fit = fit_law(record, TissueLaw::tangent);
    CHECK(fit.parameters[0] == doctest::Approx(truth.alpha_n).epsilon(0.03));
    CHECK(fit.parameters[1] == doctest::Approx(truth.beta_per_m).epsilon(0.03));
    CHECK(fit.contact_m == doctest::Approx(0.4_mm).epsilon(0.2));
    CHECK(fit.rmse_n == doctest::Approx(0.2).epsilon(0.1));
  }
}

TEST_CASE("the criterion of Akaike names the law that made the record") {
  const auto tells = [](const auto& law) { return best_law(pressed(law, 8_mm, 20_mm, 0.2)); };
  CHECK(tells([](double x, double) { return 4e5 * x * x; }) == TissueLaw::quadratic);
  CHECK(tells([](double x, double) { return 4e4 * std::pow(x, 1.5); }) == TissueLaw::hertz);
  CHECK(tells([](double x, double) { return std::expm1(400.0 * x); }) == TissueLaw::exponential);
  CHECK(tells([](double x, double) { return 3e3 * x; }) == TissueLaw::linear);
  CHECK(tells([](double x, double v) { return 4e5 * x * x * (1.0 + 8.0 * v); }) ==
        TissueLaw::hunt_crossley);
  CHECK(tells([](double x, double v) { return 3e3 * x + 60.0 * v; }) == TissueLaw::kelvin_voigt);
}
