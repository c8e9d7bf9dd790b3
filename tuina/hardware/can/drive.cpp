// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/can/drive.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/arm.hpp"

namespace tuina::hardware {
namespace {

using cia402::State;

constexpr int max_silent = 3;        // cycles of a drive that has spoken
constexpr int max_spoilt = 3;        // frames in a row
constexpr int max_fault_cycles = 3;  // in which the emergency message says what it is
constexpr int max_mode_cycles = 50;  // until it obeys torques
constexpr int max_enable_cycles = 1000;
// A motor whose torque is off by so much for so long is not the one that is ordered.
constexpr int max_off_permille = 200, max_off_cycles = 20;

}  // namespace

Drive::Drive(const DriveDevice& device, double max_torque_nm, std::string name)
    : device_(device),
      torque_at_permille_nm_(1e-3 * device.rated_torque_at_joint_nm()),
      max_permille_(max_torque_nm / std::abs(torque_at_permille_nm_)),
      name_(std::move(name)) {}

void Drive::spoilt(const char* why) noexcept {
  if (++spoilt_in_row_ >= max_spoilt) fault_.note("{}", why);
}

double Drive::q_rad() const noexcept {
  return (told_.counts - device_.zero_count) / device_.counts_per_rad();
}

void Drive::begin_cycle(int milliseconds) noexcept {
  if (heard_ && !fresh_ && cycles_since_told_ >= max_silent) fault_.note("is silent");
  fresh_ = false;
  ++cycles_since_told_;
  ms_since_told_ += milliseconds;
}

void Drive::take(const can_frame& frame) noexcept {
  switch (canopen::address_of(frame).kind) {
    case canopen::Kind::told:
      if (const auto told = cia402::told_of(frame)) return take_told(*told);
      return spoilt("tells PDOs of another size than it was set up for");
    case canopen::Kind::answer:
      if (const auto answer = canopen::answer_of(frame)) return take_answer(*answer);
      return spoilt("sends what is no answer");
    case canopen::Kind::emergency: {
      const auto code = canopen::emergency_of(frame);
      if (!code) return spoilt("sends what is no emergency message");
      if (*code != 0)
        fault_.note("reports error 0x{:04X}: {}", *code, canopen::meaning_of_emergency(*code));
      return;
    }
    case canopen::Kind::heartbeat: {
      const auto state = canopen::heartbeat_of(frame);
      if (!state) return spoilt("sends what is no heartbeat");
      if (*state == canopen::NodeState::booted) fault_.note("has begun anew: look at its supply");
      if (heard_ && *state != canopen::NodeState::operational)
        fault_.note("has left the cycles: its network state is {}", static_cast<int>(*state));
      return;
    }
    default:
      return fault_.note("is ordered about by another host");
  }
}

void Drive::take_told(const cia402::Told& told) noexcept {
  const double passed_s = 1e-3 * std::max(ms_since_told_, 1);
  const double turned_rad =
      (static_cast<double>(told.counts) - told_.counts) / device_.counts_per_rad();
  // A second one of the same cycle came late and is newer all the same.
  if (!fresh_) dq_rad_per_s_ = heard_ ? turned_rad / passed_s : 0.0;
  told_ = told;
  heard_ = fresh_ = true;
  cycles_since_told_ = ms_since_told_ = spoilt_in_row_ = 0;
  const State now = state();
  const bool in_fault = now == State::fault || now == State::fault_reaction;
  cycles_in_fault_ = in_fault ? cycles_in_fault_ + 1 : 0;
  if (cycles_in_fault_ >= max_fault_cycles) fault_.note("is in fault and does not say why");
  if (in_fault) return;
  if (obeys_ && now != State::enabled)
    fault_.note("obeys no more: {}; look at its supply and safe torque off", cia402::name_of(now));
  if (now == State::enabled && takes_torque_) judge_torque(told);
}

void Drive::judge_torque(const cia402::Told& told) noexcept {
  if (!cia402::follows(told.status)) {
    if (++cycles_unfollowed_ > max_mode_cycles)
      fault_.note("does not follow the torques it is ordered");
    return;
  }
  cycles_unfollowed_ = 0;
  // What was ordered in the last cycle counts from this SYNC on; what is told was before it.
  const int off = std::abs(told.permille - ordered_permille_[1]);
  cycles_off_ = off > max_off_permille ? cycles_off_ + 1 : 0;
  if (cycles_off_ > max_off_cycles)
    fault_.note("gives {} permille of its rated torque, {} were ordered", told.permille,
                ordered_permille_[1]);
}

void Drive::take_answer(const canopen::Answer& answer) noexcept {
  const bool refused = answer.kind == canopen::Answer::Kind::refused;
  if (answer.index == cia402::object::control_word.index && refused)
    fault_.note("refuses to be shut down: {} (0x{:08X})", canopen::meaning_of_refusal(answer.value),
                answer.value);
  if (answer.index != cia402::object::mode.index) return;
  if (answer.kind == canopen::Answer::Kind::written) takes_torque_ = true;
  if (refused)
    fault_.note("refuses torques: {} (0x{:08X})", canopen::meaning_of_refusal(answer.value),
                answer.value);
}

can_frame Drive::enable() const noexcept {
  return cia402::encode(device_.node, cia402::Ordered{.control = cia402::towards_enabled(state())});
}

can_frame Drive::place(double q_rad) const noexcept {
  const double counts = device_.zero_count + q_rad * device_.counts_per_rad();
  return cia402::placed(device_.node, static_cast<std::int32_t>(std::lround(counts)));
}

can_frame Drive::begin_torque() noexcept {
  asked_ = true;
  return canopen::write(device_.node, cia402::object::mode,
                        static_cast<std::uint32_t>(cia402::Mode::torque));
}

can_frame Drive::order(double torque_nm, bool brake) noexcept {
  if (!std::isfinite(torque_nm)) {
    fault_.note("was ordered a torque that is no number");
    return quick_stop();
  }
  const double permille =
      brake ? 0.0 : std::clamp(torque_nm / torque_at_permille_nm_, -max_permille_, max_permille_);
  ordered_permille_ = {static_cast<std::int16_t>(std::lround(permille)), ordered_permille_[0]};
  obeys_ = !brake && (obeys_ || state() == State::enabled);
  cycles_idle_ = brake || obeys_ ? 0 : cycles_idle_ + 1;
  if (cycles_idle_ > max_enable_cycles) fault_.note("does not obey: {}", cia402::name_of(state()));
  cycles_changing_ = asked_ && !takes_torque_ ? cycles_changing_ + 1 : 0;
  if (cycles_changing_ > max_mode_cycles) fault_.note("does not change from positions to torques");
  const std::uint16_t control =
      brake ? cia402::control::shutdown : cia402::towards_enabled(state());
  return cia402::encode(device_.node,
                        cia402::Ordered{.control = control, .permille = ordered_permille_[0]});
}

can_frame Drive::shut_down() noexcept {
  obeys_ = false;
  ordered_permille_ = {};
  return canopen::write(device_.node, cia402::object::control_word, cia402::control::shutdown);
}

can_frame Drive::quick_stop() const noexcept {
  return cia402::encode(device_.node, cia402::Ordered{.control = cia402::control::quick_stop});
}

}  // namespace tuina::hardware
