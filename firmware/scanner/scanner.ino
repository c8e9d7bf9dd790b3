// SPDX-License-Identifier: Apache-2.0
// The board of the scanner, an Arduino Mega 2560: between the host on Serial (500 kbit/s) and the yaw motor, an AX-12A,
// on Serial1 (1 Mbit/s, TX1 and RX1 joined to one wire). Both speak the Dynamixel protocol 1.0. The board is device 200
// for the host; packets for others are passed on to the motor and its answers back. One instruction is the board's own:
//
//   0x10 poll   sequence, lit, motor's id -> sequence, lit, why the laser was put out, motor's answer (0 good, 1 none,
//               2 wrong check sum), its error bits, position (2 bytes), load (2 bytes), moving, micros() when the motor
//               was asked, which reads its position then (4 bytes), microseconds from the poll to that and from that to
//               this answer (2 bytes each), by which the host knows better when it was
//
// The laser is lit by polls that ask for it, each with a sequence other than the one before. It goes out when none has
// come for 100 ms, when the beam stands, when the motor is silent, and after a minute; then it stays out until a poll
// has asked for darkness. The watchdog puts it out when this program hangs, and a reset leaves it dark.
#include <avr/sleep.h>
#include <avr/wdt.h>

const uint8_t laser_pin = 8, lamp_pin = 13;  // switch of the laser; the board's own lamp beside it
const uint8_t board_id = 200, version = 2;
const uint8_t instruction_ping = 1, instruction_read = 2, instruction_poll = 0x10;
const uint8_t max_length = 34;  // of a packet: parameters and two
const uint8_t told_bytes = 18;

const unsigned long max_silence_ms = 100;
const unsigned long max_stand_ms = 250;  // two counts of the motor, 0.59 degrees, at 2.3 degrees per second
const unsigned long max_lit_ms = 60000, rest_ms = 2000;
const unsigned long motor_patience_us = 3000, motor_byte_us = 10;

enum Drop : uint8_t { drop_none, drop_silence, drop_stands, drop_too_long, drop_no_motor };

struct Laser {
  bool lit;
  Drop drop;
  uint8_t sequence;
  unsigned long asked_ms, lit_since_ms, out_since_ms;
  int min_count, max_count;  // where the motor has been since the laser is lit
  unsigned long moved_ms;    // when it last went two counts farther
  unsigned long motor_ms;  // when the motor last answered
} laser;

void put_out(Drop why) {
  digitalWrite(laser_pin, LOW);
  digitalWrite(lamp_pin, LOW);
  if (laser.lit) laser.out_since_ms = millis();
  laser.lit = false;
  laser.drop = why;
}

// The program hangs: interrupts still come.
ISR(WDT_vect) {
  put_out(drop_silence);
}

void watch_laser() {
  wdt_reset();
  if (!laser.lit) return;
  const unsigned long now = millis();
  if (now - laser.asked_ms > max_silence_ms) put_out(drop_silence);
  else if (now - laser.moved_ms > max_stand_ms) put_out(drop_stands);
  else if (now - laser.motor_ms > max_silence_ms) put_out(drop_no_motor);
  else if (now - laser.lit_since_ms > max_lit_ms) put_out(drop_too_long);
}

// One packet as it comes in byte by byte; of what is none, as much is forgotten as has to be.
struct Incoming {
  uint8_t bytes[max_length + 4];
  uint8_t size;
};

// True when the packet is whole and its check sum right.
bool take(Incoming& in, uint8_t byte, bool& broken) {
  broken = false;
  if (in.size < 2 && byte != 0xFF) { in.size = 0; return false; }
  if (in.size == 2 && byte == 0xFF) return false;  // no device has this id
  if (in.size == 3 && (byte < 2 || byte > max_length)) { in.size = 0; return false; }
  in.bytes[in.size++] = byte;
  if (in.size < 4 || in.size < in.bytes[3] + 4) return false;
  uint8_t sum = 0;
  for (uint8_t i = 2; i < in.size; ++i) sum += in.bytes[i];
  broken = sum != 0xFF;
  if (broken) in.size = 0;
  return !broken;
}

void send(Stream& to, uint8_t id, uint8_t kind, const uint8_t* parameters, uint8_t count) {
  uint8_t bytes[max_length + 4] = {0xFF, 0xFF, id, (uint8_t)(count + 2), kind};
  uint8_t sum = id + count + 2 + kind;
  for (uint8_t i = 0; i < count; ++i) sum += bytes[5 + i] = parameters[i];
  bytes[5 + count] = ~sum;
  to.write(bytes, count + 6);
}

// Sends a packet to the motor and waits for its answer: 0 good, 1 none, 2 wrong check sum. What is sent comes back on
// the one wire and is dropped. `asked_us` is when the last byte had gone out.
uint8_t ask_motor(const uint8_t* question, uint8_t size, Incoming& answer, unsigned long& asked_us) {
  while (Serial1.available()) Serial1.read();
  answer.size = 0;
  Serial1.write(question, size);
  uint8_t echoed = 0;
  bool is_echo = true, any_broken = false;
  const unsigned long sent_us = micros();
  unsigned long last_us = sent_us;
  asked_us = sent_us + motor_byte_us * size;  // where nothing comes back
  while (micros() - last_us < motor_patience_us && micros() - sent_us < 3 * motor_patience_us) {
    watch_laser();
    if (!Serial1.available()) continue;
    const uint8_t byte = Serial1.read();
    last_us = micros();
    if (is_echo && echoed < size) {
      if (byte == question[echoed]) {
        if (++echoed == size) asked_us = last_us;
        continue;
      }
      // It was no echo, but an answer that begins alike.
      is_echo = false;
      bool broken;
      for (uint8_t i = 0; i < echoed; ++i) take(answer, question[i], broken);
    }
    bool broken;
    if (take(answer, byte, broken)) return 0;
    any_broken = any_broken || broken;
  }
  return any_broken ? 2 : 1;
}

void poll(const uint8_t* asked, unsigned long heard_us) {
  const uint8_t sequence = asked[0], lit = asked[1], motor = asked[2];
  const uint8_t question[8] = {0xFF, 0xFF, motor, 4, instruction_read, 36, 11,
                               (uint8_t)~(motor + 4 + instruction_read + 36 + 11)};
  Incoming answer;
  unsigned long asked_us;
  uint8_t told[told_bytes] = {sequence};
  told[3] = ask_motor(question, sizeof question, answer, asked_us);
  if (told[3] == 0 && (answer.bytes[2] != motor || answer.size != 17)) told[3] = 2;
  const unsigned long now = millis();
  if (told[3] == 0) {
    told[4] = answer.bytes[4];
    for (uint8_t i = 0; i < 2; ++i) {
      told[5 + i] = answer.bytes[5 + i];  // 36, position
      told[7 + i] = answer.bytes[9 + i];  // 40, load
    }
    told[9] = answer.bytes[15];  // 46, moving
    laser.motor_ms = now;
    const int count = told[5] | told[6] << 8;
    if (count <= laser.min_count - 2) {
      laser.min_count = count;
      laser.moved_ms = now;
    } else if (count >= laser.max_count + 2) {
      laser.max_count = count;
      laser.moved_ms = now;
    }
    if (lit && !laser.lit && laser.drop == drop_none &&
        sequence != laser.sequence) {
      laser.lit = true;
      laser.min_count = laser.max_count = count;
      laser.lit_since_ms = laser.moved_ms = laser.asked_ms = now;
      digitalWrite(laser_pin, HIGH);
      digitalWrite(lamp_pin, HIGH);
    }
  }
  if (sequence != laser.sequence && lit) laser.asked_ms = now;
  laser.sequence = sequence;
  watch_laser();
  if (!lit) {
    const bool rests = laser.drop == drop_too_long && now - laser.out_since_ms < rest_ms;
    put_out(rests ? drop_too_long : drop_none);
  }
  told[1] = laser.lit;
  told[2] = laser.drop;
  for (uint8_t i = 0; i < 4; ++i) told[10 + i] = asked_us >> (8 * i);
  const uint16_t before_us = asked_us - heard_us, after_us = micros() - asked_us;
  for (uint8_t i = 0; i < 2; ++i) {
    told[14 + i] = before_us >> (8 * i);
    told[16 + i] = after_us >> (8 * i);
  }
  send(Serial, board_id, 0, told, sizeof told);
}

void obey(const Incoming& in, unsigned long heard_us) {
  const uint8_t id = in.bytes[2], instruction = in.bytes[4], count = in.bytes[3] - 2;
  if (id != board_id) {
    Incoming answer;
    unsigned long asked_us;
    if (ask_motor(in.bytes, in.size, answer, asked_us) == 0) Serial.write(answer.bytes, answer.size);
  } else if (instruction == instruction_poll && count == 3) {
    poll(in.bytes + 5, heard_us);
  } else if (instruction == instruction_read && count == 2 && in.bytes[5] == 0 && in.bytes[6] == 3) {
    const uint8_t who[3] = {'T', 'U', version};
    send(Serial, board_id, 0, who, sizeof who);
  } else if (instruction == instruction_ping && count == 0) {
    send(Serial, board_id, 0, 0, 0);
  } else {
    send(Serial, board_id, 0x40, 0, 0);  // instruction unknown
  }
}

Incoming from_host;

void setup() {
  pinMode(laser_pin, OUTPUT);
  pinMode(lamp_pin, OUTPUT);
  put_out(drop_none);
  Serial.begin(500000);
  Serial1.begin(1000000);
  // The interrupt alone: after a reset by the watchdog the bootloaders of some boards never end.
  cli();
  wdt_reset();
  WDTCSR = _BV(WDCE) | _BV(WDE);
  WDTCSR = _BV(WDIE) | _BV(WDP1) | _BV(WDP0);  // 125 ms
  sei();
  set_sleep_mode(SLEEP_MODE_IDLE);
}

void loop() {
  watch_laser();
  bool broken;
  if (Serial.available()) {
    if (take(from_host, Serial.read(), broken)) {
      obey(from_host, micros());
      from_host.size = 0;
    }
    return;
  }
  sleep_mode();  // until a byte or the next millisecond comes
}
