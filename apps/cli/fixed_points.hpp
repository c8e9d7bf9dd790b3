// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/result.hpp"

namespace tuina::app {

/// Options `--fix` and `--fix-error-mm`: points that a therapist's finger has shown.
struct FixedPoints {
  std::vector<std::string> words;  ///< NAME=x,y,z
  double error_mm = 3.0;

  void describe(Options& options);
  [[nodiscard]] Result<std::vector<body::PalpatedPoint>> read() const;
};

}  // namespace tuina::app
