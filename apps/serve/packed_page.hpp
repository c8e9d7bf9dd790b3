// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina::app {

/// A file of the page, as gzip, that the build has put into the program; empty where node had not
/// built the page.
[[nodiscard]] std::string_view packed_page(std::string_view name);

/// What was packed as gzip. Fault::bad_input: it is none, or has more than 16 MB.
[[nodiscard]] Result<std::string> unpacked(std::string_view gzip);

}  // namespace tuina::app
