"""Generating functions F₁(q, Q, t) … F₄(p, P, t) of canonical transformations.

| type | function    | rules                      |
|------|-------------|----------------------------|
| 1    | F₁(q, Q, t) | p = ∂F₁/∂q, P = −∂F₁/∂Q    |
| 2    | F₂(q, P, t) | p = ∂F₂/∂q, Q = ∂F₂/∂P     |
| 3    | F₃(p, Q, t) | q = −∂F₃/∂p, P = −∂F₃/∂Q   |
| 4    | F₄(p, P, t) | q = −∂F₄/∂p, Q = ∂F₄/∂P    |

The new Hamiltonian is K = H + ∂F/∂t for each of them (H. Goldstein, Classical Mechanics, table 9.1). Where
degrees of freedom differ in type, ``kind`` is a tuple with one number each.
"""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted, given_expression, given_kind, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import check_none_is_the_time, in_own_symbols
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.substitution import substitute
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Status, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.mechanics.canonical.transformation import CanonicalTransformation

__all__ = [
    "GeneratingFunction",
    "NoGeneratingFunctionError",
    "Rule",
    "kind_name",
    "kinds_of",
]


class NoGeneratingFunctionError(ValueError):
    """Raised where a map has no generating function of the type that is asked for.

    Parameters
    ----------
    message
        Why, and what to do instead.
    verdict
        The verdict that says so.
    """

    def __init__(self, message: str, verdict: Verdict) -> None:
        super().__init__(message)
        self.verdict = verdict

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (str(self), self.verdict)


@dataclass(frozen=True)
class Rule:
    """One rule of a generating function: ``variable`` = ``value``, a derivative of F with its sign."""

    variable: Symbol
    value: Expr
    text: str


@dataclass(frozen=True)
class GeneratingFunction:
    """A generating function of one of the four types, or of mixed type.

    Parameters
    ----------
    kind
        1, 2, 3 or 4; or one of them for each degree of freedom.
    F
        The function, in the variables of its type and t.
    q, p
        Symbols of the old variables.
    new_q, new_p
        Symbols of the new variables.
    domain
        Where the function is meant: its branch.
    t
        The time.

    Raises
    ------
    ValueError
        Where the variables are not all different or one is the time; or where F depends on variables that are not its
        type's, or holds another symbol of the name of one.

    Examples
    --------
    >>> from sympy import symbols, cot
    >>> q, p, Q, P = symbols("q p Q P", real=True)
    >>> m, w = symbols("m w", positive=True)
    >>> F1 = GeneratingFunction(1, m*w*q**2*cot(Q)/2, q, p, Q, P)
    >>> [f"{rule.variable} = {rule.value}" for rule in F1.rules]
    ['p = m*q*w*cot(Q)', 'P = -m*q**2*w*(-cot(Q)**2 - 1)/2']
    """

    kind: tuple[int, ...]
    F: Expr
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    new_q: tuple[Symbol, ...]
    new_p: tuple[Symbol, ...]
    domain: Domain = field(default_factory=Domain)
    t: Symbol = time

    def __init__(
        self,
        kind: int | Sequence[int],
        F: Expr,
        q: Sequence[Symbol] | Symbol,
        p: Sequence[Symbol] | Symbol,
        new_q: Sequence[Symbol] | Symbol,
        new_p: Sequence[Symbol] | Symbol,
        domain: Domain | None = None,
        t: Symbol = time,
    ) -> None:
        for name, given in (("q", q), ("p", p), ("new_q", new_q), ("new_p", new_p)):
            object.__setattr__(self, name, given_symbols(given, name))
        n = len(self.q)
        object.__setattr__(self, "kind", kinds_of(kind, n))
        object.__setattr__(self, "t", given_kind(t, Symbol, "the time", "the domain comes before it"))
        object.__setattr__(self, "domain", as_domain(domain))
        variables = (*self.q, *self.p, *self.new_q, *self.new_p)
        check_none_is_the_time(variables, "GeneratingFunction(kind, F, q, p, new_q, new_p", t)
        object.__setattr__(self, "F", in_own_symbols([given_expression(F, "F")], variables, t)[0])
        if len(variables) != 4 * n or len(set(variables)) < 4 * n:
            raise ValueError(
                f"a generating function of {counted(n, 'degree')} "
                f"of freedom needs {4 * n} different symbols, "
                f"got {variables}"
            )
        foreign = self.F.free_symbols & (set(variables) - {*self.old, *self.new})
        if foreign:
            raise ValueError(
                f"F of type {self._named_kind} depends on {', '.join(sorted(map(str, foreign)))}; "
                f"it may depend on {', '.join(map(str, (*self.old, *self.new)))}, time and parameters only"
            )

    @property
    def old(self) -> tuple[Symbol, ...]:
        """The old variables on which F depends: q for types 1 and 2, p for 3 and 4."""
        return tuple(q if k in (1, 2) else p for k, q, p in zip(self.kind, self.q, self.p, strict=True))

    @property
    def new(self) -> tuple[Symbol, ...]:
        """The new variables on which F depends: Q for types 1 and 3, P for 2 and 4."""
        return tuple(
            Q if k in (1, 3) else P for k, Q, P in zip(self.kind, self.new_q, self.new_p, strict=True)
        )

    @cached_property
    def rules(self) -> tuple[Rule, ...]:
        """The 2n rules of the type: those for the other old variables, then for the other new ones."""
        old = [
            Rule(p, self.F.diff(q), f"{p} = ∂F/∂{q}")
            if k in (1, 2)
            else Rule(q, -self.F.diff(p), f"{q} = −∂F/∂{p}")
            for k, q, p in zip(self.kind, self.q, self.p, strict=True)
        ]
        new = [
            Rule(P, -self.F.diff(Q), f"{P} = −∂F/∂{Q}")
            if k in (1, 3)
            else Rule(Q, self.F.diff(P), f"{Q} = ∂F/∂{P}")
            for k, Q, P in zip(self.kind, self.new_q, self.new_p, strict=True)
        ]
        return (*old, *new)

    @cached_property
    def mixed_hessian(self) -> sp.ImmutableDenseMatrix:
        """The mixed Hessian ∂²F/∂old ∂new of shape (n, n); regular where F generates a map."""
        return sp.ImmutableDenseMatrix([[self.F.diff(a).diff(b) for b in self.new] for a in self.old])

    def generates(
        self, transformation: CanonicalTransformation, domain: Domain | None = None, budget: float = 10.0
    ) -> Verdict:
        """Tell whether F generates this map, or the map of which this is the inverse.

        The rules of the type hold identically on the map, and the mixed Hessian is regular.

        Parameters
        ----------
        transformation
            From (q, p) with Q, P as expressions, or the inverse: from (new_q, new_p) with the old variables
            as expressions. Its own symbols say which.
        domain
            Where the claim is meant; the transformation's domain unless given.
        budget
            Seconds for the rules.

        Examples
        --------
        >>> from sympy import symbols
        >>> from canon import CanonicalTransformation
        >>> q, p, Q, P = symbols("q p Q P", real=True)
        >>> exchange = CanonicalTransformation(q, p, p, -q)
        >>> GeneratingFunction(1, q*Q, q, p, Q, P).generates(exchange).status.name
        'HOLDS'
        >>> GeneratingFunction(1, -q*Q, q, p, Q, P).generates(exchange).feedback
        'on the map p = ∂F/∂q should be p, but is -p'
        """
        return self.holds_on(self._on(transformation), domain or transformation.domain, budget)

    def holds_on(
        self, there: Mapping[Symbol, Expr], domain: Domain | None = None, budget: float = 10.0
    ) -> Verdict:
        """Tell whether the rules hold where the variables have these values, with regular mixed Hessian.

        Parameters
        ----------
        there
            Variables as functions of others; those not named stand for themselves.
        domain
            Where the claim is meant.
        budget
            Seconds for the rules.
        """
        domain = as_domain(domain)
        end = clock.monotonic() + budget

        def verdicts() -> Iterator[Verdict]:
            for rule in self.rules:
                due = there.get(rule.variable, rule.variable)
                found = substitute(rule.value, there)
                left = max(0.0, end - clock.monotonic())
                verdict = all_vanish([(rule.text, due - found)], rule.text, domain, left)
                if verdict.fails:
                    verdict = replace(
                        verdict, feedback=f"on the map {rule.text} should be {due}, but is {found}"
                    )
                yield verdict
                if verdict.undecided:
                    return
            yield is_regular(self.mixed_hessian.xreplace(there), domain, "the mixed Hessian")
            variables = (*self.q, *self.p, *self.new_q, *self.new_p, self.t)
            on_the_map = substitute(self.F, there)
            answers = {**{f"{z} on the map": f for z, f in there.items()}, "F": on_the_map}
            verdict = having_values(Verdict(Status.HOLDS), answers, (), domain)
            yield verdict
            if verdict.holds:
                yield continuity(on_the_map, variables, domain, name="F", given=there.values())

        return all_hold(verdicts(), f"F of type {self._named_kind} generates the map")

    def _on(self, T: CanonicalTransformation) -> dict[Symbol, Expr]:
        """Return what the dependent variables are on the map, by symbol."""
        if T.variables == (*self.q, *self.p):
            return dict(zip((*self.new_q, *self.new_p), T.images, strict=True))
        if T.variables == (*self.new_q, *self.new_p):
            return dict(zip((*self.q, *self.p), T.images, strict=True))
        raise ValueError(
            f"the map starts from {T.variables}, the generating function knows {(*self.q, *self.p)} and "
            f"{(*self.new_q, *self.new_p)}; use the same symbols"
        )

    @property
    def _named_kind(self) -> str:
        return kind_name(self.kind)

    def _repr_latex_(self) -> str:
        arguments = ", ".join(sp.latex(s) for s in (*self.old, *self.new, self.t))
        return f"$\\displaystyle F_{{{self._named_kind}}}({arguments}) = {sp.latex(self.F)}$"


def kinds_of(kind: int | Sequence[int], n: int) -> tuple[int, ...]:
    """Return one type for each degree of freedom."""
    kinds = (kind,) * n if isinstance(kind, int) else tuple(kind)
    if len(kinds) != n or any(k not in (1, 2, 3, 4) for k in kinds):
        raise ValueError(
            f"the type {kind!r} should be 1, 2, 3 or 4, or one of them for each of {n} degrees of freedom"
        )
    return kinds


def kind_name(kinds: tuple[int, ...]) -> str:
    """Return the type as it is written: one number where all degrees of freedom are of one type."""
    return str(kinds[0]) if len(set(kinds)) == 1 else str(kinds)
