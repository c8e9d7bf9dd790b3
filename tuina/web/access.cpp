// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/access.hpp"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "tuina/web/foxglove.hpp"
#include "tuina/web/login.hpp"

namespace tuina::web {
namespace {

constexpr std::int64_t max_body_bytes = 1 << 20;
constexpr std::size_t max_invitations = 16;
constexpr std::size_t max_guests = 256;
// Five wrong tokens a minute, and five wrong passwords.
constexpr double guesses_at_once = 5.0, guesses_per_s = 5.0 / 60.0;
constexpr std::string_view token_key = "token=";
// Foxglove in a browser, and viewers that a desktop opens from its disk. Origins of others are
// refused; a program that is no browser sends none.
constexpr std::array<std::string_view, 2> program_origins = {"https://app.foxglove.dev", "file://"};

Reply refuse(int status, const char* why) {
  return {.status = status, .body = std::string(why) + "\n"};
}

}  // namespace

std::string random_token() {
  std::array<unsigned char, 32> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) std::abort();
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool same_secret(std::string_view one, std::string_view other) noexcept {
  return one.size() == other.size() && CRYPTO_memcmp(one.data(), other.data(), one.size()) == 0;
}

Result<std::string> loopback_address(const std::string& listen) {
  if (listen == "127.0.0.1" || listen == "localhost") return std::string("127.0.0.1");
  return fail(
      Fault::usage,
      "--listen {}: a network sees the page with --certificate FILE and --password-file FILE "
      "only; without them it is for this machine itself, 127.0.0.1",
      listen);
}

Access::Access(int port) : Access(port, {"127.0.0.1", "localhost", "[::1]"}, false) {}

Access::Access(int port, const std::vector<std::string>& hosts) : Access(port, hosts, true) {}

// A browser takes a cookie named `__Host-` from nobody but this host itself, by TLS.
Access::Access(int port, std::vector<std::string> hosts, bool by_tls)
    : by_tls_(by_tls),
      cookie_name_(fmt::format("{}tuina_{}", by_tls ? "__Host-" : "", port)),
      hosts_(std::move(hosts)),
      bad_tokens_(guesses_at_once, guesses_per_s),
      bad_passwords_(guesses_at_once, guesses_per_s) {
  const int left_out = by_tls ? 443 : 80;  // by browsers
  for (std::string& host : hosts_)
    if (port != left_out) host += fmt::format(":{}", port);
}

std::string Access::invite(Role role) {
  if (invitations_.size() == max_invitations) invitations_.erase(invitations_.begin());
  return invitations_.emplace_back(Invitation{random_token(), role}).token;
}

std::optional<Guest> Access::find_guest(std::string_view cookies) const {
  const std::string name = cookie_name_ + "=";
  for (std::size_t at = 0; at < cookies.size();) {
    const std::size_t end = std::min(cookies.find(';', at), cookies.size());
    std::string_view one = cookies.substr(at, end - at);
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.starts_with(name)) {
      const std::string_view value = one.substr(name.size());
      // Every cookie is compared, so that the time does not tell which one it nearly was.
      const Guest* known = nullptr;
      for (const Guest& guest : guests_)
        if (same_secret(value, guest.cookie)) known = &guest;
      if (known != nullptr) return *known;
    }
    at = end + 1;
  }
  return std::nullopt;
}

std::optional<Reply> Access::exchange(const Request& request, double now_s) {
  const std::string_view token = std::string_view(request.query).substr(token_key.size());
  const auto given =
      std::find_if(invitations_.begin(), invitations_.end(),
                   [&](const Invitation& one) { return same_secret(one.token, token); });
  if (given == invitations_.end()) {
    // Who has guessed too often is not told whether the next guess is right.
    return refuse_token(now_s, "this address was used already, or never given: ask for a new one");
  }
  const Role role = given->role;
  invitations_.erase(given);
  Reply reply = with_cookie(role);
  if (request.fetch_site != "cross-site") return reply;
  // A link in a mail or a chat: a browser would follow it on without the cookie, which is for what
  // begins here.
  reply.status = 200;
  reply.type = "text/html; charset=utf-8";
  reply.body =
      "<!doctype html><meta http-equiv=refresh content=\"0;url=/\"><a href=\"/\">tuina</a>";
  reply.headers.erase(reply.headers.begin());
  return reply;
}

Reply Access::with_cookie(Role role) {
  if (guests_.size() == max_guests) guests_.erase(guests_.begin());
  const std::string& cookie = guests_.emplace_back(Guest{random_token(), role}).cookie;
  return {
      .status = 303,
      .headers = {{"Location", "/"},
                  {"Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/{}",
                                             cookie_name_, cookie, by_tls_ ? "; Secure" : "")}}};
}

Reply Access::let_in(Role role) {
  bad_passwords_.give_back();
  return with_cookie(role);
}

Reply Access::leave(const Request& request) {
  const auto gone = find_guest(request.cookie);
  std::erase_if(guests_, [&](const Guest& one) { return gone && one.cookie == gone->cookie; });
  return {
      .status = 303,
      .headers = {{"Location", "/"},
                  {"Set-Cookie", fmt::format("{}=; HttpOnly; SameSite=Strict; Path=/; Max-Age=0{}",
                                             cookie_name_, by_tls_ ? "; Secure" : "")}}};
}

bool Access::is_own_page(std::string_view origin) const {
  const std::string_view scheme = by_tls_ ? "https://" : "http://";
  return origin.starts_with(scheme) && is_host(origin.substr(scheme.size()));
}

bool Access::is_host(std::string_view name) const {
  return std::find(hosts_.begin(), hosts_.end(), name) != hosts_.end();
}

Reply Access::refuse_token(double now_s, const char* why) {
  if (!bad_tokens_.take(now_s)) return refuse(429, "too many wrong tokens; wait a minute");
  return refuse(401, why);
}

std::optional<Reply> Access::judge_program(const Request& request, double now_s) {
  const std::string_view origin = request.origin;
  const bool known = origin.empty() || is_own_page(origin);
  if (!known &&
      std::find(program_origins.begin(), program_origins.end(), origin) == program_origins.end())
    return refuse(403, "programs of this origin may not watch");
  if (request.method != "GET" || !request.upgrade)
    return refuse(405, "only a WebSocket opens here");
  const std::string_view query = request.query;
  if (!query.starts_with(token_key) || !same_secret(query.substr(token_key.size()), program_token_))
    return refuse_token(now_s, "take the address with the token, as the terminal printed it");
  if (!foxglove::offers(request.subprotocols))
    return refuse(400, "offer the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1");
  return std::nullopt;
}

std::optional<Reply> Access::judge(const Request& request, double now_s) {
  if (!is_host(request.host)) return refuse(403, "this is not the name of this server");
  if (request.body_bytes > max_body_bytes) return refuse(413, "too much");
  if (request.path == foxglove::path) return judge_program(request, now_s);
  // A page of the server itself says so where it posts or opens a socket.
  const bool posts = by_tls_ && request.method == "POST";
  if (!is_own_page(request.origin) && (!request.origin.empty() || request.upgrade || posts))
    return refuse(403, "another page may not ask here");
  if (posts) return judge_post(request, now_s);
  if (request.method != "GET") return refuse(405, "only GET; commands go through the WebSocket");
  if (request.path == "/" && request.query.starts_with(token_key)) return exchange(request, now_s);
  if (find_guest(request.cookie)) return std::nullopt;
  if (by_tls_ && (request.path == "/" || request.path == login_path))
    return login_page(LoginAnswer::nothing);
  return refuse(401, "open the address that the terminal printed, or that an operator gave you");
}

std::optional<Reply> Access::judge_post(const Request& request, double now_s) {
  if (request.path == logout_path && find_guest(request.cookie)) return leave(request);
  if (request.path != login_path) return refuse(405, "only GET; commands go through the WebSocket");
  if (request.body_bytes < 0 || request.body_bytes > max_form_bytes)
    return refuse(413, "no password is as long");
  if (!bad_passwords_.take(now_s)) return login_page(LoginAnswer::too_often);
  return std::nullopt;
}

}  // namespace tuina::web
