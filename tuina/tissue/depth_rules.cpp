// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/depth_rules.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/tissue/estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::tissue {
namespace {

constexpr double bend_alphas = 2.5;  // force / alpha where alpha and beta can be separated
constexpr double first_probe_n = 8.0;
constexpr double firmer_by = 2.0;     // of a press against the strongest before it
constexpr double probed_share = 0.7;  // of the order
constexpr double min_probe_n = 7.0;   // less is not felt above the 3 N that are kept

double relative_sd(double ci95, double value) noexcept {
  return ci95 / (1.96 * value);
}

double log_stiffness_sd(const TissueEstimate& estimate, double force_n) noexcept {
  // Treats alpha and beta as independent; their errors are anticorrelated, so this is conservative.
  const double q = force_n / estimate.tissue.alpha_n;
  const double by_alpha = (1.0 - q * q) / (1.0 + q * q);
  return std::hypot(by_alpha * relative_sd(estimate.alpha_ci95_n, estimate.tissue.alpha_n),
                    relative_sd(estimate.beta_ci95_per_m, estimate.tissue.beta_per_m));
}

bool positive(double value) noexcept {
  return std::isfinite(value) && value > 0.0;
}

bool sound(const TissueEstimate& estimate) noexcept {
  return positive(estimate.tissue.alpha_n) && positive(estimate.tissue.beta_per_m) &&
         std::isfinite(estimate.alpha_ci95_n) && std::isfinite(estimate.beta_ci95_per_m) &&
         std::isfinite(estimate.contact_m);
}

}  // namespace

double probing_force_n(const TissueEstimate& estimate, double ordered_n,
                       double region_cap_n) noexcept {
  const double gentle_n = std::max(min_probe_n, 0.5 * region_cap_n);
  const double max_n = std::max(0.0, std::min(ordered_n, region_cap_n));
  if (estimate.presses < 1 || !sound(estimate)) return std::min({first_probe_n, gentle_n, max_n});
  const double to_bend_n = std::min(bend_alphas * estimate.tissue.alpha_n, gentle_n);
  return std::min(std::max(to_bend_n, probed_share * ordered_n), max_n);
}

bool probed_enough(const TissueEstimate& estimate, double peak_force_n, double ordered_n,
                   double region_cap_n) noexcept {
  if (estimate.presses < 2) return false;
  return peak_force_n >= 0.9 * probing_force_n(estimate, ordered_n, region_cap_n);
}

double firmest_next_n(Foretold foretold, double strongest_n, double region_cap_n) noexcept {
  if (foretold == Foretold::well) return region_cap_n;
  const double firmer = foretold == Foretold::wrongly ? 1.0 : firmer_by;
  return std::min(region_cap_n, firmer * std::max(0.0, strongest_n));
}

bool may_steer(const TissueEstimate& estimate, double nis) noexcept {
  return follows_law(estimate, nis) && estimate.converged;
}

bool follows_law(const TissueEstimate& estimate, double nis) noexcept {
  return sound(estimate) && nis <= max_nis;
}

ContactImpedance impedance_for(double tissue_n_per_m, double mass_kg) noexcept {
  if (!positive(tissue_n_per_m)) tissue_n_per_m = 0.0;
  const double K = std::clamp(0.5 * tissue_n_per_m, 200.0, 3000.0);
  return {K, 2.0 * 0.7 * std::sqrt(std::max(0.0, mass_kg) * (K + tissue_n_per_m))};
}

double ControlShare::step(double tissue_n_per_m, double tool_speed_m_per_s, double dt_s) noexcept {
  constexpr double soft_n_per_m = 2e3, stiff_n_per_m = 15e3;
  constexpr double hysteresis = 0.1, dwell_s = 0.3, slow_m_per_s = 2e-3;
  since_s_ += dt_s;
  if (!positive(tissue_n_per_m)) return share_;
  const double wanted = std::clamp(
      std::log(tissue_n_per_m / soft_n_per_m) / std::log(stiff_n_per_m / soft_n_per_m), 0.0, 1.0);
  const bool ends = (wanted == 0.0 || wanted == 1.0) && wanted != share_;
  if ((std::abs(wanted - share_) > hysteresis || ends) && since_s_ >= dwell_s &&
      std::abs(tool_speed_m_per_s) < slow_m_per_s) {
    share_ = wanted;
    since_s_ = 0.0;
  }
  return share_;
}

double detectable_change(const PressSet& a, const PressSet& b) noexcept {
  return 1.96 * std::hypot(a.sd, b.sd);
}

const char* name_of(Dwell dwell) noexcept {
  switch (dwell) {
    case Dwell::go_on:
      return "go on";
    case Dwell::softened:
      return "a tenth softer than at first: enough";
    case Dwell::no_change:
      return "twice no change that can be told: more would not help";
    case Dwell::time_up:
      return "a minute and a half at one place: enough";
  }
  return "";
}

const char* key_of(Dwell dwell) noexcept {
  constexpr const char* keys[] = {"", "why_softened", "why_no_change", "why_time_up"};
  return keys[static_cast<std::size_t>(dwell)];
}

Dwell dwell_after(std::span<const PressSet> sets, double elapsed_s) noexcept {
  constexpr double enough = 0.1, max_duration_s = 90.0;
  if (sets.size() >= 2 && sets.front().log_stiffness - sets.back().log_stiffness >= enough)
    return Dwell::softened;
  if (elapsed_s >= max_duration_s) return Dwell::time_up;
  if (sets.size() < 3) return Dwell::go_on;
  const auto unchanged = [&](std::size_t i) {
    return std::abs(sets[i].log_stiffness - sets[i - 1].log_stiffness) <
           detectable_change(sets[i], sets[i - 1]);
  };
  const std::size_t last = sets.size() - 1;
  return unchanged(last) && unchanged(last - 1) ? Dwell::no_change : Dwell::go_on;
}

const char* name_of(Alarm alarm) noexcept {
  switch (alarm) {
    case Alarm::none:
      return "none";
    case Alarm::guarding:
      return "the tissue became stiffer";
    case Alarm::moved:
      return "the skin moved";
  }
  return "";
}

const char* key_of(Alarm alarm) noexcept {
  constexpr const char* keys[] = {"", "why_guarding", "why_moved"};
  return keys[static_cast<std::size_t>(alarm)];
}

Alarm compare(const TissueEstimate& reference, const TissueEstimate& now, double force_n) noexcept {
  constexpr double max_rise = 0.25, max_jump_m = 3e-3;
  if (!sound(reference) || !sound(now)) return Alarm::none;
  const auto rose = [&](double ratio, double sd_before, double sd_now) {
    return std::log(ratio) >
           std::max(std::log(1.0 + max_rise), 1.96 * std::hypot(sd_before, sd_now));
  };
  const auto alpha_sd = [](const TissueEstimate& e) {
    return relative_sd(e.alpha_ci95_n, e.tissue.alpha_n);
  };
  if (rose(now.tissue.alpha_n / reference.tissue.alpha_n, alpha_sd(reference), alpha_sd(now)) ||
      rose(stiffness_at_force(now.tissue, force_n) / stiffness_at_force(reference.tissue, force_n),
           log_stiffness_sd(reference, force_n), log_stiffness_sd(now, force_n)))
    return Alarm::guarding;
  if (std::abs(now.contact_m - reference.contact_m) > max_jump_m) return Alarm::moved;
  return Alarm::none;
}

}  // namespace tuina::tissue
