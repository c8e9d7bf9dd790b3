// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/relay.hpp"

#include <chrono>

#include "tuina/core/stopwatch.hpp"

namespace tuina::session {

Relay::Relay(Observer& slow, Behind behind)
    : slow_(slow),
      behind_(behind),
      ring_(std::make_unique<Ring<Tick, ticks>>()),
      thread_([this] { carry(); }) {}

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

void Relay::on_profile(const scanner::LiveProfile& profile) {
  if (caught_up()) slow_.on_profile(profile);
}

void Relay::on_scan(const scanner::Scan& scan) {
  if (caught_up()) slow_.on_scan(scan);
}

void Relay::on_map(const body::Mapping& map) {
  if (caught_up()) slow_.on_map(map);
}

void Relay::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  if (caught_up()) slow_.on_plan(plan, base_from_couch);
}

void Relay::on_tick(const Tick& tick) noexcept {
  bool pushed = !given_up_ && ring_->push(tick);
  while (!pushed && behind_ == Behind::wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pushed = ring_->push(tick);
  }
  ++(pushed ? pushed_ : left_out_);
}

bool Relay::caught_up() noexcept {
  constexpr double patience_s = 1.0;
  const Stopwatch watch;
  while (!given_up_ && carried_ != pushed_) {
    given_up_ = behind_ == Behind::leave_out && watch.seconds() > patience_s;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return !given_up_;
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
