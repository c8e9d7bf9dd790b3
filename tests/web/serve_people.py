# SPDX-License-Identifier: Apache-2.0
"""Somebody with a history on the live page: what is remembered is told, used only where that is confirmed, and dropped and
said where it does not fit the back that is seen. Usage: serve_people.py TUINA"""
import json, sys, tempfile
from serve_client import Page, Server

faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def got(server, page, path):
    """Status and content of what is asked for by a page."""
    status, _, body = server.ask(path, Cookie=page.cookie)
    return status, json.loads(body) if status == 200 else None


def order(server, page, **more):
    asked = got(server, page, "/api/choices")[1]["questions"]
    return {"person": "phantom:slim", "position": "sitting", "programme": "relax", "intensity": 2, "seed": 3,
            "answered_by": "a test", "answers": {question["key"]: "no" for question in asked}, **more}


def begun(server, page, **more):
    """Whether a session comes as far as its plan; else it ends without a massage."""
    before = page.state["session"]
    expect(f"start {more}", page.outcome("start", order(server, page, **more)) == "done")
    page.until(lambda: page.state["session"] != before and page.state["phase"] in ("review", "ended"), 180)
    return page.state["phase"] == "review"


def first_session(server, page):
    """A place is ruled out in the review, softer is wished in the massage, which is then stopped."""
    expect("nobody is known", got(server, page, "/api/people") == (200, []))
    expect("a new name", got(server, page, "/api/remembered/sitting/anna")[1] == {"sessions": 0, "items": [], "changes": []})
    expect("a plan", begun(server, page, who="anna"))
    x, y, z = next(one["at"] for one in got(server, page, "/api/map")[1]["acupoints"] if one["name"] == "BL47_L")
    area = {"name": "scar", "corners": [[x - 0.02, y, z - 0.02], [x + 0.02, y, z - 0.02], [x, y, z + 0.02]]}
    before = page.state["reviews"]
    expect("change", page.outcome("change", {"no_go": [area], "fixed": []}) == "done")
    expect("another plan", page.until(lambda: page.state["reviews"] > before, 60) and not page.state["words"])
    answer = page.arm()
    expect(f"arm: {answer}", answer == "done")
    expect("it begins", page.until(lambda: page.state["phase"] == "massage", 60))
    expect("softer", page.outcome("softer") == "done")
    expect("it moves", page.until(lambda: page.live and page.live[-1]["time_s"] > 3.0, 60))
    page.ask("stop")
    expect("ended", page.until(lambda: page.state["phase"] == "ended", 60))


def remembered_sessions(server, page):
    names, (_, anna) = got(server, page, "/api/people")[1], got(server, page, "/api/remembered/sitting/anna")
    kinds = [one["kind"] for one in anna["items"]]
    expect(f"what is remembered {names} {anna}", names == ["anna"] and anna["sessions"] == 1 and kinds[:2] == ["by_hand", "wish"])
    answers = {kind: False for kind in kinds}

    expect("without an answer nothing begins", not begun(server, page, who="anna", remember={}))
    expect(f"and why is said {page.state['words']}", "was not said" in page.state["words"])

    expect("with all of it denied", begun(server, page, who="anna", remember=answers))
    expect("nothing is ruled out", got(server, page, "/api/by_hand")[1]["no_go"] == [])
    page.ask("stop")
    page.until(lambda: page.state["phase"] == "ended", 60)

    use = {**answers, "by_hand": True}
    expect("with what was said by hand", begun(server, page, who="anna", remember=use))
    expect("no word of dropping", not any(one["key"] == "note_said_dropped" for one in got(server, page, "/api/plan")[1]["notes"]))
    pressed = [path["name"] for path in got(server, page, "/api/plan")[1]["paths"]]
    expect(f"the scar is left out {pressed}", "press BL47_L" not in pressed and "press BL47_R" in pressed)
    page.ask("stop")
    page.until(lambda: page.state["phase"] == "ended", 60)

    expect("somebody else under that name", begun(server, page, who="anna", remember=use, person="phantom:hefty", seed=11))
    keys = [one["key"] for one in got(server, page, "/api/plan")[1]["notes"]]
    expect(f"what does not fit is dropped and said {keys}", "note_said_dropped" in keys)
    expect("and is not in force", "press BL47_L" in [path["name"] for path in got(server, page, "/api/plan")[1]["paths"]])
    page.ask("stop")
    page.until(lambda: page.state["phase"] == "ended", 60)


def refused(server, page):
    for wrong in ("/api/remembered/sitting/a%20b", "/api/remembered/standing/anna", "/api/remembered/anna", "/api/remembered/sitting/"):
        expect(f"{wrong} is refused", got(server, page, wrong)[0] == 404)
    for key, value in (("who", 7), ("who", "x" * 81), ("remember", ["by_hand"]), ("remember", {"by_hand": 1}), ("remember", {"shape": True})):
        outcome = page.outcome("start", order(server, page, **{key: value}))
        expect(f"{key} {value}: {outcome}", outcome.startswith(f"{key}:"))
    expect("a name that is none", not begun(server, page, who="a b"))
    viewer = Page(server, server.enter(page.invitation("invite").partition("=")[2]))
    expect("it is a viewer", viewer.state["viewer"])
    for path in ("/api/people", "/api/remembered/sitting/anna"):
        expect(f"a viewer's {path}", got(server, viewer, path)[0] == 403)
    for who, named in ((page, True), (viewer, False)):
        listed = got(server, who, "/api/sessions")[1]["sessions"]
        expect(f"whose sessions they were: {listed}", listed and all((one.get("who") == "anna") == named for one in listed))
    expect("who looked is in the audit log", any(line["what"] == "look up people" for line in server.audit()))
    viewer.close()


def main(binary):
    with tempfile.TemporaryDirectory() as folder:
        server = Server(binary, f"{folder}/one", "--pace", "5", "--history", f"{folder}/history.sqlite")
        page = Page(server, server.enter())
        expect("operate", page.outcome("operate") == "done")
        first_session(server, page)
        remembered_sessions(server, page)
        refused(server, page)
        page.close()
        expect("exit", server.end() == 0)

        alone = Server(binary, f"{folder}/two", "--pace", "5")
        page = Page(alone, alone.enter())
        expect("a server without a history knows nobody", got(alone, page, "/api/people")[0] == 404)
        page.outcome("operate")
        outcome = page.outcome("start", order(alone, page, who="anna"))
        expect(f"and takes no name {outcome}", outcome.startswith("who:"))
        page.close()
        expect("exit without a history", alone.end() == 0)
    print("people on the live page", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
