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

/// Corrections that people have made by hand, in the couch frame of one scan of a back.
struct ByHand {
  std::vector<massage::NoGo> no_go;        ///< places ruled out
  std::vector<body::PalpatedPoint> fixed;  ///< points that a finger has shown
};

/// Corrections by hand, and the acupoints that the scan they belong to has shown by itself. Without
/// acupoints they belong to the scan that is about to be made.
struct Said {
  ByHand by_hand;
  std::vector<Acupoint> lay;  ///< where the scan found the acupoints, without any correction
  /// Whether nothing was said.
  [[nodiscard]] bool empty() const { return by_hand.no_go.empty() && by_hand.fixed.empty(); }
};
/// Largest RMS distance between the acupoints of two scans, after the rigid motion that fits them
/// best: of a person who has moved within a session, and in another session, where somebody else
/// has to be noticed.
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

/// The corrections brought to a later scan, whose acupoints are `now`: their places move by the
/// fitted motion. Fails (Fault::bad_input) where fewer than three acupoints are in both, or where
/// these did not move as one body, for then nobody knows where a place that was ruled out is now.
[[nodiscard]] Result<ByHand> carried(const Said& said, std::span<const Acupoint> now,
                                     double max_misfit_m);
/// The corrections of both; a point of `more` takes the place of the one with the same name.
[[nodiscard]] ByHand joined(ByHand said, const ByHand& more);

}  // namespace tuina::session
