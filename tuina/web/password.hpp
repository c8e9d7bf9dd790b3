// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/web/role.hpp"

namespace tuina::web {

/// A password has at least so many bytes, and at most so many.
inline constexpr std::size_t min_password_bytes = 12, max_password_bytes = 256;

/// What a password can be known by and not be read from: salt and scrypt of it (RFC 7914), which
/// takes 32 MB and a tenth of a second, so that guesses at a file that was stolen are dear. Written
/// it is `scrypt 32768 8 1 SALT HASH`, the last two in hexadecimal digits.
class Password {
 public:
  /// With a salt of its own. Fault::usage: the password is too short or too long.
  [[nodiscard]] static Result<Password> make(std::string_view password);
  /// Nothing: it is not what `line` writes.
  [[nodiscard]] static std::optional<Password> parse(std::string_view line);

  [[nodiscard]] std::string line() const;  ///< without an end
  /// Whether it is this one, in a time that does not tell how nearly.
  [[nodiscard]] bool matches(std::string_view password) const;

 private:
  Password(std::string salt, std::string hash) : salt_(std::move(salt)), hash_(std::move(hash)) {}
  std::string salt_, hash_;  ///< hexadecimal
};

/// By which passwords people come in. Their file has a line for those who may take control, and, if
/// it has a second one, `viewers` and another password, for those who may watch and stop.
struct Passwords {
  Password operators;
  std::optional<Password> viewers = {};

  /// Fault::file: it cannot be read. Fault::bad_input: others may read it, or it is no such file.
  [[nodiscard]] static Result<Passwords> read(const std::filesystem::path& file);
  [[nodiscard]] std::string text() const;  ///< content of the file
  /// What the password opens; nothing: it is neither.
  [[nodiscard]] std::optional<Role> role_of(std::string_view password) const;
};

/// Fault::bad_input where a file that holds a secret may be read by others than its owner's group.
[[nodiscard]] Result<void> check_not_open_to_all(const std::filesystem::path& file);

}  // namespace tuina::web
