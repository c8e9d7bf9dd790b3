// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// How fast the time of a simulation runs, as the command line has it.
class PaceOption {
 public:
  /// `--pace`: `max`, `real`, or a number from 0.1 to 20; `usual` says what it is where not given.
  Option describe(Options& options, const std::string& usual);
  /// `record::SessionOrder::pace`: nothing for `max`, 1 for `real`, `usual` where none was given.
  [[nodiscard]] std::optional<double> pace(std::optional<double> usual) const;

 private:
  std::string word_;  ///< empty: not given
};

/// Whether arms that are no part of this program can keep that pace: theirs is real, or they wait.
[[nodiscard]] Result<void> suits_other_arms(const std::optional<double>& pace);

}  // namespace tuina::app
