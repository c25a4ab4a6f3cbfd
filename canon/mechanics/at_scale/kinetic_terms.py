"""Terms of the kinetic energy of a system of bodies: weighted velocities that are affine in q̇.

T = ½ Σ w u² over channels u = Σ aᵢ(q, t) q̇ᵢ + a₀(q, t), on an expression graph. Each Cartesian component of a centre of
mass is a channel with a = ∂x/∂q and the mass as weight, each component of an angular velocity one with a moment of
inertia. Positions are sums; they are differentiated term by term, so bodies of a chain share their nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.cached_property import cached_property
from canon.expression.graph.pythagoras import without_squares
from canon.expression.graph.sympy_conversion import NotModelledError
from canon.expression.symbols.symbol import velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.dynamicsymbols import needs_plain, plain
from canon.mechanics.algebra.substitution import exchanged
from canon.mechanics.lagrange.body import Particle, PlanarBody
from canon.mechanics.lagrange.quasi_velocity import Kinematics
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.expression.graph.graph import Graph
    from canon.mechanics.lagrange.body import Body, RigidBody

__all__ = ["Channel", "Reader", "channels"]


@dataclass(frozen=True)
class Channel:
    """A weighted velocity u = Σ aᵢ q̇ᵢ + a₀ as graph nodes.

    Parameters
    ----------
    weight
        Mass or moment of inertia.
    slopes
        Pairs (i, aᵢ); the same i may occur more than once, its slopes add up.
    rest
        a₀, or None.
    load
        An acceleration that a uniform field gives along it, or None.
    is_rate
        Whether u is the rate of a function of q and t; angular velocities in space are not.
    """

    weight: int
    slopes: tuple[tuple[int, int], ...]
    rest: int | None = None
    load: int | None = None
    is_rate: bool = True


@dataclass
class Reader:
    """SymPy expressions into graph nodes and their derivatives, each expression and each term once."""

    graph: Graph
    q: tuple[Symbol, ...]
    t: Symbol
    _nodes: dict[Expr, int] = field(default_factory=dict)
    _slopes: dict[Expr, tuple[tuple[tuple[int, int], ...], int | None]] = field(default_factory=dict)

    @cached_property
    def _named(self) -> dict[str, Symbol]:
        return {s.name: s for s in (*self.q, self.t)}

    def node(self, f: Expr) -> int:
        """Return the node of an expression."""
        found = self._nodes.get(f)
        if found is None:
            found = self._nodes[f] = self._read(f)
        return found

    def given(self, f: Expr) -> int:
        """Return the node of what a user gave beside the bodies: forces, potentials."""
        return self.node(plain(f, self.q, self.t))

    def slopes_in_velocities(self, V: Expr) -> list[int]:
        """Return ∂V/∂q̇ of a potential that is affine in the velocities; nothing where it holds none.

        Raises
        ------
        ValueError
            Where it is not affine in them.
        """
        v = [velocity(s) for s in self.q]
        node = self.given(V)
        if not self.graph.symbols(node) & set(v):
            return []
        energy = plain(V, self.q, self.t)
        if not is_affine(energy, v):
            raise ValueError(
                f"V = {energy} is not affine in the velocities, so it changes the masses; write L = T − V and take "
                "derivation_of_lagrangian"
            )
        return list(self.graph.gradient(node, v))

    def _read(self, f: Expr) -> int:
        if isinstance(f, sp.Symbol) and not needs_plain((f,), self._named):
            return self.graph.symbol(f)
        # Functions of time are rare in places; looking for them beforehand in each of a long chain would cost.
        try:
            node = self.graph.from_sympy(f)
        except NotModelledError:
            if not f.has(AppliedUndef):
                raise
        else:
            if not needs_plain(self.graph.symbols(node), self._named):
                return node
        return self.graph.from_sympy(plain(f, self.q, self.t))

    def slopes(self, f: Expr) -> tuple[tuple[tuple[int, int], ...], int | None]:
        """Return the pairs (i, ∂f/∂qᵢ) term by term, by rising i, and ∂f/∂t or None where that is 0."""
        pairs: list[tuple[int, int]] = []
        rests: list[int] = []
        for term in sp.Add.make_args(f):
            found = self._slopes.get(term)
            if found is None:
                found = self._slopes[term] = self._of_term(self.node(term))
            pairs.extend(found[0])
            if found[1] is not None:
                rests.append(found[1])
        return tuple(sorted(pairs)), self.graph.plain_add(rests) if rests else None

    def derivative(self, node: int, s: Symbol) -> int:
        """Return ∂node/∂s, its numerical factor apart, so that sin and −sin share what they multiply."""
        return self.graph.apart(self.graph.derivative(node, s))

    def _of_term(self, node: int) -> tuple[tuple[tuple[int, int], ...], int | None]:
        symbols = self.graph.symbols(node)
        pairs = [(i, self.derivative(node, s)) for i, s in enumerate(self.q) if s in symbols]
        zero = self.graph.zero
        rest = self.derivative(node, self.t) if self.t in symbols else zero
        return tuple((i, a) for i, a in pairs if a != zero), None if rest == zero else rest


def channels(reader: Reader, bodies: Sequence[Body], field: Sequence[Expr] = ()) -> Iterator[Channel]:
    """Yield the channels of bodies in a uniform field of acceleration.

    Parameters
    ----------
    reader
        The graph with the coordinates and the time.
    bodies
        Particles and rigid bodies.
    field
        The acceleration vector of gravity, of the dimension of the positions; nothing where there is none.
    """
    for body in bodies:
        if len(body.r) not in (0, len(field)) and field:
            raise ValueError(
                f"a field of {counted(len(field), 'component')} acts on a position of {len(body.r)}; give as many"
            )
        yield from _moving(reader, body, field)
        if isinstance(body, PlanarBody) and body.angle is not None:
            pairs, rest = reader.slopes(body.angle)
            if pairs or rest is not None:
                yield Channel(reader.node(body.moment), pairs, rest)
        elif not isinstance(body, Particle):
            yield from _turning(reader, body)


def _moving(reader: Reader, body: Body, field: Sequence[Expr]) -> Iterator[Channel]:
    """Yield the components of the position that move, with what the field pulls along them."""
    mass = reader.node(body.m)
    loads = [reader.node(sp.sympify(g, strict=True)) for g in field] if body.r else []
    for k, place in enumerate(body.r):
        pairs, rest = reader.slopes(place)
        load = loads[k] if loads and loads[k] != reader.graph.zero else None
        if pairs or rest is not None:
            yield Channel(mass, pairs, rest, load)


def _turning(reader: Reader, body: PlanarBody | RigidBody) -> Iterator[Channel]:
    """Yield ω along the body's axes; a product of inertia Iᵢⱼ weighs ωᵢ + ωⱼ and takes its share from ωᵢ and ωⱼ."""
    v = [velocity(s) for s in reader.q]
    at_rest = dict.fromkeys(v, sp.S.Zero)
    omega = body.angular_velocity(Kinematics(reader.q, t=reader.t))
    inertia = body.inertia
    weighed: list[tuple[Expr, Expr]] = []
    for i, w in enumerate(omega):
        others = [inertia.row(i)[j] for j in range(len(omega)) if j != i]
        weighed.append((inertia.row(i)[i] - sp.Add(*others), w))
        weighed += [(inertia.row(i)[j], w + omega[j]) for j in range(i) if inertia.row(i)[j] != 0]
    for moment, w in weighed:
        if moment == 0:
            continue
        slopes = ((i, _united(reader, w.diff(rate))) for i, rate in enumerate(v))
        pairs = tuple((i, a) for i, a in slopes if a != reader.graph.zero)
        rest = _united(reader, exchanged(w, at_rest))
        yield Channel(reader.node(moment), pairs, None if rest == reader.graph.zero else rest, is_rate=False)


def _united(reader: Reader, f: Expr) -> int:
    """Return the node of a sum of products, with cos² + sin² = 1 used."""
    products = [[reader.node(factor) for factor in sp.Mul.make_args(term)] for term in sp.Add.make_args(f)]
    united = without_squares(reader.graph, products)
    return reader.node(f) if united is None else united
