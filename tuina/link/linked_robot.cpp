// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/linked_robot.hpp"

#include <chrono>

#include "tuina/link/real_time.hpp"

namespace tuina::link {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto start_patience = 20s;           // of the other processes
constexpr auto lock_step_guard_patience = 6s;  // likewise, in each millisecond of a simulation ...
constexpr auto gone_guard_patience = 2ms;      // ... and once they were silent
constexpr int silent_guard_ticks = 20;         // then the drives brake

}  // namespace

LinkedRobot::~LinkedRobot() {
  if (armed_ && pace_ == Pace::real) end_real_time();
  wish_.ends = 1;
  link_.write(wish_);
}

Link::Deadline LinkedRobot::patience(bool there) const noexcept {
  const auto now = steady_clock::now();
  if (pace_ == Pace::real) return now + 2ms;
  return now + (there ? lock_step_guard_patience : gone_guard_patience);
}

Result<void> LinkedRobot::arm(const Arming& arming) {
  if (armed_)
    return fail(Fault::stopped, "a guard in a process of its own is armed for one massage only");
  if (auto started = start_guard_(arming); !started) return started;
  const auto ready = link_.wait_for(steady_clock::now() + start_patience, [&]() {
    const auto frame = link_.drive();
    return frame && frame->armed != 0 && frame->guard == wish_.guard ? frame : std::nullopt;
  });
  if (!ready)
    return fail(Fault::device, "the guard has not begun within {} s", start_patience.count());
  if (guard_began_) guard_began_();
  // A thread that must wait for its turn longer than the guard waits for it stops the massage.
  if (pace_ == Pace::real) (void)be_real_time(Priority::loop);
  armed_ = true;
  stop_asked_ = false;
  silent_ticks_ = 0;
  last_ = {};
  return {};
}

void LinkedRobot::rest() noexcept {
  if (armed_ && pace_ == Pace::real) end_real_time();
  armed_ = false;
  ++wish_.guard;
  link_.write(wish_);
}

Result<void> LinkedRobot::stand_ready(const robot::ReadyPose& pose) {
  const std::uint64_t guard = wish_.guard;
  wish_ = wire::to_frame(pose, wish_.number + 1);
  wish_.guard = guard;
  link_.write(wish_);
  const auto stands = link_.wait_for(steady_clock::now() + start_patience, [&]() {
    const auto frame = link_.sensors();
    return frame && frame->stands == wish_.number ? frame : std::nullopt;
  });
  if (stands) return {};
  return fail(Fault::device, "the robot does not stand ready after {} s", start_patience.count());
}

std::optional<robot::RobotReading> LinkedRobot::read() noexcept {
  const auto fresh = link_.wait_for(patience(true), [&]() {
    const auto frame = link_.sensors();
    const bool next = frame && (!last_tick_ || frame->tick != *last_tick_);
    return next ? frame : std::nullopt;
  });
  if (!fresh) return std::nullopt;
  last_tick_ = fresh->tick;
  return wire::from_frame(*fresh);
}

safety::RobotVerdict LinkedRobot::check(const robot::RobotReading& reading,
                                        const safety::RobotProposal& proposal) noexcept {
  link_.write(wire::to_frame(proposal, reading.tick, stop_asked_));
  const auto answer = link_.wait_for(patience(silent_ticks_ == 0), [&]() {
    const auto frame = link_.drive();
    return frame && frame->answers_tick == reading.tick ? frame : std::nullopt;
  });
  silent_ticks_ = answer ? 0 : silent_ticks_ + 1;
  if (answer) return last_ = wire::from_frame(*answer);
  for (safety::Verdict& one : last_.arms.of) {
    if (one.latched) continue;
    one.action = safety::Action::freeze;
    one.cause = safety::Cause::guard_silent;
    one.latched = silent_ticks_ >= silent_guard_ticks;
  }
  return last_;
}

}  // namespace tuina::link
