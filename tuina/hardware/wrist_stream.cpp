// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_stream.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace tuina::hardware {
namespace {

constexpr int max_in_row = 5;
// Samples that are missing for so long have made the guard retract.
constexpr double max_missing_s = 5e-3;
// A sensor's clock and the host's differ by less. The time of a sample may follow that of the one
// before by so much more than its place in the sequence says.
constexpr double max_drift = 0.1;

/// What OptoForce's status says, bit 15 first.
const char* meaning_of_hex(std::uint32_t status) noexcept {
  if ((status & 0xE000U) != 0) return "its box has failed";
  if ((status & 0x1C00U) != 0) return "it has failed or is not at its box";
  if ((status & 0x03F0U) != 0) return "it is overloaded";
  return "its manual says of what";
}

}  // namespace

void WristStream::break_off(std::string_view why) noexcept {
  if (faulty_) return;
  faulty_ = true;
  fault_[why.copy(fault_.data(), fault_.size() - 1)] = '\0';
}

void WristStream::take_spoilt() noexcept {
  ++traffic_.spoilt;
  if (++spoilt_in_row_ >= max_in_row) break_off("sends what is no sample of its kind");
}

bool WristStream::take(const WristSample& sample, double now_s) noexcept {
  if (faulty_ || !healthy(sample) || !follows(sample, now_s)) return false;
  same_in_row_ = traffic_.samples > 0 && sample.counts == last_.counts ? same_in_row_ + 1 : 0;
  traffic_.longest_row = std::max(traffic_.longest_row, same_in_row_);
  ++traffic_.samples;
  last_ = sample;
  convert(sample);
  return true;
}

// Who is overloaded or has failed once is not believed again before somebody has looked.
bool WristStream::healthy(const WristSample& sample) noexcept {
  const bool hex = device_.kind != WristDevice::Kind::ati_udp;
  std::array<char, 120> said = {};
  if (sample.status != 0) {
    (void)std::snprintf(said.data(), said.size(), "tells status 0x%08x: %s", sample.status,
                        hex ? meaning_of_hex(sample.status) : "its manual says of what");
    break_off(said.data());
    return false;
  }
  const std::int64_t rail = device_.kind == WristDevice::Kind::hex_serial
                                ? std::numeric_limits<std::int16_t>::max()
                                : std::numeric_limits<std::int32_t>::max();
  for (std::size_t i = 0; i < sample.counts.size(); ++i) {
    if (std::abs(std::int64_t{sample.counts[i]}) < rail) continue;
    (void)std::snprintf(said.data(), said.size(), "is saturated: %s %c is %d counts",
                        i < 3 ? "force" : "torque", "xyz"[i % 3], sample.counts[i]);
    break_off(said.data());
    return false;
  }
  return true;
}

bool WristStream::follows(const WristSample& sample, double now_s) noexcept {
  spoilt_in_row_ = 0;
  if (!begun_) {
    begun_ = true;
    time_s_ = now_s;
    again_in_row_ = late_in_row_ = stands_in_row_ = 0;
    return true;
  }
  const std::uint32_t turned = sample.sequence - last_.sequence;
  const std::int32_t ahead = device_.kind == WristDevice::Kind::hex_serial
                                 ? static_cast<std::int16_t>(turned)
                                 : static_cast<std::int32_t>(turned);
  if (ahead == 0) {
    ++traffic_.again;
    if (++again_in_row_ >= max_in_row) break_off("repeats a sample");
    return false;
  }
  if (ahead < 0) {
    ++traffic_.late;
    if (++late_in_row_ >= max_in_row) break_off("counts backwards: did it start anew?");
    return false;
  }
  again_in_row_ = late_in_row_ = 0;
  stands_in_row_ = sample.counter == last_.counter ? stands_in_row_ + 1 : 0;
  if (stands_in_row_ >= std::max(max_in_row, device_.rate_hz / 100))
    break_off("sends one measurement under new numbers");
  traffic_.lost += static_cast<std::uint64_t>(ahead - 1);
  const int max_missing = std::max(max_in_row, static_cast<int>(max_missing_s * device_.rate_hz));
  if (ahead > max_missing) {
    std::array<char, 80> said = {};
    (void)std::snprintf(said.data(), said.size(), "lost %d samples in a row", ahead - 1);
    break_off(said.data());
  }
  time_s_ = std::min(now_s, time_s_ + (1.0 + max_drift) * ahead / device_.rate_hz);
  return !faulty_;
}

void WristStream::convert(const WristSample& sample) noexcept {
  const auto at = [&](std::size_t i) { return static_cast<double>(sample.counts[i]); };
  const double sign = device_.reversed ? -1.0 : 1.0;
  const Vector3 force_in_sensor_n =
      Vector3(at(0), at(1), at(2)).cwiseQuotient(device_.counts_per_n);
  const Vector3 torque_in_sensor_nm =
      Vector3(at(3), at(4), at(5)).cwiseQuotient(device_.counts_per_nm);
  const Vector3 force_n = sign * (device_.tool_from_sensor_turn * force_in_sensor_n);
  const Vector3 torque_nm = sign * (device_.tool_from_sensor_turn * torque_in_sensor_nm) +
                            device_.sensor_in_tool_m.cross(force_n);
  in_tool_ = {.force_n = force_n - offset_in_tool_.force_n,
              .torque_nm = torque_nm - offset_in_tool_.torque_nm};
}

}  // namespace tuina::hardware
