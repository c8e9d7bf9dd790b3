/* SPDX-License-Identifier: Apache-2.0
 * armlink, version 1, as docs/armlink.md specifies it: what one robot arm and its host say to each other over UDP.
 * C99, no dependency. Numbers are little-endian on the wire whatever the machine is; doubles are IEEE 754. */
#ifndef ARMLINK_H
#define ARMLINK_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum {
  ARMLINK_VERSION = 1,
  ARMLINK_MAX_JOINTS = 7,
  ARMLINK_MAX_MISSED = 3,  /* cycles without a command after which an arm under torque stops by itself */
  ARMLINK_MAX_AGE = 8,     /* cycles from a state to its command, beyond which the arm does not hear it */
  ARMLINK_ASK = 1, ARMLINK_HELLO = 2, ARMLINK_COMMAND = 3, ARMLINK_STATE = 4, /* kinds of datagrams */
  ARMLINK_ASK_SIZE = 20, ARMLINK_HELLO_SIZE = 292, ARMLINK_COMMAND_SIZE = 92, ARMLINK_STATE_SIZE = 268
};
enum armlink_mode {
  ARMLINK_IDLE = 0,       /* brakes closed; the end of a session */
  ARMLINK_TORQUE = 1,     /* values: joint torques in Nm, gravity compensation included */
  ARMLINK_ADMITTANCE = 2, /* reserved */
  ARMLINK_READY = 3       /* values: joint angles in rad, which the arm takes and holds by its own drives */
};
enum armlink_status {
  ARMLINK_STANDS = 1,         /* mode READY: it is there */
  ARMLINK_STOPPED = 2,        /* it has stopped by itself and obeys nobody until the next session */
  ARMLINK_BRAKED = 4,         /* its brakes are closed */
  ARMLINK_DRIVE_FAULT = 8,
  ARMLINK_EMERGENCY_STOP = 16
};
enum armlink_flag {
  ARMLINK_HAS_RAIL = 1,  /* rail_m of commands and states means the linear base */
  ARMLINK_SIMULATED = 2, /* nobody can be touched by it */
  ARMLINK_WAITS = 4,     /* simulated: a cycle lasts until the host has answered it */
  ARMLINK_BUSY = 8,      /* another host has a session */
  ARMLINK_MEASURES_TORQUE = 16 /* tau_nm of states is measured: by the currents, or by sensors in the joints */
};

/* Where the fields of each datagram begin. */
enum {
  ARMLINK_AT_MAGIC = 0, ARMLINK_AT_VERSION = 4, ARMLINK_AT_KIND = 5, ARMLINK_AT_SIZE = 6,
  ARMLINK_AT_SESSION = 8, ARMLINK_AT_SEQUENCE = 12,

  ARMLINK_HELLO_AT_JOINTS = 16, ARMLINK_HELLO_AT_MODES = 17, ARMLINK_HELLO_AT_FLAGS = 18,
  ARMLINK_HELLO_AT_CYCLE_US = 20, ARMLINK_HELLO_AT_NAME = 24, ARMLINK_HELLO_AT_MAX_TORQUE = 48,
  ARMLINK_HELLO_AT_MAX_SPEED = 104, ARMLINK_HELLO_AT_MIN_ANGLE = 160, ARMLINK_HELLO_AT_MAX_ANGLE = 216,
  ARMLINK_HELLO_AT_MIN_RAIL = 272, ARMLINK_HELLO_AT_MAX_RAIL = 280,

  ARMLINK_COMMAND_AT_ANSWERS = 16, ARMLINK_COMMAND_AT_MODE = 20, ARMLINK_COMMAND_AT_JOINTS = 21,
  ARMLINK_COMMAND_AT_BRAKE = 22, ARMLINK_COMMAND_AT_ZERO = 23, ARMLINK_COMMAND_AT_RAIL = 24,
  ARMLINK_COMMAND_AT_VALUES = 32,

  ARMLINK_STATE_AT_ANSWERS = 16, ARMLINK_STATE_AT_MODE = 20, ARMLINK_STATE_AT_JOINTS = 21,
  ARMLINK_STATE_AT_STATUS = 22, ARMLINK_STATE_AT_TIME = 24, ARMLINK_STATE_AT_WRENCH_TIME = 32,
  ARMLINK_STATE_AT_RAIL = 40, ARMLINK_STATE_AT_Q = 48, ARMLINK_STATE_AT_DQ = 104,
  ARMLINK_STATE_AT_TAU = 160, ARMLINK_STATE_AT_WRENCH = 216
};

struct armlink_hello {
  uint32_t session, sequence; /* those of the question */
  uint8_t joints, modes;      /* modes: bit 1 << mode */
  uint16_t flags;
  uint32_t cycle_us;
  char name[24]; /* ends with zeros */
  double max_torque_nm[ARMLINK_MAX_JOINTS], max_speed_rad_per_s[ARMLINK_MAX_JOINTS];
  double min_rad[ARMLINK_MAX_JOINTS], max_rad[ARMLINK_MAX_JOINTS];
  double min_rail_m, max_rail_m;
};
struct armlink_command {
  uint32_t session, sequence, answers; /* answers: sequence of the state that it answers */
  uint8_t mode, joints, brake;
  double rail_m;
  double values[ARMLINK_MAX_JOINTS]; /* by the mode */
};
struct armlink_state {
  uint32_t session, sequence, answers; /* answers: sequence of the last command that was obeyed */
  uint8_t mode, joints;
  uint16_t status;
  double time_s, wrench_time_s, rail_m; /* the arm's own clock; when the wrist sensor took its sample */
  double q_rad[ARMLINK_MAX_JOINTS], dq_rad_per_s[ARMLINK_MAX_JOINTS], tau_nm[ARMLINK_MAX_JOINTS];
  double wrench_in_tool[6]; /* force in N, then torque in Nm, of the world on the tool, its weight included */
};

static inline void armlink_put(uint8_t* at, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) at[i] = (uint8_t)(value >> (8 * i));
}
static inline uint64_t armlink_get(const uint8_t* at, int bytes) {
  uint64_t value = 0;
  for (int i = bytes; i-- > 0;) value = value << 8 | at[i];
  return value;
}
static inline void armlink_put_doubles(uint8_t* at, const double* values, int count) {
  for (int i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    armlink_put(at + 8 * i, bits, 8);
  }
}
static inline void armlink_get_doubles(const uint8_t* at, double* values, int count) {
  for (int i = 0; i < count; ++i) {
    const uint64_t bits = armlink_get(at + 8 * i, 8);
    memcpy(&values[i], &bits, sizeof bits);
  }
}

/* CRC-32 of IEEE 802.3, as in zlib and Ethernet; crc of "123456789" is 0xCBF43926. */
static inline uint32_t armlink_crc(const uint8_t* bytes, int size) {
  uint32_t crc = 0xFFFFFFFFu;
  for (int i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

static inline void armlink_begin(uint8_t* out, int kind, int size, uint32_t session, uint32_t sequence) {
  memset(out, 0, (size_t)size);
  memcpy(out + ARMLINK_AT_MAGIC, "TARM", 4);
  armlink_put(out + ARMLINK_AT_VERSION, ARMLINK_VERSION, 1);
  armlink_put(out + ARMLINK_AT_KIND, (uint64_t)kind, 1);
  armlink_put(out + ARMLINK_AT_SIZE, (uint64_t)size, 2);
  armlink_put(out + ARMLINK_AT_SESSION, session, 4);
  armlink_put(out + ARMLINK_AT_SEQUENCE, sequence, 4);
}
static inline void armlink_end(uint8_t* out, int size) {
  armlink_put(out + size - 4, armlink_crc(out, size - 4), 4);
}

/* The kind of a sound datagram of this version, 0 otherwise. */
static inline int armlink_kind(const uint8_t* in, int size) {
  static const int sizes[5] = {0, ARMLINK_ASK_SIZE, ARMLINK_HELLO_SIZE, ARMLINK_COMMAND_SIZE, ARMLINK_STATE_SIZE};
  if (size < ARMLINK_ASK_SIZE || memcmp(in, "TARM", 4) != 0 || in[ARMLINK_AT_VERSION] != ARMLINK_VERSION) return 0;
  const int kind = in[ARMLINK_AT_KIND];
  if (kind < ARMLINK_ASK || kind > ARMLINK_STATE || size != sizes[kind]) return 0;
  if (armlink_get(in + ARMLINK_AT_SIZE, 2) != (uint64_t)size) return 0;
  return armlink_get(in + size - 4, 4) == armlink_crc(in, size - 4) ? kind : 0;
}

static inline void armlink_write_hello(uint8_t out[ARMLINK_HELLO_SIZE], const struct armlink_hello* hello) {
  armlink_begin(out, ARMLINK_HELLO, ARMLINK_HELLO_SIZE, hello->session, hello->sequence);
  armlink_put(out + ARMLINK_HELLO_AT_JOINTS, hello->joints, 1);
  armlink_put(out + ARMLINK_HELLO_AT_MODES, hello->modes, 1);
  armlink_put(out + ARMLINK_HELLO_AT_FLAGS, hello->flags, 2);
  armlink_put(out + ARMLINK_HELLO_AT_CYCLE_US, hello->cycle_us, 4);
  memcpy(out + ARMLINK_HELLO_AT_NAME, hello->name, sizeof hello->name);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MAX_TORQUE, hello->max_torque_nm, hello->joints);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MAX_SPEED, hello->max_speed_rad_per_s, hello->joints);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MIN_ANGLE, hello->min_rad, hello->joints);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MAX_ANGLE, hello->max_rad, hello->joints);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MIN_RAIL, &hello->min_rail_m, 1);
  armlink_put_doubles(out + ARMLINK_HELLO_AT_MAX_RAIL, &hello->max_rail_m, 1);
  armlink_end(out, ARMLINK_HELLO_SIZE);
}

static inline void armlink_write_state(uint8_t out[ARMLINK_STATE_SIZE], const struct armlink_state* state) {
  armlink_begin(out, ARMLINK_STATE, ARMLINK_STATE_SIZE, state->session, state->sequence);
  armlink_put(out + ARMLINK_STATE_AT_ANSWERS, state->answers, 4);
  armlink_put(out + ARMLINK_STATE_AT_MODE, state->mode, 1);
  armlink_put(out + ARMLINK_STATE_AT_JOINTS, state->joints, 1);
  armlink_put(out + ARMLINK_STATE_AT_STATUS, state->status, 2);
  armlink_put_doubles(out + ARMLINK_STATE_AT_TIME, &state->time_s, 1);
  armlink_put_doubles(out + ARMLINK_STATE_AT_WRENCH_TIME, &state->wrench_time_s, 1);
  armlink_put_doubles(out + ARMLINK_STATE_AT_RAIL, &state->rail_m, 1);
  armlink_put_doubles(out + ARMLINK_STATE_AT_Q, state->q_rad, state->joints);
  armlink_put_doubles(out + ARMLINK_STATE_AT_DQ, state->dq_rad_per_s, state->joints);
  armlink_put_doubles(out + ARMLINK_STATE_AT_TAU, state->tau_nm, state->joints);
  armlink_put_doubles(out + ARMLINK_STATE_AT_WRENCH, state->wrench_in_tool, 6);
  armlink_end(out, ARMLINK_STATE_SIZE);
}

/* Of a datagram whose kind is COMMAND. 0 where a value is no finite number or a mode is unknown. */
static inline int armlink_read_command(const uint8_t in[ARMLINK_COMMAND_SIZE], struct armlink_command* command) {
  memset(command, 0, sizeof *command);
  command->session = (uint32_t)armlink_get(in + ARMLINK_AT_SESSION, 4);
  command->sequence = (uint32_t)armlink_get(in + ARMLINK_AT_SEQUENCE, 4);
  command->answers = (uint32_t)armlink_get(in + ARMLINK_COMMAND_AT_ANSWERS, 4);
  command->mode = in[ARMLINK_COMMAND_AT_MODE];
  command->joints = in[ARMLINK_COMMAND_AT_JOINTS];
  command->brake = in[ARMLINK_COMMAND_AT_BRAKE];
  armlink_get_doubles(in + ARMLINK_COMMAND_AT_RAIL, &command->rail_m, 1);
  armlink_get_doubles(in + ARMLINK_COMMAND_AT_VALUES, command->values, ARMLINK_MAX_JOINTS);
  int sound = command->mode != ARMLINK_ADMITTANCE && command->mode <= ARMLINK_READY && command->brake <= 1;
  sound = sound && in[ARMLINK_COMMAND_AT_ZERO] == 0;
  sound = sound && command->joints >= 1 && command->joints <= ARMLINK_MAX_JOINTS;
  sound = sound && command->rail_m - command->rail_m == 0.0; /* neither infinite nor NaN */
  for (int i = 0; i < ARMLINK_MAX_JOINTS; ++i) {
    sound = sound && command->values[i] - command->values[i] == 0.0;
    sound = sound && (i < command->joints || armlink_get(in + ARMLINK_COMMAND_AT_VALUES + 8 * i, 8) == 0);
  }
  return sound;
}

#endif
