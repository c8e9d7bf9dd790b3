// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "apps/cli/options.hpp"
#include "tuina/core/acupoint.hpp"

namespace tuina::app {

/// The posture that a word names; nothing for `auto`, where the scan shall tell.
[[nodiscard]] std::optional<BodyPosture> posture_of(std::string_view word);

/// `--position`, as the command line has it.
class PositionOption {
 public:
  /// `about` says of whom, or what `auto` is.
  Option describe(Options& options, const std::string& about);
  [[nodiscard]] std::optional<BodyPosture> position() const { return posture_of(word_); }

 private:
  std::string word_ = "auto";
};

}  // namespace tuina::app
