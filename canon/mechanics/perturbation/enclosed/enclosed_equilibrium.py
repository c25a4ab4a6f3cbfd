"""Equilibria in balls: Newton's iteration, and the test that the box it ends in holds exactly one zero of ∇H.

For a box B about z the set z − (∇²H(B))⁻¹ ∇H(z) holds every zero of ∇H in B; where it lies inside of B there is one,
and one only (R. E. Moore, R. B. Kearfott, M. J. Cloud, Introduction to Interval Analysis, ch. 8,
doi:10.1137/1.9780898717716).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import acb, arb, arb_mat, ctx

from canon.mechanics.perturbation.enclosed.enclosed_polynomial import PrecisionError
from canon.proof.domain.balls import value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = ["enclosed_equilibrium", "enclosed_hessian"]

MOST_STEPS = 100


def enclosed_equilibrium(
    H: Expr, variables: Sequence[Symbol], near: Sequence[arb], constants: Mapping[Symbol, acb]
) -> list[arb]:
    """Return balls about the one equilibrium that Newton's iteration finds from a place near it.

    Raises
    ------
    PrecisionError
        Where the iteration does not end, or its end is not proved to be an equilibrium.
    """
    gradient = [H.diff(z) for z in variables]
    curvature = [[g.diff(z) for z in variables] for g in gradient]
    place = [x.mid() for x in near]
    small = arb(2) ** (-ctx.prec // 2)
    for _ in range(MOST_STEPS):
        step = _newton_step(gradient, curvature, variables, place, place, constants)
        place = [(x - s).mid() for x, s in zip(place, step, strict=True)]
        if all(abs(s) < small * (1 + abs(x)) for s, x in zip(step, place, strict=True)):
            break
    else:
        raise PrecisionError("Newton's iteration for the equilibrium does not end; start nearer to it")
    width = arb(2) ** (-ctx.prec + 40)
    box = [x + arb(0, 1) * width * (1 + abs(x)) for x in place]
    step = _newton_step(gradient, curvature, variables, place, box, constants)
    found = [x - s for x, s in zip(place, step, strict=True)]
    if not all(b.contains_interior(f) for b, f in zip(box, found, strict=True)):
        raise PrecisionError("the equilibrium was not proved; take more digits, or start nearer to it")
    return found


def enclosed_hessian(H: Expr, variables: Sequence[Symbol], place: Mapping[Symbol, acb]) -> list[list[arb]]:
    """Return ∂²H at a place in balls."""
    known: dict[Any, acb] = dict(place)
    return [[value(H.diff(x, y), {}, known).real for y in variables] for x in variables]


def _newton_step(
    gradient: Sequence[Any],
    curvature: Sequence[Sequence[Any]],
    variables: Sequence[Symbol],
    at: Sequence[arb],
    box: Sequence[arb],
    constants: Mapping[Symbol, acb],
) -> list[arb]:
    """Return (∇²H(box))⁻¹ ∇H(at)."""
    here: dict[Any, acb] = {**constants, **{z: acb(x) for z, x in zip(variables, at, strict=True)}}
    there: dict[Any, acb] = {**constants, **{z: acb(x) for z, x in zip(variables, box, strict=True)}}
    slope = arb_mat([[value(g, {}, here).real] for g in gradient])
    matrix = arb_mat([[value(h, {}, there).real for h in row] for row in curvature])
    try:
        step = matrix.solve(slope)
    except ZeroDivisionError as singular:
        raise PrecisionError(
            "∂²H is singular where the equilibrium is looked for: it is not isolated; reduce an ignorable coordinate"
        ) from singular
    return [step[j, 0] for j in range(len(variables))]
