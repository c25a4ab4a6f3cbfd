"""SymPy mechanics models (LagrangesMethod, KanesMethod) converted to canon.

SymPy's LagrangesMethod writes d/dt ∂L/∂q̇ − ∂L/∂q = Q − Σ λ a, canon (as most textbooks) + Σ λ a: the multipliers of
the two differ in sign, the motions do not. A holonomic constraint stays f(q, t) = 0 in canon; SymPy keeps its rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast, overload

import sympy as sp
from sympy import Expr

from canon.cached_property import cached_property
from canon.mechanics.algebra.dynamicsymbols import coordinate, plain
from canon.mechanics.algebra.linear import solve_affine
from canon.mechanics.algebra.substitution import entry
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.quasi_velocity import Kinematics

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Symbol
    from sympy.physics.mechanics import KanesMethod, LagrangesMethod

__all__ = ["QuasiMotion", "from_sympy_mechanics"]


@dataclass(frozen=True)
class QuasiMotion:
    """Equations of motion in quasi-velocities.

    Parameters
    ----------
    kinematics
        q̇ as a function of q, u, t.
    equations
        As many equations as quasi-velocities, each expression = 0, affine in u̇.
    holonomic, nonholonomic
        Constraints f(q, t) = 0 and g(q, u, t) = 0 that the equations keep, where the start is on them.
    """

    kinematics: Kinematics
    equations: tuple[Expr, ...]
    holonomic: tuple[Expr, ...] = ()
    nonholonomic: tuple[Expr, ...] = ()

    @cached_property
    def quasi_accelerations(self) -> tuple[Expr, ...]:
        """The rates u̇(q, u, t) that solve the equations."""
        return tuple(solve_affine(self.equations, self.kinematics.u_dot, name="the mass matrix").values())


@overload
def from_sympy_mechanics(method: LagrangesMethod) -> ConstrainedLagrangian: ...
@overload
def from_sympy_mechanics(method: KanesMethod) -> QuasiMotion: ...
def from_sympy_mechanics(method: Any) -> ConstrainedLagrangian | QuasiMotion:
    """Return a LagrangesMethod as a Lagrangian with its constraints, a KanesMethod as motion in its speeds.

    SymPy's LagrangesMethod writes the reactions − Σ λ a, canon + Σ λ a: where SymPy's multiplier is λ, ``multipliers``
    of what is returned is −λ. The accelerations and the reactions themselves are the same.

    Parameters
    ----------
    method
        A LagrangesMethod (its equations need not be formed), or a KanesMethod after ``kanes_equations()``.

    Raises
    ------
    TypeError
        Where it is neither.
    ValueError
        Where a KanesMethod has not formed its equations.

    Examples
    --------
    >>> from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols
    >>> x, y = dynamicsymbols("x y")
    >>> L = x.diff()**2/2 + y.diff()**2/2 - 10*y
    >>> taken = from_sympy_mechanics(LagrangesMethod(L, [x, y], nonhol_coneqs=[y.diff() - x.diff()]))
    >>> taken.nonholonomic, taken.multipliers
    ((-x_dot + y_dot,), (5,))
    """
    from sympy.physics.mechanics import KanesMethod, LagrangesMethod

    if isinstance(method, LagrangesMethod):
        return _of_lagranges_method(method)
    if isinstance(method, KanesMethod):
        return _of_kanes_method(method)
    raise TypeError(
        f"{type(method).__name__} is neither a LagrangesMethod nor a KanesMethod of sympy.physics.mechanics; "
        "give one of these"
    )


def _of_lagranges_method(method: LagrangesMethod) -> ConstrainedLagrangian:
    kept: dict[str, Any] = vars(method)  # SymPy shows neither L nor the holonomic constraints otherwise
    (L,) = kept["_L"]
    holonomic, rates = list(kept["_hol_coneqs"]), list(cast("Any", method.coneqs))
    q = list(cast("Any", method.q))
    forces = list(_generalized_forces(method, q)) if method.forcelist else None
    lagrangian = Lagrangian(L, q, forces=forces)
    return ConstrainedLagrangian(lagrangian, holonomic, rates[len(holonomic) :])


def _generalized_forces(method: LagrangesMethod, q: list[Any]) -> Iterator[Expr]:
    """Yield Σ F·∂v/∂q̇ + Σ M·∂ω/∂q̇ of the forces at points and torques on frames or bodies."""
    from sympy.physics.mechanics import ReferenceFrame

    N = method.inertial
    pairs = [(getattr(place, "masscenter", place), vector) for place, vector in _loads(method.forcelist)]
    for s in q:
        (t,) = s.args
        yield sp.Add(
            *(
                (place.ang_vel_in(N) if isinstance(place, ReferenceFrame) else place.vel(N))
                .diff(s.diff(t), N, var_in_dcm=False)
                .dot(vector)
                for place, vector in pairs
            )
        )


def _loads(forcelist: Any) -> Iterator[tuple[Any, Any]]:
    for load in forcelist:
        place, vector = tuple(load)
        yield place, vector


def _of_kanes_method(method: KanesMethod) -> QuasiMotion:
    if vars(method)["_fr"] is None:
        raise ValueError("this KanesMethod has no equations yet; call its kanes_equations() first")
    given = list(cast("Any", method.q))
    kept: Any = method.kindiffdict()
    speeds = list(cast("Any", method.u))
    rates = [kept[s.diff(s.args[0])] for s in given]
    kinematics = Kinematics(given, speeds, rates)
    u_dot = kinematics.u_dot
    names = (*kinematics.q, *(coordinate(w) for w in speeds))
    M, f = cast("Any", method.mass_matrix), cast("Any", method.forcing)
    equations = (
        sp.Add(
            *(plain(entry(M, i, j), names) * a for j, a in enumerate(u_dot)), -plain(entry(f, i, 0), names)
        )
        for i in range(len(u_dot))
    )
    return QuasiMotion(kinematics, tuple(equations), *_constraints_of_kane(method, names))


def _constraints_of_kane(method: KanesMethod, names: Sequence[Symbol]) -> Iterator[tuple[Expr, ...]]:
    """Yield the constraints on configurations, then those on speeds, K u + k = 0."""
    kept: dict[str, Any] = vars(method)  # SymPy shows them nowhere else
    K, k = kept["_k_nh"], kept["_f_nh"]
    on_speeds = K * sp.Matrix(cast("Any", method.u)) + k if K else sp.Matrix()
    for constraints in (sp.Matrix(kept["_f_h"]), on_speeds):
        yield tuple(plain(f, names) for f in constraints.flat())
