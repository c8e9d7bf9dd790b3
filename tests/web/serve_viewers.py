# SPDX-License-Identifier: Apache-2.0
"""Fifty pages that watch one massage at real pace: whether each gets its frames, and what they cost in memory. The
memory of a session grows while it records, so the same massage runs beside it with one page, and what that one grows by
from its tenth second on is taken off.
Usage: serve_viewers.py TUINA [SECONDS [tls]]; 20 is the short form, 600 the long one."""
import json, os, sys, tempfile, threading, time
from serve_client import Page, Server
from serve_stop import ORDER, SHORT_SCAN
import serve_tls

VIEWERS, FRAMES_HZ, MAX_GROWTH_MB, MIN_SHARE, MAX_GAP_S, SETTLED_S, LONG_S = 50, 20.0, 1.0, 0.5, 3.0, 10.0, 600.0
faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


class Viewer(Page):
    """A page that counts its frames and keeps none."""

    def __init__(self, server, cookie):
        self.frames, self.gap_s, self.last_s = 0, 0.0, None
        super().__init__(server, cookie)

    def take(self, message):
        if message["channel"] != "live":
            return super().take(message)
        now = time.monotonic()
        if self.last_s is not None:
            self.gap_s = max(self.gap_s, now - self.last_s)
        self.last_s, self.frames = now, self.frames + 1
        return None

    def begin(self):
        self.frames, self.gap_s, self.last_s = 0, 0.0, time.monotonic()


def resident_mb(server):
    with open(f"/proc/{server.process.pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmRSS"))


class Watched:
    """A server with a massage that the given number of pages watch; `grown_mb` is known `seconds` after it has settled."""

    def __init__(self, binary, folder, tls, viewers):
        self.server = begun(binary, folder, tls)
        cookie = self.server.enter()
        self.pages = [Viewer(self.server, cookie) for _ in range(viewers)]

    def massage(self, seconds):
        self.start()
        self.measure(seconds)

    def start(self):
        page = self.pages[0]
        questions = json.loads(self.server.ask("/api/choices", Cookie=page.cookie)[2])["questions"]
        order = {**ORDER, "programme": "full_back_20min", "answers": {question["key"]: "no" for question in questions}}
        page.outcome("operate")
        expect("start", page.outcome("start", order) == "done")
        expect("review", page.until(lambda: page.state["phase"] in ("review", "ended"), 120))
        page.outcome("hold")
        time.sleep(2.1)
        expect("arm", page.outcome("arm") == "done")
        expect("arms move", page.until(lambda: page.frames > 20, 30))

    def measure(self, seconds):
        """Of the server's memory, after what the first seconds took for good."""
        time.sleep(SETTLED_S)
        before = resident_mb(self.server)
        for page in self.pages:
            page.begin()
        began = time.monotonic()
        time.sleep(seconds)
        self.grown_mb = resident_mb(self.server) - before
        took = time.monotonic() - began
        self.rates_hz = sorted(page.frames / took for page in self.pages)
        self.gap_s = max(max(page.gap_s, time.monotonic() - page.last_s) for page in self.pages)
        state = self.pages[0].state
        expect("all are there", all(page.open for page in self.pages))
        expect("the massage goes on", state["phase"] == "massage" and not state["paused"])

    def told(self):
        return (f"{len(self.pages)} pages: {self.rates_hz[0]:.1f} to {self.rates_hz[-1]:.1f} frames a second each, of {FRAMES_HZ:.0f}; "
                f"longest without a frame {self.gap_s:.2f} s; memory grew by {self.grown_mb:.2f} MB")

    def stop(self):
        began = time.monotonic()
        expect("STOP", self.pages[0].outcome("stop") == "done")
        print(f"{len(self.pages)} pages: STOP answered after {1e3 * (time.monotonic() - began):.0f} ms")
        expect("it ends", self.pages[0].until(lambda: self.pages[0].state["phase"] == "ended", 120))
        expect("exit", self.server.end() == 0)


def begun(binary, folder, tls):
    if not tls:
        return Server(binary, folder, *SHORT_SCAN)
    os.makedirs(folder)
    files = serve_tls.Files(folder)
    serve_tls.passwords(binary, files)
    return Server(binary, folder, "--listen", serve_tls.ADDRESS, "--certificate", files.good, "--password-file",
                  files.path("password"), *SHORT_SCAN, tls=serve_tls.client_of(files), at=serve_tls.ADDRESS)


def main(binary, seconds="20", tls=""):
    seconds = float(seconds)
    with tempfile.TemporaryDirectory() as folder:
        one, many = (Watched(binary, f"{folder}/{count}", tls, count) for count in (1, VIEWERS))
        both = [threading.Thread(target=watched.massage, args=(seconds,)) for watched in (one, many)]
        for thread in both:
            thread.start()
        for thread in both:
            thread.join()
        more_mb, slowest_hz, best_hz = many.grown_mb - one.grown_mb, many.rates_hz[0], many.rates_hz[-1]
        reached = more_mb < MAX_GROWTH_MB and slowest_hz >= MIN_SHARE * best_hz > 0 and many.gap_s < MAX_GAP_S
        verdict = f"not judged by less than {LONG_S:.0f} s" if seconds < LONG_S else "reached" if reached else "NOT reached"
        print(one.told(), many.told(), sep="\n")
        print(f"{VIEWERS} viewers for {seconds:.0f} s: memory grew by {more_mb:.2f} MB more than with one (target {MAX_GROWTH_MB:.0f} MB), "
              f"the slowest got {slowest_hz:.1f} frames a second, the longest wait was {many.gap_s:.2f} s: {verdict}; "
              f"load of the machine, {os.cpu_count()} cores: {os.getloadavg()[0]:.1f}")
        expect(f"less than {MAX_GROWTH_MB} MB more: {more_mb:.2f}", more_mb < MAX_GROWTH_MB)
        expect(f"none starves: {slowest_hz:.1f} to {best_hz:.1f} frames a second", slowest_hz >= MIN_SHARE * best_hz > 0)
        expect(f"none waits: {many.gap_s:.2f} s", many.gap_s < MAX_GAP_S)
        for watched in (one, many):
            watched.stop()
    print("viewers", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
