"""Hamiltonian systems as integrators see them: the protocol of H, q, p and t."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from sympy import Expr, Symbol

__all__ = ["HamiltonianSystem"]


class HamiltonianSystem(Protocol):
    """What ``propagate`` needs of a Hamiltonian, such as :class:`canon.Hamiltonian`."""

    @property
    def H(self) -> Expr:
        """H(q, p, t)."""
        ...

    @property
    def q(self) -> tuple[Symbol, ...]:
        """The coordinates."""
        ...

    @property
    def p(self) -> tuple[Symbol, ...]:
        """The momenta."""
        ...

    @property
    def t(self) -> Symbol:
        """The time."""
        ...
