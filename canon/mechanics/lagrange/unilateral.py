"""Unilateral constraints f(q, t) ≥ 0: contacts that push and cannot pull, with Newton's restitution at impacts.

While a contact is closed, f = 0 and d/dt ∂L/∂q̇ − ∂L/∂q = Q + λ ∂f/∂q with λ ≥ 0; it opens where λ would become
negative. While it is open, f ≥ 0 and λ = 0. It is met again where f falls to 0: the velocity along the wall stays, the
one across it turns round, ḟ → −e ḟ with Newton's coefficient of restitution 0 ≤ e ≤ 1 (F. Pfeiffer & C. Glocker,
Multibody Dynamics with Unilateral Contacts, Wiley 1996, ch. 8).
"""

from __future__ import annotations

from dataclasses import dataclass
from operator import index
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.symbol import velocity
from canon.expression.symbols.user_input import counted, given_expression, given_kind
from canon.mechanics.algebra.dynamicsymbols import plain
from canon.mechanics.algebra.substitution import as_tuple
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

__all__ = ["UnilateralLagrangian"]


@dataclass(frozen=True)
class UnilateralLagrangian:
    """A Lagrangian with unilateral constraints f(q, t) ≥ 0 beside the forces and constraints that it has.

    Parameters
    ----------
    system
        The Lagrangian, or the Lagrangian with its other constraints, which holds on both sides.
    unilateral
        Expressions f(q, t), each ≥ 0; 0 in contact.
    restitution
        Newton's coefficient 0 ≤ e ≤ 1 of impacts, a number or an expression in the parameters, one for all contacts or
        one for each; 0 where what meets stays in contact. Where not given a motion ends at its first impact.

    Notes
    -----
    A start with f = 0 and ḟ = 0 is in contact where the force presses (λ > 0), whatever e; one with f = 0 and ḟ > 0 is
    leaving, and with ḟ < 0 it is refused, as one with f < 0 is. After an impact with e = 0 the contact is closed, and
    ``motion["lambda_1"]`` is the force of the first one, 0 while it is open; it opens again where the force would
    pull. Impacts with 0 < e < 1 that follow each other ever faster end in an error: a body comes to rest on a wall only
    by e = 0. ``motion.regimes`` are stretches of time, with ``begin``, ``end`` and ``closed``, the numbers of the
    contacts that were closed, counted from 1 in the order in which they are given.

    Raises
    ------
    TypeError
        The system is no Lagrangian.
    ValueError
        A constraint holds velocities or no coordinate, a coefficient is no number between 0 and 1 or not as many are
        given as there are constraints.

    Examples
    --------
    A ball that is dropped from a height of 1 and keeps half its speed at each impact:

    >>> from canon import Lagrangian, coordinates, parameters, propagate
    >>> from canon.mechanics import UnilateralLagrangian
    >>> y, g = coordinates("y"), parameters("g", positive=True)
    >>> free = Lagrangian(y.dot**2 / 2 - g * y, [y])
    >>> ball = UnilateralLagrangian(free, [y], restitution=0.5)
    >>> motion = propagate(ball, (0, 2.99), [1, 0], parameters={g: 2})
    >>> [round(met.t, 12) for met in motion.events]
    [1.0, 2.0, 2.5, 2.75, 2.875, 2.9375, 2.96875, 2.984375]
    """

    system: Lagrangian | ConstrainedLagrangian
    unilateral: tuple[Expr, ...]
    restitution: tuple[Expr, ...] | None

    def __init__(
        self,
        system: Lagrangian | ConstrainedLagrangian,
        unilateral: Expr | Sequence[Expr],
        restitution: Any = None,
    ) -> None:
        given_kind(system, (Lagrangian, ConstrainedLagrangian), "the system")
        object.__setattr__(self, "system", system)
        L = self.lagrangian
        contacts = tuple(plain(f, L.q, L.t) for f in as_tuple(unilateral))
        if not contacts:
            raise ValueError("no unilateral constraint is given: name at least one f(q, t), meant as f ≥ 0")
        for f in contacts:
            if f.has(*map(velocity, L.q)) or not f.has(*L.q):
                raise ValueError(
                    f"{f} ≥ 0 is no constraint on the positions: give f(q, t), without velocities"
                )
        object.__setattr__(self, "unilateral", contacts)
        object.__setattr__(self, "restitution", _coefficients(restitution, contacts, L))

    @property
    def lagrangian(self) -> Lagrangian:
        """The Lagrangian without its constraints."""
        return self.system.lagrangian if isinstance(self.system, ConstrainedLagrangian) else self.system

    def closed(self, *which: int) -> ConstrainedLagrangian:
        """Return the system while the contacts of these numbers, counted from 1, are closed and the others open.

        Raises
        ------
        ValueError
            Where there is no contact of a number.

        Examples
        --------
        >>> from canon import Lagrangian, coordinates
        >>> from canon.mechanics import UnilateralLagrangian
        >>> y = coordinates("y")
        >>> UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - y, [y]), [y]).closed(1).multipliers
        (1,)
        """
        count = len(self.unilateral)
        if missing := [i for i in which if index(i) not in range(1, count + 1)]:
            raise ValueError(
                f"no contact has the number {missing[0]}; there {'is' if count == 1 else 'are'} {count}, counted from 1"
            )
        bound = self.system
        given = bound.holonomic if isinstance(bound, ConstrainedLagrangian) else ()
        rates = bound.nonholonomic if isinstance(bound, ConstrainedLagrangian) else ()
        return ConstrainedLagrangian(
            self.lagrangian, (*given, *(self.unilateral[i - 1] for i in which)), rates
        )


def _coefficients(restitution: Any, contacts: Sequence[Expr], L: Lagrangian) -> tuple[Expr, ...] | None:
    if restitution is None:
        return None
    given = tuple(restitution) if isinstance(restitution, list | tuple) else (restitution,) * len(contacts)
    found = tuple(given_expression(e, "the restitution") for e in given)
    if len(found) != len(contacts):
        raise ValueError(
            f"{counted(len(found), 'coefficient')} of restitution for {counted(len(contacts), 'contact')}"
        )
    for e in found:
        if e.has(*L.q, *map(velocity, L.q), L.t):
            raise ValueError(
                f"the restitution {e} changes with the motion: give a number, or one of the parameters"
            )
        if e.is_number and not 0 <= e <= 1:
            raise ValueError(
                f"the restitution {e} is not between 0, where no speed is left, and 1, where all is"
            )
    return found
