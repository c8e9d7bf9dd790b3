// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/password.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <new>

#include "tuina/core/io/file.hpp"
#include "tuina/web/access.hpp"

namespace tuina::web {
namespace {

// What OWASP asks of scrypt where a guess may take 32 MB: N = 2^15, r = 8, p = 1 would be its
// second choice; a login waits for it, and nothing else does.
constexpr std::string_view scheme = "scrypt 32768 8 1";
constexpr std::uint64_t cost = 32768, block = 8, lanes = 1, max_memory = 64U << 20U;
constexpr std::size_t digits = 64;
constexpr std::string_view for_viewers = "viewers ";

std::string scrypt(std::string_view password, std::string_view salt) {
  std::array<unsigned char, digits / 2> key{};
  if (EVP_PBE_scrypt(password.data(), password.size(),
                     reinterpret_cast<const unsigned char*>(salt.data()), salt.size(), cost, block,
                     lanes, max_memory, key.data(), key.size()) != 1)
    throw std::bad_alloc();  // of these constants, only memory can be missing
  std::string hex;
  for (const unsigned char byte : key) hex += fmt::format("{:02x}", byte);
  return hex;
}

bool is_hex(std::string_view text) {
  return text.size() == digits && std::all_of(text.begin(), text.end(), [](char letter) {
           return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'f');
         });
}

}  // namespace

Result<void> check_not_open_to_all(const std::filesystem::path& file) {
  std::error_code fault;
  const auto mode = std::filesystem::status(file, fault).permissions();
  const bool open = (mode & std::filesystem::perms::others_read) != std::filesystem::perms::none;
  if (!fault && open)
    return fail(Fault::bad_input, "{}: everybody on this machine may read it: chmod 600",
                file.string());
  return {};
}

Result<Password> Password::make(std::string_view password) {
  if (password.size() < min_password_bytes || password.size() > max_password_bytes)
    return fail(Fault::usage, "the password has {} bytes: from {} to {} are taken", password.size(),
                min_password_bytes, max_password_bytes);
  const std::string salt = random_token();
  return Password(salt, scrypt(password, salt));
}

std::optional<Password> Password::parse(std::string_view line) {
  constexpr std::size_t salt_at = scheme.size() + 1, hash_at = salt_at + digits + 1;
  if (line.size() != hash_at + digits || !line.starts_with(scheme) || line[salt_at - 1] != ' ' ||
      line[hash_at - 1] != ' ')
    return std::nullopt;
  const std::string_view salt = line.substr(salt_at, digits), hash = line.substr(hash_at);
  if (!is_hex(salt) || !is_hex(hash)) return std::nullopt;
  return Password(std::string(salt), std::string(hash));
}

std::string Password::line() const {
  return fmt::format("{} {} {}", scheme, salt_, hash_);
}

bool Password::matches(std::string_view password) const {
  if (password.size() > max_password_bytes) return false;
  return same_secret(scrypt(password, salt_), hash_);
}

Result<Passwords> Passwords::read(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 4096;
  auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  if (auto closed = check_not_open_to_all(file); !closed) return tl::unexpected(closed.error());
  std::string_view rest = *text;
  const auto take_line = [&rest] {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    return line;
  };
  const auto operators = Password::parse(take_line());
  std::optional<Password> viewers;
  if (rest.starts_with(for_viewers)) {
    rest.remove_prefix(for_viewers.size());
    viewers = Password::parse(take_line());
    if (!viewers) rest = *text;
  }
  if (operators && rest.empty()) return Passwords{*operators, viewers};
  return fail(Fault::bad_input,
              "{}: this is no password file: tuina serve --make-password FILE makes one",
              file.string());
}

std::string Passwords::text() const {
  const std::string first = operators.line() + "\n";
  return viewers ? fmt::format("{}{}{}\n", first, for_viewers, viewers->line()) : first;
}

std::optional<Role> Passwords::role_of(std::string_view password) const {
  if (operators.matches(password)) return Role::operate;
  if (viewers && viewers->matches(password)) return Role::watch;
  return std::nullopt;
}

}  // namespace tuina::web
