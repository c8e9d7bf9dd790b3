// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/folder.hpp"

namespace tuina::test {

struct Outcome {
  int exit_code = -1;
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};

/// Runs the tuina binary as a user would, without a terminal.
[[nodiscard]] Outcome run_tuina(const std::vector<std::string>& arguments);

}  // namespace tuina::test
