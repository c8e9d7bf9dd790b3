# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser: one massage by keyboard alone, one by touch on a phone, in two languages, light and
dark; each view is judged by axe-core. Prints how soon a key reached the loop that moves the arms.
Usage: serve_browser.py TUINA PAGE_FOLDER AXE.js [PICTURES]; exit 77 where there is no browser or no page. With PICTURES
it presses 100 keys and leaves pictures there: of each view, of both arms pressing, and of a whole massage played."""
import json, os, signal, subprocess, sys, tempfile, time
from browser import Tab, chromium
from serve_client import Page, Server

faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


class Visit:
    """A tab that has entered, and where its pictures go."""

    def __init__(self, tab, server, axe, pictures, name, address=None):
        self.tab, self.axe, self.pictures, self.name = tab, axe, pictures, name
        tab.call("Page.setBypassCSP", enabled=True)  # so that axe may look; the page itself runs without
        address, began = address or server.invite(), time.monotonic()
        tab.call("Page.navigate", url=address)
        expect(f"{name}: the page opens", tab.until("!!document.querySelector('#next, #another, #stop')"))
        print(f"{name}: the page is there after {1e3 * (time.monotonic() - began):.0f} ms")

    def judge(self, view):
        """Nothing that axe finds, nothing beyond the screen's side, nothing too small for a finger."""
        tab, where = self.tab, f"{self.name}, {view}"
        if self.pictures:
            tab.picture(f"{self.pictures}/{self.name}-{view}.png")
            if self.name == "desk":
                # As docs/page.md shows it, whose letters stay readable there.
                tab.resize(1024, 768)
                time.sleep(2.0)  # drawn anew
                tab.picture(f"{self.pictures}/page-{view}.png")
                tab.resize(1600, 1000)
        if not tab.see("typeof axe !== 'undefined'"):
            tab.see(f"{self.axe}; true")
        found = tab.see("""axe.run({ iframes: false }).then((all) => all.violations.map((one) =>
            `${one.id} ${one.nodes[0].html.slice(0, 100)}`))""")
        expect(f"{where}: axe {found}", not found)
        expect(f"{where}: wider than the screen", tab.see("document.documentElement.scrollWidth <= innerWidth"))
        small = tab.see("""[...document.querySelectorAll("button, a.button, .pills label, input:not([type=radio])")]
            .filter((one) => one.offsetParent && (one.offsetWidth < 44 || one.offsetHeight < 44)).map((one) => one.outerHTML.slice(0, 80))""")
        expect(f"{where}: too small for a finger {small}", not small)

    def judge_chinese(self, view):
        """No line with three Latin words is to be read, and a page within the page is in Chinese, too. What has a digit or
        a line below in it is a name."""
        left = self.tab.see("""document.body.innerText.split("\\n").filter((line) =>
            (line.match(/(?<!\\w)[A-Za-z]{2,}(?!\\w)/g) ?? []).filter((word) => word !== "mm").length >= 3)""")
        expect(f"{self.name}, {view}: words left in English {left}", not left)
        inside = self.tab.see("""Promise.all([...document.querySelectorAll("iframe")].map(async (one) =>
            (await (await fetch(one.src)).text()).includes('<html lang="zh-Hant">')))""")
        expect(f"{self.name}, {view}: a page within the page is in Chinese {inside}", len(inside) == (view == "report") and all(inside))
        self.judge(view)

    def ended(self):
        expect(f"{self.name}: scripts complain {self.tab.errors}", not self.tab.errors)
        self.tab.close()


def events(server, watcher):
    return json.loads(server.ask("/api/events", Cookie=watcher.cookie)[2])


def plan(server, watcher):
    return json.loads(server.ask("/api/plan", Cookie=watcher.cookie)[2])


def ruled_out_by_keys(server, watcher, tab):
    """The place around an acupoint is ruled out, and the plan presses there no more."""
    before, asked_at = watcher.state["reviews"], None
    expect("ruling out is reached", tab.tab_to("[aria-label='Rule out BL50_L']"))
    asked_at = time.monotonic()
    tab.key("Enter")
    expect("another plan", watcher.until(lambda: watcher.state["reviews"] == before + 1, 20))
    print(f"another plan after {1e3 * (time.monotonic() - asked_at):.0f} ms, of which 200 are the page's hearing")
    expect("it is no refusal", not watcher.state["words"])
    names = [path["name"] for path in plan(server, watcher)["paths"]]
    expect(f"nothing at a place that is ruled out {names}", "press BL50_R" in names and not {"press BL50_L", "rub BL50_L"} & set(names))
    expect("it may be armed again", tab.until("!document.querySelector('#arm').disabled"))


def opened_anew(watcher, tab):
    """What was ruled out is there when the page is opened anew, by somebody who is not in control any more."""
    tab.call("Page.reload")
    expect("a page that is opened anew knows what was ruled out", tab.until("document.querySelector('#undo')?.disabled === false"))
    expect("nobody is in control", watcher.until(lambda: not watcher.state["operated"]))
    expect("it may be armed", tab.until("!document.querySelector('#arm').disabled"))
    time.sleep(1.0)  # the back is drawn, and buttons with it
    expect("arm is reached anew", tab.tab_to("#arm"))


def acupoint(server, watcher, name):
    points = json.loads(server.ask("/api/map", Cookie=watcher.cookie)[2])["acupoints"]
    return next(point["at"] for point in points if point["name"] == name)


def moved_by_keys(server, watcher, tab):
    """An acupoint is moved by three steps of 2 mm with the arrows, the plan follows, and it is taken back."""
    before, at = watcher.state["reviews"], acupoint(server, watcher, "BL50_L")
    expect("moving is reached", tab.tab_to("#move_BL50_L"))
    tab.key("Enter")
    told = "document.querySelector('#refusal').textContent.includes('Arrow keys')"
    expect("the keys are told", tab.until(told, 3))
    for _ in range(2):
        tab.see("document.querySelector('.tooled button').click()")  # zones: the view is drawn anew
        expect("they stay told when the view is drawn anew", tab.see(told))
    for _ in range(3):
        tab.key("ArrowUp")
    expect("nothing is asked before Enter", watcher.state["reviews"] == before)
    tab.key("Enter")
    expect("another plan for the moved point", watcher.until(lambda: watcher.state["reviews"] == before + 1, 20))
    expect("it is no refusal", not watcher.state["words"])
    way = [1e3 * (now - was) for now, was in zip(acupoint(server, watcher, "BL50_L"), at)]
    # A palpated point ends between the finger and the scan.
    expect(f"upwards, by 6 mm at most {way}", 1.5 < way[2] < 6.5 and abs(way[0]) < 2.0)
    expect("undoing is reached", tab.until("!document.querySelector('#undo').disabled") and tab.tab_to("#undo"))
    tab.key("Enter")
    expect("another plan without it", watcher.until(lambda: watcher.state["reviews"] == before + 2, 20))
    expect("it may be armed again", tab.until("!document.querySelector('#arm').disabled"))
    time.sleep(1.0)  # the new back and plan are drawn, and buttons with them


def let_go_while_moving(server, watcher, tab):
    """Who begins while an acupoint is on its way changes the plan by it, and arms nothing once the press is let go."""
    before = watcher.state["reviews"]
    expect("moving is reached again", tab.tab_to("#move_BL50_L"))
    for _ in range(3):
        tab.key("ArrowUp")
    tab.press("#arm", hold_s=0.9)
    expect("another plan for the point on its way", watcher.until(lambda: watcher.state["reviews"] == before + 1, 20))
    time.sleep(2.0)
    expect("a press that was let go arms nothing",
           watcher.state["phase"] == "review" and not any(line["what"] == "arm" for line in server.audit()))
    expect("it can be undone", tab.until("document.querySelector('#undo')?.disabled === false"))
    expect("undoing is reached again", tab.tab_to("#undo"))
    tab.key("Enter")
    expect("the plan before", watcher.until(lambda: watcher.state["reviews"] == before + 2, 20))
    expect("it may be armed once more", tab.until("document.querySelector('#arm')?.disabled === false"))


def stopped_while_lost(watcher, tab):
    """A stop without a connection is not said to be asked for; the next connection begins with it."""
    told = tab.see("""(() => { socket.close(); document.querySelector("#stop").click();
        return [document.querySelector("#lost").textContent, document.querySelector("#spoken").textContent]; })()""")
    expect(f"the hand stop is named {told}", "停止鈕" in told[0] and "已要求停止" not in told[1])
    expect("it arrives", watcher.until(lambda: watcher.state["phase"] in ("report", "ended"), 20))


def drawn_by_finger(watcher, tab):
    """An area is drawn around on the back, and taken back."""
    for ask in ("#rule_out", "#undo"):
        before = watcher.state["reviews"]
        tab.touch(ask)
        if ask == "#rule_out":
            tab.draw(".view canvas", [(0.5 + 0.12 * x, 0.5 + 0.06 * y) for x, y in
                                      ((-1, -1), (-0.3, -1), (0.3, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0))])
        expect(f"another plan by {ask}", watcher.until(lambda: watcher.state["reviews"] == before + 1, 20))
        expect(f"{ask}: {watcher.state['words']}", not watcher.state["words"])
        tab.until("!document.querySelector('#arm').disabled")
        time.sleep(1.0)  # the new back and plan are drawn, and buttons with them
    tab.touch("#rule_out")


def coloured(server, watcher, tab):
    """The techniques of the plan stand below the back, each with the colour that reports give it, too."""
    said = {one["name"]: one["colour"] for one in json.loads(server.ask("/api/choices", Cookie=watcher.cookie)[2])["techniques"]}
    planned = {path["technique"] for path in plan(server, watcher)["paths"]}
    shown = tab.see("""[...document.querySelectorAll('.legend span')].map((one) => {
        const [red, green, blue] = getComputedStyle(one.querySelector("i")).backgroundColor.match(/\\d+/g).map(Number);
        return [one.textContent, "#" + ((red << 16) + (green << 8) + blue).toString(16).padStart(6, "0")]; })""")
    expect(f"techniques and their colours {shown}", sorted(shown) == sorted([name, said[name]] for name in planned))


def answers_by_keys(tab):
    """Health questions: `no` to each, a name, and on; by keys alone."""
    questions = tab.see("[...document.querySelectorAll('.ask input[value=no]')].map((one) => one.id)")
    for question in questions:
        # Of a group without an answer the tabulator reaches the first, `no`.
        expect(f"{question} is reached", tab.tab_to(f"[id='{question}']"))
        tab.key(" ")
    expect("name is reached", tab.tab_to("#answered_by"))
    for letter in "Lin":
        tab.key(letter)
    expect("scan is reached", tab.tab_to("#scan"))
    tab.key("Enter")


def delays_ms(tab, watcher, server, presses):
    """From a key to the millisecond of control that followed it, both read off this machine's steady clock."""
    def followed():
        return [one["clock_s"] for one in events(server, watcher) if one["what"] == "command"]

    delays = []
    for press in range(presses):
        known, before = len(followed()), time.monotonic()
        tab.key(" ")
        expect(f"key {press} was followed", watcher.until(lambda: len(followed()) == known + 1, 5))
        delays.append(1e3 * (followed()[-1] - before))
        watcher.until(lambda: watcher.state["paused"] == (press % 2 == 0), 3)
        tab.until(f"!!document.querySelector('#{'resume' if press % 2 == 0 else 'pause'}')", 3)
    return sorted(delays)


def lost_and_back(server, tab):
    """A server that is silent is told within a second, and told no more when it speaks again."""
    expect("nothing is lost", tab.see("document.querySelector('#lost').hidden"))
    os.kill(server.process.pid, signal.SIGSTOP)
    began = time.monotonic()
    try:
        shown = tab.until("!document.querySelector('#lost').hidden && document.querySelector('#lost').textContent !== ''", 10)
        print(f"a lost connection is shown after {1e3 * (time.monotonic() - began):.0f} ms")
    finally:
        os.kill(server.process.pid, signal.SIGCONT)
    expect("a lost connection is shown", shown)
    expect("and comes back", tab.until("document.querySelector('#lost').hidden", 10))


def invited_by_keys(visit):
    """Somebody is invited to watch: they see STOP and the plan, and nothing with which they could steer."""
    tab = visit.tab
    for button in ("#open_invitation", "#invite"):
        expect(f"{button} is reached", tab.tab_to(button))
        tab.key("Enter")
    expect("an address", tab.until("!!document.querySelector('#invited_address')"))
    visit.judge("invitation")
    address = tab.see("document.querySelector('#invited_address').value")
    expect("closing is reached", tab.tab_to("#close_invitation"))
    tab.key("Enter")
    return address


def watched(address, axe, pictures):
    """Who was invited to watch, while a plan waits."""
    tab = Tab(1024, 768)
    guest = Visit(tab, None, axe, pictures, "guest", address)
    expect("a viewer sees the plan", tab.until("!!document.querySelector('#arm')", 20))
    guest.judge("review")
    expect("and may do nothing with it", tab.see("document.querySelector('#arm').disabled && document.querySelector('#move').disabled"))
    expect("nor take control", not tab.see("document.querySelector('#open_invitation')"))
    expect("but STOP", tab.see("!document.querySelector('#stop').disabled"))
    guest.ended()


def frames_hz(tab, seconds=4.0):
    """Pictures of the back and both arms in a second, without a graphics card."""
    def drawn():
        return tab.see("[performance.now(), Number(document.querySelector('.view canvas')?.dataset.drawn ?? 0)]")

    (began_ms, before), _ = drawn(), time.sleep(seconds)
    ended_ms, after = drawn()
    return 1e3 * (after - before) / (ended_ms - began_ms)


def by_keyboard(server, watcher, axe, pictures, presses):
    tab = Tab(1600, 1000)
    visit = Visit(tab, server, axe, pictures, "desk")
    visit.judge("choose")
    lost_and_back(server, tab)
    invitation = invited_by_keys(visit)
    expect("next is reached", tab.tab_to("#next"))
    tab.key("Enter")
    tab.until("!!document.querySelector('#answered_by')")
    visit.judge("health")
    answers_by_keys(tab)
    expect("scan begins", watcher.until(lambda: watcher.state["phase"] == "scan", 20))
    expect("the cloud grows", watcher.until(lambda: watcher.state["cloud_points"] > 2000, 30))
    expect("the scan is seen", tab.until("/^[1-9]/.test(document.querySelector('.over-view .note')?.textContent ?? '')", 5))
    visit.judge("scan")
    expect("review", tab.until("!!document.querySelector('#arm:enabled')", 120))
    visit.judge("review")
    coloured(server, watcher, tab)
    watched(invitation, axe, pictures)
    moved_by_keys(server, watcher, tab)
    let_go_while_moving(server, watcher, tab)
    ruled_out_by_keys(server, watcher, tab)
    expect("arm is reached", tab.tab_to("#arm"))
    tab.key("Enter", hold_s=1.0)
    time.sleep(1.5)
    expect("a short hold arms nothing", watcher.state["phase"] == "review")
    opened_anew(watcher, tab)
    tab.key("Enter", hold_s=3.5)
    expect("massage", tab.until("!!document.querySelector('#softer')"))
    for key, ask in (("-", "softer"), ("+", "firmer")):
        tab.key(key)
        expect(ask, watcher.until(lambda: any(line["what"] == ask for line in server.audit())))
    expect("the loop followed", watcher.until(lambda: len(events(server, watcher)) >= 2, 5))
    visit.judge("massage")
    hz = frames_hz(tab)
    print(f"both arms are drawn {hz:.1f} times a second, in software, at 1600 x 1000")
    expect("they are drawn", hz > 0.5)
    delays = delays_ms(tab, watcher, server, presses)
    expect("nobody is paused", not watcher.state["paused"])
    expect("a place was felt", watcher.until(
        lambda: any("stiffness_n_per_mm" in one for one in events(server, watcher)), 60))
    visit.judge("felt")
    if pictures:
        watcher.until(lambda: all(arm["felt_n"] > 8.0 for arm in watcher.live[-1]["arms"]), 40)
        tab.picture(f"{pictures}/pressing.png")
    expect("control was never lost", not any("no operator" in line["outcome"] for line in server.audit()))
    before = time.monotonic()
    tab.key("Escape")
    expect("stopped", watcher.until(lambda: watcher.state["phase"] in ("report", "ended"), 20))
    print(f"Esc to the end of the massage as a page hears it: {1e3 * (time.monotonic() - before):.0f} ms")
    expect("report", tab.until("!!document.querySelector('#another')", 60))
    visit.judge("report")
    looked_back_by_keys(visit)
    visit.ended()
    return delays


def at_s(tab):
    """The moment at which the slider of a finished session stands."""
    return tab.see("Number(document.querySelector('#when').value)")


def looked_back_by_keys(visit):
    tab = visit.tab
    expect("looking back is reached", tab.tab_to("#look_back"))
    tab.key("Enter")
    expect("it plays", tab.until("!!document.querySelector('#when')", 60))
    tab.key(" ")
    expect("it runs", tab.until("Number(document.querySelector('#when').value) > 0.5"))
    tab.key(" ")
    before = at_s(tab)
    tab.key("ArrowRight")
    expect(f"an arrow goes by 5 s: {before} {at_s(tab)}", abs(at_s(tab) - before - 5.0) < 0.2)
    for _ in range(5):
        tab.key("ArrowRight")  # to where the arms press
    visit.judge("play")
    tab.key("End")
    happened = tab.see("document.querySelectorAll('.log tr').length")
    expect(f"all that happened at the end {happened}", happened > 2)
    tab.key("Home")
    expect("nothing has happened at the beginning", at_s(tab) == 0 and tab.see("document.querySelectorAll('.log tr').length") == 0)
    expect("the list is reached", tab.tab_to("#leave"))
    tab.key("Enter")
    expect("the list", tab.until("!!document.querySelector('#next')"))


def by_touch(server, watcher, axe, pictures):
    tab = Tab(390, 844, touch=True, dark=True)
    tab.call("Page.addScriptToEvaluateOnNewDocument", source="""window.WebSocket = class extends WebSocket {
        constructor(address) { super(address); window.socket = this; } };""")
    visit = Visit(tab, server, axe, pictures, "phone")
    if tab.see("!!document.querySelector('#another')"):
        tab.touch("#another")
    tab.touch("#language")
    expect("Chinese", tab.until("document.documentElement.lang === 'zh-Hant'"))
    visit.judge_chinese("choose")
    english = tab.see("""[...document.querySelectorAll("button, h1, legend, .pills label")].map((one) => one.textContent)
        .filter((words) => /[a-z]{4}/.test(words) && words !== "English")""")
    expect(f"words left in English {english}", not english)
    tab.touch("label:has(#intensity_5)")  # more than zones bear, so that notes say what was lowered
    tab.touch("#next")
    for question in tab.see("[...document.querySelectorAll('.ask input[value=no]')].map((one) => one.id)"):
        tab.touch(f"label:has([id='{question}'])")
    tab.touch("#answered_by")
    tab.call("Input.insertText", text="林")
    visit.judge_chinese("health")
    tab.touch("#scan")
    expect("review", tab.until("!!document.querySelector('#arm:enabled')", 120))
    notes = tab.see("""[...document.querySelectorAll(".card:last-child .note")].map((one) => one.textContent)""")
    expect(f"what was changed is said {notes}", any("降為" in note for note in notes))
    visit.judge_chinese("review")
    drawn_by_finger(watcher, tab)
    tab.touch("#arm", hold_s=2.6)
    expect("massage", tab.until("!!document.querySelector('#softer')"))
    visit.judge_chinese("massage")
    stopped_while_lost(watcher, tab)
    expect("report", tab.until("!!document.querySelector('#another')", 60))
    visit.judge_chinese("report")
    said = tab.see("document.querySelector('#said').textContent")
    expect(f"what happened is said {said}", "有人要求停止" in said)
    tab.touch("#look_back")
    expect("it plays", tab.until("!!document.querySelector('#when')", 60))
    tab.touch("#when")
    expect(f"a finger in the middle of the slider: {at_s(tab)}", at_s(tab) > 0.0)
    visit.judge_chinese("play")
    visit.ended()


def whole_played(server, pictures):
    """A picture of the player, a third into a whole massage that lies in the server's folder as 0900."""
    tab = Tab(1600, 1000)
    tab.call("Page.navigate", url=server.invite())
    tab.until("!!document.querySelector('#another, #next')")
    if tab.see("!!document.querySelector('#another')"):
        tab.see("document.querySelector('#another').click()")
    expect("the whole massage is listed", tab.until("!!document.querySelector('#play_0900')"))
    tab.see("document.querySelector('#play_0900').click()")
    expect("it plays", tab.until("!!document.querySelector('#when')", 60))
    tab.see("""(() => { const when = document.querySelector('#when'); when.value = String(Number(when.max) / 3);
        when.dispatchEvent(new Event("input", { bubbles: true })); })()""")
    time.sleep(3.0)  # drawn, and once more with all pixels
    tab.picture(f"{pictures}/play.png")
    tab.close()


def main(binary, page_folder, axe_file, pictures=None):
    for what, there in (("Chromium", chromium()), ("the built page", os.path.exists(f"{page_folder}/page.js")),
                        ("axe-core", os.path.exists(axe_file))):
        if not there:
            print(f"skipped: {what} is not on this machine")
            return 77
    if pictures:
        os.makedirs(pictures, exist_ok=True)
    with open(axe_file, encoding="utf-8") as file:
        axe = file.read()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, folder, "--page", page_folder)
        watcher = Page(server, server.enter())
        server.invite = lambda: watcher.invitation()
        delays = by_keyboard(server, watcher, axe, pictures, presses=100 if pictures else 20)
        by_touch(server, watcher, axe, pictures)
        if pictures:
            subprocess.run([binary, "massage", "--out", f"{folder}/0900", "--quiet"], check=True, capture_output=True)
            whole_played(server, pictures)
        expect("exit", server.end() == 0)
    print(f"key to the loop that moves the arms, {len(delays)} keys: median {delays[len(delays) // 2]:.0f} ms, "
          f"90 of 100 {delays[int(0.9 * len(delays)) - 1]:.0f} ms, largest {delays[-1]:.0f} ms")
    expect(f"half of the keys within 100 ms {delays}", delays[len(delays) // 2] < 100.0)
    print("the page in a browser", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
