"""Hostile requests to ``canon serve``: broken HTTP, slow and deaf clients, other sites in a browser, names of files."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

from .count import Count
from .service import _family, _port, still_running

CLAIM = json.dumps({"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "1"}).encode()
JSON = b"Content-Type: application/json\r\n"
HOST = b"Host: localhost\r\n"


def _post(
    body: bytes = CLAIM, *, path: bytes = b"/check", head: bytes = HOST + JSON, length: bytes | None = None
) -> bytes:
    said = str(len(body)).encode() if length is None else length
    return b"POST " + path + b" HTTP/1.1\r\n" + head + b"Content-Length: " + said + b"\r\n\r\n" + body


def _get(path: bytes = b"/health", head: bytes = HOST, version: bytes = b"1.1") -> bytes:
    return b"GET " + path + b" HTTP/" + version + b"\r\n" + head + b"\r\n"


CHUNKED = HOST + JSON + b"Transfer-Encoding: chunked\r\n"
ATTACKS: dict[str, tuple[bytes, tuple[int, ...]]] = {
    "a claim": (_post(), (200,)),
    "another site's name": (_get(head=b"Host: evil.example\r\n"), (421,)),
    "another site's name that begins like ours": (_get(head=b"Host: localhost.evil.example\r\n"), (421,)),
    "another site's name with a port": (_get(head=b"Host: evil.example:8000\r\n"), (421,)),
    "an address of this machine that is none of the names": (_get(head=b"Host: 0.0.0.0\r\n"), (421,)),
    "no name": (_get(head=b""), (400, 421)),
    "an empty name": (_get(head=b"Host: \r\n"), (400, 421)),
    "two names": (_get(head=b"Host: localhost\r\nHost: evil.example\r\n"), (400, 421)),
    "a name with a user": (_get(head=b"Host: localhost@evil.example\r\n"), (400, 421)),
    "a name in the request line": (_get(b"http://evil.example/health"), (400, 404, 421)),
    "a form of another site": (
        _post(head=HOST + b"Origin: http://evil.example\r\nContent-Type: text/plain\r\n"), (415, 403)),
    "a form's own type": (_post(head=HOST + b"Content-Type: application/x-www-form-urlencoded\r\n"), (415, 403)),
    "several types": (_post(head=HOST + b"Content-Type: text/plain, application/json\r\n"), (415,)),
    "a question before": (b"OPTIONS /check HTTP/1.1\r\n" + HOST + b"Origin: http://evil.example\r\n"
                          b"Access-Control-Request-Method: POST\r\nAccess-Control-Request-Headers: content-type\r\n"
                          b"\r\n",
                          (405, 403)),
    "another site asks with JSON": (_post(head=HOST + JSON + b"Origin: http://evil.example\r\n"), (200, 403)),
    "a site of nobody": (_post(head=HOST + JSON + b"Origin: null\r\n"), (200, 403)),
    "a path upwards": (_get(b"/../../etc/passwd"), (404,)),
    "a path upwards, in signs": (_get(b"/%2e%2e/%2e%2e/etc/passwd"), (404,)),
    "a path upwards, twice in signs": (_get(b"/%252e%252e%252fetc%252fpasswd"), (404,)),
    "a path with nothing in it": (_get(b"/page.js%00.html"), (404,)),
    "a path of no text": (_get(b"/\xff\xfe"), (400, 404)),
    "a path of no text, in signs": (_get(b"/%ff%fe"), (400, 404)),
    "a path with signs of a terminal": (_get(b"/%1b%5b2J%0a"), (404,)),
    "a long path": (_get(b"/" + b"a" * 12_000), (400, 404, 414)),
    "a very long path": (_get(b"/" + b"a" * 200_000), (400, 414, 431)),
    "a long header": (_get(head=HOST + b"X: " + b"a" * 60_000 + b"\r\n"), (200, 400, 431)),
    "many headers": (_get(head=HOST + b"".join(b"X%d: a\r\n" % k for k in range(3_000))), (200, 400, 431)),
    "a folded header": (_get(head=HOST + b"X: a\r\n b\r\n"), (200, 400)),
    "a header without a name": (_get(head=HOST + b": a\r\n"), (400,)),
    "a header of no text": (_get(head=HOST + b"X: \xff\xfe\r\n"), (200, 400)),
    "HTTP 1.0": (_get(version=b"1.0"), (200,)),
    "HTTP 1.0 without a name": (_get(head=b"", version=b"1.0"), (400, 421)),
    "HTTP 9.9": (_get(version=b"9.9"), (200, 400, 505)),
    "HTTP 2": (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", (400, 421, 505)),
    "HTTP 0.9": (b"GET /health\r\n\r\n", (400,)),
    "TLS": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(range(200)), (400,)),
    "noise": (bytes(range(256)) * 4 + b"\r\n\r\n", (400,)),
    "nothing but lines": (b"\r\n" * 5_000, (400, 0)),
    "a method of nobody": (b"BREW /check HTTP/1.1\r\n" + HOST + b"\r\n", (405,)),
    "another protocol": (
        _get(head=HOST + b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: x\r\n"),
        (200, 400, 404, 426)),
    "a tunnel": (b"CONNECT evil.example:443 HTTP/1.1\r\nHost: evil.example\r\n\r\n", (400, 404, 405, 421)),
    "a length of no number": (_post(length=b"abc"), (400, 413)),
    "a length below nothing": (_post(length=b"-1"), (400, 413)),
    "a length in signs of others": (_post(length="٣".encode()), (400, 413)),
    "a length without end": (_post(length=b"9" * 300), (400, 413)),
    "a length of terabytes": (_post(length=b"9999999999999"), (400, 413)),
    "two lengths": (_post(head=HOST + JSON + b"Content-Length: 3\r\n"), (400,)),
    "a length and pieces": (_post(head=CHUNKED), (200, 400, 408)),
    "pieces": (b"POST /check HTTP/1.1\r\n" + CHUNKED + b"\r\n%x\r\n" % len(CLAIM) + CLAIM + b"\r\n0\r\n\r\n", (200,)),
    "pieces of no length": (b"POST /check HTTP/1.1\r\n" + CHUNKED + b"\r\nzz\r\nabc\r\n0\r\n\r\n", (400,)),
    "pieces of any length": (b"POST /check HTTP/1.1\r\n" + CHUNKED + b"\r\nffffffffffffffffff\r\nabc\r\n", (400, 408)),
    "pieces with words": (
        b"POST /check HTTP/1.1\r\n" + CHUNKED + b"\r\n1;" + b"x" * 100_000 + b"\r\n1\r\n0\r\n\r\n", (400,)),
    "many pieces beyond the limit": (
        b"POST /check HTTP/1.1\r\n" + CHUNKED + b"\r\n" + (b"1000\r\n" + b" " * 4096 + b"\r\n") * 100
                                     + b"0\r\n\r\n", (413,)),
    "packed": (_post(head=HOST + JSON + b"Content-Encoding: gzip\r\n",
        body=b"\x1f\x8b\x08\x00" + b"\x00" * 50), (400, 415)),
    "one behind the other": (_get() * 20, (200,)),
    "one hidden in the other": (_post(b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n"), (400,)),
    "no JSON": (_post(b"{" * 5_000), (400,)),
    "deep JSON": (_post(b"[" * 100_000), (400,)),
    "wide JSON": (_post(b"[" + b"1," * 100_000 + b"1]"), (400, 413)),
    "numbers without end": (_post(b"9" * 200_000), (400,)),
    "no text": (_post(b"\xff\xfe\xfd"), (400,)),
    "no numbers of JSON": (_post(b'[{"id": "a", "kind": "equality-only", "lhs": NaN, "rhs": Infinity}]'), (200, 400)),
    "the same key twice": (_post(b'{"id": "a", "id": "b", "kind": "equality-only", "lhs": "1", "rhs": "2"}'),
        (200, 400)),
    "half a pair": (_post(b'{"id": "\\ud800", "kind": "equality-only", "lhs": "\\udfff", "rhs": "1"}'), (200, 400)),
    "a text that is no text": (_post(b'{"text": {"a": []}, "q": 5}', path=b"/read"), (200, 400, 422)),
    "a text with markup": (_post(b'{"text": "<script>alert(1)</script>", "q": ["<b>"]}', path=b"/read"), (200, 400)),
    "an empty body": (_post(b""), (400,)),
    "a body that does not come": (_post(length=b"50"), (0, 400, 408)),
}  # fmt: skip
"""What is sent, and the status that may come back; 0 where the connection is closed without one."""

AT_ONCE = 16
"""Requests that are tried at the same time."""
MEANWHILE = 40
"""Connections that are held open and say one byte now and then, or never read, while the others are tried."""


def hostile_requests(count: int, folder: Path, seed: int = 1) -> Count:
    """Send ``count`` hostile requests to a service; ask it in between whether it is well."""
    found, draw = Count("hostile requests to canon serve"), random.Random(seed)
    command = [
        sys.executable,
        "-P",
        "-m",
        "canon",
        "serve",
        "--port",
        "0",
        "--budget",
        "2",
        "--rate",
        "1000000",
    ]
    outside = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with (folder / "log").open("w+b") as log:
        service = subprocess.Popen(command, stderr=log, cwd=folder, env=outside)
        try:
            port = _port(folder / "log")
            _send_all(found, port, count, draw)
        finally:
            family = _family(service.pid)
            service.send_signal(signal.SIGTERM)
            status = service.wait(60)
    left = still_running(family)
    found.add(
        "left running" if left or status else "ended by a signal, nothing left", f"{left}, status {status}"
    )
    said = (folder / "log").read_text("utf-8", "replace")
    if "Traceback" in said:
        found.add("traceback", f"in the log of the service: {said[said.index('Traceback') :][:3000]}")
    if "\x1b" in said or not all(line.startswith("{") for line in said.splitlines()):
        found.add("false line", "in the log of the service")
    if (folder / "owned").exists():
        found.add("code run", "a file was written")
    return found


def _send_all(found: Count, port: int, count: int, draw: random.Random) -> None:
    slow = [socket.create_connection(("127.0.0.1", port), 30) for _ in range(MEANWHILE)]
    for k, each in enumerate(slow):
        each.sendall(b"POST /check HTTP/1.1\r\nHost: local" if k % 2 else _get(b"/page.js") * 50)
    with ThreadPoolExecutor(AT_ONCE) as threads:
        sent = [_drawn(number, draw) for number in range(count)]
        for (name, what, _), outcome in zip(
            sent, threads.map(lambda each: _outcome(port, *each[1:]), sent), strict=True
        ):
            found.add(outcome, f"{name}: {what[:200]!r}")
            if draw.random() < 0.3:
                with suppress(OSError):
                    draw.choice(slow).sendall(b"h")
            if draw.random() < 0.04 and _answer(port, _get())[0] != 200:
                found.add("lost", f"the service was not well after {name}")
    for each in slow:
        each.close()


def _drawn(number: int, draw: random.Random) -> tuple[str, bytes, tuple[int, ...]]:
    """Return the name of an attack, what is sent, and what may come back; each attack once, then any, also changed."""
    names = list(ATTACKS)
    name = names[number] if number < len(names) else draw.choice(names)
    sent, wanted = ATTACKS[name]
    if number >= len(names) and draw.random() < 0.3:
        return f"{name}, changed", _changed(sent, draw), ()
    return name, sent, wanted


def _changed(sent: bytes, draw: random.Random) -> bytes:
    made = bytearray(sent)
    for _ in range(draw.randint(1, 4)):
        made[draw.randrange(min(len(made), 300))] = draw.randrange(256)
    return bytes(made)


def _outcome(port: int, sent: bytes, wanted: tuple[int, ...]) -> str:
    status, answer = _answer(port, sent)
    if b"access-control-allow" in answer.lower() or b"root:" in answer:
        return "false line"
    if status >= 500 or (wanted and status not in wanted):
        return "wrong status" if status else "closed without a word"
    return f"status {status}" if status else "closed"


def _is_whole(answer: bytes) -> bool:
    head, ended, body = answer.partition(b"\r\n\r\n")
    length = re.search(rb"content-length: (\d+)", head.lower())
    return bool(ended and length and len(body) >= int(length[1]))


def _answer(port: int, sent: bytes) -> tuple[int, bytes]:
    """Return the status that comes back, 0 where none does, and all that is sent with it."""
    found = b""
    try:
        with socket.create_connection(("127.0.0.1", port), 60) as connection:
            with suppress(OSError):
                connection.sendall(sent)
            while not _is_whole(found) and (piece := connection.recv(100_000)):
                found += piece
    except OSError:
        pass
    words = found.split(b" ", 2)
    return (int(words[1]), found) if found.startswith(b"HTTP/") and len(words) > 1 else (0, found)
