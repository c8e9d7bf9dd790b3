// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina {

/// The whole of a file; fails with what was wrong and the path. `limit_bytes` bounds the memory it
/// may take.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::size_t limit_bytes = std::size_t{256} << 20);

/// Writes beside the target and renames, so a reader or a crash never sees half a file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::string_view content);

}  // namespace tuina
