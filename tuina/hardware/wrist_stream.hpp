// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "tuina/hardware/wrist_device.hpp"
#include "tuina/hardware/wrist_frames.hpp"

namespace tuina::hardware {

/// What has come from a wrist sensor since it was opened.
struct WristTraffic {
  std::uint64_t samples = 0;
  std::uint64_t lost = 0;    ///< gaps in the sequence
  std::uint64_t again = 0;   ///< came twice
  std::uint64_t late = 0;    ///< came after a newer one
  std::uint64_t spoilt = 0;  ///< belonged to no frame
  int longest_row = 0;       ///< longest run of samples equal to the one before, to the last count
};

/// Judges the samples of one sensor as they come, and turns counts into a wrench at the tool. Takes
/// no heap and no time. A fault stays: from then on no sample is new, and the guard sees an old
/// one.
class WristStream {
 public:
  /// Before the first sample.
  explicit WristStream(const WristDevice& device) : device_(device) {}

  /// True where the sample is sound and newer than the last one. `now_s`: when it was read, on the
  /// host's steady clock.
  bool take(const WristSample& sample, double now_s) noexcept;
  /// Bytes or a datagram came that are no sample.
  void take_spoilt() noexcept;
  /// Nobody listened for a while: what comes next follows on nothing. A fault stays.
  void begin_anew() noexcept { begun_ = false; }
  /// From here on the sensor is faulty, with this reason for people.
  void break_off(std::string_view why) noexcept;

  /// Force of the environment on the tool about the tool's origin, weight included, offset taken
  /// off.
  [[nodiscard]] const Wrench& in_tool() const noexcept { return in_tool_; }
  /// When the newest sample came, at the latest: one that was held up on its way counts as old,
  /// since samples are evenly spaced.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  /// Samples counted since the start.
  [[nodiscard]] const WristTraffic& traffic() const noexcept { return traffic_; }
  /// Said of "the sensor"; null while all is well.
  [[nodiscard]] const char* fault() const noexcept { return faulty_ ? fault_.data() : nullptr; }

  /// The sensor as its file describes it.
  [[nodiscard]] const WristDevice& device() const noexcept { return device_; }
  /// @{
  /// The reading without weight and contact, N and Nm, which is taken off every sample.
  [[nodiscard]] const Wrench& offset_in_tool() const noexcept { return offset_in_tool_; }
  void set_offset(const Wrench& offset_in_tool) noexcept { offset_in_tool_ = offset_in_tool; }
  /// @}

 private:
  [[nodiscard]] bool follows(const WristSample& sample, double now_s) noexcept;
  [[nodiscard]] bool healthy(const WristSample& sample) noexcept;
  void convert(const WristSample& sample) noexcept;

  WristDevice device_;
  Wrench offset_in_tool_ = device_.calibration ? device_.calibration->offset_in_tool : Wrench{};
  Wrench in_tool_;
  double time_s_ = 0.0;
  bool begun_ = false;
  WristSample last_;
  int again_in_row_ = 0, late_in_row_ = 0, stands_in_row_ = 0, same_in_row_ = 0, spoilt_in_row_ = 0;
  WristTraffic traffic_;
  bool faulty_ = false;
  std::array<char, 160> fault_ = {};
};

}  // namespace tuina::hardware
