// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/given_presses.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/tissue/estimator.hpp"

namespace tuina::app {
namespace {

// Shares of a force between which its slope is taken; from the second on it counts as whole.
constexpr double partly = 0.8, wholly = 0.97;

}  // namespace

void TrueDeepening::add(double whole_n, double force_n, double travel_m) noexcept {
  if (!part_m_ && force_n >= partly * whole_n) part_m_ = travel_m;
  if (force_n < wholly * whole_n) return;
  if (!whole_m_) whole_m_ = travel_m;
  sum_m_ += travel_m;
  sum_share_ += force_n / whole_n;
  samples_ += 1.0;
}

std::optional<double> TrueDeepening::error(double told_m) const noexcept {
  if (!whole_m_ || !(*whole_m_ > *part_m_)) return {};
  const double per_m = (wholly - partly) / (*whole_m_ - *part_m_);
  const double deepened_m = sum_m_ / samples_ - from_m_;
  return sum_share_ / samples_ - 1.0 + per_m * (told_m - deepened_m);
}

void HeldForce::add(double asked_n, double force_n) noexcept {
  constexpr double all_of_it = 0.98;
  asked_n_ = std::max(asked_n_, asked_n);
  if (asked_n < all_of_it * asked_n_) return;
  if (since_n_ < all_of_it * asked_n_) {  // what was summed up was on the way here
    since_n_ = asked_n_;
    sum_n_ = samples_ = 0.0;
  }
  sum_n_ += force_n;
  samples_ += 1.0;
}

void GivenPresses::close(Side& side, double time_s) {
  side.open = false;
  side.press.end_s = time_s;
  side.press.asked_n = side.held.asked_n();
  side.press.held_n = side.held.mean_n();
  const auto error = side.deepening.error(side.told_m);
  side.press.foretold_wrong =
      side.press.foretold && error && std::abs(*error) > tissue::well_foretold_share;
  side.press.index = ++count_[{side.press.place, side.press.technique}];
  done_.push_back(side.press);
}

void GivenPresses::add(double time_s, Arm arm, const session::ArmView& seen,
                       const sim::ContactTruth& truth, const massage::Plan& plan) {
  constexpr double begins_n = 1.15 * massage::kept_force_n, ends_n = 1.1 * massage::kept_force_n;
  Side& side = sides_[arm];
  const bool in_contact = seen.phase == session::ArmPhase::contact;
  if (in_contact && !side.in_contact) side.contact_s = time_s;
  side.in_contact = in_contact;
  if (side.open && (!in_contact || seen.target_n < ends_n)) close(side, time_s);
  if (!in_contact) return;
  const ContactPath& path = plan.paths[static_cast<std::size_t>(seen.path)].path;
  const bool counts = path.technique == Technique::press || path.technique == Technique::tap;
  if (!counts || path.acupoints.empty()) return;
  if (!side.open && seen.target_n <= massage::kept_force_n) {
    side.deepening = TrueDeepening(-truth.gap_m);
    side.told_m = seen.deepening_m;
  }
  if (!side.open && seen.target_n > begins_n) {
    double planned_n = 0.0;
    for (const ContactPoint& point : path.points) planned_n = std::max(planned_n, point.force_n);
    side.open = true;
    side.held = {};
    side.press = {.place = path.acupoints.front(),
                  .technique = path.technique,
                  .probing = seen.probing,
                  .foretold = seen.foretold,
                  .planned_n = planned_n,
                  .arm = arm,
                  .contact_s = side.contact_s};
  }
  if (!side.open) return;
  side.held.add(seen.target_n, truth.force_n);
  side.deepening.add(side.press.planned_n, truth.force_n, -truth.gap_m);
  side.press.peak_n = std::max(side.press.peak_n, truth.force_n);
}

}  // namespace tuina::app
