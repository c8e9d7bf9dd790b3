// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/relay.hpp"

#include <chrono>

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
  wait_until_empty();  // between two plans nobody is touched, and the old plan goes
  slow_.on_plan(plan, base_from_couch);
}

void Relay::on_tick(const Tick& tick) noexcept {
  idle_ = false;
  if (!ring_->push(tick)) ++left_out_;
}

void Relay::wait_until_empty() noexcept {
  while (!idle_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
    }
    const double share = massage_share_;
    if (share != told_share) slow_.on_progress(Stage::massage, told_share = share);
    if (last) return;
    if (!any) {
      idle_ = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

}  // namespace tuina::session
