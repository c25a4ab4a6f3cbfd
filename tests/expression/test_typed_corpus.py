"""Typed forms: formulas as people and programs write them, each read as it is meant, its twin never."""

import json
from hashlib import sha256
from pathlib import Path

import pytest
import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from canon.expression.parse import LanguageError, Scope, parse_equation
from canon.expression.symbols.symbol import Coordinate, Momentum

FOLDER = Path(__file__).parents[1] / "data" / "typed"
ALL = {path.stem: json.loads(path.read_text("utf-8")) for path in sorted(FOLDER.glob("*.json"))}
SHEETS = {name: sheet for name, sheet in ALL.items() if name == sheet.get("notation")}
"""LaTeX has its own."""
READ = 0.98
"""Least share of the forms that are read."""


def scope_of(sheet):
    names = {name: Coordinate(name, real=True) for name in sheet["coordinates"]}
    names |= {name: Momentum(name, real=True) for name in sheet["momenta"]}
    names |= {name: sp.Symbol(name, positive=True) for name in sheet["parameters"]}
    functions = {name: tuple(arguments) for name, arguments in sheet["functions"].items()}
    return Scope(names, functions, moving=frozenset(sheet["coordinates"]) | frozenset(sheet["momenta"]))


def meant(text, scope):
    """Return the meaning by SymPy's own parser, which knows nothing of what is tested here."""
    names = {name: scope.symbol(name) for name in (*scope.names, "t")}
    moving = [name for name, symbol in scope.names.items() if isinstance(symbol, Coordinate)]
    rates = {f"{name}{end}" for name in moving for end in ("_dot", "_ddot")}
    names |= {name: scope.symbol(name) for name in rates}
    names |= {name: sp.Function(name, real=True) for name in scope.functions}
    return parse_expr(text, local_dict=names)


def values(formula):
    """Return the values of a formula at points drawn once and for all, to 30 digits."""
    formula = formula.subs(sp.Function("V", real=True), sp.Lambda(sp.Symbol("u"), sp.Symbol("u") ** 3)).doit()
    symbols = sorted(formula.free_symbols, key=str)
    draws = ([sp.Rational(hash_of(f"{s}{i}") % 89 + 10, 101) for s in symbols] for i in range(3))
    return [formula.subs(dict(zip(symbols, point, strict=True))).evalf(30) for point in draws]


def hash_of(text):
    return int.from_bytes(sha256(text.encode()).digest()[:4], "big")


def same(read, meaning, factor=False):
    """Tell whether two formulas have the same values, those of an equation up to a number as factor."""
    if not factor:
        return all(abs(v) < 1e-20 for v in values(read - meaning))
    found = [a / b for a, b in zip(values(read), values(meaning), strict=True)]
    return bool(found[0] != 0) and all(abs(v - found[0]) < 1e-20 for v in found)


def readings(sheet):
    scope = scope_of(sheet)
    for form in sheet["forms"]:
        equation = "=" in form["form"] or "Eq(" in form["form"]
        meaning = meant(form["meaning"], scope)
        for kind in ("form", "twin"):
            try:
                read = parse_equation(form[kind], scope)
            except LanguageError as error:
                yield form, kind, None, error
                continue
            yield form, kind, same(read, meaning, equation), read


@pytest.mark.parametrize("notation", SHEETS)
def test_forms_are_read_as_they_are_meant_and_their_twins_are_not(notation):
    found = list(readings(SHEETS[notation]))
    wrong = [(f["form"], str(told)) for f, kind, right, told in found if kind == "form" and right is False]
    passed = [f["twin"] for f, kind, right, _ in found if kind == "twin" and right]
    unread = [(f["form"], told.message) for f, kind, right, told in found if kind == "form" and right is None]
    assert not wrong
    assert not passed
    assert len(unread) <= (1 - READ) * len(SHEETS[notation]["forms"]), unread
