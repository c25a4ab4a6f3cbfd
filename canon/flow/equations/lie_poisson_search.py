"""Search for Lie–Poisson parts: which parts of H turn planes, turn all about M, or kick, on a Poisson manifold.

The flow of f(xₖ) keeps xₖ and is ẋ = f′ Aₖ x where Π eₖ = Aₖ x is linear. Where H holds M₁²/2A + M₂²/2B + M₃²/2C the
middle one of 1/A, 1/B, 1/C is taken from all three: ½ |M|² times it commutes with them and with M, its flow turns what
moves with the body about the fixed M, and less is left for the turns about axes (J. Touma, J. Wisdom, Astron. J. 107
(1994) 1189–1202, doi:10.1086/116931): nothing but one of a symmetric body, whose free motion is exact.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.graph.piecewise_form import without_pieces
from canon.flow.method.lie_poisson_splitting import NoLiePoissonPartsError
from canon.kernel.program.lie_poisson_parts import CommonTurn, Kick, LiePoissonParts, PlaneTurns, TurningBlock
from canon.kernel.program.program import exact_value
from canon.mechanics.algebra.substitution import entry

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.mechanics.hamilton.poisson_system import PoissonSystem

__all__ = ["LiePoissonSearch", "brackets_on", "row_product"]

Plane = tuple[int, int, Fraction]
"""Variables i < j and c, where ẋᵢ = −c r xⱼ and ẋⱼ = c r xᵢ."""

_OTHERS = "Taylor, DOP853, RK4 and Gauss apply"


def brackets_on(graph: Graph, system: PoissonSystem) -> list[list[int]]:
    """Return the nodes of {xᵢ, xⱼ}, row by row."""
    indices = range(len(system.x))
    return [[graph.from_sympy(entry(system.structure, i, j)) for j in indices] for i in indices]


def row_product(graph: Graph, row: Sequence[int], slopes: Sequence[int]) -> int:
    """Return the node of Σ Πᵢⱼ ∂H/∂xⱼ."""
    return graph.add([graph.mul(pair) for pair in zip(row, slopes, strict=True)])


class LiePoissonSearch:
    """The search for parts of H, with numbers, on the graph of the equations.

    Parameters
    ----------
    system
        The Poisson system.
    H
        Its Hamiltonian, as it is to be taken apart.
    moving
        The equations with numbers.
    numbers, varying
        The parameters' numbers by name, and those that differ from orbit to orbit.
    """

    def __init__(
        self,
        system: PoissonSystem,
        H: sp.Expr,
        moving: MovingSystem,
        numbers: Mapping[str, Fraction],
        varying: Sequence[Symbol],
    ) -> None:
        self.graph, self.x = moving.equations.graph, system.x
        graph, equations = self.graph, moving.equations
        node, brackets = graph.from_sympy(without_pieces(H)), brackets_on(graph, system)
        symbols = graph.all_symbols([node, *(each for row in brackets for each in row)]) - {
            *system.x,
            *varying,
        }
        known = {graph.symbol(s): graph.number(numbers[s.name]) for s in symbols}
        (node,) = graph.substitute([node], known)
        self.brackets = [graph.substitute(row, known) for row in brackets]
        self.slopes = list(graph.gradient(node, system.x))
        places = {symbol: i for i, symbol in enumerate((*equations.q, *equations.p))}
        self.places = [places[symbol] for symbol in system.x]

    def parts(self) -> LiePoissonParts:
        """Return the parts.

        Raises
        ------
        NoLiePoissonPartsError
            There are none.
        """
        graph, planes, rest = self.graph, dict[int, tuple[Plane, ...]](), list[int]()
        for k, slope in enumerate(self.slopes):
            if slope == graph.zero:
                continue
            found = self._planes(k)
            if found is None:
                rest.append(k)
            else:
                self._check_alone(k)
                planes[k] = found
        kicks, commons = self._kicks(rest), self._common_turns(planes)
        drift = self._drift(kicks, planes)
        turns = tuple(
            PlaneTurns(self.slopes[k], tuple((self.places[i], self.places[j], c) for i, j, c in found))
            for k, found in planes.items()
            if self.slopes[k] != graph.zero
        )
        if not turns and not kicks and not commons:
            raise NoLiePoissonPartsError("H moves nothing: every motion rests, which needs no method")
        outer = [self._placed(kick) for kick in kicks if kick is not drift]
        return LiePoissonParts(turns, commons, tuple(outer), self._placed(drift or {}))

    def _planes(self, k: int) -> tuple[Plane, ...] | None:
        """Return the planes that the flow of a function of xₖ turns; None where it moves otherwise."""
        rows = [self._factors(row[k]) for row in self.brackets]
        A = [row for row in rows if row is not None]
        if len(A) < len(rows):
            return None
        found: list[Plane] = []
        for i, row in enumerate(A):
            for j, factor in row.items():
                if len(row) > 1 or A[j] != {i: -factor}:
                    return None
                if i < j:
                    found.append((i, j, -factor))
        return tuple(found) or None

    def _factors(self, node: int) -> dict[int, Fraction] | None:
        """Return the factors of the variables in a linear function; None where it is none."""
        graph = self.graph
        slopes = graph.gradient(node, self.x)
        at_origin = {graph.symbol(x): graph.zero for x in self.x}
        if not all(map(graph.is_constant, slopes)) or graph.substitute([node], at_origin)[0] != graph.zero:
            return None
        return {j: exact_value(graph, slope) for j, slope in enumerate(slopes) if slope != graph.zero}

    def _check_alone(self, k: int) -> None:
        others = self._variables([self.slopes[k]]) - {self.x[k]}
        if others:
            names = " and ".join(sorted(s.name for s in others))
            raise NoLiePoissonPartsError(
                f"H couples {self.x[k]} with {names}: LiePoissonSplitting takes H = Σ Hᵢ(xᵢ) + V, for a body the axes "
                f"along which its inertia is diagonal; {_OTHERS}"
            )

    def _variables(self, nodes: Sequence[int]) -> set[Symbol]:
        return {s for s in self.graph.all_symbols(nodes) if s in self.x}

    def _kicks(self, rest: Sequence[int]) -> list[dict[int, int]]:
        """Return the rates that the rest of H gives to components, in parts along whose flow they are constant."""
        groups: list[list[int]] = []
        for part in self._uncoupled(rest):
            if self._constant_rates(part) is None:
                names = ", ".join(self.x[c].name for c in part)
                raise NoLiePoissonPartsError(
                    f"the part of H that depends on {names} has no flow that is known: LiePoissonSplitting takes a V "
                    f"of variables that commute, such as Γ or Euler's parameters; {_OTHERS}"
                )
            together = (group for group in groups if self._constant_rates([*group, *part]) is not None)
            group = next(together, None)
            if group is None:
                groups.append([*part])
            else:
                group += part
        found = [self._constant_rates(group) for group in groups]
        return [rates for rates in found if rates]

    def _uncoupled(self, rest: Sequence[int]) -> list[list[int]]:
        """Return the sets of variables that H couples."""
        left, found = [*rest], list[list[int]]()
        while left:
            part = [left.pop(0)]
            for c in part:
                coupled = self._variables([self.slopes[c]])
                more = [d for d in left if self.x[d] in coupled]
                part += more
                left = [d for d in left if d not in more]
            found.append(sorted(part))
        return found

    def _constant_rates(self, part: Sequence[int]) -> dict[int, int] | None:
        """Return the rates by what H holds of some variables; None where they change along their own flow."""
        graph, slopes = self.graph, [self.slopes[c] for c in part]
        rates = [row_product(graph, [row[c] for c in part], slopes) for row in self.brackets]
        moved = {i: rate for i, rate in enumerate(rates) if rate != graph.zero}
        return None if self._variables(rates) & {self.x[i] for i in moved} else moved

    def _drift(
        self, kicks: Sequence[dict[int, int]], planes: Mapping[int, tuple[Plane, ...]]
    ) -> dict[int, int] | None:
        """Return one of the kicks that neither moves nor reads what turns."""
        turned = {i for found in planes.values() for plane in found for i in plane[:2]} | {*planes}
        symbols = {self.x[i] for i in turned}
        for kick in reversed(kicks):
            if not turned & {*kick} and not self._variables([*kick.values()]) & symbols:
                return kick
        return None

    def _placed(self, kick: Mapping[int, int]) -> Kick:
        return tuple((self.places[i], rate) for i, rate in kick.items())

    # turns about M -----------------------------------------------------------------------------------

    def _common_turns(self, planes: Mapping[int, tuple[Plane, ...]]) -> tuple[CommonTurn, ...]:
        """Return the turns about the M of each body, and take them out of what turns about its axes."""
        found: list[CommonTurn] = []
        left = dict(planes)
        while left:
            k = next(iter(left))
            triple = self._triple(k, left)
            del left[k]
            common = None if triple is None else self._common_turn(triple, planes)
            if triple is not None and common is not None:
                found.append(common)
                for other in triple[1:]:
                    del left[other]
        return tuple(common for common in found if common.blocks)

    def _triple(self, k: int, planes: Mapping[int, tuple[Plane, ...]]) -> tuple[int, int, int] | None:
        """Return M₁, M₂ and M₃ of the body whose first is xₖ: each turns the plane of the others."""
        for i, j, c in planes[k]:
            if (
                i in planes
                and j in planes
                and (i, k, -c) in _both_ways(planes[j])
                and (j, k, c) in _both_ways(planes[i])
            ):
                return k, i, j
        return None

    def _common_turn(
        self, triple: tuple[int, int, int], planes: Mapping[int, tuple[Plane, ...]]
    ) -> CommonTurn | None:
        """Return the turn about M by the middle inverse moment of inertia; None where moments are no numbers."""
        graph = self.graph
        inverses = [self._factors(self.slopes[k]) for k in triple]
        if any(each is None or set(each) != {k} for each, k in zip(inverses, triple, strict=True)):
            return None
        middle = sorted(each[k] for each, k in zip(inverses, triple, strict=True) if each is not None)[1]
        blocks = self._blocks(triple, planes)
        if blocks is None:
            return None
        for k in triple:
            own = graph.scaled(-middle, graph.symbol(self.x[k]))
            self.slopes[k] = graph.add((self.slopes[k], own))
        return CommonTurn(middle, blocks)

    def _blocks(
        self, triple: tuple[int, int, int], planes: Mapping[int, tuple[Plane, ...]]
    ) -> tuple[TurningBlock, ...] | None:
        """Return what turns with the body: sets of variables on which S = Σ Mₖ Aₖ has S³ = −c² |M|² S."""
        turned = {(i, j): (k, c) for k in triple for i, j, c in planes[k] if not {i, j} & {*triple}}
        blocks: list[TurningBlock] = []
        while turned:
            members = {*next(iter(turned))}
            while wider := {i for pair in turned if members & {*pair} for i in pair} - members:
                members |= wider
            own = {pair: turned.pop(pair) for pair in list(turned) if members & {*pair}}
            speed = _common_speed(own, sorted(members), triple)
            if speed is None:
                return None
            pairs = [((i, j) if c > 0 else (j, i), triple.index(k)) for (i, j), (k, c) in own.items()]
            entries = tuple((self.places[i], self.places[j], k) for (i, j), k in pairs)
            blocks.append(TurningBlock(entries, tuple(self.places[k] for k in triple), speed))
        return tuple(blocks)


def _both_ways(planes: Sequence[Plane]) -> set[Plane]:
    return {*planes, *((j, i, -c) for i, j, c in planes)}


def _common_speed(
    entries: Mapping[tuple[int, int], tuple[int, Fraction]], members: Sequence[int], triple: Sequence[int]
) -> Fraction | None:
    """Return c with S³ = −c² |M|² S, the factor of every M in S; None where there is none."""
    M = dict(zip(triple, sp.symbols("M_1:4"), strict=True))
    S = sp.zeros(len(members), len(members))
    for (i, j), (k, c) in entries.items():
        a, b = members.index(i), members.index(j)
        S[a, b] -= sp.Rational(c) * M[k]
        S[b, a] += sp.Rational(c) * M[k]
    speeds = {abs(c) for _, c in entries.values()}
    speed = speeds.pop()
    square = sp.Rational(speed) ** 2 * sp.Add(*(m**2 for m in M.values()))
    kept = not speeds and (S**3 + square * S).expand() == sp.zeros(*S.shape)
    return speed if kept else None
