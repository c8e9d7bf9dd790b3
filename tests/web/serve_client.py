# SPDX-License-Identifier: Apache-2.0
"""A server of `tuina serve` and pages of it, without a browser: plain HTTP and RFC 6455 over sockets."""
import atexit, base64, json, os, re, signal, socket, struct, subprocess, sys, threading, time


class Server:
    """`tuina serve --port 0`, or another verb with the live page, in a folder of its own; `address` is the line that
    it printed."""

    def __init__(self, binary, folder, *options, verb="serve", tls=None, at="127.0.0.1", port=0):
        """With `tls`, the context of a client of TLS, the server is reached by that at the address `at`."""
        self.folder, self.tls, self.at = folder, tls, at
        self.process = subprocess.Popen([binary, verb, "--port", str(port), "--out", folder, *options],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # whoever waits for the output of a test waits for its server, too
        self.address = self.process.stdout.readline().strip()
        self.host, self.token = re.fullmatch(r"https?://([a-z0-9.]+:\d+)/\?token=([0-9a-f]{64})", self.address).groups()
        self.origin, self.port = self.address.partition("/?")[0], int(self.host.partition(":")[2])
        heard = map(self.hear, self.process.stderr)
        self.program_address = next(filter(None, heard), None) if verb == "serve" else None
        threading.Thread(target=lambda: [*heard], daemon=True).start()

    @staticmethod
    def hear(line):
        """Tells on what the server says on stderr. The address of its door for other programs, where that is said."""
        sys.stderr.write(line)
        found = re.match(r"wss?://\S+", line)
        return found[0] if found else None

    def connect(self, seconds=60):
        link = socket.create_connection((self.at, self.port), seconds)
        return self.tls.wrap_socket(link, server_hostname=self.host.partition(":")[0]) if self.tls else link

    def ask(self, path="/", method="GET", body=b"", **headers):
        """Status, headers and content of one request; a header that is None is not sent."""
        given = {"Host": self.host, "Content-Length": str(len(body)) if body else None}
        given.update({name.replace("_", "-"): value for name, value in headers.items()})
        head = "".join(f"{name}: {value}\r\n" for name, value in given.items() if value is not None)
        with self.connect() as link:
            link.sendall(f"{method} {path} HTTP/1.1\r\n{head}\r\n".encode() + body)
            answer = b""
            # A server may wait for the rest of a body before it closes; the answer is whole before that.
            while not self.whole(answer) and (part := link.recv(65536)):
                answer += part
        top, _, content = answer.partition(b"\r\n\r\n")
        lines = top.decode("latin-1").split("\r\n")
        return int(lines[0].split()[1]), dict(line.split(": ", 1) for line in lines[1:]), content

    @staticmethod
    def whole(answer):
        top, end, content = answer.partition(b"\r\n\r\n")
        length = re.search(rb"Content-Length: (\d+)", top)
        return bool(end and (top.startswith(b"HTTP/1.1 304") or length and len(content) >= int(length[1])))

    def enter(self, token=None):
        """The cookie that a token is exchanged for; None when it is refused."""
        status, headers, _ = self.ask(f"/?token={token or self.token}")
        return headers["Set-Cookie"].split(";")[0] if status == 303 else None

    def audit(self):
        with open(f"{self.folder}/audit.log", encoding="utf-8") as file:
            return [json.loads(line) for line in file]

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60)
        return self.process.returncode


class Socket:
    """A WebSocket of RFC 6455; `status` is 101 where the other side agreed, `closed_with` the number with which it left."""

    def __init__(self, port, path, link=None, **headers):
        self.link = link or socket.create_connection(("127.0.0.1", port), 10)
        given = {"Host": f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade",
                 "Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode()}
        given.update(headers)
        head = "".join(f"{name}: {value}\r\n" for name, value in given.items() if value is not None)
        self.link.sendall(f"GET {path} HTTP/1.1\r\n{head}\r\n".encode())
        self.waiting, self.sending = b"", threading.Lock()
        while b"\r\n\r\n" not in self.waiting and (part := self.link.recv(4096)):
            self.waiting += part
        top, _, self.waiting = self.waiting.partition(b"\r\n\r\n")
        self.status, self.closed_with = int(top.split()[1]), None
        self.link.settimeout(None)

    def exactly(self, size):
        while len(self.waiting) < size:
            part = self.link.recv(65536)
            if not part:
                raise ConnectionError
            self.waiting += part
        taken, self.waiting = self.waiting[:size], self.waiting[size:]
        return taken

    def message(self):
        """The next text, read from JSON; other frames are passed over."""
        while True:
            first, size = self.exactly(2)
            if size == 126:
                size, = struct.unpack(">H", self.exactly(2))
            elif size == 127:
                size, = struct.unpack(">Q", self.exactly(8))
            content = self.exactly(size)
            if first & 15 == 9:
                self.send(content, opcode=10)
            if first & 15 == 8:
                self.closed_with = int.from_bytes(content[:2], "big")
                raise ConnectionError
            if first & 15 == 1:
                return json.loads(content)

    def send(self, text, opcode=1):
        content, mask = text if isinstance(text, bytes) else text.encode(), os.urandom(4)
        size = len(content)
        length = bytes([0x80 | size]) if size < 126 else \
            b"\xfe" + struct.pack(">H", size) if size < 65536 else b"\xff" + struct.pack(">Q", size)
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(content))
        with self.sending:
            self.link.sendall(bytes([0x80 | opcode]) + length + mask + masked)


class Page:
    """One open page: reads all the time, keeps the newest state, and beats like the real one."""

    def __init__(self, server, cookie, beats=True, **headers):
        own = {"Host": server.host, "Origin": server.origin, "Cookie": cookie}
        self.socket = Socket(server.port, "/live", server.connect(10), **{**own, **headers})
        self.status, self.link = self.socket.status, self.socket.link
        self.cookie = cookie
        self.state, self.live, self.replies, self.sequence, self.open = {}, [], {}, 0, self.status == 101
        self.read_at, self.counting = 0.0, threading.Lock()
        if self.open:
            self.reader = threading.Thread(target=self.read, daemon=True)
            self.reader.start()
            self.until(lambda: self.state)
        if self.open and beats:
            threading.Thread(target=self.beat, daemon=True).start()

    def read(self):
        try:
            while True:
                self.take(self.socket.message())
        except OSError:
            self.open = False

    def take(self, message):
        if message["channel"] == "state":
            self.state, self.read_at = message, time.monotonic()
        elif message["channel"] == "live":
            self.live.append(message)
        else:
            self.replies[message["sequence"]] = message

    def beat(self):
        while self.open:
            self.ask("beat")
            time.sleep(0.5)

    def clock_s(self):
        return self.state["clock_s"] + time.monotonic() - self.read_at

    def send(self, text, opcode=1):
        try:
            self.socket.send(text, opcode)
        except OSError:
            self.open = False

    def ask(self, ask, order=None, **changed):
        """Sends an ask with the next sequence number; `changed` replaces what it says of itself."""
        with self.counting:
            self.sequence += 1
            message = {"ask": ask, "sequence": self.sequence, "clock_s": self.clock_s()}
            if order is not None:
                message["order"] = order
            message.update(changed)
            self.send(json.dumps(message))  # a beat's thread must not send the next one first
        return message["sequence"]

    def outcome(self, ask, order=None, **changed):
        """The answer to an ask."""
        self.replies.pop(changed.get("sequence"), None)
        sequence = self.ask(ask, order, **changed)
        self.until(lambda: sequence in self.replies)
        return self.replies.get(sequence, {"outcome": "nothing"})["outcome"]

    def arm(self):
        """Holds the button for as long as it takes; once more where this machine was late."""
        for _ in range(3):
            self.outcome("hold")
            time.sleep(2.1)
            if (outcome := self.outcome("arm")) == "done":
                break
        return outcome

    def invitation(self, ask="invite_operator"):
        """An address that opens the page once more; with `invite` for a viewer."""
        sequence = self.ask(ask)
        self.until(lambda: sequence in self.replies)
        return self.replies[sequence]["address"]

    def until(self, holds, seconds=10.0):
        end = time.monotonic() + seconds
        while not holds() and time.monotonic() < end:
            time.sleep(0.01)
        return bool(holds())

    def close(self):
        self.open = False
        try:
            socket.socket.shutdown(self.link, socket.SHUT_RDWR)
        except OSError:
            pass  # the server was first
        self.reader.join()  # or it would read from whoever gets this number next
        self.link.close()
