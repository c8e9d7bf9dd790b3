// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/core/result.hpp"

namespace tuina::test {

/// Why there is no value, for the message of a check that there is one. With `-s` doctest writes
/// the messages of checks that hold, too, and then there is no error to ask.
template <typename T>
[[nodiscard]] std::string reason(const Result<T>& result) {
  return result ? std::string() : result.error().message;
}

}  // namespace tuina::test
