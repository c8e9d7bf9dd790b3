// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tuina/core/result.hpp"
#include "tuina/web/role.hpp"

namespace tuina::app {

/// Asks for a password, twice and unseen at a terminal, once as a line of another input, and writes
/// what it is known by (`web::Passwords`) into a file that its owner alone may read. The password
/// of the other role stays where the file has one; that of viewers is added to a file that is
/// there.
[[nodiscard]] Result<void> make_password_file(const std::filesystem::path& file, web::Role role);

}  // namespace tuina::app
