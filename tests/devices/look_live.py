#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Looks at the page of `tuina camera --live` as a browser does: look_live.py ERR_FILE PICTURE.png

Waits for its address in what the program said on stderr, and prints what came as JSON.
"""
import http.cookiejar, json, re, sys, time, urllib.error, urllib.request

said, picture = sys.argv[1:]
address = None
for _ in range(600):
    found = re.search(r"http://\S+", open(said).read())
    if found:
        address = found.group()
        break
    time.sleep(0.05)
page = address.split("/?")[0]


def status_of(path):
    try:
        return urllib.request.urlopen(page + path, timeout=5).status
    except urllib.error.HTTPError as refused:
        return refused.code


browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar()))
stranger = status_of("/picture.png")
html = browser.open(address, timeout=5).read().decode()
scripts = [browser.open(page + path, timeout=5).read() for path in re.findall(r'(?:src|href)="(/[^"]+)"', html)]
seen = []
for _ in range(200):
    try:
        told = browser.open(page + "/told", timeout=5).read().decode()
        seen.append(browser.open(page + "/picture.png", timeout=5).read())
    except urllib.error.HTTPError:  # no picture yet
        pass
    if len(set(seen)) >= 3:
        break
    time.sleep(0.05)
open(picture, "wb").write(seen[-1])
print(json.dumps({"stranger": stranger, "again": status_of("/?" + address.split("/?")[1]), "assets": len(scripts),
                  "told": told, "pictures": len(set(seen))}))
