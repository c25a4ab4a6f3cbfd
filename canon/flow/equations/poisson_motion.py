"""Motion on Poisson manifolds: ẋ = Π ∇H as equations of first order, with the parts of H whose flows are known."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.graph.graph import Graph
from canon.expression.graph.piecewise_form import without_pieces
from canon.flow.equations.first_order_motion import FirstOrderMotion, from_any_start
from canon.flow.equations.lie_poisson_search import LiePoissonSearch, brackets_on, row_product
from canon.flow.method.lie_poisson_splitting import NoLiePoissonPartsError
from canon.mechanics.hamilton.poisson_system import PoissonSystem

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Symbol

    from canon.flow.equations.first_order_motion import MovingSystem

__all__ = ["poisson_motion", "with_lie_poisson_parts"]


def poisson_motion(system: PoissonSystem) -> FirstOrderMotion:
    """Return the equations ẋ = Π ∇H.

    Examples
    --------
    >>> from canon.mechanics import free_body
    >>> poisson_motion(free_body([1, 2, 3])).state
    (M_1, M_2, M_3)
    """
    graph = Graph()
    H = graph.from_sympy(without_pieces(system.H))
    slopes, brackets = graph.gradient(H, system.x), brackets_on(graph, system)
    rates = tuple(row_product(graph, row, slopes) for row in brackets)
    changes = graph.derivative(H, system.t)
    power = None if changes == graph.zero else changes
    return FirstOrderMotion(
        "Poisson system", graph, system.x, (), "x", system.t, rates, H, power, holds_from=from_any_start
    )


def with_lie_poisson_parts(
    given: Any,
    moving: MovingSystem,
    numbers: Mapping[str, Fraction],
    varying: Sequence[Symbol] = (),
) -> MovingSystem:
    """Return a moving system whose equations say which parts of H have flows in closed form.

    Parameters
    ----------
    given
        What the user gave: a Poisson system.
    moving
        Its equations with numbers.
    numbers, varying
        The parameters' numbers by name, and those that differ from orbit to orbit.

    Raises
    ------
    TypeError
        It is no Poisson system.
    NoLiePoissonPartsError
        H is no sum of such parts.
    """
    if not isinstance(given, PoissonSystem):
        raise TypeError(
            f"LiePoissonSplitting is for a PoissonSystem, such as canon.mechanics.rotating_body(…), and does not apply "
            f"to a {moving.kind}; Taylor, DOP853, RK4 and Gauss do"
        )
    if not moving.equations.autonomous:
        raise NoLiePoissonPartsError(
            "LiePoissonSplitting is for H that does not hold the time; Taylor, DOP853, RK4 and Gauss do"
        )
    try:
        parts = LiePoissonSearch(given, given.H, moving, numbers, varying).parts()
    except NoLiePoissonPartsError:
        # (M₁ + M₂)² − 2 M₁ M₂ is a sum only after multiplying out, which is cheap for polynomials.
        if not given.H.is_polynomial(*given.x):
            raise
        parts = LiePoissonSearch(given, sp.expand(given.H), moving, numbers, varying).parts()
    return replace(moving, equations=replace(moving.equations, lie_poisson=parts))
