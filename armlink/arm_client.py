#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The arm's side of armlink (docs/armlink.md) around a pretended arm: arm_client.py PORT [JOINTS].

To wrap your own arm, replace the methods of Arm; Link keeps the protocol. Python does not keep a millisecond under
load: this is for trying things out and for reading, the one in C for an arm that touches somebody."""
import math, socket, struct, sys, time, zlib

VERSION, MAX_JOINTS, MAX_MISSED, MAX_AGE = 1, 7, 3, 8
ASK, HELLO, COMMAND, STATE = 1, 2, 3, 4
IDLE, TORQUE, ADMITTANCE, READY = 0, 1, 2, 3
STANDS, STOPPED, BRAKED = 1, 2, 4
HAS_RAIL, SIMULATED, WAITS, BUSY, MEASURES_TORQUE = 1, 2, 4, 8, 16
CYCLE_S, ALONE_AFTER_CYCLES = 1e-3, 1000
MIN_DAMPED_CYCLES, MAX_DAMPED_CYCLES, STILL_RAD_PER_S = 300, 2000, 0.05

HEADER = "<4sBBHII"  # TARM, version, kind, size, session, sequence
HELLO_BODY = "<BBHI24s7d7d7d7d2d"
COMMAND_BODY = "<IBBBBd7d"
STATE_BODY = "<IBBH3d7d7d7d6d"


def pack(kind, session, sequence, body=b""):
    size = struct.calcsize(HEADER) + len(body) + 4
    datagram = struct.pack(HEADER, b"TARM", VERSION, kind, size, session, sequence) + body
    return datagram + struct.pack("<I", zlib.crc32(datagram))


def unpack(datagram):
    """(kind, session, sequence, body) of a sound datagram of this version, else None."""
    begin = struct.calcsize(HEADER)
    if len(datagram) < begin + 4 or datagram[:4] != b"TARM" or datagram[4] != VERSION:
        return None
    _, _, kind, size, session, sequence = struct.unpack(HEADER, datagram[:begin])
    if size != len(datagram) or struct.unpack("<I", datagram[-4:])[0] != zlib.crc32(datagram[:-4]):
        return None
    return kind, session, sequence, datagram[begin:-4]


def seven(values):
    return list(values) + [0.0] * (MAX_JOINTS - len(values))


class Arm:
    """A pretended arm without weight: each joint is a rotor with some friction."""
    max_torque_nm, max_speed_rad_per_s, max_rad = 120.0, 10.0, 3.1

    def __init__(self, joints):
        self.q_rad, self.dq_rad_per_s, self.tau_nm = [0.0] * joints, [0.0] * joints, [0.0] * joints

    def apply_torque(self, torque_nm):
        for i, wanted in enumerate(torque_nm):
            self.tau_nm[i] = max(-self.max_torque_nm, min(self.max_torque_nm, wanted))
            self.dq_rad_per_s[i] += CYCLE_S * (self.tau_nm[i] - self.dq_rad_per_s[i]) / 0.2
            self.q_rad[i] += CYCLE_S * self.dq_rad_per_s[i]

    def damp(self):
        self.apply_torque([-10.0 * speed for speed in self.dq_rad_per_s])

    def stands_still(self):
        return all(abs(speed) < STILL_RAD_PER_S for speed in self.dq_rad_per_s)

    def brake(self):
        self.dq_rad_per_s, self.tau_nm = [0.0] * len(self.q_rad), [0.0] * len(self.q_rad)

    def move_to(self, q_rad):
        """One cycle on the way, slowly; whether it stands there."""
        self.brake()
        step = 0.5 * CYCLE_S
        left = [wanted - q for wanted, q in zip(q_rad, self.q_rad)]
        self.q_rad = [q + max(-step, min(step, way)) for q, way in zip(self.q_rad, left)]
        return all(abs(way) < step for way in left)

    def wrench(self, cycle):
        return [0.0] * 5 + [1e-6 * (cycle % 7)]  # a living sensor never says the same twice


class Link:
    def __init__(self, arm, port):
        self.arm, self.cycle, self.heard_in, self.damped_cycles = arm, 0, 0, 0
        self.session, self.host, self.sequence, self.mode = 0, None, 0, IDLE
        self.ended = 0  # the session before: a command of it that comes late opens nothing
        self.values, self.rail_m, self.brake = [], 0.0, False
        self.stopped = self.braked = self.stands = False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))  # armlink knows no passwords: a network of its own, or none
        self.socket.setblocking(False)

    def busy(self):
        return self.session != 0 and self.cycle - self.heard_in < ALONE_AFTER_CYCLES

    def say_hello(self, session, sequence, asker):
        arm, joints = self.arm, len(self.arm.q_rad)
        flags = HAS_RAIL | SIMULATED | (BUSY if self.busy() else 0)
        body = struct.pack(HELLO_BODY, joints, 1 << IDLE | 1 << TORQUE | 1 << READY, flags, round(1e6 * CYCLE_S),
                           b"pretended arm", *seven([arm.max_torque_nm] * joints),
                           *seven([arm.max_speed_rad_per_s] * joints), *seven([-arm.max_rad] * joints),
                           *seven([arm.max_rad] * joints), -2.0, 2.0)
        self.socket.sendto(pack(HELLO, session, sequence, body), asker)

    def hear(self, session, sequence, body, host):
        answers, mode, joints, brake, zero, rail_m, *values = struct.unpack(COMMAND_BODY, body)
        count = len(self.arm.q_rad)
        if mode not in (IDLE, TORQUE, READY) or brake > 1 or zero or joints != count or any(body[16 + 8 * count:]):
            return
        if not all(map(math.isfinite, [rail_m, *values])):
            return
        opens = not self.busy() and session not in (0, self.session, self.ended) and mode == READY
        own = session == self.session and host == self.host
        if not (opens or own):
            return  # a stranger
        if own and mode == TORQUE and self.cycle - answers > MAX_AGE:
            return  # stale
        if own:
            self.heard_in = self.cycle
        if own and 0 < (self.sequence - sequence + 1) % 2**32 < 2**31:
            return  # overtaken, or sent again
        if opens:
            self.stopped = self.braked = False
            self.host, self.ended = host, self.session
        if self.stopped and mode != IDLE:
            return
        if mode == IDLE:
            self.ended = session
        self.session, self.sequence, self.mode = session if mode != IDLE else 0, sequence, mode
        self.values, self.rail_m, self.brake, self.heard_in = values[:count], rail_m, bool(brake), self.cycle

    def listen(self):
        for _ in range(64):  # whatever the network does, a cycle ends
            try:
                datagram, host = self.socket.recvfrom(512)
            except (BlockingIOError, ConnectionError):
                return
            sound = unpack(datagram)
            if sound and sound[0] == ASK and len(sound[3]) == 0:
                self.say_hello(sound[1], sound[2], host)
            if sound and sound[0] == COMMAND and len(sound[3]) == struct.calcsize(COMMAND_BODY):
                self.hear(*sound[1:], host)

    def act(self):
        missed = self.cycle - self.heard_in
        if not self.stopped and self.session and self.mode == TORQUE and missed >= MAX_MISSED:
            self.stopped, self.damped_cycles = True, 0
            print(f"stopped: {missed} cycles without a command", flush=True)
        self.stands = False
        if self.stopped:  # the brakes come last: in the way of a person who comes they are a wall
            self.damped_cycles += 1
            rests = self.damped_cycles > MIN_DAMPED_CYCLES and self.arm.stands_still()
            self.braked = self.braked or rests or self.damped_cycles > MAX_DAMPED_CYCLES
        else:
            self.braked = not self.session or self.brake
        if self.braked:
            self.arm.brake()
        elif self.stopped:
            self.arm.damp()
        elif self.mode == READY:
            self.stands = self.arm.move_to(self.values)
        else:
            self.arm.apply_torque(self.values)

    def tell(self):
        if not self.session:
            return
        status = STANDS * self.stands | STOPPED * self.stopped | BRAKED * self.braked
        time_s = CYCLE_S * self.cycle
        body = struct.pack(STATE_BODY, self.sequence, self.mode, len(self.arm.q_rad), status, time_s, time_s, self.rail_m,
                           *seven(self.arm.q_rad), *seven(self.arm.dq_rad_per_s), *seven(self.arm.tau_nm),
                           *self.arm.wrench(self.cycle))
        self.socket.sendto(pack(STATE, self.session, self.cycle, body), self.host)

    def run(self):
        due_s = time.monotonic()
        while True:
            self.tell()
            due_s += CYCLE_S
            time.sleep(max(0.0, due_s - time.monotonic()))
            self.listen()
            self.act()
            self.cycle += 1


if __name__ == "__main__":
    Link(Arm(int(sys.argv[2]) if len(sys.argv) > 2 else 6), int(sys.argv[1]) if len(sys.argv) > 1 else 7001).run()
