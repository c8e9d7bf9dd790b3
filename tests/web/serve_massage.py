# SPDX-License-Identifier: Apache-2.0
"""Massages driven through the WebSocket of `tuina serve`: one to its end, one stopped by a viewer, one left alone."""
import datetime, json, os, struct, subprocess, sys, tempfile, time
from serve_client import Page, Server

faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def reaches(page, *phases):
    return page.until(lambda: page.state["phase"] in phases, 180)


def begin(page, order):
    """A new session, until the page has heard of it."""
    before = page.state["session"]
    expect("start", page.outcome("start", order) == "done")
    expect("a new number", page.until(lambda: page.state["session"] != before))


def armed(server, page, order):
    """From the order to moving arms."""
    begin(page, order)
    expect("a second start is refused", page.outcome("start", order) == "a session is running")
    expect("arm before there is a plan", page.outcome("arm") != "done")
    if not reaches(page, "review", "ended") or page.state["phase"] == "ended":
        return expect(f"a plan: {page.state['words']}", False)
    for name, least in (("cloud", 50000), ("back", 50000), ("map", 1000), ("plan", 5000)):
        expect(f"{name} is shown", len(server.ask(f"/api/{name}", Cookie=page.cookie)[2]) > least)
    changed_by_hand(server, page)
    expect("no arm moves before it is armed", not page.live)
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    expect("massage", reaches(page, "massage"))


def changed_by_hand(server, page):
    """A point is put 6 mm nearer to the head, then far off the back: the plan follows the first and stays for the second."""
    where = {point["name"]: point["at"] for point in json.loads(server.ask("/api/map", Cookie=page.cookie)[2])["acupoints"]}
    x, y, z = where["GV4"]
    for at, refused in (([x, y, z + 0.006], False), ([x, y + 1.0, z], True)):
        before = page.state["reviews"]
        expect("change", page.outcome("change", {"no_go": [], "fixed": [{"name": "GV4", "at": at}]}) == "done")
        expect("another review", page.until(lambda: page.state["reviews"] == before + 1, 20))
        expect(f"refused {page.state['words']!r}", bool(page.state["words"]) == refused)
    noted = json.loads(server.ask("/api/plan", Cookie=page.cookie)[2])["notes"]
    expect(f"the plan says so {noted}", any(note["words"].startswith("GV4 was put by hand 6 mm") for note in noted))


def session(folder, number):
    with open(f"{folder}/{number}/session.json", encoding="utf-8") as file:
        return json.load(file)


def to_its_end(server, page, order):
    armed(server, page, order)
    page.until(lambda: page.live and page.live[-1]["performed"] > 0, 60)
    for ask in ("pause", "resume", "softer", "firmer", "repeat"):
        expect(ask, page.outcome(ask) == "done")
        time.sleep(0.1)
    while page.state["phase"] == "massage" and page.outcome("skip") == "done":  # what is left, but its travels
        time.sleep(0.2)
    expect("ended", reaches(page, "ended"))
    if page.state["outcome"] != "done":
        return expect(f"done: {page.state} {server.audit()[-12:]}", False)
    commands = [given["command"] for given in session(server.folder, page.state["session"])["commands"]]
    expect(f"the session heard {commands}", commands[:5] == ["pause", "resume", "softer", "firmer", "repeat"]
           and "skip" in commands)
    expect("forces were shown", max(row[1] for live in page.live for row in live["forces"]) > 5.0)
    listed = json.loads(server.ask("/api/sessions", Cookie=page.cookie)[2])
    expect("it is listed", [one["session"] for one in listed["sessions"]] == [page.state["session"]] and listed["count"] == 1)
    ended = datetime.datetime.fromisoformat(listed["sessions"][0]["ended"].replace("Z", "+00:00"))
    expect(f"with its time {ended}", abs(datetime.datetime.now(datetime.timezone.utc) - ended) < datetime.timedelta(minutes=5))
    status, headers, report = server.ask(f"/sessions/{page.state['session']}/report.html", Cookie=page.cookie)
    expect("its report", status == 200 and b"</html>" in report.lower() and b"sandbox" not in report[:100])
    status, headers_too, other = server.ask(f"/sessions/{page.state['session']}/report.html?language=zh-Hant", Cookie=page.cookie)
    expect("its report in Chinese", status == 200 and b'<html lang="zh-Hant">' in other and "力量".encode() in other
           and headers_too["Content-Security-Policy"] == headers["Content-Security-Policy"])
    expect("a report runs no script", "script-src" not in headers["Content-Security-Policy"]
           and "default-src 'none'" in headers["Content-Security-Policy"])
    looked_back(server, page, page.state["session"])


def looked_back(server, page, number):
    """A finished session as the page plays it, held against what the session has left; then damaged records of it."""
    path, record = f"/sessions/{number}/play", f"{server.folder}/{number}/session.mcap"
    expect("nobody looks back without a cookie", server.ask(path)[0] == 401)
    began = time.monotonic()
    status, _, content = server.ask(path, Cookie=page.cookie)
    took_s = time.monotonic() - began
    if status != 200:
        return expect(f"it plays: {content!r}", False)
    size, = struct.unpack("<I", content[:4])
    vertices, triangles = struct.unpack("<II", content[4:12])
    expect("the back is whole", size == 8 + 25 * vertices + 12 * triangles and vertices > 1000)
    told, left = json.loads(content[4 + size:]), session(server.folder, number)
    print(f"a session of {told['duration_s']:.0f} s, {os.path.getsize(record) / 1e6:.1f} MB of record, is {len(content) / 1e6:.1f} MB to play, "
          f"after {took_s:.1f} s")
    times = [frame["time_s"] for frame in told["frames"]]
    expect("time goes on", times == sorted(set(times)) and abs(times[-1] - left["massage"]["duration_s"]) < 0.1)
    expect("both arms are drawn", all(len(arm["links"]) > 4 for frame in told["frames"] for arm in frame["arms"]))
    # At the end it may stand where it began.
    expect("an arm moves", len({str(frame["arms"][0]["links"][-1]) for frame in told["frames"]}) > 100)
    peaks = [max(row[i] for row in told["forces"]) for i in (2, 4)]
    expect(f"forces were felt {peaks}", max(peaks) > 5.0)
    # Of what slides the page has the mean, so it need not say that the largest force is another.
    reasons = [one["why"] or "" for one in left["massage"]["performed"]]
    expect("what was performed", [(one["path"], one["why"]["words"]) for one in told["performed"]]
           == [(one["path"], "" if why.startswith("it slides") else why)
               for one, why in zip(left["massage"]["performed"], reasons)])
    expect("what was commanded", [one["name"] for one in told["events"] if one["what"] == "command"]
           == [one["command"] for one in left["commands"]])
    expect("nothing is lost", told["lost"] == [])
    with open(record, "rb") as file:
        whole = bytearray(file.read())
    spoilt = whole[:]
    spoilt[len(whole) // 4] ^= 255
    for what, now, status in (("damaged", spoilt, 200), ("cut", whole[:len(whole) // 2], 404),
                              ("foreign", b"%PDF-1.7\n", 404), ("empty", b"", 404), ("gone", None, 404), ("whole", whole, 200)):
        os.remove(record) if now is None else open(record, "wb").write(now)
        found, _, said = server.ask(path, Cookie=page.cookie)
        expect(f"a record that is {what}: {found} {said[:300]!r}", found == status)
        if found == 404:
            expect(f"one line about a record that is {what}: {said!r}", said.count(b"\n") == 1 and b"session.mcap" in said)
        elif found == 200:
            size, = struct.unpack("<I", said[:4])
            expect(f"what is lost of a record that is {what}", bool(json.loads(said[4 + size:])["lost"]) == (what == "damaged"))


def stopped_by_a_viewer(server, page, viewer, order):
    armed(server, page, order)
    page.until(lambda: any(arm["phase"] == "contact" for arm in page.live[-1]["arms"]) if page.live else False, 60)
    began = time.monotonic()
    expect("a viewer may stop", viewer.outcome("stop") == "done")
    print(f"stop was answered after {1e3 * (time.monotonic() - began):.0f} ms")
    expect("ended", reaches(page, "ended") and page.state["outcome"] == "stopped")
    heard = session(server.folder, page.state["session"])["commands"]
    expect(f"the session heard {heard}", [given["command"] for given in heard] == ["stop"])


def left_alone(server, page, viewer, order):
    """Whoever steers has gone: the massage waits, with a light touch, until somebody steers again."""
    armed(server, page, order)
    page.close()
    expect("paused without operator", viewer.until(lambda: viewer.state["paused"], 5))
    expect("the log says why", any("no operator" in line["outcome"] for line in server.audit()))
    expect("a viewer takes over", viewer.outcome("operate") == "done" and viewer.outcome("resume") == "done")
    expect("it goes on", viewer.until(lambda: not viewer.state["paused"], 5))
    viewer.ask("stop")
    expect("ended", reaches(viewer, "ended"))


def refused_by_health(server, page, order):
    answers = {**order["answers"], "pacemaker": "yes"}
    begin(page, {**order, "answers": answers})
    expect("refused", reaches(page, "ended") and page.state["outcome"] == "failed"
           and "pacemaker" in page.state["words"])


def stopped_in_scan(server, page, order):
    begin(page, order)
    page.until(lambda: page.state["cloud_points"] > 0, 60)
    page.ask("stop")
    expect("the scan ends", reaches(page, "ended") and page.state["outcome"] == "stopped" and not page.state["recorded"])


def from_the_terminal(binary, folder, order):
    """`massage --live`: one session, armed and stopped in the page; the program ends when the page has gone."""
    server = Server(binary, f"{folder}/live", "--live", "--pace", "20", "--person", "phantom:slim", "--position", "sitting",
                    "--seed", "3", "--quiet", verb="massage")
    page = Page(server, server.enter())
    expect("control", page.outcome("operate") == "done")
    expect("it is the one session", "the one session" in page.outcome("start", order) and page.state["ordered"])
    expect("the pace is said", page.state["pace"] == 20)
    expect("a review", reaches(page, "review"))
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    expect("it moves", page.until(lambda: page.live and page.live[-1]["time_s"] > 2.0, 60))
    page.ask("stop")
    expect("it is stopped", reaches(page, "ended") and page.state["outcome"] == "stopped" and page.state["recorded"])
    expect("its report", server.ask("/sessions/0001/report.html", Cookie=page.cookie)[0] == 200)
    expect("it plays", server.ask("/sessions/0001/play", Cookie=page.cookie)[0] == 200)
    expect("it waits for its page", server.process.poll() is None)
    page.close()
    try:
        print(f"massage --live ended with {server.process.wait(60)}")
    except subprocess.TimeoutExpired:
        expect("it ends with its page", False)


def main(binary):
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, folder, "--pace", "max")
        cookie = server.enter()
        page, viewer = Page(server, cookie), Page(server, cookie)
        questions = json.loads(server.ask("/api/choices", Cookie=cookie)[2])["questions"]
        order = {"person": "phantom:slim", "position": "sitting", "programme": "relax", "intensity": 2, "seed": 3,
                 "answered_by": " a test \"of\" \\ " + 24 * "推", "answers": {question["key"]: "no" for question in questions}}
        expect("operate", page.outcome("operate") == "done")
        refused_by_health(server, page, order)
        stopped_in_scan(server, page, order)
        to_its_end(server, page, order)
        page.live.clear()
        stopped_by_a_viewer(server, page, viewer, order)
        page.live.clear()
        left_alone(server, page, viewer, order)
        from_the_terminal(binary, folder, order)
        expect("exit", server.end() == 0)
        expect("audit check", subprocess.run([binary, "audit", "check", f"{folder}/audit.log"],
                                             capture_output=True).returncode == 0)
    print("massages through the page", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
