// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace tuina::app {

/// Where a file or folder lies that is shipped with the program: in share/tuina beside the bin or
/// lib that the program is in, or the library that an interpreter has loaded; else where it was
/// when it was built.
[[nodiscard]] std::filesystem::path installed_or(const char* name, std::filesystem::path built);

/// The shipped atlas.
[[nodiscard]] std::filesystem::path shipped_atlas_path();

}  // namespace tuina::app
