r"""Vectors that a claim makes known: ``\ddot{\vec r}``, ``\nabla V``, ``(\vec r \times \vec p)_z``, a body's place.

They are known where all coordinates are Cartesian, or where one body is given by its place. Names that are declared
keep their meaning.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.symbol import Coordinate, time_derivative, velocity

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Expr

    from canon.expression.text.scope import Scope

__all__ = [
    "vectors_in",
    "with_angular_momenta",
    "with_place_of_body",
    "with_speeds",
    "without_cross_products",
]

_AXES = ("x", "y", "z")
_CROSS = re.compile(
    r"(?:\\left\s?)?[(\[](?P<first>[^()\[\]=+×]{1,40}?)(?:\\times(?![A-Za-z])|×)(?P<second>[^()\[\]=+×]{1,40}?)"
    r"(?:\\right\s?)?[)\]]\s?_\s?(?:\{\s?(?P<braced>[xyz])\s?\}|(?P<axis>[xyz])(?!\w))"
)
_DRESS = re.compile(r"\\(?:vec|mathbf|boldsymbol|bm|left|right|[,;:! ])(?![A-Za-z])|[\s{}\u20d7]")
_VECTOR = re.compile(r"(?P<factor>.*?)(?P<vector>\\dot\s?r|r\u0307|ṙ|[rpv])")
_BOLD = r"\\(?:vec|mathbf|boldsymbol|bm)(?![A-Za-z])"
_SPEED = re.compile(
    r"(?P<bar>\\[lr]?vert\s?|\|)?"
    rf"(?:\\dot\s?\{{?\s?{_BOLD}\s?\{{?\s?r\s?\}}{{0,2}}|{_BOLD}\s?\{{?\s?(?:\\dot\s?\{{?\s?r\s?\}}?|v)\s?\}}?)"
    r"(?(bar)\s?(?:\\r?vert(?![A-Za-z])|\|))\s?(?=\^\s?\{?2)"
)
"""A velocity as a vector, with or without bars, before a square."""
_ARROW = re.compile(
    rf"\\[dt]?frac\s?\{{\s?d(?P<order>\s?\^\s?(?:2|\{{\s?2\s?\}}))?\s?{_BOLD}\s?\{{?\s?r\s?\}}?\s?\}}"
    r"\s?\{\s?dt(?(order)\s?\^\s?(?:2|\{\s?2\s?\}))\s?\}|"
    rf"\\(?P<dots>d?dot)\s?\{{?\s?{_BOLD}\s?\{{?\s?r(?![A-Za-z])\s?\}}?\s?\}}?"
    rf"|{_BOLD}\s?\{{\s?\\(?P<inner>d?dot)\s?\{{?\s?r\s?\}}?\s?\}}|{_BOLD}\s?\{{?\s?(?P<letter>[rva])(?![A-Za-z])\s?\}}?"
    r"|(?P<plain>[rvaṙ])(?P<above>[\u0307\u0308]?)\u20d7(?P<after>[\u0307\u0308]?)"
)
"""Vectors of the place and its rates, in bold type or with an arrow."""
_INDEX = r"_\s?(?:\{\s?[xyz]\s?\}|[xyz](?!\w))"
_DRESSED = rf"(?:{_BOLD}|\\hat(?![A-Za-z]))\s?"


def _dressed(letter: str) -> str:
    """Return the pattern of a letter in bold type, with an arrow or a hat."""
    bare = rf"(?:\{{\s?{letter}\s?\}}|{letter}(?![A-Za-z]))"
    return rf"{_DRESSED}(?:{bare}|\{{\s?{_DRESSED}{bare}\s?\}})"


_UNIT_VECTOR = re.compile(
    rf"{_dressed('e')}\s?{_INDEX}|{_DRESSED}\{{\s?e\s?{_INDEX}\s?\}}|{_dressed('(?:[xyz])')}"
)
"""Unit vectors along the axes, ``\\vec e_x``, ``\\hat{\\mathbf x}``."""
_GRADIENT = re.compile(
    rf"(?:{_BOLD}\s?\{{?\s?)?(?:\\nabla(?![A-Za-z])|∇)\s?\}}?\s?(?P<of>[A-Za-z]\w{{0,9}})"
    r"(?:\s?(?:\\left\s?)?\((?P<at>[\w, ]{0,20}?)(?:\\right\s?)?\))?(?![\w(^'])"
)
_RATES = {"dot": 1, "ddot": 2, "\u0307": 1, "\u0308": 2}
_LETTERS = {"\\dotr": "v", "r\u0307": "v", "ṙ": "v"}


def vectors_in(text: str, keys: Mapping[str, Any], scope: Scope) -> list[tuple[int, int, tuple[str, ...]]]:
    r"""Return where the known vectors of a text begin and end, and the components of each as they would be typed.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.parse import Scope
    >>> x, y = coordinates("x y")
    >>> scope = Scope({"x": x, "y": y}, {"V": ("x", "y")})
    >>> vectors_in(r"\ddot{\vec r} = -\nabla V", {"q": ["x", "y"]}, scope)
    [(0, 14, ('x_ddot', 'y_ddot')), (17, 25, ('\\frac{\\partial V}{\\partial x}', '\\frac{\\partial V}{\\partial y}'))]
    """
    q = [str(name) for name in keys["q"]] if isinstance(keys.get("q"), list) else []
    if len(q) < 2 or q != [axis for axis in _AXES if axis in q]:
        return []
    rates = [(place, _order(place, scope)) for place in _ARROW.finditer(text)]
    placed = [
        (*place.span(), tuple(f"{name}{('', '_dot', '_ddot')[order]}" for name in q))
        for place, order in rates
        if order is not None
    ]
    slopes = [
        (*place.span(), _slopes(place, q)) for place in _GRADIENT.finditer(text) if _is_slope(place, q, scope)
    ]
    return sorted([*placed, *slopes, *_unit_vectors(text, q, scope)])


def _unit_vectors(text: str, q: list[str], scope: Scope) -> Iterator[tuple[int, int, tuple[str, ...]]]:
    """Yield the unit vectors along the axes of the coordinates whose names are free."""
    for place in _UNIT_VECTOR.finditer(text):
        letters = re.sub(r"\\[A-Za-z]+", "", place.group())
        axis = re.findall("[xyz]", letters)[0]
        names = (f"e_{axis}", f"e{axis}", f"{axis}_hat", f"hat_{axis}", f"{axis}hat")
        is_unit = "e" in letters or "\\hat" in place.group()
        if is_unit and axis in q and not any(map(scope.declares, names)):
            yield (*place.span(), tuple(str(int(name == axis)) for name in q))


def _is_slope(place: re.Match[str], q: list[str], scope: Scope) -> bool:
    """Tell whether a gradient is that of a declared function of all coordinates, in their order."""
    at = place["at"]
    return scope.functions.get(place["of"]) == tuple(q) and (at is None or re.findall(r"\w+", at) == q)


def _slopes(place: re.Match[str], q: list[str]) -> tuple[str, ...]:
    slope = r"\frac{{\partial {0}}}{{\partial {1}}}" if "\\" in place.string else "∂{0}/∂{1}"
    return tuple(slope.format(place["of"], name) for name in q)


def _order(place: re.Match[str], scope: Scope) -> int | None:
    """Return how often the place is differentiated in a vector; None where its letter is declared."""
    letter = place["letter"] or place["plain"] or "r"
    dots = place["dots"] or place["inner"] or place["above"] or place["after"]
    if "frac" in place.group():
        return None if scope.declares("r") else 1 + bool(place["order"])
    order = _RATES.get(dots or "", 0) + {"r": 0, "ṙ": 1, "v": 1, "a": 2}[letter]
    letter = letter.replace("ṙ", "r")
    return None if scope.declares(letter) or letter in scope.functions or order > 2 else order


def without_cross_products(text: str, keys: Mapping[str, Any], scope: Scope) -> tuple[str, dict[str, Expr]]:
    r"""Return a text with names in place of components of cross products that are known, and their values.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.parse import Scope
    >>> x, y = coordinates("x y")
    >>> scope, keys = Scope({"x": x, "y": y}), {"q": ["x", "y"], "L": "x_dot**2/2 + y_dot**2/2"}
    >>> without_cross_products(r"(\vec r\times\vec p)_z", keys, scope)
    (' Cross_0 ', {'Cross_0': x*y_dot - x_dot*y})
    """
    values: dict[str, Expr] = {}

    def named(found: re.Match[str]) -> str:
        first, second = (_vector(found[which], keys, scope) for which in ("first", "second"))
        if first is None or second is None:
            return found.group()
        name = f"Cross_{len(values)}"
        values[name] = _component(first[1], second[1], found["braced"] or found["axis"])
        factors = "".join(f"({factor})" for factor, _ in (first, second) if factor)
        return f" {factors} {name} " if factors else f" {name} "

    return _CROSS.sub(named, text) if "times" in text or "×" in text else text, values


def with_angular_momenta(keys: Mapping[str, Any], scope: Scope) -> Scope:
    """Return a scope in which L_x, L_y and L_z are those of a particle whose coordinates and momenta are given.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.parse import Scope, parse_expression
    >>> x, y = coordinates("x y")
    >>> scope = Scope({s.name: s for s in (x, y, x.momentum, y.momentum)})
    >>> parse_expression("L_z", with_angular_momenta({"q": ["x", "y"], "p": ["p_x", "p_y"]}, scope))
    -p_x*y + p_y*x
    """
    places, momenta = _known("r", keys, scope), _known("p", keys, scope)
    if places is None or momenta is None or "L" in keys:
        return scope
    values = {f"L_{axis}": _component(places, momenta, axis) for axis in _AXES}
    return _with_values(scope, {name: value for name, value in values.items() if value != 0})


def with_place_of_body(keys: Mapping[str, Any], scope: Scope) -> Scope:
    """Return a scope in which x, y and z are the place of the one body that a claim gives, with their rates.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.parse import Scope, parse_expression
    >>> keys, scope = {"bodies": [{"m": "1", "r": ["s**2"]}]}, Scope({"s": coordinates("s")})
    >>> parse_expression("x' + x", with_place_of_body(keys, scope))
    s**2 + 2*s*s_dot
    """
    bodies = keys.get("bodies")
    if not (isinstance(bodies, list) and len(bodies) == 1 and "r" in bodies[0]):
        return scope
    entries = bodies[0]["r"] if isinstance(bodies[0]["r"], list) else [bodies[0]["r"]]
    try:
        place = [parse_expression(str(entry), scope) for entry in entries[: len(_AXES)]]
    except LanguageError:  # it is told where the body is read
        return scope
    q = [symbol for symbol in scope.names.values() if isinstance(symbol, Coordinate)]
    values: dict[str, Expr] = {}
    for axis, value in zip(_AXES, place, strict=False):
        first = time_derivative(value, q, scope.time)
        values |= {axis: value, f"{axis}_dot": first, f"{axis}_ddot": time_derivative(first, q, scope.time)}
    values["v"] = sp.sqrt(
        sp.Add(*(values[f"{axis}_dot"] ** 2 for axis, _ in zip(_AXES, place, strict=False)))
    )
    return _with_values(scope, values)


def with_speeds(text: str) -> str:
    r"""Return a text with v for the velocity of a body as a vector, where it is squared.

    Examples
    --------
    >>> with_speeds(r"\frac12 m\dot{\mathbf r}^2"), with_speeds(r"\frac12 m|\dot{\vec r}|^2"), with_speeds("m v²")
    ('\\frac12 m v ^2', '\\frac12 m v ^2', 'm v²')
    """
    return _SPEED.sub(" v ", text)


def _with_values(scope: Scope, values: Mapping[str, Expr]) -> Scope:
    """Return a scope with values of names that are not declared."""
    free = {
        name: value
        for name, value in values.items()
        if not scope.declares(name) and name not in scope.functions
    }
    bases = (name for name in free if not name.endswith(("_dot", "_ddot")))
    names = {name: Coordinate(name, real=True) for name in bases}
    return replace(scope, names={**scope.names, **names}, values={**scope.values, **free})


def _vector(text: str, keys: Mapping[str, Any], scope: Scope) -> tuple[str, dict[str, Expr]] | None:
    """Return the factor before a vector, and its components; None where it is not known."""
    found = _VECTOR.fullmatch(_DRESS.sub("", text))
    if found is None:
        return None
    letter = _LETTERS.get(found["vector"], found["vector"])
    vector = None if scope.declares(letter) else _known(letter, keys, scope)
    return None if vector is None else (found["factor"], vector)


def _known(letter: str, keys: Mapping[str, Any], scope: Scope) -> dict[str, Expr] | None:
    """Return the components of the place, the velocity or the momentum; None where coordinates are not Cartesian."""
    q = keys.get("q")
    if not isinstance(q, list) or not set(map(str, q)) <= set(_AXES):
        return None
    places = {str(name): scope.names[name] for name in q if name in scope.names}
    match letter:
        case "r":
            return dict(places)
        case "v":
            return {axis: velocity(x) for axis, x in places.items() if isinstance(x, Coordinate)}
        case _:
            return _momenta(places, keys, scope)


def _momenta(
    places: Mapping[str, sp.Symbol], keys: Mapping[str, Any], scope: Scope
) -> dict[str, Expr] | None:
    """Return the momenta that are declared, or those that follow from a given Lagrangian."""
    p = keys.get("p")
    if isinstance(p, list) and len(p) == len(places) and all(name in scope.names for name in p):
        return {axis: scope.names[name] for axis, name in zip(places, p, strict=True)}
    if not isinstance(keys.get("L"), str):
        return None
    try:
        L = parse_expression(keys["L"], scope)
    except LanguageError:  # it is told where it is read
        return None
    return {axis: L.diff(velocity(x)) for axis, x in places.items() if isinstance(x, Coordinate)}


def _component(first: Mapping[str, Expr], second: Mapping[str, Expr], axis: str) -> Expr:
    """Return one component of a cross product; what has no component is zero there."""
    after = _AXES[(_AXES.index(axis) + 1) % 3], _AXES[(_AXES.index(axis) + 2) % 3]
    a, b = after
    zero = sp.S.Zero
    return sp.expand(first.get(a, zero) * second.get(b, zero) - first.get(b, zero) * second.get(a, zero))
