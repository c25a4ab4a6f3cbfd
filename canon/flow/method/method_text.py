"""Methods by name, as ``method="kahan-li-8"`` and the command line give them, and as study files write them."""

from __future__ import annotations

import functools
import inspect
import re
import reprlib
from difflib import get_close_matches
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

from canon.flow.method.adaptive_methods import DOP853, Taylor
from canon.flow.method.composition import COMPOSITIONS
from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
from canon.flow.method.method import RK4, Gauss, Method, Splitting, TimeTransformed
from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.flow.method.solvable_splitting import SABA, SBAB, WisdomHolman
from canon.flow.method.variational_method import GalerkinVariational
from canon.kernel.schemes.gauss_tableau import HIGHEST_STAGES
from canon.kernel.schemes.perturbed_schemes import ABA
from canon.kernel.schemes.splitting_schemes import SCHEMES

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["MethodGiven", "method_from", "method_named", "method_of"]

MethodGiven = Method | type[Method] | str
"""How a method may be given: as a value, by its name, or as a class whose arguments all have defaults."""

_EIGHT = range(1, 9)
"""Stages of SABA and SBAB methods."""

_AVERAGES = range(2, 2 * HIGHEST_STAGES + 1, 2)
"""Orders of the average vector field methods."""

_NUMBERED = re.compile(r"(gauss|saba|sbab)([0-9]{1,3})")

_NEWTON = re.compile(r"gauss([0-9]{1,3})newton")

_TAO = re.compile(
    r"\s*tao[-_ ]?([0-9]{1,3})[,;]?\s*omega\s*=?\s*(\.?[0-9]{1,30}|[0-9]{1,30}\.[0-9]{0,30})(e[-+]?[0-9]{1,3})?\s*",
    re.IGNORECASE,
)

_AVERAGE = re.compile(
    r"\s*avf[-_ ]?([0-9]{1,3})(?:,?\s*points\s*=?\s*([0-9]{1,3}))?(?:[-,_ ]\s*(newton))?\s*", re.IGNORECASE
)

_GALERKIN = re.compile(
    r"\s*galerkin[-_ ]?([0-9]{1,3})(?:,?\s*points\s*=?\s*([0-9]{1,3}))?(?:[-,_ ]\s*(gauss|lobatto))?\s*",
    re.IGNORECASE,
)

_RATIONAL = re.compile(r"[-+]?[0-9]{1,80}(?:\.[0-9]{0,80}|/[0-9]{1,80})?(?:[eE][-+]?[0-9]{1,2})?")

_MOST_COEFFICIENTS = 1_000

_CHOICES = {"corrector", "commutator", "coordinates"}
"""What a splitting by solvable parts may say beside its name."""


@functools.cache
def _named() -> dict[str, Callable[[], Method]]:
    """Return what makes each method that has a name."""
    return {
        **{name: partial(Splitting, name) for name in SCHEMES},
        "rk4": RK4,
        "taylor": Taylor,
        "dop853": DOP853,
        "gauss": Gauss,
        **{f"gauss-{stages}": partial(Gauss, stages) for stages in range(1, HIGHEST_STAGES + 1)},
        "rattle": Rattle,
        **{f"rattle-{each}": partial(Rattle, each) for each in COMPOSITIONS},
        "nonholonomic-leapfrog": NonholonomicLeapfrog,
        **{f"nonholonomic-leapfrog-{each}": partial(NonholonomicLeapfrog, each) for each in COMPOSITIONS},
        "lie-poisson": LiePoissonSplitting,
        **{f"lie-poisson-{each}": partial(LiePoissonSplitting, each) for each in COMPOSITIONS},
        "boris": Boris,
        **{f"boris-{each}": partial(Boris, each) for each in COMPOSITIONS},
        **{f"magnetic-{each}": partial(MagneticSplitting, each) for each in COMPOSITIONS},
        "avf": AverageVectorField,
        "galerkin": GalerkinVariational,
        **{f"galerkin-{each}": partial(GalerkinVariational, each) for each in range(1, HIGHEST_STAGES + 1)},
        **{f"avf-{each}": partial(AverageVectorField, each) for each in _AVERAGES},
        **{f"semiexplicit-{each}": partial(SemiexplicitSplitting, each) for each in COMPOSITIONS},
        "wisdom-holman": WisdomHolman,
        **{f"saba-{stages}": partial(SABA, stages) for stages in _EIGHT},
        **{scheme.name: partial(SABA, stages) for stages, scheme in ABA.items()},
        **{f"sbab-{stages}": partial(SBAB, stages) for stages in _EIGHT},
    }


def _folded(name: str) -> str:
    """Return a name without what is forgiven: case, hyphens, blanks, brackets."""
    return "".join(letter for letter in name.lower() if letter.isalnum())


_ADAPTIVE = '"taylor" (to round-off) and "dop853" choose their own steps'
_IMPLICIT = '"taylor" or "dop853" with the steps that stiffness asks for, or an implicit method, "gauss-2" … "gauss-8"'

# What other libraries call their methods.
_ELSEWHERE = {
    **dict.fromkeys(
        ("rk45", "rk23", "dopri5", "ode45", "tsit5", "vern9", "ias15", "bulirschstoer"), _ADAPTIVE
    ),
    **dict.fromkeys(("radau", "radau5", "bdf", "lsoda", "vode", "cvode"), _IMPLICIT),
    **dict.fromkeys(("leapfrog", "stormerverlet", "störmerverlet", "velocityverlet"), '"verlet" is its name'),
    **dict.fromkeys(
        ("yoshida", "yoshida4"), '"forest-ruth" is Yoshida\'s method of order 4, "kahan-li-8" has order 8'
    ),
    **dict.fromkeys(("whfast", "symba"), '"wisdom-holman" splits off the Kepler motions'),
    **dict.fromkeys(
        ("tao", "tao2", "tao4", "tao6", "tao8", "extendedphasespace"),
        '"tao-4, omega 20" is ExtendedPhaseSpace(4, omega=20): say how strongly the copies are held together',
    ),
    "semiexplicit": '"semiexplicit-4" has order 4',
    "implicitmidpoint": '"gauss-1" is the implicit midpoint rule',
    **dict.fromkeys(("euler", "symplecticeuler"), '"verlet" costs as much and has order 2'),
}


def method_named(name: str) -> Method:
    """Return the method of a name; case, hyphens and blanks are forgiven.

    Raises
    ------
    ValueError
        Where there is no such method, with those whose names are near.

    Examples
    --------
    >>> method_named("kahan-li-8"), method_named("RK4"), method_named("gauss-6"), method_named("Wisdom Holman")
    (Splitting('kahan-li-8'), RK4(), Gauss(stages=6), WisdomHolman())
    >>> method_named("verlets")
    Traceback (most recent call last):
        ...
    ValueError: no method is called 'verlets'; did you mean verlet?
    """
    methods = {_folded(known): make for known, make in _named().items()}
    if (make := methods.get(_folded(name))) is not None:
        return make()
    if (numbered := _NUMBERED.fullmatch(_folded(name))) is not None:
        family, stages = numbered.groups()
        return {"gauss": Gauss, "saba": SABA, "sbab": SBAB}[family](
            int(stages)
        )  # which says how many there are
    if (newton := _NEWTON.fullmatch(_folded(name))) is not None:
        return Gauss(int(newton[1]), iteration="newton")
    if (tao := _TAO.fullmatch(name)) is not None:
        return ExtendedPhaseSpace(int(tao[1]), omega=float(tao[2] + (tao[3] or "")))
    if (average := _AVERAGE.fullmatch(name)) is not None:
        order, points, newton = average.groups()
        return AverageVectorField(
            int(order), int(points) if points else None, iteration=(newton or "fixed-point").lower()
        )
    if (galerkin := _GALERKIN.fullmatch(name)) is not None:
        degree, points, quadrature = galerkin.groups()
        return GalerkinVariational(
            int(degree), int(points) if points else None, quadrature=(quadrature or "gauss").lower()
        )
    if (here := _ELSEWHERE.get(_folded(name))) is not None:
        raise ValueError(f"no method is called {name!r} here: {here}")
    spelled = {_folded(known): known for known in _named()}
    near = [spelled[each] for each in get_close_matches(_folded(name[:60]), spelled, n=3, cutoff=0.6)]
    there = f"did you mean {' or '.join(near)}?" if near else f"there are {_those_there_are()}"
    raise ValueError(f"no method is called {name!r}; {there}")


def _those_there_are() -> str:
    composed = ("semiexplicit", "rattle", "nonholonomic-leapfrog", "lie-poisson", "boris", "magnetic")
    ranges = (
        ("gauss", 1, HIGHEST_STAGES),
        ("avf", 2, _AVERAGES[-1]),
        ("galerkin", 1, HIGHEST_STAGES),
        *((name, 2, 8) for name in composed),
    )
    numbered = ", ".join(
        f"{name}-{a} … {name}-{b}" for name, a, b in (*ranges, ("saba", 1, 8), ("sbab", 1, 8))
    )
    return f"{', '.join((*SCHEMES, 'rk4', 'taylor', 'dop853', 'wisdom-holman', *_blanes()))}, {numbered}"


def _blanes() -> list[str]:
    return [scheme.name for scheme in ABA.values()]


def method_of(given: MethodGiven | None) -> Method:
    """Return the method that was given as a value, by its name or as a class; Taylor's where none was.

    Raises
    ------
    ValueError, TypeError
        There is no such method, or a class needs arguments.

    Examples
    --------
    >>> method_of(None), method_of("verlet"), method_of(RK4), method_of(SABA(4))
    (Taylor(tolerance=None), Splitting('verlet'), RK4(), SABA(4))
    """
    chosen: Any = Taylor() if given is None else given
    if isinstance(chosen, str):
        return method_named(chosen)
    if isinstance(chosen, type) and issubclass(chosen, Method):
        chosen = _made(chosen)
    if not isinstance(chosen, Method):
        raise TypeError(
            f"method={chosen!r} is no method: give one by name, such as 'verlet' or 'gauss-6', or as a value, such as "
            "Splitting('kahan-li-8'), Gauss(6) or Taylor()"
        )
    return chosen


def _made(kind: Any) -> Any:
    """Return the method of a class whose arguments all have defaults."""
    needed = [each.name for each in inspect.signature(kind).parameters.values() if each.default is each.empty]
    if needed:
        name = kind.__name__
        raise TypeError(f"method={name} is a class: give a method made of it, {name}({', '.join(needed)})")
    return kind()


def method_from(written: Mapping[str, Any] | str) -> Method:
    """Return the method of a table in a study file, as a method's ``written`` has it, or of a name alone.

    Raises
    ------
    ValueError
        Where there is no such method.

    Examples
    --------
    >>> method_from("kahan-li-8"), method_from("rk4"), method_from({"gauss": 6})
    (Splitting('kahan-li-8'), RK4(), Gauss(stages=6))
    >>> method_from({"solvable": "wisdom-holman", "corrector": 3})
    WisdomHolman(corrector=3)
    """
    if isinstance(written, str):
        return method_named(written)
    match dict(written):
        case {"splitting": str() as name, **rest} if not rest:
            return Splitting(name)
        case {"splitting": {"a": a, "b": b}, **rest} if not rest:
            return Splitting(a=_coefficients(a), b=_coefficients(b))
        case {"solvable": str() as name, **rest} if set(rest) <= _CHOICES:
            return _solvable(name, rest)
        case {"time_transformed": str() | dict() as inner, **rest} if not rest:
            return _time_transformed(method_from(inner))
        case {"gauss": int() as stages, **rest} if not rest and stages is not True:
            return Gauss(stages)
        case {"gauss": int() as stages, "iteration": str() as iteration, **rest} if not rest:
            return Gauss(stages, iteration=iteration)
        case {"average_vector_field": int() as order, **rest} if set(rest) <= {"points", "iteration"}:
            return AverageVectorField(order, **rest)
        case {"galerkin": int() as degree, **rest} if set(rest) <= {"points", "quadrature"}:
            return GalerkinVariational(degree, **rest)
        case {"rattle": int() as order, **rest} if not rest:
            return Rattle(order)
        case {"nonholonomic_leapfrog": int() as order, **rest} if not rest:
            return NonholonomicLeapfrog(order)
        case {"lie_poisson": int() as order, **rest} if not rest:
            return LiePoissonSplitting(order)
        case {"boris": int() as order, **rest} if not rest:
            return Boris(order)
        case {"magnetic": int() as order, **rest} if not rest:
            return MagneticSplitting(order)
        case {"semiexplicit": int() as order, **rest} if not rest:
            return SemiexplicitSplitting(order)
        case {"extended_phase_space": int() as order, "omega": int() | float() as omega, **rest} if not rest:
            return ExtendedPhaseSpace(order, omega=float(omega))
        case {"rk4": True, **rest} if not rest:
            return RK4()
        case {"taylor": True, **rest} if not rest:
            return Taylor()
        case {"taylor": float() as tolerance, **rest} if not rest:
            return Taylor(tolerance)
        case {"dop853": True, **rest} if not rest:
            return DOP853()
        case {"dop853": float() as tolerance, **rest} if not rest:
            return DOP853(tolerance)
        case _:
            known = ", ".join(f"{key} = {reprlib.repr(value)}" for key, value in written.items())[:200]
            raise ValueError(
                f"no method is written {known}; there are names, {_those_there_are()}, and tables, "
                "{ gauss = stages, iteration = name }, "
                "{ average_vector_field = order, points = number, iteration = name }, "
                "{ galerkin = degree, points = number, quadrature = name }, "
                "{ taylor = tolerance }, { dop853 = tolerance }, { time_transformed = splitting }, "
                "{ splitting = { a, b } }, { semiexplicit = order }, { rattle = order }, "
                "{ nonholonomic_leapfrog = order }, { lie_poisson = order }, "
                "{ boris = order }, { magnetic = order }, "
                "{ extended_phase_space = order, omega = number }, "
                "{ solvable = name, corrector = order, commutator = true, coordinates = name }"
            )


def _coefficients(written: Any) -> list[Fraction]:
    """Return the coefficients of a splitting, exactly; numbers of thousands of digits are not made."""
    if not isinstance(written, list | tuple) or len(written) > _MOST_COEFFICIENTS:
        raise ValueError(
            f"the coefficients of a splitting are a list of at most {_MOST_COEFFICIENTS} numbers"
        )
    if not all(isinstance(x, int | float | Fraction) or _RATIONAL.fullmatch(str(x)) for x in written):
        raise ValueError(
            'a coefficient is a number or a text such as "1/2" or "0.675603595979828817023843904"'
        )
    return [Fraction(x) for x in written]


def _time_transformed(inner: Method) -> TimeTransformed:
    if not isinstance(inner, Splitting):
        raise ValueError(
            f"{inner} in transformed time: a study takes the splittings, which need no function g"
        )
    return TimeTransformed(inner)


def _solvable(name: str, choices: dict[str, Any]) -> Method:
    makers: dict[str, Any] = {known: make for known, make in _named().items() if make().family == "solvable"}
    if name not in makers:
        raise ValueError(f"no splitting by solvable parts is called {name!r}; there are {', '.join(makers)}")
    return makers[name](**choices)
