#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation run over a room, one file of it, or what has changed: mutate.py safety [guard_law.cpp | changed]

tests/mutation/<room>_judged.txt has the sha256 of the code, without comments and spaces, of each file whose mutants
were all judged, with the tests of that time; `changed` judges the others. Before a release the whole room is judged, since tests may have become weaker.

Every mutant of the sources is built into one test program, which runs once for each with TUINA_MUTANT set. A mutant
that no test notices must stand in tests/mutation/<room>_survivors.txt with a reason; what stands there must exist and
survive. clang's syntax tree tells operators, constants and conditions apart. Families: relational, arithmetic, sign,
logical, constant, range (min, max, clamp, abs, front, back), statement, condition, value (returned, enumerator, truth).
"""
import collections, fnmatch, glob, hashlib, json, os, re, subprocess, sys, time
from concurrent.futures import ThreadPoolExecutor

ROOM = sys.argv[1]
ONLY = sys.argv[2] if len(sys.argv) > 2 and sys.argv[2] != "changed" else ""
CHANGED = sys.argv[2:] == ["changed"]
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = f"{ROOT}/build/mutation/{ROOM}"
FLAGS = ["-std=c++20", "-isystem", "/usr/include/eigen3"]
# Pairs of operators that tell more than others, after Kaminski, Ammann, Offutt 2013 [kaminski2013].
RELATIONAL = {"<": ("less", ["at_most", "at_least", "unequal"]), "<=": ("at_most", ["less", "more", "equal"]),
              ">": ("more", ["at_least", "at_most", "unequal"]), ">=": ("at_least", ["more", "less", "equal"]),
              "==": ("equal", ["unequal", "at_most", "at_least"]), "!=": ("unequal", ["equal", "less", "more"])}
ARITHMETIC = {"+": ("plus", ["minus", "left"]), "-": ("minus", ["plus", "left"]), "*": ("times", ["over"]),
              "/": ("over", ["times"])}
SIGN = dict(less="<", at_most="<=", more=">", at_least=">=", equal="==", unequal="!=", plus="+", minus="-",
            times="*", over="/", left="left side only", scaled_down="/")
SWAPPED = {"min": "max", "max": "min", "minCoeff": "maxCoeff", "maxCoeff": "minCoeff", "cwiseMin": "cwiseMax",
           "cwiseMax": "cwiseMin", "front": "back", "back": "front"}
SCALAR = ("double", "int", "unsigned long", "long", "float", "unsigned int")

mutants = []  # {file, function, family, what}


class Source:
    """Rewrites one file: sites are ranges of its text with a function that writes them anew."""

    def __init__(self, path):
        self.path, self.text, self.sites, self.seen = path, open(f"{ROOT}/{path}").read(), [], set()

    def add(self, begin, end, family, changes, write, function):
        key = (begin, end, family, changes and changes[0])
        if key in self.seen or end <= begin or self.text[begin:end] == ":":  # how a range is gone through
            return
        self.seen.add(key)
        number = len(mutants)
        original = " ".join(self.text[begin:end].split())
        for change in changes:
            mutants.append(dict(file=os.path.basename(self.path), function=function, family=family,
                                what=f"`{original}` {change}"))
        self.sites.append((begin, end, len(self.sites), number, write))

    def render(self, begin, end, skip=frozenset()):
        """The text of a range with the outermost sites in it rewritten; `skip` are those being written already."""
        inside = [s for s in self.sites if begin <= s[0] and s[1] <= end and s[2] not in skip]
        inside.sort(key=lambda s: (s[0], -s[1], s[2]))
        out, at = [], begin
        for b, e, index, number, write in inside:
            if b < at:
                continue
            out.append(self.text[at:b])
            taken = skip | {index}
            out.append(write(number, lambda x, y: self.render(x, y, taken)))
            at = e
        return "".join(out) + self.text[at:end]


def span(node):
    r = node.get("range", {})
    b, e = r.get("begin", {}), r.get("end", {})
    if "offset" not in b or "offset" not in e:
        return None
    return b["offset"], e["offset"] + e["tokLen"]


def kind_of(node):
    return node.get("type", {}).get("desugaredQualType", node.get("type", {}).get("qualType", "")).replace("const ", "")


def called(node):
    """The name of the function that a call or an operator calls."""
    callee = node["inner"][0]
    while "referencedDecl" not in callee and callee.get("kind") != "MemberExpr" and callee.get("inner"):
        callee = callee["inner"][0]
    return callee.get("referencedDecl", {}).get("name", callee.get("name", "")).removeprefix("operator")


class Walk:
    def __init__(self, sources):
        self.sources, self.file, self.enums = sources, "", {}

    def visit(self, node, function=""):
        for where in [node.get("loc", {})] + [node.get("range", {}).get(x, {}) for x in ("begin", "end")]:
            self.file = where.get("file", self.file)
        kind, source, here = node.get("kind"), self.sources.get(os.path.normpath(self.file)), span(node)
        if kind == "EnumDecl":
            members = [n for n in node["inner"] if n["kind"] == "EnumConstantDecl"]
            self.enums.update({n["id"]: (node["name"], i, [m["name"] for m in members])
                               for i, n in enumerate(members)})
        outside = kind in ("VarDecl", "CXXRecordDecl") and not function
        if outside or kind in ("FunctionDecl", "CXXMethodDecl", "CXXConstructorDecl", "FieldDecl"):
            name = node.get("name", "operator()")
            function = function if name == "operator()" else name
        is_size = kind == "VarDecl" and node["type"]["qualType"] == "const std::size_t"  # of an array: fixed
        skipped = kind in ("CXXDefaultArgExpr", "CXXDefaultInitExpr") or node.get("isImplicit") or is_size
        if source and here and not skipped:
            getattr(self, kind, lambda *a: None)(node, source, here, function)
            if kind in ("CompoundStmt", "IfStmt", "ForStmt"):
                self.statements(node, source, function)
        for inner in node.get("inner", []):
            if skipped or "kind" not in inner:
                self.follow(inner)
            else:
                self.visit(inner, function)

    def follow(self, node):  # only to keep track of the file
        for where in [node.get("loc", {})] + [node.get("range", {}).get(x, {}) for x in ("begin", "end")]:
            self.file = where.get("file", self.file)
        for inner in node.get("inner", []):
            self.follow(inner)

    def operands(self, node, count=2):
        parts = [p for p in node["inner"] if span(p)]
        return [span(p) for p in parts[-count:]], [kind_of(p) for p in parts[-count:]]

    def replaced(self, source, here, family, table, opcode, ab, function):
        original, others = table[opcode]
        (a, b) = ab
        source.add(*here, family, [f"with {SIGN[o]}" for o in others], lambda n, r:
                   f"tuina::mutation::binary<{', '.join('tuina::mutation::' + x for x in [original] + others)}>"
                   f"({n}, {r(*a)}, {r(*b)})", function)

    def BinaryOperator(self, node, source, here, function):
        op, ((a, b), kinds) = node["opcode"], self.operands(node)
        if op in ("==", "!=") and "*" in "".join(kinds):  # addresses have no order
            others = {"==": ("equal", ["unequal"]), "!=": ("unequal", ["equal"])}
            self.replaced(source, here, "relational", others, op, (a, b), function)
        elif op in RELATIONAL:
            self.replaced(source, here, "relational", RELATIONAL, op, (a, b), function)
        elif op in ARITHMETIC and "*" not in kind_of(node):
            self.replaced(source, here, "arithmetic", ARITHMETIC, op, (a, b), function)
        elif op in ("&&", "||"):
            name, other = ("both", "||") if op == "&&" else ("either", "&&")
            source.add(*here, "logical", [f"with {other}", "left side only", "right side only"], lambda n, r:
                       f"tuina::mutation::{name}({n}, [&]() -> bool {{ return {r(*a)}; }}, "
                       f"[&]() -> bool {{ return {r(*b)}; }})", function)
        elif op == ",":
            for part in (a, b):
                source.add(*part, "statement", ["removed"], lambda n, r, part=part:
                           f"(tuina::mutation::is({n}) ? void() : void({r(*part)}))", function)

    def CXXOperatorCallExpr(self, node, source, here, function):
        op, count = called(node), len(node["inner"]) - 1
        if count == 1 and op == "-":
            (a,), _ = self.operands(node, 1)
            source.add(*here, "sign", ["without its sign"], lambda n, r: f"tuina::mutation::negated({n}, {r(*a)})",
                       function)
        if count != 2:
            return
        (a, b), kinds = self.operands(node)
        if op in ("+", "-"):
            self.replaced(source, here, "arithmetic", ARITHMETIC, op, (a, b), function)
        elif op == "*" and kinds[1] in SCALAR:
            self.replaced(source, here, "arithmetic", ARITHMETIC, op, (a, b), function)
        elif op == "*" and kinds[0] in SCALAR:
            self.replaced(source, here, "arithmetic", {"*": ("times", ["scaled_down"])}, op, (a, b), function)
        elif op in ("+=", "-="):
            self.assigned(source, here, op, a, b, function)

    def CompoundAssignOperator(self, node, source, here, function):
        self.assigned(source, here, node["opcode"], *self.operands(node)[0], function)

    def assigned(self, source, here, op, a, b, function):
        other = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}[op]
        source.add(*here, "arithmetic", [f"with {other}"], lambda n, r:
                   f"(tuina::mutation::is({n}) ? void({r(*a)} {other} {r(*b)}) : void({r(*a)} {op} {r(*b)}))", function)

    def UnaryOperator(self, node, source, here, function):
        op, ((a,), _) = node["opcode"], self.operands(node, 1)
        if op == "-":
            source.add(*here, "sign", ["without its sign"], lambda n, r: f"tuina::mutation::negated({n}, {r(*a)})",
                       function)
        elif op == "!":
            source.add(*here, "logical", ["without !"], lambda n, r: f"tuina::mutation::inverted({n}, {r(*a)})",
                       function)
        elif op in ("++", "--"):
            other = "--" if op == "++" else "++"
            first, last = (op, "") if not node.get("isPostfix") else ("", op)
            source.add(*here, "arithmetic", [f"with {other}"], lambda n, r:
                       f"(tuina::mutation::is({n}) ? {first and other}{r(*a)}{last and other} : {first}{r(*a)}{last})",
                       function)

    def number(self, source, here, value, epsilon, kind, function):
        wanted = [0, 2 * value, value / 2 if kind == "double" else value // 2, value + epsilon, value - epsilon]
        wanted = [1, -1] if value == 0 else wanted
        others = list(dict.fromkeys(w for w in wanted if w != value))
        source.add(*here, "constant", [f"as {o:g}" for o in others], lambda n, r:
                   f"tuina::mutation::constant<{kind}>({n}, {r(*here)}, {', '.join(map(repr, others))})", function)

    def FloatingLiteral(self, node, source, here, function):
        value = float(node["value"])
        self.number(source, here, value, 0.01 * value, "double", function)

    def IntegerLiteral(self, node, source, here, function):
        self.number(source, here, int(node["value"]), 1, "int", function)

    def CXXBoolLiteralExpr(self, node, source, here, function):
        value = str(not node["value"]).lower()
        source.add(*here, "value", [f"as {value}"], lambda n, r:
                   f"tuina::mutation::constant<bool>({n}, {r(*here)}, {value})", function)

    def DeclRefExpr(self, node, source, here, function):
        if node.get("referencedDecl", {}).get("id") not in self.enums:
            return
        name, i, members = self.enums[node["referencedDecl"]["id"]]
        others = [members[k] for k in (i - 1, i + 1) if 0 <= k < len(members)]
        source.add(*here, "value", [f"as {o}" for o in others], lambda n, r:
                   f"tuina::mutation::constant<{name}>({n}, {r(*here)}, "
                   f"{', '.join(f'{name}::{o}' for o in others)})", function)

    def CallExpr(self, node, source, here, function):
        name = called(node)
        parts = [span(p) for p in node["inner"][1:]]
        if name in SWAPPED:
            self.changed(source, here, name, SWAPPED[name], function)
        elif name in ("abs", "clamp"):
            source.add(*here, "range", [f"without {name}"], lambda n, r:
                       f"(tuina::mutation::is({n}) ? {r(*parts[0])} : {r(*here)})", function)

    def CXXMemberCallExpr(self, node, source, here, function):
        name = called(node)
        if name in SWAPPED:
            self.changed(source, here, name, SWAPPED[name], function)
        elif name in ("cwiseAbs", "allFinite"):
            inner = span(node["inner"][0]["inner"][0])
            other = lambda r: f"tuina::mutation::value({r(*inner)})" if name == "cwiseAbs" else "true"
            source.add(*here, "range", [f"without {name}"], lambda n, r:
                       f"(tuina::mutation::is({n}) ? {other(r)} : tuina::mutation::value({r(*here)}))", function)

    def changed(self, source, here, name, other, function):
        def write(n, r):
            text = r(*here)
            if text.startswith(f"std::{name}("):
                swapped = text.replace(name, other, 1)
            else:
                head, _, tail = text.rpartition(f"{name}(")
                swapped = f"{head}{other}({tail}"
            if name.startswith("cwise"):  # both are expressions of their own type
                swapped, text = f"tuina::mutation::value({swapped})", f"tuina::mutation::value({text})"
            return f"(tuina::mutation::is({n}) ? {swapped} : {text})"
        source.add(*here, "range", [f"with {other}"], write, function)

    def IfStmt(self, node, source, here, function):
        condition = next(p for p in node["inner"] if kind_of(p))
        self.condition(source, span(condition), function)

    def ConditionalOperator(self, node, source, here, function):
        self.condition(source, span(node["inner"][0]), function)

    def condition(self, source, here, function):
        source.add(*here, "condition", ["as true", "as false"], lambda n, r:
                   f"tuina::mutation::condition({n}, {r(*here)})", function)

    def ReturnStmt(self, node, source, here, function):
        value = node.get("inner", [{}])[0]
        if kind_of(value) in ("bool", "double") or "Eigen::Matrix" in kind_of(value):
            kind = kind_of(value) if "Eigen" not in kind_of(value) else "tuina::JointVector"
            source.add(*span(value), "value", ["not returned"], lambda n, r:
                       f"tuina::mutation::returned<{kind}>({n}, {r(*span(value))})", function)

    def statements(self, node, source, function):
        first = {"CompoundStmt": 0, "IfStmt": 1, "ForStmt": -1}[node["kind"]]
        for part in node.get("inner", [])[first:]:
            kind = part.get("kind", "")
            empty_return = kind == "ReturnStmt" and not part.get("inner")
            if span(part) and ("Expr" in kind or kind.endswith("Operator") or kind == "ExprWithCleanups" or empty_return):
                begin, end = span(part)[0], source.text.index(";", span(part)[1]) + 1
                source.add(begin, end, "statement", ["removed"], lambda n, r, b=begin, e=end:
                           f"{{ if (!tuina::mutation::is({n})) {{ {r(b, e)} }} }}", function)


def write_mutants():
    paths = sorted(p for p in (os.path.relpath(p, ROOT) for p in glob.glob(f"{ROOT}/tuina/{ROOM}/*.[ch]pp")))
    sources = {path: Source(path) for path in paths}
    walk = Walk(sources)
    for unit in (p for p in paths if p.endswith(".cpp")):
        tree = subprocess.run(["clang++-14", *FLAGS, "-I.", "-fsyntax-only", "-Xclang", "-ast-dump=json", "-Xclang",
                               f"-ast-dump-filter=tuina::{ROOM}", unit], cwd=ROOT, check=True,
                              capture_output=True, text=True).stdout
        at, walk.file = 0, ""
        while tree[at:].strip():
            at += len(tree[at:]) - len(tree[at:].lstrip())
            node, used = json.JSONDecoder().raw_decode(tree[at:])
            walk.visit(node)
            at += used
    for path, source in sources.items():
        text = source.render(0, len(source.text))
        # What is chosen at run time is no constant expression; sizes stay constants.
        text = re.sub(r"\bconstexpr (?!std::size_t)((?:const )?[\w:<>, \[\]]+ ?\*? ?\w+\()", r"inline \1", text)
        text = re.sub(r"\bconstexpr (?!std::size_t)", "const ", text)
        text = text.replace("#include", '#include "tests/mutation/mutant.hpp"\n#include', 1)
        os.makedirs(os.path.dirname(f"{BUILD}/{path}"), exist_ok=True)
        if not os.path.exists(f"{BUILD}/{path}") or open(f"{BUILD}/{path}").read() != text:
            open(f"{BUILD}/{path}", "w").write(text)
    return [f"{BUILD}/{p}" for p in paths if p.endswith(".cpp")]


def build(units):
    beneath = ["core/random", "robot/arm_model", "robot/arm_table", "robot/clearance"]
    tests = sorted(glob.glob(f"{ROOT}/tests/{ROOM}/**/*_test.cpp", recursive=True)) + [
        f"{ROOT}/tests/main.cpp", f"{ROOT}/tests/allocation.cpp", *(f"{ROOT}/tuina/{b}.cpp" for b in beneath)]
    objects = [(f"{BUILD}/{os.path.relpath(u, BUILD if u in units else ROOT).replace('/', '_')}.o", u)
               for u in units + tests]
    flags = FLAGS + ["-O1", "-w", "-Wno-narrowing", "-D_GLIBCXX_ASSERTIONS", "-I", BUILD, "-I", ROOT]
    def compile(pair):
        return subprocess.run(["ccache", "g++", *flags, "-c", pair[1], "-o", pair[0]]).returncode
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        if any(pool.map(compile, objects)):
            sys.exit("the mutants do not compile")
    program = f"{BUILD}/test_{ROOM}"
    subprocess.run(["g++", *[o for o, _ in objects], "-lfmt", "-o", program], check=True)
    return program


def run(program, number, limit_s, test=None):
    """The test that failed, or none; a crash and a program that never ends are noticed too."""
    try:
        done = subprocess.run([program, "--abort-after=1", "--no-colors=1"] + ([f"--test-case={test}"] if test else []),
                              env={**os.environ, "TUINA_MUTANT": str(number)}, timeout=limit_s,
                              capture_output=True, text=True, errors="replace")
    except subprocess.TimeoutExpired:
        return "never ended"
    if done.returncode == 0:
        return None
    failed = re.search(r"TEST CASE:  (.*)", done.stdout)
    return failed.group(1).strip() if failed else "crashed"


def code_of(path):
    """Text without comments and spaces: what is in a comment makes no other mutant."""
    literal_or_comment = r'("(?:\\.|[^"\\\n])*")|//[^\n]*|/\*.*?\*/'
    text = re.sub(literal_or_comment, lambda m: m.group(1) or " ", open(path).read(), flags=re.DOTALL)
    return " ".join(text.split())


def sums_of(pattern):
    return {os.path.basename(path): hashlib.sha256(code_of(path).encode()).hexdigest() for path in glob.glob(pattern)}


def main():
    started = time.time()
    judged_path = f"{ROOT}/tests/mutation/{ROOM}_judged.txt"
    known = dict(reversed(line.split()) for line in open(judged_path)) if os.path.exists(judged_path) else {}
    sums = sums_of(f"{ROOT}/tuina/{ROOM}/*.?pp")
    changed = {name for name in sums if not CHANGED or known.get(name) != sums[name]}
    if not changed:
        print(f"no file of {ROOM} has changed since its mutants were judged")
        return
    program = build(write_mutants())
    count = collections.Counter()
    for m in mutants:
        name = f"{m['file']} {m['function']}: {m['what']}"
        count[name] += 1
        m["name"] = name if count[name] == 1 else f"{name} [{count[name]}]"
    before = time.time()
    if run(program, -1, 600):
        sys.exit("the tests fail without any mutant")
    limit_s = 10 * (time.time() - before) + 1
    built_s = time.time() - started

    digest = hashlib.sha256(b"".join(open(p, "rb").read() for p in sorted(
        glob.glob(f"{BUILD}/tuina/{ROOM}/*") + glob.glob(f"{ROOT}/tests/{ROOM}/**/*.?pp", recursive=True) +
        glob.glob(f"{ROOT}/tests/mutation/*.hpp")))).hexdigest()
    cache_path = f"{BUILD}/noticed.json"
    cache = json.load(open(cache_path)) if os.path.exists(cache_path) else {}  # name: [digest, the test]

    def judge(i):
        judged, hint = cache.get(mutants[i]["name"], ["", None])
        if judged == digest:
            return hint
        # The test that noticed it last time is asked first. Commas would part names of tests.
        if hint and hint not in ("crashed", "never ended") and run(program, i, limit_s, hint.replace(",", "?")):
            return hint
        return run(program, i, limit_s)
    chosen = [i for i, m in enumerate(mutants) if ONLY in ("", m["file"]) and m["file"] in changed]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(judge, chosen))
    judged = [mutants[i] for i in chosen]
    noticed = {m["name"]: r for m, r in zip(judged, results)}
    json.dump({**cache, **{name: [digest, r] for name, r in noticed.items()}}, open(cache_path, "w"), indent=1)

    families = collections.Counter(m["family"] for m in judged)
    lost = collections.Counter(m["family"] for m, r in zip(judged, results) if r is None)
    for family, all_of in sorted(families.items()):
        print(f"{family:12} {all_of:5} mutants, {all_of - lost[family]:5} noticed")
    survivors = {name for name, result in noticed.items() if result is None}
    print(f"{len(judged)} mutants, {len(judged) - len(survivors)} noticed; built in {built_s:.0f} s, "
          f"judged in {time.time() - started - built_s:.0f} s")

    faults, named = [], set()
    for number, line in enumerate(open(f"{ROOT}/tests/mutation/{ROOM}_survivors.txt"), 1):
        if not line.strip() or line.startswith("//") or not line.startswith(ONLY) or line.split()[0] not in changed:
            continue
        pattern, _, reason = line.strip().partition(" -- ")
        # `*` stands for anything; brackets are themselves.
        found = set(fnmatch.filter(noticed, pattern.strip().replace("[", "[[]")))
        if not reason.strip():
            faults.append(f"line {number} names no reason: {line.strip()}")
        if not found:
            faults.append(f"line {number} names no mutant: {pattern}")
        faults += [f"line {number} is noticed by now: {name}" for name in sorted(found - survivors)]
        named |= found
    faults += [f"nothing notices: {name}" for name in noticed if name in survivors - named]
    print("\n".join(faults), end="\n" if faults else "")
    if not faults:
        judged_now = {ONLY} if ONLY else changed
        known = {name: sums[name] if name in judged_now else known[name] for name in sums
                 if name in judged_now or name in known}
        with open(judged_path, "w") as file:
            file.writelines(f"{known[name]} {name}\n" for name in sorted(known))
    sys.exit(1 if faults else 0)


main()
