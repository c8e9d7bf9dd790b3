// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "tuina/web/ask.hpp"
#include "tuina/web/rate.hpp"
#include "tuina/web/role.hpp"

namespace tuina::web {

/// One open page, for as long as its connection lasts.
using ClientId = std::uint64_t;

/// Why an ask is not done.
enum class Refusal : std::uint8_t { none, too_fast, out_of_order, stale, viewer, taken, not_held };
[[nodiscard]] const char* name_of(Refusal refusal) noexcept;

/// A message may be so old; its clock may run ahead by as much.
inline constexpr double max_age_s = 0.5;
/// An operator who is silent for so long is none any more.
inline constexpr double lease_s = 2.0;
/// The button that arms is held so long, and then asked for so soon.
inline constexpr double hold_s = 2.0;
inline constexpr double max_hold_s = 10.0;
/// Messages of one page in a second.
inline constexpr double max_messages_per_s = 20.0;

/// Decides who may ask for what. Whoever has a page open may stop: at any rate, at any age, at any
/// time. `Role::watch` may do nothing else but `beat`. `Role::operate` may `operate` and invite;
/// all else is for the one operator, whose lease ends when their page falls silent. Times are
/// seconds of one monotonic clock.
class Desk {
 public:
  /// @{
  /// A client has come or gone.
  void come(ClientId client, double now_s, Role role = Role::operate);
  void go(ClientId client);
  /// @}
  /// Takes note of the message, so that it counts once.
  [[nodiscard]] Refusal judge(ClientId client, const Message& message, double now_s);

  /// Who may steer at this time; nobody where their page has fallen silent.
  [[nodiscard]] std::optional<ClientId> operator_at(double now_s) const;
  /// Number of clients.
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

 private:
  struct Client {
    Role role = Role::operate;
    std::uint64_t sequence = 0;
    double heard_s = 0.0;
    double held_s = -1.0;  ///< time at which the button went down; -1: it is up
    Rate rate{max_messages_per_s, max_messages_per_s};
  };
  [[nodiscard]] Refusal judge_operator(ClientId client, Client& from, Ask ask, double now_s);

  std::map<ClientId, Client> clients_;
  std::optional<ClientId> operator_;
};

}  // namespace tuina::web
