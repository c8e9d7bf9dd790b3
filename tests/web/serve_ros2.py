# SPDX-License-Identifier: Apache-2.0
"""`tuina serve --ros2`: a program that knows Cyclone DDS only hears the sessions that a page begins, and steers them at
the same desk as the page: one is in control at a time, whoever asks may stop."""
import json, os, random, subprocess, sys, tempfile
from serve_client import Page, Server
from serve_foxglove import arm, expect, faults

SILENT_S = 2.0  # whoever says nothing for so long is not in control any more


class Program:
    """Another process for each list of names: services that it calls, or `hear:` and a latched topic."""

    def __init__(self, client, domain):
        self.client, self.domain = client, domain

    def ask(self, *names):
        called = subprocess.run([self.client, self.domain, *names], stdout=subprocess.PIPE, text=True, timeout=60)
        return [line.split(" ", 1)[1] for line in called.stdout.splitlines()]


def order(page, server, person):
    questions = json.loads(server.ask("/api/choices", Cookie=page.cookie)[2])["questions"]
    return {"person": person, "position": "sitting", "programme": "relax", "intensity": 2, "seed": 3,
            "answered_by": "a test", "answers": {question["key"]: "no" for question in questions}}


def review(page, wanted):
    before = page.state["session"]
    expect("operate", page.outcome("operate") == "done")
    expect("start", page.outcome("start", wanted) == "done")
    expect("a new session", page.until(lambda: page.state["session"] != before))
    expect("a plan", page.until(lambda: page.state["phase"] in ("review", "ended"), 180))


def one_desk(page, program):
    """The page is in control, then a program of ROS 2, then nobody, then the page again."""
    expect("taken by the page", program.ask("/tuina/operate", "/tuina/pause") == ["false taken", "false viewer"])
    expect("hand over", page.outcome("hand_over") == "done")
    page.until(lambda: page.state["paused"], 5)
    expect("steered", program.ask("/tuina/operate", "/tuina/resume", "/tuina/softer") == ["true done"] * 3)
    expect("taken by a program", page.outcome("operate") == "taken" and not page.state["operator"])
    expect("it goes on", page.until(lambda: not page.state["paused"], 1))
    expect("paused without operator", page.until(lambda: page.state["paused"], SILENT_S + 3))
    expect("operate again", page.outcome("operate") == "done" and page.outcome("resume") == "done")


def main(binary, client):
    os.environ["ROS_DOMAIN_ID"] = str(random.randint(1, 101))
    program = Program(client, os.environ["ROS_DOMAIN_ID"])
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, folder, "--ros2", "--pace", "real")
        page = Page(server, server.enter())
        review(page, order(page, server, "phantom:slim"))
        expect("nothing is steered before it moves", program.ask("/tuina/softer") == ["false viewer"])
        arm(page)
        expect("massage", page.until(lambda: page.state["phase"] == "massage", 60))
        heard = program.ask("hear:/tuina/order")[0]
        expect(f"the order: {heard[:80]}", "phantom:slim" in heard)
        one_desk(page, program)
        expect("a stop", program.ask("/tuina/stop") == ["true done"])
        expect("ended", page.until(lambda: page.state["phase"] == "ended", 60) and page.state["outcome"] == "stopped")

        review(page, order(page, server, "phantom:hefty"))
        arm(page)
        expect("a second massage", page.until(lambda: page.state["phase"] == "massage", 60))
        heard = program.ask("hear:/tuina/order")[0]
        expect(f"the second order: {heard[:80]}", "phantom:hefty" in heard)
        expect("a second stop", program.ask("/tuina/stop") == ["true done"])
        expect("ended again", page.until(lambda: page.state["phase"] == "ended", 60))
        lines = [(line["what"], line["outcome"]) for line in server.audit() if line["who"].startswith("ros2 ")]
        for line in (("operate", "refused: taken"), ("pause", "refused: viewer"), ("softer", "done"), ("stop", "done")):
            expect(f"the audit log has {line}", line in lines)
        checked = subprocess.run([binary, "audit", "check", f"{folder}/audit.log"], stdout=subprocess.DEVNULL)
        expect("the audit log is whole", checked.returncode == 0)
        expect("exit", server.end() == 0)
    print("two sessions of a page, heard and steered from ROS 2", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
