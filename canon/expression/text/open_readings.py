"""Open readings: which letters are angles or counts, and whether an e that is declared stands for Euler's number.

Nobody takes the sine of an angle over a length, so ``g sin θ/l`` has one reading; ``sin θ/2`` has two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.text.syntax import Name, Node, parts

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = [
    "DECLARED_E",
    "counts",
    "is_angle",
    "is_angle_of_functions",
    "looks_like_eulers",
    "prime_in_doubt",
    "stem_of",
]

_ANGLES = ("theta", "vartheta", "phi", "varphi", "psi", "th", "ph")
"""Letters that are angles in any book."""
_ANGLES_OF_FUNCTIONS = (*_ANGLES, "alpha", "beta", "gamma", "delta", "epsilon", "chi", "eta")
"""Letters that are angles wherever a function is taken of them alone."""
_COUNTS = ("n", "N", "k", "i", "j")
"""Letters that count, so that an angle is divided by them."""
DECLARED_E = (
    "is e here what was declared, or Euler's number?",
    "write exp( ) for Euler's number, e**( ) for the other, or declare another letter",
)
"""Question and remedy."""


def is_angle(name: str) -> bool:
    """Tell whether a name is that of an angle.

    Examples
    --------
    >>> is_angle("theta_0"), is_angle("phi1"), is_angle("x")
    (True, True, False)
    """
    return stem_of(name) in _ANGLES


def is_angle_of_functions(name: str) -> bool:
    """Tell whether a name is that of an angle where a function is taken of it, ``sin α``.

    Examples
    --------
    >>> is_angle_of_functions("alpha"), is_angle_of_functions("omega")
    (True, False)
    """
    return stem_of(name) in _ANGLES_OF_FUNCTIONS


def counts(name: str) -> bool:
    """Tell whether a name is that of a whole number."""
    return stem_of(name) in _COUNTS


def looks_like_eulers(base: Node, exponent: Node, scope: Scope) -> bool:
    """Tell whether a power of a declared e could be meant for Euler's: one whose exponent moves or is imaginary.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> from sympy import Symbol
    >>> looks_like_eulers(Name("e", 0, 1), Name("t", 0, 3), Scope({"e": Symbol("e")}))
    True
    """
    if not (isinstance(base, Name) and base.text == "e" and not base.primes and scope.declares("e")):
        return False
    names = [part for part in parts(exponent) if isinstance(part, Name)]
    imaginary = any(name.text == "I" and not scope.declares("I") for name in names)
    return imaginary or any(name.primes or scope.moves(name.text) for name in names)


def prime_in_doubt(function: str, scope: Scope) -> str:
    """Return what to ask of a prime behind a function of a slow time, by which or by t it may be; nothing of others.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> slow = Scope({}, {"w": ("tau",)}, dependent=frozenset({"tau"}))
    >>> prime_in_doubt("w", slow), prime_in_doubt("w", Scope({}, {"w": ("tau",)}))
    ("is w' the derivative by tau, or by t?", '')
    """
    variables = scope.functions[function]
    if not scope.dependent.intersection(variables):
        return ""
    return f"is {function}' the derivative by {variables[0]}, or by {scope.time.name}?"


def stem_of(name: str) -> str:
    """Return the letter of a name without its number or subscript.

    Examples
    --------
    >>> stem_of("theta_0"), stem_of("phi1"), stem_of("k_x")
    ('theta', 'phi', 'k')
    """
    return name.partition("_")[0].rstrip("0123456789")
