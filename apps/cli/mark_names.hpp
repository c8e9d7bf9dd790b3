// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/cli/mark_words.hpp"
#include "tuina/body/acupoints.hpp"

namespace tuina::app {

/// A mark on the skin, as a scan has shown it.
struct SkinMark {
  std::string kind;  ///< as its group has it
  Vector3 at_in_couch = Vector3::Zero();
};

/// Which mark, by its index, is which point. Those of one kind are told apart by their level along
/// the spine, pairs by their side, in the frame that an atlas has found on this person. Fails when
/// a mark is missing or too many, when the order cannot be told, and when a mark lies more than
/// `max_off_m` from where the atlas expects its point.
[[nodiscard]] Result<std::map<std::string, std::size_t>> name_marks(
    const std::vector<SkinMark>& marks, const std::vector<MarkGroup>& groups,
    const body::Mapping& expected, double max_off_m);

}  // namespace tuina::app
