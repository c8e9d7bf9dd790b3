// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/emulated_wrist.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>

namespace tuina::app {
namespace {

using namespace std::chrono_literals;

constexpr double counts_per_n = 10'000.0, counts_per_nm = 100'000.0;
constexpr double silence_s = 10e-3;
const Vector3 sensor_in_tool_m(-0.060, 0.0, 0.0);
const Vector3 zero_force_n(1.5, -2.0, 3.0), zero_torque_nm(0.05, -0.02, 0.01);

/// Its x is the tool's z, its y the tool's -y, its z the tool's x, which points out of the handle.
Vector3 in_sensor_axes(const Vector3& in_tool) {
  return {in_tool.z(), -in_tool.y(), in_tool.x()};
}

using Record = std::array<std::byte, 36>;

void put(Record& record, std::size_t word, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i)
    record[4 * word + i] = static_cast<std::byte>(value >> (24 - 8 * i) & 0xFFU);
}

}  // namespace

Result<std::unique_ptr<EmulatedWrist>> EmulatedWrist::listen(const hardware::UdpAddress& own,
                                                             std::string address,
                                                             WristFailure failure) {
  auto socket = hardware::UdpSocket::listen(own);
  if (!socket) return tl::unexpected(socket.error());
  return std::unique_ptr<EmulatedWrist>(
      new EmulatedWrist(std::move(*socket), std::move(address), failure));
}

EmulatedWrist::EmulatedWrist(hardware::UdpSocket socket, std::string address, WristFailure failure)
    : socket_(std::move(socket)), address_(std::move(address)), failure_(failure) {
  thread_ = std::jthread([this](const std::stop_token& stop) { live(stop); });
}

std::string EmulatedWrist::section(Arm arm) const {
  return fmt::format(
      "[wrist_sensor.{}]\nkind = \"ati_udp\"\naddress = \"{}\"\n"
      "counts_per_n = [{:g}, {:g}, {:g}]\ncounts_per_nm = [{:g}, {:g}, {:g}]\n"
      "x = [0, 0, 1]\nz = [1, 0, 0]\nat_mm = [-60, 0, 0]\nzero_at_start = true\n",
      name_of(arm), address_, counts_per_n, counts_per_n, counts_per_n, counts_per_nm,
      counts_per_nm, counts_per_nm);
}

void EmulatedWrist::live(const std::stop_token& stop) {
  auto next = std::chrono::steady_clock::now();
  for (int number = 0; !stop.stop_requested(); ++number) {
    {
      const std::lock_guard lock(mutex_);
      obey_requests();
      // The last counts of a living sensor move, also while the simulation has nothing new to say.
      constexpr int dither_counts = 100;
      if (stands_) send(in_sensor_, dither_counts * (number % 5 - 2));
    }
    std::this_thread::sleep_until(next += 1ms);
  }
}

// A request is 0x1234, a command, and data that only filters and rates have.
void EmulatedWrist::obey_requests() {
  constexpr std::byte stop{0}, start{2};
  std::array<std::byte, 16> request;
  hardware::UdpAddress from;
  while (const auto size = socket_.receive(request, &from)) {
    if (*size != 8 || request[0] != std::byte{0x12} || request[1] != std::byte{0x34}) continue;
    if (request[3] == stop) streams_ = false;
    if (request[3] == start) streams_ = true, sequence_ = 0, host_ = from;
  }
}

void EmulatedWrist::send(const Wrench& in_sensor, int dither_counts) {
  ++sequence_;
  if (!streams_ || off_) return;
  Record record = {};
  put(record, 0, sequence_);
  put(record, 1, sequence_);
  for (int i = 0; i < 3; ++i) {
    const auto force = std::lround(counts_per_n * (in_sensor.force_n[i] + zero_force_n[i]));
    const auto torque = std::lround(counts_per_nm * (in_sensor.torque_nm[i] + zero_torque_nm[i]));
    const std::size_t word = 3 + static_cast<std::size_t>(i);
    put(record, word, static_cast<std::uint32_t>(force + dither_counts));
    put(record, word + 3, static_cast<std::uint32_t>(torque + dither_counts));
  }
  socket_.send(record, host_);
}

void EmulatedWrist::feel(double time_s, const Wrench& in_tool) {
  const std::lock_guard lock(mutex_);
  const Vector3 torque_nm = in_tool.torque_nm - sensor_in_tool_m.cross(in_tool.force_n);
  in_sensor_ = {.force_n = in_sensor_axes(in_tool.force_n), .torque_nm = in_sensor_axes(torque_nm)};
  using Kind = WristFailure::Kind;
  const double failing_s = time_s - failure_.at_s;
  if (failing_s >= 0.0 && failure_.kind == Kind::stuck) {
    if (!sticks_) stuck_ = in_sensor_;
    sticks_ = true;
    in_sensor_ = stuck_;
  }
  off_ = failing_s >= 0.0 &&
         (failure_.kind == Kind::off || (failure_.kind == Kind::silent && failing_s < silence_s));
  if (!stands_) send(in_sensor_, 0);
}

void EmulatedWrist::stand(bool stands) {
  const std::lock_guard lock(mutex_);
  stands_ = stands;
}

}  // namespace tuina::app
