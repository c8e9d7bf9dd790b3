// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/desk.hpp"

#include <array>
#include <utility>

namespace tuina::web {

const char* name_of(Refusal refusal) noexcept {
  constexpr std::array<const char*, 7> names = {"none",   "too_fast", "out_of_order", "stale",
                                                "viewer", "taken",    "not_held"};
  return names[static_cast<std::size_t>(refusal)];
}

void Desk::come(ClientId client, double now_s, Role role) {
  clients_[client] = {.role = role, .heard_s = now_s};
}

void Desk::go(ClientId client) {
  clients_.erase(client);
  if (operator_ == client) operator_.reset();
}

std::optional<ClientId> Desk::operator_at(double now_s) const {
  if (!operator_) return std::nullopt;
  const auto found = clients_.find(*operator_);
  const bool there = found != clients_.end() && now_s - found->second.heard_s <= lease_s;
  return there ? operator_ : std::nullopt;
}

Refusal Desk::judge(ClientId client, const Message& message, double now_s) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return Refusal::viewer;
  if (message.ask == Ask::stop) return Refusal::none;
  // Whose lease has run out does not get it back by speaking again.
  if (operator_ == client && operator_at(now_s) != client) operator_.reset();
  Client& from = found->second;
  if (!from.rate.take(now_s)) return Refusal::too_fast;
  if (message.sequence <= from.sequence) return Refusal::out_of_order;
  from.sequence = message.sequence;
  const double age_s = now_s - message.clock_s;
  if (age_s > max_age_s || age_s < -max_age_s) return Refusal::stale;
  from.heard_s = now_s;
  return judge_operator(client, from, message.ask, now_s);
}

Refusal Desk::judge_operator(ClientId client, Client& from, Ask ask, double now_s) {
  if (ask == Ask::beat) return Refusal::none;
  if (from.role == Role::watch) return Refusal::viewer;
  if (ask == Ask::invite || ask == Ask::invite_operator) return Refusal::none;
  const auto at_the_desk = operator_at(now_s);
  if (ask == Ask::operate) {
    if (at_the_desk && *at_the_desk != client) return Refusal::taken;
    operator_ = client;
    return Refusal::none;
  }
  if (at_the_desk != client) return Refusal::viewer;
  if (ask == Ask::hand_over) operator_.reset();
  if (ask == Ask::change) from.held_s = -1.0;  // whoever holds the button sees another plan soon
  if (ask == Ask::hold) from.held_s = now_s;
  if (ask == Ask::arm) {
    const double since_s = std::exchange(from.held_s, -1.0);
    const bool held = since_s >= 0.0 && now_s - since_s >= hold_s && now_s - since_s <= max_hold_s;
    if (!held) return Refusal::not_held;
  }
  return Refusal::none;
}

}  // namespace tuina::web
