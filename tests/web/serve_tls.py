# SPDX-License-Identifier: Apache-2.0
"""The live page for a network: what `tuina serve` refuses to begin with, who comes in by TLS and by a password, and who
does not. 127.0.0.2 stands for the network here: to the program it is another address than its own."""
import os, socket, ssl, stat, subprocess, sys, tempfile, time, urllib.parse, warnings
from serve_client import Page, Server, Socket

ADDRESS, PASSWORD, VIEWERS = "127.0.0.2", "eleven slow hands & 推拿", "twelve quiet eyes"
warnings.simplefilter("ignore", DeprecationWarning)  # of old TLS, which is asked for to be refused
faults, asked = [], 0


def expect(what, found, wanted=True):
    global asked
    asked += 1
    if found != wanted:
        faults.append(f"{what}: {found!r} instead of {wanted!r}")


class Files:
    """Certificates and keys, good and bad, of OpenSSL's own program."""

    def __init__(self, folder):
        self.folder = folder
        self.openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-subj", "/CN=tuina", "-days", "2",
                     "-addext", f"subjectAltName=DNS:robot.test,IP:{ADDRESS}", "-keyout", "key", "-out", "certificate")
        self.openssl("genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256", "-out", "other_key")
        self.openssl("pkcs8", "-topk8", "-in", "key", "-out", "locked_key", "-passout", "pass:locked")
        self.openssl("req", "-x509", "-key", "key", "-subj", "/CN=tuina", "-days", "2", "-out", "nameless_certificate")
        self.openssl("req", "-new", "-key", "key", "-subj", "/CN=tuina", "-addext", "subjectAltName=DNS:robot.test", "-out", "request")
        self.openssl("x509", "-req", "-in", "request", "-copy_extensions", "copy", "-signkey", "key", "-days", "-1", "-out", "old_certificate")
        self.good = self.joined("good.pem", "certificate", "key")

    def openssl(self, *words):
        subprocess.run(["openssl", *words], cwd=self.folder, check=True, capture_output=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def lines(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.readlines()

    def written(self, name, content, mode=0o600):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(content)
        os.chmod(self.path(name), mode)
        return self.path(name)

    def joined(self, name, *parts, mode=0o600):
        texts = []
        for part in parts:
            with open(self.path(part), encoding="utf-8") as file:
                texts.append(file.read())
        return self.written(name, "".join(texts), mode)


def client_of(files, newest=None):
    context = ssl.create_default_context(cafile=files.path("certificate"))
    if newest:
        context.set_ciphers("ALL:@SECLEVEL=0")  # or this side would refuse first
        context.minimum_version, context.maximum_version = ssl.TLSVersion.TLSv1, newest
    return context


def passwords(binary, files):
    def make(name, typed, *options):
        return subprocess.run([binary, "serve", "--make-password", files.path(name), *options], input=typed.encode(), capture_output=True).returncode

    expect("a short password", (make("none", "short\n"), os.path.exists(files.path("none"))), (1, False))
    expect("a password", (make("password", PASSWORD + "\n"), make("again", PASSWORD + "\n")), (0, 0))
    expect("viewers before operators", (make("none", VIEWERS + "\n", "--viewers"), os.path.exists(files.path("none"))), (2, False))
    expect("viewers by the operators' password", make("password", PASSWORD + "\n", "--viewers"), 1)
    expect("viewers", (make("password", VIEWERS + "\n", "--viewers"), len(files.lines("password"))), (0, 2))
    expect("a password that was taken for the other", make("password", VIEWERS + "\n"), 1)
    with open(files.path("password"), encoding="utf-8") as one, open(files.path("again"), encoding="utf-8") as other:
        first, second = one.read(), other.read()
    expect("its owner's alone", stat.S_IMODE(os.stat(files.path("password")).st_mode), 0o600)
    expect("it is not in the file", "slow" in first, False)
    expect("salt", first != second)


def refused_starts(binary, files, folder):
    good, password = files.good, files.path("password")
    joined = files.joined
    for what, code, words, options in [
            ("an address alone", 1, "--certificate", []),
            ("a certificate alone", 1, "--password-file", ["--certificate", good]),
            ("a password alone", 1, "--certificate", ["--password-file", password]),
            ("an address in words", 1, "in numbers", ["--listen", "robot.test", "--certificate", good, "--password-file", password]),
            ("an address of elsewhere", 3, "listened at", ["--listen", "192.0.2.1", "--certificate", good, "--password-file", password]),
            *[(what, 2, words, ["--certificate", file, "--password-file", password]) for what, words, file in [
                ("no file", "nowhere.pem", files.path("nowhere.pem")),
                ("a folder", "", folder),
                ("an empty file", "no certificate", files.written("empty.pem", "")),
                ("no certificate", "no certificate", joined("a.pem", "key")),
                ("no key", "no key", joined("b.pem", "certificate")),
                ("another's key", "not that of", joined("c.pem", "certificate", "other_key")),
                ("a locked key", "passphrase", joined("d.pem", "certificate", "locked_key")),
                ("an old certificate", "ended on", joined("e.pem", "old_certificate", "key")),
                ("a certificate for nobody", "no host", joined("f.pem", "nameless_certificate", "key")),
                ("a key for everybody", "chmod 600", joined("g.pem", "certificate", "key", mode=0o644))]],
            *[(what, 2, words, ["--certificate", good, "--password-file", file]) for what, words, file in [
                ("no password file", "nowhere", files.path("nowhere")),
                ("an empty one", "no password file", files.written("h", "")),
                ("a password as it is", "no password file", files.written("i", PASSWORD)),
                ("one of another cost", "no password file", files.written("j", "scrypt 2 8 1 " + "0" * 64 + " " + "0" * 64 + "\n")),
                ("one for everybody", "chmod 600", files.written("k", "x", 0o644))]]]:
        own = ["--listen", ADDRESS] if "--listen" not in options else []
        found = subprocess.run([binary, "serve", "--port", "0", "--out", f"{folder}/out", *own, *options], capture_output=True, timeout=60)
        said = found.stderr.decode()
        expect(f"{what}: exit and lines {said}", (found.returncode, found.stdout, said.count("\n") <= 2, words in said), (code, b"", True, True))


def versions(server, files):
    for newest, wanted in [(ssl.TLSVersion.TLSv1, False), (ssl.TLSVersion.TLSv1_1, False), (ssl.TLSVersion.TLSv1_2, True), (ssl.TLSVersion.TLSv1_3, True)]:
        try:
            with client_of(files, newest).wrap_socket(socket.create_connection((ADDRESS, server.port), 10), server_hostname=ADDRESS) as link:
                found = link.version() is not None
        except (ssl.SSLError, ConnectionError):
            found = False
        expect(f"at most {newest.name}", found, wanted)
    with socket.create_connection((ADDRESS, server.port), 10) as link:
        link.sendall(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
        answer = link.recv(4096)
        expect("HTTP is told to come by https", (answer.startswith(b"HTTP/1.1 400"), b"https" in answer), (True, True))
    with socket.create_connection((ADDRESS, server.port), 10) as link:
        link.sendall(os.urandom(2000))
        try:
            rest = b"".join(iter(lambda: link.recv(4096), b""))
        except ConnectionError:
            rest = b""
        expect("noise gets no answer but an alert", len(rest) < 16)


def log_in(server, password=PASSWORD, **headers):
    form = urllib.parse.urlencode({"password": password}).encode()
    return server.ask("/login", "POST", form, **{"Origin": server.origin, "Content_Type": "application/x-www-form-urlencoded", **headers})


def doors(server):
    here, there = server.host, "evil.example"
    status, headers, page = server.ask()
    expect("who is not known is asked for the password, in both languages",
           (status, b"Password" in page, "密碼".encode() in page, "script" in page.decode()), (401, True, True, False))
    expect("HSTS", headers["Strict-Transport-Security"], "max-age=31536000")
    for what, wanted, found in [
            ("sessions", 401, lambda: server.ask("/api/sessions")[0]),
            ("page.js", 401, lambda: server.ask("/page.js")[0]),
            ("a socket without cookie", 401, lambda: Page(server, "x=1").status),
            ("another host", 403, lambda: server.ask(Host=f"{there}:{server.port}")[0]),
            ("loopback's name", 403, lambda: server.ask(Host=f"localhost:{server.port}")[0]),
            ("a login of another page", 403, lambda: log_in(server, Origin=f"https://{there}")[0]),
            ("a login of http", 403, lambda: log_in(server, Origin=f"http://{here}")[0]),
            ("a login of no page", 403, lambda: log_in(server, Origin=None)[0]),
            ("a login by GET", 401, lambda: server.ask(f"/login?password={urllib.parse.quote(PASSWORD)}")[0]),
            ("a long login", 413, lambda: server.ask("/login", "POST", b"x" * 5000, Origin=server.origin)[0]),
            ("a login without end", 413, lambda: server.ask("/login", "POST", Origin=server.origin, Content_Length="1000000000")[0]),
            ("a leave of nobody", 405, lambda: server.ask("/logout", "POST", Origin=server.origin)[0])]:
        expect(what, found(), wanted)


def cookies(server):
    """Logs in, is recognised, leaves, and is not recognised any more."""
    status, headers, _ = log_in(server)
    expect("the password opens", (status, headers.get("Location")), (303, "/"))
    said = headers.get("Set-Cookie", "=; ")
    cookie = said.split(";")[0]
    expect("of whose cookie", [word in said for word in ("Secure", "HttpOnly", "SameSite=Strict", "Path=/")] + [said.startswith("__Host-")], [True] * 5)
    page, other = Page(server, cookie), Page(server, cookie, beats=False)
    expect("a socket", (page.status, page.outcome("operate"), page.outcome("stop")), (101, "done", "done"))
    expect("a leave that another page asks for", server.ask("/logout", "POST", Cookie=cookie, Origin="https://evil.example")[0], 403)
    expect("a leave", server.ask("/logout", "POST", Cookie=cookie, Origin=server.origin)[0], 303)
    expect("the cookie again", server.ask("/api/choices", Cookie=cookie)[0], 401)
    expect("a socket by it", Page(server, cookie).status, 401)
    expect("its page is closed", page.until(lambda: not page.open))
    read_at = other.read_at
    time.sleep(0.7)
    expect("a silent page of it hears nothing more", other.read_at, read_at)
    other.ask("operate")
    expect("and is closed when it speaks", other.until(lambda: not other.open))


def viewers(server):
    """Who comes by the viewers' password, or is invited to watch, sees everything, may stop, and nothing else."""
    status, headers, _ = log_in(server, VIEWERS)
    expect("the viewers' password opens", status, 303)
    cookie = headers.get("Set-Cookie", "=; ").split(";")[0]
    therapist = Page(server, server.enter())
    guest = Page(server, server.enter(therapist.invitation("invite").partition("=")[2]))
    for who, page in (("by password", Page(server, cookie)), ("by invitation", guest)):
        expect(f"a viewer {who} is told", (page.state["viewer"], page.state["operator"]), (True, False))
        for ask in ("operate", "invite", "invite_operator", "hold", "arm", "pause", "resume", "softer", "hand_over"):
            expect(f"a viewer {who}: {ask}", page.outcome(ask), "viewer")
        expect(f"a viewer {who}: start", page.outcome("start", {}), "viewer")
        expect(f"a viewer {who}: stop", page.outcome("stop"), "done")
        page.close()
    expect("a viewer sees", server.ask("/api/choices", Cookie=cookie)[0], 200)
    expect("who may take control is told", therapist.state["viewer"], False)
    expect("and may", therapist.outcome("operate"), "done")
    therapist.close()
    expect("the log has who came to watch", any(line["outcome"] == "done: to watch" for line in server.audit()))


def guesses(server):
    """Who guesses is slow after five, and so is who knows it; an invitation opens, and who is in stays in."""
    before = len(server.audit())
    page = Page(server, log_in(server)[1]["Set-Cookie"].split(";")[0])
    found = [log_in(server, f"{PASSWORD}{i}")[0] for i in range(7)]
    expect("seven guesses", found, [401] * 5 + [429] * 2)
    expect("the right one among guesses", log_in(server)[0], 429)
    expect("the page's STOP meanwhile", page.outcome("stop"), "done")
    expect("an invitation meanwhile", server.enter(page.invitation().partition("=")[2]) is not None)
    lines = [line["outcome"] for line in server.audit()[before:] if line["outcome"].startswith("refused")]
    expect("each is a line of the audit log", lines, ["refused: 401"] * 5 + ["refused: 429"] * 3)
    expect("that says from where", all(ADDRESS[:4] in line["who"] for line in server.audit()[before:] if line["outcome"].startswith("refused")))
    return page


def open_files(process):
    """What a process has open; what it closes meanwhile is left out."""
    found = set()
    for fd in os.listdir(f"/proc/{process.pid}/fd"):
        try:
            found.add(os.readlink(f"/proc/{process.pid}/fd/{fd}"))
        except FileNotFoundError:
            pass
    return found


def around(server, cookie):
    """The server behind the door hears nobody who comes another way."""
    sockets = open_files(server.process)
    with open("/proc/net/tcp", encoding="ascii") as file:
        rows = [line.split() for line in file][1:]
    ports = [int(row[1].partition(":")[2], 16) for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in sockets]
    inner = [port for port in ports if port != server.port]
    expect("one port behind the door", len(inner), 1)
    with socket.create_connection(("127.0.0.1", inner[0]), 10) as link:
        link.sendall(f"GET /api/choices HTTP/1.1\r\nHost: {server.host}\r\nCookie: {cookie}\r\n\r\n".encode())
        expect("nobody gets around it", link.recv(4096).split()[1], b"403")


def programs(server):
    path = server.program_address.partition(str(server.port))[2]
    expect("the address of programs", server.program_address.startswith("wss://robot.test:"))

    def status(path, **headers):
        given = {"Host": server.host, "Sec-WebSocket-Protocol": "foxglove.sdk.v1", **headers}
        return Socket(server.port, path, server.connect(), **given).status

    expect("a program", status(path), 101)
    expect("a program of a wrong token", status(path[:-1] + ("0" if path[-1] != "0" else "1")), 401)
    expect("a program of http", status(path, Origin=f"http://{server.host}"), 403)


def crowd(server, page):
    """More connections than there is room for, which say nothing: who is in stays in, who comes can come, and they go."""
    links = [socket.create_connection((ADDRESS, server.port), 10) for _ in range(300)]
    expect("STOP in a crowd", page.outcome("stop"), "done")
    expect("one more comes in", server.ask("/api/choices", Cookie=page.cookie)[0], 200)
    began = time.monotonic()
    links[-1].settimeout(20)
    expect("who does not shake hands is left", links[-1].recv(1), b"")
    expect("after ten seconds", 5.0 < time.monotonic() - began + 1.0 < 15.0)
    for link in links:
        link.close()


def main(binary):
    with tempfile.TemporaryDirectory() as folder:
        files = Files(folder)
        passwords(binary, files)
        refused_starts(binary, files, folder)
        os.makedirs(f"{folder}/out", exist_ok=True)
        server = Server(binary, f"{folder}/out", "--listen", ADDRESS, "--certificate", files.good, "--password-file", files.path("password"),
                        tls=client_of(files), at=ADDRESS)
        expect("the address is the certificate's", server.address.startswith("https://robot.test:"))
        versions(server, files)
        doors(server)
        cookies(server)
        viewers(server)
        page = guesses(server)
        around(server, page.cookie)
        programs(server)
        crowd(server, page)
        expect("the server is still there", page.outcome("stop"), "done")
        expect("exit", server.end(), 0)
        expect("audit check", subprocess.run([binary, "audit", "check", f"{folder}/out/audit.log"], capture_output=True).returncode, 0)
    print(f"{asked} asks over TLS", *faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
