// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/no_go.hpp"

namespace tuina::session {

/// What people have said of a back by hand, in the couch frame of one scan of it.
struct ByHand {
  std::vector<massage::NoGo> no_go;        ///< places ruled out
  std::vector<body::PalpatedPoint> fixed;  ///< points that a finger has shown
};

/// What was said by hand, and where the acupoints were found, by the scan alone, in the scan of
/// which it was said. Without points it was said of the scan that comes.
struct Said {
  ByHand by_hand;
  std::vector<Acupoint> lay;
  /// Whether nothing was said.
  [[nodiscard]] bool empty() const { return by_hand.no_go.empty() && by_hand.fixed.empty(); }
};
/// RMS distance of the acupoints of two scans of one person: after the person has moved, and in
/// another session, which must not be somebody else's.
inline constexpr double max_moved_misfit_m = 15e-3, max_other_misfit_m = 6e-3;

/// The answer of somebody who has looked at a plan. `change` asks for another plan, with `wanted`
/// in place of what was wanted before and beside what the order rules out.
struct Review {
  /// No massage, this plan, or another one.
  enum class Answer : std::uint8_t { no, go, change } answer = Answer::no;
  ByHand wanted = {};
};

/// How a person lies in a later scan: the rigid motion that fits the acupoints of both scans best
/// ([umeyama1991], without scale), and the RMS distance that it leaves.
struct FittedMotion {
  Transform now_from_then = Transform::Identity();
  double misfit_m = 0.0;
};
/// Fails (Fault::bad_input) where fewer than three acupoints are in both.
[[nodiscard]] Result<FittedMotion> fit_motion(std::span<const Acupoint> then,
                                              std::span<const Acupoint> now);

/// The same said of a later scan: places move with the person, by the fitted motion. Fails
/// (Fault::bad_input) where the points did not move as one body, for then nobody knows where a
/// place that was ruled out is now.
[[nodiscard]] Result<ByHand> carried(const Said& said, std::span<const Acupoint> now,
                                     double max_misfit_m);
/// The same with more of it; a point that is said anew takes the place of what was said of it.
[[nodiscard]] ByHand joined(ByHand said, const ByHand& more);

}  // namespace tuina::session
