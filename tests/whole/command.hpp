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

/// Runs the tuina binary as a user would, without a terminal. One that lasts longer than `max_s` is
/// ended, with exit code 124: a robot waits for its host, and its host may have failed.
[[nodiscard]] Outcome run_tuina(const std::vector<std::string>& arguments, int max_s = 0);

}  // namespace tuina::test
