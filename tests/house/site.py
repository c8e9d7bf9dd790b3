#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Looks at a built site: site.py FOLDER. Every link and anchor leads somewhere, and no page loads anything from elsewhere."""
import html.parser, os, sys, urllib.parse

LOADS = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("object", "data")}


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.loads, self.anchors = [], [], {""}
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag, name) == ("a", "name"):
                self.anchors.add(value)
            elif (tag, name) == ("a", "href"):
                self.links.append(value)
            elif (tag, name) in LOADS:
                self.loads.append(value)


folder = os.path.abspath(sys.argv[1])
# Doxygen's pages are its own affair; links to them are looked at.
paths = [f"{at}/{name}" for at, _, names in os.walk(folder) for name in names
         if name.endswith(".html") and not at.startswith(folder + "/reference") and name != "404.html"]
pages = {path: Page(path) for path in paths}
faults = []
for path, page in pages.items():
    for link in page.links + page.loads:
        url = urllib.parse.urlsplit(link)
        if url.scheme or url.netloc:
            if link in page.loads:
                faults.append(f"{path[len(folder) + 1:]}: loads {link}")
            continue
        target = os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(url.path))) if url.path else path
        target = target + "/index.html" if os.path.isdir(target) else target
        if not os.path.exists(target):
            faults.append(f"{path[len(folder) + 1:]}: the link to {link} leads nowhere")
        elif target in pages and urllib.parse.unquote(url.fragment) not in pages[target].anchors:
            faults.append(f"{path[len(folder) + 1:]}: {link}: there is no such place on that page")
print("\n".join(sorted(set(faults))) or f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links")
sys.exit(bool(faults))
