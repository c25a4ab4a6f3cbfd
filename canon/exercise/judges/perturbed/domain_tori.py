"""Tori of a separable system in the domain of a claim, and its actions in closed form on them.

A formula holds for motions of one kind. Where the domain has rotations in both senses, each is looked at by itself.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import islice
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.question.deadline import PROOF_SECONDS, Deadline
from canon.expression.symbols.user_input import free_name
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.substitution import exchanged, substitute, symbols_of
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import ActionVariables, action_variables
from canon.mechanics.integrable.ball_function import NotHolomorphicError
from canon.mechanics.integrable.closed_form.actions_in_closed_form import closed_actions, lies_in
from canon.mechanics.integrable.closed_form.validity import Validity, validity
from canon.mechanics.integrable.complete_integral import CompleteIntegral, hamilton_jacobi
from canon.mechanics.integrable.cycles import CycleKind, ball_of
from canon.mechanics.integrable.separated_momenta import NotSeparatedError
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.analytic import proved_sign
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import parts_of
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict
from canon.proof.rungs.ladder import is_empty

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import acb, arb
    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.integrable.separated_momenta import SeparatedMomentum

__all__ = ["BITS", "DIGITS", "Tori", "by_senses", "falls", "may_be"]

DIGITS = 15
TORI = 3
"""On how many tori of the domain the actions must be the same formulas."""
COMPARED = 9
"""On how many tori of the domain, in its box and outside, kinds of motion and formulas are compared."""
POINTS = 24
"""Points of the domain that are tried for these tori; through some of them no bounded motion goes."""
BITS = 128
LONGEST = 400
"""Operations of a formula of an action that is compared; claims about others are refuted by quadrature alone."""
_ANGLE = re.compile(r"(?:var)?(?:theta|phi|psi)|alpha|beta|gamma|chi|th|ph", re.IGNORECASE)
"""Names of angles."""
KEPT = 8
"""Systems whose tori are kept."""


@dataclass(frozen=True)
class Tori:
    """Some tori of a separable system, and its actions in closed form where they are known.

    Parameters
    ----------
    integral
        The complete integral that separates.
    tori
        Tori through points of the domain.
    J
        Actions as functions of the constants, the same on all of these tori; None where no closed form is known.
    back
        The functions of parameters for which symbols stand in the integral.
    """

    integral: CompleteIntegral
    tori: tuple[ActionVariables, ...]
    J: tuple[Expr | None, ...]
    back: Mapping[Expr, Expr]
    valid: Validity = field(default_factory=lambda: Validity((), ()))

    def where_valid(self, domain: Domain) -> Domain:
        """Return the part of a domain that has bounded motions of the kind of the formulas.

        What a formula gives for other motions is no action, whichever way it is written.
        """
        open_ = [f for f in map(self.of_state, self.valid.bounded) if not is_positive_there(f, domain)]
        bounded = Domain((*domain.conditions, *(sp.Gt(f, 0) for f in open_)), domain.box)
        kinds = [f for f in map(self.of_state, self.valid.kind) if not is_positive_there(f, bounded)]
        return Domain((*bounded.conditions, *(sp.Gt(f, 0) for f in kinds)), domain.box)

    def of_one_kind(self, domain: Domain) -> Verdict:
        """Tell whether it is proved that all bounded motions in a domain are of the kind of the formulas.

        Some tori do not show it: a narrow band of motions on the other side of a separatrix is easily missed.
        """
        question = "the motions in the domain are of one kind"
        bounded = (sp.Gt(f, 0) for f in map(self.of_state, self.valid.bounded))
        there = Domain((*domain.conditions, *bounded), domain.box)
        open_ = [f for f in map(self.of_state, self.valid.kind) if not is_positive_there(f, there)]
        if not open_:
            return Verdict(Status.HOLDS, question, "exact")
        why = f"the domain may have motions of another kind: narrow it by {open_[0]} > 0"
        return Verdict(Status.UNDECIDED, question, evidence=(Evidence("open", why),), feedback=why)

    def along_the_motion(
        self, claimed: Sequence[Expr], right: Sequence[Expr], balls: Sequence[arb], domain: Domain
    ) -> tuple[Expr, ...]:
        """Return what is right, with the other sign where an answer is counted along a coordinate that falls."""
        with precision(BITS):
            turned = [
                self._falls(i, domain) and may_be(self.number(f, self.tori[0]), -ball)
                for i, (f, ball) in enumerate(zip(claimed, balls, strict=True))
            ]
        return tuple(-f if turns else f for f, turns in zip(right, turned, strict=True))

    def _falls(self, i: int, domain: Domain) -> bool:
        """Tell whether a coordinate turns backwards all over the domain."""
        sense = _sense(self.integral.momenta[i])
        if sense is None or not all(falls(torus, i) for torus in self.tori):
            return False
        H, p = self.integral.H.H, self.integral.momenta[i].p
        if self.integral.momenta[i].square is None and substitute(H, {p: -p}) != H:
            sense = self.frequencies()[i]
        return proved_sign(self.of_state(sense), domain) == "-"

    def number(self, f: Expr, torus: ActionVariables) -> acb:
        """Return a ball that holds an answer, a function of (q, p), at the start of a torus."""
        bare = exchanged(f, {known: symbol for symbol, known in self.back.items()})
        return ball_of(substitute(bare, dict(torus.values)))

    def of_state(self, f: Expr) -> Expr:
        """Return a function of the constants as one of (q, p)."""
        return exchanged(substitute(f, dict(self.integral.defined_as)), self.back)

    @property
    def in_closed_form(self) -> bool:
        """Whether all actions are known as formulas."""
        return all(J is not None for J in self.J)

    def frequencies(self) -> tuple[Expr, ...]:
        """Return ω = ∂H/∂J as functions of the constants, by Cramer's rule.

        Raises
        ------
        Undecided
            Where an action has no closed form that is known.
        """
        J, constants = self.known(), self.integral.constants
        slopes = sp.Matrix([[action.diff(c) for c in constants] for action in J])
        energy, determinant = constants.index(self.integral.energy), slopes.det(method="berkowitz")
        return tuple(slopes.cofactor(i, energy, method="berkowitz") / determinant for i in range(len(J)))

    def shown(self) -> tuple[Expr, ...]:
        """Return all actions as functions of the constants, the energy being E."""
        E = Symbol("E", real=True)
        return tuple(substitute(J, {self.integral.energy: E}) for J in self.known())

    def known(self) -> tuple[Expr, ...]:
        """Return all actions as functions of the constants.

        Raises
        ------
        Undecided
            Where one of them has no closed form that is known.
        """
        found = [J for J in self.J if J is not None]
        if len(found) < len(self.J):
            unknown = [str(x) for x, J in zip(self.integral.H.q, self.J, strict=True) if J is None]
            raise Undecided(
                f"the action of {', '.join(unknown)} has no closed form that canon knows; certified quadrature at "
                f"{len(self.tori)} points has nothing against the claim, which is no proof"
            )
        return tuple(found)


def is_positive_there(f: Expr, domain: Domain) -> bool:
    """Tell whether it is proved that a function is positive, or zero on a separatrix at most, all over a domain.

    What is k g + r with g > 0 said by the domain, k > 0 and r ≥ 0, is positive too.

    Examples
    --------
    >>> q, p = sp.symbols("q p", real=True)
    >>> H = p**2 / 2 - sp.cos(q)
    >>> [is_positive_there(2 - 2 * H, Domain((H < bound,))) for bound in (sp.Rational(1, 2), 1, 2)]
    [True, True, False]
    """
    bounds = [c for c in parts_of(domain.conditions) if isinstance(c, sp.Gt | sp.Lt | sp.Ge | sp.Le)]
    gaps = (cast("Expr", c.gts) - cast("Expr", c.lts) for c in bounds)
    if any(_follows_from(gap, f, domain) for gap in gaps):
        return True
    if proved_sign(f, domain).endswith("+"):
        return True
    elsewhere = Domain((*domain.conditions, cast("Boolean", sp.Lt(f, 0))), domain.box)
    return is_empty(elsewhere, time.monotonic() + PROOF_SECONDS)


def _follows_from(gap: Expr, f: Expr, domain: Domain) -> bool:
    """Whether f = k g + r, with k > 0 and r ≥ 0, for what is positive on the domain."""
    for s in symbols_of(gap):
        slope = gap.diff(s)
        k = sp.cancel(f.diff(s) / slope) if slope != 0 else sp.S.Zero
        rest = sp.expand(f - k * gap) if k.is_positive else sp.S.NegativeOne
        if rest.is_nonnegative or (k.is_positive and proved_sign(rest, domain).endswith("+")):
            return True
    return False


def by_senses(H: Hamiltonian, reading: Reading) -> list[tuple[Domain, Tori]]:
    """Return the tori of a system on each part of the domain where every coordinate turns in one sense.

    Those of the last few systems are kept, as each repair of an answer asks for them anew.
    """
    waiting, done = [reading.domain], list[tuple[Domain, Tori]]()
    while waiting:
        domain = waiting.pop(0)
        box = tuple(domain.box.items())
        found = _kept_tori(H.H, H.q, H.p, H.t, domain.conditions, box, reading.claim.budget)
        if isinstance(found, Tori):
            done.append((domain, found))
            continue
        senses = sp.Gt(found.momentum, 0), sp.Lt(found.momentum, 0)
        waiting += [Domain((*domain.conditions, sense), domain.box) for sense in senses]
    return done


@dataclass(frozen=True)
class _BothSenses:
    """A domain in which a coordinate turns in both senses: by the sign of its momentum, less a constant."""

    momentum: Expr


def _both_senses(tori: Sequence[ActionVariables], back: Mapping[Expr, Expr]) -> _BothSenses | None:
    """Return what tells the senses of the first coordinate that turns forwards on some tori and backwards on others."""
    for i, momentum in enumerate(tori[0].integral.momenta):
        sense = _sense(momentum)
        turning = [torus for torus in tori if torus.cycles[i].kind is not CycleKind.LIBRATION]
        if sense is None or not turning:
            continue
        shown = exchanged(substitute(sense, dict(tori[0].integral.defined_as)), back)
        signs = {bool(ball_of(substitute(sense, torus.values)).real > 0) for torus in turning}
        if len(signs) > 1:
            return _BothSenses(shown)
    return None


def _sense(momentum: SeparatedMomentum) -> Expr | None:
    """Return what has the sign of q̇ where p = s ± √p² with a constant s, p itself where it is constant; or None."""
    if momentum.shift.has(momentum.q):
        return None
    return momentum.p if momentum.square is None else momentum.p - momentum.shift


@lru_cache(maxsize=KEPT)
def _kept_tori(
    energy: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    conditions: tuple[Boolean, ...],
    box: tuple[tuple[Symbol, tuple[sp.Rational, sp.Rational]], ...],
    budget: float,
) -> Tori | _BothSenses:
    """Return tori through points of the domain, and the actions that are one formula on all of them.

    Raises
    ------
    Undecided
        Where H does not separate, no bounded motions were found in the time of the claim, or the formula is another one
        in parts of the domain.
    """
    deadline = Deadline.after(budget)
    frozen = _frozen(energy, (*q, *p))
    still = Hamiltonian(exchanged(energy, frozen), q, p, t)
    there = Domain(tuple(cast("Boolean", c.xreplace(frozen)) for c in conditions), FrozenMapping(dict(box)))
    try:
        integral = hamilton_jacobi(still, domain=there, energy=_energy_of(still))
    except NotSeparatedError as reason:
        raise Undecided(f"actions are known where the Hamilton–Jacobi equation separates; {reason}") from None
    try:
        # A box is a hint only: what holds there must hold on the rest of the domain too.
        compared = list(islice(_bounded(integral, Domain(there.conditions), deadline), COMPARED))
        found = list(islice(_bounded(integral, there, deadline), TORI)) if there.box else compared[:TORI]
    except NotHolomorphicError as reason:
        raise Undecided(f"no quadrature of this H is certified: {reason}") from None
    if len(found) < TORI:
        raise Undecided(
            f"bounded motions were found through {len(found)} of {POINTS} points of the domain only; narrow it"
        )
    _check_turns(found[0])
    if len({tuple(cycle.kind for cycle in torus.cycles) for torus in (*found, *compared)}) > 1:
        raise Undecided(
            "the domain has motions of several kinds, librations and rotations; narrow it to those that are meant"
        )
    both = _both_senses((*found, *compared), {symbol: f for f, symbol in frozen.items()})
    if both is not None:
        return both
    return _with_formulas(integral, found, compared, {symbol: f for f, symbol in frozen.items()})


def _with_formulas(
    integral: CompleteIntegral,
    found: Sequence[ActionVariables],
    compared: Sequence[ActionVariables],
    back: Mapping[Expr, Expr],
) -> Tori:
    """Return tori with the formulas that their actions are known by, and where these are valid."""
    known = tuple(None if action is None else action.J for action in closed_actions(found[0], LONGEST))
    if not all(_lie_in(known, torus) for torus in (*found, *compared)):
        raise Undecided("the actions are other functions in parts of the domain; narrow it")
    valid = validity(found[0])
    sides = (tuple(exchanged(f, back) for f in side) for side in (valid.bounded, valid.kind))
    whole = tuple(J if J is None else exchanged(J, back) for J in known)
    return Tori(integral, tuple(found), whole, back, Validity(*sides))


def _check_turns(torus: ActionVariables) -> None:
    """Refuse a coordinate that moves evenly and for ever where nothing says that it is an angle."""
    for momentum, cycle in zip(torus.integral.momenta, torus.cycles, strict=True):
        even = cycle.kind is CycleKind.ROTATION and not any(
            f is not None and f.has(cycle.q) for f in (momentum.square, momentum.shift)
        )
        if even and not _ANGLE.match(str(cycle.q)):
            raise Undecided(
                f"{cycle.q} moves evenly and for ever, so that it has no action; where it is an angle, call it one, "
                "such as phi or theta"
            )


def _frozen(H: Expr, state: Sequence[Symbol]) -> dict[Expr, Expr]:
    """Return symbols for the functions of parameters that H holds."""
    functions = sorted(H.atoms(AppliedUndef), key=str)
    if any(f.has(*state) for f in functions):
        raise Undecided(
            "H holds a function of the coordinates that is not given, so its actions are not known"
        )
    taken = {s.name for s in symbols_of(H)}
    names = [free_name(f"{f.func}_{i}", taken) for i, f in enumerate(functions)]
    return {
        f: Symbol(name, real=True, positive=f.is_positive) for f, name in zip(functions, names, strict=True)
    }


def _energy_of(system: Hamiltonian) -> Symbol:
    """Return a symbol for the energy that is none of the parameters, such as a field E_0."""
    return Symbol(free_name("E_0", {s.name for s in symbols_of(system.H)}), real=True)


def _bounded(integral: CompleteIntegral, domain: Domain, deadline: Deadline) -> Iterator[ActionVariables]:
    """Yield tori through points of a domain, where there are bounded motions.

    Raises
    ------
    Undecided
        Where the time ends before the points do: fewer tori would let a formula pass that is another one elsewhere.
    """
    H = integral.H
    symbols = {s for s in H.H.free_symbols if isinstance(s, Symbol)} | {*H.q, *H.p}
    for point in domain.points(symbols, POINTS):
        if deadline.worked_off:
            raise Undecided(
                "actions all over the domain were not found in the budget; give a larger one, or narrow the domain"
            )
        start = {z: point[z] for z in (*H.q, *H.p)}
        parameters = {s: point[s] for s in symbols - set(start)}
        try:
            yield action_variables(integral, start, parameters, DIGITS)
        except NoCycleError:
            continue


def _lie_in(known: Sequence[Expr | None], torus: ActionVariables) -> bool:
    with precision(BITS):
        pairs = zip(known, torus.J, strict=True)
        return all(lies_in(J, torus.values, ball) for J, ball in pairs if J is not None)


def falls(torus: ActionVariables, i: int) -> bool:
    """Tell whether a coordinate turns backwards: its frequency is negative along it."""
    return torus.cycles[i].kind is not CycleKind.LIBRATION and bool(torus.frequencies[i] < 0)


def may_be(number: acb, due: arb) -> bool:
    """Tell whether a number is not certainly another one."""
    return not number.is_finite() or (number.imag.contains(0) and number.real.overlaps(due))
