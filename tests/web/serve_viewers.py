# SPDX-License-Identifier: Apache-2.0
"""Fifty pages that watch one massage at real pace: whether each gets its frames, and what they cost in memory. The
session's own memory grows while it records, and not evenly, so one page alone is measured before the fifty and after
them, each for a third of the time and 30 s at most: the programme takes twelve minutes.
Usage: serve_viewers.py TUINA [SECONDS [tls]]; 20 is the short form, 600 the long one, which takes a quarter of an hour."""
import json, os, sys, tempfile, threading, time
from serve_client import Page, Server
from serve_stop import ORDER, SHORT_SCAN
import serve_tls

VIEWERS, FRAMES_HZ, MAX_GROWTH_MB, MIN_SHARE, MAX_GAP_S, MIN_ALONE_S, MAX_ALONE_S, LONG_S = 50, 20.0, 1.0, 0.5, 3.0, 10.0, 30.0, 600.0
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


def massage(server, page):
    """The arms move."""
    questions = json.loads(server.ask("/api/choices", Cookie=page.cookie)[2])["questions"]
    order = {**ORDER, "programme": "full_back_20min", "answers": {question["key"]: "no" for question in questions}}
    page.outcome("operate")
    expect("start", page.outcome("start", order) == "done")
    expect("review", page.until(lambda: page.state["phase"] in ("review", "ended"), 120))
    page.outcome("hold")
    time.sleep(2.1)
    expect("arm", page.outcome("arm") == "done")
    expect("arms move", page.until(lambda: page.frames > 20, 30))


def growth_mb(server, seconds):
    """Of the server's memory, after what the first seconds took for good."""
    time.sleep(min(10.0, seconds / 2))
    before = resident_mb(server)
    time.sleep(seconds)
    return resident_mb(server) - before


def watched(server, page, viewers, seconds):
    for viewer in viewers:
        viewer.begin()
    began = time.monotonic()
    grown = growth_mb(server, seconds)
    took = time.monotonic() - began
    rates = sorted(viewer.frames / took for viewer in viewers)
    gaps = sorted(max(viewer.gap_s, time.monotonic() - viewer.last_s) for viewer in viewers)
    print(f"{len(viewers)} pages, {took:.0f} s: {rates[0]:.1f} to {rates[-1]:.1f} frames a second each, of {FRAMES_HZ:.0f}; "
          f"longest without a frame {gaps[-1]:.2f} s; memory grew by {grown:.2f} MB", flush=True)
    expect(f"all are there {sum(viewer.open for viewer in viewers)}", all(viewer.open for viewer in viewers))
    expect("the massage goes on", page.state["phase"] == "massage" and not page.state["paused"])
    return grown, rates, gaps


def begun(binary, folder, tls):
    if not tls:
        return Server(binary, folder, *SHORT_SCAN)
    files = serve_tls.Files(folder)
    serve_tls.passwords(binary, files)
    return Server(binary, folder, "--listen", serve_tls.ADDRESS, "--certificate", files.good, "--password-file",
                  files.path("password"), *SHORT_SCAN, tls=serve_tls.client_of(files), at=serve_tls.ADDRESS)


def main(binary, seconds="20", tls=""):
    seconds = float(seconds)
    with tempfile.TemporaryDirectory() as folder:
        server = begun(binary, folder, tls)
        cookie = server.enter()
        page = Viewer(server, cookie)
        massage(server, page)
        alone_s = min(max(MIN_ALONE_S, seconds / 3), MAX_ALONE_S)
        before = watched(server, page, [page], alone_s)[0]
        viewers = [page, *(Viewer(server, cookie) for _ in range(VIEWERS - 1))]
        together, rates, gaps = watched(server, page, viewers, seconds)
        for viewer in viewers[1:]:
            viewer.close()
        after = watched(server, page, [page], alone_s)[0]
        alone = 0.5 * (before + after) * seconds / alone_s
        reached = together - alone < MAX_GROWTH_MB and rates[0] >= MIN_SHARE * rates[-1] > 0 and gaps[-1] < MAX_GAP_S
        verdict = f"not judged by less than {LONG_S:.0f} s" if seconds < LONG_S else "reached" if reached else "NOT reached"
        print(f"{VIEWERS} viewers for {seconds:.0f} s: memory grew by {together - alone:.2f} MB beyond one viewer's (target {MAX_GROWTH_MB:.0f} MB), "
              f"the slowest got {rates[0]:.1f} frames a second, the longest wait was {gaps[-1]:.2f} s: {verdict}; "
              f"load of the machine, {os.cpu_count()} cores: {os.getloadavg()[0]:.1f}")
        expect(f"less than {MAX_GROWTH_MB} MB more: {together - alone:.2f}", together - alone < MAX_GROWTH_MB)
        expect(f"none starves: {rates[0]:.1f} to {rates[-1]:.1f} frames a second", rates[0] >= MIN_SHARE * rates[-1] > 0)
        expect(f"none waits: {gaps[-1]:.2f} s", gaps[-1] < MAX_GAP_S)
        began = time.monotonic()
        expect("STOP", page.outcome("stop") == "done")
        print(f"STOP of the one that is left answered after {1e3 * (time.monotonic() - began):.0f} ms")
        expect("it ends", page.until(lambda: page.state["phase"] == "ended", 120))
        expect("exit", server.end() == 0)
    print("viewers", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
