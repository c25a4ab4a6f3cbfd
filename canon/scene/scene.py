"""A scene: a ready mechanical system as plain data, its symbols and functions built when asked for."""

from __future__ import annotations

import reprlib
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NoReturn

from canon.cached_property import cached_property
from canon.scene.parts import Condition, Integral, Parameter, SceneError, Solution, Start, near

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray
    from sympy import Expr, Symbol

    from canon.expression.symbols.symbol import Coordinate
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    from canon.mechanics.lagrange.body import Body
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.scene.picture import Picture

    Build = Callable[[SimpleNamespace], Expr]
    BuildMany = Callable[[SimpleNamespace], Sequence[Expr]]

__all__ = ["Condition", "Integral", "Parameter", "Scene", "SceneError", "Solution", "Start", "near"]


@dataclass(frozen=True)
class Scene:
    """A mechanical system that is ready to be derived, judged, run and looked at.

    A scene is plain data: no symbol is made and nothing is derived before it is asked for. What a scene says of
    itself it says by functions of its symbols: ``s.x`` a coordinate, ``s.x.dot`` its velocity, ``s.x.momentum``
    the momentum ∂L/∂ẋ, ``s.m`` a parameter, ``s.t`` the time.

    Parameters
    ----------
    name, title
        The name one calls it by, and one line that says what it is.
    coordinates
        Names of the generalized coordinates, separated by spaces.
    parameters
        Its constants with default values.
    starts
        Initial states; the first one is the default.
    time_scale
        Period of a typical motion as a function of the values of the parameters by name.
    time_unit
        Unit of time, empty in dimensionless scenes.
    source
        Where the system and its numbers come from.
    L_of, H_of, bodies_of
        The Lagrangian, the Hamiltonian, or what has mass and where it is; one of them suffices. Bodies beside a
        Lagrangian are an independent account of it: L = T(bodies) − V.
    V_of
        The potential energy of the bodies.
    forces_of
        Generalized forces Q(q, q̇, t) without potential, one a coordinate.
    holonomic_of, nonholonomic_of
        Constraints f(q, t) = 0, and g(q, q̇, t) = 0 affine in the velocities.
    integrals
        Known constants of the motion beside the energy.
    solutions
        Motions known beforehand.
    conditions
        What the parameters must satisfy together.
    picture_of
        What it looks like.
    energy_bound, energy_why
        What the relative change of the energy along a run up to the horizon stays below, and why where it is more
        than 1e-13.
    horizon
        For how many periods a run makes sense in doubles.
    shown
        How many periods its picture shows.
    angles
        Names of the coordinates that may be turned back by whole turns without changing the motion.

    Examples
    --------
    >>> from canon.scene import find
    >>> pendulum = find("simple-pendulum")
    >>> pendulum.hamiltonian.q_dot
    (p_theta/(l**2*m),)
    >>> pendulum.with_parameters(l=2.0).values["l"]
    2.0
    """

    name: str
    title: str
    coordinates: str
    parameters: tuple[Parameter, ...]
    starts: tuple[Start, ...]
    time_scale: Callable[[Mapping[str, float]], float]
    time_unit: str
    source: str
    L_of: Build | None = None
    H_of: Build | None = None
    bodies_of: Callable[[SimpleNamespace], Sequence[Body]] | None = None
    V_of: Build | None = None
    forces_of: BuildMany | None = None
    holonomic_of: BuildMany | None = None
    nonholonomic_of: BuildMany | None = None
    integrals: tuple[Integral, ...] = ()
    solutions: tuple[Solution, ...] = ()
    conditions: tuple[Condition, ...] = ()
    picture_of: Callable[[SimpleNamespace], Picture] | None = None
    energy_bound: float = 1e-13
    energy_why: str = ""
    horizon: float = 1000.0
    shown: float = 5.0
    angles: str = ""

    def __post_init__(self) -> None:
        for condition in self.conditions:
            if not condition.met(self.values):
                given = ", ".join(f"{c.name} = {c.value:g}" for c in self.parameters)
                raise SceneError(f"{given} makes no sense: {condition.about}")

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            f"the scene {self.name} is made of functions, which are not pickled: send its name and values, and "
            "take find(name).with_parameters(**values) there"
        )

    def __deepcopy__(self, memo: object) -> Scene:
        return self

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {self.title}>"

    @cached_property
    def q(self) -> tuple[Coordinate, ...]:
        """The coordinates as symbols."""
        from canon.expression.symbols.symbol import coordinates

        return coordinates(f"{self.coordinates},")

    @cached_property
    def p(self) -> tuple[Symbol, ...]:
        """The momenta as symbols."""
        return tuple(q.momentum for q in self.q)

    @cached_property
    def symbols(self) -> SimpleNamespace:
        """Coordinates, parameters and the time ``t`` as symbols, by name."""
        from canon.expression.symbols.symbol import parameters, time

        constants = [parameters(c.name, **{c.sign: True}) for c in self.parameters]
        return SimpleNamespace(**{s.name: s for s in (time, *self.q, *constants)})

    @property
    def is_free(self) -> bool:
        """Whether no constraints and no forces without potential act, so that a Hamiltonian says all."""
        return not (self.forces_of or self.is_constrained)

    @property
    def is_constrained(self) -> bool:
        """Whether constraints act."""
        return bool(self.holonomic_of or self.nonholonomic_of)

    @property
    def has_lagrangian(self) -> bool:
        """Whether it is given by a Lagrangian or by bodies, and not by a Hamiltonian alone."""
        return self.L_of is not None or self.bodies_of is not None

    @cached_property
    def lagrangian(self) -> Lagrangian:
        """The Lagrangian, with the forces that have no potential."""
        from canon.mechanics.lagrange.lagrangian import Lagrangian

        forces = self.forces_of(self.symbols) if self.forces_of else None
        if self.L_of is not None:
            return Lagrangian(self.L_of(self.symbols), self.q, forces=forces)
        if self.bodies_of is None:
            from canon.mechanics.hamilton.legendre_pair import lagrangian

            return lagrangian(self.hamiltonian)
        from canon.mechanics.lagrange.force import lagrangian_of_bodies

        V = self.V_of(self.symbols) if self.V_of else None
        bodies = self.bodies_of(self.symbols)
        return (
            lagrangian_of_bodies(bodies, self.q, forces=forces)
            if V is None
            else lagrangian_of_bodies(bodies, self.q, V, forces)
        )

    @cached_property
    def constrained(self) -> ConstrainedLagrangian:
        """The Lagrangian with the constraints of the scene."""
        from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

        s = self.symbols
        holonomic = self.holonomic_of(s) if self.holonomic_of else ()
        nonholonomic = self.nonholonomic_of(s) if self.nonholonomic_of else ()
        return ConstrainedLagrangian(self.lagrangian, holonomic, nonholonomic)

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """The Hamiltonian.

        Raises
        ------
        SceneError
            Where constraints or forces without potential act: Hamilton's equations would miss them.
        """
        if not self.is_free:
            raise SceneError(
                f"{self.name} has constraints or forces without potential, so no Hamiltonian says how it moves; "
                "take its lagrangian, or give its name to propagate()"
            )
        from canon.mechanics.hamilton.hamiltonian import Hamiltonian
        from canon.mechanics.hamilton.legendre_pair import hamiltonian

        if self.H_of is None:
            return hamiltonian(self.lagrangian, self.p)
        return Hamiltonian(self.H_of(self.symbols), self.q, self.p)

    @property
    def values(self) -> dict[str, float]:
        """The values of the parameters by name."""
        return {c.name: c.value for c in self.parameters}

    @property
    def period(self) -> float:
        """Period of a typical motion, with the present values of the parameters."""
        return self.time_scale(self.values)

    def values_by_symbol(self) -> dict[Symbol, float]:
        """Return the values of the parameters by symbol, the way ``propagate`` takes them."""
        return {getattr(self.symbols, c.name): c.value for c in self.parameters}

    def constants(self) -> dict[str, Expr]:
        """Return the known constants of the motion beside the energy, as functions of q and p (or q̇) and t."""
        return {integral.name: integral.build(self.symbols) for integral in self.integrals}

    def with_parameters(self, /, **values: float) -> Scene:
        """Return the scene with other values of some parameters, without the motions that are not known then.

        Starts stay the numbers that they are; what was said of those made for other values says so, as that p at a
        perihelion belongs to another mu.

        Raises
        ------
        SceneError
            Where a parameter does not exist or a value makes no sense.
        """
        known = [c.name for c in self.parameters]
        for name in values:
            if name not in known:
                raise SceneError(f"{self.name} has no parameter {name!r}{near(name, known)}")
        changed = tuple(
            replace(c, value=_number(c.name, values[c.name])) if c.name in values else c
            for c in self.parameters
        )
        moved = {c.name for c, now in zip(self.parameters, changed, strict=True) if c.value != now.value}
        unfit = {start.name for start in self.starts if moved & set(start.made_for.split())}
        known_still = tuple(solution for solution in self.solutions if solution.start not in unfit)
        starts = tuple(self._told(start, moved) if start.name in unfit else start for start in self.starts)
        return replace(self, parameters=changed, solutions=known_still, starts=starts)

    def _told(self, start: Start, moved: set[str]) -> Start:
        """Return a start whose words say for which values of the parameters that have moved it was made."""
        others = [name for name in start.made_for.split() if name not in moved]
        was = ", ".join(f"{name} = {self.values[name]:g}" for name in start.made_for.split() if name in moved)
        return replace(start, about=f"{start.about}, made for {was}", made_for=" ".join(others))

    def start(self, name: str | None = None) -> Start:
        """Return the start of that name, or the default one."""
        if name is None:
            return self.starts[0]
        for start in self.starts:
            if start.name == name:
                return start
        raise SceneError(f"{self.name} has no start {name!r}{near(name, [s.name for s in self.starts])}")

    def state(
        self, start: str | Start | None = None, values: Mapping[str, Any] | None = None
    ) -> NDArray[np.float64]:
        """Return an initial state (q, p), shape (2n,); velocities become momenta by p = ∂L/∂q̇.

        Parameters
        ----------
        start
            A start, the name of one, or None for the first.
        values
            Values of parameters by name in place of the scene's own, as the momenta depend on them: numbers, or arrays
            of shape (orbits,). Where momenta differ from orbit to orbit, the state has the shape (2n, orbits).

        Raises
        ------
        SceneError
            Where there is no such start, or it has another number of coordinates.
        ValueError
            Where arrays differ in length.

        Examples
        --------
        >>> from canon.scene import find
        >>> find("simple-pendulum").state("rotating", {"m": 3.0}).tolist()
        [0.0, 21.0]
        """
        import numpy as np

        chosen = start if isinstance(start, Start) else self.start(start)
        if len(chosen.q) != len(self.q):
            raise SceneError(
                f"the start {chosen.name!r} is at {chosen.q}: {self.name} needs one number for each of "
                f"{self.coordinates}"
            )
        if chosen.p is not None:
            return np.array([*chosen.q, *chosen.p])
        from sympy import Float

        from canon.expression.symbols.symbol import time
        from canon.mechanics.algebra.substitution import exchanged

        lagrangian = self.lagrangian
        given = {getattr(self.symbols, name): x for name, x in {**self.values, **(values or {})}.items()}
        varying = {symbol: np.asarray(x) for symbol, x in given.items() if np.ndim(x)}
        known = {
            **{symbol: x for symbol, x in given.items() if symbol not in varying},
            **dict(zip(self.q, chosen.q, strict=True)),
            **dict(zip(lagrangian.velocities, chosen.v or (), strict=True)),
            time: 0.0,
        }
        at = {symbol: Float(float(x)) for symbol, x in known.items()}
        momenta = [exchanged(p, at) for p in lagrangian.momenta]
        if not any(p.free_symbols for p in momenta):
            return np.array([*chosen.q, *map(float, momenta)])
        if len({x.shape for x in varying.values()}) > 1 or any(x.ndim != 1 for x in varying.values()):
            shapes = ", ".join(f"{symbol} of shape {x.shape}" for symbol, x in varying.items())
            raise ValueError(f"{shapes}: parameters by orbit have shape (orbits,)")
        by_orbit: list[list[float]] = []
        for orbit in zip(*varying.values(), strict=True):
            at = {symbol: Float(float(x)) for symbol, x in zip(varying, orbit, strict=True)}
            by_orbit.append([*chosen.q, *(float(exchanged(p, at)) for p in momenta)])
        return np.array(by_orbit).T


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise SceneError(f"{name} = {reprlib.repr(value)}: give a finite number") from None
