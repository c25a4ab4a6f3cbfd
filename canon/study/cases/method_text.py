"""Methods as text, for files and keys."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor, TimeTransformed
from canon.flow.method.solvable_splitting import SABA, SBAB, SolvableSplitting, WisdomHolman
from canon.kernel.schemes.perturbed_schemes import ABA
from canon.kernel.schemes.splitting_schemes import SCHEMES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.flow.method.method import Method

__all__ = ["method_from", "method_to"]

EIGHT = range(1, 9)
"""Stages of SABA and SBAB methods."""

_CHOICES = {"corrector", "commutator", "coordinates"}
"""What a splitting by solvable parts may say beside its name."""


def method_to(method: Method) -> dict[str, Any]:
    """Return a method as what JSON and TOML can hold.

    Raises
    ------
    ValueError
        Where a method has parts of its own, which are no text.

    Examples
    --------
    >>> method_to(Splitting("verlet")), method_to(Gauss(4)), method_to(Taylor(1e-10))
    ({'splitting': 'verlet'}, {'gauss': 4}, {'taylor': 1e-10})
    """
    match method:
        case Splitting(parts=(_, _)):
            raise ValueError(f"{method}: a study takes the parts T(p) and V(q) of H, none of your own")
        case Splitting(scheme=scheme):
            if scheme.name:
                return {"splitting": scheme.name}
            return {"splitting": {"a": [str(x) for x in scheme.a], "b": [str(x) for x in scheme.b]}}
        case SolvableSplitting(scheme=scheme, parts=parts):
            if parts is not None or not scheme.name:
                raise ValueError(f"{method}: a study takes parts that are found from the structure of H")
            return {"solvable": scheme.name, "corrector": method.corrector} | _choices(method)
        case TimeTransformed(method=inner, g=g):
            if g is not None:
                raise ValueError(f"{method} with g: a study takes the splittings, which need none")
            return {"time_transformed": method_to(inner)}
        case Gauss(stages=stages):
            return {"gauss": stages}
        case RK4():
            return {"rk4": True}
        case Taylor(tolerance=tolerance):
            return {"taylor": tolerance if tolerance is not None else True}
        case DOP853(tolerance=tolerance):
            return {"dop853": tolerance}


def method_from(written: Mapping[str, Any] | str) -> Method:
    """Return the method of a table, or of a name alone.

    Raises
    ------
    ValueError
        Where there is no such method.

    Examples
    --------
    >>> method_from("kahan-li-8"), method_from("rk4"), method_from({"gauss": 6})
    (Splitting('kahan-li-8'), RK4(), Gauss(stages=6))
    >>> str(method_from({"solvable": "wisdom-holman", "corrector": 3}))
    'wisdom-holman, corrector 3'
    """
    if isinstance(written, str):
        name = written.lower()
        written = (
            {"splitting": name}
            if name in SCHEMES
            else {"solvable": name}
            if _is_solvable(name)
            else {name: True}
        )
    match dict(written):
        case {"splitting": str() as name, **rest} if not rest:
            return Splitting(name)
        case {"splitting": {"a": a, "b": b}, **rest} if not rest:
            return Splitting(a=[Fraction(x) for x in a], b=[Fraction(x) for x in b])
        case {"solvable": str() as name, **rest} if set(rest) <= _CHOICES and _is_solvable(name):
            return _solvable(name, rest)
        case {"time_transformed": str() | dict() as inner, **rest} if not rest:
            return _time_transformed(method_from(inner))
        case {"gauss": int() as stages, **rest} if not rest and stages is not True:
            return Gauss(stages)
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
            known = ", ".join(f"{key} = {value!r}" for key, value in written.items())
            raise ValueError(
                f"no method is written {known}; there are {', '.join(SCHEMES)}, rk4, taylor, dop853, "
                "wisdom-holman, saba-1 … saba-8, sbab-1 … sbab-8, { gauss = stages }, { taylor = tolerance }, "
                "{ dop853 = tolerance }, { time_transformed = splitting }, { splitting = { a, b } }, "
                "{ solvable = name, corrector = order, commutator = true, coordinates = name }"
            )


def _time_transformed(inner: Method) -> TimeTransformed:
    if not isinstance(inner, Splitting):
        raise ValueError(
            f"{inner} in transformed time: a study takes the splittings, which need no function g"
        )
    return TimeTransformed(inner)


def _is_solvable(name: str) -> bool:
    family, _, stages = name.partition("-")
    numbered = family in ("saba", "sbab") and stages.isdecimal() and int(stages) in EIGHT
    return name == WisdomHolman().scheme.name or numbered or name in (scheme.name for scheme in ABA.values())


def _choices(method: SolvableSplitting) -> dict[str, Any]:
    """Return what differs from the ordinary choices."""
    commutator = {"commutator": True} if method.commutator else {}
    return commutator | ({"coordinates": method.coordinates} if method.coordinates != "jacobi" else {})


def _solvable(name: str, choices: dict[str, Any]) -> SolvableSplitting:
    if name == WisdomHolman().scheme.name:
        return WisdomHolman(**choices)
    for key, scheme in ABA.items():
        if scheme.name == name:
            return SABA(key, **choices)
    family, _, stages = name.partition("-")
    return (SABA if family == "saba" else SBAB)(int(stages), **choices)
