// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/earlier/known_tissue.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/session/earlier/by_hand.hpp"

namespace tuina::session {
namespace {

const Acupoint* named(std::span<const Acupoint> points, const std::string& name) {
  const auto found = std::ranges::find(points, name, &Acupoint::name);
  return found == points.end() ? nullptr : &*found;
}

/// Empty where the acupoints lie as they did, or in another position.
Sentence somebody_else(const KnownTissue& known, BodyPosture position,
                       std::span<const Acupoint> now) {
  if (known.lay.empty() || known.position != position) return {};
  const auto motion = fit_motion(known.lay, now);
  if (!motion || motion->misfit_m <= max_other_misfit_m) return {};
  return sentence("note_somebody_else",
                  "another person than in the last session, or one who is bent: the acupoints lie "
                  "otherwise to each other than then ({:.1f} mm; {:.0f} mm are usual)",
                  to_mm(motion->misfit_m), to_mm(max_other_misfit_m));
}

}  // namespace

Recognised recognised(const KnownTissue& known, BodyPosture position,
                      std::span<const Acupoint> now) {
  Recognised found;
  if (known.places.empty()) {
    found.note = somebody_else(known, position, now);
    return found;
  }
  if (known.position != position) {
    found.note =
        sentence("note_known_other_position", "the tissue felt earlier is not used: it was felt {}",
                 name_of(known.position));
    return found;
  }
  const auto motion = fit_motion(known.lay, now);
  if (!motion || !(motion->misfit_m <= max_other_misfit_m)) {
    found.note =
        motion ? sentence("note_known_other_lay",
                          "the tissue felt earlier is not used: the acupoints lie otherwise to "
                          "each other than then ({:.1f} mm; {:.0f} mm are borne)",
                          to_mm(motion->misfit_m), to_mm(max_other_misfit_m))
               : sentence("note_known_unlike", "the tissue felt earlier is not used: {}",
                          motion.error().message);
    return found;
  }
  for (const KnownPlace& place : known.places) {
    const Acupoint *before = named(known.lay, place.name), *after = named(now, place.name);
    if (before == nullptr || after == nullptr) continue;
    const Vector3 expected_in_couch = motion->now_from_then * before->at_in_couch;
    const double offset_m = (expected_in_couch - after->at_in_couch).norm();
    if (!(offset_m <= max_place_offset_m)) continue;
    found.places.push_back(place);
    found.places.back().log_sd = std::hypot(place.log_sd, change_along_skin_per_m * offset_m);
  }
  found.note = sentence("note_known", "the tissue of {} of {} places felt earlier counts as known",
                        found.places.size(), known.places.size());
  return found;
}

KnownMatch match(const TangentTissue& known, double known_sd, const TangentTissue& felt,
                 const Eigen::Matrix2d& felt_covariance, double force_n) noexcept {
  constexpr double z95 = 1.96, chi_square_95 = 5.99;  // one and two degrees of freedom
  constexpr double telling = 1.5;
  const Eigen::Matrix2d covariance =
      felt_covariance + known_sd * known_sd * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d apart(std::log(felt.alpha_n / known.alpha_n),
                              std::log(felt.beta_per_m / known.beta_per_m));
  // What is not a number has not come as known.
  if (!(apart.dot(covariance.inverse() * apart) <= chi_square_95)) return KnownMatch::differs;
  const double q = force_n / known.alpha_n;
  const Eigen::Vector2d depth_by(-q / ((1.0 + q * q) * std::atan(q)), -1.0);
  const double borne = z95 * std::sqrt(depth_by.dot(covariance * depth_by));
  return borne <= std::log(telling) ? KnownMatch::holds : KnownMatch::unclear;
}

}  // namespace tuina::session
