# SPDX-License-Identifier: Apache-2.0
"""A flood at the live page's port, from a process of its own: requests as fast as they are answered, a thousand
connections that say a byte now and then, and a page that announces a message of 1 GB and goes on sending it. Prints what
came of it as one JSON object when it is ended.
Usage: flood.py PORT COOKIE [requests,slow,message]"""
import json, os, signal, socket, struct, sys, threading, time
from serve_client import Socket

SLOW, ASKERS, MESSAGE_BYTES, EVERY_S = 1000, 8, 1 << 30, 3.0
ends = threading.Event()
told = {"requests": 0, "refused_connections": 0, "slow_connections": 0, "slow_closed": 0, "message_bytes": 0, "messages": 0}
counting = threading.Lock()


def count(what, by=1):
    with counting:
        told[what] += by


def asks(port):
    request = f"GET /api/choices HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()
    while not ends.is_set():
        try:
            with socket.create_connection(("127.0.0.1", port), 5) as link:
                link.sendall(request)
                count("requests" if link.recv(4096) else "refused_connections")
        except OSError:
            count("refused_connections")


def slow(port):
    links = []
    while not ends.is_set():
        while len(links) < SLOW and not ends.is_set():
            try:
                links.append(socket.create_connection(("127.0.0.1", port), 1))
                links[-1].sendall(b"GET / HTTP/1.1\r\nHost: 127.0")
                count("slow_connections")
            except OSError:
                break
        ends.wait(EVERY_S)
        left = []
        for link in links:
            try:
                link.sendall(b".")
                left.append(link)
            except OSError:
                count("slow_closed")
                link.close()
        links = left


def huge(port, cookie):
    own = {"Origin": f"http://127.0.0.1:{port}", "Cookie": cookie}
    piece = bytes(1 << 16)
    while not ends.is_set():
        try:
            page = Socket(port, "/live", **own)
            page.link.sendall(b"\x81\xff" + struct.pack(">Q", MESSAGE_BYTES) + os.urandom(4))
            count("messages")
            for _ in range(MESSAGE_BYTES // len(piece)):
                if ends.is_set():
                    break
                page.link.sendall(piece)
                count("message_bytes", len(piece))
        except (OSError, IndexError):
            ends.wait(0.5)


def main(port, cookie, kinds="requests,slow,message"):
    signal.signal(signal.SIGTERM, lambda *_: ends.set())
    began, port = time.monotonic(), int(port)
    for kind in kinds.split(","):
        for _ in range(ASKERS if kind == "requests" else 1):
            act, given = {"requests": (asks, (port,)), "slow": (slow, (port,)), "message": (huge, (port, cookie))}[kind]
            threading.Thread(target=act, args=given, daemon=True).start()
    while not ends.is_set():
        ends.wait(0.2)
    print(json.dumps({**told, "seconds": time.monotonic() - began}), flush=True)
    os._exit(0)  # threads that wait for a socket are not waited for


if __name__ == "__main__":
    main(*sys.argv[1:])
