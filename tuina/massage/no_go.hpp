// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"

namespace tuina::massage {

/// A part of the back that the therapist has ruled out, by its corners on the scan, in order.
struct NoGo {
  std::string name;
  std::vector<Vector3> corners_in_couch;
};

/// Reads `[[no_go]]` entries with `name` and `corners_m`, three corners at least. Everything wrong
/// is in the one message, a line each; a file that rules nothing out is refused too.
[[nodiscard]] Result<std::vector<NoGo>> parse_no_go(std::string_view text, std::string_view name);
/// Reads such a file; fails as parse_no_go() does, and where there is no such file.
[[nodiscard]] Result<std::vector<NoGo>> read_no_go(const std::filesystem::path& file);

}  // namespace tuina::massage
