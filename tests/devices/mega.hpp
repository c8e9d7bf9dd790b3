// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>

struct avr_t;
struct avr_irq_t;

namespace tuina::tests {

/// An Arduino Mega 2560 in simavr with a program in it: its first two serial lines and the pin of
/// the laser. Time is that of its own clock, which advances by `run_to` alone.
class Mega {
 public:
  /// Throws where the program cannot be read.
  explicit Mega(const std::string& elf);
  ~Mega();
  Mega(const Mega&) = delete;
  Mega& operator=(const Mega&) = delete;

  void run_to(double time_s);
  [[nodiscard]] double time_s() const;
  /// A byte that reaches the board on one of its lines, not before this time.
  void send(int line, std::uint8_t byte, double time_s);
  /// Told of each byte that the board sends, when it does.
  std::function<void(int line, std::uint8_t byte)> on_byte;
  [[nodiscard]] bool laser_lit() const { return lit_; }
  /// When the laser was last switched.
  [[nodiscard]] double switched_s() const { return switched_s_; }
  [[nodiscard]] bool crashed() const;

 private:
  struct Due {
    double time_s;
    std::uint8_t byte;
  };
  struct Line {
    Mega* mega = nullptr;
    int number = 0;
    avr_irq_t* input = nullptr;
    bool open = true;
    std::deque<Due> due;
  };
  void feed();
  static void out(avr_irq_t*, std::uint32_t value, void* line);
  static void on(avr_irq_t*, std::uint32_t, void* line);
  static void off(avr_irq_t*, std::uint32_t, void* line);
  static void laser(avr_irq_t*, std::uint32_t value, void* mega);

  avr_t* avr_ = nullptr;
  Line lines_[2];
  bool lit_ = false;
  double switched_s_ = 0.0;
};

}  // namespace tuina::tests
