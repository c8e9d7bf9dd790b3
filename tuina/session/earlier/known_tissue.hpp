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

/// What an earlier session has felt, and where its scan found the acupoints. Without places only
/// whether this is the same person is of interest.
struct KnownTissue {
  BodyPosture position = BodyPosture::sitting;
  std::vector<Acupoint> lay;  ///< where its scan found the acupoints
  std::vector<KnownPlace> places;
};

/// Largest distance between a place and where the fitted motion of all acupoints puts it, up to
/// which its tissue counts as known; and the relative change of stiffness per metre of that
/// distance, assumed as about half of that from bone to muscle.
inline constexpr double max_place_offset_m = 5e-3, change_along_skin_per_m = 30.0;

/// The places whose tissue still counts in a new scan, and a sentence for people.
struct Recognised {
  std::vector<KnownPlace> places;
  Sentence note;  ///< empty where nothing was known, or the same person was seen without places
};
/// Places of `known` that still count where a scan finds the acupoints at `now`. None in another
/// position, or where the acupoints are those of somebody else (`max_other_misfit_m`). A place that
/// is off by more than `max_place_offset_m` is left out; the `log_sd` of the others grows with
/// their offset.
[[nodiscard]] Recognised recognised(const KnownTissue& known, BodyPosture position,
                                    std::span<const Acupoint> now);

/// What a first press says of a place that is known.
enum class KnownMatch : std::uint8_t {
  holds,    ///< it came as known, closely enough to rely on it
  unclear,  ///< too wide an error to tell
  differs,  ///< it came otherwise
};
/// Compares ln alpha and ln beta: `known_sd` is the standard deviation of each known one,
/// `felt_covariance` that of the felt ones. `differs` at the 5 % level (chi-squared, two degrees of
/// freedom); else `holds` where the 95 % interval of the depth at `force_n` reaches to less than
/// half as much again, and `unclear` where it is wider.
[[nodiscard]] KnownMatch match(const TangentTissue& known, double known_sd,
                               const TangentTissue& felt, const Eigen::Matrix2d& felt_covariance,
                               double force_n) noexcept;

}  // namespace tuina::session
