# SPDX-License-Identifier: Apache-2.0
"""What stands above a table of docs/ that commands make, for who runs them and for who checks them.

A table stands between a comment and `<!-- end -->`. The comment has commands, one a line, or of several lines that end
with a backslash, and then a filter of jq. `{a,b}` in a command stands for one with each.
"""
import re

PROGRAMS = ("tuina ", "build/release/")
COMMENT = r"<!-- ((?:tuina |build/release/).*?)-->"


def each(command):
    """The commands that one with {a,b} stands for."""
    found = re.search(r"\{([^{}]*,[^{}]*)\}", command)
    if not found:
        return [command]
    before, after = command[:found.start()], command[found.end():]
    return [line for word in found[1].split(",") for line in each(before + word + after)]


def parts(comment):
    """The commands of a comment, and its filter."""
    lines = re.sub(r"\\\n\s*", "", comment.strip()).splitlines()
    commands = [command for line in lines if line.startswith(PROGRAMS) for command in each(line)]
    return commands, "\n".join(line for line in lines if not line.startswith(PROGRAMS))
