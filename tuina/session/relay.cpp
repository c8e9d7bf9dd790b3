// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/relay.hpp"

#include <chrono>

#include "tuina/core/stopwatch.hpp"

namespace tuina::session {

Relay::Relay(Observer& slow)
    : slow_(slow), ring_(std::make_unique<Ring<Tick, ticks>>()), thread_([this] { carry(); }) {}

Relay::~Relay() {
  ends_ = true;
  thread_.join();
}

void Relay::on_progress(Stage stage, double share) noexcept {
  if (stage == Stage::massage) {
    massage_share_ = share;
  } else {
    slow_.on_progress(stage, share);
  }
}

void Relay::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  // The old plan goes, and the observer may still be reading it.
  constexpr double patience_s = 1.0;
  given_up_ = given_up_ || !empties_within(patience_s);
  if (!given_up_) slow_.on_plan(plan, base_from_couch);
}

void Relay::on_tick(const Tick& tick) noexcept {
  if (!given_up_ && ring_->push(tick)) {
    ++pushed_;
  } else {
    ++left_out_;
  }
}

bool Relay::empties_within(double seconds) const noexcept {
  const Stopwatch watch;
  while (carried_ != pushed_) {
    if (watch.seconds() > seconds) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

void Relay::carry() {
  double told_share = -1.0;
  for (;;) {
    const bool last = ends_;
    Tick tick;
    bool any = false;
    while (ring_->pop(tick)) {
      any = true;
      slow_.on_tick(tick);
      ++carried_;
    }
    const double share = massage_share_;
    if (share != told_share) slow_.on_progress(Stage::massage, told_share = share);
    if (last) return;
    if (!any) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

}  // namespace tuina::session
