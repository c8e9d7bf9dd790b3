// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/result.hpp"

namespace tuina::app {

/// Asks for a password, twice and unseen at a terminal, once as a line of another input, and writes
/// what it is known by (`web::Password`) into a file that its owner alone may read.
[[nodiscard]] Result<void> make_password_file(const std::filesystem::path& file);

}  // namespace tuina::app
