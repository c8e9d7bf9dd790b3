// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/yaw_servo.hpp"

#include <array>

#include "tuina/hardware/steady_clock.hpp"

namespace tuina::hardware {
namespace {

using namespace std::chrono_literals;
using dynamixel::Packet;

constexpr auto answer_patience = 40ms;
constexpr auto boot_patience = 4s;  // opening its line starts an Arduino anew
constexpr int ax12_model = 12, ax18_model = 18;
constexpr int max_count = 1023;
constexpr double return_delay_unit_s = 2e-6;
constexpr std::size_t frame_bytes = 6;  // of a packet, beside its parameters

int pair_of(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  return bytes[at] | bytes[at + 1] << 8;
}

std::uint8_t low(int value) {
  return static_cast<std::uint8_t>(value & 0xFF);
}
std::uint8_t high(int value) {
  return static_cast<std::uint8_t>(value >> 8);
}

/// What is left of an exchange once what is known of its two ways is taken off; nothing where a
/// line is quicker than it says, such as one without bits.
BoardClock::Exchange narrowed(BoardClock::Exchange whole, double there_s, double back_s) {
  whole.sent_s += there_s;
  whole.received_s -= back_s;
  if (whole.received_s < whole.sent_s)
    whole.sent_s = whole.received_s = 0.5 * (whole.sent_s + whole.received_s);
  return whole;
}

const char* cause_of(scanner_board::Drop drop) {
  using enum scanner_board::Drop;
  switch (drop) {
    case silence:
      return "it heard nothing for 0.1 s; is this machine overloaded?";
    case stands:
      return "the beam stood still; is the unit blocked?";
    case too_long:
      return "it was lit for a minute; it may be lit again after 2 s";
    case no_motor:
      return "the motor did not answer; is its 12 V supply on?";
    case none:
      break;
  }
  return "for a cause that this program does not know";
}

}  // namespace

Result<YawServo> YawServo::open(const TurntableDevice& device) {
  auto port = SerialPort::open(device.address, device.bits_per_s);
  if (!port) return tl::unexpected(port.error());
  YawServo servo(device, DynamixelBus(std::move(*port)));
  if (const auto greeted = servo.greet(); !greeted) return tl::unexpected(greeted.error());
  return servo;
}

tl::unexpected<Error> YawServo::wrong(const std::string& what) const {
  return fail(Fault::device, "{}: {}", device_.address, what);
}

Result<void> YawServo::greet() {
  if (device_.kind == TurntableDevice::Kind::board) {
    const auto until = SerialPort::Clock::now() + boot_patience;
    auto hello = bus_.ask({scanner_board::id, dynamixel::read, {0, 3}}, 3, 200ms);
    while (!hello && SerialPort::Clock::now() < until)
      hello = bus_.ask({scanner_board::id, dynamixel::read, {0, 3}}, 3, 200ms);
    if (!hello)
      return fail(Fault::device, "{}; is it the scanner's board, with `./run firmware` on it?",
                  hello.error().message);
    const auto& is = hello->parameters;
    if (hello->kind != 0 || is.size() != 3 || is[0] != 'T' || is[1] != 'U')
      return wrong("what answers is not the scanner's board; flash `./run firmware` onto it");
    if (is[2] != scanner_board::version)
      return wrong(
          fmt::format("the board has version {} of its firmware, {} is needed; flash "
                      "`./run firmware` onto it",
                      is[2], scanner_board::version));
  }
  return greet_motor();
}

Result<void> YawServo::greet_motor() {
  if (device_.kind == TurntableDevice::Kind::adapter) {
    if (auto dark = bus_.port().raise_dtr(false); !dark) return dark;
  }
  auto table = read(ax12::model, 2);
  for (int tries = 0; !table && tries < 3; ++tries) table = read(ax12::model, 2);
  if (!table)
    return fail(Fault::device, "{}; is the motor's 12 V supply on, and its id {}?",
                table.error().message, device_.servo);
  model_ = pair_of(*table, 0);
  if (model_ != ax12_model && model_ != ax18_model)
    return wrong(fmt::format("motor {} is of model {}; an AX-12A (12) or AX-18A (18) is needed",
                             device_.servo, model_));
  const auto limits = read(ax12::angle_limits, 4);
  if (!limits) return tl::unexpected(limits.error());
  if (pair_of(*limits, 0) != 0 || pair_of(*limits, 2) != max_count)
    return wrong(
        fmt::format("motor {} is limited to counts {} to {} (addresses 6 and 8); set them "
                    "to 0 and 1023",
                    device_.servo, pair_of(*limits, 0), pair_of(*limits, 2)));
  const auto delay = read(ax12::return_delay, 1);
  if (!delay) return tl::unexpected(delay.error());
  return_delay_s_ = return_delay_unit_s * delay->front();
  return {};  // it is not told to hold: to an old goal it would turn
}

Result<std::vector<std::uint8_t>> YawServo::ask(std::uint8_t what,
                                                const std::vector<std::uint8_t>& parameters,
                                                std::size_t bytes) {
  auto answer = bus_.ask({static_cast<std::uint8_t>(device_.servo), what, parameters}, bytes,
                         answer_patience);
  if (!answer) return tl::unexpected(answer.error());
  if (answer->kind != 0)
    return wrong(
        fmt::format("motor {} says: {}", device_.servo, dynamixel::errors_of(answer->kind)));
  return std::move(answer->parameters);
}

// Settings can be read and written twice without harm, and an answer that is lost on the motor's
// line is no reason to end a sweep.
Result<std::vector<std::uint8_t>> YawServo::read(std::uint8_t address, std::uint8_t bytes) {
  auto answer = ask(dynamixel::read, {address, bytes}, bytes);
  return answer ? answer : ask(dynamixel::read, {address, bytes}, bytes);
}

Result<void> YawServo::write(std::uint8_t address, std::vector<std::uint8_t> bytes) {
  bytes.insert(bytes.begin(), address);
  auto answer = ask(dynamixel::write, bytes, 0);
  if (!answer) answer = ask(dynamixel::write, bytes, 0);
  if (!answer) return tl::unexpected(answer.error());
  return {};
}

// The time that a packet of so many parameters takes on the line.
double YawServo::line_s(std::size_t parameters) const {
  constexpr double bits_per_byte = 10.0;  // a start and a stop
  return bits_per_byte * static_cast<double>(frame_bytes + parameters) / device_.bits_per_s;
}

Result<void> YawServo::turn_to(int count, int speed) {
  return write(ax12::goal, {low(count), high(count), low(speed), high(speed)});
}

Result<YawServo::Told> YawServo::poll(bool lit) {
  return device_.kind == TurntableDevice::Kind::board ? poll_board(lit) : poll_motor(lit);
}

Result<YawServo::Told> YawServo::poll_board(bool lit) {
  // A question that is not a new one keeps nothing lit, and its number is in the answer, so that a
  // late answer is known.
  if (++sequence_ == 0) sequence_ = 1;
  const auto servo = static_cast<std::uint8_t>(device_.servo);
  const double sent_s = steady_s();
  auto answer =
      bus_.ask({scanner_board::id, scanner_board::poll, {sequence_, std::uint8_t{lit}, servo}},
               scanner_board::told_bytes, answer_patience);
  const double received_s = steady_s();
  if (!answer) return tl::unexpected(answer.error());
  const auto& told = answer->parameters;
  if (answer->kind != 0 || told.size() != scanner_board::told_bytes)
    return wrong("the board does not understand what it is asked");
  if (told[0] != sequence_)
    return wrong(fmt::format("answer {} came to question {}", told[0], sequence_));
  const auto drop = static_cast<scanner_board::Drop>(told[2]);
  if (lit && drop != scanner_board::Drop::none)
    return wrong(fmt::format("the board put the laser out: {}", cause_of(drop)));
  if (told[3] == 1) return wrong(fmt::format("motor {} does not answer", device_.servo));
  if (told[3] != 0)
    return wrong(fmt::format("motor {} answers with a wrong check sum", device_.servo));
  if (told[4] != 0)
    return wrong(fmt::format("motor {} says: {}", device_.servo, dynamixel::errors_of(told[4])));
  std::uint32_t asked_us = 0;
  for (std::size_t i = 0; i < 4; ++i) asked_us |= std::uint32_t{told[10 + i]} << (8 * i);
  min_round_trip_s_ = std::min(min_round_trip_s_, received_s - sent_s);
  const auto stamp_s = clock_.add(narrowed(
      {sent_s, received_s, asked_us}, line_s(scanner_board::asked_bytes) + 1e-6 * pair_of(told, 14),
      line_s(scanner_board::told_bytes) + 1e-6 * pair_of(told, 16)));
  if (!stamp_s) return wrong("the board: " + stamp_s.error().message);
  return Told{.stamp_s = *stamp_s, .count = pair_of(told, 5), .moving = told[9] != 0};
}

Result<YawServo::Told> YawServo::poll_motor(bool lit) {
  if (lit != lit_) {
    if (const auto switched = bus_.port().raise_dtr(lit); !switched)
      return tl::unexpected(switched.error());
    lit_ = lit;
  }
  constexpr std::uint8_t asked_bytes = 2,
                         bytes = 11;  // position, speed, load, voltage, temperature, moving
  const double sent_s = steady_s();
  const auto table = ask(dynamixel::read, {ax12::position, bytes}, bytes);
  const double received_s = steady_s();
  if (!table) return tl::unexpected(table.error());
  const auto asked =
      narrowed({sent_s, received_s, 0}, line_s(asked_bytes), return_delay_s_ + line_s(bytes));
  return Told{.stamp_s = 0.5 * (asked.sent_s + asked.received_s),
              .count = pair_of(*table, 0),
              .moving = table->back() != 0};
}

double YawServo::host_s(double stamp_s) const {
  return device_.kind == TurntableDevice::Kind::board ? clock_.host_s(stamp_s) : stamp_s;
}

std::string YawServo::who() const {
  std::string text =
      fmt::format("{} (model {})", model_ == ax12_model ? "AX-12A" : "AX-18A", model_);
  if (device_.kind == TurntableDevice::Kind::board)
    text = fmt::format("board version {}, {}, round trip {:.1f} ms", scanner_board::version, text,
                       1e3 * min_round_trip_s_);
  return text;
}

}  // namespace tuina::hardware
