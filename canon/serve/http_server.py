"""HTTP server: uvicorn around the application, ended by a signal when what is in hand has been answered."""

from __future__ import annotations

import ipaddress
import signal
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING, cast

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from canon.serve.guarded_responses import LOOPBACK
from canon.serve.request_log import LOGGER, log_as_json
from canon.serve.service_limits import Limits
from canon.serve.web_application import application

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Generator, Sequence

    from starlette.applications import Starlette
    from uvicorn.protocols.http.h11_impl import RequestResponseCycle

__all__ = ["configured", "serve"]

BACKLOG = 256
IDLE = 15
"""Seconds for which a connection stays open on which no whole request has come."""
UNREAD = 30.0
"""Seconds for which an answer that a client does not take is kept for it."""


def serve(
    host: str = "127.0.0.1",
    port: int = 8000,
    limits: Limits | None = None,
    *,
    names: Sequence[str] = (),
    proxy: str = "",
) -> None:
    """Answer requests until a signal ends the process.

    Parameters
    ----------
    host, port
        Where to listen: on loopback unless told otherwise; port 0 takes a free one, which the log tells.
    limits
        What the service does at most.
    names
        Names that it answers to, besides those of loopback where it listens there; any, where it listens elsewhere and
        none are given.
    proxy
        Address of a reverse proxy, whose word on who asks is believed.

    Raises
    ------
    OSError
        Where nothing can listen there.
    """
    limits = limits or Limits()
    listening = _listening(host, port)
    log_as_json()
    local = _is_loopback(listening)
    answers_to = (*LOOPBACK, *names) if local else (*names, *(LOOPBACK if names else ()))
    config = configured(application(limits, tuple(name.lower() for name in answers_to)), limits, proxy)
    place = listening.getsockname()
    with listening, _ended_by_signals():
        said = {"host": place[0], "port": place[1], "names": answers_to, **vars(limits)}
        LOGGER.info("listening", extra={"said": said})
        uvicorn.Server(config).run([listening])
        LOGGER.info("stopped")


def configured(app: Starlette, limits: Limits, proxy: str = "") -> uvicorn.Config:
    """Return how uvicorn serves an application within limits."""
    return uvicorn.Config(
        app,
        log_config=None,
        access_log=False,
        server_header=False,
        http=_Prompt,
        ws="none",
        lifespan="on",
        limit_concurrency=limits.connections,
        timeout_keep_alive=IDLE,
        timeout_graceful_shutdown=int(limits.drain) or 1,
        h11_max_incomplete_event_size=16_384,
        proxy_headers=bool(proxy),
        forwarded_allow_ips=proxy or None,
    )


class _Prompt(H11Protocol):
    """HTTP/1.1 on one connection, closed where no whole request comes or an answer is not taken.

    uvicorn waits for both without end.
    """

    _seen: RequestResponseCycle | None = None
    """What had been answered last when it was looked; None while nothing had."""
    _resting = True
    """Whether nothing was being answered then."""
    _giving_up: asyncio.TimerHandle | None = None
    """What will end the connection, unless the client takes what was sent before."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        super().connection_made(transport)
        transport.set_write_buffer_limits(0)  # the next piece of an answer waits until the last one has gone
        self.loop.call_later(IDLE, self._look)

    def pause_writing(self) -> None:
        super().pause_writing()
        self._giving_up = self.loop.call_later(
            UNREAD, self.transport.abort
        )  # closing would wait for the client

    def resume_writing(self) -> None:
        super().resume_writing()
        self._take_back()

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self._take_back()

    def _take_back(self) -> None:
        if self._giving_up is not None:
            self._giving_up.cancel()
            self._giving_up = None

    def _look(self) -> None:
        """Close the connection where nothing is being answered and nothing new was since the last look."""
        cycle = cast("RequestResponseCycle | None", self.cycle)  # None before the first request
        if self.transport.is_closing():
            return
        resting = cycle is None or cycle.response_complete
        if resting and self._resting and cycle is self._seen:
            self.transport.close()
            return
        self._seen, self._resting = cycle, resting
        self.loop.call_later(IDLE, self._look)


def _listening(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    return socket.create_server((host, port), family=family, backlog=BACKLOG)


def _is_loopback(listening: socket.socket) -> bool:
    return ipaddress.ip_address(listening.getsockname()[0]).is_loopback


@contextmanager
def _ended_by_signals() -> Generator[None]:
    """Let a signal end the server, and not the process: the server repeats it when it has ended."""
    before = {number: signal.signal(number, lambda *_: None) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
