// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/ax12_turntable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::hardware {
namespace {

using namespace std::chrono_literals;

constexpr double speed_unit_rad_per_s = from_deg(0.111 * 6.0);
constexpr int run_up_counts = 10, run_out_counts = 7;  // 3 and 2 degrees
constexpr int even_after_counts = 4;                   // by then an AX-12A has its speed
constexpr int near_counts = 3;                         // it ends up to so far from its goal
constexpr int approach_speed = 60;                     // 40 degrees per second
constexpr int max_count = 1023;
// The board puts the laser out where the motor seems to stand: less than two counts in a quarter of
// a second (firmware/scanner).
constexpr int min_lit_speed = 4;
constexpr auto poll_every = 10ms, min_pause = 2ms;
constexpr auto max_silence = 150ms;
// The scan asks once per frame; the laser goes out for who does not.
constexpr auto max_unasked = 180ms;
constexpr auto step_every = 100ms;
constexpr auto min_max_stand = 300ms;

}  // namespace

Result<std::unique_ptr<Ax12Turntable>> Ax12Turntable::open(const TurntableDevice& device) {
  auto servo = YawServo::open(device);
  if (!servo) return tl::unexpected(servo.error());
  const auto told = servo->poll(false);
  if (!told) return tl::unexpected(told.error());
  return std::unique_ptr<Ax12Turntable>(new Ax12Turntable(std::move(*servo), told->count));
}

Ax12Turntable::Ax12Turntable(YawServo servo, int count)
    : servo_(std::move(servo)), opened_at_count_(count), last_told_at_(Clock::now()) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Ax12Turntable::~Ax12Turntable() {
  thread_.request_stop();
  thread_.join();
  (void)servo_.poll(false);  // a destructor has nobody to tell
}

std::string Ax12Turntable::who() const {
  const std::lock_guard lock(mutex_);
  return fmt::format("{}, stands at count {}", servo_.who(), opened_at_count_);
}

double Ax12Turntable::yaw_of(int count) const {
  const TurntableDevice& device = servo_.device();
  return (device.reversed ? -1 : 1) * (count - device.zero_count) * scanner::yaw_count_rad;
}

Result<int> Ax12Turntable::count_of(double yaw_rad) const {
  const TurntableDevice& device = servo_.device();
  const int counts = static_cast<int>(std::lround(yaw_rad / scanner::yaw_count_rad));
  const int count = device.zero_count + (device.reversed ? -counts : counts);
  // What the run-up needs lies within the motor's turn, too.
  const int margin = run_up_counts + even_after_counts;
  if (count >= margin && count <= max_count - margin) return count;
  return fail(
      Fault::device,
      "{}: the motor turns from {:.0f} to {:.0f} degrees about its zero at count {}, not to "
      "{:.1f}",
      device.address, to_deg(std::min(yaw_of(margin), yaw_of(max_count - margin))),
      to_deg(std::max(yaw_of(margin), yaw_of(max_count - margin))), device.zero_count,
      to_deg(yaw_rad));
}

// At even intervals, of which there were nearly a whole number while the motor turns by one count,
// the rounding of its readings would not average out. So each question is early or late by up to a
// fifth of the interval, by the golden ratio, which spreads them evenly.
void Ax12Turntable::run(const std::stop_token& stop) {
  constexpr double golden_ratio = 0.6180339887498949;
  auto next = Clock::now();
  double spread = 0.0;
  while (!stop.stop_requested()) {
    {
      const std::lock_guard lock(mutex_);
      if (!failure_) look();
    }
    // Where the line is slow, who waits for the lock has its turn all the same.
    next = std::max(next + poll_every, Clock::now() + min_pause);
    spread = std::fmod(spread + golden_ratio, 1.0);
    const std::chrono::duration<double> aside = (spread - 0.5) * 0.4 * poll_every;
    std::this_thread::sleep_until(next + std::chrono::duration_cast<Clock::duration>(aside));
  }
}

// One exchange with the motor. A single one may fail; the laser and the turn do not wait longer
// than `max_silence` for the next.
void Ax12Turntable::look() {
  if (want_lit_ && Clock::now() - asked_at_ > max_unasked) {
    (void)servo_.poll(false);
    failure_ = Error{Fault::device,
                     fmt::format("{}: the laser was put out, since the scan took no frame for {} "
                                 "ms; does the camera hang, or is this machine overloaded?",
                                 servo_.device().address, max_unasked / 1ms)};
    return;
  }
  const auto told = servo_.poll(want_lit_);
  const auto now = Clock::now();
  if (!told) {
    if (now - last_told_at_ <= max_silence) return;
    (void)servo_.poll(false);
    failure_ = told.error();
    return;
  }
  last_told_at_ = now;
  if (told->count < 0 || told->count > max_count) {
    failure_ = Error{Fault::device, fmt::format("{}: the motor tells count {}; it has 0 to {}",
                                                servo_.device().address, told->count, max_count)};
    return;
  }
  judge(*told);
  if (turning_ && step_counts_ != 0 && now >= next_step_at_) take_step();
}

// What the newest reading says of the turn.
void Ax12Turntable::judge(const YawServo::Told& told) {
  count_ = told.count;
  if (!turning_) return;
  told_.push_back(told);
  const auto now = Clock::now();
  // One that swings about a place stands there.
  if (direction_ * (count_ - stands_at_count_) >= 2) {
    stands_at_count_ = count_;
    stands_since_ = now;
  }
  // A motor may rest a little short of where it was sent; a sweep is sent further than its end.
  const bool rests =
      step_counts_ != 0 && goal_count_ == end_count_ && now - stands_since_ > min_max_stand;
  turned_ = turned_ || direction_ * (count_ - end_count_) >= (rests ? -near_counts : 0);
  if (turned_ || now - stands_since_ <= max_stand_) return;
  failure_ =
      Error{Fault::device,
            fmt::format(
                "{}: the motor has stood at {:.1f} degrees for {} ms on its way to {:.1f}; is the "
                "unit blocked, or its 12 V supply too weak?",
                servo_.device().address, to_deg(yaw_of(count_)), max_stand_ / 1ms,
                to_deg(yaw_of(end_count_)))};
}

void Ax12Turntable::take_step() {
  if (direction_ * (goal_count_ - end_count_) >= 0) return;
  const int goal = goal_count_ + direction_ * step_counts_;
  if (!servo_.turn_to(goal, approach_speed)) return;  // once more after the next reading
  goal_count_ = goal;
  next_step_at_ += step_every;
}

// The failure of the thread, if there is one.
Result<void> Ax12Turntable::standing() const {
  if (failure_) return tl::unexpected(*failure_);
  return {};
}

// Turns to a place quickly, and waits until the motor rests there.
Result<void> Ax12Turntable::begin_at(double yaw_rad) {
  std::unique_lock lock(mutex_);
  if (auto good = standing(); !good) return good;
  const auto count = count_of(yaw_rad);
  if (!count) return tl::unexpected(count.error());
  turning_ = turned_ = false;
  told_.clear();
  // Away from the turn, so that the play of the gear lies where it will lie in the turn.
  const int goal = *count - direction_ * (step_counts_ != 0 ? 0 : run_up_counts);
  if (auto sent = servo_.turn_to(goal, approach_speed); !sent) return sent;
  const double way_s =
      std::abs(goal - count_) * scanner::yaw_count_rad / (approach_speed * speed_unit_rad_per_s);
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(2.0 * way_s + 1.0));
  int rested = 0, before = count_;
  while (rested < 5) {
    lock.unlock();
    std::this_thread::sleep_for(2 * poll_every);
    lock.lock();
    if (auto good = standing(); !good) return good;
    rested = std::abs(count_ - goal) <= near_counts && count_ == before ? rested + 1 : 0;
    before = count_;
    if (Clock::now() < deadline) continue;
    return fail(Fault::device,
                "{}: the motor stands at {:.1f} degrees instead of {:.1f}; is the unit blocked, or "
                "its 12 V supply too weak?",
                servo_.device().address, to_deg(yaw_of(count_)), to_deg(yaw_of(goal)));
  }
  return {};
}

Result<void> Ax12Turntable::sweep(double from_rad, double to_rad, double rad_per_s) {
  const auto end = count_of(to_rad);
  if (!end) return tl::unexpected(end.error());
  const int speed =
      std::min(static_cast<int>(std::lround(rad_per_s / speed_unit_rad_per_s)), max_count);
  if (speed < min_lit_speed)
    return fail(Fault::config,
                "{}: {:.1f} degrees per second are too slow, for the laser goes out where its beam "
                "seems to stand; sweep within {:.0f} s",
                servo_.device().address, to_deg(rad_per_s),
                std::floor(std::abs(to_rad - from_rad) / (min_lit_speed * speed_unit_rad_per_s)));
  {
    const std::lock_guard lock(mutex_);
    direction_ = (to_rad > from_rad) == servo_.device().reversed ? -1 : 1;
    step_counts_ = 0;
  }
  if (auto there = begin_at(from_rad); !there) return there;
  std::unique_lock lock(mutex_);
  end_count_ = *end;
  goal_count_ = *end + direction_ * run_out_counts;
  const int begin_count = count_;
  if (auto sent = servo_.turn_to(goal_count_, speed); !sent) return sent;
  turning_ = true;
  stands_at_count_ = count_;
  stands_since_ = Clock::now();
  const double slow_s = 5.0 * scanner::yaw_count_rad / (speed * speed_unit_rad_per_s);
  max_stand_ = std::max<Clock::duration>(min_max_stand,
                                         std::chrono::milliseconds(static_cast<int>(1e3 * slow_s)));
  // A motor that does not start is found by `judge`.
  while (direction_ * (count_ - begin_count) < even_after_counts) {
    lock.unlock();
    std::this_thread::sleep_for(poll_every);
    lock.lock();
    if (auto good = standing(); !good) return good;
  }
  return {};
}

Result<void> Ax12Turntable::step(double from_rad, double to_rad, double step_rad) {
  const auto end = count_of(to_rad);
  if (!end) return tl::unexpected(end.error());
  {
    const std::lock_guard lock(mutex_);
    direction_ = (to_rad > from_rad) == servo_.device().reversed ? -1 : 1;
    step_counts_ = std::max(1, static_cast<int>(std::lround(step_rad / scanner::yaw_count_rad)));
  }
  if (auto there = begin_at(from_rad); !there) return there;
  const std::lock_guard lock(mutex_);
  end_count_ = *end;
  goal_count_ = stands_at_count_ = count_;
  turning_ = true;
  stands_since_ = Clock::now();
  next_step_at_ = Clock::now() + step_every;
  max_stand_ = 10 * step_every;
  return {};
}

Result<bool> Ax12Turntable::arrived() const {
  const std::lock_guard lock(mutex_);
  if (const auto good = standing(); !good) return tl::unexpected(good.error());
  asked_at_ = Clock::now();
  return turned_;
}

Result<void> Ax12Turntable::switch_laser(bool on) {
  const std::lock_guard lock(mutex_);
  if (auto good = standing(); !good) return good;
  want_lit_ = on;
  asked_at_ = Clock::now();
  const auto told = servo_.poll(on);
  if (told || !on) return {};  // one that is to be dark is asked again a hundred times a second
  want_lit_ = false;
  return tl::unexpected(told.error());
}

Result<std::vector<scanner::YawReading>> Ax12Turntable::readings() const {
  const std::lock_guard lock(mutex_);
  if (const auto good = standing(); !good) return tl::unexpected(good.error());
  std::vector<scanner::YawReading> all;
  all.reserve(told_.size());
  double last_s = 0.0;
  for (const YawServo::Told& told : told_) {
    // The map of the clocks is a little better with each exchange; order is kept by it.
    last_s = std::max(last_s, servo_.host_s(told.stamp_s));
    all.push_back({.time_s = last_s, .yaw_rad = yaw_of(told.count)});
  }
  return all;
}

}  // namespace tuina::hardware
