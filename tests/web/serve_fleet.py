# SPDX-License-Identifier: Apache-2.0
"""A robot that tells a history what it does: a file, and a server that is away; then `tuina fleet` on what it told."""
import json, os, subprocess, sys, tempfile, time
from serve_client import Page, Server

faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def fleet(binary, history, *more):
    done = subprocess.run([binary, "fleet", "--history", history, "--json", *more], capture_output=True, text=True)
    expect(f"fleet {done.stderr!r}", done.returncode == 0)
    return json.loads(done.stdout)["robots"] if done.returncode == 0 else []


def soon(holds, seconds=5.0):
    """A robot tells what it does a moment after it does it."""
    end = time.monotonic() + seconds
    while not holds() and time.monotonic() < end:
        time.sleep(0.1)
    return holds()


def give(server, order):
    """A session that is stopped while it moves."""
    page = Page(server, server.enter())
    expect("operate", page.outcome("operate") == "done")
    expect("start", page.outcome("start", order(server, page)) == "done")
    expect("a plan", page.until(lambda: page.state["phase"] == "review", 180))
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    expect("it moves", page.until(lambda: page.live and page.live[-1]["time_s"] > 2.0, 60))
    page.ask("stop")
    expect("ended", page.until(lambda: page.state["phase"] == "ended", 60))
    return page


def main(binary):
    with tempfile.TemporaryDirectory() as folder:
        history, calibration = f"{folder}/history.sqlite", f"{folder}/calibration.toml"
        with open(calibration, "w", encoding="utf-8") as file:
            file.write("# as old as its file\n")
        three_days_ago = time.time() - 3 * 86400
        os.utime(calibration, (three_days_ago, three_days_ago))

        def order(server, page):
            asked = json.loads(server.ask("/api/choices", Cookie=page.cookie)[2])["questions"]
            return {"person": "phantom:slim", "position": "sitting", "programme": "relax", "intensity": 2, "seed": 3,
                    "answered_by": "a test", "answers": {question["key"]: "no" for question in asked}}

        server = Server(binary, f"{folder}/one", "--pace", "5", "--history", history, "--called", "room-2",
                        "--calibration", calibration)
        expect("idle", soon(lambda: fleet(binary, history)[0]["doing"] == "idle"))
        page = give(server, order)
        expect("idle again", soon(lambda: fleet(binary, history)[0]["doing"] == "idle"))
        refused = order(server, page)
        refused["answers"]["pacemaker"] = "yes"
        page.outcome("start", refused)
        expect("refused", page.until(lambda: page.state["outcome"] == "failed", 60))
        page.close()
        expect("exit", server.end() == 0)
        robot = fleet(binary, history, "--out", f"{folder}/fleet.html")[0]
        expect(f"what it told {robot}", robot["robot"] == "room-2" and robot["model"] == "thesis"
               and robot["sessions"] == 2 and robot["stopped"] == 1 and robot["cut_short"] == 0
               and round(robot["calibration_age_days"]) == 3 and robot["doing"].startswith("off since"))
        with open(f"{folder}/fleet.html", encoding="utf-8") as file:
            shown = file.read()
        expect("the page", "room-2" in shown and "Stops" in shown and "Drift of the wrist sensors" in shown)
        expect("no word of health", "pacemaker" not in shown and "slim" not in shown)

        # A port at which nobody is.
        os.environ["XDG_DATA_HOME"] = f"{folder}/data"
        away = Server(binary, f"{folder}/two", "--pace", "5", "--history", "postgresql://nobody@127.0.0.1:9/tuina",
                      "--called", "room-3")
        give(away, order).close()
        expect("exit without a server", away.end() == 0)
        waits = fleet(binary, f"{folder}/data/tuina/outbox-127.0.0.1-9-tuina-nobody.sqlite")[0]
        expect(f"what waits {waits}", waits["robot"] == "room-3" and waits["sessions"] == 1 and waits["stopped"] == 1)
    print("a robot and its history", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
