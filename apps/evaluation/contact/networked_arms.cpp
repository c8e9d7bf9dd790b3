// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/contact/networked_arms.hpp"

#include <algorithm>

namespace tuina::app {
namespace {

// Room for all that can be under way at once.
constexpr std::size_t max_under_way = 256;
// Commands in a row that the arms have not obeyed, before their host breaks off.
constexpr int max_unheard = 10;
// As tuina's host sends the last command again, and for how long.
constexpr double again_every_s = 0.5e-3, again_for_s = 6e-3;

}  // namespace

NetworkedArms::NetworkedArms(robot::Robot& arms, const Network& network, std::uint64_t seed)
    : arms_(arms), network_(network), random_(make_random(seed, "network")) {
  states_.reserve(max_under_way);
  commands_.reserve(max_under_way);
}

/// Nothing where the datagram is lost.
std::optional<double> NetworkedArms::arrival_s(double sent_s) noexcept {
  const double late_s = network_.delay_s + gaussian(random_, network_.jitter_s);
  const bool lost = uniform(random_, 0.0, 1.0) < network_.loss;
  if (lost) return std::nullopt;
  return sent_s + std::max(late_s, 0.0);
}

void NetworkedArms::send(const Command& command, double sent_s) noexcept {
  const auto at_s = arrival_s(sent_s);
  if (!at_s || commands_.size() >= max_under_way) return;
  commands_.push_back(command);
  commands_.back().at_s = *at_s;
}

void NetworkedArms::send_again_until(double time_s) noexcept {
  for (; last_ && again_s_ < std::min(time_s, host_s_ + again_for_s); again_s_ += again_every_s)
    send(*last_, again_s_);
}

/// The arms' next cycle: obeys what has come by its begin, and tells of it.
bool NetworkedArms::step() noexcept {
  const Command* newest = nullptr;
  bool heard = false;
  for (const Command& command : commands_) {
    const bool old =
        tick_ - command.answers > static_cast<std::uint64_t>(network_.max_answer_age_cycles);
    const bool come = command.at_s <= cycle_s_ + control_period_s;
    if (!come || old) continue;
    heard = true;
    if (obeyed_ && command.answers <= *obeyed_) continue;
    if (newest == nullptr || command.answers > newest->answers) newest = &command;
  }
  if (newest != nullptr && !stopped_) {
    obeyed_ = newest->answers;
    moving_ = newest->number;
    torques_ = newest->command;
    arms_.apply(torques_);
    missed_in_row_ = 0;
  } else if (obeyed_) {  // before the first command nobody drives the arms
    ++missed_;
    missed_in_row_ = heard ? 0 : missed_in_row_ + 1;
    stopped_ = missed_in_row_ >= hardware::armlink::max_missed_cycles || stopped_;
    if (heard && !stopped_) arms_.apply(torques_);
  }
  std::erase_if(commands_, [&](const Command& command) {
    return command.at_s <= cycle_s_ + control_period_s;
  });
  const auto reading = arms_.read();
  if (!reading) return false;
  tick_ = reading->tick;
  cycle_s_ = reading->time_s;
  const auto at_s = arrival_s(cycle_s_);
  if (at_s && cycle_s_ < network_.deaf_from_s) states_.push_back({*at_s, *reading, moving_});
  return true;
}

std::optional<robot::RobotReading> NetworkedArms::read() noexcept {
  constexpr int max_cycles = 100;  // then the host gives them up
  for (int cycles = 0; cycles < max_cycles;) {
    const auto next = std::min_element(
        states_.begin(), states_.end(),
        [](const State& one, const State& other) { return one.at_s < other.at_s; });
    const bool in_cycle = next != states_.end() && next->at_s <= cycle_s_ + control_period_s;
    send_again_until(in_cycle ? next->at_s : cycle_s_ + control_period_s);
    if (!in_cycle) {
      if (!step()) return std::nullopt;
      ++cycles;
      continue;
    }
    State state = *next;
    states_.erase(next);
    if (heard_ && state.reading.tick <= *heard_) continue;
    heard_ = state.reading.tick;
    host_s_ = state.at_s;
    last_.reset();
    for (robot::ArmReading& arm : state.reading.arms.of) arm.command_age = sent_ - state.obeyed;
    return state.reading;
  }
  return std::nullopt;
}

void NetworkedArms::apply(const robot::RobotCommand& command) noexcept {
  // Until the first command has come the arms stand by their own drives, as these torques hold
  // them.
  ++sent_;
  if (!obeyed_) {
    arms_.apply(command);
    moving_ = sent_;
    stopped_ = ++unheard_ > max_unheard;
  }
  const Command sent = {host_s_, sent_, *heard_, command};
  send(sent, host_s_);
  if (network_.sent_again) last_ = sent;
  again_s_ = host_s_ + again_every_s;
}

}  // namespace tuina::app
