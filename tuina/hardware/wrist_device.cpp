// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_device.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::hardware {
namespace {

constexpr double max_counts = 1e9;
constexpr double max_lever_mm = 1000.0;
constexpr double max_skew = 1e-3;
// Rates that a sensor may have. The guard freezes an arm whose sample is older than 3 ms, so one
// has to come every 2 ms.
constexpr int min_rate_hz = 500, max_rate_hz = 7000;

std::optional<Vector3> vector_of(const TomlTable& table, const char* key, double limit) {
  const auto numbers = table.numbers(key, 3, limit);
  if (!numbers) return std::nullopt;
  return Vector3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

Vector3 read_counts(const TomlTable& table, const char* key) {
  const auto counts = vector_of(table, key, max_counts);
  if (!counts) return Vector3::Ones();
  if (!(counts->minCoeff() > 0.0)) table.wrong(key, "has a number that is not above 0");
  return *counts;
}

Matrix3 read_turn(const TomlTable& table) {
  const auto x = vector_of(table, "x", 1.0), z = vector_of(table, "z", 1.0);
  if (!x || !z) return Matrix3::Identity();
  const bool square = std::abs(x->norm() - 1.0) < max_skew &&
                      std::abs(z->norm() - 1.0) < max_skew && std::abs(x->dot(*z)) < max_skew;
  if (!square) {
    table.wrong("x", "and z are not two directions of length 1 at a right angle");
    return Matrix3::Identity();
  }
  Matrix3 turn;
  turn.col(0) = x->normalized();
  turn.col(1) = z->cross(*x).normalized();
  turn.col(2) = turn.col(0).cross(turn.col(1));
  return turn;
}

void read_address(const TomlTable& table, WristDevice& device) {
  device.address = table.text("address").value_or("");
  if (!table.has("address")) return;
  if (device.kind == WristDevice::Kind::hex_serial) {
    if (!device.address.starts_with('/'))
      table.wrong("address", "is no path of a serial line, such as \"/dev/ttyACM1\"");
    return;
  }
  const auto udp = parse_udp_address(device.address);
  if (!udp) table.wrong("address", "is no IPv4 address and port, such as \"192.168.1.1:49152\"");
  device.udp = udp.value_or(UdpAddress{});
}

void read_rate(const TomlTable& table, WristDevice& device) {
  using Kind = WristDevice::Kind;
  device.rate_hz = table.whole("rate_hz", min_rate_hz, max_rate_hz).value_or(device.rate_hz);
  if (device.kind == Kind::hex_serial && device.rate_hz != 1000)
    table.wrong("rate_hz", "is not 1000, the only one of this sensor's that the guard can use");
  if (device.kind == Kind::hex_udp && device.rate_hz != 1000 && device.rate_hz != 500)
    table.wrong("rate_hz", "is not 1000 or 500: this sensor counts whole milliseconds");
  const auto filter =
      table.word("filter", {"none", "500Hz", "150Hz", "50Hz", "15Hz", "5Hz", "1.5Hz"});
  device.filter = static_cast<std::uint8_t>(filter.value_or(0));
  if (device.kind == Kind::ati_udp && table.has("filter"))
    table.wrong("filter", "is set on the page that this sensor serves, not from here");
  if (device.kind != Kind::ati_udp && !table.has("filter"))
    table.reject("filter", "filter is missing: none, 500Hz, 150Hz, 50Hz, 15Hz, 5Hz or 1.5Hz");
}

}  // namespace

WristDevice read_wrist_device(const TomlTable& table) {
  WristDevice device;
  table.only({"rate_hz", "filter", "reversed", "zero_at_start", "calibration"},
             {"kind", "address", "counts_per_n", "counts_per_nm", "x", "z", "at_mm"},
             "a wrist sensor");
  device.kind =
      static_cast<WristDevice::Kind>(table.word("kind", {"hex_serial", "hex_udp", "ati_udp"})
                                         .value_or(static_cast<std::size_t>(device.kind)));
  read_address(table, device);
  read_rate(table, device);
  device.counts_per_n = read_counts(table, "counts_per_n");
  device.counts_per_nm = read_counts(table, "counts_per_nm");
  device.tool_from_sensor_turn = read_turn(table);
  device.sensor_in_tool_m =
      1e-3 * vector_of(table, "at_mm", max_lever_mm).value_or(Vector3::Zero());
  device.reversed = table.flag("reversed").value_or(false);
  device.zero_at_start = table.flag("zero_at_start").value_or(false);
  device.calibration_file = table.text("calibration").value_or("");
  return device;
}

}  // namespace tuina::hardware
