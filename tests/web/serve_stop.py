# SPDX-License-Identifier: Apache-2.0
"""How soon STOP, pressed by a mouse in Chromium, changes a torque at real pace. Each press ends a short session. The
torques are those of its record, held against the same session stopped later: the first millisecond in which one
differs. Its time on this machine's steady clock is that of the loop's hearing, as an observer behind the relay has it,
and of the milliseconds from there. All of it counts: browser, server, loop. With a flood, tests/web/flood.cpp (built as
tests/flood beside TUINA) asks at the same port meanwhile: KINDS are some of `requests,slow,message`.
Usage: serve_stop.py TUINA PAGE_FOLDER [PRESSES [KINDS]]; exit 77 where there is no browser or no page. 5 presses are the
short form, 100 the long one."""
import atexit, csv, json, os, random, statistics, subprocess, sys, tempfile, time
from browser import Tab, chromium
from serve_client import Page, Server

ORDER = {"person": "phantom:slim", "position": "sitting", "programme": "relax", "intensity": 3, "seed": 3, "answered_by": "a test"}
SHORT_SCAN = ("--set", "scan.sweep_s=3")
MAX_LATER_S, LEFT_ALONE_S, MAX_CHANGE_MS = 1.0, 8.0, 5
TARGET_MS, TARGET_IN_FLOOD_MS = 50.0, 100.0
faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def torques(binary, record, folder, until_s):
    """Rows of torques by their millisecond, from the record's beginning."""
    os.makedirs(folder)
    subprocess.run([binary, "export", "csv", record, "--out", folder, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    with open(f"{folder}/joint_states.csv", encoding="utf-8") as file:
        rows = csv.reader(file)
        efforts = [i for i, name in enumerate(next(rows)) if name.endswith(("_n", "_nm"))]
        found = {}
        for row in rows:
            if float(row[0]) > until_s:
                break
            found[round(1e3 * float(row[0]))] = [row[i] for i in efforts]
    return found


class Stops:
    def __init__(self, binary, page_folder, folder, flood=""):
        self.binary, self.folder, self.later_ms, self.flood, self.floods = binary, folder, [], flood, []
        self.server = Server(binary, folder, "--page", page_folder, *SHORT_SCAN)
        self.page = Page(self.server, self.server.enter())
        self.page.outcome("operate")
        questions = json.loads(self.server.ask("/api/choices", Cookie=self.page.cookie)[2])["questions"]
        self.order = {**ORDER, "answers": {question["key"]: "no" for question in questions}}
        self.tab = Tab(1000, 800)
        self.tab.call("Page.navigate", url=self.page.invitation())
        self.tab.until("!!document.querySelector('#next')")
        self.reference = self.left_alone()

    def left_alone(self):
        """Torques of the session that all others are, stopped when all others have been."""
        self.moving()
        expect("it goes on", self.page.until(lambda: self.page.live[-1]["time_s"] > LEFT_ALONE_S, 120))
        self.page.ask("stop")
        expect("it ends", self.page.until(lambda: self.page.state["phase"] == "ended", 180))
        return torques(self.binary, f"{self.folder}/{self.page.state['session']}/session.mcap", f"{self.folder}/csv", LEFT_ALONE_S)

    def moving(self):
        """A new session, until its arms have moved a little."""
        page, before = self.page, self.page.state["session"]
        page.live.clear()
        outcome = page.outcome("start", self.order)
        expect(f"start {outcome}", outcome == "done")
        page.until(lambda: page.state["session"] != before)
        expect("review", page.until(lambda: page.state["phase"] in ("review", "ended"), 120))
        answer = page.arm()
        expect(f"arm: {answer}", answer == "done")
        expect("arms move", page.until(lambda: page.live and page.live[-1]["time_s"] > 0.5, 20))
        expect("STOP is there", self.tab.until("!!document.querySelector('#stop') && !!document.querySelector('#softer')"))

    def flooded(self):
        """The flood, once it has come."""
        flood = subprocess.Popen([os.path.join(os.path.dirname(self.binary), "tests", "flood"), str(self.server.port), self.page.cookie, self.flood],
                                 stdout=subprocess.PIPE)
        atexit.register(flood.kill)
        time.sleep(1.5)
        return flood

    def press_ms(self):
        self.moving()
        x, y = self.tab.see("(() => { const box = document.querySelector('#stop').getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; })()")
        flood = self.flooded() if self.flood else None
        time.sleep(random.uniform(0.5, 1.5))  # presses fall anywhere between two frames
        began = time.monotonic()
        self.tab.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", clickCount=1)
        expect("it ends", self.page.until(lambda: self.page.state["phase"] in ("report", "ended"), 180))
        self.tab.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left", clickCount=1)
        if flood:
            flood.terminate()
            self.floods.append(json.loads(flood.communicate(timeout=60)[0]))
        expect("ended", self.page.until(lambda: self.page.state["phase"] == "ended", 180))
        events = json.loads(self.server.ask("/api/events", Cookie=self.page.cookie)[2])
        heard = [one["clock_s"] for one in events if one["what"] == "command" and one["name"] == "stop"]
        number = self.page.state["session"]
        with open(f"{self.folder}/{number}/session.json", encoding="utf-8") as file:
            stops_s = [one["time_s"] for one in json.load(file)["commands"] if one["command"] == "stop"]
        if len(heard) != 1 or len(stops_s) != 1:
            expect(f"one STOP: {heard} {stops_s} {self.page.state}", False)
            return None
        later_ms = self.first_change_ms(number, stops_s[0])
        self.later_ms.append(later_ms)
        return None if later_ms is None else 1e3 * (heard[0] - began) + later_ms

    def first_change_ms(self, number, stop_s):
        """From the millisecond that took STOP to the first in which a torque is another than without it."""
        stop_ms = round(1e3 * stop_s)
        own = torques(self.binary, f"{self.folder}/{number}/session.mcap", f"{self.folder}/csv{number}", stop_s + MAX_LATER_S)
        changed = [ms for ms, row in own.items() if ms in self.reference and row != self.reference[ms]]
        expect(f"session {number}: a torque differs before STOP, at {changed[:1]} of {stop_ms}", not changed or changed[0] >= stop_ms)
        expect(f"session {number}: a torque differs after STOP at {stop_ms}", bool(changed))
        return changed[0] - stop_ms if changed else None


def told(presses_ms, kinds, floods):
    found = sorted(one for one in presses_ms if one is not None)
    if not found:
        return expect("no press was measured", False)
    def share(part):
        return found[min(len(found) - 1, int(part * len(found)))]
    target_ms = TARGET_IN_FLOOD_MS if floods else TARGET_MS
    verdict = "not judged by so few" if len(found) < 100 else "reached" if share(0.99) <= target_ms else "NOT reached"
    print(f"STOP to the first changed torque, {len(found)} presses: median {share(0.5):.1f} ms, 95 of 100 {share(0.95):.1f} ms, "
          f"99 of 100 {share(0.99):.1f} ms, largest {found[-1]:.1f} ms; target {target_ms:.0f} ms in 99 of 100: {verdict}")
    if floods:
        weak = [kind for kind, strong in told_of(floods).items() if kind in kinds and not strong]
        print(f"the flood was weaker than it should be: {', '.join(weak)}" if weak else "the flood was as strong as it should be")


def told_of(floods):
    whole = {key: sum(one[key] for one in floods) for key in floods[0]}
    def rate(what):
        return whole[what] / whole["seconds"]
    slow = min(one["slow_most"] for one in floods)
    print(f"the flood: {rate('requests_sent'):.0f} requests a second came, {rate('requests_answered'):.0f} of them answered; "
          f"{slow} slow connections at once; {whole['messages']} messages of 1 GB begun, {whole['messages_cut']} cut off "
          f"after {whole['message_bytes'] / max(1, whole['messages']) / 1e6:.2f} MB each")
    return {"requests": rate("requests_sent") >= 10000, "slow": slow >= 1000, "message": whole["messages_cut"] > 0}


def main(binary, page_folder, presses="5", flood=""):
    for what, there in (("Chromium", chromium()), ("the built page", os.path.exists(f"{page_folder}/page.js"))):
        if not there:
            print(f"skipped: {what} is not on this machine")
            return 77
    with tempfile.TemporaryDirectory() as folder:
        stops = Stops(binary, page_folder, folder, flood)
        found = []
        for _ in range(int(presses)):
            found.append(stops.press_ms())
            print(f"STOP to the first changed torque: {found[-1]}", file=sys.stderr, flush=True)
        told(found, flood.split(","), stops.floods)
        # A busy machine is late by itself: of a short run no more is held than that most are within a second.
        expect(f"all measured, most within a second {found}", None not in found and statistics.median(found) < 1000.0)
        # Of the session's own time, which is late on no machine.
        later_ms = [one for one in stops.later_ms if one is not None]
        expect(f"a torque changes within {MAX_CHANGE_MS} ms of the loop's hearing {later_ms}", max(later_ms, default=0) <= MAX_CHANGE_MS)
        print(f"from the millisecond that hears STOP to the first changed torque: at most {max(later_ms, default=0)} ms of the session")
        print(f"load of the machine, {os.cpu_count()} cores: {os.getloadavg()[1]:.1f} in the mean of five minutes")
        stops.tab.close()
        expect("exit", stops.server.end() == 0)
    print("STOP", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
