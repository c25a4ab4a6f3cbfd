"""OpenAPI document: what the service reads and answers, for programs that are written against it."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

from canon.exercise.report.judgement import Judgement
from canon.exercise.sheet.kinds import KINDS
from canon.version import __version__

if TYPE_CHECKING:
    from canon.serve.service_limits import Limits

__all__ = ["openapi"]

_TEXT, _NUMBER, _INTEGER = {"type": "string"}, {"type": "number"}, {"type": "integer"}
_STRINGS = {"type": "array", "items": _TEXT}
_VERDICT = {
    "status": {"type": "string", "enum": ["holds", "fails", "undecided", "invalid"]},
    "seconds": _NUMBER,
    "counterexample": {"type": ["object", "null"]},
    "steps": {"type": "array", "items": _STRINGS},
    "warnings": _STRINGS,
    "points": {"type": ["number", "null"]},
    "share": {"type": ["number", "null"]},
    "earned": {"type": ["number", "null"]},
}
_EXAMPLE = {
    "id": "pendulum",
    "kind": "euler-lagrange",
    "q": ["theta"],
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "claim": [r"$\ddot\theta + \frac{g}{l}\sin\theta = 0$"],
}


def openapi(limits: Limits) -> dict[str, Any]:
    """Return the document.

    Examples
    --------
    >>> from canon.serve.service_limits import Limits
    >>> sorted(openapi(Limits())["paths"])
    ['/check', '/health', '/kinds.json', '/openapi.json', '/read']
    """
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "canon",
            "version": __version__,
            "description": "Claims about mechanics in, verdicts out. holds is only said of what was proved, fails only "
            "of what was refuted. Nothing that is sent is executed.",
        },
        "paths": {
            "/check": {"post": _check(limits)},
            "/read": {"post": _read(limits)},
            "/health": {"get": _get("How the service is: its processes, and how many claims wait.")},
            "/kinds.json": {"get": _get("The keys of each kind of claim, and where its answer stands.")},
            "/openapi.json": {"get": _get("This document.")},
        },
        "components": {"schemas": _schemas()},
    }


def _check(limits: Limits) -> dict[str, Any]:
    verdict, sheet = _ref("Verdict"), _ref("Verdicts")
    return {
        "summary": "Judge a claim, or a sheet of claims.",
        "description": f"At most {limits.claims} claims and {limits.body} bytes at a time; {limits.budget:g} s each. "
        "A claim that can't be read is answered, as invalid. With Accept: application/x-ndjson a sheet is "
        "answered line by line, each verdict as soon as it is known.",
        "requestBody": _body({"oneOf": [_ref("Claim"), _ref("Sheet")]}, _EXAMPLE),
        "responses": {
            "200": {
                "description": "The verdict, or those of the sheet in the order of its claims.",
                "content": {
                    "application/json": {"schema": {"oneOf": [verdict, sheet]}},
                    "application/x-ndjson": {"schema": verdict},
                },
            },
            **_problems(limits),
        },
    }


def _read(limits: Limits) -> dict[str, Any]:
    example = {"text": "theta'' + g*sin(theta) = 0", "q": ["theta"], "parameters": {"g": "positive"}}
    return {
        "summary": "Tell how a text is read.",
        "description": "With kind and key, as what stands there in a claim; else with the declared names only.",
        "requestBody": _body(_ref("Text"), example),
        "responses": {
            "200": {
                "description": "Its statements, or where it goes wrong.",
                "content": {"application/json": {"schema": _ref("Reading")}},
            },
            **_problems(limits),
        },
    }


def _schemas() -> dict[str, Any]:
    kind = {"type": "string", "enum": list(KINDS)}
    claim = {"id": _TEXT, "kind": kind, "parameters": {"type": "object"}, "domain": _STRINGS}
    verdict = {
        name: _VERDICT.get(name, _TEXT) for name in (*(field.name for field in fields(Judgement)), "earned")
    }
    place = {"place": _TEXT, "column": _INTEGER, "reason": _TEXT, "caret": _TEXT}
    statement = {"place": _TEXT, "mathml": _TEXT, "plain": _TEXT}
    text = {"text": {}, "kind": kind, "key": _TEXT, "q": _STRINGS, "parameters": {"type": "object"}}
    counts = {"type": "object", "additionalProperties": _INTEGER}
    return {
        "Claim": _object(claim, "id", "kind"),
        "Sheet": _object({"title": _TEXT, "claims": _list_of("Claim")}, "claims"),
        "Verdict": _object(verdict, *verdict),
        "Verdicts": _object({"title": _TEXT, "counts": counts, "verdicts": _list_of("Verdict")}, "verdicts"),
        "Text": _object(text, "text"),
        "Reading": _object(
            {
                "read": {"type": "boolean"},
                "statements": {"type": "array", "items": _object(statement, *statement)},
                "warnings": _STRINGS,
                "error": _object(place, *place),
            },
            "read",
        ),
        "Problem": _object({"status": _INTEGER, "detail": _TEXT}, "status", "detail"),
    }


def _object(properties: dict[str, Any], *required: str) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(required)}


def _list_of(name: str) -> dict[str, Any]:
    return {"type": "array", "items": _ref(name)}


def _ref(name: str) -> dict[str, str]:
    return {"$ref": f"#/components/schemas/{name}"}


def _get(summary: str) -> dict[str, Any]:
    content = {"application/json": {"schema": {"type": "object"}}}
    return {"summary": summary, "responses": {"200": {"description": "As an object.", "content": content}}}


def _body(schema: dict[str, Any], example: dict[str, Any]) -> dict[str, Any]:
    return {"required": True, "content": {"application/json": {"schema": schema, "example": example}}}


def _problems(limits: Limits) -> dict[str, Any]:
    told = {
        "400": "The body is no JSON, or not what is read here.",
        "408": "The body did not come in time.",
        "413": "The body is too large, or has too many claims.",
        "415": "The body is not application/json.",
        "422": "Reading the text did not come to an end.",
        "429": f"More than {limits.rate:g} claims a minute; Retry-After says when to ask again.",
        "503": "Too many claims wait; Retry-After says when to ask again.",
    }
    content = {"application/problem+json": {"schema": _ref("Problem")}}
    return {status: {"description": text, "content": content} for status, text in told.items()}
