#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the text of the repository to docs/house.md: house.py rooms|paths|references|sizes|names|includes|version"""
import collections, itertools, os, re, sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CODE = ("tuina", "apps", "python", "tests", "examples", "bench", "docs")
MAX_UNITS, MAX_FILE_LINES, MAX_FUNCTION_LINES = 25, 300, 60  # units of a folder: a stem, .hpp and .cpp alike


def read(path):
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        return file.read()


def files(*endings, folders=CODE):
    for folder in folders:
        for at, _, names in os.walk(f"{ROOT}/{folder}"):
            for name in sorted(names):
                if name.endswith(endings):
                    yield os.path.relpath(f"{at}/{name}", ROOT)


def documents():
    return ["README.md", *files(".md", folders=("docs", "examples"))]


def exceptions(kind):
    """The lines `<kind> <what> -- <reason>` of exceptions.txt."""
    found = {}
    for line in read("tests/house/exceptions.txt").splitlines():
        if line.startswith(kind + " "):
            what, _, reason = line[len(kind) + 1:].partition(" -- ")
            found[what.strip()] = reason.strip()
    return found


def excused(kind, broken):
    """What is broken without an exception, and exceptions without a reason or without need."""
    named = exceptions(kind)
    yield from (text for what, text in broken.items() if not named.get(what))
    yield from (f"tests/house/exceptions.txt: {kind} {what} is no exception any more" for what in named
                if what not in broken)


def rooms():
    """The rooms of docs/house.md, of cmake/rooms.cmake and the folders of tuina/ are the same."""
    listed = re.search(r"set\(TUINA_ROOMS ([^)]*)\)", read("cmake/rooms.cmake")).group(1).split()
    folders = [name for name in os.listdir(f"{ROOT}/tuina") if os.path.isdir(f"{ROOT}/tuina/{name}")]
    tree = read("docs/house.md").split("tuina/ ", 1)[1].split("\napps/", 1)[0]
    shown = re.findall(r"^  ([a-z0-9_]+)/", tree, re.MULTILINE)
    table = read("docs/house.md").split("| room | may include", 1)[1].split("\n\n", 1)[0]
    rows = [name for row in table.splitlines()[2:] for name in row.split("|")[1].replace(" ", "").split(",")]
    for where, names in (("the tree of docs/house.md", shown), ("cmake/rooms.cmake", listed),
                         ("the table of docs/house.md", [name for name in rows if name not in ("apps", "python")])):
        for name in sorted(set(folders) ^ set(names)):
            yield f"room {name} stands in only one of tuina/ and {where}"


def spread(path):
    """Paths with braces in them, one by one."""
    inside = re.search(r"\{([^{}]*)\}", path)
    if not inside:
        return [path]
    return itertools.chain(*(spread(path[:inside.start()] + part.strip() + path[inside.end():])
                             for part in inside.group(1).split(",")))


def anchors(document):
    """What headings of a document are called in links."""
    text = re.sub(r"^```.*?^```", "", read(document), flags=re.DOTALL | re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).strip().replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE)}


def paths():
    """Paths in backticks and links of the documents exist. A room's file may be named without tuina/ and ending."""
    top = {name for name in os.listdir(ROOT) if os.path.isdir(f"{ROOT}/{name}")} - {"build"}
    rooms = {name for name in os.listdir(f"{ROOT}/tuina") if os.path.isdir(f"{ROOT}/tuina/{name}")}
    for document in documents():
        text = re.sub(r"```.*?```", "", read(document), flags=re.DOTALL)
        for quoted in re.findall(r"`([\w./{}, -]+)`", text):
            for path in spread(quoted):
                if "/" not in path or " " in path or path.split("/")[0] not in top | rooms:
                    continue
                if not any(os.path.exists(f"{ROOT}/{folder}{path}{ending}")
                           for folder in ("", "tuina/") for ending in ("", ".hpp", ".cpp")):
                    yield f"{document}: `{path}` does not exist"
        for link, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^):\s]+))?\)", text):
            path = os.path.normpath(os.path.join(os.path.dirname(document), link)) if link else document
            if not os.path.exists(f"{ROOT}/{path}"):
                yield f"{document}: the link to {link} leads nowhere"
            elif anchor and anchor not in anchors(path):
                yield f"{document}: {path} has no heading {anchor}"


def references():
    """Keys of sources such as [hogan1985] stand in docs/references.md, each once."""
    known = re.findall(r"^\| \[(\w+)\] \|", read("docs/references.md"), re.MULTILINE)
    yield from (f"docs/references.md: [{key}] twice" for key, n in collections.Counter(known).items() if n > 1)
    single = [key for key in known if not re.search(r"\d{4}", key)]  # [thesis] and the like
    key = re.compile(r"(?<![\w\])}>])\[([a-z]+(?:19|20)\d\d[a-z]?|" + "|".join(single) + r")\]")
    for path in [*files(".cpp", ".hpp", ".py", ".md", ".cmake", ".txt"), "README.md"]:
        for used in sorted(set(key.findall(read(path))) - set(known)):
            yield f"{path}: [{used}] is not in docs/references.md"


def functions(path):
    """(name, lines) of each function, from the shape that clang-format gives it."""
    start, inner = {0: None, 2: None}, False
    for number, line in enumerate(read(path).splitlines(), 1):
        for indent in start:
            margin = " " * indent
            if re.match(margin + r"[A-Za-z_~\[]", line) and not line.startswith((margin + "else", margin + "case")):
                if indent == 0:
                    inner = bool(re.match(r"(struct|class)\b", line))
                start[indent] = (number, line.strip())
            if line == margin + "}" and start[indent] and "(" in start[indent][1] and (indent == 0 or inner):
                begin, text = start[indent]
                named = re.search(r"([\w:~]+)\(", text)
                yield text if "TEST_CASE" in text or not named else named.group(1), number - begin + 1


def sizes():
    """A folder holds at most 25 units, a file 300 lines, a function 60; exceptions.txt names the others."""
    units = collections.defaultdict(set)
    long_files, long_functions = {}, {}
    for path in files(".cpp", ".hpp"):
        units[os.path.dirname(path)].add(os.path.splitext(os.path.basename(path))[0])
        lines = read(path).count("\n")
        if lines > MAX_FILE_LINES:
            long_files[path] = f"{path} has {lines} lines"
        for name, lines in functions(path):
            if lines > MAX_FUNCTION_LINES:
                long_functions[f"{path} {name}"] = f"{path}: {name} has {lines} lines"
    yield from (f"{folder} holds {len(names)} units" for folder, names in units.items() if len(names) > MAX_UNITS)
    yield from excused("file", long_files)
    yield from excused("function", long_functions)


def names():
    """Limits are max_ and min_; most_ and least_ are left for results, which exceptions.txt names."""
    broken = {}
    for path in files(".cpp", ".hpp"):
        code = re.sub(r"//.*|\"(\\.|[^\"\\])*\"", "", read(path))
        for name in re.findall(r"\b(?:most|least)_\w+", code):
            broken.setdefault(name, f"{path}: {name} should be max_ or min_")
    yield from excused("name", broken)


def includes():
    """A header that names a type of tuina/core includes its header, itself or by another: built in batches, a source
    compiles without. Examples include what is installed."""
    text = {path: read(path) for path in files(".hpp")}
    included = {path: re.findall(r'#include "([^"]+)"', text[path]) for path in text}
    code = {path: re.sub(r"//.*|\"(\\.|[^\"\\\n])*\"", "", text[path]) for path in text}
    types = {name: path for path in text if path.startswith("tuina/core/")
             for name in re.findall(r"^(?:struct|class|enum class|using) (?:\[\[nodiscard\]\] )?(\w+)[ :{=]", code[path],
                                    re.MULTILINE)}
    def reached_by(*paths):
        reached, left = set(), list(paths)
        while left:
            at = left.pop()
            if at not in reached:
                reached.add(at)
                left += included.get(at, [])
        return reached

    for path in text:
        reached = reached_by(path)
        for name in sorted(set(re.findall(r"\b[A-Z]\w+", code[path])) & set(types)):
            own = re.search(rf"\b(?:struct|class|using|typename) {name}\b", "".join(code.get(at, "") for at in reached))
            if types[name] not in reached and not own:
                yield f"{path}: names {name} without {types[name]}"
    installed = reached_by(*(path for path in text if re.fullmatch(r"tuina/\w+\.hpp", path)))
    for path in files(".cpp", ".hpp", folders=("examples",)):
        for header in re.findall(r'#include "(tuina/[^"]+)"', read(path)):
            if header not in installed:
                yield f"{path}: {header} is the room's own, and not installed"


def version():
    """CMakeLists.txt holds the version; files that others read without CMake say the same."""
    right = re.search(r"project\(tuina VERSION ([0-9.]+)", read("CMakeLists.txt")).group(1)
    copies = {"CITATION.cff": r"^version: (.*)$", **{path: "<version>(.*)</version>"
                                                     for path in files("package.xml", folders=("ros2",))}}
    for path, pattern in copies.items():
        said = re.search(pattern, read(path), re.MULTILINE)
        if not said or said.group(1) != right:
            yield f"{path}: says version {said and said.group(1)}, CMakeLists.txt says {right}"


checks = dict(rooms=rooms, paths=paths, references=references, sizes=sizes, names=names, includes=includes,
              version=version)
faults = list(checks[sys.argv[1]]())
print("\n".join(faults))
sys.exit(bool(faults))
