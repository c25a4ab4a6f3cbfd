"""Refusals: answers of the service to what it does not do, each with a sentence that says what to do instead."""

from __future__ import annotations

import json
import math

from starlette.responses import Response

__all__ = ["Refusal", "problem"]


class Refusal(Exception):
    """Raised for a request that is not answered as it was asked.

    Parameters
    ----------
    status
        The HTTP status.
    detail
        What was wrong and what to do instead.
    retry_after
        Seconds after which the same request can succeed; None where it never will.
    """

    def __init__(self, status: int, detail: str, retry_after: float | None = None) -> None:
        super().__init__(status, detail, retry_after)
        self.status = status
        self.detail = detail
        self.retry_after = retry_after

    @property
    def headers(self) -> dict[str, str]:
        """The header that says when to come back, where that helps.

        Examples
        --------
        >>> Refusal(429, "too many claims", 2.3).headers
        {'Retry-After': '3'}
        """
        return {} if self.retry_after is None else {"Retry-After": str(max(1, math.ceil(self.retry_after)))}


def problem(status: int, detail: str, headers: dict[str, str] | None = None) -> Response:
    """Return an error as RFC 9457 has it."""
    body = json.dumps({"status": status, "detail": detail})
    return Response(body, status, headers, "application/problem+json")
