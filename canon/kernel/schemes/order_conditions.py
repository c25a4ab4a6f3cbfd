"""Order conditions of splitting methods, exact, from the free Lie algebra of the two parts.

The map exp(h a₁A) exp(h b₁B) … is a power series in the words of the two letters A (drift) and B (kick),
which do not commute. The method has order p when its logarithm is h(A + B) up to words longer than p:
necessary and sufficient for every pair of vector fields. For Nyström methods (kinetic energy quadratic) the
brackets that hold [B, [B, [B, A]]] vanish and are projected out.

Source: S. Blanes, F. Casas, A. Murua, Splitting and composition methods in the numerical integration of
differential equations, Bol. Soc. Esp. Mat. Apl. 45 (2008) 89–145, arXiv:0812.0377.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["conditions", "defects", "order"]

_Vector = npt.NDArray[Any]
_Words = list[_Vector]
"""Coefficients of all words by length; a word is a binary number, A = 0 and B = 1, first letter highest."""


def order(
    a: Sequence[Any], b: Sequence[Any], *, nystrom: bool = False, tolerance: float = 1e-12, highest: int = 10
) -> int:
    """Return the order of the splitting method with drifts a and kicks b.

    Parameters
    ----------
    a, b
        Coefficients in the order of use, a first; ``len(a) == len(b) + 1``. Numbers of any precision.
    nystrom
        Count the order for quadratic kinetic energies only.
    tolerance
        How far a condition may be from zero.
    highest
        The greatest order looked for.

    Examples
    --------
    >>> order([0.5, 0.5], [1.0])
    2
    """
    # Words double with every degree: look at short ones first, for most methods need no more.
    for length in range(2, highest + 3, 2):
        for degree, defect in enumerate(defects(a, b, length, nystrom=nystrom), start=1):
            if not defect <= tolerance:
                return degree - 1
            if degree == highest:
                return highest
    return highest


def defects(a: Sequence[Any], b: Sequence[Any], length: int, *, nystrom: bool = False) -> list[Any]:
    """Return, for each word length 1 … ``length``, by how much the order conditions fail.

    The greatest coefficient, over words of that length, of log(method) − (A + B).
    """
    return [max(abs(degree)) for degree in conditions(a, b, length, nystrom=nystrom)]


def conditions(a: Sequence[Any], b: Sequence[Any], length: int, *, nystrom: bool = False) -> list[_Vector]:
    """Return log(method) − (A + B) by word length 1 … ``length``: all of it vanishes up to the method's order."""
    logarithm = _logarithm(composed(a, b, length))
    logarithm[1] = logarithm[1] - 1
    ideal = _nystrom_ideal(length) if nystrom else {}
    return [_outside(logarithm[d], ideal.get(d, [])) for d in range(1, length + 1)]


def composed(a: Sequence[Any], b: Sequence[Any], length: int) -> _Words:
    """Return exp(a₁A) exp(b₁B) … exp(a_{s+1}A) as a series in words up to a length."""
    one = sum(a) * 0 + 1
    words = [np.full(2**degree, 0 * one) for degree in range(length + 1)]
    words[0][0] = one
    for i, drift in enumerate(a):
        words = _times_exponential(words, 0, drift)
        if i < len(b):
            words = _times_exponential(words, 1, b[i])
    return words


def _times_exponential(words: _Words, letter: int, coefficient: Any) -> _Words:
    """Multiply a series by exp(c X) from the right: the word w becomes Σ cᵏ/k! w Xᵏ."""
    product = [degree.copy() for degree in words]
    for degree in range(1, len(words)):
        factor = coefficient * 0 + 1
        for k in range(1, degree + 1):
            factor = factor * coefficient / k
            ending = (2**k - 1) if letter else 0
            product[degree][ending :: 2**k] += words[degree - k] * factor
    return product


def _product(u: _Words, v: _Words) -> _Words:
    product = [0 * degree for degree in u]
    for i, x in enumerate(u):
        for j in range(len(u) - i):
            product[i + j] = product[i + j] + np.multiply.outer(x, v[j]).ravel()
    return product


def _logarithm(words: _Words) -> _Words:
    """Return log(1 + x) = x − x²/2 + x³/3 − … of a series that starts with 1."""
    x = [degree.copy() for degree in words]
    x[0] = 0 * x[0]
    total, power = [degree.copy() for degree in x], x
    for k in range(2, len(words)):
        power = _product(power, x)
        total = [t + p * (-1) ** (k + 1) / k for t, p in zip(total, power, strict=True)]
    return total


@functools.cache
def _nystrom_ideal(length: int) -> dict[int, list[_Vector]]:
    """Return, by word length, orthogonal whole-number vectors that span the brackets with [B,[B,[B,A]]]."""
    a, b = np.array([1, 0], dtype=object), np.array([0, 1], dtype=object)
    element = a
    for _ in range(3):
        element = _bracket(b, element)
    generated, bases = [element], dict[int, list[_Vector]]()
    for degree in range(4, length + 1):
        bases[degree] = _orthogonal(generated)
        generated = [_bracket(letter, each) for letter in (a, b) for each in bases[degree]]
    return bases


def _bracket(u: _Vector, v: _Vector) -> _Vector:
    return np.multiply.outer(u, v).ravel() - np.multiply.outer(v, u).ravel()


def _orthogonal(vectors: Sequence[_Vector]) -> list[_Vector]:
    """Gram–Schmidt in whole numbers: exact, so that high-precision coefficients can be judged with it."""
    basis: list[_Vector] = []
    for vector in vectors:
        rest = vector
        for u in basis:
            rest = rest * (u @ u) - u * (u @ rest)
            rest = rest // max(1, np.gcd.reduce(rest))
        if any(rest):
            basis.append(rest)
    return basis


def _outside(vector: _Vector, basis: Sequence[_Vector]) -> _Vector:
    for u in basis:
        vector = vector - u * ((u @ vector) / (u @ u))
    return vector
