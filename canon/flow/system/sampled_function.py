"""Functions from data as expressions: splines through samples, and SciPy's own piecewise polynomials."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

if TYPE_CHECKING:
    import numpy.typing as npt
    from sympy import Expr

    from canon.array import Array

__all__ = ["sampled_function"]


def sampled_function(variable: Expr, at: npt.ArrayLike | Any, values: npt.ArrayLike | None = None) -> Expr:
    """Return a function that is given by samples, or a spline of SciPy's, as an expression.

    The pieces are polynomials with the exact coefficients of the doubles that SciPy computes; between them Taylor's
    method and DOP853 stop as at any kink, so that a potential from a table is integrated to round-off.

    Beyond the first and the last sample the first and the last piece go on, as SciPy's splines do that have
    ``extrapolate=True``; others, which are periodic or end there, are refused. An event with
    ``action="stop"`` ends a motion where it leaves the table.

    Parameters
    ----------
    variable
        What it is a function of, such as a coordinate or r = √(x² + y²).
    at
        The places of the samples, in rising order, shape (samples,), at least 4; or SciPy's ``CubicSpline``,
        ``PchipInterpolator``, ``Akima1DInterpolator``, ``PPoly`` or ``BSpline`` of one function.
    values
        The values there, shape (samples,): joined by the cubic spline that is twice continuously differentiable,
        whose third derivative is continuous at the second and last but one sample too (SciPy's "not-a-knot").

    Raises
    ------
    ValueError
        The samples are too few, not in order, or not finite; or the spline is something else beyond its ends than
        its first and last piece.

    Examples
    --------
    >>> import numpy as np
    >>> from canon import Hamiltonian, coordinates, propagate
    >>> x = coordinates("x")
    >>> r = np.linspace(-2, 2, 9)
    >>> V = sampled_function(x, r, r**2 / 2)
    >>> motion = propagate(Hamiltonian(x.momentum**2 / 2 + V, [x], [x.momentum]), (0, 2 * np.pi), [1, 0])
    >>> bool(abs(motion.final - [1, 0]).max() < 1e-13)
    True
    """
    breaks, coefficients = _pieces(at, values)
    pieces = [
        _polynomial(variable - _exact(a), column) for a, column in zip(breaks, coefficients.T, strict=False)
    ]
    return _joined(variable, breaks[1:-1], pieces)


def _pieces(at: Any, values: Any) -> tuple[Array, Array]:
    """Return the ends of the pieces, and their coefficients of (x − end)ᵏ, highest first, shape (k + 1, pieces)."""
    from scipy.interpolate import CubicSpline, PPoly

    if values is None:
        spline: Any = PPoly.from_spline(at) if hasattr(at, "t") else at
        if not hasattr(spline, "c") or not hasattr(spline, "x"):
            raise TypeError(f"{at!r} is no spline of SciPy's: give one, or places and values of samples")
        _check_goes_on(spline)
        if np.ndim(spline.c) != 2:
            raise ValueError("the spline has several values at a place: give one of them at a time")
        breaks, coefficients = np.asarray(spline.x, dtype=np.float64), np.asarray(spline.c, dtype=np.float64)
        real = np.diff(breaks) > 0  # knots of a BSpline that lie on each other
        breaks, coefficients = np.append(breaks[:-1][real], breaks[-1]), coefficients[:, real]
    else:
        places, given = np.asarray(at, dtype=np.float64), np.asarray(values, dtype=np.float64)
        if places.ndim != 1 or places.shape != given.shape or len(places) < 4:
            raise ValueError(
                f"places of shape {places.shape} and values of shape {given.shape}: give as many, shape (samples,), "
                "and at least 4"
            )
        if not (np.isfinite(places).all() and np.isfinite(given).all() and (np.diff(places) > 0).all()):
            raise ValueError("the places of the samples are to rise, and all numbers to be finite")
        made: Any = CubicSpline(places, given)
        breaks, coefficients = made.x, made.c
    if not (np.isfinite(breaks).all() and np.isfinite(coefficients).all()):
        raise ValueError("the spline has coefficients that are not finite")
    return breaks, coefficients


def _check_goes_on(spline: Any) -> None:
    """Refuse a spline that is not its first and last piece beyond its ends, as what is made of it would be."""
    extrapolate = getattr(spline, "extrapolate", True)
    if extrapolate == "periodic":
        raise ValueError(
            "the spline is periodic, and a function made of pieces has ends: give a table over as many periods as the "
            "motion visits; or set spline.extrapolate = True where it stays within one"
        )
    if not extrapolate:
        first, last = float(spline.x[0]), float(spline.x[-1])
        raise ValueError(
            f"the spline has extrapolate=False, no values beyond {first:g} … {last:g}: set spline.extrapolate = True, "
            f'where its end pieces go on, and end the motion there, events=[Event(x - {last:g}, action="stop")]'
        )


def _polynomial(x: Any, coefficients: Array) -> Any:
    """Return Horner's form."""
    value: Any = _exact(coefficients[0])
    for c in coefficients[1:]:
        value = value * x + _exact(c)
    return value


def _joined(x: Any, borders: Array, pieces: list[Any]) -> Any:
    """Return what is the first piece below the first border, and so on: a tree, as deep as 2 has a power."""
    if not len(borders):
        return pieces[0]
    middle = len(borders) // 2
    below = _joined(x, borders[:middle], pieces[: middle + 1])
    above = _joined(x, borders[middle + 1 :], pieces[middle + 1 :])
    side = sp.sign(x - _exact(borders[middle])) / 2
    return below * (sp.Rational(1, 2) - side) + above * (sp.Rational(1, 2) + side)


def _exact(number: Any) -> Any:
    value = Fraction(float(number))
    return sp.Rational(value.numerator, value.denominator)
