// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace tuina::app {

/// Where a file or folder lies that is shipped with the program: in share/tuina above the program,
/// or the library that an interpreter has loaded, or where it was when it was built.
[[nodiscard]] std::filesystem::path installed_or(const char* name, std::filesystem::path built);

/// The shipped atlas.
[[nodiscard]] std::filesystem::path shipped_atlas_path();

}  // namespace tuina::app
