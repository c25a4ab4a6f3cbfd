"""Hamiltonians as text: for study files, keys and workers."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.user_input import counted
from canon.printable import in_one_line
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.expression.parse import Scope
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

__all__ = [
    "Formula", "check_declared", "entries_of", "formula_from", "formula_of", "hamiltonian_of", "names_of", "number_of",
    "require_labels", "scope_of",
]  # fmt: skip

MOST_NAMES = 500
"""Names of coordinates, momenta and parameters that a system of a study file may have."""

LONGEST_NAME = 80
"""Letters of a name."""

_OF_TEX = frozenset("\\{}")
"""Signs in the names of symbols that SymPy prints in TeX, which the expression language does not have."""

KEYS = ("H", "q", "p", "parameters", "starts", "period")
"""What a table in a file may say of a system."""


@dataclass(frozen=True)
class Formula:
    """A Hamiltonian written in canon's expression language; nothing in it is executed.

    Parameters
    ----------
    name
        What it is called.
    H
        H(q, p, t) as text; the time is ``t``.
    q, p
        Names of the coordinates and of their momenta.
    parameters
        Names and values of the constants.
    starts
        Names and states (q, p); the first is the default.
    period
        Period of a typical motion, None where none is known.

    Examples
    --------
    >>> quartic = Formula("quartic", "p**2/2 + k*q**4/4", ("q",), ("p",), (("k", 2.0),))
    >>> hamiltonian_of(quartic).p_dot
    (-k*q**3,)
    """

    name: str
    H: str
    q: tuple[str, ...]
    p: tuple[str, ...]
    parameters: tuple[tuple[str, float], ...] = ()
    starts: tuple[tuple[str, tuple[float, ...]], ...] = ()
    period: float | None = None

    def __post_init__(self) -> None:
        check_declared(self.name, (*self.q, *self.p), self.parameters, self.starts, self.period)
        if not self.q or len(self.q) != len(self.p):
            raise StudyError(
                f"{self.name}: {counted(len(self.q), 'coordinate')} and "
                f"{counted(len(self.p), 'momentum', 'momenta')}; each coordinate needs one"
            )
        for name, state in self.starts:
            self.check(state, f"the start {name!r}")

    def check(self, state: Sequence[float], what: str) -> None:
        """Raise StudyError where a state has not 2n finite numbers."""
        if len(state) != 2 * len(self.q) or not all(map(math.isfinite, state)):
            raise StudyError(
                f"{self.name}: {what} needs {2 * len(self.q)} finite numbers (q, p), not {list(state)}"
            )

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold of this system."""
        return {
            "name": self.name,
            "H": self.H,
            "q": list(self.q),
            "p": list(self.p),
            "parameters": dict(self.parameters),
            "starts": {name: list(state) for name, state in self.starts},
            "period": self.period,
        }

    @staticmethod
    def from_dict(written: Mapping[str, Any]) -> Formula:
        """Return the system that :meth:`to_dict` wrote."""
        return Formula(
            name=written["name"],
            H=written["H"],
            q=tuple(written["q"]),
            p=tuple(written["p"]),
            parameters=tuple(written["parameters"].items()),
            starts=tuple((name, tuple(state)) for name, state in written["starts"].items()),
            period=written["period"],
        )


def formula_from(name: str, table: Mapping[str, Any]) -> Formula:
    """Return the system that a table of a study file describes.

    Parameters
    ----------
    name
        What it is called there.
    table
        ``H``; ``q`` and ``p`` as lists or with spaces between (``p`` may be left out: ``p_<coordinate>``);
        ``parameters``, ``starts`` and ``period`` where there are any.

    Raises
    ------
    StudyError
        Where a key is missing, unknown or of the wrong kind, or H can't be read.

    Examples
    --------
    >>> formula_from("pendulum", {"H": "p_a**2/2 - cos(a)", "q": "a", "starts": {"high": [3.0, 0.0]}})
    Formula(name='pendulum', H='p_a**2/2 - cos(a)', q=('a',), p=('p_a',), ...
    """
    require_labels(name)
    unknown = sorted(set(table) - set(KEYS))
    if unknown:
        raise StudyError(
            f"system {name[:LONGEST_NAME]}: unknown key {unknown[0][:60]!r}; there are {', '.join(KEYS)}"
        )
    for key in ("H", "q"):
        if key not in table:
            raise StudyError(f"system {name}: {key!r} is missing")
    try:
        q = names_of(table["q"])
        period = table.get("period")
        found = Formula(
            name=name,
            H=_text(table["H"]),
            q=q,
            p=names_of(table["p"]) if "p" in table else tuple(f"p_{x}" for x in q),
            parameters=tuple(
                (key, number_of(value))
                for key, value in entries_of(table.get("parameters", {}), "parameters").items()
            ),
            starts=tuple(
                (key, _numbers(state)) for key, state in entries_of(table.get("starts", {}), "starts").items()
            ),
            period=None if period is None else number_of(period),
        )
    except (TypeError, OverflowError) as error:
        raise StudyError(f"system {name[:LONGEST_NAME]}: {str(error)[:500]}") from error
    hamiltonian_of(found)
    return found


def formula_of(
    hamiltonian: HamiltonianSystem,
    name: str = "Hamiltonian",
    *,
    parameters: Mapping[str, float] | None = None,
    starts: Mapping[str, Sequence[float]] | None = None,
    period: float | None = None,
) -> Formula:
    """Return a Hamiltonian as text that reads back as the same expression.

    Parameters
    ----------
    hamiltonian
        The Hamiltonian, such as :class:`canon.Hamiltonian`. Floats in it are taken for the numbers they are.
    name, parameters, starts, period
        As :class:`Formula` takes them.

    Raises
    ------
    StudyError
        Where the expression language has no words for it, or a parameter has no value.

    Examples
    --------
    >>> from canon import Hamiltonian, coordinates, parameters
    >>> x, k = coordinates("x"), parameters("k", positive=True)
    >>> formula_of(Hamiltonian(x.momentum**2/2 + k*x**4/4, [x], [x.momentum]), parameters={"k": 2.0}).H
    'k*x**4/4 + p_x**2/2'
    """
    import sympy as sp

    exact: dict[Any, Any] = {x: _exact(x) for x in hamiltonian.H.atoms(sp.Float)}
    H: Any = hamiltonian.H.xreplace(exact)
    own = {*hamiltonian.q, *hamiltonian.p, hamiltonian.t}
    given = {str(key) for key in parameters or {}}
    if missing := sorted(str(s) for s in H.free_symbols if s not in own and str(s) not in given):
        raise StudyError(f"{name} holds {', '.join(missing)}: give each a value, parameters={{name: value}}")
    if hamiltonian.t in H.free_symbols and str(hamiltonian.t) != "t":
        raise StudyError(f"{name}: in a study the time is called t, not {hamiltonian.t}")
    formula = Formula(
        name=name,
        H=str(H.xreplace({s: sp.Symbol(_spelled(s.name)) for s in H.free_symbols if {*s.name} & _OF_TEX})),
        q=tuple(map(str, hamiltonian.q)),
        p=tuple(map(str, hamiltonian.p)),
        parameters=tuple((str(key), float(value)) for key, value in (parameters or {}).items()),
        starts=tuple((key, tuple(map(float, state))) for key, state in (starts or {}).items()),
        period=period,
    )
    read = hamiltonian_of(formula)
    if _by_name(read.H) != _by_name(H):
        raise StudyError(
            f"{name}: the expression language has no words for {formula.H}; write H as text, as in a study file"
        )
    return formula


@lru_cache(maxsize=64)
def hamiltonian_of(formula: Formula) -> Hamiltonian:
    """Return the Hamiltonian that the text spells.

    Raises
    ------
    StudyError
        With the place in the text and the remedy, where it can't be read.
    """
    from sympy import Symbol

    from canon.expression.parse import LanguageError, parse_expression
    from canon.expression.symbols.symbol import Coordinate, Momentum
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

    try:
        q = [Coordinate(name, real=True) for name in formula.q]
        p = [Momentum(name, real=True) for name in formula.p]
        constants = [Symbol(name, real=True) for name, _ in formula.parameters]
        H = parse_expression(formula.H, scope_of((*q, *p, *constants)))
    except LanguageError as error:
        raise StudyError(f"system {formula.name}, H: {error}") from error
    return Hamiltonian(H, q, p)


def scope_of(symbols: Sequence[Symbol]) -> Scope:
    """Return the scope in which these are declared, θ by the name theta too: the language spells Greek letters out."""
    from canon.expression.parse import Scope

    names = {symbol.name: symbol for symbol in symbols}
    plain = {_spelled(name): symbol for name, symbol in names.items()}
    return Scope(names, other_names={name: symbol for name, symbol in plain.items() if name not in names})


def _spelled(name: str) -> str:
    r"""Return a name as the language reads it: ω₀ and TeX's \omega_0 as omega_0; another name as it is."""
    from canon.expression.text.tokens import LanguageError, tokens

    try:
        word, *rest = tokens("".join(sign for sign in name if sign not in _OF_TEX))
    except LanguageError:
        return name
    plain = (
        word.kind == "name" and len(rest) == 1 and not word.primes and not any(a.rates for a in word.atoms)
    )
    return word.text if plain else name


def check_declared(
    name: str,
    variables: Sequence[str],
    parameters: Sequence[tuple[str, float]],
    starts: Sequence[tuple[str, Sequence[float]]],
    period: float | None,
) -> None:
    """Raise StudyError where names of a system are too many, too long or given twice, or numbers make no sense."""
    require_labels(name, *(start for start, _ in starts))
    names = [*variables, *(parameter for parameter, _ in parameters)]
    if len(names) > MOST_NAMES:
        raise StudyError(f"{name}: more than {MOST_NAMES} names; write larger systems in Python")
    if long := [each for each in names if len(each) > LONGEST_NAME]:
        raise StudyError(f"{name}: {long[0][:LONGEST_NAME]!r}… is a name of {len(long[0])} letters")
    if twice := sorted({each for each in names if names.count(each) > 1}):
        raise StudyError(f"{name}: {twice[0]!r} is declared twice")
    for parameter, value in parameters:
        if not math.isfinite(value):
            raise StudyError(f"{name}: the parameter {parameter} = {value} is not a finite number")
    if period is not None and not (math.isfinite(period) and period > 0.0):
        raise StudyError(f"{name}: a period of {period} makes no sense: give a positive number")


def _exact(x: Any) -> Expr:
    """Return the number that a Float is."""
    import sympy as sp

    numerator, denominator = x.as_integer_ratio()
    return sp.Rational(int(numerator), int(denominator))


def _by_name(f: Any) -> Any:
    """Return an expression in plain symbols, whatever is assumed of them."""
    import sympy as sp

    return f.xreplace({symbol: sp.Symbol(str(symbol), real=True) for symbol in f.free_symbols})


def names_of(written: Any) -> tuple[str, ...]:
    """Return names from a list, or from text with spaces or commas between them."""
    names = written.replace(",", " ").split() if isinstance(written, str) else list(written)
    if not all(isinstance(name, str) and name.isidentifier() for name in names):
        raise TypeError(f"names are words, such as theta or x_1, not {reprlib.repr(written)}")
    return tuple(names)


def _text(written: Any) -> str:
    if not isinstance(written, str):
        raise TypeError(f"H is text in quotation marks, not {reprlib.repr(written)}")
    return written


def number_of(written: Any) -> float:
    """Return what is written as a number."""
    if isinstance(written, bool) or not isinstance(written, int | float):
        raise TypeError(f"{reprlib.repr(written)} is no number")
    return float(written)


def entries_of(written: Any, key: str) -> Mapping[str, Any]:
    """Return what is written as a table of names and values."""
    if not isinstance(written, Mapping):
        raise TypeError(f"{key} is a table of names and values, not {reprlib.repr(written)}")
    return written


def _numbers(written: Any) -> tuple[float, ...]:
    if not isinstance(written, list | tuple):
        raise TypeError(f"a start is a list of numbers (q, p), not {reprlib.repr(written)}")
    return tuple(map(number_of, written))


def require_labels(*names: str) -> None:
    """Raise StudyError where a name is long, has several lines, or commands a terminal: it stands in tables."""
    for name in names:
        if not 0 < len(name) <= LONGEST_NAME or in_one_line(name) != name:
            raise StudyError(
                f"something is called {name[:LONGEST_NAME]!r}: give it a name of one line, "
                f"at most {LONGEST_NAME} letters, and no signs that command a terminal"
            )
