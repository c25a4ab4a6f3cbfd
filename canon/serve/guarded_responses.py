"""Guarded responses: headers that forbid a browser what the page does not need, and the names a service answers to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.datastructures import Headers, MutableHeaders

from canon.serve.refusal import problem

if TYPE_CHECKING:
    from collections.abc import Collection

    from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["HEADERS", "LOOPBACK", "GuardedResponses", "host_of"]

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
"""Names of a service that only this machine can reach."""

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Cache-Control": "no-store",
}


class GuardedResponses:
    """Middleware that puts the headers on every response, and checks the name that a request is sent to.

    A page of another site can let its own name point to this machine and so have a browser ask here; the browser then
    says that name.

    Parameters
    ----------
    app
        What answers.
    names
        The names that the service answers to; any, where there are none.
    """

    def __init__(self, app: ASGIApp, names: Collection[str] = ()) -> None:
        self._app, self._names = app, frozenset(names)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request that is meant for this service."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        name = host_of(Headers(scope=scope).get("host", ""))
        if self._names and name not in self._names:
            known = ", ".join(sorted(self._names))
            wrong = problem(421, f"this service is not called {name[:100]!r}; it answers to {known}")
            await wrong(scope, receive, guarded)
            return
        await self._app(scope, receive, guarded)


def host_of(said: str) -> str:
    """Return the name in a Host header, without its port.

    Examples
    --------
    >>> host_of("localhost:8000"), host_of("[::1]:8000"), host_of("canon.example")
    ('localhost', '[::1]', 'canon.example')
    """
    name, _, port = said.rpartition(":")
    return (name if port.isdecimal() and name else said).lower()
