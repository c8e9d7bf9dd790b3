#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what commands print into the tables of docs/: numbers.py BUILD [PAGE..]

A table stands between a comment and `<!-- end -->`. The comment has commands of tuina, one a line, and then a filter of
jq that makes rows of cells from their JSON, of several commands from an array. table.jq has what filters share. What a
command has printed is kept in build/docs/numbers for as long as the program is not built anew. A page is written when
all its commands are done, and not at all if one fails.
"""
import json, os, re, subprocess, sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
KEPT = f"{ROOT}/build/docs/numbers"
TABLE = re.compile(r"(<!-- (tuina .*?)-->\n)(.*?)(?=<!-- end -->)", re.DOTALL)


def parts(comment):
    """The commands of a comment, and its filter."""
    lines = comment.strip().splitlines()
    commands = [line for line in lines if line.startswith("tuina ")]
    return commands, "\n".join(line for line in lines if not line.startswith("tuina "))


def answer(command, build):
    """The JSON that a command prints."""
    kept = f"{KEPT}/{re.sub(r'[^A-Za-z0-9.=-]+', '_', command)}.json"
    if not os.path.exists(kept) or os.path.getmtime(kept) < os.path.getmtime(f"{build}/tuina-evaluate"):
        print(command, file=sys.stderr, flush=True)
        done = subprocess.run([f"{build}/tuina", *command.split()[1:], "--json", "--quiet"], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{command}: ends with {done.returncode}: {done.stderr.strip()}")
        with open(f"{kept}.part", "w", encoding="utf-8") as file:
            file.write(done.stdout)
        os.replace(f"{kept}.part", kept)
    with open(kept, encoding="utf-8") as file:
        return file.read()


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


def main(build, pages):
    os.makedirs(KEPT, exist_ok=True)
    for page in pages or sorted(name for name in os.listdir(f"{ROOT}/docs") if name.endswith(".md")):
        path = f"{ROOT}/docs/{page.removeprefix('docs/')}"
        with open(path, encoding="utf-8") as file:
            text = file.read()
        new = TABLE.sub(lambda found: found.group(1) + table(*parts(found.group(2)), build, page), text)
        if new != text:
            with open(f"{path}.part", "w", encoding="utf-8") as file:
                file.write(new)
            os.replace(f"{path}.part", path)
            print(f"{page}: written anew")


main(os.path.abspath(sys.argv[1]), sys.argv[2:])
