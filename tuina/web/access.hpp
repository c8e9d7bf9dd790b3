// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/web/rate.hpp"
#include "tuina/web/request.hpp"
#include "tuina/web/role.hpp"

namespace tuina::web {

/// 32 random bytes of the system, as 64 hexadecimal digits. Ends the program where the system has
/// none to give.
[[nodiscard]] std::string random_token();
/// Compares in a time that does not tell where two texts differ.
[[nodiscard]] bool same_secret(std::string_view one, std::string_view other) noexcept;

/// The loopback address to listen at. Refused (Fault::usage): any other address, since without
/// encryption and a password nothing is shown to a network.
[[nodiscard]] Result<std::string> loopback_address(const std::string& listen);

/// Who asks to be let in with a password, and who leaves: both by POST.
inline constexpr const char *login_path = "/login", *logout_path = "/logout";

/// Somebody who is in.
struct Guest {
  std::string cookie;
  Role role = Role::watch;
};

/// Who may come in, and as what. A page is opened once with a token, in the address that the
/// terminal printed, and known by a cookie from then on. A Host that is not this machine is another
/// name for it, given by somebody who wants a browser to ask here; an Origin that is not this
/// server is another person's page.
///
/// Another program that watches (`foxglove::path`) has no cookie and comes again by the same
/// address, so it shows a token of its own each time: one that is good until the server ends. A
/// cookie does not let it in, since a browser shows that for any page of this machine.
///
/// A server that is reached by TLS is for a network. Its hosts are those of its certificate, and a
/// password opens it, too. Who guesses passwords is slow after five, and so are all others then who
/// come with a password; an invitation opens all the same, and who is in stays in.
class Access {
 public:
  /// For a server at this port of this machine.
  explicit Access(int port);
  /// For one that is reached by TLS under these names.
  Access(int port, const std::vector<std::string>& hosts);

  /// A token that opens the page once.
  [[nodiscard]] std::string invite(Role role);
  /// The token that other programs show.
  [[nodiscard]] const std::string& program_token() const { return program_token_; }
  /// The reply to whom is not let in, or who has just shown a token, or leaves; nothing for whom
  /// may go on: to `login_path`, where the password is to be looked at, or anywhere with a cookie.
  [[nodiscard]] std::optional<Reply> judge(const Request& request, double now_s);
  /// Lets in whose password was right.
  [[nodiscard]] Reply let_in(Role role);
  /// Whose cookie is among these.
  [[nodiscard]] std::optional<Guest> find_guest(std::string_view cookies) const;

 private:
  Access(int port, std::vector<std::string> hosts, bool by_tls);
  [[nodiscard]] bool is_host(std::string_view name) const;
  [[nodiscard]] bool is_own_page(std::string_view origin) const;
  [[nodiscard]] Reply with_cookie(Role role);
  [[nodiscard]] Reply leave(const Request& request);
  [[nodiscard]] std::optional<Reply> judge_post(const Request& request, double now_s);
  [[nodiscard]] Reply refuse_token(double now_s, const char* why);
  [[nodiscard]] std::optional<Reply> exchange(const Request& request, double now_s);
  [[nodiscard]] std::optional<Reply> judge_program(const Request& request, double now_s);

  bool by_tls_;
  std::string cookie_name_;  ///< with the port, since ports share their cookies
  std::vector<std::string> hosts_;
  struct Invitation {
    std::string token;
    Role role;
  };
  std::vector<Invitation> invitations_;  ///< given and not used yet
  std::vector<Guest> guests_;
  std::string program_token_ = random_token();
  Rate bad_tokens_, bad_passwords_;
};

}  // namespace tuina::web
