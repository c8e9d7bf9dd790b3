# SPDX-License-Identifier: Apache-2.0
"""The live page before a server that says what the test wants: a massage between contacts, a lost connection, a server
that began anew, numbers that nobody meant. Usage: page_alone.py TUINA PAGE_FOLDER; exit 77 where there is no browser or no page."""
import functools, http.server, json, os, signal, sys, tempfile, threading, time
from browser import Tab, chromium
from serve_client import Server

faults = []

CHOICES = {"people": ["phantom:slim", "phantom:medium"], "positions": ["sitting", "prone"],
           "programmes": [{"name": "relax", "description": ""}], "techniques": [{"name": "press", "colour": "#b3261e"}],
           "questions": [{"key": "minor"}, {"key": "bleeding"}], "zones": [{"name": "muscle", "cap_n": 30}],
           "max_seed": 1000000, "max_name_letters": 40, "keeps_people": False, "devices": None}
PLAN = {"duration_s": 60.7, "notes": [], "paths": [
    {"name": f"press BL{47 + step}_L", "technique": "press", "arm": "left" if step % 2 == 0 else "right", "step": step, "start_s": 10.0 * step,
     "duration_s": 9.0, "zone": "muscle", "ordered_n": 12.0, "cap_n": 13.0, "places": [[0, 0, 0]]} for step in range(6)]}
SESSIONS = {"count": 59, "sessions": [{"session": f"{59 - i:04}", "ended": "2026-11-28T09:05:00Z", "who": "anna" if i == 1 else None, "person": "phantom:medium",
                                       "programme": "relax", "duration_s": 158.7, "performed": 13, "paths": 13, "stops": 0} for i in range(50)]}
STATE = {"channel": "state", "you": 1, "viewer": False, "operator": True, "operated": True, "pages": 1, "phase": "massage",
         "progress": 0.5, "paused": False, "session": "0001", "outcome": "", "said": [], "recorded": False, "reviews": 0,
         "cloud_points": 0, "backs": 0, "plans": 1, "events": 0, "pace": 1, "ordered": False, "audit_fails": False, "password": False}
# The connection of the page, of which this test is the other end.
SOCKET = """window.state = null; window.there = true; window.sockets = []; window.asked = [];
window.WebSocket = class {
    static OPEN = 1; readyState = 0;
    constructor() {
        sockets.push(this);
        setTimeout(() => {
            this.readyState = there ? 1 : 3;
            if (there) this.onopen?.(); else this.onclose?.();
        }, 20);
    }
    send(text) { asked.push(JSON.parse(text).ask); }
    close() { this.readyState = 3; }
};
window.hear = (message) => { const one = sockets.at(-1); if (one?.readyState === 1) one.onmessage?.({ data: JSON.stringify(message) }); };
setInterval(() => { if (state) hear({ ...state, clock_s: performance.now() / 1000 }); }, 100);"""


def expect(what, holds):
    if not holds:
        faults.append(what)


class Files(http.server.SimpleHTTPRequestHandler):
    """The built page, and what it asks for; `server.status` other than 200 is the answer to everything but these files."""

    def do_GET(self):
        if not self.path.startswith("/api/"):
            return super().do_GET()
        self.server.counted += 1
        told = {"/api/choices": CHOICES, "/api/plan": PLAN, "/api/events": self.server.events,
                "/api/sessions": SESSIONS, "/api/by_hand": {"no_go": [], "fixed": []}}.get(self.path)
        body = json.dumps(told).encode()
        self.send_response(self.server.status if told is not None else 404)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


class Alone:
    """A tab with the page, and both ends of its connection."""

    def __init__(self, page_folder, **state):
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=page_folder))
        self.server.status, self.server.events, self.server.counted = 200, [], 0
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.tab = Tab(1280, 900)
        self.tab.call("Page.addScriptToEvaluateOnNewDocument", source=SOCKET)
        self.tab.call("Page.navigate", url=f"http://127.0.0.1:{self.server.server_port}/")
        self.tab.until("!!window.sockets?.length")
        self.say(**state)
        expect("the page opens", self.tab.until("!!document.querySelector('#next, #pause, #resume, #another')"))

    def say(self, **state):
        self.tab.see(f"state = {json.dumps({**STATE, **state})}; true")

    def arms(self, *arms, performed=0, intensity=1.0):
        """What both arms do: phase and path of each."""
        now = [{"phase": phase, "path": path, "probing": False, "target_n": 0, "felt_n": 2.9, "links": []} for phase, path in arms]
        self.tab.see(f"""hear({json.dumps({"channel": "live", "time_s": 20.0, "performed": performed, "intensity": intensity,
                                           "arms": now, "forces": []})})""")

    def next_steps(self):
        return self.tab.see("""[...document.querySelectorAll('h2')].find((one) => one.textContent === 'Next').nextSibling
            .innerText.split('\\n').filter(Boolean).map((one) => one.replaceAll('\\t', ' '))""")

    def text(self, selector):
        return self.tab.see(f"document.querySelector({json.dumps(selector)})?.innerText ?? ''")

    def end(self):
        expect(f"scripts complain {self.tab.errors}", not self.tab.errors)
        self.tab.close()
        self.server.shutdown()


def what_comes_next(page_folder):
    """The steps ahead are told while both arms are between contacts, too, and with the force that is wished for now."""
    page = Alone(page_folder)
    page.tab.until("document.body.innerText.includes('Next')")
    page.arms(("contact", 2), ("contact", 3))
    time.sleep(0.3)
    page.arms(("contact", 2), ("contact", 3))
    ahead = page.next_steps()
    expect(f"what is ahead {ahead}", [one.split()[1] for one in ahead] == ["BL51_L", "BL52_L"])
    expect(f"its force {ahead}", all(one.endswith("12 N") for one in ahead))
    page.arms(("travel", -1), ("travel", -1), intensity=1 / 1.15)
    ahead = page.next_steps()
    expect(f"what is ahead between contacts {ahead}", [one.split()[1] for one in ahead] == ["BL51_L", "BL52_L"])
    expect(f"its force after `softer` {ahead}", all(one.endswith("10 N") for one in ahead))
    page.arms(("travel", -1), ("travel", -1), intensity=1.3)
    expect(f"its force at the cap {page.next_steps()}", all(one.endswith("13 N") for one in page.next_steps()))
    # A page that is opened now knows of it by what has ended.
    page.server.events = [{"what": "ended", "time_s": 30.0, "path": 3, "whole": True, "name": "press BL50_L"}]
    page.tab.call("Page.reload")
    page.tab.until("!!window.sockets?.length")
    page.say(events=1)
    page.tab.until("document.querySelector('.log')?.innerText.includes('30 s')")
    page.arms(("travel", -1), ("travel", -1))
    ahead = page.next_steps()
    expect(f"what is ahead for who has come late {ahead}", [one.split()[1] for one in ahead] == ["BL51_L", "BL52_L"])
    expect("seconds are rounded, as in reports", "1:01 left" in page.text(".over-view .note"))
    page.end()


def paused(page_folder):
    """A light touch is told where an arm touches."""
    page = Alone(page_folder, paused=True)
    page.tab.until("!!document.querySelector('#resume')")
    for phase, wanted in (("contact", "Paused, with a light touch"), ("travel", "Paused")):
        page.arms((phase, 0 if phase == "contact" else -1), ("travel", -1))
        for place in ("h1", "#stop-bar span"):
            expect(f"{place} in {phase}: {page.text(place)}", page.text(place) == wanted)
    page.end()


def refused(page_folder):
    """A heartbeat that came late is nobody's ask; of what was asked, the refusal stands until the next ask is done."""
    page = Alone(page_folder)
    page.tab.until("!!document.querySelector('#refusal')")
    answer = {"channel": "reply", "sequence": 1, "outcome": "stale", "said": {"words": "stale", "key": "refusal_stale", "values": []}}
    for ask, wanted in (("beat", ""), ("softer", "Not done: stale"), ("firmer", "")):
        page.tab.see(f"hear({json.dumps({**answer, 'ask': ask, 'outcome': 'done' if ask == 'firmer' else 'stale'})})")
        expect(f"told of {ask}: {page.text('#refusal')}", page.text("#refusal") == wanted)
    page.tab.see(f"hear({json.dumps({**answer, 'ask': 'stop', 'outcome': 'done'})})")
    expect("spoken", page.tab.see("document.querySelector('#spoken').textContent") == "Stop was asked.")
    page.tab.see("document.querySelector('#language').click()")
    expect("spoken in Chinese", page.tab.see("document.querySelector('#spoken').textContent") == "已要求停止。")
    expect("the button keeps the focus", page.tab.see("document.querySelector('#language').focus(), document.querySelector('#language').click(), document.activeElement.id") == "language")
    page.end()


def lost(page_folder, pictures):
    """While nothing is heard nothing but STOP can be pressed, and what was heard last is not shown as what is."""
    page = Alone(page_folder)
    tab = page.tab
    tab.until("!!document.querySelector('#pause:enabled')")
    tab.see("document.querySelector('#softer').focus()")
    tab.see("there = false; sockets.at(-1).readyState = 3; sockets.at(-1).onclose(); true")
    expect("it is told", tab.until("!document.querySelector('#lost').hidden", 5))
    expect("nothing can be pressed", tab.see("document.querySelector('main').inert"))
    expect("nobody is in control", tab.see("document.querySelector('.tools').innerText").startswith("Not connected"))
    covered = tab.see("document.querySelector('#lost').getBoundingClientRect().bottom - document.querySelector('#top').getBoundingClientRect().top")
    expect(f"the banner covers {covered} px of the top", covered <= 0)
    tab.see("asked.length = 0; true")
    tab.key(" ")
    expect("no key does", "pause" not in tab.see("asked"))
    if pictures:
        time.sleep(1.5)  # drawn
        tab.picture(f"{pictures}/lost.png")
    tab.see("there = true")
    expect("it comes back", tab.until("document.querySelector('#lost').hidden && !document.querySelector('main').inert", 5))
    expect("and the focus with it", tab.see("document.activeElement.id") == "softer")
    # The same, at a server that does not know this page any more.
    page.server.status, page.server.counted = 401, 0
    tab.see("there = false; sockets.at(-1).readyState = 3; sockets.at(-1).onclose(); true")
    expect("a new server is told", tab.until("document.querySelector('#lost').innerText.includes('began anew')", 5))
    tried = tab.see("sockets.length")
    time.sleep(3.0)
    expect(f"nothing is tried again: {tab.see('sockets.length') - tried}", tab.see("sockets.length") == tried and page.server.counted <= 2)
    expect("STOP may be pressed", tab.see("!document.querySelector('#stop').disabled && !document.querySelector('#stop').closest('[inert]')"))
    tab.see("document.querySelector('#stop').click()")
    expect(f"the hand stop is named {page.text('#lost')}", tab.until("document.querySelector('#lost').innerText.includes('hand stop')", 2))
    tab.see("document.querySelector('#language').click()")
    expect(f"in Chinese {page.text('#lost')}", "停止鈕" in page.text("#lost") and "重新啟動" in page.text("#lost"))
    if pictures:
        tab.picture(f"{pictures}/anew.png")
    page.end()


def chosen(page_folder, pictures):
    """A seed that is none, a name of blanks and a reason against it are told before anything is asked for."""
    page = Alone(page_folder, phase="idle", session="", plans=0)
    tab = page.tab
    expect("how many are shown", tab.until("!!document.querySelector('#shown_of')") and "50 of 59" in page.text("#shown_of"))
    rows = tab.see("[...document.querySelectorAll('.sessions tr')].slice(0, 2).map((one) => one.innerText.replaceAll(/\\s+/g, ' '))")
    expect(f"day and pseudonym {rows}", all("2026" in row and "Relax" in row for row in rows) and "anna" in rows[1] and "anna" not in rows[0])
    write = """((id, words) => { const one = document.getElementById(id); one.value = words; one.dispatchEvent(new Event('input', { bubbles: true })); })"""
    for seed, goes in (("-7", False), ("1.5", False), ("", False), ("1000001", False), ("12", True)):
        tab.see(f"{write}('seed', '{seed}')")
        expect(f"seed {seed}", tab.see("!document.querySelector('#next').disabled") == goes)
        expect(f"seed {seed} is told", tab.see("document.querySelector('#seed').getAttribute('aria-invalid') === 'true'") != goes)
        if pictures and seed == "-7":
            time.sleep(1.5)
            tab.picture(f"{pictures}/seed.png")
    tab.see("document.querySelector('#next').click()")
    goes = "!document.querySelector('#scan').disabled"
    for question in ("minor", "bleeding"):
        tab.see(f"document.querySelector('#a_{question}_no').click()")
    for name, may in (("   ", False), ("林" * 40, True), ("𠀀" * 41, False), (" Anna ", True)):
        tab.see(f"{write}('answered_by', '{name}')")
        expect(f"answered by {name!r}", tab.see(goes) == may)
    tab.see("document.querySelector('#a_minor_yes').click()")
    expect("with a yes", not tab.see(goes))
    expect("it is told why", "no massage" in page.text("#why_no_scan"))
    if pictures:
        tab.picture(f"{pictures}/yes.png")
    tab.see("document.querySelector('#a_minor_no').click()")
    tab.see("document.querySelector('#scan').click()")
    expect("it is asked for", tab.until("asked.includes('start')", 2))
    page.end()


def not_begun(page_folder):
    """Of answers that speak against a massage people read a sentence, and not where their server keeps its files."""
    said = [[{"words": "/srv/0001/consent.toml:13: minor = \"yes\"", "key": "not_begun", "values": []}]]
    page = Alone(page_folder, phase="ended", outcome="failed", plans=0, said=said)
    page.tab.until("!!document.querySelector('#said')")
    expect(f"what is said {page.text('#said')}", "physician" in page.text("#said") and "/" not in page.text("#said"))
    page.end()


def begun_anew(binary, page_folder):
    """A server is killed and begins again at its port: the page that stands there says so and leaves it alone."""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, folder, "--page", page_folder)
        tab = Tab(1280, 900)
        tab.call("Page.navigate", url=server.address)
        expect("the page opens", tab.until("!!document.querySelector('#next')"))
        os.kill(server.process.pid, signal.SIGKILL)
        server.process.wait(20)
        expect("it is lost", tab.until("!document.querySelector('#lost').hidden", 10))
        again = Server(binary, f"{folder}/again", "--page", page_folder, port=server.port)
        expect("it is told", tab.until("document.querySelector('#lost').innerText.includes('began anew')", 20))
        refused = sum(line["outcome"] == "refused: 401" for line in again.audit())
        time.sleep(3.0)
        after = sum(line["outcome"] == "refused: 401" for line in again.audit())
        expect(f"nothing is asked for again: {refused}, then {after}", after == refused and after <= 8)  # what was under way is refused; two more a second were, for ever
        expect("exit", again.end() == 0)
        tab.close()


def main(binary, page_folder, pictures=None):
    for what, there in (("Chromium", chromium()), ("the built page", os.path.exists(f"{page_folder}/page.js"))):
        if not there:
            print(f"skipped: {what} is not on this machine")
            return 77
    what_comes_next(page_folder)
    paused(page_folder)
    refused(page_folder)
    lost(page_folder, pictures)
    chosen(page_folder, pictures)
    not_begun(page_folder)
    begun_anew(binary, page_folder)
    print("the page before a server that says what is wanted", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
