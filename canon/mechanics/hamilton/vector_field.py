"""Vector fields as differential operators X = Σ aⁱ ∂ᵢ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted, given_expression, given_symbols
from canon.mechanics.algebra.dynamicsymbols import check_no_namesake, in_own_symbols
from canon.mechanics.algebra.substitution import as_tuple, symbols_of
from canon.mechanics.hamilton.bracket import lie_bracket

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["VectorField", "check_moves_in_time", "hamiltonian_field"]


@dataclass(frozen=True)
class VectorField:
    """The first-order operator X = Σ aⁱ ∂/∂xⁱ.

    Parameters
    ----------
    components
        The aⁱ(x).
    x
        The coordinates.

    Raises
    ------
    ValueError
        Where there are not as many of both, or a component holds another symbol of the name of a coordinate.

    Examples
    --------
    The product of two operators is of second order, their commutator again of first:

    >>> from sympy import Function, symbols
    >>> x, y = symbols("x y")
    >>> X, Y = VectorField((y, 0), (x, y)), VectorField((0, x), (x, y))
    >>> f = Function("f")(x, y)
    >>> (X(Y(f)) - Y(X(f)) - X.bracket(Y)(f)).expand()
    0
    """

    components: tuple[Expr, ...]
    x: tuple[Symbol, ...]

    def __init__(self, components: Sequence[Expr], x: Sequence[Symbol]) -> None:
        object.__setattr__(self, "components", as_tuple(components))
        object.__setattr__(self, "x", given_symbols(x, "x"))
        if len(self.components) != len(self.x):
            raise ValueError(
                f"{counted(len(self.components), 'component')} for "
                f"{counted(len(self.x), 'coordinate')}; give one each"
            )
        named = {s.name: s for s in self.x}
        for f in self.components:
            check_no_namesake(f, symbols_of(f), named, self.x, time)

    def _repr_latex_(self) -> str:
        terms = [
            rf"\left({sp.latex(a)}\right) \partial_{{{sp.latex(x)}}}"
            for a, x in zip(self.components, self.x, strict=True)
        ]
        return "$\\displaystyle " + " + ".join(terms) + "$"

    def __call__(self, f: Expr) -> Expr:
        """Return X f = Σ aⁱ ∂f/∂xⁱ."""
        f = given_expression(f, "f")
        return sp.Add(*(a * f.diff(s) for a, s in zip(self.components, self.x, strict=True)))

    def __add__(self, other: VectorField) -> VectorField:
        """Return the sum of two fields on the same coordinates."""
        self._same_coordinates(other)
        return VectorField([a + b for a, b in zip(self.components, other.components, strict=True)], self.x)

    def bracket(self, other: VectorField) -> VectorField:
        """Return the commutator [X, Y] = XY − YX."""
        self._same_coordinates(other)
        return VectorField(lie_bracket(self.components, other.components, self.x), self.x)

    def _same_coordinates(self, other: VectorField) -> None:
        if other.x != self.x:
            raise ValueError(
                f"the fields live on different coordinates, {self.x} and {other.x}; write both in the same"
            )


def check_moves_in_time(field: VectorField, t: Symbol) -> None:
    """Refuse to follow ẋ = X(x, t) where a variable is the time itself; as an operator such a field is none the worse.

    Examples
    --------
    >>> from canon import time
    >>> check_moves_in_time(VectorField([1], [time]), time)
    Traceback (most recent call last):
        ...
    ValueError: the field's variable t is the symbol of the time too: write another one, such as coordinates('t'), ...
    """
    if t in field.x:
        raise ValueError(
            f"the field's variable {t} is the symbol of the time too: write another one, such as "
            f"coordinates({t.name!r}), in the components and among the variables"
        )


def hamiltonian_field(H: Expr, q: Sequence[Symbol] | Symbol, p: Sequence[Symbol] | Symbol) -> VectorField:
    """Return the field X_H = Σ (∂H/∂p ∂/∂q − ∂H/∂q ∂/∂p), so that X_H f = {f, H}.

    Its commutators go against the brackets: [X_f, X_g] = −X_{f, g}.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p")
    >>> hamiltonian_field(p**2/2, [q], [p]).components
    (p, 0)
    """
    q, p = given_symbols(q, "q"), given_symbols(p, "p")
    if len(q) != len(p):
        raise ValueError(
            f"{counted(len(q), 'coordinate')} and {counted(len(p), 'momentum', 'momenta')}; each coordinate needs one"
        )
    (energy,) = in_own_symbols([given_expression(H, "H")], (*q, *p))
    return VectorField([*(energy.diff(s) for s in p), *(-energy.diff(s) for s in q)], (*q, *p))
