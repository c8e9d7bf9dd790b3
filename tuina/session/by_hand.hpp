// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/no_go.hpp"

namespace tuina::session {

/// What people have said of a back by hand, in the couch frame of one scan of it.
struct ByHand {
  std::vector<massage::NoGo> no_go;        ///< places ruled out
  std::vector<body::PalpatedPoint> fixed;  ///< points that a finger has shown
};

/// The answer of somebody who has looked at a plan. `change` asks for another plan, with `wanted`
/// in place of what was wanted before and beside what the order rules out.
struct Review {
  enum class Answer : std::uint8_t { no, go, change } answer = Answer::no;
  ByHand wanted = {};
};

/// The same said of a later scan: places move with the person, by the rigid motion that fits the
/// acupoints of both scans best ([umeyama1991], without scale). Fails (Fault::bad_input) where the
/// points did not move as one body, for then nobody knows where a place that was ruled out is now.
[[nodiscard]] Result<ByHand> carried(const ByHand& said, std::span<const Acupoint> then,
                                     std::span<const Acupoint> now);

}  // namespace tuina::session
