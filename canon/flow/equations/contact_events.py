"""Events of contacts: where they open, where they are met, and what an impact does.

Where a contact opens f and ḟ are round-off; f counts as met again only where it falls below that margin, until it has
risen above it. At an impact q̇ → q̇ − (1 + e) ḟ M⁻¹Aᵀ/G, and what the energy changes by is added to the work done.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Symbol

from canon.flow.equations.bounce import is_straight
from canon.flow.equations.contact_walls import dot, is_touched, power_of_two, size_of_wall, values_of
from canon.flow.equations.first_order_motion import Contact, Contacts
from canon.flow.run.event import Event

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr

    from canon.expression.graph.graph import Graph
    from canon.flow.equations.contact_walls import Regimes, Wall

__all__ = ["ContactEvents"]

_MARGIN = Fraction(1, 2**36)
"""Round-off of a contact that opens, in parts of the size of f's terms."""


@dataclass(frozen=True)
class ContactEvents:
    """What makes the events of contacts.

    Parameters
    ----------
    regimes
        The equations of all regimes.
    start
        Numbers for the state, t and the parameters at the start.
    named
        Nodes by symbol: the functions of events and the new values stand here.
    work, losses
        The variable of the work done, and what impacts add to it, by the symbol of the work after each.
    """

    regimes: Regimes
    start: Mapping[Symbol, float]
    named: dict[Symbol, int]
    work: Symbol = field(default_factory=lambda: sp.Dummy("W", real=True))
    losses: dict[Symbol, int] = field(default_factory=dict[Symbol, int])

    @property
    def graph(self) -> Graph:
        """The graph of all nodes."""
        return self.regimes.graph

    def contacts(self, restitution: Sequence[Expr] | None, closed: Sequence[bool]) -> Contacts:
        """Return the contacts of a motion, with coefficients of restitution, and which are closed at the start.

        Raises
        ------
        ValueError
            A coefficient is not between 0 and 1, or masses depend on the velocities so that it does not say what an
            impact does.
        """
        each, hidden = list[Contact](), dict[Symbol, Fraction]()
        unit = self.regimes.unit
        for i, wall in enumerate(self.regimes.walls):
            each.append(self._contact(i, None if restitution is None else restitution[i], closed=closed[i]))
            f = abs(float(values_of(self.graph, [wall.value], self.start)[0]))
            near = not closed[i] and is_touched(self.regimes.free, wall, self.start)
            hidden[wall.switch] = unit if closed[i] else Fraction(0)
            hidden[wall.margin] = (
                (_MARGIN + 2 * Fraction(f) / self._size(wall)) * unit if near else Fraction(0)
            )
            hidden[wall.armed] = Fraction(0) if near else unit
        return Contacts(tuple(each), hidden, self.work, self.losses)

    def _contact(self, i: int, e: Expr | None, *, closed: bool) -> Contact:
        graph, regimes, wall = self.graph, self.regimes, self.regimes.walls[i]
        said, lam, size = f"{wall.f} = 0", regimes.multipliers[i], self._size(wall)
        armed = graph.scaled(size / regimes.unit, graph.symbol(wall.armed))
        margin = graph.scaled(size / regimes.unit, graph.symbol(wall.margin))
        rose = graph.add((wall.value, graph.negative(margin), armed))
        fell = graph.add((wall.value, margin, graph.scaled(size, regimes.closed(wall))))
        others = [w for w in regimes.walls if w is not wall and self._coupled(wall, w)]
        alone = graph.mul([graph.one, *(regimes.open(w) for w in others)])
        beside = graph.add((graph.one, graph.negative(alone)))
        fallen = self._name(graph.add((fell, graph.scaled(size, beside))), "fell")
        pressed = graph.add((lam, graph.scaled(self._force_at_start(lam), regimes.open(wall))))
        action: dict[Symbol, Expr] = {
            wall.switch: sp.S.Zero,
            wall.armed: sp.S.Zero,
            wall.margin: self._off(wall),
        }
        if e is None:
            lands = Event(fallen, -1, "stop", f"impact at {said}, for which no restitution is given")
        else:
            lands = self._impact(i, e, fallen)
        crowded = None
        if others:
            words = f"impact at {said} while another contact is closed, which Newton's restitution does not determine"
            crowd = self._name(graph.add((fell, graph.scaled(size, alone))), "fell")
            crowded = Event(crowd, -1, "stop", words)
        return Contact(
            words=said,
            value=wall.value,
            multiplier=lam,
            switch=wall.switch,
            closed=closed,
            opens=Event(self._name(pressed, "pressed"), -1, action, f"contact at {said} opens"),
            lands=lands,
            parts=Event(self._name(rose, "rose"), 1, {wall.margin: sp.S.Zero, wall.armed: self._unit}),
            crowded=crowded,
            restitution=None if e is None else self._number(e),
        )

    def _impact(self, i: int, e: Expr, fallen: Symbol) -> Event:
        """Return the event of an impact: new velocities, and a closed contact where nothing is thrown back."""
        graph, wall = self.graph, self.regimes.walls[i]
        after = self._velocities_after(wall, e)
        new = {graph.symbol(s): node for s, node in after.items()}
        energy = self.regimes.free.energy
        assert energy is not None
        later = sp.Dummy("W_after", real=True)
        self.losses[later] = graph.add((graph.substitute([energy], new)[0], graph.negative(energy)))
        action: dict[Symbol, Expr] = {self.work: later}
        for s, node in after.items():
            action[s] = self._name(node, s.name)
        if self._number(e) != 0:
            return Event(fallen, -1, action, f"impact at {wall.f} = 0")
        shut = {graph.symbol(wall.switch): graph.number(self.regimes.unit)}
        force = graph.substitute([self.regimes.multipliers[i]], {**new, **shut})[0]
        # Closed where the force presses or vanishes, as at the start: s = sign λ gives 1 + (s − s²)/2.
        s = graph.function("sign", force)
        bent = graph.scaled(Fraction(1, 2), graph.add((s, graph.negative(graph.mul((s, s))))))
        shut_again = graph.add((graph.one, bent))
        unit = self.regimes.unit
        action[wall.switch] = action[wall.armed] = self._name(graph.scaled(unit, shut_again), "closed")
        free = self._name(graph.negative(bent), "free")
        action[wall.margin] = free * self._off(wall)
        return Event(fallen, -1, action, f"contact at {wall.f} = 0 closes")

    def _velocities_after(self, wall: Wall, e: Expr) -> dict[Symbol, int]:
        graph = self.graph
        factor = graph.negative(graph.add((graph.one, graph.from_sympy(e))))
        across = dot(graph, wall.normal, wall.pushed)
        if not is_straight(graph, wall.pushed, across, self.regimes.free.second):
            raise ValueError(
                f"masses depend on the velocities, so it is not known how they change at an impact at {wall.f} = 0: "
                "leave out its restitution, and the motion ends there"
            )
        impulse = graph.mul((factor, wall.rate, graph.power(across, -1)))
        pushes = [graph.mul((impulse, push)) for push in wall.pushed]
        return {
            s: graph.add((graph.symbol(s), push))
            for s, push in zip(self.regimes.free.second, pushes, strict=True)
        }

    def _number(self, e: Expr) -> float:
        value = float(values_of(self.graph, [self.graph.from_sympy(e)], self.start)[0])
        if not 0 <= value <= 1:
            raise ValueError(f"the restitution {e} = {value:g} is not between 0 and 1")
        return value

    def _off(self, wall: Wall) -> Symbol:
        """Return the name of the margin of a contact that opens, in parts of the size of f's terms."""
        graph = self.graph
        rounding = graph.scaled(2 / self._size(wall), graph.function("Abs", wall.value))
        return self._name(
            graph.scaled(self.regimes.unit, graph.add((rounding, graph.number(_MARGIN)))), "margin"
        )

    def _name(self, node: int, words: str) -> Symbol:
        symbol = sp.Dummy(words, real=True)
        self.named[symbol] = node
        return symbol

    @property
    def _unit(self) -> Expr:
        return sp.Rational(self.regimes.unit.numerator, self.regimes.unit.denominator)

    def _size(self, wall: Wall) -> Fraction:
        return power_of_two(size_of_wall(self.regimes.free, wall, self.start))

    def _coupled(self, a: Wall, b: Wall) -> bool:
        """Tell whether an impact at one contact pushes at another."""
        return dot(self.graph, a.normal, b.pushed) != self.graph.zero

    def _force_at_start(self, lam: int) -> Fraction:
        """Return the size of a force of contact at the start, were all contacts closed."""
        shut = {w.switch: float(self.regimes.unit) for w in self.regimes.walls}
        return power_of_two(abs(float(values_of(self.graph, [lam], {**self.start, **shut})[0])))
