# SPDX-License-Identifier: Apache-2.0
"""What nobody should ask of `tuina serve`: each is refused, changes nothing, and is one line of the audit log."""
import gzip, json, re, struct, subprocess, sys, tempfile, time
from serve_client import Page, Server, Socket

faults = []


def expect(what, found, wanted):
    if found != wanted:
        faults.append(f"{what}: {found!r} instead of {wanted!r}")


def same(state):
    """What a refusal must leave as it is."""
    return {key: state[key] for key in ("phase", "session", "operator", "operated", "paused", "outcome", "plans")}


def refused(server, page, what, act, wanted):
    """`act` gives `wanted`, leaves the state alone and adds one line to the audit log."""
    before, lines = same(page.state), len(server.audit())
    expect(what, act(), wanted)
    read_at = page.read_at
    page.until(lambda: page.read_at > read_at)
    expect(f"{what}: state", same(page.state), before)
    added = server.audit()[lines:]
    expect(f"{what}: lines in the audit log", [line["outcome"].startswith("refused") for line in added], [True])


def requests(server, cookie):
    here, there = f"127.0.0.1:{server.port}", "evil.example"
    for what, status, path, headers in [
            ("no host", 403, "/", {"Host": None, "Cookie": cookie}),
            ("another host", 403, "/", {"Host": there, "Cookie": cookie}),
            ("a name for this machine", 403, "/", {"Host": f"{there}:{server.port}", "Cookie": cookie}),
            ("a host without port", 403, "/", {"Host": "127.0.0.1", "Cookie": cookie}),
            ("another page's request", 403, "/api/map", {"Origin": f"http://{there}", "Cookie": cookie}),
            ("a page of no origin", 403, "/api/map", {"Origin": "null", "Cookie": cookie}),
            ("another scheme", 403, "/api/map", {"Origin": f"https://{here}", "Cookie": cookie}),
            ("nobody", 401, "/", {}),
            ("nobody at the sessions", 401, "/api/sessions", {}),
            ("another cookie", 401, "/", {"Cookie": cookie[:-1] + ("0" if cookie[-1] != "0" else "1")}),
            ("an empty cookie", 401, "/", {"Cookie": cookie.split("=")[0] + "="}),
            ("a used token", 401, f"/?token={server.token}", {}),
            ("a wrong token", 401, f"/?token={'0' * 64}", {}),
            ("an empty token", 401, "/?token=", {}),
            ("a way up", 404, "/sessions/../audit.log", {"Cookie": cookie}),
            ("a coded way up", 404, "/sessions/%2e%2e/audit.log", {"Cookie": cookie}),
            ("a doubly coded one", 404, "/sessions/%252e%252e/audit.log", {"Cookie": cookie}),
            ("a way up to a report", 404, "/sessions/../../report.html", {"Cookie": cookie}),
            ("the log", 404, "/audit.log", {"Cookie": cookie}),
            ("a session that is none", 404, "/sessions/9999/report.html", {"Cookie": cookie}),
            ("a report in no language", 404, "/sessions/0001/report.html?language=../../en", {"Cookie": cookie}),
            ("a session without number", 404, "/sessions/000x/report.html", {"Cookie": cookie}),
            ("a long name", 404, "/sessions/" + "9" * 3000 + "/report.html", {"Cookie": cookie}),
            ("another file of a session", 404, "/sessions/0001/consent.toml", {"Cookie": cookie})]:
        yield what, lambda path=path, headers=headers: server.ask(path, **headers)[0], status
    for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "HEAD"):
        yield method, lambda method=method: server.ask("/", method, Cookie=cookie)[0], 405
    yield "a huge body", lambda: server.ask("/", "POST", Cookie=cookie, Content_Length="1000000000")[0], 413
    for what, status, headers in [
            ("a socket without cookie", 401, {"Cookie": None}),
            ("a socket of another host", 403, {"Host": there}),
            ("a socket of another page", 403, {"Origin": f"http://{there}"}),
            ("a socket of no page", 403, {"Origin": None})]:
        yield what, lambda headers=headers: Page(server, cookie, **headers).status, status


def program(server, **headers):
    """A socket of another program, by the address that the terminal printed."""
    given = {"Sec-WebSocket-Protocol": "foxglove.sdk.v1", **headers}
    return Socket(server.port, given.pop("path", server.program_address.partition(str(server.port))[2]), **given)


def programs(server, cookie):
    for what, status, headers in [
            ("a program of another page", 403, {"Origin": "https://evil.example"}),
            ("a program of another host", 403, {"Host": f"evil.example:{server.port}"}),
            ("a program without token", 401, {"path": "/foxglove", "Cookie": cookie}),
            ("a program of another protocol", 400, {"Sec-WebSocket-Protocol": "foxglove.websocket.v2"}),
            ("a program without protocol", 400, {"Sec-WebSocket-Protocol": None})]:
        yield what, lambda headers=headers: program(server, **headers).status, status
    yield "a program that is none", lambda: server.ask("/foxglove?token=x", Cookie=cookie)[0], 405


def frames(socket):
    """Frames of a program that has come in: each is answered by why it is not followed."""
    def answer(frame):
        socket.send(frame, opcode=2 if isinstance(frame, bytes) else 1)
        while (message := socket.message())["op"] not in ("status", "serviceCallFailure"):
            pass
        return message["op"]

    for text in ["", "[]", "[" * 10000, '{"op":"fly"}', '{"op":"advertise","channels":[{"id":1}]}', '{"op":"subscribe"}',
                 '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}',
                 '{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}',
                 '{"op":"subscribe","subscriptions":' + json.dumps([{"id": i, "channelId": 1} for i in range(300)]) + "}",
                 '{"op":"unsubscribe","subscriptionIds":[5]}', b"", b"\1", b"\2\1", struct.pack("<BIII", 2, 1, 1, 2**32 - 1)]:
        yield f"frame {text[:50]!r}", lambda text=text: answer(text), "status"
    for service, request in [(0, b"{}"), (99, b"{}"), (1, b"[]"), (1, b'{"force_n":99}'), (1, b""), (4, b"{}"), (7, b"{}")]:
        call = struct.pack("<BIII", 2, service, 7, 4) + b"json" + request
        yield f"call of {service} {request}", lambda call=call: answer(call), "serviceCallFailure"


def messages(page, viewer, order):
    def outcome(text):
        page.replies.pop(0, None)
        page.send(text)
        page.until(lambda: 0 in page.replies)
        return "refused" if page.replies.get(0, {}).get("outcome", "done") != "done" else "done"

    for text in ["", "x", "[]", "null", "{}", "[" * 10000, '{"ask":"pause"}', '{"ask":"fly","sequence":9,"clock_s":1}',
                 '{"ask":"pause","sequence":-1,"clock_s":1}', '{"ask":"pause","sequence":9,"clock_s":1,"force_n":99}',
                 '{"ask":"set","key":"safety.force_ceiling_n","value":99}']:
        yield f"message {text[:60]}", lambda text=text: outcome(text), "refused"
    yield "an old ask", lambda: page.outcome("operate", clock_s=page.clock_s() - 1.0), "stale"
    yield "an ask of the future", lambda: page.outcome("operate", clock_s=page.clock_s() + 1.0), "stale"
    yield "a second operator", lambda: viewer.outcome("operate"), "taken"
    for ask in ("hold", "arm", "pause", "resume", "skip", "repeat", "softer", "firmer", "hand_over"):
        yield f"a viewer's {ask}", lambda ask=ask: viewer.outcome(ask), "viewer"
    yield "a viewer's start", lambda: viewer.outcome("start", order), "viewer"
    yield "arm without hold", lambda: page.outcome("arm"), "not_held"
    for ask in ("pause", "skip", "firmer"):
        yield f"{ask} of nothing", lambda ask=ask: page.outcome(ask), "no massage is running"
    for key, value in [("person", "/etc/passwd"), ("person", "phantom:medium\n"), ("programme", "../relax"),
                       ("programme", 7), ("intensity", 6), ("intensity", 2.5), ("seed", -1), ("seed", 10**30),
                       ("position", "standing"), ("answered_by", ""), ("answered_by", "x" * 1000),
                       ("answered_by", "   "), ("answered_by", " \u3000"), ("answered_by", "林" * 41),
                       ("answered_by", 'a"\nbleeding = "no'), ("answers", {}), ("answers", {"bleeding": "maybe"}),
                       ("force_ceiling_n", 90)]:
        def act(key=key, value=value):
            time.sleep(0.06)  # within twenty a second
            return page.outcome("start", {**order, key: value}).split(":")[0]
        yield f"start with {key} {value!r:.40}", act, {"force_ceiling_n": "order", "answers": "bleeding"}.get(key, key)
    area = {"name": "a", "corners": [[0, 0, 0]] * 3}
    yield "a viewer's change", lambda: viewer.outcome("change", {"no_go": [], "fixed": []}), "viewer"
    for what, change, wanted in [
            ("of nothing", {"no_go": [area], "fixed": []}, "no plan waits to be changed"),
            ("without points", {"no_go": []}, "order"), ("with a force", {"no_go": [], "fixed": [], "n": 99}, "order"),
            ("of 21 areas", {"no_go": [area] * 21, "fixed": []}, "no_go"),
            ("of a line", {"no_go": [{"name": "a", "corners": [[0, 0, 0]] * 2}], "fixed": []}, "no_go"),
            ("of 81 corners", {"no_go": [{"name": "a", "corners": [[0, 0, 0]] * 81}], "fixed": []}, "no_go"),
            ("far away", {"no_go": [], "fixed": [{"name": "GV4", "at": [0, 0, 1e9]}]}, "fixed"),
            ("in words", {"no_go": [], "fixed": [{"name": "GV4", "at": "here"}]}, "fixed"),
            ("without a name", {"no_go": [], "fixed": [{"name": "", "at": [0, 0, 0]}]}, "fixed")]:
        def act(change=change):
            time.sleep(0.06)
            return page.outcome("change", change).split(":")[0]
        yield f"change {what}", act, wanted


def files(server, cookie):
    """The page's own files: packed for who takes that, and not sent again to who has them."""
    def ask(**headers):
        """The answer, and how soon it was there, in ms: the soonest of five, since the machine has more to do."""
        took = []
        for _ in range(5):
            began = time.monotonic()
            answer = server.ask("/page.js", Cookie=cookie, **headers)
            took.append(1e3 * (time.monotonic() - began))
        return *answer, min(took)

    status, headers, whole, whole_ms = ask()
    if status != 200:
        return print("the page is not built: its files are not looked at")
    expect("a browser asks again", headers["Cache-Control"], "private, no-cache")
    _, packed_headers, packed, packed_ms = ask(Accept_Encoding="gzip, br")
    if packed_headers.get("Content-Encoding") == "gzip":
        expect("packed content", gzip.decompress(packed), whole)
    expect("not packed for who does not take it",
           "Content-Encoding" in server.ask("/page.js", Cookie=cookie, Accept_Encoding="gzip;q=0")[1], False)
    status, again, nothing, again_ms = ask(If_None_Match=headers["ETag"])
    expect("not changed", (status, nothing, again["ETag"]), (304, b"", headers["ETag"]))
    expect("another content", server.ask("/page.js", Cookie=cookie, If_None_Match='W/"0"')[0], 200)
    expect("not without cookie", server.ask("/page.js", If_None_Match=headers["ETag"])[0], 401)
    print(f"page.js: {len(whole)} bytes in {whole_ms:.1f} ms, packed {len(packed)} in {packed_ms:.1f} ms, "
          f"not changed in {again_ms:.1f} ms")


def flood(server, page, viewer):
    """A page that asks without end is refused; stop is heard all the same, and the log does not fill."""
    lines = len(server.audit())
    for _ in range(2000):
        viewer.ask("beat")
    expect("stop in a flood", viewer.outcome("stop"), "done")
    expect("a flood is refused", any("too_fast" in line["outcome"] for line in server.audit()[lines:]), True)
    expect("a flood fills the log", len(server.audit()) - lines < 400, True)
    expect("the other page goes on", page.outcome("hold"), "done")


def closed(server, cookie, what, send):
    page = Page(server, cookie)
    send(page)
    expect(f"{what}: closed", page.until(lambda: not page.open), True)


def memory_mb(server):
    with open(f"/proc/{server.process.pid}/status", encoding="ascii") as file:
        return int(re.search(r"VmHWM:\s+(\d+) kB", file.read())[1]) / 1000


def sends_without_end(link, content_bytes):
    """So much content of a message, until the other side hangs up; what it took of that."""
    sent, piece = 0, bytes(1 << 18)
    try:
        while sent < content_bytes:
            sent += link.send(piece[:content_bytes - sent])
    except OSError:
        pass
    return sent


def without_end(server, cookie):
    """Messages of 1 GB are not held: 1009, one line in the audit log each, and no memory worth naming."""
    with open(f"/proc/{server.process.pid}/clear_refs", "w", encoding="ascii") as file:
        file.write("5")  # the most memory so far begins anew
    before, content_bytes = memory_mb(server), 1 << 30
    for who, opcode in (("page", 1), ("page", 2), ("program", 2)):
        page = Page(server, cookie, beats=False) if who == "page" else None
        socket = page.socket if page else program(server)
        lines = len(server.audit())
        socket.link.sendall(bytes([0x80 | opcode, 0xff]) + struct.pack(">Q", content_bytes) + b"mask")
        sent = sends_without_end(socket.link, content_bytes)
        expect(f"a {who}'s message of 1 GB is cut off, after {sent} bytes", sent < content_bytes, True)
        if page:
            page.until(lambda: not page.open)
        else:
            try:
                while socket.message():
                    pass
            except OSError:
                pass
        expect(f"a {who}'s message of 1 GB: told", socket.closed_with, 1009)
        told = lambda: [line["outcome"] for line in server.audit()[lines:] if line["outcome"].startswith("refused")]
        end = time.monotonic() + 5
        while not told() and time.monotonic() < end:
            time.sleep(0.02)
        expect(f"a {who}'s message of 1 GB: lines", told(), ["refused: too much at once"])
    grown = memory_mb(server) - before
    print(f"three messages of 1 GB: the server's memory grew by {grown:.1f} MB at most")
    expect(f"memory for messages of 1 GB {grown} MB", grown < 10.0, True)


def main(binary):
    with tempfile.TemporaryDirectory() as folder:
        elsewhere = subprocess.run([binary, "serve", "--listen", "0.0.0.0", "--out", folder], capture_output=True)
        expect("another address", elsewhere.returncode, 1)
        server = Server(binary, folder)
        cookie = server.enter()
        page, viewer = Page(server, cookie), Page(server, cookie)
        questions = json.loads(server.ask("/api/choices", Cookie=cookie)[2])["questions"]
        order = {"person": "phantom:medium", "position": "sitting", "programme": "relax", "intensity": 3, "seed": 1,
                 "answered_by": "a test", "answers": {question["key"]: "no" for question in questions}}
        expect("operate", page.outcome("operate"), "done")
        page.until(lambda: page.state["operator"])
        asked = 0
        watcher = program(server)
        expect("a program comes in", (watcher.status, watcher.message()["op"]), (101, "serverInfo"))
        for what, act, wanted in [*requests(server, cookie), *programs(server, cookie), *frames(watcher),
                                  *messages(page, viewer, order)]:
            refused(server, page, what, act, wanted)
            asked += 1
        sequence = page.sequence
        refused(server, page, "a replayed ask", lambda: page.outcome("operate", sequence=sequence), "out_of_order")
        for _ in range(6):
            server.ask(f"/?token={'1' * 64}")
        refused(server, page, "a sixth wrong token", lambda: server.ask(f"/?token={'1' * 64}")[0], 429)
        files(server, cookie)
        flood(server, page, viewer)
        closed(server, cookie, "a huge message", lambda page: page.send("x" * 70000))
        without_end(server, cookie)
        closed(server, cookie, "a binary message", lambda page: page.send("x", opcode=2))
        watcher.send(b"x" * 70000, opcode=2)
        expect("a huge frame: closed", page.until(lambda: server.audit()[-1]["what"] == "go"), True)
        expect("the server is still there", server.ask("/api/choices", Cookie=cookie)[0], 200)
        expect("nothing was begun", [line["what"] for line in server.audit() if line["what"] == "start"
                                     and line["outcome"] == "done"], [])
        expect("exit", server.end(), 0)
        expect("audit check", subprocess.run([binary, "audit", "check", f"{folder}/audit.log"],
                                             capture_output=True).returncode, 0)
    print(f"{asked + 2} hostile asks", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
