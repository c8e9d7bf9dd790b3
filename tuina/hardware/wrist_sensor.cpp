// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/hardware/steady_clock.hpp"

namespace tuina::hardware {
namespace {

using namespace std::chrono_literals;
using Kind = WristDevice::Kind;
using steady_clock = std::chrono::steady_clock;

constexpr int line_bits_per_s = 1'000'000;
constexpr int max_asked = 10;
constexpr auto ask_patience = 100ms;
constexpr auto watched = 500ms;
constexpr auto begin_patience = 5ms, catch_up_patience = 100ms;
constexpr auto kept_comes_within = 500us;
constexpr auto zero_takes = 250ms;
constexpr int max_at_once = 256;  // whatever comes, a millisecond ends
constexpr int max_queued = 4096;  // samples in a full socket, of which those lost come after
constexpr double max_rate_off = 0.08;
// A USB serial line holds bytes back for 16 ms where nobody has told it otherwise. Shorter pauses
// may be this machine's own; the guard sees them.
constexpr double max_pause_s = 10e-3;
constexpr std::size_t max_spoilt_bytes = 5 * hex_serial::frame_size;
constexpr double max_restless_n = 0.5, max_zero_moves_n = 10.0;

}  // namespace

tl::unexpected<Error> WristSensor::wrong(const std::string& what) const {
  return fail(Fault::device, "{}: {}", device().address, what);
}

Result<WristSensor> WristSensor::open(const WristDevice& device) {
  WristSensor sensor(device);
  if (const auto done = sensor.connect(); !done) return tl::unexpected(done.error());
  if (const auto done = sensor.start(); !done) return tl::unexpected(done.error());
  if (const auto done = sensor.watch(); !done) return tl::unexpected(done.error());
  return sensor;
}

WristSensor::~WristSensor() {
  stop();
}

Result<void> WristSensor::connect() {
  if (device().kind == Kind::hex_serial) {
    auto port = SerialPort::open(device().address, line_bits_per_s);
    if (!port) return tl::unexpected(port.error());
    port_ = std::move(*port);
    return {};
  }
  auto socket = UdpSocket::connect(device().udp);
  if (!socket) return tl::unexpected(socket.error());
  socket_ = std::move(*socket);
  return {};
}

Result<void> WristSensor::ask() {
  if (port_) {
    return port_->write(hex_serial::encode_config(hex_serial::speed_1000_hz, device().filter,
                                                  hex_serial::keep_no_zero),
                        steady_clock::now() + ask_patience);
  }
  const auto say = [&](rdt::Command command, std::uint32_t data) {
    socket_->send(rdt::encode(command, data));
  };
  say(rdt::Command::stop, 0);
  if (device().kind == Kind::hex_udp) {
    say(rdt::Command::period, static_cast<std::uint32_t>(1000 / device().rate_hz));
    say(rdt::Command::filter, device().filter);
    say(rdt::Command::bias, 0);
  }
  say(rdt::Command::start, 0);
  return {};
}

// Why there is no sample, as far as what came instead tells.
tl::unexpected<Error> WristSensor::wrong_start() const {
  if (reader_.other_axes() != 0)
    return wrong("a sensor of 3 axes or several of them answer; a HEX of 6 axes is needed");
  if (stream_->traffic().spoilt + reader_.spoilt_bytes() > 0)
    return wrong("what comes is no sample of this kind of sensor; are kind and address right?");
  if (const char* fault = stream_->fault()) return wrong(fmt::format("the sensor {}", fault));
  return wrong(port_ ? "the sensor says nothing; is it at its box, and is this its line?"
                     : "the sensor says nothing; has it power, and is this its address?");
}

// Asks until samples come, by serial line also until the configuration is acknowledged: else
// nobody knows which filter and zero the sensor has.
Result<void> WristSensor::start() {
  const auto answered = [&] { return !port_ || reader_.answer().has_value(); };
  bool sends = false;
  for (int i = 0; i < max_asked && !(sends && answered()); ++i) {
    if (auto asked = ask(); !asked) return asked;
    const auto until = steady_clock::now() + ask_patience;
    while (!(sends && answered()) && stream_->fault() == nullptr && steady_clock::now() < until) {
      wait(until);
      while (next()) sends = true;
    }
    if (stream_->fault() != nullptr) return wrong_start();
    if (reader_.answer().value_or(0) != 0)
      return wrong(fmt::format("the sensor refuses its configuration with error {}; is it a HEX?",
                               *reader_.answer()));
  }
  if (!sends) return wrong_start();
  if (!answered())
    return wrong(
        "the sensor does not acknowledge its configuration, so its filter is not known; "
        "plug it in again");
  return {};
}

// What is heard with nobody in a hurry: rate, rests and repeats of a sound sensor.
Result<void> WristSensor::watch() {
  std::vector<double> pauses_s;
  const double begun_s = steady_s();
  double first_s = begun_s, last_s = begun_s;
  std::uint64_t before = 0;
  const auto counted = [&] { return stream_->traffic().samples + stream_->traffic().lost; };
  const auto until = steady_clock::now() + watched;
  while (steady_clock::now() < until && stream_->fault() == nullptr) {
    wait(until);
    if (!hear()) continue;
    const double now_s = steady_s();
    if (before == 0) {
      before = counted();
      first_s = now_s;
    } else {
      pauses_s.push_back(now_s - last_s);
    }
    last_s = now_s;
  }
  if (const char* fault = stream_->fault()) return wrong(fmt::format("the sensor {}", fault));
  if (pauses_s.empty()) return wrong("the sensor falls silent; look after its cable and power");
  measured_rate_hz_ = static_cast<double>(counted() - before) / (last_s - first_s);
  if (steady_s() - last_s > 0.2) return wrong("the sensor falls silent; look after its cable");
  if (std::abs(measured_rate_hz_ / device().rate_hz - 1.0) > max_rate_off)
    return wrong(fmt::format("the sensor sends {:.0f} samples a second, {} belong here; {}",
                             measured_rate_hz_, device().rate_hz,
                             device().kind == Kind::ati_udp
                                 ? "set its RDT output rate on its own page, and `rate_hz`"
                                 : "is its line or this machine overloaded?"));
  double long_s = 0.0;
  int long_pauses = 0;
  for (const double pause_s : pauses_s) {
    if (pause_s <= max_pause_s) continue;
    long_s += pause_s;
    ++long_pauses;
  }
  if (port_ && long_s > 0.5 * (last_s - first_s))
    return wrong(
        fmt::format("samples come in bursts {:.0f} ms apart, and the guard needs one every 3; "
                    "set `latency_timer` of the USB serial line to 1",
                    1e3 * long_s / long_pauses));
  const auto& traffic = stream_->traffic();
  if (traffic.samples > 2 && traffic.longest_row + 2 >= static_cast<int>(traffic.samples))
    return wrong(
        "the sensor says the same for half a second to the last count, and no living one "
        "does; is it plugged into its box, and its filter wide enough?");
  return {};
}

void WristSensor::stop() noexcept {
  if (!stream_) return;  // moved away
  if (port_) {
    const auto quiet = hex_serial::encode_config(0, device().filter, hex_serial::keep_no_zero);
    (void)port_->write(quiet, steady_clock::now() + 10ms);  // a destructor has nobody to tell
  }
  if (socket_) socket_->send(rdt::encode(rdt::Command::stop, 0));
}

std::optional<WristSample> WristSensor::next() noexcept {
  if (socket_) {
    std::array<std::byte, 2 * rdt::record_size> bytes;
    for (int i = 0; i < max_at_once; ++i) {
      const auto size = socket_->receive(bytes);
      if (!size) return std::nullopt;
      if (auto sample = rdt::decode({bytes.data(), *size})) return sample;
      stream_->take_spoilt();
    }
    return std::nullopt;
  }
  for (int i = 0; port_ && i < max_at_once; ++i) {
    if (auto sample = reader_.next()) return sample;
    const auto size = port_->take(reader_.room());
    if (!size) stream_->break_off("was unplugged; plug it in again");
    if (!size || *size == 0) return std::nullopt;
    reader_.took(*size);
    if (reader_.spoilt_bytes() > max_spoilt_bytes)
      stream_->break_off("sends bytes that are no frame");
  }
  return std::nullopt;
}

bool WristSensor::hear(std::optional<double> now_s) noexcept {
  bool fresh = false;
  for (int i = 0; i < max_at_once && stream_->fault() == nullptr; ++i) {
    const auto sample = next();
    if (!sample) break;
    fresh = stream_->take(*sample, now_s.value_or(steady_s())) || fresh;
  }
  return fresh && stream_->fault() == nullptr;
}

void WristSensor::wait(steady_clock::time_point deadline) const noexcept {
  const int number = socket_ ? socket_->number() : port_->number();
  wait_for_datagram({&number, 1}, deadline);
}

/// Reads a serial line until its newest bytes. What kernel and device have kept comes at once, one
/// after the other makes room for the next; what the sensor says now has to be waited for.
void WristSensor::catch_up() noexcept {
  std::array<std::uint8_t, 512> old;
  const auto until = steady_clock::now() + catch_up_patience;
  for (int waited = 0; waited < 2;) {
    const auto began = steady_clock::now();
    if (began >= until) return;
    wait(began + begin_patience);
    const auto size = port_->take(old);
    if (!size || *size == 0) return;
    waited = steady_clock::now() - began < kept_comes_within ? 0 : waited + 1;
  }
}

bool WristSensor::begin_anew(std::optional<double> now_s) noexcept {
  // What lies in the queue is old, and what did not fit into it is lost.
  if (port_) catch_up();
  reader_.clear();
  for (int i = 0; socket_ && i < max_queued && next(); ++i) continue;
  stream_->begin_anew();
  const auto until =
      steady_clock::now() + (now_s ? steady_clock::duration(ask_patience) : begin_patience);
  while (stream_->fault() == nullptr && steady_clock::now() < until) {
    if (hear(now_s)) return true;
    wait(until);
  }
  return false;
}

Result<void> WristSensor::zero(const Wrench& weight_in_tool) {
  (void)begin_anew();
  Wrench sum;
  double sum2_n2 = 0.0;
  int count = 0;
  const auto until = steady_clock::now() + zero_takes;
  while (steady_clock::now() < until && stream_->fault() == nullptr) {
    wait(until);
    if (!hear()) continue;
    const Wrench& now = stream_->in_tool();
    sum.force_n += now.force_n;
    sum.torque_nm += now.torque_nm;
    sum2_n2 += now.force_n.squaredNorm();
    ++count;
  }
  if (const char* fault = stream_->fault()) return wrong(fmt::format("the sensor {}", fault));
  if (count < 10) return wrong("the sensor falls silent; look after its cable and power");
  const Vector3 mean_n = sum.force_n / count;
  const double restless_n = std::sqrt(std::max(0.0, sum2_n2 / count - mean_n.squaredNorm()));
  if (restless_n > max_restless_n)
    return wrong(
        fmt::format("the force changes by {:.1f} N while it should be zeroed, {} N are "
                    "borne; nothing may touch the tool",
                    restless_n, max_restless_n));
  const Vector3 off_n = mean_n - weight_in_tool.force_n;
  if (device().calibration && off_n.norm() > max_zero_moves_n)
    return wrong(
        fmt::format("its zero would move by {:.1f} N from its calibration, {} N are borne; "
                    "does something touch the tool? Else calibrate it again",
                    off_n.norm(), max_zero_moves_n));
  const Wrench& old = stream_->offset_in_tool();
  stream_->set_offset(
      {.force_n = old.force_n + off_n,
       .torque_nm = old.torque_nm + sum.torque_nm / count - weight_in_tool.torque_nm});
  // What is read next must not have the zero of before.
  const auto next_by = steady_clock::now() + ask_patience;
  while (!hear()) {
    if (stream_->fault() != nullptr || steady_clock::now() >= next_by)
      return wrong("the sensor falls silent; look after its cable and power");
    wait(next_by);
  }
  return {};
}

}  // namespace tuina::hardware
