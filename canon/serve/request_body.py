"""Request bodies: JSON up to a size and within a time, whatever a client says or leaves unsaid about it."""

from __future__ import annotations

import asyncio
import json
from codecs import BOM_UTF8
from typing import TYPE_CHECKING, Any, NoReturn

from starlette.requests import ClientDisconnect

from canon.exercise.sheet.sheet import Claim, Sheet, SheetError, sheet_from
from canon.serve.refusal import Refusal

if TYPE_CHECKING:
    from starlette.requests import Request

__all__ = ["asked_claims", "asked_text", "body_of"]

SECONDS = 10.0
"""Seconds within which a body must have come."""


async def body_of(request: Request, most: int) -> bytes:
    """Return the body of a request that says it is JSON.

    Raises
    ------
    Refusal
        Where it is something else, too large, or does not come.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        raise Refusal(415, f"the body is {kind[:60] or 'of no kind'}; send JSON as application/json")
    too_large = Refusal(413, f"more than {most} bytes; send fewer claims at a time")
    said = request.headers.get("content-length", "0")
    if not said.isdecimal() or int(said[:20]) > most:
        raise too_large
    found = bytearray()
    try:
        async with asyncio.timeout(SECONDS):
            async for chunk in request.stream():
                found += chunk
                if len(found) > most:
                    raise too_large
    except TimeoutError:
        raise Refusal(408, f"the body did not come within {SECONDS:g} s; send it at once") from None
    except ClientDisconnect:
        raise Refusal(499, "the client went away before its request had come") from None
    return bytes(found)


def asked_claims(body: bytes, most: int) -> tuple[Sheet, bool]:
    """Return the claims of a body, and whether it was one claim by itself and no sheet.

    Raises
    ------
    Refusal
        Where it is neither a sheet nor a claim, or has too many of them.

    Examples
    --------
    >>> sheet, alone = asked_claims(b'{"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "1"}', 10)
    >>> sheet.claims, alone
    ((<Claim 'a': equality-only>,), True)
    """
    claim = _one_claim(body)
    if claim is not None:
        return Sheet("", (claim,)), True
    try:
        sheet = sheet_from(body)
    except SheetError as error:
        raise Refusal(400, str(error)) from error
    if len(sheet.claims) > most:
        raise Refusal(
            413, f"{len(sheet.claims)} claims, and at most {most} are judged at a time; split the sheet"
        )
    return sheet, False


def _one_claim(body: bytes) -> Claim | None:
    """Return the claim that a body is, read as in a sheet of one; None where it has none of a claim's own keys."""
    body = body.removeprefix(BOM_UTF8)
    try:
        is_object = isinstance(json.loads(body), dict)
        said = sheet_from(b'{"claims": [' + body + b"]}").claims if is_object else ()
    except (ValueError, RecursionError, SheetError):
        return None  # the error is told of the body as it was sent
    claim = said[0] if len(said) == 1 else None
    return claim if claim is not None and "kind" in claim.keys else None


def asked_text(body: bytes) -> dict[str, Any]:
    """Return what a body asks to be read: an object with a text and declared names.

    Raises
    ------
    Refusal
        Where it is none.

    Examples
    --------
    >>> asked_text(b'{"text": "2*x", "q": ["x"]}')
    {'text': '2*x', 'q': ['x']}
    """

    def no_constant(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a number of JSON")

    try:
        found = json.loads(body.decode("utf-8-sig"), parse_float=str, parse_constant=no_constant)
    except (ValueError, RecursionError) as error:
        raise Refusal(400, f"not valid JSON ({str(error)[:200] or 'nested too deeply'})") from error
    if not isinstance(found, dict) or "text" not in found:
        raise Refusal(400, 'send an object {"text": …} with the declared names, such as "q": ["theta"]')
    return found
