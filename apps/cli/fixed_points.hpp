// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/result.hpp"

namespace CLI {
class App;
}

namespace tuina::app {

/// Options `--fix` and `--fix-error-mm`: points that a therapist's finger has shown.
struct FixedPoints {
  std::vector<std::string> words;  ///< NAME=x,y,z
  double error_mm = 3.0;

  void describe(CLI::App& command);
  [[nodiscard]] Result<std::vector<body::PalpatedPoint>> read() const;
};

}  // namespace tuina::app
