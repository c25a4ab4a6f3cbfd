"""Fourier series in some angles with expressions as coefficients: Σ c_k exp(i k·θ), the c_k free of these angles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["NoFourierSeriesError", "fourier_bracket", "fourier_expression", "fourier_series"]

Harmonic = tuple[int, ...]
Series = dict[Harmonic, Expr]


class NoFourierSeriesError(ValueError):
    """Raised for a function that is no trigonometric polynomial in the angles."""


def fourier_series(f: Expr, angles: Sequence[Symbol]) -> Series:
    """Return the coefficients of exp(i k·θ) of a trigonometric polynomial in some angles.

    Raises
    ------
    NoFourierSeriesError
        Where f depends on an angle in another way.

    Examples
    --------
    >>> theta, a = sp.symbols("theta a", real=True)
    >>> fourier_series(a * sp.cos(theta) ** 2, [theta])
    {(-2,): a/4, (0,): a/2, (2,): a/4}
    """
    waves: Any = f.replace(
        lambda g: isinstance(g, sp.sin | sp.cos) and g.has(*angles), lambda g: g.rewrite(sp.exp)
    )
    waves_of: dict[Any, Symbol] = {wave: sp.Dummy() for wave in waves.atoms(sp.exp) if wave.has(*angles)}
    phases = {name: wave.args[0] for wave, name in waves_of.items()}
    series: Series = {}
    for term in sp.Add.make_args(sp.expand(waves.xreplace(waves_of))):  # no exp(−iθ) moves into a denominator
        factors: tuple[Any, ...] = sp.Mul.make_args(term)
        moving = [factor.as_base_exp() for factor in factors if factor.has(*angles, *phases)]
        if not all(base in phases and power.is_Integer for base, power in moving):
            raise _refused(f, angles)
        phase = sp.expand(sp.Add(*(phases[base] * power for base, power in moving)))
        harmonic = [sp.expand(phase.coeff(angle, 1) / sp.I) for angle in angles]
        left = sp.expand(
            phase - sp.I * sp.Add(*(k * angle for k, angle in zip(harmonic, angles, strict=True)))
        )
        if left.has(*angles) or not all(k.is_Integer for k in harmonic):
            raise _refused(f, angles)
        rest = sp.Mul(*(factor for factor in factors if not factor.has(*phases)), sp.exp(left))
        key = tuple(int(k) for k in harmonic)
        series[key] = series.get(key, sp.S.Zero) + rest
    return _without_zeros(series)


def fourier_expression(series: Mapping[Harmonic, Expr], angles: Sequence[Symbol]) -> Expr:
    """Return Σ c_k exp(i k·θ) in cosines and sines."""
    total = sp.S.Zero
    for k, c in series.items():
        opposite = tuple(-j for j in k)
        phase = sp.Add(*(j * angle for j, angle in zip(k, angles, strict=True)))
        if k == opposite:
            total += c
        elif k > opposite:
            other = series.get(opposite, sp.S.Zero)
            total += sp.expand(c + other) * sp.cos(phase) + sp.expand(sp.I * (c - other)) * sp.sin(phase)
        elif opposite not in series:
            total += c * sp.cos(phase) + sp.I * c * sp.sin(phase)
    return total


def fourier_bracket(
    f: Mapping[Harmonic, Expr],
    g: Mapping[Harmonic, Expr],
    actions: Sequence[Symbol],
    q: Sequence[Symbol],
    p: Sequence[Symbol],
) -> Series:
    """Return {f, g}: the angles are conjugate to the actions, and (q, p) are the slow variables."""
    total: Series = {}
    for k, a in f.items():
        for l, b in g.items():
            value = sp.S.Zero
            for j, action in enumerate(actions):
                value += sp.I * (k[j] * a * b.diff(action) - l[j] * b * a.diff(action))
            for x, y in zip(q, p, strict=True):
                value += a.diff(x) * b.diff(y) - a.diff(y) * b.diff(x)
            key = tuple(i + j for i, j in zip(k, l, strict=True))
            total[key] = total.get(key, sp.S.Zero) + value
    return _without_zeros(total)


def _without_zeros(series: Series) -> Series:
    summed = {k: sp.expand(c) for k, c in sorted(series.items())}
    return {k: c for k, c in summed.items() if c != 0}


def _refused(f: Expr, angles: Sequence[Symbol]) -> NoFourierSeriesError:
    return NoFourierSeriesError(
        f"{f} is no trigonometric polynomial in {', '.join(map(str, angles))}; "
        "expand it in a small parameter, such as an eccentricity, first"
    )
