// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/given_presses.hpp"

#include <algorithm>

#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::app {

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
  side.press.index = ++count_[{side.press.place, side.press.technique}];
  done_.push_back(side.press);
}

void GivenPresses::add(double time_s, Arm arm, const session::ArmView& seen, double true_force_n,
                       const massage::Plan& plan) {
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
  side.held.add(seen.target_n, true_force_n);
  side.press.peak_n = std::max(side.press.peak_n, true_force_n);
}

}  // namespace tuina::app
