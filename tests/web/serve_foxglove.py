# SPDX-License-Identifier: Apache-2.0
"""A session watched by Foxglove's own client over both subprotocols: every message is decoded and compared with the
record of the session, and services obey the rules of the page. Exit code 77: node or the client is missing."""
import json, os, shutil, subprocess, sys, tempfile, time
from serve_client import Page, Server, Socket

faults = []
LATCHED = {"/scan", "/acupoints", "/plan", "/robot_description", "/tf_static"}
# Two records of one session show these at other milliseconds where the watching one was left out of some.
SHOWN = {"/tf", "/left/wrench", "/right/wrench", "/tuina/arms", "/tuina/gaps", "/tuina/guard"}
# Nothing was left out; the scan was over.
MAY_LACK = {"/tuina/gaps", "/profile"}


def expect(what, holds):
    if not holds:
        faults.append(what)


os.environ.setdefault("TUINA_READERS", os.path.join(os.path.dirname(os.path.abspath(__file__)), "../whole/readers"))


class Watcher:
    """The client, a process of node."""

    def __init__(self, address, subprotocol):
        self.process = subprocess.Popen(["node", os.path.join(os.path.dirname(__file__), "watch_foxglove.mjs"), address,
                                         subprotocol], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline() or sys.exit("Foxglove's client ended without an answer"))
        if answer.get("missing") and "topics" not in answer:
            print("skipped:", answer["missing"])
            sys.exit(77)
        return answer

    def until(self, holds, seconds=30.0):
        end = time.monotonic() + seconds
        while not holds(answer := self.ask("list")) and time.monotonic() < end:
            time.sleep(0.05)
        return holds(answer)

    def call(self, service):
        return self.ask(f"call /tuina/{service}")["outcome"]

    def end(self):
        self.process.kill()
        self.process.wait()


def review(page, order):
    expect("operate", page.outcome("operate") == "done")
    expect("start", page.outcome("start", order) == "done")
    expect("a plan", page.until(lambda: page.state["phase"] in ("review", "ended"), 180))


def arm(page):
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")


def operated_by_a_program(page, watcher):
    """A program that is in control stays there by the echoes of its connection, and its going pauses the massage."""
    expect("a viewer's pause", watcher.call("pause") == "viewer")
    expect("a second operator", watcher.call("operate") == "taken")
    expect("hand over", page.outcome("hand_over") == "done")
    expect("operate by a program", watcher.call("operate") == "done")
    expect("pause", watcher.call("pause") == "done" and page.until(lambda: page.state["paused"], 5))
    time.sleep(2.3)
    expect("its lease lasts", page.state["operated"] and not page.state["operator"])
    for ask in ("resume", "softer", "firmer"):
        expect(ask, watcher.call(ask) == "done")
    expect("it goes on", page.until(lambda: not page.state["paused"], 5))
    watcher.end()
    expect("paused without operator", page.until(lambda: page.state["paused"], 5))
    expect("operate again", page.outcome("operate") == "done" and page.outcome("resume") == "done")


def judge(said, subprotocol):
    expect(f"{subprotocol}: {said['subprotocol']}", said["subprotocol"] == subprotocol)
    expect(f"{subprotocol}: faults {said['faults']}", not said["faults"])
    expect(f"{subprotocol}: server info", said["info"]["name"] == "tuina" and said["times"] > 0)
    expect(f"{subprotocol}: channels of the record that were not advertised: {said['missing']}", not said["missing"])
    for name, topic in said["topics"].items():
        whole = topic["decoded"] > 0 and topic["different"] == 0 and (topic["elsewhen"] == 0 or name in SHOWN)
        expect(f"{subprotocol}: {name} {topic}", whole or (name in MAY_LACK and not topic["received"]))
    for name in LATCHED | {"/joint_states", "/tools", "/left/pose", "/right/pose"}:
        expect(f"{subprotocol}: {name} as recorded", said["topics"][name]["same"] > 0)


def deaf(server):
    """A client that subscribes to all that is there and reads no more: nobody waits for it."""
    socket = Socket(server.port, server.program_address.partition(str(server.port))[2],
                    **{"Sec-WebSocket-Protocol": "foxglove.sdk.v1"})
    while (message := socket.message())["op"] != "advertise":
        pass
    socket.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": channel["id"], "channelId": channel["id"]}
                                                                 for channel in message["channels"]]}))
    return socket


def laid_out(said):
    """Everything that the shipped layout shows is there."""
    with open(os.path.join(os.path.dirname(__file__), "../../config/foxglove/tuina.json"), encoding="utf-8") as file:
        panels = json.load(file)["configById"]
    shown = {topic for panel in panels.values() for topic in panel.get("topics", {})}
    shown |= {panel["topicPath"] for panel in panels.values() if "topicPath" in panel}
    shown |= {path["value"].partition("{")[0] for panel in panels.values() for path in panel.get("paths", [])}
    expect(f"topics of the layout: {shown - set(said['topics'])}", len(shown) > 5 and shown <= set(said["topics"]))
    asked = {panel["serviceName"] for panel in panels.values() if "serviceName" in panel}
    expect(f"services of the layout: {asked}", asked and asked <= set(said["services"]))


def main(binary):
    if not shutil.which("node"):
        print("skipped: node is not on this machine")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, folder, "--pace", "max")
        address = server.program_address
        page = Page(server, server.enter())
        early = Watcher(address, "foxglove.websocket.v1")
        expect("services", early.until(lambda said: len(said["services"]) == 9))
        questions = json.loads(server.ask("/api/choices", Cookie=page.cookie)[2])["questions"]
        review(page, {"person": "phantom:slim", "position": "sitting", "programme": "relax", "intensity": 2, "seed": 3,
                      "answered_by": "a test", "answers": {question["key"]: "no" for question in questions}})
        operating = Watcher(address, "foxglove.sdk.v1")
        expect("services", operating.until(lambda said: len(said["services"]) == 9))
        arm(page)
        expect("massage", page.until(lambda: page.state["phase"] == "massage", 60))
        page.until(lambda: page.live, 30)
        silent = deaf(server)
        late = Watcher(address, "foxglove.sdk.v1")
        expect("latched", late.until(lambda said: all(said["topics"].get(name) == 1 for name in LATCHED)))
        operated_by_a_program(page, operating)
        expect("a contact ends", late.until(lambda said: said["topics"].get("/tuina/contacts", 0) > 0, 60))
        expect("stop by a program that only watches", late.call("stop") == "done")
        expect("ended", page.until(lambda: page.state["phase"] == "ended", 60) and page.state["outcome"] == "stopped")
        laid_out(late.ask("list"))
        record = f"{folder}/{page.state['session']}/session.mcap"
        first = early.ask(f"compare {record}")
        judge(first, "foxglove.websocket.v1")
        expect(f"lines of the laser as recorded {first['topics'].get('/profile')}", first["topics"]["/profile"]["same"] > 0)
        judge(late.ask(f"compare {record}"), "foxglove.sdk.v1")
        asked = [(line["what"], line["outcome"]) for line in server.audit() if line["who"].startswith("program")]
        for line in (("pause", "refused: viewer"), ("operate", "refused: taken"), ("pause", "done"), ("stop", "done")):
            expect(f"the audit log has {line}", line in asked)
        early.end(), late.end(), silent.link.close()
        expect("exit", server.end() == 0)
    print("a session watched over both subprotocols", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
