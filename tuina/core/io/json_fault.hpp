// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <string_view>

#include "tuina/core/result.hpp"

namespace tuina {

/// Error for an exception that reading JSON threw, in words for people. Text that is no JSON is
/// named with its line; of content that does not fit, the message says that it is not `wanted`
/// ("the labels of a body") and why. `name` stands for the file. An exception of the caller's own
/// keeps its words.
[[nodiscard]] Error json_fault(const std::exception& fault, std::string_view text,
                               std::string_view name, std::string_view wanted);

}  // namespace tuina
