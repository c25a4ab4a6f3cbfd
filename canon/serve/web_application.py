"""Web application: the paths of the service, what each reads and answers."""

from __future__ import annotations

import asyncio
import ipaddress
import json
import time
from contextlib import aclosing, asynccontextmanager, contextmanager
from importlib import resources
from typing import TYPE_CHECKING, Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from canon.exercise.report.report import Report
from canon.serve.api_page import api_page
from canon.serve.guarded_responses import HEADERS, LOOPBACK, GuardedResponses
from canon.serve.judging_queue import JudgingQueue
from canon.serve.kinds_for_the_page import kinds
from canon.serve.openapi_document import openapi
from canon.serve.refusal import Refusal, problem
from canon.serve.request_body import asked_claims, asked_text, body_of
from canon.serve.request_log import RequestLog, note
from canon.serve.service_limits import Limits
from canon.serve.text_reader import TextReader
from canon.serve.token_bucket import Buckets, WorkTime
from canon.version import __version__

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Collection, Generator

    from starlette.requests import Request

    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Sheet

__all__ = ["application"]

TEXTS_A_CLAIM = 40
"""How many texts are read, or requests looked at, for what one claim costs; their time is put to account besides."""
LINES = "application/x-ndjson"
_FILES = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/page.js": ("page.js", "text/javascript; charset=utf-8"),
    "/page.css": ("page.css", "text/css; charset=utf-8"),
    "/icon.svg": ("icon.svg", "image/svg+xml"),
}
_TOLD = {
    404: "there is nothing here; /check judges, /read reads, /openapi.json says how",
    405: "this path does not answer that method; /openapi.json says which",
    500: "a fault of the service; its log says where",
}


def application(limits: Limits | None = None, names: Collection[str] = LOOPBACK) -> Starlette:
    """Return the service as an ASGI application, for a server of one's own.

    Parameters
    ----------
    limits
        What it does at most.
    names
        The names that it answers to, as they stand in a Host header; any, where there are none.

    Returns
    -------
    Starlette
        It starts its processes when the server does, and kills them when the server ends.

    Examples
    --------
    >>> [route.path for route in application().routes][:4]
    ['/check', '/read', '/health', '/openapi.json']
    """
    service = _Service(limits or Limits())
    routes = [
        Route("/check", service.check, methods=["POST"]),
        Route("/read", service.read, methods=["POST"]),
        Route("/health", service.health),
        Route("/openapi.json", service.openapi),
        Route("/api", service.api),
        Route("/kinds.json", service.kinds),
        *(Route(path, _file(*file)) for path, file in _FILES.items()),
    ]
    made = Starlette(
        routes=routes,
        middleware=[Middleware(RequestLog), Middleware(GuardedResponses, names=tuple(names))],
        exception_handlers={Refusal: _refused, HTTPException: _not_found, Exception: _fault},
        lifespan=service.lifespan,
    )
    made.state.service = service
    return made


def _json(found: dict[str, Any]) -> Response:
    """Return an answer in ASCII, in which half of a surrogate pair that was typed can stand too."""
    return Response(json.dumps(found), media_type="application/json")


class _Service:
    """What the paths share: the processes, and how much each client may still ask."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.buckets = Buckets(limits.rate / 60.0, limits.burst)
        self.queue: JudgingQueue
        self.reader: TextReader
        self.since = time.monotonic()
        self.document = openapi(limits)

    @asynccontextmanager
    async def lifespan(self, _: Starlette) -> AsyncGenerator[None]:
        """Start the processes, and kill them at the end."""
        self.queue, self.reader = JudgingQueue(self.limits), TextReader()
        try:
            yield
        finally:
            self.queue.close()
            self.reader.close()

    async def check(self, request: Request) -> Response:
        """Judge a sheet, or one claim."""
        self._take(request, 1.0 / TEXTS_A_CLAIM)
        body = await body_of(request, self.limits.body)
        with self._on_account(request) as work:
            sheet, alone = await asyncio.to_thread(self._asked, body, work)
        self._take(request, len(sheet.claims) - 1.0 / TEXTS_A_CLAIM)
        note(request.scope, bytes=len(body), claims=len(sheet.claims))
        if not alone and LINES in request.headers.get("accept", ""):
            return await self._lines(request, sheet.claims)
        found: list[Judgement] = []
        async with aclosing(self.queue.verdicts(sheet.claims)) as verdicts:
            async for judgement in verdicts:
                found.append(self._charged(request, judgement))
                if await request.is_disconnected():
                    return Response(status_code=499)
        report = Report(sheet.title, tuple(found))
        note(request.scope, **report.counts)
        if alone:
            return Response(found[0].json_line, media_type="application/json")
        return _json(
            {"title": sheet.title, "counts": report.counts, "verdicts": [each.to_dict() for each in found]}
        )

    async def _lines(self, request: Request, claims: Any) -> Response:
        """Return the verdicts as lines, each sent as soon as it is known."""
        verdicts = self.queue.verdicts(claims)
        first = await anext(verdicts)  # a refusal is told before anything is sent

        async def lines() -> AsyncGenerator[str]:
            async with aclosing(verdicts):
                yield f"{self._charged(request, first).json_line}\n"
                async for judgement in verdicts:
                    yield f"{self._charged(request, judgement).json_line}\n"

        return StreamingResponse(lines(), media_type=LINES)

    async def read(self, request: Request) -> Response:
        """Tell how a text is read."""
        self._take(request, 1.0 / TEXTS_A_CLAIM)
        body = await body_of(request, self.limits.body)
        with self._on_account(request) as work:
            found = await self.reader.how_read(asked_text(body), work)
        note(request.scope, bytes=len(body), read=found["read"])
        return _json(found)

    async def health(self, _: Request) -> Response:
        """Tell that the service runs, and how busy it is."""
        return JSONResponse(
            {
                "status": "ok",
                "version": __version__,
                "seconds": round(time.monotonic() - self.since, 1),
                "processes": self.queue.processes,
                "waiting": {"claims": self.queue.waiting, "texts": self.reader.waiting},
                "judged": self.queue.judged,
            }
        )

    async def openapi(self, _: Request) -> Response:
        """Describe the service for programs."""
        return JSONResponse(self.document)

    async def api(self, _: Request) -> Response:
        """Describe the service for people."""
        return Response(api_page(self.document), media_type="text/html; charset=utf-8")

    async def kinds(self, _: Request) -> Response:
        """Tell what the page asks for in each kind of claim."""
        return JSONResponse(kinds())

    def _take(self, request: Request, tokens: float) -> None:
        if wait := self.buckets.take(_client(request), tokens):
            raise Refusal(
                429,
                f"at most {self.limits.rate:g} claims a minute are judged for one client; "
                f"ask again in {max(1, round(wait))} s",
                retry_after=wait,
            )

    def _asked(self, body: bytes, work: WorkTime) -> tuple[Sheet, bool]:
        with work:
            return asked_claims(body, self.limits.claims)

    @contextmanager
    def _on_account(self, request: Request) -> Generator[WorkTime]:
        """Give what counts the seconds of work; they are put to the client's account, even where nothing came of it."""
        work = WorkTime()
        try:
            yield work
        finally:
            self.buckets.charge(_client(request), work.seconds)

    def _charged(self, request: Request, judgement: Judgement) -> Judgement:
        """Return a judgement whose time was put to the client's account."""
        if judgement.seconds > 1.0:
            self.buckets.charge(_client(request), judgement.seconds)
        return judgement


def _client(request: Request) -> str:
    """Return who asks: an address, or the network that one person has where addresses are plenty."""
    host = request.client.host if request.client else ""
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host
    if isinstance(address, ipaddress.IPv6Address):
        if address.ipv4_mapped is None:
            return str(ipaddress.ip_network((address, 64), strict=False))
        address = address.ipv4_mapped  # how a socket for both versions names who asks by IPv4
    return str(address)


def _file(name: str, kind: str) -> Any:
    content = resources.files("canon.serve").joinpath("page", name).read_bytes()

    async def sent(_: Request) -> Response:
        return Response(content, media_type=kind)

    return sent


async def _refused(_: Request, error: Exception) -> Response:
    if not isinstance(error, Refusal):
        raise error
    return problem(error.status, error.detail, error.headers)


async def _not_found(_: Request, error: Exception) -> Response:
    if not isinstance(error, HTTPException):
        raise error
    return problem(error.status_code, _TOLD.get(error.status_code, error.detail), dict(error.headers or {}))


async def _fault(_: Request, __: Exception) -> Response:
    return problem(500, _TOLD[500], HEADERS)  # answered outside of what guards the other responses
