"""Hamiltonian maps: kicks by a potential and free motion between them, once each per unit of time.

p′ = p − ∂V/∂q at q, then q′ = q + ∂T/∂p at p′: the motion from kick to kick of H = T(p) + V(q) Σₙ δ(t − n), and one
step of size 1 of the splitting that kicks first. Both parts are canonical, so that the map is.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import given_expression, given_symbols
from canon.flow.method.method import Splitting
from canon.mechanics.algebra.dynamicsymbols import check_none_is_the_time
from canon.mechanics.hamilton.hamiltonian import Hamiltonian

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from sympy import Expr, Symbol

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.mechanics.canonical.transformation import CanonicalTransformation

__all__ = ["DRIFT_AND_KICK", "KICK_AND_DRIFT", "HamiltonianMap", "check_whole", "kicked"]

KICK_AND_DRIFT, DRIFT_AND_KICK = Splitting(a=[0, 1], b=[1]), Splitting(a=[1, 0], b=[1])
"""A kick, then a drift; back in time the drift comes first."""


@dataclass(frozen=True)
class HamiltonianMap:
    """A map p′ = p − ∂V/∂q, q′ = q + ∂T/∂p′, iterated by what moves Hamiltonians: :func:`canon.propagate` and the rest.

    The time is the number of iterations, of the inverse map where it falls; ``method`` and ``step`` are left out, and
    sample times are whole.

    Parameters
    ----------
    T
        The free motion's Hamiltonian, a function of p.
    V
        The potential of the kicks, a function of q.
    q, p
        Coordinates and momenta; angles are not taken back to one turn.

    Raises
    ------
    ValueError
        T or V holds what it must not; or there are not as many momenta as coordinates.

    Examples
    --------
    Chirikov's standard map, p′ = p + K sin q, q′ = q + p′ (Phys. Rep. 52 (1979) 263, doi:10.1016/0370-1573(79)90023-1),
    whose exponent is ln(K/2) nearly where K is large:

    >>> import sympy
    >>> from canon import coordinates, parameters
    >>> from canon.flow import HamiltonianMap, lyapunov_spectrum
    >>> q, K = coordinates("q"), parameters("K", positive=True)
    >>> standard = HamiltonianMap(q.momentum**2 / 2, K * sympy.cos(q), [q], [q.momentum])
    >>> standard.images
    (K*sin(q) + p_q + q, K*sin(q) + p_q)
    >>> bool(standard.transformation.is_canonical())
    True
    >>> found = lyapunov_spectrum(standard, (0, 20000), [0.1, 0.2], parameters={K: 10})
    >>> found.verdict, bool(abs(found.largest - sympy.log(5)) < 0.03)
    (<Regularity.CHAOTIC: 'chaotic'>, True)
    """

    T: Expr
    V: Expr
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    t: Symbol = field(default=time, repr=False)

    def __init__(
        self, T: Expr, V: Expr, q: Sequence[Symbol] | Symbol, p: Sequence[Symbol] | Symbol, t: Symbol = time
    ) -> None:
        object.__setattr__(self, "T", given_expression(T, "T"))
        object.__setattr__(self, "V", given_expression(V, "V"))
        object.__setattr__(self, "q", given_symbols(q, "q"))
        object.__setattr__(self, "p", given_symbols(p, "p"))
        object.__setattr__(self, "t", t)
        check_none_is_the_time((*self.q, *self.p), "HamiltonianMap(T, V, q, p", t)
        if len(self.q) != len(self.p):
            raise ValueError(f"{len(self.q)} q and {len(self.p)} p: give as many of each")
        for name, given, others in (("T", self.T, {*self.q, t}), ("V", self.V, {*self.p, t})):
            strange = sorted(str(s) for s in given.free_symbols & others)
            if strange:
                raise ValueError(
                    f"{name} = {given} holds {', '.join(strange)}: T is a function of the momenta, V of the coordinates"
                )

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """T + V, whose splitting into a kick and a drift the map is."""
        return Hamiltonian(self.T + self.V, list(self.q), list(self.p), self.t)

    @property
    def images(self) -> tuple[Expr, ...]:
        """Where (q, p) is mapped to, as expressions, of length 2n."""
        kicked_p = [p - sp.diff(self.V, q) for q, p in zip(self.q, self.p, strict=True)]
        there = dict(zip(self.p, kicked_p, strict=True))
        moved = [q + sp.diff(self.T, p).xreplace(there) for q, p in zip(self.q, self.p, strict=True)]
        return (*moved, *kicked_p)

    @property
    def transformation(self) -> CanonicalTransformation:
        """The map as a transformation, which can be proved to be canonical."""
        from canon.mechanics.canonical.transformation import CanonicalTransformation

        n = len(self.q)
        return CanonicalTransformation(self.q, self.p, self.images[:n], self.images[n:])


@functools.lru_cache(maxsize=64)
def kicked(system: HamiltonEquations) -> HamiltonEquations:
    """Return the equations of T + V as those of a map: what they conserve is nothing, as kicks come at whole times."""
    return replace(system, autonomous=False, kicked=True)


def check_whole(t: Fraction) -> None:
    """Refuse times between iterations.

    Raises
    ------
    ValueError
        The time is not whole.
    """
    if t.denominator != 1:
        raise ValueError(f"t = {float(t):g}: a map is iterated a whole number of times, give whole times")
