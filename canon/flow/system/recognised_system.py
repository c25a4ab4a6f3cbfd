"""Recognised systems: what a person has, its variables and parameters, and how its equations are derived."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.input_in_words import module_of
from canon.expression.symbols.symbol import velocity
from canon.flow.equations.contact_motion import contact_motion
from canon.flow.equations.lagrangian_motion import constraints_of, lagrangian_motion
from canon.flow.equations.listed_equations import field_motion, heyoka_field, is_heyoka_system
from canon.flow.equations.poisson_motion import poisson_motion
from canon.flow.equations.quasi_velocity_motion import appell_motion, newton_euler_motion, quasi_motion
from canon.flow.equations.routhian_motion import routhian_motion, routhian_state
from canon.flow.system.parameter_values import symbols_in
from canon.flow.system.written_with_signs import written_with_signs
from canon.mechanics.hamilton.poisson_system import PoissonSystem
from canon.mechanics.hamilton.vector_field import VectorField
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.newton_euler import NewtonEuler
from canon.mechanics.lagrange.sympy_bridge import QuasiMotion, from_sympy_mechanics
from canon.mechanics.lagrange.unilateral import UnilateralLagrangian
from canon.mechanics.reduction.routh import Routhian
from canon.mechanics.traced.rates_function import is_rates_function

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from sympy import Expr, Symbol
    from sympy.physics.mechanics import KanesMethod, LagrangesMethod

    from canon.flow.equations.first_order_motion import FirstOrderMotion
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.system.hamiltonian_map import HamiltonianMap
    from canon.flow.system.scene_as_system import SceneLike
    from canon.mechanics.lagrange.body import Body

    MovableSystem = (
        HamiltonianSystem
        | HamiltonianMap
        | Lagrangian
        | ConstrainedLagrangian
        | UnilateralLagrangian
        | Routhian
        | GibbsAppell
        | QuasiMotion
        | NewtonEuler
        | VectorField
        | PoissonSystem
        | LagrangesMethod
        | KanesMethod
        | Sequence[tuple[Any, Any]]
        | Callable[[Any, Any], Any]
        | SceneLike
        | str
    )

__all__ = ["RecognisedSystem", "recognised"]


@dataclass(frozen=True, eq=False)
class RecognisedSystem:
    """A system, its variables and parameters known, its equations not derived yet.

    Parameters
    ----------
    state, t
        The variables in the order of the state, and the time.
    parameters
        The symbols that need a number.
    derived
        The equations, from numbers for the state, t and the parameters at the start.
    unneeded
        Symbols of what was given that the equations do not hold, such as a mass that drops out.
    system
        The system as canon writes it: models of others converted, functions made of pieces taken apart.
    """

    state: tuple[Symbol, ...]
    t: Symbol
    parameters: tuple[Symbol, ...]
    derived: Callable[[Mapping[Symbol, float]], FirstOrderMotion]
    unneeded: tuple[Symbol, ...] = ()
    system: Any = None


def recognised(system: Any) -> RecognisedSystem:
    """Return what is known of a system before its equations are derived.

    Raises
    ------
    TypeError
        It is no system that moves.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, k = coordinates("x"), parameters("k", positive=True)
    >>> found = recognised(Lagrangian(x.dot**2 / 2 - k * x**2 / 2, [x]))
    >>> found.state, found.parameters
    ((x, x_dot), (k,))
    """
    if module_of(type(system)).startswith("sympy.physics.mechanics"):
        system = from_sympy_mechanics(system)
    if is_heyoka_system(system):
        system = heyoka_field(system)
    system = written_with_signs(system)
    return replace(_known(system), system=system)


def _known(system: Any) -> RecognisedSystem:
    """Return what is known of a system that canon writes so."""
    if isinstance(system, Lagrangian | ConstrainedLagrangian):
        return _of_lagrangian(system)
    if isinstance(system, UnilateralLagrangian):
        found = _of_lagrangian(system.system)
        said = (*found.parameters, *system.unilateral, *(system.restitution or ()))
        return _with(found.state, found.t, said, lambda start: contact_motion(system, start))
    if isinstance(system, Routhian):
        L = system.lagrangian
        said = (L.L, *L.forces, *system.ignorable_velocities)
        return _with(routhian_state(system), system.t, said, lambda start: routhian_motion(system, start))
    if isinstance(system, GibbsAppell):
        kinematics = system.kinematics
        said = (*kinematics.q_dot, system.gibbs_function, *system.forces)
        state, hidden = (*kinematics.q, *kinematics.u), kinematics.u_dot
        found = _with(state, kinematics.t, said, lambda start: appell_motion(system, start), hidden)
        return replace(found, unneeded=_of_bodies(system.bodies))
    if isinstance(system, QuasiMotion):
        kinematics = system.kinematics
        said = (*kinematics.q_dot, *system.equations, *system.holonomic, *system.nonholonomic)
        state = (*kinematics.q, *kinematics.u)
        return _with(state, kinematics.t, said, lambda start: quasi_motion(system, start), kinematics.u_dot)
    if isinstance(system, NewtonEuler):
        state = (*system.q, *map(velocity, system.q))
        return _with(
            state,
            system.t,
            system.balances,
            lambda start: newton_euler_motion(system, start),
            system.unknowns,
        )
    if isinstance(system, VectorField):
        motion = field_motion(system)
        return RecognisedSystem(motion.state, motion.t, motion.parameters, lambda _: motion)
    if isinstance(system, PoissonSystem):
        said = (system.H, *system.brackets)
        return _with(system.x, system.t, said, lambda _: poisson_motion(system))
    if is_rates_function(system):
        raise TypeError(
            f"{system!r} does not say how many variables it has: give canon.mechanics.field_of_function(f, n), which "
            "reads a function f(t, y) of n variables as a vector field"
        )
    if isinstance(system, list | tuple | dict):
        raise TypeError(
            "a list or a table of rates is no system that can be propagated: "
            "write canon.VectorField(rates, variables), the rates in the order of the variables"
        )
    raise TypeError(
        f"{system!r} is no system that can be propagated: give a Hamiltonian, a Lagrangian with its forces and "
        "constraints, Gibbs–Appell or Newton–Euler equations, a Routhian, a vector field, a Poisson system, a scene or "
        "its name, SymPy's LagrangesMethod or KanesMethod, or heyoka's list of (variable, right-hand side)"
    )


def _of_lagrangian(system: Lagrangian | ConstrainedLagrangian) -> RecognisedSystem:
    lagrangian, holonomic, nonholonomic = constraints_of(system)
    said = (lagrangian.L, *lagrangian.forces, *holonomic, *nonholonomic)
    state = (*lagrangian.q, *lagrangian.velocities)
    return _with(state, lagrangian.t, said, lambda start: lagrangian_motion(system, start))


def _of_bodies(bodies: Sequence[Body]) -> tuple[Symbol, ...]:
    """Return the symbols of masses and inertias."""
    used: set[Any] = set().union(*(body.m.free_symbols | body.inertia.free_symbols for body in bodies))
    return tuple(used)


def _with(
    state: Sequence[Symbol],
    t: Symbol,
    said: Iterable[Expr],
    derived: Callable[[Mapping[Symbol, float]], FirstOrderMotion],
    unknown: Sequence[Symbol] = (),
) -> RecognisedSystem:
    used = frozenset[Any]().union(*map(symbols_in, said))
    parameters = sorted(used - {*state, t, *unknown}, key=lambda s: s.name)
    return RecognisedSystem(tuple(state), t, tuple(parameters), derived)
