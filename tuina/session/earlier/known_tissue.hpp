// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::session {

/// Tissue of one place as an earlier session has felt it.
struct KnownPlace {
  std::string name;  ///< acupoint
  TangentTissue tissue;
  /// Standard deviation of the logarithm of its stiffness as it may be now: that of the estimate,
  /// from day to day, and by the offset of the place.
  double log_sd = 0.0;
};

/// What an earlier session has felt, and where its scan found the acupoints.
struct KnownTissue {
  BodyPosture position = BodyPosture::sitting;
  std::vector<Acupoint> lay;
  std::vector<KnownPlace> places;
};

/// Largest offset of a place against the other acupoints for which its tissue counts as known, and
/// the relative change of stiffness along the skin. The latter is assumed: from bone to muscle
/// stiffness changes by about twice as much.
inline constexpr double max_place_offset_m = 5e-3, change_along_skin_per_m = 30.0;

/// The places whose tissue still counts in a new scan, and a sentence for people.
struct Recognised {
  std::vector<KnownPlace> places;
  Sentence note;  ///< empty where nothing was known
};
/// None where the position is another one or the acupoints are those of somebody else
/// (`max_other_misfit_m`); without places that lie elsewhere among the acupoints than they did, the
/// others widened by their offset.
[[nodiscard]] Recognised recognised(const KnownTissue& known, BodyPosture position,
                                    std::span<const Acupoint> now);

/// What a first press says of a place that is known.
enum class KnownMatch : std::uint8_t {
  holds,    ///< it came as known, closely enough to rely on it
  unclear,  ///< too wide an error to tell
  differs,  ///< it came otherwise
};
/// Compares ln alpha and ln beta of both, known to `known_sd` each and felt with `felt_covariance`.
/// Differs where only 5 of 100 that have not changed would be so far apart; unclear where a depth
/// at `force_n` of half as much again would not differ.
[[nodiscard]] KnownMatch match(const TangentTissue& known, double known_sd,
                               const TangentTissue& felt, const Eigen::Matrix2d& felt_covariance,
                               double force_n) noexcept;

}  // namespace tuina::session
