// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/hardware/pseudo_terminal.hpp"
#include "tests/hardware/servo_emulator.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/ax12_turntable.hpp"
#include "tuina/hardware/steady_clock.hpp"
#include "tuina/hardware/yaw_servo.hpp"

namespace tuina::tests {

/// Whether serial lines have a line DTR, which those of this machine that are emulated have not,
/// and whether it is raised. ax12_turntable_test.cpp puts one in.
extern std::atomic<bool> adapters_have_dtr, dtr_is_high;

/// The board of the scanner with its motor, or the motor alone, at the other end of a pty; the
/// script says what goes wrong from its `from_poll`-th question for the motor's state on.
class ScriptedBoard {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Script {
    bool alone = false;        ///< no board: a motor at a USB adapter
    bool echo = false;         ///< what is sent comes back
    std::string address = {};  ///< where the driver looks for it, if not where it is
    int from_poll = 0;         ///< begins this many polls after the first that wants the laser
    bool once = false;         ///< and ends with that one
    bool unplugged = false;
    std::function<void(ServoEmulator&, double time_s)> motor;     ///< before it answers
    std::function<void(Bytes& told)> told;                        ///< of an answer of the board
    std::function<void(Bytes& packet)> packet;                    ///< as it is sent
    std::function<void(std::array<std::uint8_t, 3>& who)> hello;  ///< from the beginning
    double board_rate = 1.0;                                      ///< of the board's clock
  };

  explicit ScriptedBoard(Script script)
      : script_(std::move(script)), began_s_(hardware::steady_s()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~ScriptedBoard() {
    thread_.request_stop();
    thread_.join();
    unplug();
  }
  ScriptedBoard(const ScriptedBoard&) = delete;
  ScriptedBoard& operator=(const ScriptedBoard&) = delete;

  [[nodiscard]] hardware::TurntableDevice device() const {
    using Kind = hardware::TurntableDevice::Kind;
    return {.kind = script_.alone ? Kind::adapter : Kind::board,
            .address = script_.address.empty() ? line_.address() : script_.address,
            .bits_per_s = script_.alone ? 1'000'000 : 500'000};
  }
  [[nodiscard]] bool lit() const { return lit_; }
  /// When the last question came that kept the laser lit.
  [[nodiscard]] double last_lit_s() const { return last_lit_s_; }
  [[nodiscard]] ServoEmulator& servo() { return servo_; }

 private:
  void unplug() {
    line_.unplug();
    lit_ = false;
  }
  void run(const std::stop_token& stop) {
    hardware::dynamixel::Reader reader;
    while (!stop.stop_requested() && line_.end() >= 0) {
      pollfd wanted = {.fd = line_.end(), .events = POLLIN, .revents = 0};
      if (::poll(&wanted, 1, 5) <= 0) {
        if (lit_ && hardware::steady_s() - last_lit_s_ > 0.1) drop(1);
        continue;
      }
      std::array<std::uint8_t, 256> bytes;
      const ssize_t size = ::read(line_.end(), bytes.data(), bytes.size());
      if (size <= 0) continue;
      if (script_.echo) (void)!::write(line_.end(), bytes.data(), static_cast<std::size_t>(size));
      reader.add({bytes.data(), static_cast<std::size_t>(size)});
      while (const auto packet = reader.next()) answer(*packet);
    }
  }
  void drop(std::uint8_t why) {
    lit_ = false;
    drop_ = why;
  }
  [[nodiscard]] bool acts(bool is_poll) {
    if (is_poll && (polls_ > 0 || wants_lit_)) ++polls_;
    return script_.once ? is_poll && polls_ == script_.from_poll + 1 : polls_ > script_.from_poll;
  }
  void answer(const hardware::dynamixel::Packet& in) {
    namespace board = hardware::scanner_board;
    const double now_s = hardware::steady_s();
    const bool for_board = in.id == board::id && !script_.alone;
    const bool is_poll = for_board ? in.kind == board::poll
                                   : in.kind == hardware::dynamixel::read &&
                                         in.parameters[0] == hardware::ax12::position;
    if (for_board && is_poll) wants_lit_ = in.parameters[1] != 0;
    if (script_.alone) wants_lit_ = true;
    const bool act = acts(is_poll);
    if (act && script_.unplugged) return unplug();
    if (act && script_.motor) script_.motor(servo_, now_s);
    Bytes out;
    if (!for_board) {
      out = servo_.answer(in, now_s);
    } else if (is_poll) {
      out = poll(in, now_s, act);
    } else {
      std::array<std::uint8_t, 3> who = {'T', 'U', board::version};
      if (script_.hello) script_.hello(who);
      out = hardware::dynamixel::encode({board::id, 0, {who.begin(), who.end()}});
    }
    if (act && script_.packet) script_.packet(out);
    if (!out.empty()) (void)!::write(line_.end(), out.data(), out.size());
  }
  Bytes poll(const hardware::dynamixel::Packet& in, double now_s, bool act) {
    if (!wants_lit_) drop(0);
    if (wants_lit_ && drop_ == 0) {
      lit_ = true;
      last_lit_s_ = now_s;
    }
    Bytes told(hardware::scanner_board::told_bytes);
    told[0] = in.parameters[0];
    told[1] = lit_;
    told[2] = drop_;
    const auto state = servo_.state(now_s);
    told[4] = servo_.error;
    std::copy_n(state.begin(), 2, told.begin() + 5);
    std::copy_n(state.begin() + 4, 2, told.begin() + 7);
    told[9] = state[10];
    const auto stamp_us = static_cast<std::uint32_t>(
        static_cast<std::int64_t>(1e6 * script_.board_rate * (now_s - began_s_)) + wraps_after_us_);
    for (unsigned i = 0; i < 4; ++i) told[10 + i] = static_cast<std::uint8_t>(stamp_us >> (8 * i));
    if (act && script_.told) script_.told(told);
    return hardware::dynamixel::encode({hardware::scanner_board::id, 0, told});
  }

  // The 32 bits of its clock come to their end soon after it began.
  static constexpr std::int64_t wraps_after_us_ = 0xFFFFFFFFLL - 1'000'000;
  Script script_;
  ServoEmulator servo_;
  PseudoTerminal line_;
  int polls_ = 0;
  bool wants_lit_ = false;
  std::uint8_t drop_ = 0;
  double began_s_;
  std::atomic<bool> lit_ = false;
  std::atomic<double> last_lit_s_ = 0.0;
  std::jthread thread_;
};

/// How a sweep or a turn in steps ended, of which frames are asked for at once; "arrived" when it
/// did.
inline std::string end_of_turn(hardware::Ax12Turntable& unit, double rad_per_s,
                               bool steps = false) {
  const auto began = steps ? unit.step(from_deg(-3.0), from_deg(3.0), from_deg(1.0))
                           : unit.sweep(from_deg(-6.0), from_deg(6.0), rad_per_s);
  if (!began) return began.error().message;
  if (const auto lit = unit.switch_laser(true); !lit) return lit.error().message;
  for (;;) {
    const auto arrived = unit.arrived();
    if (!arrived) return arrived.error().message;
    if (*arrived) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const auto readings = unit.readings();
  if (!readings) return readings.error().message;
  return "arrived";
}

}  // namespace tuina::tests
