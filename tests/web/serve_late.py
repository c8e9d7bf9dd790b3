# SPDX-License-Identifier: Apache-2.0
"""Whether the server makes the loop late: the same massage at real pace by turns without it (`tuina massage`) and with it
(`tuina serve`, and pages that watch). How late the milliseconds were over, session.json has as `massage.late_ms`.
Usage: serve_late.py TUINA [TURNS [PAGES]]; 2 turns of each and one page unless said."""
import json, os, statistics, subprocess, sys, tempfile
from serve_client import Page, Server
from serve_stop import ORDER, SHORT_SCAN

TOLD = (("median", "median"), ("p999", "999 of 1000"), ("max", "largest"))
faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def late_ms(folder):
    with open(f"{folder}/session.json", encoding="utf-8") as file:
        return json.load(file)["massage"]["late_ms"]


def without(binary, folder):
    subprocess.run([binary, "massage", "--person", ORDER["person"], "--position", ORDER["position"], "--programme", ORDER["programme"],
                    "--seed", str(ORDER["seed"]), "--pace", "real", "--out", folder, "--quiet", *SHORT_SCAN], check=True)
    return late_ms(folder)


def served(binary, folder, pages):
    server = Server(binary, folder, *SHORT_SCAN)
    cookie = server.enter()
    page = Page(server, cookie)
    watching = [page, *(Page(server, cookie) for _ in range(pages - 1))]
    questions = json.loads(server.ask("/api/choices", Cookie=cookie)[2])["questions"]
    page.outcome("operate")
    expect("start", page.outcome("start", {**ORDER, "answers": {question["key"]: "no" for question in questions}}) == "done")
    expect("review", page.until(lambda: page.state["phase"] in ("review", "ended"), 120))
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    expect("it ends", page.until(lambda: page.state["phase"] in ("report", "ended"), 600))
    expect("all pages got frames", all(len(one.live) > 100 for one in watching))
    session = page.state["session"]
    expect("exit", server.end() == 0)
    return late_ms(f"{folder}/{session}")


def told(what, found):
    """The middle turn of each number."""
    print(f"{what}: " + ", ".join(f"{words} {statistics.median(one[key] for one in found):.2f} ms" for key, words in TOLD))


def main(binary, turns="2", pages="1"):
    alone, beside = [], []
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(int(turns)):
            alone.append(without(binary, f"{folder}/alone{turn}"))
            print(f"turn {turn + 1}, without the server: {alone[-1]}", file=sys.stderr, flush=True)
            beside.append(served(binary, f"{folder}/served{turn}", int(pages)))
            print(f"turn {turn + 1}, with it: {beside[-1]}", file=sys.stderr, flush=True)
    told("without the server", alone)
    told(f"with it and pages {pages}", beside)
    # What one machine does by itself differs from turn to turn by so much; more than that is the server's.
    later = [words for key, words in TOLD if min(one[key] for one in beside) > max(one[key] for one in alone)]
    print(f"later with the server in every turn: {', '.join(later) or 'nothing'}; load of the machine, {os.cpu_count()} cores: {os.getloadavg()[0]:.1f}")
    # A busy machine is late by itself, so only what no busy machine explains is a fault here.
    expect(f"the loop waits for the server {later}", "median" not in later or statistics.median(one["median"] for one in beside) < 1.0)
    print("late", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
