"""Reading of a claim: its names and expressions as SymPy objects, its domain."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NoReturn

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.cached_property import cached_property
from canon.exercise.sheet.field_texts import texts_in
from canon.exercise.sheet.kept_parses import parsed
from canon.exercise.sheet.key_shapes import ASSUMPTIONS
from canon.exercise.sheet.kind import Kind, Shape
from canon.exercise.sheet.kinds import kind_of
from canon.exercise.sheet.sheet import Claim, ClaimError
from canon.exercise.sheet.typed_answers import typed_answers
from canon.expression.parse import (
    LanguageError,
    Scope,
    exact,
    parse_condition,
    parse_equation,
    parse_expression,
)
from canon.expression.symbols.symbol import Coordinate, Momentum, velocity
from canon.expression.symbols.user_input import counted
from canon.expression.text.units import units
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.pfaffian_form import displacements, divided_by_dt
from canon.proof.domain.domain import Domain
from canon.proof.rungs.ladder import is_empty

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.typed_answers import Link

__all__ = ["NAME_KEYS", "InvalidClaim", "Reading"]

_MAKERS: Mapping[str, Callable[..., Symbol]] = FrozenMapping(
    {"q": Coordinate, "p": Momentum, "quasi": Coordinate, "new_p": Momentum, "momenta": Momentum}
)
_OF_OMEGA = re.compile(r"w_?[0-9]?")
NAME_KEYS = (
    "q", "p", "x", "variables", "new_q", "new_p", "cyclic", "momenta",
    "multipliers", "quasi", "constants", "actions", "slow",
)  # fmt: skip
"""Keys that declare names."""


_MOVING = ("q", "p", "x", "variables", "new_q", "new_p", "quasi")
"""Keys of names that stand for what changes in time."""


class InvalidClaim(ValueError):
    """Raised for a claim that says nothing that could be judged; ``error`` names the key and the column."""

    def __init__(self, error: ClaimError) -> None:
        super().__init__(str(error))
        self.error = error


@dataclass(frozen=True)
class Reading:
    """A claim with its names resolved.

    Parameters
    ----------
    claim
        The claim as written; its form has been checked.
    links
        Equations between the sides of chains, each with the key under which it stands.
    passed
        What was passed over in reading left sides.
    units
        The unit behind a value, by its place in the claim.
    names
        Symbols that the judge of a kind adds to the declared ones, such as ``d_x`` and ``delta_x``.
    instead
        Expressions that are read in place of what stands under a key, such as ``"Q[0]"``.
    at
        Values put in for parameters.

    Raises
    ------
    InvalidClaim
        From any attribute or method, with the key and column at fault.
    """

    claim: Claim
    links: tuple[Link, ...] = ()
    passed: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=lambda: FrozenMapping({}))
    names: Mapping[str, Symbol] = field(default_factory=lambda: FrozenMapping({}))
    instead: Mapping[str, Expr] = field(default_factory=lambda: FrozenMapping({}))
    at: Mapping[Symbol, Expr] = field(default_factory=lambda: FrozenMapping({}))

    @classmethod
    def of(cls, claim: Claim) -> Reading:
        """Return a claim whose answers are as people type them, with left sides, chains, several equations in a text.

        Raises
        ------
        InvalidClaim
            Where a left side contradicts the question.
        """
        written = cls(claim)
        plain = typed_answers(claim, written.scope, written.error)
        keys = FrozenMapping(plain.keys)
        return cls(
            replace(claim, keys=keys), tuple(plain.links), tuple(plain.passed), FrozenMapping(plain.units)
        )

    def error(self, key: str, error: LanguageError) -> InvalidClaim:
        """Return the error of a text under a key."""
        return InvalidClaim(
            ClaimError(self.claim.id, key, error.message, error.column, error.caret(), self.claim.file)
        )

    def has(self, key: str) -> bool:
        """Whether the claim has this key."""
        return key in self.claim.keys

    def word(self, key: str) -> str:
        """Return a word as written."""
        return str(self.claim.keys[key])

    def fault(self, key: str, reason: str) -> NoReturn:
        """Refuse the claim for what stands under a key."""
        raise InvalidClaim(ClaimError(self.claim.id, key, reason, file=self.claim.file))

    def with_names(self, names: Mapping[str, Symbol]) -> Reading:
        """Return the same claim read with more names."""
        return replace(self, names=FrozenMapping({**self.names, **names}))

    def with_instead(self, key: str, expression: Expr) -> Reading:
        """Return the same claim with another expression under one key."""
        return replace(self, instead=FrozenMapping({**self.instead, key: expression}))

    def words(self, key: str) -> tuple[str, ...]:
        """Return a list of words as written."""
        return tuple(map(str, _as_list(self.claim.keys[key])))

    @cached_property
    def kind(self) -> Kind:
        """The kind of the claim."""
        return kind_of(self.claim.kind, self.claim.keys)

    @property
    def complete(self) -> bool:
        """Whether the answer should determine every unknown of its kind."""
        return self.claim.keys.get("complete") is True

    @cached_property
    def time(self) -> Symbol:
        """The symbol of the time."""
        name = str(self.claim.keys.get("t", "t"))
        if not (name.isidentifier() and name.isascii()):
            self.fault("t", "should be the name of the time")
        return Symbol(name, **self._assumptions(name))

    @cached_property
    def scope(self) -> Scope:
        """The declared names."""
        keys, names = self.claim.keys, self._variables()
        functions = {name: tuple(_as_list(args)) for name, args in keys.get("functions", {}).items()}
        for name in keys.get("parameters", {}):
            if name not in functions and name != self.time.name and not _is_rate(name, names):
                names.setdefault(name, Symbol(name, **self._assumptions(name)))
        if self.is_names("quasi"):
            rates = {f"{u}_dot": velocity(names[u]) for u in _as_list(keys["quasi"])}
            names = {**rates, **names}
        for name in functions:
            if name in names:
                self.fault("functions", f"{name} is declared as a symbol too")
        signs = {name: self._assumptions(name) for name in functions}
        for name, symbol in self._other_names(names):
            if name not in functions:
                names.setdefault(name, symbol)
        implicit = keys.get("implicit_multiplication") is True
        moving = frozenset(name for key in _MOVING if self.is_names(key) for name in _as_list(keys[key]))
        return Scope({**self.names, **names}, functions, self.time, signs, implicit, moving)

    def _other_names(self, names: Mapping[str, Symbol]) -> Iterator[tuple[str, Symbol]]:
        """Yield what else declared names are called: ``omega`` for w, ``p_theta`` for p, and p for ``p_theta``."""
        yield from [
            (f"omega{name[1:]}", symbol) for name, symbol in names.items() if _OF_OMEGA.fullmatch(name)
        ]
        if not (self.is_names("q") and self.is_names("p")):
            return
        pairs = list(zip(self.words("q"), self.words("p"), strict=False))
        yield from ((f"p_{q}", names[p]) for q, p in pairs if p != f"p{q}")  # which is read as p_q already
        if len(pairs) == 1 and pairs[0][1].startswith("p"):
            yield "p", names[pairs[0][1]]

    def _variables(self) -> dict[str, Symbol]:
        """Return the symbols of the names that stand under keys of their own, each declared once."""
        names: dict[str, Symbol] = {}
        declared = ((key, name) for key in NAME_KEYS if self.is_names(key) for name in self.words(key))
        for key, name in declared:
            if name == self.time.name:
                self.fault(key, f"{name} is the name of the time; choose another, or say t = 'tau'")
            if key == "cyclic":
                continue
            if name in names:
                self.fault(key, f"{name} is declared twice")
            real = key not in self.kind.complex_names
            said = self._assumptions(name) if real else {"complex": True}
            names[name] = _MAKERS.get(key, Symbol)(name, **said)
        for name in names:
            if _is_rate(name, names):
                self.fault("q", f"{name} is the velocity of a coordinate that is declared too; rename one")
        return names

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is passed over in reading the claim: units after numbers."""
        shapes = {**self.kind.shapes, "domain": Shape.TEXTS}
        said = {
            key: value
            for key, value in self.claim.keys.items()
            if key in shapes and shapes[key] not in (Shape.NAMES, Shape.WORD)
        }
        found = {(key, unit.text): None for key, text in texts_in(said) for unit in units(text, self.scope)}
        units_passed = (
            f"the unit {unit} in {key} is passed over: numbers are read in any one consistent system of units"
            for key, unit in found
        )
        return (*self.passed, *units_passed)

    @cached_property
    def domain(self) -> Domain:
        """The conditions of the claim and the box of its hints."""
        conditions = [*self._of_rates()]
        for position, text in enumerate(_as_list(self.claim.keys.get("domain", []))):
            condition = self._parse(parse_condition, text, f"domain[{position}]")
            if condition is sp.false:
                self.fault(f"domain[{position}]", "no point satisfies this condition")
            if condition is not sp.true:
                conditions += condition.args if isinstance(condition, sp.And) else (condition,)
        box: dict[Symbol, tuple[Rational, Rational]] = {}
        for name, (low, high) in self.claim.keys.get("box", {}).items():
            symbol = self.scope.symbol(name)
            if symbol is None:
                self.fault("box", f"{name} is not declared; {self.scope.near(name)}")
            box[symbol] = (exact(low), exact(high))
        domain = Domain(tuple(conditions), FrozenMapping(box))
        if (
            conditions
            and next(domain.points((), 1), None) is None
            and is_empty(domain, time.monotonic() + 0.5)
        ):
            self.fault("domain", "no point satisfies these conditions and assumptions together")
        return domain

    def _of_rates(self) -> Iterator[Boolean]:
        """Yield what ``parameters`` assumes of velocities and accelerations, as conditions."""
        relations = {"positive": sp.Gt, "negative": sp.Lt, "nonzero": sp.Ne}
        for name, word in self.claim.keys.get("parameters", {}).items():
            symbol = self.scope.symbol(name)
            if (
                symbol is not None
                and name not in self.scope.names
                and word in relations
                and symbol != self.time
            ):
                yield relations[word](symbol, 0)

    def symbols(self, key: str) -> tuple[Symbol, ...]:
        """Return the symbols of a list of names."""
        return tuple(self.scope.names[name] for name in _as_list(self.claim.keys.get(key, [])))

    def subset(self, key: str, of: str) -> tuple[Symbol, ...]:
        """Return the symbols of a list of names that must be among those of another list."""
        allowed = _as_list(self.claim.keys[of])
        for name in _as_list(self.claim.keys[key]):
            if name not in allowed:
                self.fault(key, f"{name} is not among {of} = {', '.join(allowed)}")
        return self.symbols(key)

    def phase_space(self, q: str, p: str) -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
        """Return coordinates and momenta, as many of each."""
        coordinates, momenta = self.symbols(q), self.symbols(p)
        if len(coordinates) != len(momenta):
            self.fault(
                p,
                f"{counted(len(momenta), 'momentum', 'momenta')} "
                f"for {counted(len(coordinates), 'coordinate')}",
            )
        return coordinates, momenta

    def expression(self, key: str, default: Expr | None = None) -> Expr:
        """Return the expression under a key."""
        if default is not None and not self.has(key):
            return default
        return self._parse(parse_expression, _the_one(self.claim.keys[key]), key)

    def expressions(self, key: str, like: str = "") -> tuple[Expr, ...]:
        """Return the expressions of a list, as many as there are names under ``like``."""
        found = tuple(
            self._parse(parse_expression, text, f"{key}[{i}]")
            for i, text in enumerate(_as_list(self.claim.keys[key]))
        )
        return self._as_many(key, found, like)

    def equations(self, key: str) -> tuple[Expr, ...]:
        """Return the equations of a list, each as what should vanish."""
        texts = _as_list(self.claim.keys[key])
        if not texts:
            self.fault(key, "at least one equation is needed")
        read = self.constraint if key == "constraints" else self.equation
        return tuple(read(f"{key}[{i}]", text) for i, text in enumerate(texts))

    def equation(self, where: str, text: object) -> Expr:
        """Return one equation, or expression, that stands somewhere in the claim."""
        return self._parse(parse_equation, text, where)

    def constraint(self, where: str, text: object) -> Expr:
        """Return a constraint; one between differentials, a dx + b dy + c dt = 0, as that between their rates."""
        try:
            return self.equation(where, text)
        except InvalidClaim as fault:
            q = self.symbols("q")
            names = {d.name: d for d in displacements((*q, self.time))[0] if d.name not in self.scope.names}
            try:
                form = self.with_names(names).equation(where, text)
            except InvalidClaim as other:
                raise max(fault, other, key=lambda said: said.error.column) from None
        rates = divided_by_dt(form, q, self.time)
        if rates is None:
            self.fault(
                where, "each term of a Pfaffian constraint has one differential, as in dx - a*dphi = 0"
            )
        return rates

    def table(self, key: str) -> dict[str, Expr]:
        """Return the expressions of a table {name: expression}."""
        table = self.claim.keys[key]
        return {name: self._parse(parse_expression, text, f"{key}.{name}") for name, text in table.items()}

    def lists(self, key: str, parts: Mapping[str, str]) -> tuple[tuple[Expr, ...], ...]:
        """Return the lists of a table, ``parts`` saying as many as which names each of them has."""
        table = self.claim.keys[key]
        if set(table) != set(parts):
            self.fault(key, f"should be a table of {' and '.join(parts)}")
        return tuple(self.inside(f"{key}.{part}", table[part], like) for part, like in parts.items())

    def inside(self, where: str, value: Any, like: str = "") -> tuple[Expr, ...]:
        """Return the expressions of a list that stands inside another key."""
        found = tuple(
            self._parse(parse_expression, text, f"{where}[{i}]") for i, text in enumerate(_as_list(value))
        )
        return self._as_many(where, found, like)

    def brackets(self, first: str, second: str) -> list[tuple[Expr, Expr, Expr]]:
        """Return the triples (first, second, value) under ``pairs``."""
        found: list[tuple[Expr, Expr, Expr]] = []
        for i, pair in enumerate(self.claim.keys["pairs"]):
            if set(pair) != {first, second, "value"}:
                self.fault(f"pairs[{i}]", f"should be a table of {first}, {second} and value")
            a, b, value = (
                self._parse(parse_expression, pair[k], f"pairs[{i}].{k}") for k in (first, second, "value")
            )
            found.append((a, b, value))
        return found

    def _as_many(self, key: str, found: tuple[Expr, ...], like: str) -> tuple[Expr, ...]:
        if like and len(found) != len(_as_list(self.claim.keys[like])):
            self.fault(
                key,
                f"{counted(len(found), 'expression')} for the "
                f"{len(_as_list(self.claim.keys[like]))} names of {like}",
            )
        return found

    def is_names(self, key: str) -> bool:
        """Whether a list of names stands under a key."""
        return self.has(key) and self.kind.shapes.get(key) is Shape.NAMES

    def _assumptions(self, name: str) -> dict[str, bool]:
        word = self.claim.keys.get("parameters", {}).get(name, "real")
        if word not in ASSUMPTIONS:
            self.fault("parameters", f"{word} can't be assumed of {name}; write {', '.join(ASSUMPTIONS)}")
        return {"real": True} if word == "real" else {"real": True, word: True}

    def _parse(self, parse: Callable[[str, Scope], Any], text: Any, key: str) -> Any:
        if key in self.instead:
            return self.instead[key]
        try:
            said = parsed(parse, str(text), self.scope)
            return substitute(said, self.at) if self.at else said
        except LanguageError as error:
            raise self.error(key, error) from error


def _is_rate(name: str, names: Mapping[str, Symbol]) -> bool:
    """Whether a name is that of a declared coordinate's velocity or acceleration."""
    bases = (name.removesuffix(ending) for ending in ("_ddot", "_dot") if name.endswith(ending))
    return any(isinstance(names.get(base), Coordinate) for base in bases)


def _the_one(value: Any) -> Any:
    """Return what stands alone in a list, or the value itself."""
    return value[0] if isinstance(value, list) and len(value) == 1 else value


def _as_list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]
