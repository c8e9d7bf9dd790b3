// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/hardware/serial_port.hpp"
#include "tuina/hardware/wrist_stream.hpp"

namespace tuina::hardware {

/// A force sensor at a wrist, by serial line or Ethernet (docs/wrist_sensors.md). After `open`
/// nothing but `zero` waits, and nothing takes heap.
class WristSensor {
 public:
  /// Sets its filter and rate, takes its own zero off where it has one, and listens for half a
  /// second. Fails with Fault::device, naming the address, what is amiss and what mends it.
  [[nodiscard]] static Result<WristSensor> open(const WristDevice& device);
  WristSensor(WristSensor&&) = default;
  WristSensor& operator=(WristSensor&&) = delete;
  /// It sends no more.
  ~WristSensor();

  /// Takes what has come; true where there is a newer sample. `now_s`: the time on the clock by
  /// which samples age, where that is not the host's steady clock.
  bool hear(std::optional<double> now_s = {}) noexcept;
  /// Waits until something comes, or until the deadline.
  void wait(std::chrono::steady_clock::time_point deadline) const noexcept;
  /// Forgets what came while nobody listened, which takes 100 ms at most, and waits 5 ms at most
  /// for a new sample; 100 ms where `now_s` stands still meanwhile. True where one has come.
  bool begin_anew(std::optional<double> now_s = {}) noexcept;
  /// Takes the mean of a quarter of a second, with nothing at the tool, for `weight_in_tool`. Fails
  /// with Fault::device when the sensor is at fault or does not rest, or when a calibrated one
  /// would move by more than 10 N.
  [[nodiscard]] Result<void> zero(const Wrench& weight_in_tool);

  /// The newest sample and what went wrong.
  [[nodiscard]] const WristStream& stream() const noexcept { return *stream_; }
  [[nodiscard]] double measured_rate_hz() const noexcept { return measured_rate_hz_; }

 private:
  explicit WristSensor(const WristDevice& device)
      : stream_(std::make_unique<WristStream>(device)) {}
  [[nodiscard]] const WristDevice& device() const noexcept { return stream_->device(); }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const;
  [[nodiscard]] tl::unexpected<Error> wrong_start() const;
  [[nodiscard]] Result<void> connect();
  [[nodiscard]] Result<void> start();
  [[nodiscard]] Result<void> ask();
  [[nodiscard]] Result<void> watch();
  void stop() noexcept;
  void catch_up() noexcept;
  [[nodiscard]] std::optional<WristSample> next() noexcept;

  std::unique_ptr<WristStream> stream_;
  std::optional<SerialPort> port_;
  std::optional<UdpSocket> socket_;
  hex_serial::Reader reader_;
  double measured_rate_hz_ = 0.0;
};

}  // namespace tuina::hardware
