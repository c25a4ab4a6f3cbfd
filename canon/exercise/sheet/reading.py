"""Reading of a claim: its names and expressions as SymPy objects, its domain."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NoReturn

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.cached_property import cached_property
from canon.exercise.sheet.answers.typed_answers import typed_answers
from canon.exercise.sheet.declared_symbols import DeclaredSymbols, as_list
from canon.exercise.sheet.field_texts import texts_in
from canon.exercise.sheet.kept_parses import parsed
from canon.exercise.sheet.kind import Kind, Shape
from canon.exercise.sheet.kinds import kind_of
from canon.exercise.sheet.sheet import Claim, ClaimError
from canon.exercise.sheet.signs_apart import signs_apart
from canon.expression.parse import (
    LanguageError,
    Scope,
    exact,
    parse_condition,
    parse_equation,
    parse_expression,
)
from canon.expression.siunitx import without_siunitx
from canon.expression.symbols.symbol import Rate
from canon.expression.symbols.user_input import counted
from canon.expression.text.units import units
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.possible_motion import where_real
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.pfaffian_form import displacements, divided_by_dt
from canon.proof.domain.domain import Domain, has_point
from canon.proof.rungs.ladder import is_empty

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from sympy import Basic
    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.answers.one_expression import Link

__all__ = ["InvalidClaim", "Reading"]


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
    lower
        The same claim with the lower signs, where ``±`` stands in its answer and this is that of the upper ones.
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
    lower: Reading | None = None
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
        upper, *lower = (_plain(each) for each in signs_apart(claim, cls(claim).error))
        if not lower:
            return upper
        told = "± is read as two answers, of the upper signs and of the lower, and both must be right"
        upper, below = (replace(each, passed=(*each.passed, told)) for each in (upper, *lower))
        return replace(upper, lower=below)

    @property
    def signs(self) -> tuple[Reading, ...]:
        """The claims of the upper and of the lower signs, or the claim itself."""
        return (self,) if self.lower is None else (replace(self, lower=None), self.lower)

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
        return self._declared.words(key)

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
        return self._declared.time

    @cached_property
    def scope(self) -> Scope:
        """The declared names."""
        return self._declared.scope(self.names)

    @cached_property
    def _declared(self) -> DeclaredSymbols:
        return DeclaredSymbols(self.claim.keys, self.kind, self.fault)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is passed over in reading the claim, as units after numbers are, and where L is not judged."""
        shapes = {**self.kind.shapes, "domain": Shape.TEXTS}
        said = {
            key: value
            for key, value in self.claim.keys.items()
            if key in shapes and shapes[key] not in (Shape.NAMES, Shape.WORD)
        }
        found = {
            (key, unit.text): None
            for key, text in texts_in(said)
            for unit in units(without_siunitx(text), self.scope)
        }
        units_passed = (
            f"the unit {unit} in {key} is passed over: numbers are read in any one consistent system of units"
            for key, unit in found
        )
        narrowed = self.domain.conditions if self.has("L") else ()
        real = [c for c in narrowed if c not in self._given_domain.conditions]
        judged = [f"judged where L is real: {', '.join(map(str, real))}"] if real else []
        return (*self.passed, *units_passed, *judged)

    @cached_property
    def domain(self) -> Domain:
        """The conditions of the claim and the box of its hints, and where a given Lagrangian is real."""
        domain = self._given_domain
        if not self.has("L") or "L" in self.kind.answer:
            return domain
        try:
            L = self.expression("L")
        except InvalidClaim:  # it is told where it is read
            return domain
        return where_real([L], domain)

    @cached_property
    def _given_domain(self) -> Domain:
        conditions = [*self._of_rates()]
        for position, text in enumerate(as_list(self.claim.keys.get("domain", []))):
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
        if conditions and not has_point(domain) and is_empty(domain, time.monotonic() + 0.5):
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
        return tuple(self.scope.names[name] for name in as_list(self.claim.keys.get(key, [])))

    def subset(self, key: str, of: str) -> tuple[Symbol, ...]:
        """Return the symbols of a list of names that must be among those of another list."""
        allowed = as_list(self.claim.keys[of])
        for name in as_list(self.claim.keys[key]):
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
            for i, text in enumerate(as_list(self.claim.keys[key]))
        )
        return self._as_many(key, found, like)

    def equations(self, key: str) -> tuple[Expr, ...]:
        """Return the equations of a list, each as what should vanish."""
        texts = as_list(self.claim.keys[key])
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
            self._parse(parse_expression, text, f"{where}[{i}]") for i, text in enumerate(as_list(value))
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
        if like and len(found) != len(as_list(self.claim.keys[like])):
            self.fault(
                key,
                f"{counted(len(found), 'expression')} for the "
                f"{len(as_list(self.claim.keys[like]))} names of {like}",
            )
        return found

    def is_names(self, key: str) -> bool:
        """Whether a list of names stands under a key."""
        return self._declared.is_names(key)

    def _parse(self, parse: Callable[[str, Scope], Any], text: Any, key: str) -> Any:
        if key in self.instead:
            return self.instead[key]
        try:
            said = parsed(parse, str(text), self.scope_of(key))
        except LanguageError as error:
            raise self.error(key, error) from error
        if self._is_of_phase_space and re.split(r"[\[.]", key)[0] not in _RATES_TOO:
            self._refuse_rates(said, key)
        return substitute(said, self.at) if self.at else said

    def scope_of(self, key: str) -> Scope:
        """Return the declared names, and whether quadratures may stand under a key."""
        return replace(self.scope, quadratures=True) if key in self.kind.quadratures else self.scope

    @cached_property
    def _is_of_phase_space(self) -> bool:
        """Whether the claim is about functions of q, p and t: coordinates have momenta, and H is given or L is not."""
        given = self.has("H") and "H" not in self.kind.answer
        return self.is_names("p") and (given or not self.has("L"))

    def _refuse_rates(self, said: Basic, key: str) -> None:
        """Refuse what holds velocities or accelerations, which would count as free constants."""
        found = sorted(str(rate) for rate in said.atoms(Rate))
        if found:
            self.fault(key, f"should be a function of q, p and t; eliminate {', '.join(found)}")


def _plain(claim: Claim) -> Reading:
    """Return a claim with every text in plain form."""
    written = Reading(claim)
    plain = typed_answers(claim, written.scope, written.error)
    keys = FrozenMapping(plain.keys)
    return Reading(
        replace(claim, keys=keys),
        tuple(plain.links),
        tuple(plain.passed),
        units=FrozenMapping(plain.units),
    )


_RATES_TOO = ("L", "domain", "q_dot", "p_dot", "solution")
"""Keys under which velocities may stand in phase space, in chains at least; the judge tells them elsewhere."""


def _the_one(value: Any) -> Any:
    """Return what stands alone in a list, or the value itself."""
    return value[0] if isinstance(value, list) and len(value) == 1 else value
