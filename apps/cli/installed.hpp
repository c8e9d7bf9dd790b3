// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace tuina::app {

/// Where a file or folder lies that is shipped with the program: below share/tuina beside an
/// installed program, or where it was when the program was built.
[[nodiscard]] inline std::filesystem::path installed_or(const char* name,
                                                        std::filesystem::path built) {
  std::error_code fault;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", fault);
  auto installed = program.parent_path().parent_path() / "share/tuina" / name;
  return std::filesystem::exists(installed, fault) ? installed : built;
}

}  // namespace tuina::app
