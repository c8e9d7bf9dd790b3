// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/position_option.hpp"

namespace tuina::app {

std::optional<BodyPosture> posture_of(std::string_view word) {
  for (const BodyPosture posture : {BodyPosture::sitting, BodyPosture::prone}) {
    if (word == name_of(posture)) return posture;
  }
  return std::nullopt;
}

Option PositionOption::describe(Options& options, const std::string& about) {
  return options.add("--position", word_, about)
      .one_of({"auto", "sitting", "prone"})
      .show_default();
}

}  // namespace tuina::app
