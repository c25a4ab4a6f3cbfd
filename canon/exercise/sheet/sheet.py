"""Sheets of claims: read from TOML or JSON, checked for their form, nothing evaluated.

What a claim says is read by :mod:`canon.exercise.sheet.reading`, when it is judged. Limits: 10 MB a file, 10 000
claims a sheet.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal, InvalidOperation
from importlib import resources
from pathlib import Path
from typing import Any, NoReturn

from canon.exercise.sheet.key_shapes import MAX_DIGITS, declared_names, faults, with_plain_names
from canon.expression.symbols.input_in_words import counted, given_kind
from canon.frozen_mapping import FrozenMapping
from canon.given_file import UnreadableFile, bytes_of, tables_of

__all__ = [
    "Claim",
    "ClaimError",
    "Sheet",
    "SheetError",
    "bundled_sheet",
    "claim_from",
    "read_sheet",
    "sheet_from",
]

MAX_BYTES = 10_000_000
MAX_TOML_BYTES = 2_000_000
"""TOML is written by people, and its parser takes longer than JSON's."""
MAX_CLAIMS = 10_000
MAX_REASON = 2_000
"""Characters of what is told against a claim; only a stranger's name in it can make it longer."""
MIN_BUDGET = Decimal("0.01")
_FOR_ALL = ("implicit_multiplication", "complete", "in", "points", "partial", "dimensions")
"""Keys that may stand beside the claims and are meant for each of them."""
DEFAULT_BUDGET = 10.0
MOST_POINTS = 1_000_000


class SheetError(ValueError):
    """Raised for a file that can't be read as a sheet of claims."""


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
        told = self.reason if len(self.reason) <= MAX_REASON else f"{self.reason[:MAX_REASON]}…"
        reason = f"{where}: {told}" if where else told
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
    keys: Mapping[str, Any] = field(default_factory=lambda: FrozenMapping({}))
    expect: str = ""
    budget: float = DEFAULT_BUDGET
    errors: tuple[ClaimError, ...] = ()
    file: str = ""

    def __repr__(self) -> str:
        return f"<Claim {self.id!r}: {self.kind}{', ill-formed' if self.errors else ''}>"


@dataclass(frozen=True)
class Sheet:
    """Sheet of claims in their order; those of a wrong form carry their errors."""

    title: str
    claims: tuple[Claim, ...]
    file: str = ""

    def __repr__(self) -> str:
        return f"<Sheet {self.title!r}: {counted(len(self.claims), 'claim')}>"

    @property
    def errors(self) -> tuple[ClaimError, ...]:
        """Everything that is wrong with the form of the claims."""
        return tuple(error for claim in self.claims for error in claim.errors)


def read_sheet(source: str | Path | Mapping[str, Any] | list[Any] | tuple[Any, ...]) -> Sheet:
    r"""Read a sheet of claims from a ``.toml`` or ``.json`` file, from its text, or from tables.

    Parameters
    ----------
    source
        The path of a file, which is read as TOML where it ends in ``.toml`` and else as JSON; or a text that has line
        breaks or begins with a bracket, JSON or TOML; or what JSON makes of one: a dict with ``claims``, a list of
        dicts.

    Returns
    -------
    Sheet
        With every claim in its order. Claims of a wrong form are there too and carry their errors.

    Raises
    ------
    SheetError
        Where the file can't be read, is too large, or is no sheet.

    Examples
    --------
    >>> read_sheet({"claims": [{"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "2/2"}]}).claims
    (<Claim 'a': equality-only>,)
    >>> read_sheet('[[claim]]\nid = "a"\nkind = "equality-only"\nlhs = "1"\nrhs = "2/2"').claims
    (<Claim 'a': equality-only>,)
    """
    if isinstance(source, Mapping | list | tuple):
        try:
            text = json.dumps(source, default=_said_as_text)
        except (TypeError, ValueError, RecursionError) as error:
            raise SheetError(f"the sheet: these tables hold what no sheet does ({error})") from error
        return sheet_from(text.encode())
    given_kind(source, (str, Path), "the path of the sheet")
    if isinstance(source, str) and ("\n" in source or source.lstrip().startswith(("{", "["))):
        toml = re.match(r"\ufeff?\s*(\{|\[\s*[{\]])", source) is None
        return sheet_from(source.encode("utf-8", "surrogatepass"), toml=toml)
    path = Path(source)
    try:
        data = bytes_of(path, MAX_BYTES, "split the sheet")
    except UnreadableFile as error:
        raise SheetError(f"{path}: {error}") from error
    return sheet_from(data, file=str(path), toml=path.suffix.lower() == ".toml")


def _said_as_text(value: Any) -> dict[str, Any]:
    """Return a table whose keys are those of a mapping that is no dict; anything else is refused."""
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} {str(value)[:60]!r}")


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
        text = data.decode("utf-8-sig")  # what Windows writes begins with a byte order mark
    except UnicodeDecodeError as error:
        raise SheetError(f"{shown}: not UTF-8 text (byte {error.start})") from error
    try:
        return _sheet(_toml(text) if toml else _json(text), file, shown)
    except RecursionError as error:
        raise SheetError(f"{shown}: nested too deeply to be a sheet") from error
    except SheetError:
        raise
    except ValueError as error:
        remedy = _QUOTES if toml and "\\" in str(error) else ""
        raise SheetError(f"{shown}: not valid {'TOML' if toml else 'JSON'} ({error}){remedy}") from error


_QUOTES = (
    "; a backslash means something to TOML between double quotes: write LaTeX between single quotes, '…'"
)
_TWICE = "; a backslash means something to JSON: write it twice, \\\\theta"

_EATEN = re.compile(
    "\t(?=au|an|heta|ext|imes|frac|o\\b)|\x08(?=eta|ar|igl?|oldsymbol)|\x0c(?=rac)|\r(?=ho|ight|angle|m\\b)|\n(?=abla|eq?\\b|u\\b)"
)
"""What is left of \\theta, \\beta, \\frac, \\rho, \\nabla where a backslash and a letter became one character."""

_SURELY_EATEN = re.compile("\t(?=heta|imes|frac|ext\\{)|\x08(?=eta|ar|egin)|\x0c(?=rac)|\r(?=ho|ight)")
"""The same in LaTeX without dollars, as far as plain text never has it."""


def _eaten(value: Any) -> bool:
    """Tell whether LaTeX in a value lost backslashes to the quotes it stood in."""
    if isinstance(value, str):
        return (_EATEN if "$" in value else _SURELY_EATEN).search(value) is not None
    if isinstance(value, dict):
        return any(map(_eaten, value.values()))
    return isinstance(value, list) and any(map(_eaten, value))


def _decimal(text: str) -> Decimal | str:
    """Return a decimal; what is no number, or one that nobody means, stays text and is refused where it stands."""
    try:
        value = Decimal(text)
    except InvalidOperation:
        return text
    return value if value.is_finite() and abs(value.adjusted()) <= MAX_DIGITS else text


def _toml(text: str) -> Any:
    if len(text) > MAX_TOML_BYTES:
        raise ValueError(f"{len(text)} characters, and at most {MAX_TOML_BYTES} are read; split the sheet")
    return tables_of(text, _decimal)


def _json(text: str) -> Any:
    def no_constant(name: str) -> NoReturn:
        raise ValueError(f"{name} is not a number of JSON")

    def no_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key, value in pairs:
            if key in found:
                raise ValueError(f"the key {key[:60]!r} stands twice in one object")
            found[key] = value
        return found

    return json.loads(text, parse_float=_decimal, parse_constant=no_constant, object_pairs_hook=no_repeats)


def _sheet(found: Any, file: str, shown: str) -> Sheet:
    raw = found.get("claims", found.get("claim")) if isinstance(found, dict) else found
    if not isinstance(raw, list):
        raise SheetError(
            f"{shown}: no claims; write [[claim]] tables in TOML, or {{'claims': [ … ]}} in JSON"
        )
    if isinstance(found, dict):
        unknown = sorted(set(found) - {"title", "claims", "claim", "source", *_FOR_ALL})
        if unknown:
            raise SheetError(f"{shown}: unknown key {unknown[0][:60]!r} beside the claims")
        if {"claims", "claim"} <= found.keys():
            raise SheetError(
                f"{shown}: claims stand under 'claims' and under 'claim'; put them under one of them"
            )
    if not raw:
        raise SheetError(f"{shown}: a list of claims without a claim")
    if len(raw) > MAX_CLAIMS:
        raise SheetError(f"{shown}: {len(raw)} claims, and at most {MAX_CLAIMS} are read; split the sheet")
    for_all = _for_all(found)
    raw = list(map(_with_plain_names, raw))
    _refuse_idle_dimensions(for_all.get("dimensions"), raw, shown)
    seen: set[str] = set()
    claims: list[Claim] = []
    for number, keys in enumerate(raw, 1):
        claim = claim_from(_beside(keys, for_all) if isinstance(keys, dict) else keys, number, file)
        if claim.id in seen:
            error = ClaimError(
                claim.id, "id", "another claim before it has the same id; rename one", file=file
            )
            claim = replace(claim, errors=(*claim.errors, error))
        seen.add(claim.id)
        claims.append(claim)
    title = found.get("title", "") if isinstance(found, dict) else ""
    return Sheet(str(title), tuple(claims), file)


def _with_plain_names(keys: Any) -> Any:
    return with_plain_names(str(keys.get("kind", "")), keys) if isinstance(keys, dict) else keys


def _for_all(found: Any) -> dict[str, Any]:
    """Return what stands beside the claims and is meant for all of them."""
    keys = {key: found[key] for key in _FOR_ALL if key in found} if isinstance(found, dict) else {}
    return {**with_plain_names("", keys)}


def _beside(keys: dict[str, Any], for_all: dict[str, Any]) -> dict[str, Any]:
    """Return a claim with what stands beside all claims: of dimensions those of the names that it declares."""
    dimensions = for_all.get("dimensions")
    if isinstance(dimensions, dict):
        declared = declared_names(str(keys.get("kind", "")), keys)
        own = {name: said for name, said in dimensions.items() if name in declared}
        return {**for_all, "dimensions": own, **keys}
    return {**for_all, **keys}


def _refuse_idle_dimensions(dimensions: Any, claims: list[Any], shown: str) -> None:
    """Refuse a dimension of a name that no claim declares, or a table that is none."""
    if not isinstance(dimensions, dict):
        return
    tables = [keys for keys in claims if isinstance(keys, dict)]
    declared = {name for keys in tables for name in declared_names(str(keys.get("kind", "")), keys)}
    idle = next((name for name in dimensions if name not in declared), None)
    if idle is not None:
        raise SheetError(
            f"{shown}: dimensions: {idle[:60]!r} is declared by no claim; mend it or leave it out"
        )


def claim_from(keys: Any, number: int = 1, file: str = "") -> Claim:
    """Return the claim that a table of keys is, with what is wrong with its form.

    Parameters
    ----------
    keys
        What stands in the claim, ``id`` and ``kind`` included.
    number, file
        Where it stands.

    Examples
    --------
    >>> claim_from({"id": "a", "kind": "equality-only", "lhs": "1"}).errors[0].brief
    'key rhs: missing (an expression)'
    """
    if not isinstance(keys, dict):
        error = ClaimError(f"#{number}", "", "a claim is a table of keys", file=file)
        return Claim(f"#{number}", "", errors=(error,), file=file)
    name = keys.get("id")
    id_ = name if isinstance(name, str) and name else f"#{number}"
    said = keys.get("kind")
    kind = said if isinstance(said, str) else ""
    keys = with_plain_names(kind, keys)
    unnamed = "missing" if name is None else f"{name!r} is no text"
    found = [("id", f"{unnamed} (a name for the claim)")] if id_ != name else []
    found += faults(kind, keys)
    found += [
        (key, f"a backslash and a letter became one sign here{_TWICE if file.endswith('.json') else _QUOTES}")
        for key in keys
        if _eaten(keys[key])
    ]
    expect = keys.get("expect", "")
    if expect not in ("", "holds", "fails"):
        found.append(("expect", "write holds or fails"))
    budget = keys.get("budget", int(DEFAULT_BUDGET))
    usable = (
        isinstance(budget, (int, Decimal)) and not isinstance(budget, bool) and MIN_BUDGET <= budget <= 3600
    )
    if not usable:
        found.append(("budget", f"write a number of seconds from {MIN_BUDGET} to 3600"))
    points = keys.get("points", 1)
    if isinstance(points, (int, Decimal)) and not 0 < points <= MOST_POINTS:
        found.append(("points", f"write a number of points above 0, at most {MOST_POINTS}"))
    return Claim(
        id_,
        kind,
        FrozenMapping(keys),
        expect=str(expect),
        budget=float(budget) if usable else DEFAULT_BUDGET,
        errors=tuple(ClaimError(id_, key, reason, file=file) for key, reason in found),
        file=file,
    )
