# SPDX-License-Identifier: Apache-2.0
"""Whatever the server says by a key can be said in Chinese: every key of a sentence in the sources, and every name that
stands in one, has its message, which uses no value that the sentence does not have. Usage: messages.py SOURCES"""
import json, pathlib, re, sys

# Where names come from that stand in sentences: the file, and what begins their list there.
NAMES = (("tuina/safety/names.cpp", "name_of(Cause"), ("tuina/control/arm_controller.cpp", "name_of(ContactFault"),
         ("tuina/session/live_command.hpp", "live_command_names"))


def keys_in(source):
    """The keys of sentences in a source, with how many values each has; None where that is not seen."""
    for at in re.finditer(r'(?:\bsentence|\bnote)\(\s*(?:\w+\s*\?\s*"(\w+)"\s*:\s*)?"(\w+)",\s*((?:"(?:[^"\\]|\\.)*"\s*)+)', source):
        values = len(re.findall(r"\{[^}]*\}", at[3]))
        # A path's layer puts the name of its path before the values.
        values += 1 if at[0].startswith("note") else 0
        yield from ((key, values) for key in at.groups()[:2] if key)
    for key in re.findall(r'(?:\.key = |\bkey = [^;]*?|\? )"(\w+)"', source) + re.findall(r'"((?:why|fault)_\w+)"', source):
        yield key, None


def said_in(source):
    """What a report says, with its values: the English is the key."""
    for literals in re.findall(r'\b(?:say|language)\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)', source):
        words = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', literals))
        yield words, len(re.findall(r"\{[^}]*\}", words))


def main(folder):
    root = pathlib.Path(folder)
    faults, keys = [], set()

    def each_once(pairs):
        once = dict(pairs)
        faults.extend(f"{key} is twice in a file of messages" for key in once if sum(key == other for other, _ in pairs) > 1)
        return once

    def messages(language):
        text = (root / f"page/messages/{language}.json").read_text(encoding="utf-8")
        return json.loads(text, object_pairs_hook=each_once)

    messages("en")
    chinese = messages("zh-Hant")
    for source in [*(root / "tuina").rglob("*.cpp"), *(root / "apps").rglob("*.[ch]pp")]:
        for key, values in keys_in(source.read_text(encoding="utf-8")):
            if not re.match(r"(note|why|by|sum|fault|stopped|changed?|not|remembered)_(?!.*said$)", key):
                continue
            keys.add(key)
            if key not in chinese:
                faults.append(f"{source.relative_to(root)}: {key} has no message in Chinese")
            elif values is not None and any(int(number) >= values for number in re.findall(r"\{(\d)\}", chinese[key])):
                faults.append(f"{source.relative_to(root)}: {key} has {values} values, and its message uses more")
    report = [*(root / "tuina/telemetry/report").glob("*.cpp"), root / "tuina/telemetry/plot/session_strip.cpp"]
    for source in report:
        for words, values in said_in(source.read_text(encoding="utf-8")):
            keys.add(words)
            message = chinese.get(words)
            if message is None or any(int(number) >= values for number in re.findall(r"\{(\d)\}", message)):
                faults.append(f"{source.relative_to(root)}: \"{words}\" has no message in Chinese, or one with other values")
    for file, begin in NAMES:
        names = re.findall(r'"([^"]+)"', re.search(re.escape(begin) + r"[^{]*\{(.*?)\};", (root / file).read_text(), re.S)[1])
        keys.update(names)
        faults += [f"{file}: {name} has no message in Chinese" for name in names if name not in chinese and name != "none"]
    # A technique is named, and said as what is done and what was done.
    table = (root / "tuina/core/technique.hpp").read_text()
    words = re.findall(r'\.(?:name|doing|did) = "([^"]+)"', table)
    keys.update(words)
    faults += [f"technique.hpp: {word} has no message in Chinese" for word in words if word not in chinese]
    if len(words) < 15:
        faults.append("technique.hpp: the words of techniques are not found")
    print(f"{len(keys)} keys and names", *faults, sep="\n")
    return 1 if faults or len(keys) < 180 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
