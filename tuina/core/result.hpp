// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace tuina {

/// Kinds of failure, by what the caller can do.
enum class Fault : std::uint8_t {
  usage,      ///< the command was used wrongly: correct the call
  not_found,  ///< what was looked for is not there: change the scene
  bad_input,  ///< data are malformed or implausible: correct the data
  config,     ///< a configuration key or value is wrong: correct the file
  file,       ///< a file cannot be opened, read or written
  device,     ///< a camera, motor, sensor or arm fails
  stopped,    ///< stopped for safety
};

/// Why something could not be done.
struct Error {
  Fault fault;
  std::string message;  ///< a sentence for people, with the numbers in it
};

/// A value, or why there is none.
template <typename T>
using Result = tl::expected<T, Error>;

/// `return fail(Fault::not_found, "{} of {} rows lit, {} needed", lit, rows, enough);`
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> fail(Fault fault, fmt::format_string<Args...> format,
                                         Args&&... args) {
  return tl::unexpected(Error{fault, fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace tuina
