#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what commands print into the tables of docs/: numbers.py BUILD [PAGE..]

made_tables.py says how a table names its commands. The filter makes rows of cells from their JSON, of several commands
from an array; of commands joined by && the last one answers. What an example or a test of the build prints is one
string for the filter. table.jq has what filters share. What a command has printed is kept in build/docs/numbers for as
long as the program is not built anew. A page is written when all its commands are done, and not at all if one fails. A
table of people who lie beside the repository (`../shared`), or of a test, stays as it is where these are not there.
"""
import json, os, re, shlex, subprocess, sys, tempfile

from made_tables import COMMENT, parts

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
KEPT = f"{ROOT}/build/docs/numbers"
STOPPED = 4  # by the guard; the session is told all the same
TABLE = re.compile(rf"({COMMENT}\n)(.*?)(?=<!-- end -->)", re.DOTALL)


def said_by(command, build):
    """What the last of commands joined by && prints. They are run in a folder of their own, for some write files."""
    with tempfile.TemporaryDirectory() as folder:
        for one in command.split(" && "):
            program, *words = shlex.split(one)
            words = [f"{ROOT}/{word}" if "/" in word and os.path.exists(f"{ROOT}/{word}") else word for word in words]
            words += ["--json", "--quiet"] if program == "tuina" else []
            done = subprocess.run([f"{build}/{program.removeprefix('build/release/')}", *words], capture_output=True,
                                  text=True, cwd=folder)
            if done.returncode not in (0, STOPPED):
                sys.exit(f"{one}: ends with {done.returncode}: {done.stderr.strip() or done.stdout.strip()[-300:]}")
    return done.stdout if program == "tuina" else json.dumps(done.stdout)


def answer(command, build):
    """The JSON of a command."""
    kept = f"{KEPT}/{re.sub(r'[^A-Za-z0-9.=-]+', '_', command)}.json"
    program = command.split()[0].removeprefix("build/release/")
    programs = ["tuina", "tuina-evaluate"] if program == "tuina" else [program]
    built = max(os.path.getmtime(f"{build}/{program}") for program in programs)
    if not os.path.exists(kept) or os.path.getmtime(kept) < built:
        print(command, file=sys.stderr, flush=True)
        said = said_by(command, build)
        with open(f"{kept}.part", "w", encoding="utf-8") as file:
            file.write(said)
        os.replace(f"{kept}.part", kept)
    with open(kept, encoding="utf-8") as file:
        return file.read()


def missing(comment, build):
    """What is named and not there: a folder beside the repository, or a test that was not built."""
    return next((word for word in comment.split() if word.startswith("../") and not os.path.exists(f"{ROOT}/{word}")
                 or word.startswith("build/") and not os.path.exists(word.replace("build/release", build, 1))), None)


def table(commands, rows, build, page):
    """The table in Markdown; its first row is the head."""
    answers = [answer(command, build) for command in commands]
    done = subprocess.run(["jq", "--compact-output", "-L", f"{ROOT}/docs/site", *(["--slurp"] if len(answers) > 1 else []),
                           f'include "table"; {rows}'], input="\n".join(answers), capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{page}: the filter of `{commands[0]}`: {done.stderr.strip()}")
    cells = [json.loads(line) for line in done.stdout.splitlines()]
    if len(cells) < 2 or len({len(row) for row in cells}) != 1:
        sys.exit(f"{page}: `{commands[0]}` makes {len(cells)} rows of {sorted({len(row) for row in cells})} cells; a head "
                 "and rows of as many cells are needed")
    cells.insert(1, ["---"] * len(cells[0]))
    return "\n" + "".join(f"| {' | '.join(map(str, row))} |\n" for row in cells) + "\n"


def written(found, build, page):
    """The table anew, or as it is."""
    commands, rows = parts(found[2])
    if missing(found[2], build):
        print(f"{page}: no {missing(found[2], build)} here; the table of `{commands[0]}` stays")
        return found[0]
    return found[1] + table(commands, rows, build, page)


def main(build, pages):
    os.makedirs(KEPT, exist_ok=True)
    known = sorted(name for name in os.listdir(f"{ROOT}/docs") if name.endswith(".md"))
    for page in pages or known:
        if page.removeprefix("docs/") not in known:
            sys.exit(f"docs has no page {page}; one is called as {known[0]}")
        path = f"{ROOT}/docs/{page.removeprefix('docs/')}"
        with open(path, encoding="utf-8") as file:
            text = file.read()
        new = TABLE.sub(lambda found: written(found, build, page), text)
        if new != text:
            with open(f"{path}.part", "w", encoding="utf-8") as file:
                file.write(new)
            os.replace(f"{path}.part", path)
            print(f"{page}: written anew")


main(os.path.abspath(sys.argv[1]), sys.argv[2:])
