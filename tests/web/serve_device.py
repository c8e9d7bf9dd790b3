# SPDX-License-Identifier: Apache-2.0
"""Sessions of `tuina serve --device`, whose arms are another program over UDP (`tuina robot armlink`): arms that are missing,
arms before somebody else, a massage to its end, one that a viewer stops, arms that are killed while they press. After each
the server goes on. With a page and Chromium the same is read on the page.
Usage: serve_device.py TUINA [PAGE_FOLDER]"""
import json, os, subprocess, sys, tempfile, time
from browser import Tab, chromium
from serve_client import Page, Server

faults = []
SEED, PERSON = "7", ("--person", "phantom:slim", "--position", "prone")


def expect(what, holds):
    if not holds:
        faults.append(what)
    return holds


class Arms:
    """Both arms of a simulated robot before its person, which wait for each command; they live for one session."""

    def __init__(self, binary, device, port, seed=SEED):
        self.process = subprocess.Popen([binary, "robot", "armlink", "--pace", "max", "--quiet", "--listen", f"127.0.0.1:{port}",
                                         "--seed", seed, *PERSON], stdout=subprocess.DEVNULL)
        end = time.monotonic() + 120
        while subprocess.run([binary, "doctor", "--device", device, "--quiet"], capture_output=True).returncode != 0:
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError("the arms do not come")

    def end(self):
        try:
            return self.process.wait(120)
        except subprocess.TimeoutExpired:
            return None

    def kill(self):
        self.process.kill()
        self.process.wait()


def device_file(folder, port):
    path = f"{folder}/device.toml"
    with open(path, "w", encoding="utf-8") as file:
        for name, at in (("left", port), ("right", port + 1)):
            file.write(f'[arm.{name}]\nkind = "armlink"\naddress = "127.0.0.1:{at}"\n')
    return path


def reaches(page, *phases):
    return page.until(lambda: page.state["phase"] in phases, 240)


def begin(page, order):
    before = page.state["session"]
    expect("start", page.outcome("start", order) == "done")
    expect("a new number", page.until(lambda: page.state["session"] != before))


def comes_to_nothing(server, page, order, why):
    """It ends before anything moves; the page hears why, and no folder is left."""
    page.live.clear()
    begin(page, order)
    expect(f"{why}: it ends", reaches(page, "ended"))
    expect(f"{why}: {page.state['outcome']}, {page.state['words']!r}", page.state["outcome"] == "failed" and why in page.state["words"])
    expect(f"{why}: by a sentence of devices", page.state["said"][0][0]["key"] == "fault_device")
    expect(f"{why}: nothing is left", not page.state["recorded"] and not os.path.exists(f"{server.folder}/{page.state['session']}"))
    expect(f"{why}: nothing has moved", not page.live)


def armed(page, order):
    page.live.clear()
    begin(page, order)
    if not expect(f"a plan: {page.state['words']!r}", reaches(page, "review", "ended") and page.state["phase"] == "review"):
        return False
    expect("no arm moves before it is armed", not page.live)
    expect("nobody arms without holding", page.outcome("arm") != "done")
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    return expect("massage", reaches(page, "massage"))


def presses(page):
    return page.until(lambda: any(max(row[2], row[4]) > 3.0 for live in page.live for row in live["forces"]), 180)


def session(server, page):
    with open(f"{server.folder}/{page.state['session']}/session.json", encoding="utf-8") as file:
        return json.load(file)


def to_its_end(server, page, order, arms, port):
    if not armed(page, order):
        return
    expect("it presses", presses(page))
    expect("softer", page.outcome("softer") == "done")
    while page.state["phase"] == "massage" and page.outcome("skip") == "done":  # what is left, but its travels
        time.sleep(0.2)
    if not expect(f"done: {page.state['words']!r}", reaches(page, "ended") and page.state["outcome"] == "done"):
        return
    told = session(server, page)
    expect(f"its arms are those of the file {told['devices']}", told["devices"]["arms"] == f"armlink 127.0.0.1:{port}, 127.0.0.1:{port + 1}")
    expect("states came", told["devices"]["left"]["cycles"] > 1000 and told["devices"]["right"]["cycles"] > 1000)
    expect("the session is that of the server's person", told["seed"] == int(SEED) and told["position"] == "prone")
    expect("softer was heard", told["commands"][0]["command"] == "softer")
    expect("the report", server.ask(f"/sessions/{page.state['session']}/report.html", Cookie=page.cookie)[0] == 200)
    expect("the arms have ended with the session", arms.end() == 0)


def stopped_by_a_viewer(server, page, viewer, order, arms):
    if not armed(page, order):
        return
    expect("it presses before it is stopped", presses(page))
    expect("a viewer may stop", viewer.outcome("stop") == "done")
    expect("stopped", reaches(page, "ended") and page.state["outcome"] == "stopped")
    expect("the session heard it", [given["command"] for given in session(server, page)["commands"]] == ["stop"])
    expect("the arms have ended", arms.end() == 0)


def killed(server, page, order, arms):
    """Arms that fall silent under the hand: said, not taken for a session that has not begun, and its record is kept."""
    if not armed(page, order):
        return
    expect("it presses before the arms die", presses(page))
    arms.kill()
    expect("the session ends by itself", reaches(page, "ended"))
    expect(f"the page hears of it: {page.state}", page.state["outcome"] == "stopped" and "robot" in page.state["words"]
           and page.state["said"][0][0]["key"] == "fault_device")
    kept = f"{page.state['session']}/session.mcap"
    expect(f"and of the record: {page.state['words']!r}", kept in page.state["words"] and os.path.getsize(f"{server.folder}/{kept}") > 100_000)


def refused_at_the_start(binary, folder, device):
    bare = f"{folder}/bare.toml"
    with open(bare, "w", encoding="utf-8") as file:
        file.write('[camera]\nkind = "v4l2"\naddress = "/dev/video0"\n')
    whole = f"{folder}/whole.toml"
    with open(whole, "w", encoding="utf-8") as file, open(device, encoding="utf-8") as arms:
        file.write('[camera]\nkind = "v4l2"\naddress = "/dev/video0"\n[turntable]\nkind = "board"\naddress = "/dev/none"\n' + arms.read())
    for words, code, said in ((("--device", f"{folder}/none.toml"), 2, "none.toml"), (("--device", bare), 2, "names no arms"),
                              (("--device", whole), 1, "needs --calibration"), (("--device", whole, "--calibration", device), 1, "needs --robot-pose"),
                              (("--device", device, "--pace", "5"), 1, "--pace"), (("--person", "phantom:slim"), 1, "--device"),
                              (("--device", device, "--robot", "none"), 1, "none")):
        done = subprocess.run([binary, "serve", "--port", "0", "--out", f"{folder}/not", *words], capture_output=True, text=True, timeout=60)
        expect(f"{words}: {done.returncode} {done.stderr!r}", done.returncode == code and said in done.stderr and not done.stdout
               and done.stderr.count("\n") <= 2)


def read_on_the_page(server, page_folder, order):
    """Which arms are driven, no choice of a person, and why a session has not begun."""
    if not chromium() or not page_folder or not os.path.exists(f"{page_folder}/page.js"):
        return print("the page itself was not looked at: Chromium or the built page is not on this machine")
    tab = Tab(1024, 768)
    tab.call("Page.navigate", url=server.invite())
    expect("the page opens", tab.until("!!document.querySelector('#another, #next')"))
    tab.see("document.querySelector('#another')?.click(); true")
    expect("the page names the arms", tab.until("document.querySelector('#devices')?.textContent.includes('device.toml: armlink 127.0.0.1:')"))
    expect("and below", tab.see("document.querySelector('#foot').textContent.includes('device.toml: armlink')"))
    expect("no person is chosen", not tab.see("!!document.querySelector('[name=person], [name=position], #seed')"))
    expect("a programme is", tab.see("!!document.querySelector('[name=programme]')"))
    tab.see("document.querySelector('#next').click(); true")
    expect("questions", tab.until("!!document.querySelector('#scan')"))
    tab.see("""document.querySelectorAll("[id$='_no']").forEach((one) => one.click()); const name = document.querySelector('#answered_by');
        name.value = 'a test'; name.dispatchEvent(new Event('input')); document.querySelector('#scan').click(); true""")
    expect("the page says what is missing", tab.until("document.querySelector('#said')?.textContent.includes('nobody answers')", 120))
    expect("and that nothing has begun", tab.see("document.querySelector('h1').textContent") == "Not begun")
    expect(f"scripts complain {tab.errors}", not tab.errors)
    tab.close()


def main(binary, page_folder=None):
    with tempfile.TemporaryDirectory() as folder:
        port = 15_000 + 4 * (os.getpid() % 1_000)
        device = device_file(folder, port)
        refused_at_the_start(binary, folder, device)
        words = ["--page", page_folder] if page_folder and os.path.exists(f"{page_folder}/page.js") else []
        server = Server(binary, f"{folder}/sessions", "--device", device, "--seed", SEED, *PERSON, *words)
        cookie = server.enter()
        page, viewer = Page(server, cookie), Page(server, cookie)
        choices = json.loads(server.ask("/api/choices", Cookie=cookie)[2])
        expect(f"what is driven {choices['devices']}", choices["devices"] == {
            "named": f"device.toml: armlink 127.0.0.1:{port}, 127.0.0.1:{port + 1}", "person": "phantom:slim", "position": "prone", "seed": int(SEED)})
        order = {"programme": "relax", "intensity": 2, "answered_by": "a test", "answers": {question["key"]: "no" for question in choices["questions"]}}
        expect("operate", page.outcome("operate") == "done")
        expect("time runs as the arms have it", page.state["pace"] == 1)
        for key, value in (("person", "phantom:slim"), ("position", "prone"), ("seed", 7)):
            expect(f"{key} is not chosen", page.outcome("start", {**order, key: value}).startswith("order: has a key that is none of"))
        comes_to_nothing(server, page, order, "nobody answers")
        stranger = Arms(binary, device, port, "8")
        comes_to_nothing(server, page, order, "the arms are before phantom_slim_prone_8, seed 8")
        stranger.kill()
        to_its_end(server, page, order, arms := Arms(binary, device, port), port)
        arms.kill()
        stopped_by_a_viewer(server, page, viewer, order, arms := Arms(binary, device, port))
        arms.kill()
        killed(server, page, order, Arms(binary, device, port))
        comes_to_nothing(server, page, order, "nobody answers")
        expect("hand over", page.outcome("hand_over") == "done")
        server.invite = page.invitation
        read_on_the_page(server, page_folder, order)
        expect("exit", server.end() == 0)
    print("sessions on devices", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
