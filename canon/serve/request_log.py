"""Request log: one JSON object a line on standard error, for each request and for what the service says of itself."""

from __future__ import annotations

import json
import logging
import sys
import time
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from h11 import LocalProtocolError

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["RequestLog", "log_as_json", "note"]

LOGGER = logging.getLogger("canon.serve")
MOST = 300
"""Characters of a path that are logged."""


class _AsJson(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        said: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "event": record.getMessage().strip(),
            **getattr(record, "said", {}),
        }
        if record.exc_info:
            said["traceback"] = self.formatException(record.exc_info)
        return json.dumps(said, default=str)  # in ASCII: what a stranger wrote can't command a terminal


def log_as_json() -> None:
    """Write the log of the service, and of its server, to standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_AsJson())
    for name in ("canon.serve", "uvicorn"):
        logger = logging.getLogger(name)
        logger.handlers, logger.propagate = [handler], False
        logger.setLevel(logging.INFO)


def note(scope: Scope, **said: Any) -> None:
    """Add to what is logged of a request when it has been answered."""
    scope.setdefault("canon.log", {}).update(said)


class RequestLog:
    """Middleware that logs each request when it has been answered: never what stands in it.

    Parameters
    ----------
    app
        What answers.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request and log it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        start, status = time.monotonic(), 499  # the client went away before it was answered

        async def watched(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            try:
                await send(message)
            except LocalProtocolError:
                # What followed the head was no HTTP, and the server has said so and hung up.
                status = 400

        try:
            await self._app(scope, receive, watched)
        except Exception:
            status = 500
            raise
        finally:
            client = scope.get("client")
            said = {
                "method": scope["method"],
                "path": scope["path"][:MOST],
                "status": status,
                "seconds": round(time.monotonic() - start, 4),
                "client": client[0] if client else "",
                **scope.get("canon.log", {}),
            }
            LOGGER.info("request", extra={"said": said})
