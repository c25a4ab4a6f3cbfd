"""Sheets of claims: read from TOML or JSON, checked for their form, nothing evaluated.

What a claim says is read by :mod:`canon.exercise.reading`, when it is judged. Limits: 10 MB a file, 10 000
claims a sheet.
"""

from __future__ import annotations

import difflib
import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from importlib import resources
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

from canon.exercise.kinds import COMMON, KINDS, Shape

__all__ = ["Claim", "ClaimError", "Sheet", "SheetError", "bundled_sheet", "read_sheet", "sheet_from"]

MAX_BYTES = 10_000_000
MAX_CLAIMS = 10_000
DEFAULT_BUDGET = 10.0
ASSUMPTIONS = ("positive", "negative", "nonzero", "real", "integer")


class SheetError(ValueError):
    """A file that is no sheet at all."""


@dataclass(frozen=True)
class ClaimError:
    """What is wrong with the form of a claim, and where.

    Parameters
    ----------
    claim
        The claim's id, or ``#n`` for the n-th claim where it has none.
    key
        The key under which the fault stands; empty for the claim as a whole.
    reason
        What is wrong and what to do instead.
    column
        Column of the expression, counted from 1, or 0 where there is none.
    caret
        The text with a caret under the column, for expressions.
    file
        The file the claim stands in.
    """

    claim: str
    key: str
    reason: str
    column: int = 0
    caret: str = ""
    file: str = ""

    @property
    def brief(self) -> str:
        """What is wrong inside the claim, without saying which claim it is."""
        places = (f"key {self.key}" if self.key else "", f"column {self.column}" if self.column else "")
        where = ", ".join(place for place in places if place)
        reason = f"{where}: {self.reason}" if where else self.reason
        return f"{reason}\n{self.caret}" if self.caret else reason

    def __str__(self) -> str:
        where = f"{self.file}, claim {self.claim}" if self.file else f"claim {self.claim}"
        return f"{where}{', ' if self.key or self.column else ': '}{self.brief}"


@dataclass(frozen=True)
class Claim:
    """One claim of a sheet, as it was written.

    Parameters
    ----------
    id, kind
        Its name in the sheet and what sort of thing it claims.
    keys
        Everything that stands in the claim, by key.
    expect
        What the author expects, ``holds``, ``fails`` or nothing; never used to judge.
    budget
        Seconds that the judgement may take.
    errors
        What is wrong with its form; a claim with errors is invalid.
    file
        The file it stands in.
    """

    id: str
    kind: str
    keys: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    expect: str = ""
    budget: float = DEFAULT_BUDGET
    errors: tuple[ClaimError, ...] = ()
    file: str = ""


@dataclass(frozen=True)
class Sheet:
    """Claims in their order, the ill-formed among them marked."""

    title: str
    claims: tuple[Claim, ...]
    file: str = ""

    @property
    def errors(self) -> tuple[ClaimError, ...]:
        """Everything that is wrong with the form of the claims."""
        return tuple(error for claim in self.claims for error in claim.errors)


def read_sheet(path: str | Path) -> Sheet:
    """Read a sheet of claims from a ``.toml`` or ``.json`` file.

    Parameters
    ----------
    path
        The file; anything that does not end in ``.toml`` is read as JSON.

    Returns
    -------
    Sheet
        With every claim in its order. Claims of a wrong form are there too and carry their errors.

    Raises
    ------
    SheetError
        Where the file can't be read, is too large, or is no sheet.
    """
    path = Path(path)
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise SheetError(f"{path}: {size} bytes, and at most {MAX_BYTES} are read; split the sheet")
        data = path.read_bytes()
    except OSError as error:
        raise SheetError(f"{path}: can't be read ({error.strerror or error})") from error
    return sheet_from(data, file=str(path), toml=path.suffix.lower() == ".toml")


def bundled_sheet(name: str = "tour") -> Sheet:
    """Return a sheet that comes with canon.

    Examples
    --------
    >>> bundled_sheet().claims[0].id
    'pendulum'
    """
    data = resources.files("canon.exercise").joinpath("sheets", f"{name}.toml").read_bytes()
    return sheet_from(data, file=f"{name}.toml", toml=True)


def sheet_from(data: bytes, *, file: str = "", toml: bool = False) -> Sheet:
    """Read a sheet from the bytes of a file.

    Raises
    ------
    SheetError
        Where the bytes are no sheet.

    Examples
    --------
    >>> sheet = sheet_from(b'{"claims": [{"id": "a", "kind": "equality-only", "lhs": "1"}]}')
    >>> print(*sheet.errors)
    claim a, key rhs: missing (an expression)
    """
    shown = file or "the sheet"
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise SheetError(f"{shown}: not UTF-8 text (byte {error.start})") from error
    try:
        found = tomllib.loads(text, parse_float=Decimal) if toml else _json(text)
    except RecursionError as error:
        raise SheetError(f"{shown}: nested too deeply to be a sheet") from error
    except ValueError as error:
        raise SheetError(f"{shown}: not valid {'TOML' if toml else 'JSON'} ({error})") from error
    return _sheet(found, file, shown)


def _json(text: str) -> Any:
    def no_constant(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a number of JSON")

    def no_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            keys = [key for key, _ in pairs]
            raise ValueError(
                f"the key {next(k for k in keys if keys.count(k) > 1)!r} stands twice in one object"
            )
        return found

    return json.loads(text, parse_float=Decimal, parse_constant=no_constant, object_pairs_hook=no_repeats)


def _sheet(found: Any, file: str, shown: str) -> Sheet:
    raw = found.get("claims", found.get("claim")) if isinstance(found, dict) else found
    if not isinstance(raw, list):
        raise SheetError(
            f"{shown}: no claims; write [[claim]] tables in TOML, or {{'claims': [ … ]}} in JSON"
        )
    if isinstance(found, dict):
        unknown = sorted(set(found) - {"title", "claims", "claim", "source"})
        if unknown:
            raise SheetError(f"{shown}: unknown key {unknown[0]!r} beside the claims")
    if len(raw) > MAX_CLAIMS:
        raise SheetError(f"{shown}: {len(raw)} claims, and at most {MAX_CLAIMS} are read; split the sheet")
    seen: set[str] = set()
    claims: list[Claim] = []
    for number, keys in enumerate(raw, 1):
        claim = _claim(keys, number, file)
        if claim.id in seen:
            error = ClaimError(
                claim.id, "id", "another claim before it has the same id; rename one", file=file
            )
            claim = replace(claim, errors=(*claim.errors, error))
        seen.add(claim.id)
        claims.append(claim)
    title = found.get("title", "") if isinstance(found, dict) else ""
    return Sheet(str(title), tuple(claims), file)


def _claim(keys: Any, number: int, file: str) -> Claim:
    if not isinstance(keys, dict):
        error = ClaimError(f"#{number}", "", "a claim is a table of keys", file=file)
        return Claim(f"#{number}", "", errors=(error,), file=file)
    name = keys.get("id")
    id_ = name if isinstance(name, str) and name else f"#{number}"
    said = keys.get("kind")
    kind = said if isinstance(said, str) else ""
    faults = [("id", "missing (a name for the claim)")] if id_ != name else []
    faults += _faults(kind, keys)
    expect = keys.get("expect", "")
    if expect not in ("", "holds", "fails"):
        faults.append(("expect", "write holds or fails"))
    budget = keys.get("budget", DEFAULT_BUDGET)
    usable = isinstance(budget, (int, float, Decimal)) and not isinstance(budget, bool) and 0 < budget <= 3600
    if not usable:
        faults.append(("budget", "write a number of seconds above 0 and up to 3600"))
    return Claim(
        id_,
        kind,
        MappingProxyType(keys),
        expect=str(expect),
        budget=float(budget) if usable else DEFAULT_BUDGET,
        errors=tuple(ClaimError(id_, key, reason, file=file) for key, reason in faults),
        file=file,
    )


def _faults(kind: str, keys: Mapping[str, Any]) -> list[tuple[str, str]]:
    if kind not in KINDS:
        close = difflib.get_close_matches(kind[:60], KINDS, n=2, cutoff=0.5)
        remedy = f"is {' or '.join(close)} meant?" if close else f"known are {', '.join(KINDS)}"
        return [("kind", f"unknown kind {kind!r}; {remedy}" if kind else f"missing; {remedy}")]
    wanted = KINDS[kind]
    known = {**COMMON, **wanted.required, **wanted.optional}
    faults = [(key, f"missing ({shape.value})") for key, shape in wanted.required.items() if key not in keys]
    if wanted.one_of and not any(all(key in keys for key in group) for group in wanted.one_of):
        groups = " or ".join(" with ".join(group) for group in wanted.one_of)
        faults.append((wanted.one_of[0][-1], f"missing; a claim of kind {kind} needs {groups}"))
    for key, value in keys.items():
        if key not in known:
            close = difflib.get_close_matches(key[:60], known, n=1, cutoff=0.6)
            remedy = f"is {close[0]} meant?" if close else f"known are {', '.join(known)}"
            faults.append((key[:60], f"unknown key for the kind {kind}; {remedy}"))
        elif not _fits(value, known[key]):
            faults.append((key, f"should be {known[key].value}"))
    return faults


def _text(value: Any) -> bool:
    return isinstance(value, (str, int, Decimal)) and not isinstance(value, bool)


def _texts(value: Any) -> bool:
    return _text(value) or (isinstance(value, list) and len(value) > 0 and all(_text(item) for item in value))


def _name(value: Any) -> bool:
    return isinstance(value, str) and value.isidentifier() and value.isascii()


def _names(value: Any) -> bool:
    return _name(value) or (isinstance(value, list) and all(_name(item) for item in value))


def _table(value: Any) -> bool:
    return isinstance(value, Mapping) and all(_name(key) for key in value)


def _fits(value: Any, shape: Shape) -> bool:
    match shape:
        case Shape.TEXT:
            return _text(value)
        case Shape.TEXTS:
            return _texts(value) or value == []
        case Shape.NAMES:
            return _names(value)
        case Shape.WORD:
            return isinstance(value, str)
        case Shape.TRUE:
            return value is True
        case Shape.NUMBER:
            return isinstance(value, (int, Decimal)) and not isinstance(value, bool)
        case Shape.ASSUMPTIONS:
            return _table(value) and all(item in ASSUMPTIONS for item in value.values())
        case Shape.FUNCTIONS:
            return _table(value) and all(_names(item) and item != [] for item in value.values())
        case Shape.BOX:
            return _table(value) and all(_interval(item) for item in value.values())
        case Shape.EXPRESSIONS:
            return _table(value) and all(_text(item) for item in value.values())
        case Shape.LISTS:
            return _table(value) and all(_texts(item) for item in value.values())
        case Shape.BRACKETS:
            return isinstance(value, list) and len(value) > 0 and all(_bracket(item) for item in value)
        case Shape.BODIES:
            return isinstance(value, list) and len(value) > 0 and all(_body(item) for item in value)


def _interval(value: Any) -> bool:
    if not isinstance(value, list) or len(value) != 2:
        return False
    numbers = all(isinstance(end, (int, Decimal)) and not isinstance(end, bool) for end in value)
    return numbers and all(Decimal(end).is_finite() for end in value) and value[0] < value[1]


def _bracket(value: Any) -> bool:
    return (
        _table(value)
        and set(value) in ({"f", "g", "value"}, {"u", "v", "value"})
        and all(map(_text, value.values()))
    )


def _body(value: Any) -> bool:
    if not _table(value) or not set(value) <= {"m", "r", "I", "angle", "omega"}:
        return False
    point, rotor = {"m", "r"} <= set(value), "I" in value and bool({"angle", "omega"} & set(value))
    return (point or rotor) and all(_texts(item) for item in value.values())
