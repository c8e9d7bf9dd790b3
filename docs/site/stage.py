#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lays the pages of docs/ out for mkdocs: stage.py FOLDER

The pages stay what a code host shows. In the copy README.md is the home page, files of code that a page links to have
a page each, and keys such as [thesis] are links into references.md. Notebooks are the pages that running them has left
in FOLDER/notebooks.
"""
import os, re, shutil, sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
KATEX = "/usr/share/javascript/katex"
ELSEWHERE = {"README.md": "index.md", "examples/README.md": "examples.md", "CONTRIBUTING.md": "contributing.md",
             "docs/README.md": "pages.md"}
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".h": "c", ".c": "c", ".py": "python", ".toml": "toml"}


def read(path):
    with open(f"{ROOT}/{path}", encoding="utf-8") as file:
        return file.read()


def outside_code(text, change):
    """The text with `change` made to all of it but headings, and blocks and spans of code."""
    parts = re.split(r"(^ *```.*?^ *```|^#+ .*?$|`[^`]*`)", text, flags=re.DOTALL | re.MULTILINE)
    return "".join(part if number % 2 else change(part) for number, part in enumerate(parts))


class Site:
    def __init__(self, folder):
        self.folder, self.pages = folder, folder + "/pages"
        keys = re.findall(r"^\| \[(\w+)\] \|", read("docs/references.md"), re.MULTILINE)
        self.key = re.compile(r"(?<![\w\])}>])\[(" + "|".join(keys) + r")\](?!\()")
        self.places = dict(ELSEWHERE)
        for name in os.listdir(f"{ROOT}/docs"):
            if name.endswith(".md"):
                self.places.setdefault(f"docs/{name}", name)
        for name in os.listdir(f"{ROOT}/notebooks"):
            if name.endswith(".ipynb"):
                self.places[f"notebooks/{name}"] = f"notebooks/{name.removesuffix('.ipynb')}.md"

    def text(self, source):
        if not source.endswith(".ipynb"):
            return read(source)
        with open(f"{self.folder}/{self.places[source]}", encoding="utf-8") as file:
            text = file.read().replace("![png]", "![what the cell above draws]")
        # Tables of pandas look like all others.
        return re.sub(r"<style scoped>.*?</style>\n", "", text, flags=re.DOTALL).replace(' border="1" class="dataframe"', "")

    def write(self, path, text):
        os.makedirs(os.path.dirname(f"{self.pages}/{path}"), exist_ok=True)
        with open(f"{self.pages}/{path}", "w", encoding="utf-8") as file:
            file.write(text)

    def place(self, path):
        """Where a file of the repository is on the site; code becomes a page with its text."""
        while os.path.isdir(f"{ROOT}/{path}") and not os.path.exists(f"{ROOT}/{path}/README.md"):
            path = os.path.dirname(path)  # of a folder without words of its own, the words about the one around it
        if os.path.isdir(f"{ROOT}/{path}"):
            path = os.path.normpath(f"{path}/README.md")
        if path in self.places or not os.path.isfile(f"{ROOT}/{path}"):
            return self.places.get(path, path)
        if path.startswith("docs/"):
            return path[len("docs/"):]
        self.places[path] = f"code/{path}.md"
        language = LANGUAGES.get(os.path.splitext(path)[1], "")
        self.write(self.places[path], f"# {path}\n\n```{language}\n{read(path)}\n```\n")
        return self.places[path]

    def page(self, source, target):
        def from_here(place):
            return os.path.relpath(place, os.path.dirname(target) or ".")

        def placed(link):
            path, mark, anchor = link.group(1).partition("#")
            if ":" in path or not path:
                return link.group(0)
            place = self.place(os.path.normpath(os.path.join(os.path.dirname(source), path)))
            return f"]({from_here(place)}{mark}{anchor})"

        def changed(text):
            text = re.sub(r"\]\(([^)\s]+)\)", placed, text)
            if target == "references.md":
                return re.sub(r"^\| \[(\w+)\] \|", r'| <span id="\1">[\1]</span> |', text, flags=re.MULTILINE)
            return self.key.sub(rf"[\[\1\]]({from_here('references.md')}#\1)", text)

        source_text = re.sub(r"^<!-- .*?-->\n", "", self.text(source), flags=re.DOTALL | re.MULTILINE)
        # A list may follow its sentence at once on a code host, here it needs an empty line between.
        text = re.sub(r"^(?![ >|#]|[-*] |\d+\. )(.+)\n(?=(?:[-*]|\d+\.) )", r"\1\n\n", source_text, flags=re.MULTILINE)
        self.write(target, outside_code(text, changed))

    def configure(self):
        """mkdocs.yml without the pages that do not exist. Gives the pages that it does not name."""
        lines, named = [], set()
        for line in read("docs/site/mkdocs.yml").splitlines():
            page = re.match(r"\s+- .*: ([\w/]+\.md)$", line)
            if page and page.group(1) not in self.places.values():
                print(f"not there yet, and left out of the site: {page.group(1)}", file=sys.stderr)
                continue
            named.update([page.group(1)] if page else [])
            lines.append(line)
        with open(f"{self.folder}/mkdocs.yml", "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        return sorted(set(self.places.values()) - named - {"reference/index.html"})

    def reference(self):
        """The first page of the reference of the headers, and what each room's namespace says: its header's words.
        A namespace without words has no page, and its functions would be on none."""
        rooms, namespaces = [], []
        for name in sorted(os.listdir(f"{ROOT}/tuina")):
            words = name.endswith(".hpp") and re.search(r"^/// Room (\w+): (.*)", read(f"tuina/{name}"), re.MULTILINE)
            if words:
                namespace = "tuina" if words.group(1) == "core" else f"tuina::{words.group(1)}"
                rooms.append(f'- @ref {namespace} "{words.group(1)}": {words.group(2)} `#include "tuina/{name}"`')
                namespaces.append(f"/// @namespace {namespace}\n/// Room {words.group(1)}: {words.group(2)}\n\n")
        with open(f"{self.folder}/reference.md", "w", encoding="utf-8") as file:
            file.write("# C++ reference\n\nWhat is meant for others, room by room:\n\n" + "\n".join(rooms) +
                       "\n\nHow to compile against them: [Install](../install.html#compile-against-it).\n")
        with open(f"{self.folder}/namespaces.dox", "w", encoding="utf-8") as file:
            file.writelines(namespaces)

    def build(self):
        shutil.rmtree(self.pages, ignore_errors=True)
        missing = self.configure()
        if missing:
            sys.exit(f"docs/site/mkdocs.yml: nav does not name {', '.join(missing)}")
        for source, target in sorted(self.places.items()):
            self.page(source, target)
        self.reference()
        for kind in ("figures", "pictures"):
            leave_out = shutil.ignore_patterns("*.cpp", "*.txt")
            shutil.copytree(f"{ROOT}/docs/{kind}", f"{self.pages}/{kind}", ignore=leave_out)
        for name in os.listdir(f"{self.folder}/notebooks"):
            if name.endswith("_files"):
                shutil.copytree(f"{self.folder}/notebooks/{name}", f"{self.pages}/notebooks/{name}")
        for name in ("site.css", "equations.js"):
            os.makedirs(f"{self.pages}/assets/katex", exist_ok=True)
            shutil.copy(f"{ROOT}/docs/site/{name}", f"{self.pages}/assets/{name}")
        for name in ("katex.min.css", "katex.min.js", "contrib/auto-render.js"):
            shutil.copy(f"{KATEX}/{name}", f"{self.pages}/assets/katex/")
        shutil.copytree(f"{KATEX}/fonts", f"{self.pages}/assets/katex/fonts")


Site(os.path.abspath(sys.argv[1])).build()
