// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "tuina/hardware/dynamixel.hpp"

namespace tuina::tests {

/// An AX-12A by its data sheet, in a time that is told to it: control table, speeds in units of
/// 0.111 rpm, readings in counts of 300/1024 degrees, an answer 0.5 ms after the question.
class ServoEmulator {
 public:
  static constexpr double answer_after_s = 0.5e-3;
  static constexpr double counts_per_s_of_unit = 0.111 * 6.0 / (300.0 / 1024.0);
  static constexpr double max_speed_unit = 531.0;  // 59 rpm without load, at 12 V

  std::uint8_t id = 1;
  int model = 12;
  std::uint8_t error = 0;      ///< bits of every answer
  bool blocked = false;        ///< turns no more
  double skip_counts = 0.0;    ///< by which its readings are too large
  int stuck_count = -1;        ///< what it tells for ever, if not negative
  double ripple_counts = 0.0;  ///< amplitude of the gear's unevenness ...
  double ripple_period_counts = 1.0;

  /// Where the even part of its motion is, in counts.
  [[nodiscard]] double at(double time_s) const {
    const double way = goal_ - from_;
    const double gone = blocked ? 0.0 : speed_ * (time_s - since_s_);
    return from_ + std::copysign(std::min(std::abs(way), gone), way);
  }
  [[nodiscard]] double speed_counts_per_s(double time_s) const {
    return at(time_s) == goal_ || blocked ? 0.0 : std::copysign(speed_, goal_ - from_);
  }
  void block(double time_s) {
    from_ = goal_ = at(time_s);
    blocked = true;
  }

  /// The answer to a packet that came; nothing where it is for another.
  [[nodiscard]] std::vector<std::uint8_t> answer(const hardware::dynamixel::Packet& in,
                                                 double time_s) {
    namespace dxl = hardware::dynamixel;
    if (in.id != id) return {};
    dxl::Packet out{.id = id, .kind = error, .parameters = {}};
    if (in.kind == dxl::read && in.parameters.size() == 2) {
      refresh(time_s);
      for (int i = 0; i < in.parameters[1]; ++i)
        out.parameters.push_back(table_[(in.parameters[0] + static_cast<unsigned>(i)) % 50]);
    } else if (in.kind == dxl::write && in.parameters.size() >= 2) {
      for (std::size_t i = 1; i < in.parameters.size(); ++i)
        table_[(in.parameters[0] + i - 1) % 50] = in.parameters[i];
      obey(time_s);
    } else if (in.kind != dxl::ping) {
      out.kind |= 0x40;
    }
    return dxl::encode(out);
  }
  void set_limits(int low, int high) {
    put(6, low);
    put(8, high);
  }
  /// Position, speed, load, voltage, temperature and moving, as they are read at once.
  [[nodiscard]] std::span<const std::uint8_t> state(double time_s) {
    refresh(time_s);
    return std::span(table_).subspan(36, 11);
  }

 private:
  void put(std::size_t address, int value) {
    table_[address] = static_cast<std::uint8_t>(value & 0xFF);
    table_[address + 1] = static_cast<std::uint8_t>(value >> 8);
  }
  void refresh(double time_s) {
    put(0, model);
    const double even = at(time_s);
    const double turned = even + ripple_counts * std::sin(2.0 * 3.14159265358979 * (even - 512.0) /
                                                          ripple_period_counts);
    put(36, stuck_count >= 0 ? stuck_count : static_cast<int>(std::lround(turned + skip_counts)));
    table_[42] = 120;  // 12 V
    table_[43] = 31;   // degrees
    table_[46] = speed_counts_per_s(time_s) != 0.0 ? 1 : 0;
  }
  void obey(double time_s) {
    from_ = at(time_s);
    since_s_ = time_s;
    goal_ = table_[30] | table_[31] << 8;
    const int unit = table_[32] | table_[33] << 8;
    speed_ = counts_per_s_of_unit *
             (unit == 0 ? max_speed_unit : std::min<double>(unit, max_speed_unit));
  }

  std::array<std::uint8_t, 64> table_ = [] {
    std::array<std::uint8_t, 64> table = {};
    table[5] = 250;                      // answers after 0.5 ms
    table[8] = 0xFF, table[9] = 0x03;    // limits 0 to 1023
    table[30] = 0x00, table[31] = 0x02;  // goal 512
    return table;
  }();
  double from_ = 512.0, goal_ = 512.0, speed_ = 0.0, since_s_ = 0.0;
};

}  // namespace tuina::tests
