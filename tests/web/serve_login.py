# SPDX-License-Identifier: Apache-2.0
"""A real browser comes to the live page by TLS and a password, and goes again.
Usage: serve_login.py TUINA PAGE_FOLDER; exit 77 where there is no browser or no page."""
import os, sys, tempfile
from browser import Tab, chromium
from serve_client import Server
import serve_tls

faults = []


def expect(what, holds):
    if not holds:
        faults.append(what)


def by_password(binary, folder, page_folder):
    """From another address: the form in the browser, a wrong password, the right one, the page by TLS, and out again."""
    files = serve_tls.Files(folder)
    serve_tls.passwords(binary, files)
    server = Server(binary, f"{folder}/network", "--page", page_folder, "--listen", serve_tls.ADDRESS, "--certificate", files.good,
                    "--password-file", files.path("password"), tls=serve_tls.client_of(files), at=serve_tls.ADDRESS)
    tab = Tab(390, 844, touch=True, flags=("--ignore-certificate-errors", f"--host-resolver-rules=MAP robot.test {serve_tls.ADDRESS}"))
    tab.call("Page.navigate", url=f"{server.origin}/")
    for password, wanted in (("not the password", "!!document.body?.textContent.includes('密碼不正確')"), (serve_tls.PASSWORD, "!!document.querySelector('#next')")):
        expect("the form", tab.until("!!document.querySelector('#password')"))
        tab.see("document.querySelector('#password').focus()")
        tab.call("Input.insertText", text=password)
        tab.key("Enter")
        expect(f"after {password}", tab.until(wanted))
    tab.until("!!document.querySelector('#leave_server')")
    expect("wider than the screen", tab.see("document.documentElement.scrollWidth <= innerWidth"))
    tab.touch("#leave_server")
    expect("out again", tab.until("!!document.querySelector('#password')"))
    expect(f"scripts complain {tab.errors}", not tab.errors)
    tab.close()
    expect("exit", server.end() == 0)


def main(binary, page_folder):
    for what, there in (("Chromium", chromium()), ("the built page", os.path.exists(f"{page_folder}/page.js"))):
        if not there:
            print(f"skipped: {what} is not on this machine")
            return 77
    with tempfile.TemporaryDirectory() as folder:
        by_password(binary, folder, page_folder)
    faults.extend(serve_tls.faults)
    print("a login in a browser", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
