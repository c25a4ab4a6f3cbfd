"""Actions in closed form: integrals that are known, recognised term by term and certified against quadrature.

The loop integrals of roots of A + B f(q) + C g(q) that are sums of residues (A. Sommerfeld, Atombau und Spektrallinien,
supplement 6; M. Born, Vorlesungen über Atommechanik, appendix), and complete elliptic integrals of the pendulum, of
quartic wells and of two centres (P. F. Byrd, M. D. Friedman, Handbook of Elliptic Integrals, 213, 218, 219). None is
returned on recognition alone: see :func:`closed_actions`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Rational, Symbol, sqrt

from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.actions import ActionVariables, action_variables
from canon.mechanics.integrable.closed_form.elliptic_coordinates import action_in_elliptic_coordinates
from canon.mechanics.integrable.cycles import CycleKind, ball_of
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision, value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import arb

    from canon.mechanics.integrable.cycles import Cycle
    from canon.mechanics.integrable.separated_momenta import SeparatedMomentum

__all__ = ["ClosedAction", "closed_actions"]

NEIGHBOURS = (sp.S.Zero, Rational(1, 64), Rational(-1, 64), Rational(1, 1024), Rational(-1, 1024))
"""By how much momenta are enlarged for the tori that a formula is compared on."""
TORI = 3
GUARD_BITS = 64


@dataclass(frozen=True)
class ClosedAction:
    """An action as a function of the constants.

    Parameters
    ----------
    J
        The formula, in the constants α and the parameters.
    name
        What the integral is known as.
    tori
        On how many tori the formula and its derivatives by all constants lie in the certified balls.
    digits
        The digits of those balls.
    """

    J: Expr
    name: str
    tori: int
    digits: int


def closed_actions(
    torus: ActionVariables, most_operations: int | None = None
) -> tuple[ClosedAction | None, ...]:
    """Return the actions in closed form where the integral is a known one; None for the others.

    A formula is returned where p² has exactly the terms of the known integral, and where on three tori, that of the
    motion and two with other momenta, J and all ∂J/∂α agree with the certified balls of the quadrature. It holds for
    motions of the same kind, such as libration.

    Parameters
    ----------
    torus
        What :func:`action_variables` returned.
    most_operations
        How long a formula may be; those of spherical pendulum and top, whose cubic has its roots by Viète's cosines,
        have more than a thousand operations and take seconds to certify.

    Examples
    --------
    >>> from canon.mechanics import Hamiltonian, hamilton_jacobi
    >>> r, m, k = sp.symbols("r m k", positive=True)
    >>> phi, p_r, p_phi = sp.symbols("phi p_r p_phi", real=True)
    >>> kepler = hamilton_jacobi(Hamiltonian(p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r, [r, phi], [p_r, p_phi]))
    >>> torus = action_variables(kepler, {r: 1, phi: 0, p_r: sp.Rational(1, 4), p_phi: 1}, {m: 1, k: 1})
    >>> [action.J for action in closed_actions(torus)]
    [sqrt(2)*k*sqrt(m)/(2*sqrt(-E)) - Abs(alpha_phi), alpha_phi]
    """
    given_kind(torus, ActionVariables, "what closed_actions() takes", "action_variables() returns it")
    known = [
        recognised(m, c, torus.values) for m, c in zip(torus.integral.momenta, torus.cycles, strict=True)
    ]
    if most_operations is not None:
        known = [f if f is None or sp.count_ops(f[0]) <= most_operations else None for f in known]
    if not any(found is not None for found in known):
        return tuple(None for _ in known)
    tori = neighbouring_tori(torus)
    if len(tori) < TORI:
        return tuple(None for _ in known)
    return tuple(
        ClosedAction(found[0], found[1], len(tori), torus.digits)
        if found is not None and all(_agrees(found[0], i, other) for other in tori)
        else None
        for i, found in enumerate(known)
    )


def neighbouring_tori(torus: ActionVariables) -> list[ActionVariables]:
    """Return three tori of the same kind: that of the motion, and two with other momenta."""
    starts = {*torus.integral.H.q, *torus.integral.H.p}
    parameters = {s: v for s, v in torus.values.items() if s not in starts | {*torus.integral.constants}}
    periods = {c.q: c.period for c in torus.cycles if c.period is not None}
    found: list[ActionVariables] = []
    for change in NEIGHBOURS:
        try:
            other = action_variables(torus.integral, _moved(torus, change), parameters, torus.digits, periods)
        except NoCycleError:  # a neighbour across a separatrix: the next one is nearer
            continue
        if [c.kind for c in other.cycles] == [c.kind for c in torus.cycles]:
            found.append(other)
        if len(found) == TORI:
            break
    return found


def _moved(torus: ActionVariables, change: Expr) -> dict[Symbol, Expr]:
    """Return the start with its momenta changed in proportion, or where all of them are zero with all of it."""
    H, values = torus.integral.H, torus.values
    start = {z: values[z] * (1 + change if z in H.p else 1) for z in (*H.q, *H.p)}
    if change != 0 and all(start[z] == values[z] for z in start):
        return {z: values[z] * (1 + change) for z in start}
    return start


def _agrees(J: Expr, i: int, torus: ActionVariables) -> bool:
    """Whether a formula and its derivatives by the constants lie in the balls of one torus."""
    due = [(J, torus.J[i])]
    due += [(J.diff(c), torus.slopes[i][j]) for j, c in enumerate(torus.integral.constants)]
    with precision(int(torus.digits * 3.33) + GUARD_BITS):
        return all(lies_in(f, torus.values, ball) for f, ball in due)


def lies_in(f: Expr, values: Mapping[Symbol, Expr], ball: arb) -> bool:
    """Tell whether f at exact values is a real number that may be the one in a ball.

    Symbols have balls for their values: put into f, SymPy would ask of every sum with them whether it is zero.
    """
    found = value(f, {}, {s: ball_of(number) for s, number in values.items()})
    return found.is_finite() and found.imag.contains(0) and found.real.overlaps(ball)


def recognised(
    momentum: SeparatedMomentum, cycle: Cycle, values: Mapping[Symbol, Expr]
) -> tuple[Expr, str] | None:
    """Return a known integral whose terms are those of p², and its name."""
    q, square = momentum.q, momentum.square
    if cycle.kind is CycleKind.IGNORABLE:
        ratio = cast("Expr", cycle.period) / (2 * sp.pi)
        return ratio * momentum.shift, "a constant momentum"
    if square is None:
        return _linear(momentum.shift, q)
    if cycle.kind is CycleKind.LIBRATION:  # the shift is there and back the same
        return _of_square(square, q, cycle, values)
    ratio = cast("Expr", cycle.period) / (2 * sp.pi)
    if momentum.shift.has(q):
        return None
    if not square.has(q):
        return ratio * momentum.value(cycle.sign), "free rotation"
    found = _of_square(square, q, cycle, values)
    return found and (ratio * momentum.shift + found[0], found[1])


def _of_square(
    square: Expr, q: Symbol, cycle: Cycle, values: Mapping[Symbol, Expr]
) -> tuple[Expr, str] | None:
    """Return the known integral of √(p²) over a cycle."""
    terms = terms_in(in_reciprocals(about_its_kink(square, q)), q)
    A = terms.pop(sp.S.One, sp.S.Zero)
    elliptic = action_in_elliptic_coordinates(A, terms, q, cycle, values)
    if elliptic is not None:
        return elliptic, "elliptic coordinates"
    if cycle.kind is CycleKind.ROTATION:
        return _pendulum(A, terms, q, cycle)
    for known in (_powers, _trigonometric, _exponentials, _isochrone):
        found = known(A, terms, q)
        if found is not None:
            return found
    return _quartic_well(A, terms, q, cycle) or _pendulum(A, terms, q, cycle) or _on_the_sphere(square, q)


def about_its_kink(f: Expr, q: Symbol) -> Expr:
    """Return f(q + a) where f holds |q − a| and no other modulus: the loop integral is the same."""
    inside = {part.args[0] for part in f.atoms(sp.Abs) if part.has(q)}
    if len(inside) != 1:
        return f
    (u,) = inside
    return substitute(f, {q: q + sp.expand(q - u / u.diff(q))}) if u.diff(q) in (1, -1) else f


def in_reciprocals(f: Expr) -> Expr:
    """Return f with tan² as 1/cos² − 1, cot² and tanh² likewise, and with sec, csc, sech as reciprocals."""
    known = {g**2: sp.cos(g.args[0]) ** -2 - 1 for g in f.atoms(sp.tan)}
    known |= {g**2: sp.sin(g.args[0]) ** -2 - 1 for g in f.atoms(sp.cot)}
    known |= {g**2: 1 - sp.cosh(g.args[0]) ** -2 for g in f.atoms(sp.tanh)}
    for kind, inverse in ((sp.sec, sp.cos), (sp.csc, sp.sin), (sp.sech, sp.cosh)):
        known |= {g: 1 / inverse(g.args[0]) for g in f.atoms(kind)}
    return cast("Expr", f.xreplace(known))


def terms_in(f: Expr, q: Symbol) -> dict[Expr, Expr]:
    """Return the coefficient of each function of q in f."""
    terms: dict[Expr, Expr] = {}
    for term in sp.Add.make_args(sp.expand(f)):
        coefficient, function = term.as_independent(q, as_Add=False)
        terms[function] = terms.get(function, sp.S.Zero) + coefficient
    return terms


def _powers(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> tuple[Expr, str] | None:
    names = set(terms)
    if q**2 in names and names <= {q, q**2}:
        B, C = terms.get(q, sp.S.Zero), terms[q**2]
        return (A - B**2 / (4 * C)) / (2 * sqrt(-C)), "oscillator"
    if len(terms) == 1 and (even := _even_power(next(iter(names)), q)) is not None:
        n, wall = even, -next(iter(terms.values()))
        gammas = sp.gamma(1 / n) / sp.gamma(1 / n + Rational(3, 2))
        return A ** (Rational(1, 2) + 1 / n) * wall ** (-1 / n) * gammas / (n * sqrt(sp.pi)), "even power"
    if names == {1 / q, q**-2}:
        pull = terms[1 / q]
        # motions are bound where pull/q > 0
        attraction = pull if q.is_positive else -pull if q.is_negative else sp.Abs(pull)
        return attraction / (2 * sqrt(-A)) - sqrt(-terms[q**-2]), "Kepler"
    if names == {q**2, q**-2}:
        return A / (4 * sqrt(-terms[q**2])) - sqrt(-terms[q**-2]) / 2, "radial oscillator"
    return None


def _even_power(f: Expr, q: Symbol) -> Expr | None:
    """Return n where f is q⁴, q⁶, … or |q − a|ⁿ: with |q − a| = b x^(1/n) its action is a beta function."""
    powers = [factor.as_base_exp() for factor in sp.Mul.make_args(f)]
    if len(powers) == 1 and powers[0][0] == q:
        n = powers[0][1]
        return n if n.is_Integer and n.is_even and bool(n > 2) else None
    sides = [(sp.Abs(base), n) for base, n in powers]
    (modulus, _), slope = (
        sides[0],
        cast("Expr", sides[0][0].args[0]).diff(q) if sides[0][0].args else sp.S.Zero,
    )
    if not isinstance(modulus, sp.Abs) or slope not in (1, -1) or any(side != modulus for side, _ in sides):
        return None
    total = sp.Add(*(n for _, n in sides))
    return total if total.is_positive else None


def _trigonometric(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> tuple[Expr, str] | None:
    if len(terms) != 1:
        return None
    ((f, C),) = terms.items()
    base, exponent = f.as_base_exp()
    if exponent != -2 or not isinstance(base, sp.sin | sp.cos | sp.cosh):
        return None
    a = cast("Expr", base.args[0]).diff(q)
    if a.has(q):
        return None
    if isinstance(base, sp.cosh):
        return (sqrt(C) - sqrt(-A)) / sp.Abs(a), "Pöschl–Teller"
    return (sqrt(A) - sqrt(-C)) / sp.Abs(a), "polar angle"


def _exponentials(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> tuple[Expr, str] | None:
    exponents = {cast("Expr", f.args[0]): c for f, c in terms.items() if isinstance(f, sp.exp)}
    rates = {u.diff(q): c for u, c in exponents.items()}
    if len(terms) != 2 or len(rates) != 2:
        return None
    for rate, B in rates.items():
        if 2 * rate in rates and not rate.has(q):
            if {*exponents} != {rate * q, 2 * rate * q}:
                return None
            return (B / (2 * sqrt(-rates[2 * rate])) - sqrt(-A)) / sp.Abs(rate), "Morse"
    return None


def _isochrone(A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> tuple[Expr, str] | None:
    C = terms.get(q**-2)
    others = [f for f in terms if f != q**-2]
    if C is None or len(others) != 1:
        return None
    (f,) = others
    b = (1 / f).subs(q, 0) / 2
    if not b.is_positive or 1 / f != b + sqrt(b**2 + q**2):
        return None
    B, L = terms[f], sqrt(-C)
    return B / (2 * sqrt(-A)) - (L + sqrt(L**2 + 2 * B * b)) / 2, "isochrone"


def _quartic_well(A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle) -> tuple[Expr, str] | None:
    """Return the loop integrals of √(A + B q² + C q⁴): hard and soft springs, double wells on one side or over both.

    With R = √(B² − 4AC), the zeros of p² are q² = (−B ± R)/(2C).
    """
    if set(terms) != {q**2, q**4}:
        return None
    B, C = terms[q**2], terms[q**4]
    low, high = cast("tuple[arb, arb]", cycle.turning_points)
    R, K, E = sqrt(B**2 - 4 * A * C), sp.elliptic_k, sp.elliptic_e
    if low > 0 or high < 0:
        m = 2 * R / (B + R)
        return sqrt((B + R) / 2) / (-3 * sp.pi * C) * (B * E(m) - (B - R) * K(m)), "double well, on one side"
    if C.is_negative:
        m = (R + B) / (2 * R)
        return sqrt(R) / (-3 * sp.pi * C) * ((R - B) * K(m) + 2 * B * E(m)), "quartic well"
    if C.is_positive:
        m = (B + R) / (B - R)
        return -sqrt(2 * (R - B)) / (3 * sp.pi * C) * (B * E(m) + R * K(m)), "soft quartic well"
    return None


def _on_the_sphere(square: Expr, q: Symbol) -> tuple[Expr, str] | None:
    """Return the loop integral of √P(z)/(1 − z²), z = cos q, with a cubic P: spherical pendulum and Lagrange's top.

    Of a quadratic P, as that of a top without weight, it is the sum of the residues at z = ±1 and infinity.
    P/(1 − z²) is linear in z but for P(1)/2 over 1 − z and P(−1)/2 over 1 + z, and z = z₁ + (z₂ − z₁) sn²
    (E. T. Whittaker, Analytical Dynamics, section 71).
    """
    z = sp.Dummy("z", real=True)
    whole = sp.cancel(sp.expand(square).subs(sp.sin(q), sqrt(1 - z**2)).subs(sp.cos(q), z) * (1 - z**2))
    if whole.has(q) or not whole.is_polynomial(z):
        return None
    cubic = sp.Poly(whole, z)
    if cubic.degree() == 2:
        poles = (sqrt(-cubic.eval(1)) + sqrt(-cubic.eval(-1))) / 2
        return sqrt(-cubic.LC()) - poles, "free symmetric top"
    if cubic.degree() != 3:
        return None
    P = sp.Poly(whole.subs(z, -z), z) if cubic.LC().is_negative else cubic
    if not P.LC().is_positive:
        return None
    alpha, beta, _, _ = P.all_coeffs()
    z1, z2, z3 = three_roots(P)
    m, g = (z2 - z1) / (z3 - z1), 2 / sqrt(alpha * (z3 - z1))
    above = P.eval(1) * sp.elliptic_pi((z2 - z1) / (1 - z1), m) / (1 - z1)
    below = P.eval(-1) * sp.elliptic_pi((z1 - z2) / (1 + z1), m) / (1 + z1)
    first, second = sp.elliptic_k(m), sp.elliptic_e(m)
    linear = -alpha * (z3 * first - (z3 - z1) * second) - beta * first
    return g / sp.pi * (linear + (above + below) / 2), "motion on a sphere"


def three_roots(P: sp.Poly) -> tuple[Expr, Expr, Expr]:
    """Return the roots of a cubic that has three real ones, in their order, by Viète's cosines."""
    _, b, c, d = P.monic().all_coeffs()
    p, r = c - b**2 / 3, 2 * b**3 / 27 - b * c / 3 + d
    third = sp.acos(3 * r / (2 * p) * sqrt(-3 / p)) / 3
    large, middle, small = (2 * sqrt(-p / 3) * sp.cos(third - 2 * sp.pi * k / 3) - b / 3 for k in range(3))
    return small, middle, large


def _linear(p: Expr, q: Symbol) -> tuple[Expr, str] | None:
    """Return the mean over a turn of A + B cos q, or of N/(A + B cos q), where H is linear in p."""
    name, waves = "rotation linear in p", ({sp.cos(q)}, {sp.sin(q)})
    above, below = sp.fraction(sp.together(p))
    terms = terms_in(below if below.has(q) else p, q)
    A = terms.pop(sp.S.One, sp.S.Zero)
    if set(terms) not in waves or (below.has(q) and above.has(q)):
        return None
    (B,) = terms.values()
    return (above * sp.sign(A) / sqrt(A**2 - B**2) if below.has(q) else A), name


def _pendulum(A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle) -> tuple[Expr, str] | None:
    """Return Legendre's form of the integrals over √(A + B cos q)."""
    if set(terms) != {sp.cos(q)}:
        return None
    beta = sp.Abs(terms[sp.cos(q)])
    modulus = (A + beta) / (2 * beta)
    if cycle.kind is CycleKind.LIBRATION:
        complete = sp.elliptic_e(modulus) - (1 - modulus) * sp.elliptic_k(modulus)
        return 4 * sqrt(2 * beta) / sp.pi * complete, "pendulum, libration"
    if cycle.period != 2 * sp.pi:
        return None
    return cycle.sign * 2 / sp.pi * sqrt(A + beta) * sp.elliptic_e(1 / modulus), "pendulum, rotation"
