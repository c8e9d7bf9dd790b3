// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tuina/web/request.hpp"

namespace tuina::web {

/// What became of a password.
enum class LoginAnswer : std::uint8_t { nothing, wrong, too_often };

/// The page that asks for the password, in both languages; it needs no script and nothing else.
[[nodiscard]] Reply login_page(LoginAnswer answer);

/// The password of the form that the page sends; empty: there is none.
[[nodiscard]] std::string password_of(std::string_view form);

}  // namespace tuina::web
