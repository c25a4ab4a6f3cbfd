"""The tree of a system's velocities, and M q̈ = f solved along it without M: the recursion of articulated bodies.

For T = ½ Σ w u² the accelerations make ½ Σ w α² − f·q̈ least, α = Σ a q̈ over channels. Bodies of a chain share the heads
of their sums, α = α_before + a q̈; so each α is eliminated for the one before it, from the leaves to the root, and each
q̈ once nothing beyond its joint is left. A chain of n links takes n steps of a fixed size where L D Lᵀ of M takes n³/6
products; where nothing is shared it is that factorisation. Its pivots are positive where M is positive definite.

Source: R. Featherstone, Rigid Body Dynamics Algorithms (Springer 2008), ch. 7, doi:10.1007/978-1-4899-7560-7; the sums
are found as in J. Han, J. Pei, Y. Yin, SIGMOD Rec. 29(2), 1 (2000), doi:10.1145/335191.335372.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.expression.graph.graph import Graph
    from canon.mechanics.at_scale.kinetic_terms import Channel

__all__ = ["Sum", "TreeOfSums", "tree_of_sums"]

_Slope = tuple[int, int]
"""A coordinate's number and the node of the slope; the number is −1 where the node is a velocity by itself."""
_Unknown = int | tuple[int]
"""What is unknown: the acceleration of a coordinate, or of a sum, whose number stands in a tuple."""


@dataclass(frozen=True)
class Sum:
    """A partial sum u = u_before + Σ a q̇ that channels share.

    Parameters
    ----------
    before
        The number of the sum that it goes on from, −1 where it begins.
    own
        What it adds: pairs (i, a), i = −1 for what is no product with a q̇.
    weights
        The weights of the channels that it is.
    """

    before: int
    own: tuple[_Slope, ...]
    weights: tuple[int, ...]


@dataclass(frozen=True)
class TreeOfSums:
    """The sums of a system's velocities, all that go on from one right after it."""

    graph: Graph
    sums: tuple[Sum, ...]

    @property
    def terms(self) -> int:
        """How many slopes the sums add."""
        return sum(i >= 0 for each in self.sums for i, _ in each.own)

    def added(self, term: Callable[[_Slope], Sequence[int]]) -> list[int]:
        """Return what each sum is where its slopes stand for these terms, nodes."""
        found: list[int] = []
        for each in self.sums:
            before = [found[each.before]] if each.before >= 0 else []
            found.append(
                self.graph.plain_add([*before, *(node for slope in each.own for node in term(slope))])
            )
        return found

    def projected(self, values: Sequence[int], n: int) -> list[int]:
        """Return Σ w a F for each coordinate, F being the values of the sums."""
        graph = self.graph
        beyond: list[list[int]] = [[] for _ in self.sums]
        terms: list[list[int]] = [[] for _ in range(n)]
        for number in reversed(range(len(self.sums))):
            each = self.sums[number]
            own = [graph.plain_mul((w, values[number])) for w in each.weights]
            total = graph.plain_add([*own, *beyond[number]])
            if each.before >= 0:
                beyond[each.before].append(total)
            for i, a in each.own:
                if i >= 0:
                    terms[i].append(graph.plain_mul((a, total)))
        return [graph.plain_add(each) for each in terms]

    def solved(self, right: Sequence[int], more: Mapping[tuple[int, int], int]) -> tuple[int, ...]:
        """Return the nodes q̈ with M q̈ = right.

        Parameters
        ----------
        right
            The right-hand side, n nodes.
        more
            What M has besides Σ w a aᵀ, by (i, j) with i ≥ j.

        Raises
        ------
        ZeroDivisionError
            A pivot is 0 on the graph.
        """
        elimination = _Elimination(self.graph, right, more)
        left = set(range(len(self.sums)))
        for i in self.order(len(right)):
            beyond = {k for number in self._having.get(i, ()) for k in self._subtree(number)} & left
            left -= beyond
            for number in sorted(beyond, reverse=True):
                elimination.of_sum(number, self.sums[number])
            elimination.of_coordinate(i)
        return elimination.accelerations()

    def order(self, n: int) -> list[int]:
        """Return the order in which :meth:`solved` eliminates n coordinates: those with the least beyond them first."""
        return sorted(range(n), key=lambda i: sum(self._sizes[k] for k in self._having.get(i, ())))

    @cached_property
    def _having(self) -> Mapping[int, list[int]]:
        """The sums that add terms of a coordinate."""
        found: defaultdict[int, list[int]] = defaultdict(list)
        for number, each in enumerate(self.sums):
            for i in dict.fromkeys(i for i, _ in each.own):
                found[i].append(number)
        return found

    @cached_property
    def _sizes(self) -> list[int]:
        """How many sums go on from each, itself counted."""
        sizes = [1] * len(self.sums)
        for number in reversed(range(len(sizes))):
            if self.sums[number].before >= 0:
                sizes[self.sums[number].before] += sizes[number]
        return sizes

    def _subtree(self, number: int) -> range:
        """Return the sums that go on from one, which follow it."""
        return range(number, number + self._sizes[number])


def tree_of_sums(graph: Graph, channels: Sequence[Channel]) -> TreeOfSums:
    """Return the sums that channels share, slopes of many channels standing first, what is no slope last.

    Examples
    --------
    Two masses, the second measured from the first; a force pulls at the first alone:

    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> from canon.mechanics.at_scale.kinetic_terms import Channel
    >>> graph, m = Graph(), symbols("m", positive=True)
    >>> mass, one = graph.symbol(m), graph.one
    >>> tree = tree_of_sums(graph, [Channel(mass, ((0, one),)), Channel(mass, ((0, one), (1, one)))])
    >>> tree.terms
    2
    >>> [graph.to_sympy(a) for a in tree.solved([mass, graph.zero], {})]
    [1, -1]
    """
    slopes = [(*c.slopes, *(() if c.rest is None else ((-1, c.rest),))) for c in channels]
    often = Counter(slope for each in slopes for slope in each)
    root: dict[_Slope, _Branch] = {}
    for c, each in zip(channels, slopes, strict=True):
        branches, last = root, None
        for slope in sorted(each, key=lambda s: (s[0] < 0, -often[s], s)):
            last = branches.setdefault(slope, _Branch())
            branches = last.after
        if last is not None:
            last.weights.append(c.weight)
    return TreeOfSums(graph, tuple(_sums(root)))


@dataclass(frozen=True)
class _Branch:
    """What follows a slope, and the weights of the channels that end with it."""

    after: dict[_Slope, _Branch] = field(default_factory=dict[_Slope, "_Branch"])
    weights: list[int] = field(default_factory=list[int])


def _sums(root: dict[_Slope, _Branch]) -> list[Sum]:
    """Return the sums of a tree; slopes that follow each other without a fork are of one sum."""
    found: list[Sum] = []
    waiting = [(-1, slope, branch) for slope, branch in root.items()]
    while waiting:
        before, slope, branch = waiting.pop()
        own = [slope]
        while len(branch.after) == 1 and not branch.weights:
            ((slope, branch),) = branch.after.items()
            own.append(slope)
        found.append(Sum(before, tuple(own), tuple(branch.weights)))
        waiting += [(len(found) - 1, *each) for each in branch.after.items()]
    return found


class _Elimination:
    """The symmetric form ½ xᵀ H x − gᵀ x of what is left of the unknowns."""

    def __init__(self, graph: Graph, right: Sequence[int], more: Mapping[tuple[int, int], int]) -> None:
        self.graph, self.n = graph, len(right)
        self.rows: dict[_Unknown, dict[_Unknown, int]] = {i: {} for i in range(len(right))}
        self.right: dict[_Unknown, int] = dict(enumerate(right))
        self.back: list[tuple[_Unknown, int, dict[_Unknown, int]]] = []
        for (i, j), node in more.items():
            self._increase(i, j, node)

    def of_sum(self, number: int, each: Sum) -> None:
        """Write α = α_before + Σ a q̈ for the acceleration of a sum."""
        mul, add = self.graph.plain_mul, self.graph.plain_add
        parts: dict[_Unknown, int] = {(each.before,): self.graph.one} if each.before >= 0 else {}
        for i, a in each.own:
            if i >= 0:
                parts[i] = add((parts[i], a)) if i in parts else a
        own, row, pushed = self._taken((number,))
        self.back.append(((number,), self.graph.zero, parts))
        inertia = add((*each.weights, own))
        known = [*parts.items()]
        for k, (u, a) in enumerate(known):
            share = mul((inertia, a))
            for v, b in known[: k + 1]:
                self._increase(u, v, mul((share, b)))
            for v, h in row.items():
                # Where v is u itself, (α, q̈) stands on both sides of the diagonal.
                self._increase(u, v, self.graph.scaled(1 + (u == v), mul((h, a))))
            self._push(u, mul((pushed, a)))

    def of_coordinate(self, i: int) -> None:
        """Eliminate the acceleration of a coordinate."""
        graph, mul = self.graph, self.graph.plain_mul
        pivot, row, pushed = self._taken(i)
        if pivot == graph.zero:
            raise ZeroDivisionError(
                f"the pivot of coordinate {i + 1} is 0; L does not determine the accelerations: use fewer coordinates"
            )
        inverse = graph.power(pivot, -1)
        shares = {v: graph.negative(mul((h, inverse))) for v, h in row.items()}
        self.back.append((i, mul((pushed, inverse)), shares))
        known = [*row.items()]
        for k, (u, _) in enumerate(known):
            for v, h in known[: k + 1]:
                self._increase(u, v, mul((shares[u], h)))
            self._push(u, mul((shares[u], pushed)))

    def accelerations(self) -> tuple[int, ...]:
        """Return q̈ by substitution back."""
        found: dict[_Unknown, int] = {}
        for u, begins, parts in reversed(self.back):
            terms = [self.graph.plain_mul((a, found[v])) for v, a in parts.items()]
            found[u] = self.graph.plain_add((begins, *terms))
        return tuple(found[i] for i in range(self.n))

    def _increase(self, u: _Unknown, v: _Unknown, node: int) -> None:
        if node == self.graph.zero:
            return
        for a, b in ((u, v),) if u == v else ((u, v), (v, u)):
            row = self.rows.setdefault(a, {})
            row[b] = self.graph.plain_add((row[b], node)) if b in row else node

    def _push(self, u: _Unknown, node: int) -> None:
        if node != self.graph.zero:
            self.right[u] = self.graph.plain_add((self.right.get(u, self.graph.zero), node))

    def _taken(self, u: _Unknown) -> tuple[int, dict[_Unknown, int], int]:
        """Take an unknown out; return its diagonal entry, its row and its right-hand side."""
        row = self.rows.pop(u, {})
        own = row.pop(u, self.graph.zero)
        for v in row:
            del self.rows[v][u]
        return own, row, self.right.pop(u, self.graph.zero)
