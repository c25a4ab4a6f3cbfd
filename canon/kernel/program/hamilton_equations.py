"""Hamilton's equations ready to compile: the kind of the Hamiltonian, and the programs of its right-hand sides."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.graph.graph import Graph
from canon.expression.symbols.repeated_sum import sums_within, written_out
from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.program import Program, exact_value, program, with_numbers
from canon.kernel.program.repeated.gathered_rows import gathered
from canon.kernel.program.repeated.rates_in_loops import rates_in_loops
from canon.kernel.program.repeated.repeated_terms import KeptFunction, repeated_terms, sums_in
from canon.kernel.program.shared_products import with_shared_products

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.kernel.program.holonomic_system import HolonomicSystem
    from canon.kernel.program.lagrangian.momenta_and_forces import MomentaAndForces
    from canon.kernel.program.lie_poisson_parts import LiePoissonParts
    from canon.kernel.program.nonholonomic_system import NonholonomicSystem
    from canon.kernel.program.repeated.rates_in_loops import RatesInLoops
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = [
    "EquationNodes",
    "HamiltonEquations",
    "equations",
    "exact_number",
    "exact_numbers",
]


@dataclass(frozen=True, eq=False)
class EquationNodes:
    """Equations of motion on a graph.

    Parameters
    ----------
    graph
        The graph that holds the Hamiltonian and its gradient.
    hamiltonian
        The node of H.
    velocity, force
        The nodes of ∂H/∂p and of −∂H/∂q.
    """

    graph: Graph
    hamiltonian: int
    velocity: tuple[int, ...]
    force: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class HamiltonEquations:
    """Hamilton's equations of one Hamiltonian with numbers for its parameters.

    Parameters
    ----------
    written
        The Hamiltonian and its gradient on a graph, or the sums over rows that the Hamiltonian consists of.
    q, p, t
        Coordinates, momenta and time.
    parameters
        The parameters' numbers by name.
    separable
        Whether H = T(p, t) + V(q, t): then drifts and kicks are exact flows.
    quadratic_kinetic
        Whether moreover ∂²T/∂p² is constant, as Nyström methods ask.
    autonomous
        Whether t is absent from H.
    varying
        How many parameters differ from orbit to orbit: the last so many of q, which keep their values, and of
        p, where each has a twin for the velocities to read.
    canonical
        Whether they are Hamilton's equations. Equations of other origin (:mod:`canon.flow.system`) stand here too, as
        every engine but the splittings takes any: ``velocity`` and ``force`` are the rates of the first and the second
        half of their state, ``hamiltonian`` is what the motion conserves, or 0, and the last ``varying`` of both
        halves are what is integrated along unseen.
    spare
        How many of p before those only fill up the second half, at rate 0.
    kicked
        Whether they are those of a map: T + V of which a step is a kick and a drift, and nothing between.
    named
        The nodes of further symbols that functions along the motion may hold, such as multipliers.
    holonomic, nonholonomic
        The constraints that a method itself keeps, and what it needs for that.
    lagrangian
        Momenta and forces of the Lagrangian that they come from, for methods that discretise its action.
    lie_poisson
        The exactly solvable parts of a Lie–Poisson system, where a method moves it by them.
    variations
        How many variations of the motion are part of the state, behind it in q and in p.
    whole
        The Hamiltonian written out, where it was given so and gathered into sums.
    """

    written: EquationNodes | tuple[RepeatedTerms, ...]
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    t: Symbol
    parameters: Mapping[str, Fraction]
    separable: bool
    quadratic_kinetic: bool
    autonomous: bool
    varying: int = 0
    canonical: bool = True
    spare: int = 0
    kicked: bool = False
    named: Mapping[Symbol, int] = field(default_factory=lambda: FrozenMapping({}))
    holonomic: HolonomicSystem | None = None
    nonholonomic: NonholonomicSystem | None = None
    lie_poisson: LiePoissonParts | None = None
    lagrangian: MomentaAndForces | None = None
    variations: int = 0
    whole: Expr | None = None

    @cached_property
    def nodes(self) -> EquationNodes:
        """The Hamiltonian and its gradient on a graph; sums over rows are written out when this is first asked for."""
        if isinstance(self.written, EquationNodes):
            return self.written
        whole = self.whole
        if whole is None:
            whole = KeptFunction(self.written).written_out((*self.q, *self.p))
        return _equations(whole, self.q, self.p, self.t, self.parameters, ()).nodes

    @property
    def sums(self) -> tuple[RepeatedTerms, ...]:
        """The sums over rows that H consists of, where it is kept as such."""
        return () if isinstance(self.written, EquationNodes) else self.written

    @cached_property
    def loops(self) -> RatesInLoops | None:
        """The rates of those sums as loops."""
        return rates_in_loops(self.sums, self.t, len(self.q)) if self.sums else None

    @property
    def graph(self) -> Graph:
        """The graph that holds the Hamiltonian and its gradient."""
        return self.nodes.graph

    @property
    def hamiltonian(self) -> int:
        """The node of H."""
        return self.nodes.hamiltonian

    @property
    def velocity(self) -> tuple[int, ...]:
        """The nodes of ∂H/∂p."""
        return self.nodes.velocity

    @property
    def force(self) -> tuple[int, ...]:
        """The nodes of −∂H/∂q."""
        return self.nodes.force

    def moving_by(
        self, velocity: Sequence[int], force: Sequence[int], hamiltonian: int | None = None
    ) -> EquationNodes:
        """Return other rates, and another H where one is given, on the same graph."""
        energy = self.hamiltonian if hamiltonian is None else hamiltonian
        return EquationNodes(self.graph, energy, tuple(velocity), tuple(force))

    @cached_property
    def rows(self) -> list[int]:
        """The components of a state that are coordinates and momenta rather than parameters."""
        n = len(self.q) - self.varying
        return [*range(n), *range(len(self.q), len(self.q) + n - self.spare)]

    @property
    def keeps_constraints(self) -> bool:
        """Whether a method itself keeps constraints of theirs."""
        return self.holonomic is not None or self.nonholonomic is not None

    @cached_property
    def inputs(self) -> tuple[Symbol, ...]:
        """The arguments of every program of these equations: q, p and t."""
        return (*self.q, *self.p, self.t)

    @cached_property
    def rates(self) -> tuple[int, ...]:
        """The nodes of ∂H/∂p and −∂H/∂q together, written with as few products of functions as are found."""
        return tuple(with_shared_products(self.graph, (*self.velocity, *self.force)))

    def program(self, nodes: Sequence[int]) -> Program:
        """Return the program of some nodes, a function of (q, p, t)."""
        return program(self.graph, nodes, self.inputs)

    def observable(self, expression: Expr, what: str) -> int | KeptFunction:
        """Return a function of (q, p, t) as it is measured: its node, or, where H is kept as sums, its sums."""
        if self.sums:
            sums = sums_in(expression, (*self.q, *self.p), self.t, self.parameters, what)
            if sums is not None:
                return KeptFunction(sums)
        return self.node(written_out(expression), what)

    def node_of(self, observable: int | KeptFunction) -> int:
        """Return the node of what :meth:`observable` returned."""
        if isinstance(observable, int):
            return observable
        return self.node(observable.written_out((*self.q, *self.p)), "the observable")

    def node(self, expression: Expr, what: str) -> int:
        """Return the node of a function of (q, p, t) and the parameters; ``what`` names it in errors."""
        if not self.named:
            return with_numbers(self.graph, expression, self.inputs, self.parameters, what)
        both = (*self.inputs, *self.named)
        node = with_numbers(self.graph, expression, both, self.parameters, what)
        known = {self.graph.symbol(symbol): value for symbol, value in self.named.items()}
        return self.graph.substitute([node], known)[0]


def equations(
    hamiltonian: Expr,
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    t: Symbol,
    parameters: Mapping[str, Fraction],
    varying: Sequence[Symbol] = (),
) -> HamiltonEquations:
    """Return Hamilton's equations q̇ = ∂H/∂p, ṗ = −∂H/∂q, ready to compile.

    Parameters
    ----------
    hamiltonian
        H(q, p, t) as a SymPy expression.
    q, p, t
        Its coordinates, momenta and time.
    parameters
        An exact number for every other symbol, by name.
    varying
        Parameters that differ from orbit to orbit: part of the state, where they stay what they are.

    Raises
    ------
    KeyError
        A symbol of H is neither a coordinate, a momentum, the time nor a given parameter.
    """
    q, p = tuple(q), tuple(p)
    varying = tuple(varying)
    as_sums = _as_sums(hamiltonian, (*q, *p), t)
    if as_sums is not None and not varying:
        kept = _of_sums(as_sums, q, p, t, parameters)
        if kept is not None:
            return kept if as_sums is hamiltonian else replace(kept, whole=hamiltonian)
    if as_sums is hamiltonian:
        hamiltonian = written_out(hamiltonian)
    made = _equations(hamiltonian, q, p, t, parameters, varying)
    if made.separable or not hamiltonian.is_polynomial(*q, *p):
        return made
    # (q + p)² − 2qp is separable only after multiplying out, which is cheap for polynomials.
    expanded = _equations(sp.expand(hamiltonian), q, p, t, parameters, varying)
    return expanded if expanded.separable else made


def _as_sums(hamiltonian: Expr, variables: tuple[Symbol, ...], t: Symbol) -> Expr | None:
    """Return H with sums over rows, as it was given or gathered from many terms; None where it has none."""
    if sums_within(hamiltonian):
        return hamiltonian
    made = gathered(hamiltonian, variables, t)
    return None if made is hamiltonian else made


def _of_sums(
    hamiltonian: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    parameters: Mapping[str, Fraction],
) -> HamiltonEquations | None:
    """Return the equations of H = T(p, t) + V(q, t) that consists of long sums over rows; None of any other."""
    sums = repeated_terms(hamiltonian, q, p, t, parameters)
    if sums is None:
        return None
    kinetic = [each for each in sums if each.reads(len(q)) == {"p"}]
    made = HamiltonEquations(
        sums,
        q=q,
        p=p,
        t=t,
        parameters=parameters,
        separable=True,
        quadratic_kinetic=all(each.is_quadratic for each in kinetic),
        autonomous=not any(t in each.graph.symbols(each.node) for each in sums),
    )
    return None if made.loops is None else made


def _equations(
    hamiltonian: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    parameters: Mapping[str, Fraction],
    varying: tuple[Symbol, ...],
) -> HamiltonEquations:
    graph = Graph()
    node = with_numbers(graph, hamiltonian, (*q, *p, t, *varying), parameters, "the Hamiltonian")
    gradient = graph.gradient(node, (*q, *p))
    velocity = gradient[len(q) :]
    force = tuple(graph.negative(slope) for slope in gradient[: len(q)])
    separable = not (_depends(graph, velocity, q) or _depends(graph, force, p))
    quadratic = _is_linear(graph, velocity, p, (*q, t), varying)
    # A drift reads momenta only: what it needs of the parameters lies there once more.
    twins: tuple[Symbol, ...] = tuple(sp.Dummy(each.name, real=True) for each in varying)
    if varying:
        stays = (graph.number(Fraction(0)),) * len(varying)
        moved = {graph.symbol(a): graph.symbol(b) for a, b in zip(varying, twins, strict=True)}
        velocity = (*graph.substitute(velocity, moved), *stays)
        force = (*force, *stays)
    return HamiltonEquations(
        EquationNodes(graph, node, tuple(velocity), tuple(force)),
        q=(*q, *varying),
        p=(*p, *twins),
        t=t,
        parameters=parameters,
        separable=separable,
        quadratic_kinetic=quadratic,
        autonomous=not _depends(graph, [node], [t]),
        varying=len(varying),
    )


def _depends(graph: Graph, nodes: Sequence[int], symbols: Sequence[Symbol]) -> bool:
    wanted = graph.mask(symbols)
    return any(graph.masks[node] & wanted for node in nodes)


def _is_linear(
    graph: Graph,
    velocity: Sequence[int],
    p: tuple[Symbol, ...],
    others: tuple[Symbol, ...],
    constants: tuple[Symbol, ...],
) -> bool:
    """Return whether velocities are linear in the momenta with constant coefficients."""
    if _depends(graph, velocity, others):
        return False
    momenta = frozenset[Any](p)
    return not any(
        graph.symbols(slope) - set(constants)
        for v in velocity
        for slope in graph.gradient(v, tuple(momenta & graph.symbols(v)))
    )


def exact_number(value: Any, what: str) -> Fraction:
    """Return a number exactly: floats as the binary numbers they are, text as the decimal it spells.

    Raises
    ------
    ValueError
        The value is no finite real number; ``what`` says in the message what it was given for.

    Examples
    --------
    >>> exact_number("0.1", "g"), exact_number(0.5, "g")
    (Fraction(1, 10), Fraction(1, 2))
    """
    if isinstance(value, sp.Expr):
        graph = Graph()
        node = graph.from_sympy(value)
        if not graph.is_constant(node):
            raise ValueError(f"{what} = {value} is no number; give one, such as 9.81 or Rational(1, 10)")
        return exact_value(graph, node)
    if isinstance(value, bool):
        raise ValueError(f"{what} = {value} is no number; give one, such as 9.81 or Rational(1, 10)")
    try:
        if isinstance(value, str | int | Fraction):
            return Fraction(value)
        if hasattr(value, "man_exp"):  # mpmath's, which are binary numbers too
            return _binary_number(value)
        if not hasattr(value, "as_integer_ratio") and getattr(value, "ndim", None) == 0:
            return exact_number(value.item(), what)  # NumPy's whole numbers, and arrays of one number
        return Fraction(*value.as_integer_ratio())
    except (ValueError, OverflowError, AttributeError, ZeroDivisionError):
        raise ValueError(f"{what} = {value!r} is no finite real number") from None


def _binary_number(value: Any) -> Fraction:
    """Return a number of mpmath exactly; its mantissa has no sign, and is 0 of what is not finite."""
    mantissa, exponent = value.man_exp
    if not mantissa and value != 0:
        raise ValueError("infinite, or no number")
    return Fraction(int(-mantissa if value < 0 else mantissa)) * Fraction(2) ** exponent


def exact_numbers(parameters: Mapping[Symbol | str, Any]) -> dict[str, Fraction]:
    """Return parameters' exact numbers by name.

    Raises
    ------
    ValueError
        A value is no finite real number.

    Examples
    --------
    >>> exact_numbers({sp.Symbol("g"): "9.81", "m": 0.5})
    {'g': Fraction(981, 100), 'm': Fraction(1, 2)}
    """
    return {str(name): exact_number(value, str(name)) for name, value in parameters.items()}
