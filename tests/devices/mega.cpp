// SPDX-License-Identifier: Apache-2.0
#include "tests/devices/mega.hpp"

#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace tuina::tests {
namespace {

constexpr double hz = 16e6;
constexpr double slice_s = 50e-6;  // a byte at 500 kbit/s takes 20 us, at 1 Mbit/s 10

}  // namespace

Mega::Mega(const std::string& elf) {
  elf_firmware_t firmware = {};
  avr_ = avr_make_mcu_by_name("atmega2560");
  if (avr_ == nullptr || elf_read_firmware(elf.c_str(), &firmware) != 0)
    throw std::runtime_error("cannot read " + elf);
  avr_init(avr_);
  avr_->log = LOG_ERROR;
  avr_->frequency = static_cast<std::uint32_t>(hz);
  avr_load_firmware(avr_, &firmware);
  avr_->frequency = static_cast<std::uint32_t>(hz);
  avr_->sleep = [](avr_t*, avr_cycle_count_t) {};  // whoever runs it keeps the pace
  for (int i = 0; i < 2; ++i) {
    lines_[i].mega = this;
    lines_[i].number = i;
    const auto name = static_cast<char>('0' + i);
    std::uint32_t flags = 0;
    avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS(name), &flags);
    const auto irq = [&](int which) {
      return avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ(name), which);
    };
    lines_[i].input = irq(UART_IRQ_INPUT);
    avr_irq_register_notify(irq(UART_IRQ_OUTPUT), out, &lines_[i]);
    avr_irq_register_notify(irq(UART_IRQ_OUT_XON), on, &lines_[i]);
    avr_irq_register_notify(irq(UART_IRQ_OUT_XOFF), off, &lines_[i]);
  }
  // Digital pin 8 of the Mega is bit 5 of port H.
  avr_irq_register_notify(avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ('H'), IOPORT_IRQ_PIN5), laser,
                          this);
}

Mega::~Mega() {
  avr_terminate(avr_);
}

double Mega::time_s() const {
  return static_cast<double>(avr_->cycle) / hz;
}

bool Mega::crashed() const {
  return avr_->state == cpu_Done || avr_->state == cpu_Crashed;
}

void Mega::run_to(double time_s) {
  const auto end = static_cast<avr_cycle_count_t>(hz * time_s);
  constexpr auto slice = static_cast<avr_cycle_count_t>(hz * slice_s);
  while (avr_->cycle < end && !crashed()) {
    feed();
    const avr_cycle_count_t until = std::min(end, avr_->cycle + slice);
    while (avr_->cycle < until && !crashed()) avr_run(avr_);
  }
}

void Mega::feed() {
  for (Line& line : lines_) {
    while (line.open && !line.due.empty() && line.due.front().time_s <= time_s()) {
      const std::uint8_t byte = line.due.front().byte;
      line.due.pop_front();
      avr_raise_irq(line.input, byte);
    }
  }
}

void Mega::send(int line, std::uint8_t byte, double time_s) {
  lines_[line].due.push_back({time_s, byte});
}

void Mega::out(avr_irq_t*, std::uint32_t value, void* line) {
  const auto& from = *static_cast<Line*>(line);
  if (from.mega->on_byte) from.mega->on_byte(from.number, static_cast<std::uint8_t>(value));
}

void Mega::on(avr_irq_t*, std::uint32_t, void* line) {
  static_cast<Line*>(line)->open = true;
}

void Mega::off(avr_irq_t*, std::uint32_t, void* line) {
  static_cast<Line*>(line)->open = false;
}

void Mega::laser(avr_irq_t*, std::uint32_t value, void* mega) {
  auto& self = *static_cast<Mega*>(mega);
  self.lit_ = (value & 1U) != 0;
  self.switched_s_ = self.time_s();
}

}  // namespace tuina::tests
