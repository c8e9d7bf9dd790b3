// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/web/rate.hpp"
#include "tuina/web/request.hpp"

namespace tuina::web {

/// 32 random bytes of the system, as 64 hexadecimal digits. Ends the program where the system has
/// none to give.
[[nodiscard]] std::string random_token();
/// Compares in a time that does not tell where two texts differ.
[[nodiscard]] bool same_secret(std::string_view one, std::string_view other) noexcept;

/// The loopback address to listen at. Refused (Fault::usage): any other address, since there is no
/// encryption and no password.
[[nodiscard]] Result<std::string> loopback_address(const std::string& listen);

/// Who may come in. A page is opened once with a token, in the address that the terminal printed,
/// and known by a cookie from then on. A Host that is not this machine is another name for it,
/// given by somebody who wants a browser to ask here; an Origin that is not this server is another
/// person's page.
///
/// Another program that watches (`foxglove::path`) has no cookie and comes again by the same
/// address, so it shows a token of its own each time: one that is good until the server ends. A
/// cookie does not let it in, since a browser shows that for any page of this machine.
class Access {
 public:
  /// For a server at this port of this machine.
  explicit Access(int port);

  /// An address that opens the page, once.
  [[nodiscard]] std::string invite();
  /// The token that other programs show.
  [[nodiscard]] const std::string& program_token() const { return program_token_; }
  /// The reply to whom is not let in, or who has just shown a token; nothing for whom may go on.
  [[nodiscard]] std::optional<Reply> judge(const Request& request, double now_s);

 private:
  [[nodiscard]] bool knows(std::string_view cookies) const;
  [[nodiscard]] bool is_host(std::string_view name) const;
  [[nodiscard]] Reply refuse_token(double now_s, const char* why);
  [[nodiscard]] std::optional<Reply> exchange(std::string_view token, double now_s);
  [[nodiscard]] std::optional<Reply> judge_program(const Request& request, double now_s);

  std::string cookie_name_;  ///< with the port, since ports share their cookies
  std::vector<std::string> hosts_;
  std::vector<std::string> tokens_;   ///< given and not used yet
  std::vector<std::string> cookies_;  ///< of those who are in
  std::string program_token_ = random_token();
  Rate bad_tokens_;
};

}  // namespace tuina::web
