"""Integration methods as values: which to use with which settings, not how it runs.

Each answers for itself: ``engine`` (what integrates it, whether it takes a step, its precisions), ``family`` (the word
that tables of functions know it by), ``order``, ``stages`` (its cost), ``is_symplectic``, ``solvable`` (the splitting
by solvable parts that it is, or None), ``tolerance`` (None where it takes a step), ``written`` (the method as files
hold it), ``str`` (in words), ``citation``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import counted, given_expression
from canon.flow.method.adaptive_methods import DOP853, Taylor
from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.engine import FICTITIOUS_TIME, FIXED_STEPS
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.flow.method.solvable_splitting import SolvableSplitting
from canon.flow.method.stage_iteration import ITERATIONS, check_iteration
from canon.flow.method.variational_method import GalerkinVariational
from canon.kernel.schemes.gauss_tableau import HIGHEST_STAGES
from canon.kernel.schemes.order_conditions import order
from canon.kernel.schemes.splitting_schemes import SCHEMES, Scheme

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

__all__ = [
    "DOP853",
    "RK4",
    "FixedStep",
    "Gauss",
    "Method",
    "Splitting",
    "Stepped",
    "Taylor",
    "TimeTransformed",
]

Coefficient = float | int | str | Fraction
"""Text is read as the exact decimal or quotient it spells, a float as the binary number it is."""


@dataclass(frozen=True, init=False)
class Splitting:
    """A symplectic splitting method for H = T(p, t) + V(q, t): drifts and kicks in turn.

    Parameters
    ----------
    name
        One of ``verlet``, ``forest-ruth``, ``suzuki-4``, ``mclachlan-4``, ``blanes-moan-4``,
        ``blanes-moan-6``, ``kahan-li-6``, ``kahan-li-8``, ``sofroniou-spaletta-10``; or ``srkn-6a``,
        ``srkn-6b`` where T is quadratic in p.
    a, b
        Coefficients of your own instead: drift a₁h, kick b₁h, drift a₂h …; as many drifts as kicks, or one
        more.
    parts
        H₀ and H₁ with H = H₀ + H₁, in place of T and V: the flow of H₀, which is quadratic in (q, p) or Kepler's
        motion, takes the drifts' place, kicks by H₁, a function of q, the kicks'. See also
        :func:`canon.flow.method.solvable_splitting.SABA`.

    Raises
    ------
    ValueError
        No such method; or coefficients whose number is wrong or which do not add up to 1; or the parts are not two.

    Examples
    --------
    >>> Splitting("kahan-li-8")
    Splitting('kahan-li-8')
    >>> Splitting("kahan-li-8").order, Splitting("kahan-li-8").stages
    (8, 17)
    >>> Splitting(a=["1/2", "1/2"], b=[1]).order
    2
    """

    scheme: Scheme
    parts: tuple[Expr, Expr] | None = None
    engine, is_symplectic, tolerance = FIXED_STEPS, True, None

    def __init__(
        self,
        name: str | None = None,
        *,
        a: Sequence[Coefficient] | None = None,
        b: Sequence[Coefficient] | None = None,
        parts: tuple[Expr, Expr] | None = None,
    ) -> None:
        object.__setattr__(self, "parts", _two_parts(parts))
        if (name is None) == (a is None) or (a is None) != (b is None):
            raise ValueError("say which splitting: Splitting('kahan-li-8'), or Splitting(a=[…], b=[…])")
        if name is not None:
            if name not in tuple(SCHEMES):  # by comparison: a list has no hash
                raise ValueError(f"no splitting is called {name!r}; there are {', '.join(SCHEMES)}")
            object.__setattr__(self, "scheme", SCHEMES[name])
        elif a is not None and b is not None:
            object.__setattr__(self, "scheme", _own_scheme(a, b))

    def __repr__(self) -> str:
        parts = f", parts={self.parts}" if self.parts else ""
        if self.scheme.name:
            return f"Splitting({self.scheme.name!r}{parts})"
        a, b = ([float(x) for x in half] for half in (self.scheme.a, self.scheme.b))
        return f"Splitting(a={a}, b={b}{parts})"

    def __str__(self) -> str:
        name = self.scheme.name or f"splitting, order {self.order}, {counted(self.stages, 'stage')}"
        return f"{name}, own parts" if self.parts else name

    @property
    def family(self) -> str:
        """What it is called in files; with parts it is a splitting by solvable ones."""
        return "splitting" if self.parts is None else "solvable"

    @property
    def solvable(self) -> SolvableSplitting | None:
        """The splitting by solvable parts that it is, where it has parts."""
        return None if self.parts is None else SolvableSplitting(self.scheme, parts=self.parts)

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it.

        Raises
        ------
        ValueError
            It has parts, which are no text.

        Examples
        --------
        >>> Splitting("verlet").written, Gauss(4).written, Taylor(1e-10).written
        ({'splitting': 'verlet'}, {'gauss': 4}, {'taylor': 1e-10})
        """
        if self.parts is not None:
            raise ValueError(f"{self}: a study takes the parts T(p) and V(q) of H, none of your own")
        own = {"a": [str(x) for x in self.scheme.a], "b": [str(x) for x in self.scheme.b]}
        return {"splitting": self.scheme.name or own}

    @cached_property
    def order(self) -> int:
        """The order of the method; for ``srkn`` methods on kinetic energies quadratic in p."""
        return self.scheme.order

    @property
    def stages(self) -> int:
        """Force evaluations in a step."""
        return self.scheme.stages

    @property
    def citation(self) -> str:
        """Where the method was published."""
        return self.scheme.citation


def _two_parts(parts: Sequence[Expr] | None) -> tuple[Expr, Expr] | None:
    """Return parts as they can be kept."""
    if parts is None:
        return None
    given = tuple(parts) if hasattr(parts, "__iter__") else (parts,)
    if len(given) != 2:
        raise ValueError(f"parts={parts}: give the two parts of H = H0 + H1, parts=(H0, H1)")
    return given


def _own_scheme(a: Sequence[Coefficient], b: Sequence[Coefficient]) -> Scheme:
    drifts, kicks = ([_exact(x) for x in half] for half in (a, b))
    if len(drifts) == len(kicks):
        drifts.append(Fraction(0))
    if len(drifts) != len(kicks) + 1 or not kicks:
        raise ValueError(
            f"{counted(len(drifts), 'drift')} and {counted(len(kicks), 'kick')}: "
            "they alternate, so give as many or one drift more"
        )
    for letter, half in (("a", drifts), ("b", kicks)):
        if abs(sum(half) - 1) > Fraction(1, 10**12):
            raise ValueError(
                f"the coefficients {letter} add up to {float(sum(half))!r}; a consistent method has 1"
            )
    found = order([float(x) for x in drifts], [float(x) for x in kicks])
    return Scheme("", found, tuple(drifts), tuple(kicks), "coefficients given by the user")


def _exact(x: Coefficient) -> Fraction:
    if isinstance(x, float) and not math.isfinite(x):
        raise ValueError(f"{x} is no coefficient: give finite numbers")
    return Fraction(x)


@dataclass(frozen=True, repr=False)
class Gauss:
    """A Gauss–Legendre method: implicit, symplectic and symmetric for every Hamiltonian, of order 2s.

    Parameters
    ----------
    stages
        s = 1 (the implicit midpoint rule) … 8.
    iteration
        How the stages are found: ``"fixed-point"``, cheapest where the step is set by the motion, or ``"newton"``, by
        Newton's method, which converges where stiff springs are much faster than the motion that is
        followed.

    Raises
    ------
    ValueError
        No such number of stages, or no such iteration.

    Notes
    -----
    Steps that are long beside the period of a stiff spring do not follow its swings; they follow the motion along which
    it hardly swings. Where the spring turns on the way, as in a pendulum, the method's error excites its swings, and
    they grow where a step is more than some 10³ of its radians: take a constraint in its place then, or smaller steps.

    Examples
    --------
    >>> Gauss(6).order, Gauss(2, iteration="newton")
    (12, Gauss(stages=2, iteration='newton'))
    """

    stages: int = 6
    iteration: str = "fixed-point"
    citation = (
        "E. Hairer, R. I. McLachlan, A. Razakarivony, Achieving Brouwer’s law with implicit Runge–Kutta methods, "
        "BIT 48 (2008) 231–243, doi:10.1007/s10543-008-0170-3"
    )
    engine, family, is_symplectic, solvable = FIXED_STEPS, "gauss", True, None
    tolerance = None

    def __post_init__(self) -> None:
        if self.stages not in range(1, HIGHEST_STAGES + 1):
            raise ValueError(f"Gauss({self.stages}): the number of stages is 1 … {HIGHEST_STAGES}")
        object.__setattr__(self, "stages", int(self.stages))
        check_iteration(self.iteration)

    @property
    def _choice(self) -> dict[str, str]:
        """The iteration where it is not the usual one."""
        return {} if self.iteration == ITERATIONS[0] else {"iteration": self.iteration}

    def __repr__(self) -> str:
        return (
            f"Gauss(stages={self.stages}{''.join(f', iteration={each!r}' for each in self._choice.values())})"
        )

    def __str__(self) -> str:
        return f"Gauss({self.stages}{''.join(f', {each}' for each in self._choice.values())})"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"gauss": self.stages, **self._choice}

    @property
    def order(self) -> int:
        """2s."""
        return 2 * self.stages


@dataclass(frozen=True)
class RK4:
    """The classical fourth-order Runge–Kutta method: not symplectic, its energy error grows with time.

    Examples
    --------
    >>> RK4().order, RK4().stages
    (4, 4)
    """

    order = 4
    stages = 4
    citation = (
        "W. Kutta, Beitrag zur näherungsweisen Integration totaler Differentialgleichungen, "
        "Z. Math. Phys. 46 (1901) 435–453"
    )
    engine, family, is_symplectic, solvable = FIXED_STEPS, "rk4", False, None
    tolerance = None

    def __str__(self) -> str:
        return "RK4"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"rk4": True}


@dataclass(frozen=True)
class TimeTransformed:
    """A symplectic method in a fictitious time, whose steps in t vary with the state, for close encounters.

    Parameters
    ----------
    method
        A splitting, with the logarithmic Hamiltonian of Mikkola and Tanikawa and of Preto and Tremaine, for H = T(p) +
        V(q, t) with V < 0 along the motion: dt/ds = −1/V. Or a Gauss method with a function g.
    g
        dt/ds as a function of (q, p), positive along the motion, for Poincaré's K = g(H − E₀), which takes a
        Gauss method; a constant factor in it is of no account.

    Raises
    ------
    TypeError
        The method is neither a splitting nor a Gauss method, such as a name alone.
    ValueError
        A splitting with g, or a Gauss method without.

    Notes
    -----
    ``step`` is the size in t of the first step; elsewhere steps are longer or shorter as dt/ds is. The end, named
    ``times`` and events are reached by a part of a step, so that those states err by one more part of a step than the
    motion itself, which goes on from its own whole steps. ``samples`` of one orbit are evenly spaced in steps, more
    where steps are short; of many orbits in t.

    Examples
    --------
    >>> from canon.flow.propagation import propagate
    >>> from canon.scene import find
    >>> kepler = find("kepler")
    >>> near = kepler.start("e=0.9")
    >>> method = TimeTransformed(Splitting("verlet"))
    >>> motion = propagate(
    ...     kepler.hamiltonian, (0, 10), [*near.q, *near.p], method=method, step=1e-4, parameters=kepler.values
    ... )
    >>> bool(abs(motion.energy_error).max() < 1e-14)
    True
    """

    method: Splitting | Gauss
    g: Expr | None = None
    engine, family, is_symplectic, solvable = FICTITIOUS_TIME, "time_transformed", True, None
    tolerance = None

    def __post_init__(self) -> None:
        given: Any = self.method
        if not isinstance(given, Splitting | Gauss):
            raise TypeError(
                f"TimeTransformed({given!r}): give a splitting or a Gauss method as a value, such as "
                "TimeTransformed(Splitting('verlet')) or TimeTransformed(Gauss(6), g=…)"
            )
        implicit = isinstance(given, Gauss)
        if not implicit and (self.g is not None or self.method.solvable is not None):
            raise ValueError(
                "g(q, p)(H − E0) does not split: give a Gauss method with g, or a splitting without g and parts"
            )
        if implicit and self.g is None:
            raise ValueError(
                "say how long a step is to be where: TimeTransformed(Gauss(6), g=…), such as g = r near a centre"
            )
        if self.g is not None:
            object.__setattr__(self, "g", given_expression(self.g, "g of TimeTransformed"))

    def __str__(self) -> str:
        return f"{self.method}, time-transformed"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it.

        Raises
        ------
        ValueError
            It has a function g, which is no text.
        """
        if self.g is not None:
            raise ValueError(f"{self} with g: a study takes the splittings, which need none")
        return {"time_transformed": self.method.written}

    @property
    def order(self) -> int:
        """The method's own."""
        return self.method.order

    @property
    def stages(self) -> int:
        """The method's own."""
        return self.method.stages

    @property
    def citation(self) -> str:
        """Where the transformation was published."""
        if self.g is not None:
            return "E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration (2nd ed., Springer 2006), § VIII.2"
        return (
            "S. Mikkola, K. Tanikawa, Explicit symplectic algorithms for time-transformed Hamiltonians, Celest. Mech. "
            "Dyn. Astron. 74 (1999) 287–295, doi:10.1023/A:1008368322547; M. Preto, S. Tremaine, A class of symplectic "
            "integrators with adaptive time step for separable Hamiltonian systems, Astron. J. 118 (1999) 2532–2541, "
            "doi:10.1086/301102"
        )


FixedStep = (
    Splitting
    | Gauss
    | RK4
    | SolvableSplitting
    | ExtendedPhaseSpace
    | SemiexplicitSplitting
    | Rattle
    | NonholonomicLeapfrog
    | LiePoissonSplitting
    | Boris
    | MagneticSplitting
    | AverageVectorField
    | GalerkinVariational
)
"""Methods that take steps of one size."""

Stepped = FixedStep | TimeTransformed
"""Methods that take ``step=``; the others choose theirs by ``tolerance=``."""

Method = Stepped | Taylor | DOP853
"""What ``propagate`` takes as ``method``."""
