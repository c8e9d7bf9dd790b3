/* SPDX-License-Identifier: Apache-2.0
 * The arm's side of armlink (docs/armlink.md) around a pretended arm: arm_client PORT [JOINTS].
 * To wrap your own arm, replace the functions of `struct arm` below; the rest keeps the protocol.
 *
 *   cc -std=c99 -O2 -Wall -Wextra -Werror arm_client.c -o arm_client
 */
#define _POSIX_C_SOURCE 200112L
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "armlink.h"

enum { CYCLE_US = 1000, MIN_DAMPED_CYCLES = 300, MAX_DAMPED_CYCLES = 2000, ALONE_AFTER_CYCLES = 1000 };
static const double still_rad_per_s = 0.05;

/* ---- The arm: replace this. -------------------------------------------------------------------------------- */

/* A pretended arm without weight: each joint is a rotor with some friction. */
struct arm {
  int joints;
  double q_rad[ARMLINK_MAX_JOINTS], dq_rad_per_s[ARMLINK_MAX_JOINTS], tau_nm[ARMLINK_MAX_JOINTS];
};
static const double max_torque_nm = 120.0, max_speed_rad_per_s = 10.0, max_rad = 3.1, cycle_s = 1e-6 * CYCLE_US;

/* One cycle under these torques. */
static void arm_apply_torque(struct arm* arm, const double* torque_nm) {
  const double inertia = 0.2, friction = 1.0;
  for (int i = 0; i < arm->joints; ++i) {
    arm->tau_nm[i] = torque_nm[i] > max_torque_nm ? max_torque_nm : torque_nm[i] < -max_torque_nm ? -max_torque_nm : torque_nm[i];
    arm->dq_rad_per_s[i] += cycle_s * (arm->tau_nm[i] - friction * arm->dq_rad_per_s[i]) / inertia;
    arm->q_rad[i] += cycle_s * arm->dq_rad_per_s[i];
  }
}
/* One cycle of its own drives without a command: they carry the weight and take the speed out of the joints. */
static void arm_damp(struct arm* arm) {
  double torque_nm[ARMLINK_MAX_JOINTS];
  for (int i = 0; i < arm->joints; ++i) torque_nm[i] = -10.0 * arm->dq_rad_per_s[i];
  arm_apply_torque(arm, torque_nm);
}
/* Whether nobody pushes its joints on. */
static int arm_stands_still(const struct arm* arm) {
  for (int i = 0; i < arm->joints; ++i)
    if (arm->dq_rad_per_s[i] > still_rad_per_s || arm->dq_rad_per_s[i] < -still_rad_per_s) return 0;
  return 1;
}
static void arm_brake(struct arm* arm) {
  memset(arm->dq_rad_per_s, 0, sizeof arm->dq_rad_per_s);
  memset(arm->tau_nm, 0, sizeof arm->tau_nm);
}
/* One cycle on the way to a posture, slowly, by its own drives. Returns whether it stands there. */
static int arm_move_to(struct arm* arm, const double* q_rad) {
  const double step_rad = 0.5 * cycle_s;
  int there = 1;
  arm_brake(arm);
  for (int i = 0; i < arm->joints; ++i) {
    const double left_rad = q_rad[i] - arm->q_rad[i];
    const int near_rad = left_rad < step_rad && left_rad > -step_rad;
    arm->q_rad[i] = near_rad ? q_rad[i] : arm->q_rad[i] + (left_rad > 0.0 ? step_rad : -step_rad);
    there = there && near_rad;
  }
  return there;
}
/* What the wrist sensor says; a living one never says the same twice. */
static void arm_wrench(unsigned cycle, double wrench_in_tool[6]) {
  memset(wrench_in_tool, 0, 6 * sizeof wrench_in_tool[0]);
  wrench_in_tool[5] = 1e-6 * (double)(cycle % 7u);
}

/* ---- The protocol: keep this. ------------------------------------------------------------------------------ */

struct link {
  int socket;
  struct sockaddr_in host;
  struct armlink_command last; /* the newest one that was obeyed; its session is 0 where there is none */
  uint32_t ended;              /* the session before: a command of it that comes late opens nothing */
  unsigned cycle, heard_in;    /* cycles since the begin; the one in which the host last commanded */
  unsigned damped_cycles;
  int stopped, braked, stands;
};

/* Whether a host has the arm, so that no other one can. */
static int busy(const struct link* link) {
  return link->last.session != 0 && link->cycle - link->heard_in < ALONE_AFTER_CYCLES;
}

static void say_hello(const struct link* link, const struct arm* arm, const uint8_t* ask, const struct sockaddr_in* asker) {
  struct armlink_hello hello;
  uint8_t out[ARMLINK_HELLO_SIZE];
  memset(&hello, 0, sizeof hello);
  hello.session = (uint32_t)armlink_get(ask + ARMLINK_AT_SESSION, 4);
  hello.sequence = (uint32_t)armlink_get(ask + ARMLINK_AT_SEQUENCE, 4);
  hello.joints = (uint8_t)arm->joints;
  hello.modes = 1 << ARMLINK_IDLE | 1 << ARMLINK_TORQUE | 1 << ARMLINK_READY;
  hello.flags = ARMLINK_HAS_RAIL | ARMLINK_SIMULATED | (busy(link) ? ARMLINK_BUSY : 0);
  hello.cycle_us = CYCLE_US;
  strncpy(hello.name, "pretended arm", sizeof hello.name - 1);
  for (int i = 0; i < arm->joints; ++i) {
    hello.max_torque_nm[i] = max_torque_nm;
    hello.max_speed_rad_per_s[i] = max_speed_rad_per_s;
    hello.min_rad[i] = -max_rad;
    hello.max_rad[i] = max_rad;
  }
  hello.min_rail_m = -2.0;
  hello.max_rail_m = 2.0;
  armlink_write_hello(out, &hello);
  (void)sendto(link->socket, out, sizeof out, 0, (const struct sockaddr*)asker, sizeof *asker);
}

/* A session begins with READY while no other host is there; within it only its own host is heard. */
static void hear(struct link* link, const struct arm* arm, const struct armlink_command* command, const struct sockaddr_in* from) {
  const int opens = !busy(link) && command->session != 0 && command->session != link->last.session &&
                    command->session != link->ended && command->mode == ARMLINK_READY;
  const int own = command->session == link->last.session && from->sin_port == link->host.sin_port &&
                  from->sin_addr.s_addr == link->host.sin_addr.s_addr;
  if ((!opens && !own) || command->joints != arm->joints) return;
  if (own && command->mode == ARMLINK_TORQUE && link->cycle - command->answers > ARMLINK_MAX_AGE) return; /* stale */
  if (own) link->heard_in = link->cycle;
  if (own && (int32_t)(command->sequence - link->last.sequence) <= 0) return; /* overtaken, or sent again */
  if (opens) link->stopped = link->braked = 0, link->host = *from, link->ended = link->last.session;
  if (link->stopped && command->mode != ARMLINK_IDLE) return;
  link->last = *command;
  link->heard_in = link->cycle;
  if (command->mode == ARMLINK_IDLE) link->ended = command->session, link->last.session = 0;
}

static void listen_to_all(struct link* link, const struct arm* arm) {
  uint8_t in[ARMLINK_HELLO_SIZE + 1];
  for (int i = 0; i < 64; ++i) { /* whatever the network does, a cycle ends */
    struct sockaddr_in from;
    socklen_t length = sizeof from;
    struct armlink_command command;
    const int size = (int)recvfrom(link->socket, in, sizeof in, 0, (struct sockaddr*)&from, &length);
    if (size < 0) return;
    const int kind = armlink_kind(in, size);
    if (kind == ARMLINK_ASK) say_hello(link, arm, in, &from);
    if (kind == ARMLINK_COMMAND && armlink_read_command(in, &command)) hear(link, arm, &command, &from);
  }
}

/* One cycle of the arm as its state wants it. */
static void act(struct link* link, struct arm* arm) {
  const unsigned missed = link->cycle - link->heard_in;
  if (!link->stopped && link->last.session != 0 && link->last.mode == ARMLINK_TORQUE && missed >= ARMLINK_MAX_MISSED) {
    link->stopped = 1;
    link->damped_cycles = 0;
    printf("stopped: %u cycles without a command\n", missed);
    fflush(stdout);
  }
  link->stands = 0;
  if (link->stopped) { /* the brakes come last: in the way of a person who comes they are a wall */
    const unsigned damped = ++link->damped_cycles;
    link->braked = link->braked || (damped > MIN_DAMPED_CYCLES && arm_stands_still(arm)) || damped > MAX_DAMPED_CYCLES;
  } else {
    link->braked = link->last.session == 0 || link->last.mode == ARMLINK_IDLE || link->last.brake;
  }
  if (link->braked) {
    arm_brake(arm);
  } else if (link->stopped) {
    arm_damp(arm);
  } else if (link->last.mode == ARMLINK_READY) {
    link->stands = arm_move_to(arm, link->last.values);
  } else {
    arm_apply_torque(arm, link->last.values);
  }
}

static void tell(const struct link* link, const struct arm* arm) {
  struct armlink_state state;
  uint8_t out[ARMLINK_STATE_SIZE];
  if (link->last.session == 0) return;
  memset(&state, 0, sizeof state);
  state.session = link->last.session;
  state.sequence = link->cycle;
  state.answers = link->last.sequence;
  state.mode = link->last.mode;
  state.joints = (uint8_t)arm->joints;
  state.status = (uint16_t)((link->stands ? ARMLINK_STANDS : 0) | (link->stopped ? ARMLINK_STOPPED : 0) |
                            (link->braked ? ARMLINK_BRAKED : 0));
  state.time_s = state.wrench_time_s = cycle_s * link->cycle;
  state.rail_m = link->last.rail_m; /* a pretended base is where it should be */
  memcpy(state.q_rad, arm->q_rad, sizeof state.q_rad);
  memcpy(state.dq_rad_per_s, arm->dq_rad_per_s, sizeof state.dq_rad_per_s);
  memcpy(state.tau_nm, arm->tau_nm, sizeof state.tau_nm);
  arm_wrench(link->cycle, state.wrench_in_tool);
  armlink_write_state(out, &state);
  (void)sendto(link->socket, out, sizeof out, 0, (const struct sockaddr*)&link->host, sizeof link->host);
}

int main(int argc, char** argv) {
  struct link link;
  struct arm arm;
  struct sockaddr_in own;
  memset(&link, 0, sizeof link);
  memset(&arm, 0, sizeof arm);
  memset(&own, 0, sizeof own);
  arm.joints = argc > 2 ? atoi(argv[2]) : 6;
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK); /* armlink knows no passwords: a network of its own, or none */
  own.sin_port = htons((uint16_t)(argc > 1 ? atoi(argv[1]) : 7001));
  link.socket = socket(AF_INET, SOCK_DGRAM, 0);
  if (arm.joints < 1 || arm.joints > ARMLINK_MAX_JOINTS || fcntl(link.socket, F_SETFL, O_NONBLOCK) < 0 ||
      bind(link.socket, (struct sockaddr*)&own, sizeof own) < 0) {
    perror("arm_client PORT [JOINTS]");
    return 1;
  }
  struct timespec next;
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (;; ++link.cycle) {
    tell(&link, &arm);
    next.tv_nsec += 1000L * CYCLE_US;
    if (next.tv_nsec >= 1000000000L) next.tv_nsec -= 1000000000L, ++next.tv_sec;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL) == EINTR) continue;
    listen_to_all(&link, &arm);
    act(&link, &arm);
  }
}
