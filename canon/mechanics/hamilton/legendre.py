"""Legendre's transformation f(x) ↦ Σ x y − f, y = ∂f/∂x: velocities eliminated for momenta, or vice versa."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.all_vanish import is_quadratic_in
from canon.mechanics.algebra.branch_point import branch_points
from canon.mechanics.algebra.linear import SingularMatrixError, eliminate, is_regular, solve
from canon.mechanics.algebra.possible_motion import where_real
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import entry, exchanged, size, substitute, symbols_of
from canon.proof.domain.domain import Domain
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.polynomial_roots import is_binomial, low_degree_roots, polynomial_in

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.mechanics.algebra.branch_point import BranchPoint
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = [
    "LegendreError",
    "check_momenta",
    "eliminate_velocities",
    "is_dual",
    "legendre_residual",
    "where_root_is_real",
]

WITNESSES = 4
"""Points that show a branch."""


class LegendreError(ValueError):
    """Raised where Legendre's transformation does not exist, or not in closed form.

    Parameters
    ----------
    message
        What was wrong and what to do instead.
    null_direction
        The direction in the velocities along which the Hessian is singular, where that is the reason.
    """

    def __init__(self, message: str, null_direction: tuple[Expr, ...] | None = None) -> None:
        super().__init__(message)
        self.null_direction = null_direction


def check_momenta(momenta: Sequence[Symbol], lagrangian: Lagrangian, call: str) -> None:
    """Refuse momenta that are called as a symbol of the system is: what follows would read as if they were one.

    Parameters
    ----------
    call
        How other symbols are given, such as ``"hamiltonian(L, p=[…])"``.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x = coordinates("x")
    >>> check_momenta([x], Lagrangian(x.dot**2/2, [x]), "hamiltonian(L, p=[…])")
    Traceback (most recent call last):
        ...
    ValueError: x is the name of a momentum and of another symbol in L: call that otherwise, or give symbols for ...
    """
    L = lagrangian
    names = {s.name for s in (*L.q, L.t, *symbols_of(L.L, *L.forces))}
    clash = next((p for p in momenta if p.name in names), None)
    if clash is not None:
        raise ValueError(
            f"{clash} is the name of a momentum and of another symbol in L: call that otherwise, or give symbols for "
            f"the momenta, {call}"
        )


def eliminate_velocities(
    f: Expr, old: Sequence[Symbol], new: Sequence[Symbol], domain: Domain, name: str, what: str
) -> Expr:
    """Return Σ old·new − f as a function of ``new`` = ∂f/∂``old``.

    Parameters
    ----------
    f
        L with its velocities, or H with its momenta.
    old, new
        The variables to be eliminated and the ones that replace them.
    domain
        Where f is meant; it may decide between branches.
    name, what
        ``"L"`` and ``"velocities"``, or ``"H"`` and ``"momenta"``, for messages.

    Raises
    ------
    LegendreError
        Where the Hessian is singular, or the old variables have no closed form.
    """
    gradient = [f.diff(x) for x in old]
    hessian = sp.Matrix([[g.diff(x) for x in old] for g in gradient])
    quadratic = is_quadratic_in(f, old, domain)
    try:
        transformed = (
            _of_quadratic(f, gradient, hessian, old, new, domain)
            if quadratic
            else _of_nonlinear(f, gradient, hessian, old, new, domain)
        )
    except SingularMatrixError as singular:
        raise LegendreError(
            f"the Hessian of {name} in its {what} ({', '.join(map(str, old))}) is singular along "
            f"({', '.join(map(str, singular.null_direction))}), so these {what} cannot be eliminated. Remove "
            "the redundant coordinate, or treat the relation among the momenta as a constraint (Dirac)",
            singular.null_direction,
        ) from singular
    if transformed is None:
        raise LegendreError(
            f"the {what} ({', '.join(map(str, old))}) could not be found in closed form on this "
            "domain; narrow it with conditions that choose the branch, or check a Hamiltonian you have with "
            "is_hamiltonian_of"
        )
    return transformed


def legendre_residual(H: Expr, momenta: Mapping[Symbol, Expr], energy: Expr) -> Expr:
    """Return H(q, ∂L/∂q̇, t) − (Σ p q̇ − L), which vanishes where H is the Hamiltonian of L.

    Parameters
    ----------
    H
        A function of q, p and t.
    momenta
        ∂L/∂q̇ of each momentum.
    energy
        Σ p q̇ − L as a function of velocities.
    """
    return substitute(H, momenta) - energy


def _of_quadratic(
    f: Expr,
    gradient: Sequence[Expr],
    hessian: sp.Matrix,
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    domain: Domain,
) -> Expr:
    """Return ½ wᵀ M⁻¹ w − f(0), w = y − ∂f/∂x at x = 0: through M = L D Lᵀ a sum of squares Σ (L⁻¹w)²/2D."""
    at_rest = dict.fromkeys(old, sp.S.Zero)
    w = [y - exchanged(g, at_rest) for y, g in zip(new, gradient, strict=True)]
    eliminated = eliminate(hessian, sp.Matrix(w), domain)
    if eliminated.null_direction is not None:
        raise SingularMatrixError("the Hessian is singular", eliminated.null_direction)
    if eliminated.order == tuple(range(len(old))):
        squares = [_factored(row[-1]) ** 2 / (2 * _factored(row[i])) for i, row in enumerate(eliminated.rows)]
        return sp.Add(*squares, -exchanged(f, at_rest))
    values = [row[0] for row in eliminated.back_substituted()]
    return sp.Add(*(v * b / 2 for v, b in zip(values, w, strict=True)), -exchanged(f, at_rest))


def _factored(f: Expr) -> Expr:
    """Take common factors out where the expression is small enough for that to be quick."""
    return sp.factor_terms(f) if size(f) < 1000 else f


def _of_nonlinear(
    f: Expr,
    gradient: Sequence[Expr],
    hessian: sp.Matrix,
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    domain: Domain,
) -> Expr | None:
    """Transform by a candidate x(y) with x(∂f/∂x) = x proved; None where there is none."""
    if is_regular(hessian, domain).fails:
        solve(hessian, sp.zeros(len(old), 1), domain)
    there = dict(zip(new, gradient, strict=True))
    domain = _where_real(f, old, domain)
    witnesses = tuple(branch_points({*f.atoms(Symbol), *old}, there, domain, WITNESSES))
    for values, transformed in _candidates(f, gradient, old, new, witnesses):
        if _only_root(values, gradient, hessian, old, new) or all(
            vanishes_off_kinks(substitute(value, there) - x, domain).holds
            for value, x in zip(values, old, strict=True)
        ):
            return transformed
    return None


def _only_root(
    values: Sequence[Expr],
    gradient: Sequence[Expr],
    hessian: sp.Matrix,
    old: Sequence[Symbol],
    new: Sequence[Symbol],
) -> bool:
    """Whether a real x(y) gives ∂f/∂x = y for every y, in one variable where ∂f/∂x grows: there is no other root."""
    if len(old) > 1 or not _is_positive(entry(hessian, 0, 0), old[0]) or not values[0].is_real:
        return False
    return vanishes_off_kinks(substitute(gradient[0], {old[0]: values[0]}) - new[0], Domain()).holds


def _is_positive(f: Expr, x: Symbol) -> bool:
    """Whether f > 0 for every real x, by its symbols or as a square polynomial without real roots."""
    square = polynomial_in(f, x)
    if f.is_positive or square is None or square.degree() != 2:
        return bool(f.is_positive)
    return bool(square.LC().is_positive and sp.factor(-square.discriminant()).is_positive)


def is_dual(H: Expr, L: Expr, v: Symbol, p: Symbol) -> bool:
    """Tell whether H is the transform of a convex L by what holds at its own v = ∂H/∂p, with nothing left open.

    With ∂²L/∂v² > 0 the two identities ∂L/∂v = p and p v − L = H at v = ∂H/∂p say all: for each p there is one v only
    (V. I. Arnold, Mathematical Methods of Classical Mechanics, section 14).

    Examples
    --------
    >>> v, p = sp.symbols("v p", real=True)
    >>> is_dual(p**2/2, v**2/2, v, p), is_dual(p**2, v**2/2, v, p)
    (True, False)
    """
    slope = H.diff(p)
    if not _is_positive(L.diff(v, 2), v) or not slope.is_real:
        return False
    there = {v: slope}
    claims = (substitute(L.diff(v), there) - p, p * slope - substitute(L, there) - H)
    return all(vanishes_off_kinks(claim, Domain()).holds for claim in claims)


def _where_real(f: Expr, old: Sequence[Symbol], domain: Domain) -> Domain:
    """Return the domain where roots in f are real, as √(1 − v²/c²) is below the speed of light."""
    return where_real([e for e in f.atoms(sp.Pow) if e.has(*old)], domain)


def where_root_is_real(f: Expr, old: Sequence[Symbol], domain: Domain) -> Domain:
    """Return the domain where f is real, if f holds one square root √r of the old variables and is rational in it.

    Elsewhere r < 0 and f has an imaginary part, as −m c² √(1 − v²/c²) beyond the speed of light.

    Examples
    --------
    >>> v = Symbol("v", real=True)
    >>> where_root_is_real(sp.sqrt(1 - v), [v], Domain()).conditions, where_root_is_real(v**2, [v], Domain()).conditions
    ((v < 1,), ())
    """
    roots: dict[Expr, Expr] = {
        e: sp.Dummy() for e in f.atoms(sp.Pow) if e.has(*old) and not _exponent(e).is_Integer
    }
    seen = exchanged(f, roots)
    inside = any(g.has(*roots.values()) for g in seen.atoms(sp.Function)) if roots else False
    one = len({e.as_base_exp()[0] for e in roots}) == 1
    halves = all((2 * e.as_base_exp()[1]).is_Integer for e in roots)
    return _where_real(f, old, domain) if one and halves and not inside and not f.has(sp.I) else domain


def _candidates(
    f: Expr,
    gradient: Sequence[Expr],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    witnesses: Sequence[BranchPoint],
) -> Iterator[tuple[tuple[Expr, ...], Expr]]:
    """Yield x(y) that may solve y = ∂f/∂x, each with Σ x y − f in terms of y."""
    radicals = {e for e in f.atoms(sp.Pow) if not _exponent(e).is_Integer and e.has(*old)}
    if not radicals and len(old) == 1:
        equation = sp.numer(sp.together(gradient[0] - new[0]))
        yield from _of_odd_power(f, equation, old[0], new[0])
        yield from _of_growing_cubic(f, equation, old[0], new[0])
        for root, _ in low_degree_roots(equation, old[0]):
            yield (root,), sp.factor_terms(root * new[0] - substitute(f, {old[0]: root}))
    bases = {e.as_base_exp()[0] for e in radicals}
    if len(bases) == 1 and all((2 * _exponent(e)).is_Integer for e in radicals):
        yield from _of_one_radical(bases.pop(), f, gradient, old, new, witnesses)
    for witness, slopes in product(witnesses, dict.fromkeys((tuple(gradient), _by_tanh(gradient, old)))):
        solved = solve_system(list(zip(slopes, new, strict=True)), old, Inversion(witness))
        if solved is not None:
            values = tuple(solved[x] for x in old)
            products = (x * y for x, y in zip(values, new, strict=True))
            yield values, sp.Add(*products, -substitute(f, dict(zip(old, values, strict=True))))


def _by_tanh(gradient: Sequence[Expr], old: Sequence[Symbol]) -> tuple[Expr, ...]:
    """Return ∂f/∂x with tanh for quotients of sinh and cosh."""
    sines = {
        g: sp.tanh(g.args[0]) * sp.cosh(g.args[0]) for f in gradient for g in f.atoms(sp.sinh) if g.has(*old)
    }
    return tuple(exchanged(f, sines) for f in gradient)


def _of_growing_cubic(
    f: Expr, equation: Expr, x: Symbol, y: Symbol
) -> Iterator[tuple[tuple[Expr, ...], Expr]]:
    """Yield the only real root of a x³ + b x² + c x + d = 0 where the left side grows, 3 a c > b².

    With x = u − b/3a it is u³ + P u + Q = 0, P > 0, whose root is u = −2 √(P/3) sinh(⅓ arsinh((3 Q/2 P) √(3/P))), real
    without cube roots of negative numbers as in Cardano's formula. Powers of x from x³ are reduced by the equation.
    """
    poly = polynomial_in(equation, x)
    if poly is None or poly.degree() != 3:
        return
    a, b, c, d = poly.all_coeffs()
    P = sp.cancel((3 * a * c - b**2) / (3 * a**2))
    if not P.is_positive:
        return
    Q = sp.cancel((2 * b**3 - 9 * a * b * c + 27 * a**2 * d) / (27 * a**3))
    u = -2 * sp.sqrt(P / 3) * sp.sinh(sp.asinh(3 * Q * sp.sqrt(3 / P) / (2 * P)) / 3)
    root = sp.Dummy()
    total = sp.rem(sp.Poly(x * y - f, x), poly).as_expr() if (x * y - f).is_polynomial(x) else x * y - f
    shifted = root - b / (3 * a)
    yield (u - b / (3 * a),), exchanged(sp.expand(substitute(total, {x: shifted})), {root: u})


def _of_odd_power(f: Expr, equation: Expr, x: Symbol, y: Symbol) -> Iterator[tuple[tuple[Expr, ...], Expr]]:
    """Yield the real root x = s r of xⁿ = c with an odd n from 3, where s = sign(c) and r = |c|^(1/n).

    In f and in x y, which holds c = s rⁿ if c is affine in y, powers of s are 1 or s: no |c| stands beside sign(c).
    """
    poly = polynomial_in(equation, x)
    if poly is None or not is_binomial(poly) or poly.degree() % 2 == 0 or poly.degree() < 3:
        return
    n, c = poly.degree(), -poly.eval(0) / poly.LC()
    s, r = sp.Dummy(), sp.Dummy(positive=True)
    slope = c.diff(y)
    through_c = y if slope.has(y) else (s * r**n - exchanged(c, {y: sp.S.Zero})) / slope
    total = sp.expand(s * r * through_c - substitute(f, {x: s * r}))
    monomials = [(term.subs(s, 1), term.as_coeff_exponent(s)[1]) for term in sp.Add.make_args(total)]
    if not all(power.is_Integer for _, power in monomials):
        return
    reduced = sp.Add(*(rest * s ** (power % 2) for rest, power in monomials))
    values = {s: sp.sign(c), r: sp.Abs(c) ** sp.Rational(1, n)}
    yield (sp.sign(c) * sp.Abs(c) ** sp.Rational(1, n),), exchanged(reduced, values)


def _of_one_radical(
    base: Expr,
    f: Expr,
    gradient: Sequence[Expr],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    witnesses: Sequence[BranchPoint],
) -> Iterator[tuple[tuple[Expr, ...], Expr]]:
    """Yield candidates with the common radical r(x) = √base as an unknown of its own.

    With r held fixed the equations are often linear in x (relativistic momenta are m x / r), and the definition of r
    then is one equation for r².
    """
    r = sp.Dummy("r", positive=True)
    frozen = [
        exchanged(g, {e: r ** (2 * _exponent(e)) for e in g.atoms(sp.Pow) if e.as_base_exp()[0] == base})
        for g in (*gradient, f)
    ]
    slopes = sp.Matrix([[g.diff(x) for x in old] for g in frozen[:-1]])
    if slopes.has(*old):
        return
    at_rest = dict.fromkeys(old, sp.S.Zero)
    right = sp.Matrix([y - exchanged(g, at_rest) for g, y in zip(frozen[:-1], new, strict=True)])
    try:
        column = solve(slopes, right)
    except SingularMatrixError:  # of −√v all slopes stand in r: 1/(2 r) holds no v besides
        return
    in_r = {x: entry(column, i, 0) for i, x in enumerate(old)}
    total = sp.Add(
        *(value * y for value, y in zip(in_r.values(), new, strict=True)), -exchanged(frozen[-1], in_r)
    )
    equation = sp.numer(sp.together(r**2 - exchanged(base, in_r)))
    for square in _squares(equation, r):
        numerator, denominator = sp.fraction(square)
        if any((value := witness.number(denominator)) is not None and value < 0 for witness in witnesses):
            numerator, denominator = (
                -numerator,
                -denominator,
            )  # of r² > 0 both are positive, and the root real
        root = sp.sqrt(numerator) / sp.sqrt(denominator)
        yield (
            tuple(exchanged(value, {r: root}) for value in in_r.values()),
            _with_root(total, r, square, root),
        )


def _squares(equation: Expr, r: Symbol) -> list[Expr]:
    """Return the values of r² that a polynomial equation, even in r, allows."""
    if not equation.is_polynomial(r):
        return []
    square = sp.Dummy()
    even = sp.Poly(equation, r)
    if any(power % 2 for (power,) in even.monoms()):
        return []
    reduced = sp.Add(*(c * square ** (power // 2) for (power,), c in even.terms()))
    return [sp.cancel(value) for value, _ in low_degree_roots(reduced, square)]


def _with_root(f: Expr, r: Symbol, square: Expr, root: Expr) -> Expr:
    """Put r in what is even plus what is odd in r, so that each holds the root at most once."""
    mirrored = exchanged(f, {r: -r})
    even, odd = sp.cancel((f + mirrored) / 2), sp.cancel((f - mirrored) * r / 2)
    s = sp.Dummy()
    even, odd = (sp.cancel(exchanged(_in_square(part, r, s), {s: square})) for part in (even, odd))
    return sp.factor_terms(even) + sp.factor(odd) / root


def _in_square(f: Expr, r: Symbol, s: Symbol) -> Expr:
    """Write a rational function that is even in r through s = r²."""
    numerator, denominator = (sp.Poly(part, r) for part in sp.fraction(sp.cancel(f)))
    if any(power % 2 for part in (numerator, denominator) for (power,) in part.monoms()):
        numerator, denominator = numerator * sp.Poly(r, r), denominator * sp.Poly(r, r)
    return sp.Add(*(c * s ** (power // 2) for (power,), c in numerator.terms())) / sp.Add(
        *(c * s ** (power // 2) for (power,), c in denominator.terms())
    )


def _exponent(power: sp.Pow) -> Expr:
    return power.as_base_exp()[1]
