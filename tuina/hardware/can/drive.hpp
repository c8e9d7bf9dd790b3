// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tuina/hardware/can/cia402.hpp"
#include "tuina/hardware/can/drive_device.hpp"
#include "tuina/hardware/can/first_fault.hpp"

namespace tuina::hardware {

/// One drive as its host sees it from cycle to cycle: what it told, what it is ordered, and what is
/// wrong with it. It knows no bus and no clock. No heap.
class Drive {
 public:
  /// `name` is what people call it, such as "the left elbow".
  Drive(const DriveDevice& device, double max_torque_nm, std::string name);

  /// A SYNC goes out, so many milliseconds after the one before. A drive that has told nothing in
  /// three cycles is silent.
  void begin_cycle(int milliseconds) noexcept;
  /// Any frame of its node.
  void take(const can_frame& frame) noexcept;
  /// Whether it has told since the SYNC, and anything at all.
  [[nodiscard]] bool fresh() const noexcept { return fresh_; }
  [[nodiscard]] bool heard_anything() const noexcept { return heard_; }

  [[nodiscard]] double q_rad() const noexcept;
  /// From one position to the next.
  [[nodiscard]] double dq_rad_per_s() const noexcept { return dq_rad_per_s_; }
  [[nodiscard]] double torque_nm() const noexcept {
    return torque_at_permille_nm_ * told_.permille;
  }
  /// Whether it obeys torques, so that what it tells can be held against them.
  [[nodiscard]] bool follows() const noexcept {
    return takes_torque_ && state() == cia402::State::enabled && cia402::follows(told_.status);
  }
  [[nodiscard]] cia402::State state() const noexcept { return cia402::state_of(told_.status); }

  /// One state nearer to obeying, without a torque; while it holds a position.
  [[nodiscard]] can_frame enable() const noexcept;
  /// Where it should be, while it holds a position.
  [[nodiscard]] can_frame place(double q_rad) const noexcept;
  /// From here on it is to obey torques: the SDO question that says so.
  [[nodiscard]] can_frame begin_torque() noexcept;
  [[nodiscard]] bool torque_begun() const noexcept { return asked_; }
  /// The torque of this cycle, within the limit; with `brake` none, and its brake closes.
  [[nodiscard]] can_frame order(double torque_nm, bool brake) noexcept;
  /// At once and without a SYNC: off, and its brake closes. It obeys again by the next orders.
  [[nodiscard]] can_frame shut_down() noexcept;
  /// Stops by its own ramp, then its brake closes.
  [[nodiscard]] can_frame quick_stop() const noexcept;

  [[nodiscard]] const DriveDevice& device() const noexcept { return device_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// Null while all is well, else what it does wrong, said of it. It stays.
  [[nodiscard]] const char* fault() const noexcept { return fault_.words(); }

 private:
  void take_told(const cia402::Told& told) noexcept;
  void take_answer(const canopen::Answer& answer) noexcept;
  void judge_torque(const cia402::Told& told) noexcept;
  void spoilt(const char* why) noexcept;

  DriveDevice device_;
  double torque_at_permille_nm_;
  double max_permille_;
  std::string name_;
  cia402::Told told_;
  double dq_rad_per_s_ = 0.0;
  bool heard_ = false, fresh_ = false;
  int cycles_since_told_ = 0, ms_since_told_ = 0, spoilt_in_row_ = 0, cycles_in_fault_ = 0;
  bool asked_ = false, takes_torque_ = false;
  bool obeys_ = false;  ///< was enabled, and has not been told otherwise
  std::array<std::int16_t, 2> ordered_permille_ = {};  ///< in this cycle, and in the one before
  int cycles_idle_ = 0, cycles_changing_ = 0, cycles_unfollowed_ = 0, cycles_off_ = 0;
  FirstFault fault_;
};

}  // namespace tuina::hardware
