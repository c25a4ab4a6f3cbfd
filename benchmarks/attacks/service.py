"""Load on ``canon serve``: 64 clients, one claim in twenty hostile, processes killed; every answer is looked at.

Each client has an address of its own, waits for its answer and thinks for a while, so that all together ask about
``ASKED`` claims a second. Half of the claims are new, half were asked by somebody before, as in a class.
"""

from __future__ import annotations

import asyncio
import json
import os
import random
import signal
import statistics
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from .count import Count

CLIENTS = 64
ASKED = 20.0
"""Claims a second of all clients together, if each is answered at once."""
HOSTILE = 0.05
KILLED_EVERY = 300
"""Answers after which a judging process is killed."""
BUDGET = 2.0
PATIENT = 120.0
"""Seconds after which an answer is lost."""

X = {"kind": "equality-only", "parameters": {"x": "real"}}
PENDULUM = {"kind": "euler-lagrange", "q": ["a"], "parameters": {"m": "positive", "g": "positive"}}
BRACKET = {"kind": "poisson-bracket", "q": ["q"], "p": ["p"]}
MAP = {"kind": "canonicity", "q": ["q"], "p": ["p"]}

HARMFUL = (
    {"lhs": "__import__('os').system('touch owned')"},
    {"lhs": "().__class__.__mro__[1].__subclasses__()"},
    {"lhs": "9**9**9"},
    {"lhs": "x*exp(exp(exp(exp(exp(10)))))"},
    {"lhs": "+".join(["x"] * 50_000)},
    {"lhs": "(" * 5_000 + "x"},
    {"lhs": "$" + "{" * 20_000 + "x"},
    {"lhs": "$" + "xt" * 15_000 + "$"},
    {"lhs": "*".join(f"(x + {i})" for i in range(900))},
    {"lhs": "(" + "+".join(f"x**{i}" for i in range(200)) + ")**500"},
    {"lhs": "(x + cos(x) + 1)**60*sin(x)**40", "rhs": "(x + cos(x) + 1)**60*(1 - cos(x)**2)**20 + x/7**90"},
    {"lhs": "Derivative(" * 8 + "exp(sin(x)**x)**x" + ", (x, 8))" * 8},
    {"lhs": "Max(x, Min(" * 15 + "x, 1" + "))" * 15},
    {"lhs": 5e300, "budget": 3600},
    {"lhs": ["x"], "\u202e": "\x1b[2J"},
)


def fresh(draw: random.Random) -> tuple[dict[str, object], str]:
    """Return a claim that was hardly asked before, and the verdict that it should have."""
    n, m, right = draw.randint(2, 10**6), draw.randint(2, 99), draw.random() < 0.7
    off = 0 if right else draw.choice((1, -1, 3))
    made = draw.choice(
        (
            {**X, "lhs": f"{n}*sin({m}*x)*cos({m}*x)", "rhs": f"{n}*sin({2 * m}*x)/2 + {off}"},
            {**X, "lhs": f"(x + {m})**2 - {n}", "rhs": f"x**2 + {2 * m}*x + {m * m - n + off}"},
            {**PENDULUM, "L": f"{n}*m*a_dot**2/2 - m*g*{m}*a", "claim": [f"{n}*a'' + {m + off}*g = 0"]},
            {**BRACKET, "pairs": [{"f": f"{n}*q**2", "g": f"p**2 + {m}", "value": f"{4 * n + off}*q*p"}]},
            {**MAP, "Q": [f"{n}*q + {m}*p"], "P": [f"{1 + off}*p/{n}"]},
        )
    )
    return made, "holds" if right else "fails"


def hostile(draw: random.Random) -> tuple[dict[str, object], str]:
    """Return a claim that should do harm."""
    return {"rhs": "x + 1", **X, **draw.choice(HARMFUL)}, "hostile"


def served_load(count: int, folder: Path, seed: int = 1) -> Count:
    """Ask a service ``count`` claims and count what came of them."""
    found = Count(f"claims asked of canon serve by {CLIENTS} clients")
    command = [sys.executable, "-P", "-m", "canon", "serve", "--port", "0", "--budget", str(BUDGET)]
    where = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    with (folder / "log").open("w+b") as log:
        service = subprocess.Popen([*command, "--rate", "100000"], stderr=log, cwd=folder, env=where)
        try:
            port = _port(folder / "log")
            asyncio.run(_Load(found, service.pid, port, random.Random(seed)).run(count))
        finally:
            family = _family(service.pid)
            service.send_signal(signal.SIGTERM)
            status = service.wait(60)
    left = still_running(family)
    found.add(
        "left running" if left or status else "ended by a signal, nothing left", f"{left}, status {status}"
    )
    if (folder / "owned").exists():
        found.add("code run", "a file was written")
    said = (folder / "log").read_text("utf-8", "replace")
    if "Traceback" in said:
        found.add("traceback", f"in the log of the service: {said[said.index('Traceback') :][:3000]}")
    return found


def _port(log: Path) -> int:
    while True:
        for line in log.read_text("utf-8").splitlines():
            if '"listening"' in line:
                return json.loads(line)["port"]
        time.sleep(0.1)


class _Load:
    """The clients, and what they saw."""

    def __init__(self, found: Count, service: int, port: int, draw: random.Random) -> None:
        self.found, self.service, self.port, self.draw = found, service, port, draw
        self.asked: list[tuple[dict[str, object], str]] = []
        self.waits: dict[str, list[float]] = {"all": [], "new": [], "asked before": [], "hostile": []}
        self.memory: list[int] = []
        self.answered = self.again = self.killed = 0

    async def run(self, count: int) -> None:
        await self._ask(0, fresh(self.draw)[0])  # the processes are warm
        start, used = time.monotonic(), _processor_seconds(self.service)
        todo = iter(range(count))
        await asyncio.gather(*(self._client(number, todo) for number in range(CLIENTS)))
        seconds, worked = time.monotonic() - start, _processor_seconds(self.service) - used
        health = (await self._request(0, "GET", "/health", b""))[2]
        self._measured(seconds, worked, json.loads(health))

    async def _client(self, number: int, todo) -> None:
        for _ in todo:
            await asyncio.sleep(self.draw.expovariate(ASKED / CLIENTS))
            before = bool(self.asked) and self.draw.random() < 0.5
            usual = self.draw.choice(self.asked) if before else fresh(self.draw)
            claim, wanted = hostile(self.draw) if self.draw.random() < HOSTILE else usual
            sort = "hostile" if wanted == "hostile" else "asked before" if before else "new"
            start = time.monotonic()
            outcome = await self._outcome(number, claim, wanted)
            wait = time.monotonic() - start
            self.waits["all"].append(wait)
            self.waits[sort].append(wait)
            self.found.add(outcome, json.dumps(claim)[:300])
            if wanted != "hostile":
                self.asked.append((claim, wanted))
            self.answered += 1
            if self.answered % KILLED_EVERY == 0:
                self._kill()
            if self.answered % 50 == 0:
                self.memory.append(max(map(_resident, _judging(self.service)), default=0))

    async def _outcome(self, number: int, claim: dict[str, object], wanted: str) -> str:
        try:
            said = await asyncio.wait_for(self._ask(number, claim), PATIENT)
        except (OSError, ValueError, asyncio.IncompleteReadError, TimeoutError):
            return "lost"
        if wanted == "hostile":
            return "wrong status" if said == "holds" else f"hostile, {said}"
        return said if said == wanted or said == "undecided" else "wrong status"

    async def _ask(self, number: int, claim: dict[str, object]) -> str:
        """Return the status of a claim; who is told to come back does."""
        body = json.dumps({"id": "asked", **claim}).encode()
        while True:
            status, head, answer = await self._request(number, "POST", "/check", body)
            if status == 200:
                return json.loads(answer)["status"]
            if status not in (429, 503):
                raise ValueError(answer)
            self.again += 1
            after = next(line for line in head if line.lower().startswith("retry-after:"))
            await asyncio.sleep(float(after.partition(":")[2]))

    async def _request(
        self, number: int, method: str, path: str, body: bytes
    ) -> tuple[int, list[str], bytes]:
        own = (f"127.0.1.{number + 1}", 0)
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port, local_addr=own)
        head = f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
        head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
        writer.write(head.encode() + body)
        answer = await reader.read()
        writer.close()
        with suppress(OSError):
            await writer.wait_closed()
        said, _, content = answer.partition(b"\r\n\r\n")
        lines = said.decode().split("\r\n")
        return int(lines[0].split()[1]), lines[1:], content

    def _kill(self) -> None:
        for pid in _judging(self.service)[:1]:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
                self.killed += 1

    def _measured(self, seconds: float, worked: float, health: dict) -> None:
        told = self.found.figures.append
        for sort, waits in self.waits.items():
            if len(waits) > 20:
                middle, most = statistics.median(waits), statistics.quantiles(waits, n=20)[-1]
                told(f"{sort}: {len(waits)}, median {1000 * middle:.0f} ms, 95 % within {1000 * most:.0f} ms")
        speed, load = self.answered / seconds, os.getloadavg()[1]
        told(f"{seconds:.0f} s, {speed:.1f} claims a second, load of the machine {load:.1f}")
        each = 1000 * worked / self.answered
        told(f"processor time of the service: {each:.1f} ms a claim; {self.again} told to come back")
        quarter = max(1, len(self.memory) // 4)
        first, last = max(self.memory[:quarter], default=0), max(self.memory[-quarter:], default=0)
        told(f"largest judging process: {first >> 20} MB in the first quarter, {last >> 20} MB in the last")
        told(f"{self.killed} processes killed; {health['processes']}")
        if health["processes"]["running"] != health["processes"]["wanted"]:
            self.found.add("wrong status", "a killed process was not replaced")
        if last > 2 * first + (100 << 20):
            self.found.add("over budget", "the memory of the processes grows")


def still_running(family: list[int], patience: float = 30.0) -> list[int]:
    """Return which processes have not ended after a while: those that are ending take longer on a busy machine."""
    until = time.monotonic() + patience
    while left := [pid for pid in family if Path(f"/proc/{pid}").exists()]:
        if time.monotonic() > until:
            break
        time.sleep(0.2)
    return left


def _family(pid: int) -> list[int]:
    """Return all descendants of a process."""
    try:
        said = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    found = [int(child) for child in said]
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):
            found += [int(child) for child in task.read_text().split()]
    found = list(dict.fromkeys(found))
    return found + [each for child in found for each in _family(child)]


def _judging(service: int) -> list[int]:
    """Return the judging processes of a service."""
    found = []
    for pid in _family(service):
        with suppress(OSError):
            if b"canon.exercise.judging_process" in Path(f"/proc/{pid}/cmdline").read_bytes():
                found.append(pid)
    return found


def _resident(pid: int) -> int:
    with suppress(OSError):
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return 0


def _processor_seconds(service: int) -> float:
    """Return what a service and its processes have used, ended ones that were waited for included."""
    ticks = 0
    for pid in (service, *_family(service)):
        with suppress(OSError):
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            ticks += sum(map(int, fields[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK")
