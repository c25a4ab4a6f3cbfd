"""Read the corpus of identities: claims lhs = rhs whose truth is known."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sympy import Expr, Rational, Symbol

from canon.expression.parse import Scope, exact, parse_condition, parse_expression

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy.logic.boolalg import Boolean

__all__ = ["ASSUMPTIONS", "Identity", "identities", "subjects"]

FOLDER = Path(__file__).parent
ASSUMPTIONS: Mapping[str, Mapping[str, bool]] = {
    "real": {"real": True},
    "positive": {"positive": True},
    "negative": {"negative": True},
    "nonzero": {"real": True, "nonzero": True},
    "integer": {"integer": True},
}


@dataclass(frozen=True)
class Identity:
    """A claim lhs = rhs, true (or not) at all points of the domain where both sides are defined."""

    id: str
    title: str
    lhs: Expr
    rhs: Expr
    conditions: tuple[Boolean, ...]
    box: Mapping[Symbol, tuple[Rational, Rational]]
    truth: bool
    subject: str


def subjects() -> list[str]:
    """Return the names of the files, each a subject."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def identities(*only: str) -> list[Identity]:
    """Return the identities of all subjects, or of those named."""
    return [
        _identity(entry, subject)
        for subject in subjects()
        if not only or subject in only
        for entry in entries(subject)
    ]


def entries(subject: str) -> list[dict[str, Any]]:
    """Return the tables of one file as they are written."""
    with (FOLDER / f"{subject}.toml").open("rb") as file:
        return tomllib.load(file)["identity"]


def _identity(entry: Mapping[str, Any], subject: str) -> Identity:
    symbols = {name: Symbol(name, **ASSUMPTIONS[kind]) for name, kind in entry["symbols"].items()}
    scope = Scope(
        names=symbols,
        functions={name: tuple(arguments) for name, arguments in entry.get("functions", {}).items()},
        time=symbols.get("t", Symbol("t", real=True)),
    )
    return Identity(
        id=entry["id"],
        title=entry["title"],
        lhs=parse_expression(entry["lhs"], scope),
        rhs=parse_expression(entry["rhs"], scope),
        conditions=tuple(parse_condition(text, scope) for text in entry.get("conditions", [])),
        box={symbols[name]: (exact(low), exact(high)) for name, (low, high) in entry.get("box", {}).items()},
        truth=entry["truth"],
        subject=subject,
    )
