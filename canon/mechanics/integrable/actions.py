"""Actions, frequencies and angles of separated systems, by certified quadrature: each number is a ball."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import arb, arb_mat
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import by_symbol, given_kind
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.complete_integral import CompleteIntegral
from canon.mechanics.integrable.cycles import Cycle, CycleIntegrals, ball_of, cycle_of
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canon.array import Array

    State = Mapping[Any, Expr | float] | Iterable[Expr | float] | Array

__all__ = ["ActionVariables", "action_variables", "angles", "frequencies"]

GUARD_BITS = 64
MOST_ROUNDS = 3
"""How often the precision is doubled until the digits are reached."""


@dataclass(frozen=True)
class ActionVariables:
    """The actions and frequencies on the torus of one motion.

    Parameters
    ----------
    integral
        The complete integral.
    values
        The exact values of parameters and constants.
    cycles
        The cycle of each coordinate.
    J
        The actions (1/2π) ∮ p_i dq_i, balls that certainly hold them.
    frequencies
        ω_i = ∂H/∂J_i, in radians per unit of time, balls.
    slopes
        ∂J_i/∂α_j, of shape (n, n).
    digits
        The digits that were asked for.
    """

    integral: CompleteIntegral
    values: Mapping[Symbol, Expr] = field(repr=False)
    cycles: tuple[Cycle, ...]
    J: tuple[arb, ...]
    frequencies: tuple[arb, ...]
    slopes: tuple[tuple[arb, ...], ...] = field(repr=False)
    digits: int = 30

    def __str__(self) -> str:
        rows = [
            f"{cycle.q}: {cycle.kind.value}, J = {J.str(self.digits)}, omega = {w.str(self.digits)}"
            for cycle, J, w in zip(self.cycles, self.J, self.frequencies, strict=True)
        ]
        return "\n".join(rows)


def action_variables(
    integral: CompleteIntegral,
    start: State,
    parameters: Mapping[Any, Expr | float] | None = None,
    digits: int = 30,
    periods: Mapping[Any, Expr | float] | None = None,
) -> ActionVariables:
    """Return the actions and frequencies on the torus through a start, with rigorous error bounds.

    J_i = (1/2π) ∮ p_i dq_i over one cycle of q_i, a libration between two turning points or a rotation through one
    period, and ω = ∂H/∂J by the inverse of ∂J/∂α, whose integrals are certified too (M. Born, Vorlesungen über
    Atommechanik, section 14; H. Goldstein, Classical Mechanics, section 10.6). Actions of rotations have the sign of
    the momentum. Any consistent units.

    Parameters
    ----------
    integral
        What :func:`hamilton_jacobi` returned.
    start
        (q, p) of one point of the motion, in the coordinates of ``integral.H``, in their order or by symbol or name.
        Floats are taken as the binary numbers that they are.
    parameters
        The values of all other symbols, by symbol or name.
    digits
        How many digits the result should have at least.
    periods
        The periods of coordinates that are no angles, by symbol or name; a coordinate in which p² is proved to have the
        period 2π, or that is ignorable, is taken for an angle.

    Raises
    ------
    NoCycleError
        Where a coordinate is unbounded, at rest at its equilibrium, on a separatrix or too near to one, or its momentum
        is proved not to have the period that was given.
    NotHolomorphicError
        Where H holds functions that are not modelled.
    ValueError
        Where the start or a parameter is missing, or a period is no positive number, or one of no coordinate.

    Examples
    --------
    >>> from canon.mechanics import Hamiltonian, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> pendulum = hamilton_jacobi(Hamiltonian(p**2/2 - sp.cos(q), q, p))
    >>> found = action_variables(pendulum, {q: 0, p: 1})
    >>> round(float(found.J[0]), 12), round(float(found.frequencies[0]), 12), found.cycles[0].kind.value
    (0.517315809223, 0.931808391622, 'libration')
    >>> found.frequencies[0].rel_accuracy_bits() > 100
    True
    """
    given_kind(integral, CompleteIntegral, "the integral", "hamilton_jacobi(H) finds it")
    if digits < 1:
        raise ValueError(f"the digits should be a whole number from 1, not {digits}")
    values = _values(integral, start, parameters or {})
    known_periods = _periods(periods or {}, integral.H.q)
    bits = int(digits * 3.33) + GUARD_BITS
    for _ in range(MOST_ROUNDS):
        with precision(bits):
            found = _actions(integral, values, known_periods, digits)
            if all(ball.rel_accuracy_bits() >= digits * 3.32 for ball in (*found.J, *found.frequencies)):
                return found
        bits *= 2
    raise NoCycleError(
        f"the actions were not found to {digits} digits: the motion is very near to a separatrix or an equilibrium, "
        "or an action or a frequency is zero; ask for fewer digits, or change the start"
    )


def frequencies(
    integral: CompleteIntegral,
    start: State,
    parameters: Mapping[Any, Expr | float] | None = None,
    digits: int = 30,
    periods: Mapping[Any, Expr | float] | None = None,
) -> tuple[arb, ...]:
    """Return the frequencies ω = ∂H/∂J of the motion through a start; see :func:`action_variables`.

    Examples
    --------
    >>> from canon.mechanics import Hamiltonian, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> oscillator = hamilton_jacobi(Hamiltonian(p**2/2 + 9*q**2/2, q, p))
    >>> [float(w) for w in frequencies(oscillator, {q: 1, p: 1})]
    [3.0]
    """
    return action_variables(integral, start, parameters, digits, periods).frequencies


def angles(actions: ActionVariables, state: State) -> tuple[arb, ...]:
    """Return the angles θ = ∂W/∂J of a state on the torus, zero where each libration is at its lower turning point.

    Rotating and ignorable coordinates are counted from q = 0. The state should be on the torus: its constants are not
    looked at, its coordinates and the signs of its momenta are. Angles are not reduced to 0 … 2π but for librations.

    Raises
    ------
    ValueError
        Where a coordinate is outside its turning points.

    Examples
    --------
    >>> from canon.mechanics import Hamiltonian, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> oscillator = hamilton_jacobi(Hamiltonian(p**2/2 + q**2/2, q, p))
    >>> torus = action_variables(oscillator, {q: 1, p: 1})
    >>> [round(float(angles(torus, {q: 1, p: sign})[0] * 4 / arb.pi()), 12) for sign in (1, -1)]
    [3.0, 5.0]
    """
    n, H = len(actions.cycles), actions.integral.H
    at = _by_symbol(state, (*H.q, *H.p))
    with precision(int(actions.digits * 3.33) + GUARD_BITS):
        balls = {s: ball_of(v) for s, v in actions.values.items()}
        by_alpha = [arb(0)] * n
        for momentum, cycle in zip(actions.integral.momenta, actions.cycles, strict=True):
            place = _exact(at[momentum.q], momentum.q)
            at_place = substitute(momentum.shift, {**actions.values, momentum.q: place})
            outward = ball_of(_exact(at[momentum.p], momentum.p) - at_place)
            integrals = CycleIntegrals(momentum, cycle, balls)
            for j, constant in enumerate(actions.integral.constants):
                by_alpha[j] += integrals.up_to(constant, place, outward.real)
        inverse = arb_mat(n, n, [x for row in actions.slopes for x in row]).inv()
        return tuple(sum((inverse[j, i] * by_alpha[j] for j in range(n)), arb(0)) for i in range(n))


def _by_symbol(state: State, symbols: tuple[Symbol, ...]) -> dict[Symbol, Expr | float]:
    """Return the numbers of a state by symbol."""
    names = ", ".join(str(symbol) for symbol in symbols)
    if not isinstance(state, Mapping):
        numbers = list(state)
        if len(numbers) != len(symbols):
            raise ValueError(f"the state has {len(numbers)} numbers; give {names} in this order, or by name")
        return dict(zip(symbols, numbers, strict=True))
    given = {str(key): number for key, number in state.items()}
    unknown = sorted(given.keys() - {str(symbol) for symbol in symbols})
    if unknown:
        raise ValueError(f"the state is ({names}), and {', '.join(unknown)} is none of them")
    missing = [str(symbol) for symbol in symbols if str(symbol) not in given]
    if missing:
        raise ValueError(
            f"the start does not say what {', '.join(missing)} is; give every coordinate and momentum"
        )
    return {symbol: given[str(symbol)] for symbol in symbols}


def _values(
    integral: CompleteIntegral, state: State, parameters: Mapping[Any, Expr | float]
) -> dict[Symbol, Expr]:
    """Return exact values of parameters, the start and the constants."""
    start = _by_symbol(state, (*integral.H.q, *integral.H.p))
    named = {s.name: s for s in integral.H.H.free_symbols if isinstance(s, Symbol)}
    given = {named.get(str(key), sp.Symbol(str(key))): number for key, number in parameters.items()}
    known = {s: _exact(v, s) for s, v in (*given.items(), *start.items())}
    below = next((z for z in start if z.is_positive and known[z].is_positive is False), None)
    if below is not None:
        raise ValueError(f"{below} is declared positive, but starts at {known[below]}")
    needed = {s for s in integral.H.H.free_symbols if isinstance(s, Symbol)}
    unknown = sorted(str(s) for s in needed - set(known))
    if unknown:
        raise ValueError(f"{', '.join(unknown)} has no value; give parameters={{…}}")
    constants = {c: substitute(f, known) for c, f in integral.defined_as.items()}
    return known | constants


def _periods(given: Mapping[Any, Expr | float], q: tuple[Symbol, ...]) -> dict[Symbol, Expr]:
    periods = {x: _exact(period, x) for x, period in by_symbol(given, q, "periods").items()}
    for x, period in periods.items():
        if not period.is_positive:
            raise ValueError(f"the period of {x} should be a positive number, not {period}")
    return periods


def _exact(number: Expr | float, name: Symbol) -> Expr:
    try:
        exact = sp.sympify(number, strict=True)
    except sp.SympifyError:
        raise ValueError(f"{name} should have a real number for its value, not {number!r}") from None
    if exact.is_Float:
        exact = sp.Rational(exact)  # of any precision; float() would cut it to a double
    if not exact.is_number or exact.is_real is False:
        raise ValueError(f"{name} should have a real number for its value, not {number}")
    return exact


def _actions(
    integral: CompleteIntegral, values: Mapping[Symbol, Expr], periods: Mapping[Symbol, Expr], digits: int
) -> ActionVariables:
    n = len(integral.momenta)
    balls = {s: ball_of(v) for s, v in values.items()}
    cycles = tuple(cycle_of(m, values, balls, periods) for m in integral.momenta)
    each = [CycleIntegrals(m, cycle, balls) for m, cycle in zip(integral.momenta, cycles, strict=True)]
    actions = tuple(integrals.whole() for integrals in each)
    slopes = tuple(tuple(integrals.whole(c) for c in integral.constants) for integrals in each)
    matrix = arb_mat(n, n, [x for row in slopes for x in row])
    if matrix.det().contains(0):
        raise NoCycleError("∂J/∂α may be singular here; ask for more digits, or change the start")
    inverse = matrix.inv()
    omega = tuple(inverse[n - 1, i] for i in range(n))
    return ActionVariables(integral, values, cycles, actions, omega, slopes, digits)
