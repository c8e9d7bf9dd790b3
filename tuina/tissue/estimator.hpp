// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// A recursive estimator of the tangent law, fed sample by sample at 1 kHz: times in seconds, of
/// any origin and increasing; depth along the inward normal. Real-time: no heap, no exceptions.
template <typename T>
concept Estimator = std::is_nothrow_constructible_v<T, const typename T::Options&> &&
    requires(T estimator, const T& fed, double time_s, const Press& sample) {
  requires noexcept(estimator.update(time_s, sample));
  requires noexcept(fed.estimate());
  requires std::is_convertible_v<decltype(fed.estimate()), TissueEstimate>;
};

/// A press is well foretold when half of its 95 % band is at most this share of its force.
inline constexpr double well_foretold_share = 0.15;

/// Normalised innovation squared beyond which the law does not describe what is felt, and its
/// parameters mean nothing: somebody coughs, tenses, or the tool slips.
inline constexpr double max_nis = 4.0;

/// An estimator that may decide forces in a session: it tells whether the law fits, how well
/// stiffness is known, how well a press of some force is foretold and how deep it goes, whether the
/// last press came otherwise than it had foretold. It is told when the tool goes to the next place,
/// and that the contact which is over may be remembered as of this person.
template <typename T>
concept SteeringEstimator = Estimator<T> && requires(T estimator, const T& fed, double force_n) {
  requires noexcept(estimator.next_place());
  requires noexcept(estimator.keep_person());
  requires std::is_same_v<decltype(fed.nis()), double>;
  requires std::is_same_v<decltype(fed.stiffness_sd(force_n)), double>;
  requires std::is_same_v<decltype(fed.force_half_width(force_n)), double>;
  requires std::is_same_v<decltype(fed.deepening_m(force_n)), double>;
  requires std::is_same_v<decltype(fed.surprised()), bool>;
};

}  // namespace tuina::tissue
