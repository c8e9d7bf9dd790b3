// SPDX-License-Identifier: Apache-2.0
// Layers that relax on a torso under a breath, pressed as an arm does.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/living_tissue.hpp"
#include "tuina/tissue/creep_estimator.hpp"

using namespace tuina;
using namespace tuina::tissue;

namespace {

constexpr double believed_torso_n_per_m = 20e3, ms = 1e-3;

/// A tool that comes from the air and then follows forces.
class Tool {
 public:
  Tool(std::uint64_t seed, double breath_m)
      : random_(make_random(seed, "layers")),
        breath_m_(breath_m),
        phase_(uniform(random_, 0.0, 2.0 * pi)),
        skin_m_(gaussian(random_, 2.0_mm)),
        estimator_(on_unknown_torso(pressed_by_robot(believed_torso_n_per_m, 0.0))) {
    const auto near = [this](double usual) { return usual * uniform(random_, 0.8, 1.2); };
    tissue_.form = sim::draw_form(sim::ElasticForm::Law::layers, random_);
    tissue_.relaxation.tau_s = {uniform(random_, 0.3, 1.0), uniform(random_, 5.0, 20.0), 1.0};
    tissue_.relaxation.share = {near(0.12), near(0.12), 0.0};
    tissue_.damping_s_per_m = near(3.0);
    tissue_.torso = sim::Torso::with(near(6.0), near(believed_torso_n_per_m), 0.3);
    place_ = {near(5.6), near(215.0)};
  }

  /// The felt first loading over the true one: logarithms of alpha and beta.
  std::pair<double, double> errors_after_presses() {
    constexpr double touched_n = 1.5, kept_n = 3.0, approach_m_per_s = 15.0_mm;
    while (force_n_ < touched_n) step(approach_m_per_s);
    hold(kept_n, 0.5, 1.0);
    for (const double peak_n : {10.0, 14.0, 20.0, 20.0}) {
      hold(peak_n, 1.5, 1.5);
      hold(kept_n, 1.0, 0.5);
    }
    estimator_.settle();
    const TangentTissue truth = tissue_.first_loading(place_, 1.0, 20.0);
    const TangentTissue felt = estimator_.estimate().tissue;
    return {std::log(felt.alpha_n / truth.alpha_n), std::log(felt.beta_per_m / truth.beta_per_m)};
  }

 private:
  void step(double m_per_s) {
    constexpr double breath_hz = 0.25;
    at_m_ += m_per_s * ms;
    const double angle = 2.0 * pi * breath_hz * (time_s_ += ms) + phase_;
    const double breath_m = 0.5 * breath_m_ * std::sin(angle);
    const double breath_m_per_s = pi * breath_hz * breath_m_ * std::cos(angle);
    force_n_ = tissue_.press(place_, at_m_ - skin_m_ + breath_m, m_per_s + breath_m_per_s, 1.0, ms);
    estimator_.update(time_s_, {.depth_m = at_m_ + gaussian(random_, 0.01_mm),
                                .force_n = force_n_ + gaussian(random_, 0.05)});
  }
  void hold(double to_n, double rise_s, double for_s) {
    constexpr double m_per_s_per_n = 2.0_mm, lag = 0.05, fastest = 50.0_mm;
    const double from_n = force_n_;
    for (double t = 0.0; t < rise_s + for_s; t += ms) {
      const double share = std::min(1.0, t / rise_s);
      const double target_n = from_n + (to_n - from_n) * share * share * (3.0 - 2.0 * share);
      const double wanted = std::clamp(m_per_s_per_n * (target_n - force_n_), -fastest, fastest);
      m_per_s_ += lag * (wanted - m_per_s_);
      step(m_per_s_);
    }
  }

  Random random_;
  double breath_m_, phase_, skin_m_;
  CreepEstimator estimator_;
  sim::LivingTissue tissue_;
  TangentTissue place_;
  double time_s_ = 0.0, at_m_ = -20.0_mm, m_per_s_ = 0.0, force_n_ = 0.0;
};

}  // namespace

TEST_CASE("the first loading of layers is felt without bias: the touch of the skin tells, too") {
  std::vector<double> alpha, beta;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const auto [alpha_error, beta_error] = Tool(seed, 3.0_mm).errors_after_presses();
    alpha.push_back(alpha_error);
    beta.push_back(beta_error);
  }
  for (auto* errors : {&alpha, &beta}) {
    std::ranges::sort(*errors);
    const double median = (*errors)[errors->size() / 2];
    CHECK(std::abs(median) < 0.05);
  }
  MESSAGE("alpha ", alpha.front(), " ", alpha[12], " ", alpha.back(), "; beta ", beta.front(), " ",
          beta[12], " ", beta.back());
}
