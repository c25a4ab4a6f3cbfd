"""Key shapes: the keys of a claim, their form and size, checked before anything in it is read.

What is found here costs time in proportion to the sheet, whatever stands in it.
"""

from __future__ import annotations

import difflib
import math
import re
import unicodedata
from collections.abc import Mapping
from decimal import Decimal
from itertools import islice
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.kind import COMMON, Shape
from canon.exercise.sheet.kinds import KINDS, kind_of
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from canon.exercise.sheet.kind import Kind

__all__ = ["ASSUMPTIONS", "MAX_NAMES", "declared_names", "faults", "plain_name", "with_plain_names"]

ASSUMPTIONS = ("positive", "negative", "nonzero", "real", "integer")
MAX_FAULTS = 20
"""Faults of one claim that are told; a claim made of faults is not listed to its end."""
MAX_NAMES = 500
"""Most names in one list or table of a claim."""
MAX_DIGITS = 1_000
"""Most digits of a number that stands bare in a sheet."""
_MAX_BITS = 3_320


def faults(kind: str, keys: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what is wrong with the keys of a claim: pairs of a key and a reason, the first few.

    Examples
    --------
    >>> faults("equality-only", {"lhs": "1", "rsh": "2"})
    [('rhs', 'missing (an expression)'), ('rsh', 'unknown key for the kind equality-only; is rhs meant?')]
    """
    return list(islice(_faults(kind, keys), MAX_FAULTS))


def with_plain_names(kind: str, keys: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the keys of a claim with every name that it declares in plain spelling, ``theta`` for θ.

    Texts read both spellings in any case. Two names that would be one stay as they are, and are refused.

    Examples
    --------
    >>> with_plain_names("euler-lagrange", {"q": ["θ₁"], "parameters": {"ω": "positive"}, "L": "θ₁'**2"})
    {'q': ['theta_1'], 'parameters': {'omega': 'positive'}, 'L': "θ₁'**2"}
    """
    shapes = {**COMMON, **(kind_of(kind, keys).shapes if kind in KINDS else {})}
    named = {key: _with_plain_names(value, shapes.get(key)) for key, value in keys.items()}
    return keys if all(named[key] is keys[key] for key in keys) else named


def plain_name(name: Any) -> Any:
    """Return a name with Greek letters and small figures in plain spelling; π, which is a number, stays.

    Examples
    --------
    >>> plain_name("φ₁"), plain_name("π")
    ('phi_1', 'π')
    """
    if not isinstance(name, str) or name.isascii() or "π" in name:
        return name
    plain = "".join(GREEK.get(letter, letter) for letter in name)
    return re.sub("[₀-₉]+", lambda figures: f"_{unicodedata.normalize('NFKC', figures.group())}", plain)


def _with_plain_names(value: Any, shape: Shape | None) -> Any:
    """Return what stands under a key of names with plain ones; what has none of others is returned as it is."""
    found = value
    if shape in _TABLES_OF_NAMES and isinstance(value, Mapping):
        found = _with_plain_keys(value, shape)
    elif shape is Shape.VALUES and isinstance(value, list):
        found = [_with_plain_names(item, shape) for item in value]
    elif shape is Shape.NAMES:
        found = [plain_name(name) for name in value] if isinstance(value, list) else plain_name(value)
    return value if found == value else found


def _with_plain_keys(table: Mapping[str, Any], shape: Shape) -> Mapping[str, Any]:
    """Return a table of names with plain ones, and itself where two of them would be one."""
    arguments = Shape.NAMES if shape is Shape.FUNCTIONS else None
    found = {plain_name(name): _with_plain_names(item, arguments) for name, item in table.items()}
    return found if len(found) == len(table) else table


def declared_names(kind: str, keys: Mapping[str, Any]) -> set[str]:
    """Return the names that a claim declares, whatever stands in it.

    Examples
    --------
    >>> sorted(declared_names("euler-lagrange", {"q": ["x"], "parameters": {"m": "positive"}, "L": "k"}))
    ['m', 't', 'x']
    """
    shapes = kind_of(kind, keys).shapes if kind in KINDS else {}
    listed = (keys.get(key) for key, shape in shapes.items() if shape is Shape.NAMES)
    tables = (keys.get(key) for key in ("parameters", "functions"))
    found = [keys.get("t", "t")]
    for value in (*listed, *tables):
        found += value if isinstance(value, list | Mapping) else [value]
    return {name for name in found if isinstance(name, str)}


def _faults(kind: str, keys: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    if kind not in KINDS:
        close = difflib.get_close_matches(kind[:60], KINDS, n=2, cutoff=0.5)
        remedy = f"is {' or '.join(close)} meant?" if close else f"known are {', '.join(KINDS)}"
        yield "kind", f"unknown kind {kind[:60]!r}; {remedy}" if kind else f"missing; {remedy}"
        return
    wanted = kind_of(kind, keys)
    if wanted.about and isinstance(keys.get("of"), str) and keys["of"] not in wanted.about:
        yield "of", f"should be one of {', '.join(wanted.about)}"
        return
    known = {**COMMON, **wanted.shapes}
    yield from _missing_or_double(kind, wanted, keys)
    yield from _of_two_ways(wanted, keys)
    yield from _empty_answer(wanted, known, keys)
    for key, value in keys.items():
        if key not in known:
            close = difflib.get_close_matches(key[:60], known, n=1, cutoff=0.6)
            remedy = f"is {close[0]} meant?" if close else f"known are {', '.join(known)}"
            yield key[:60], f"unknown key for the kind {kind}; {remedy}"
        elif isinstance(value, (list, Mapping)) and len(value) > MAX_NAMES:
            yield key, f"{len(value)} entries, and at most {MAX_NAMES} are read; split the claim"
        elif not _fits(value, known[key]):
            yield key, f"should be {known[key].value}{_remedy(value, known[key])}"


def _missing_or_double(kind: str, wanted: Kind, keys: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield keys that a kind needs and that are not there, and those of two groups where one should be given."""
    for key, shape in wanted.required.items():
        if key not in keys:
            yield key, f"missing ({shape.value})"
    complete = [group for group in wanted.one_of if all(key in keys for key in group)]
    if wanted.one_of and not complete:
        groups = " or ".join(" with ".join(group) for group in wanted.one_of)
        yield wanted.one_of[0][-1], f"missing; a claim of kind {kind} needs {groups}"
    if wanted.exclusive and len(complete) > 1:
        groups = " and ".join(" with ".join(group) for group in complete)
        yield complete[1][-1], f"{groups} both say what it is about; leave one out"
    for group in wanted.one_of if complete else ():
        yield from _half_claimed(group, complete, wanted, keys)


def _half_claimed(
    group: Sequence[str], complete: Sequence[Sequence[str]], wanted: Kind, keys: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """Yield what is lacking of a group of which a part is claimed beside another whole one, and would not be judged."""
    lacking = [key for key in group if key not in keys]
    told = {key for other in (*complete, *wanted.ways) for key in other}
    given = [key for key in group if key in keys and key in wanted.answer and key not in told]
    if lacking and given:
        yield lacking[0], f"missing; {_listed(given)} would be passed over without it"


def _of_two_ways(wanted: Kind, keys: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield keys that do not go with others, as they belong to another way of saying the same thing.

    They would be passed over in silence, or names that they declare taken for constants.
    """
    given = {key for way in wanted.ways for key in way if key in keys}
    best = max(wanted.ways, key=lambda way: (len(given & {*way}), -len(way)), default=())
    strays = [key for key in keys if key in given and key not in best]
    if strays:
        fits = [key for key in best if key in keys]
        yield strays[0], f"{_listed(strays)} can't stand beside {_listed(fits)}; leave one or the other out"


def _listed(keys: Sequence[str]) -> str:
    """Return keys in words.

    Examples
    --------
    >>> _listed(["q"]), _listed(["q", "p", "H"])
    ('q', 'q, p and H')
    """
    *others, last = keys
    return f"{', '.join(others)} and {last}" if others else last


def _empty_answer(
    wanted: Kind, known: Mapping[str, Shape], keys: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    given = [key for key in wanted.answer if key in keys and known[key] is not Shape.VALUES]
    if given and all(keys[key] in ([], {}) and _fits(keys[key], known[key]) for key in given):
        yield given[0], "nothing is claimed: the answer is empty"
    elif empty := [key for key in given if keys[key] == {}]:
        yield empty[0], "nothing is claimed here: the table is empty; leave it out, or say what is in it"


def _remedy(value: Any, shape: Shape) -> str:
    """Say which entry is at fault, where one is."""
    table = value if isinstance(value, Mapping) else {}
    if shape in _OF_NAMES:
        names = [value] if isinstance(value, str) else value if isinstance(value, list) else table
        wrong = next((name for name in names if isinstance(name, str) and not _name(name)), None)
        if wrong is not None:
            return _remedy_of_name(wrong)
    for name, item in table.items():
        if shape is Shape.ASSUMPTIONS and item not in ASSUMPTIONS:
            return f"; {name} is {', '.join(ASSUMPTIONS[:-1])} or {ASSUMPTIONS[-1]}, not {str(item)[:60]!r}"
        if shape is Shape.BOX and not _interval(item):
            return f"; that of {name} should be two numbers, the smaller one first"
    return ""


def _remedy_of_name(wrong: str) -> str:
    plain = "".join(GREEK.get(letter, letter) for letter in wrong)
    return f"; write {plain} for {wrong[:60]}" if _name(plain) else f"; {wrong[:60]!r} is not a name"


_TABLES_OF_NAMES = (
    Shape.ASSUMPTIONS, Shape.DIMENSIONS, Shape.FUNCTIONS, Shape.BOX, Shape.EXPRESSIONS, Shape.VALUES,
)  # fmt: skip
"""Shapes of tables by names."""
_OF_NAMES = (Shape.NAMES, Shape.ASSUMPTIONS, Shape.DIMENSIONS, Shape.FUNCTIONS, Shape.BOX, Shape.EXPRESSIONS)


def _number(value: Any) -> bool:
    """Whether a bare number is one of a length that anyone means; the others cost more than their text."""
    if isinstance(value, bool) or not isinstance(value, (int, Decimal)):
        return False
    if isinstance(value, int):
        return value.bit_length() <= _MAX_BITS
    return (
        value.is_finite()
        and len(value.as_tuple().digits) <= MAX_DIGITS
        and abs(value.adjusted()) <= MAX_DIGITS
    )


def _text(value: Any) -> bool:
    return isinstance(value, str) or _number(value)


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
        case Shape.TEXT:  # a list of one is read as the one
            return _text(value) or (isinstance(value, list) and len(value) == 1 and _text(value[0]))
        case Shape.TEXTS:
            return _texts(value) or value == []
        case Shape.NAMES:
            return _names(value)
        case Shape.WORD:
            return isinstance(value, str)
        case Shape.TRUE:
            return value is True
        case Shape.SWITCH:
            return isinstance(value, bool)
        case Shape.NUMBER:
            return _number(value)
        case Shape.ASSUMPTIONS:
            return _table(value) and all(item in ASSUMPTIONS for item in value.values())
        case Shape.DIMENSIONS:
            return _table(value) and all(_text(item) for item in value.values())
        case Shape.FUNCTIONS:
            return _table(value) and all(_names(item) and item != [] for item in value.values())
        case Shape.BOX:
            return _table(value) and all(_interval(item) for item in value.values())
        case Shape.EXPRESSIONS:
            return _table(value) and all(_text(item) for item in value.values())
        case Shape.LISTS:
            return _table(value) and all(_texts(item) for item in value.values())
        case Shape.BRACKETS:
            return _bracket(value) or _are(value, _bracket)
        case Shape.BODIES:
            return _are(value, _body)
        case Shape.FORCES:
            return _are(value, _force)
        case Shape.WORDS:
            return isinstance(value, str) or _are(value, lambda word: isinstance(word, str))
        case Shape.VALUES:  # one table is read as a list of one
            tables = [value] if isinstance(value, Mapping) else value
            return isinstance(tables, list) and all(_fits(item, Shape.EXPRESSIONS) for item in tables)


def _are(value: Any, fits: Callable[[Any], bool]) -> bool:
    """Whether this is a list, not empty, of what fits."""
    return isinstance(value, list) and len(value) > 0 and all(fits(item) for item in value)


def _interval(value: Any) -> bool:
    if not isinstance(value, list) or len(value) != 2:
        return False
    return all(_number(end) or _float(end) for end in value) and value[0] < value[1]


def _float(value: Any) -> bool:
    """Whether this is a finite float, as a hint given from Python may be; sheets have decimals."""
    return isinstance(value, float) and math.isfinite(value)


def _bracket(value: Any) -> bool:
    return (
        _table(value)
        and set(value) in ({"f", "g", "value"}, {"u", "v", "value"})
        and all(map(_text, value.values()))
    )


def _body(value: Any) -> bool:
    if not _table(value) or not set(value) <= {"m", "r", "I", "angle", "omega"}:
        return False
    if ("m" in value) != ("r" in value) or {"angle", "omega"} <= set(value):
        return False
    point, rotor = "m" in value, bool({"angle", "omega"} & set(value))
    return (point or rotor) and rotor == ("I" in value) and all(_texts(item) for item in value.values())


def _force(value: Any) -> bool:
    if not _table(value) or set(value) not in ({"F", "r"}, {"torque", "angle"}, {"torque", "omega"}):
        return False
    return all(_texts(item) for item in value.values())
