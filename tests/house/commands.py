#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the commands of the documents to the programs: commands.py TUINA [--run [DOCUMENT..]]

Every command of tuina, in a block or in backticks, is parsed by the program itself: with --help it reads all words
and does nothing. Of programs of the build the names are checked. Commands of other programs are only listed.

With --run every block of shell is run, too. A page has a folder of its own, as its reader would. What stands above a
block is not shown to a reader:
  <!-- file: NAME -->     the block below lies in the folder as that file
  <!-- before: COMMAND -->  is run before the block, for what a reader brings along
  <!-- ends with: CODE -->  what a command of it shows, other than 0
  <!-- not run: WHY -->  it is long, or needs somebody's devices

`tuina --help` parses all options and their values first; required ones may be missing, since a text may name part of
a command.
"""
import itertools, json, os, re, shlex, signal, subprocess, sys, tempfile, time
from concurrent.futures import ThreadPoolExecutor

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.append(f"{ROOT}/docs/site")
from made_tables import COMMENT, parts  # noqa: E402
TUINA = os.path.abspath(sys.argv[1])
MAX_BLOCK_S = 900
SHELL_ONLY = re.compile(r"^(for|done|wait|export|cd|time|python3|#|with\b)")


def read(path):
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        return file.read()


def documents():
    yield from ("README.md", "CONTRIBUTING.md", "examples/README.md")
    yield from sorted(f"docs/{name}" for name in os.listdir(f"{ROOT}/docs") if name.endswith(".md"))


def blocks(text):
    """(language, marks above, lines) of the blocks of code, joined where a line ends with a backslash."""
    marks = r"(?:^ *<!-- (?:file|before|ends with|not run): (?:(?!-->).)*-->\n+)*"
    block = re.compile(rf"({marks}) *```(\S*)\n(.*?)^ *```", re.DOTALL | re.MULTILINE)
    for above, language, body in block.findall(text):
        found = re.findall(r"<!-- (file|before|ends with|not run): ((?:(?!-->).)*?)\s*-->", above, re.DOTALL)
        yield language, dict(found), [line.strip() for line in body.replace("\\\n", " ").splitlines()]


def simple(line):
    """The simple commands of a line of shell, without what only the shell reads."""
    line = re.sub(r"\s#\s.*|^\s*#.*", "", line)
    for command in re.split(r"&&|\|\||[;|&](?=\s|$)", line.removesuffix("; do")):
        command = re.sub(r"\s+\d?>\S+|\s*:::.*", "", command).strip()
        if command:
            yield re.sub(r"^(?:do\s+|time\s+|taskset -c \d+ |[A-Z_]+=\S+ )*", "", command)


def commands(text):
    """(command, from a block) of a document; those that make its tables stand in comments."""
    for comment in re.findall(COMMENT, text, re.DOTALL):
        yield from ((command, True) for line in parts(comment)[0] for command in simple(line))
    for language, _, lines in blocks(text):
        if language in ("sh", "bash"):
            for line in lines:
                yield from ((command, True) for command in simple(line))
    for span in re.findall(r"`([^`]+)`", re.sub(r"^ *```.*?^ *```", "", text, flags=re.DOTALL | re.MULTILINE)):
        span = " ".join(span.split())
        if re.match(r"(tuina|\./run|build/release/|ctest|-{1,2}[a-z])", span):
            yield from ((command, False) for command in simple(span))


def variants(word):
    """A word as somebody would type it: of `a|b` each, and a value for a name in capitals or of the shell."""
    for one in word.split("|"):
        one = re.sub(r"\$\w+|\{\}|(?<![\w./-])[A-Z]$", "1", one)
        yield re.sub(r"^(\d|K)/N$", "1/2", one)


def typed(command):
    """The command lines that a written one stands for."""
    words = shlex.split(command.replace("[", "").replace("]", "").replace("...", ""))
    return [list(words) for words in itertools.product(*(list(variants(word)) for word in words))]


def parsed(words, from_block):
    # Not at the end: an option without its value would take it for one, and the command would be done.
    told = subprocess.run([TUINA, *words[:1], "--help", *words[1:]], capture_output=True, text=True, timeout=30)
    # In a text the last option may stand for itself, without a value.
    named = not from_block and words and words[-1].startswith("--") and "missing" in told.stderr
    return told.stderr.strip() if told.returncode and not named else ""


def known():
    """Names that the build, ./run and the presets have."""
    tests = read("tests/CMakeLists.txt") + read("tests/CMakeLists.txt").replace("tuina_tests(", "test_")
    more = "".join(read(path) for path in ("examples/CMakeLists.txt", "tests/fuzz/CMakeLists.txt")
                   if os.path.exists(f"{ROOT}/{path}"))
    return tests + more, set(re.findall(r"^  ([a-z]+)\)$", read("run"), re.MULTILINE))


def run_verb(words, verbs, from_block):
    """What is wrong with `./run words`."""
    if not words:
        return ""
    if words[0] not in verbs:
        return f"./run has no {words[0]}"
    if words[0] in ("massage", "serve"):
        return parsed(words, from_block)
    presets = {preset["name"] for preset in json.loads(read("CMakePresets.json"))["configurePresets"]}
    for word in words[1:]:
        told = word in presets or word in ("ROOM", "FILE", "PRESET", "PAGE", "--check", "--numbers", "changed", "short") or word in read("tests/CMakeLists.txt")
        if not told and not os.path.exists(f"{ROOT}/tuina/{word}"):
            return f"./run {words[0]} has nothing called {word}"
    return ""


def judge(command, from_block, names, verbs, options):
    """What is wrong with a command; None where it is of another program."""
    try:
        lines = typed(command)
    except ValueError as error:
        return str(error)
    for words in lines:
        program = words[0] if words else ""
        if program.startswith("-"):
            wrong = "" if program.split("=")[0] in options else "no verb has this option"
        elif program == "./run":
            wrong = run_verb(words[1:], verbs, from_block)
        elif program in ("tuina", "build/release/tuina"):
            wrong = parsed(words[1:], from_block)
        elif program.startswith("build/release/"):
            wrong = "" if os.path.basename(program) in names else "is not built"
        else:
            return None
        if wrong:
            return wrong
    return ""


def all_options():
    """Options of every verb, as the manual page has them, and those of ./run."""
    pages = [subprocess.run([os.path.dirname(TUINA) + "/" + program, "manual"], capture_output=True, text=True).stdout
             for program in ("tuina", "tuina-evaluate")]
    text = "".join(pages).replace("\\-", "-")
    return set(re.findall(r"--[a-z][a-z0-9-]*", text)) | {"--check", "--numbers", "--help", "--version"}


def check():
    names, verbs = known()
    options = all_options()
    written = {}
    faults, other = [], {}
    for document in documents():
        text = read(document)
        if len(re.findall(COMMENT, text, re.DOTALL)) != len(re.findall("<!-- end -->", text)):
            faults.append(f"{document}: comments with a command and `<!-- end -->` do not come in pairs")
        for command, from_block in commands(text):
            written.setdefault(command, (document, from_block))
        if document != "docs/python.md" and any(language == "python" for language, *_ in blocks(text)):
            faults.append(f"{document}: a block of Python that no test runs; docs/python.md is where they are run")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda item: judge(item[0], item[1][1], names, verbs, options), written.items()))
    for (command, (document, from_block)), wrong in zip(written.items(), found):
        if wrong:
            faults.append(f"{document}: `{command}`: {wrong}")
        elif wrong is None and from_block and not SHELL_ONLY.match(command):
            other[command] = document
    print(f"{len(written) - len(other)} commands parsed; of other programs, and not tried:")
    print("".join(f"  {document}: {command}\n" for command, document in other.items()), end="")
    return faults


def reader_folder(folder):
    """What lies there for a reader: the parts of the repository that pages name, and the programs."""
    for name in ("armlink", "config", "examples", "models"):
        os.symlink(f"{ROOT}/{name}", f"{folder}/{name}")
    for path in ("bin", "build/release", "docs/figures"):
        os.makedirs(f"{folder}/{path}")
    for path in ("bin/tuina", "build/release/tuina"):
        os.symlink(TUINA, f"{folder}/{path}")
    with open(f"{folder}/run", "w", encoding="utf-8") as file:
        file.write(f'#!/bin/sh\ncase $1 in massage | serve) exec {TUINA} "$@" ;; esac\n'
                   f'HOME={os.environ.get("HOME", "/")} exec {ROOT}/run "$@"\n')
    os.chmod(f"{folder}/run", 0o755)


def run_blocks(chosen):
    """Runs the blocks of shell; those of a page share a folder."""
    count, left_out, start = 0, [], time.monotonic()
    for document in documents():
        if chosen and document not in chosen:
            continue
        with tempfile.TemporaryDirectory() as folder:
            reader_folder(folder)
            for language, marks, lines in blocks(read(document)):
                if "file" in marks:
                    with open(f"{folder}/{marks['file']}", "w", encoding="utf-8") as file:
                        file.write("\n".join(lines) + "\n")
                elif language not in ("sh", "bash"):
                    continue
                elif "not run" in marks:
                    left_out.append(f"  {document}: {lines[0]}: {marks['not run']}")
                else:
                    count += 1
                    yield from run_block(document, marks, lines, folder)
    print(f"{count} blocks run in {time.monotonic() - start:.0f} s; not run:")
    print("\n".join(left_out))


def script_of(marks, lines):
    """The block as one script, which ends at its first fault. What a reader starts in the background has begun before
    they type the next line."""
    script = ["set -e", marks.get("before", "")]
    for line in lines:
        may_end = f" || [ $? = {marks['ends with']} ]" if "ends with" in marks else ""
        script.append(f"{line}\nsleep 3" if line.endswith("&") else re.sub(r"\s+#.*", "", line) + may_end)
    return "\n".join(script)


def run_block(document, marks, lines, folder):
    """What goes wrong; what a block leaves running ends with it."""
    start = time.monotonic()
    with tempfile.TemporaryFile("w+") as said:
        shell = subprocess.Popen(["bash", "-c", script_of(marks, lines)], cwd=folder, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=said, start_new_session=True,
                                 env={**os.environ, "HOME": folder, "XDG_DATA_HOME": folder,
                                      "PATH": f"{folder}/bin:{os.environ['PATH']}"})
        try:
            code = shell.wait(MAX_BLOCK_S)
        except subprocess.TimeoutExpired:
            code = f"nothing after {MAX_BLOCK_S} s"
        try:
            os.killpg(shell.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        shell.wait()
        print(f"{document}: {lines[0]}: {time.monotonic() - start:.1f} s", flush=True)
        said.seek(0)
        if code:
            yield f"{document}: `{lines[0]}` ends with {code}: {said.read().strip()[-300:]}"


all_faults = check()
if "--run" in sys.argv:
    all_faults += run_blocks(sys.argv[sys.argv.index("--run") + 1:])
print("\n".join(all_faults))
sys.exit(bool(all_faults))
