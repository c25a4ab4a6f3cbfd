"""LaTeX as people type it: what each form means in SymPy's own spelling, and a twin that means something else."""

import json
import re
from functools import cache
from pathlib import Path

import pytest
import sympy as sp
from sympy.parsing.sympy_parser import parse_expr

from canon import coordinates, parameters
from canon.expression.parse import LanguageError, Scope, parse_equation, parse_expression, statements_of
from canon.expression.symbols.symbol import Coordinate, Momentum, time

FOLDER = Path(__file__).parents[1] / "data" / "typed"
LABEL = re.compile(
    r"\w+(\([\w,']*\))?|\w+'|\{\w+,\w+\}|\[\w+,\w+\]|d\w+/dt|-?∂[A-Z]/∂\w+'?|[A-Z][-+][A-Z]|H\+∂F/∂t"
)
"""What names an answer, or a definition from a book."""
FILES = ("latex.json", "latex_held_out.json", "outside.json", "first_sight.json")


@cache
def corpus(name):
    return json.loads((FOLDER / name).read_text("utf-8"))


@cache
def scope_of(name):
    """Return the scope that a corpus names, and the same names for SymPy's parser."""
    said = next(
        corpus(file)["scopes"][name]
        for file in ("latex.json", "outside.json", "first_sight.json")
        if name in corpus(file)["scopes"]
    )
    q = [Coordinate(x, real=True) for x in said["q"].split()]
    names = {s.name: s for s in (*q, *parameters(said["parameters"]))}
    names |= {p: Momentum(p, real=True) for p in said["p"].split()}
    functions = {f: tuple(arguments) for f, arguments in said["functions"].items()}
    rates = {r.name: r for x in q for r in (x.dot, x.ddot)}
    applied = {f: sp.Function(f, real=True) for f in functions}
    known = {**names, **rates, **applied, "t": time, "lambda_": names.get("lambda")}
    return Scope(names, functions), known


def meant(text, name):
    """Return the sides of an equation in SymPy's spelling, read by SymPy alone."""
    known = scope_of(name)[1]
    plain = text.replace("lambda", "lambda_") if known["lambda_"] is not None else text
    return tuple(parse_expr(side, local_dict=known) for side in plain.split(" = "))


def read(form, name):
    """Return the sides of every statement; a side that is only a name of the answer or a definition is left out."""
    scope = scope_of(name)[0]
    found = []
    for statement in statements_of(form, scope):
        *names, last = statement.sides
        sides = [side for said in names if (side := value_or_name(said, scope)) is not None]
        found.append((*sides, (parse_expression if names else parse_equation)(last.text, scope)))
    return found


def value_or_name(side, scope):
    """Return the value of a side, None where it is made of names that are not declared."""
    try:
        return parse_expression(side.text, scope)
    except LanguageError:
        if not LABEL.fullmatch(side.said):
            raise
        return None


def agree(found, expected):
    """Whether two expressions are equal: after expansion, or in 20 digits at two points."""
    if sp.expand(found - expected) == 0:
        return True
    derivatives = found.atoms(sp.Derivative) | expected.atoms(sp.Derivative)
    applied = found.atoms(sp.core.function.AppliedUndef) | expected.atoms(sp.core.function.AppliedUndef)
    for k, atoms in enumerate((derivatives, applied)):
        dummies = {a: sp.Symbol(f"A{k}_{i}") for i, a in enumerate(sorted(atoms, key=sp.default_sort_key))}
        found, expected = found.xreplace(dummies), expected.xreplace(dummies)
    symbols = sorted(found.free_symbols | expected.free_symbols, key=str)
    for k in range(2):
        point = {s: sp.Rational(5 + 7 * i + 3 * k, 11 + 2 * i) for i, s in enumerate(symbols)}
        values = [sp.N(f.xreplace(point), 30) for f in (found, expected)]
        if not abs(values[0] - values[1]) < 1e-18 * (1 + abs(values[1])):
            return False
    return True


def says(form, entry):
    """Tell whether a form is read as an entry means it; None where it is not read."""
    try:
        found = read(form, entry["scope"])
    except LanguageError:
        return None
    expected = [meant(text, entry["scope"]) for text in entry["means"]]
    if [len(sides) for sides in found] != [len(sides) for sides in expected]:
        return False
    pairs = zip((s for sides in found for s in sides), (s for sides in expected for s in sides), strict=True)
    return all(agree(f, e) for f, e in pairs)


@pytest.mark.parametrize("name", FILES)
def test_typed_forms_are_read_and_none_is_read_wrongly(name):
    forms = corpus(name)["forms"]
    told = [(entry["form"], says(entry["form"], entry)) for entry in forms]
    wrong = [form for form, verdict in told if verdict is False]
    unread = [form for form, verdict in told if verdict is None]
    assert wrong == []
    assert len(unread) <= 0.02 * len(forms), "\n".join(unread)


def table():
    """Return the rows of the page on sheets: what is typed, and what it is read as."""
    page = (Path(__file__).parents[2] / "docs" / "sheets.md").read_text("utf-8")
    rows = page.split("| as typed | read as |\n|---|---|\n")[1].split("\n\n")[0].splitlines()
    cells = [row.strip("|").split(" | ") for row in rows]
    return [
        (form, meaning.strip(" `"))
        for typed, meaning in cells
        for form in re.findall(r"`([^`]+)`", typed)
        if form != "lam"
    ]


def test_the_table_on_the_page_is_true():
    names = {s.name: s for s in (*coordinates("x theta phi theta_1"), *parameters("m k g l lam"))}
    scope = Scope({**names, "p": Momentum("p", real=True)}, {"V": ("x",)})
    rows = table()
    assert len(rows) > 20
    for form, meaning in rows:
        last = statements_of(form, scope)[-1].sides[-1]
        assert sp.expand(parse_expression(last.text, scope) - parse_expression(meaning, scope)) == 0, form


@pytest.mark.parametrize("name", FILES)
def test_twins_are_not_taken_for_the_forms(name):
    taken = [entry["twin"] for entry in corpus(name)["forms"] if says(entry["twin"], entry)]
    assert taken == []


def test_what_is_open_is_refused():
    for entry in corpus("outside.json")["open"]:
        with pytest.raises(LanguageError):
            read(entry["form"], entry["scope"])
