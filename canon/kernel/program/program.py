"""Straight-line programs: the machine operations that compute nodes of a graph, one after another.

Powers are lowered (whole exponents to products, halves to square roots), quotients get one division, a
reciprocal that several products share is computed once, and subexpressions without symbols become one exact
constant. Constants stay exact rational numbers (to 100 digits where irrational) until a back end prints
them at its own precision.
"""

from __future__ import annotations

import operator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.expression.graph.number_systems import multiprecision
from canon.expression.graph.piecewise_form import without_pieces

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["Instruction", "Program", "exact_value", "interpret", "program", "with_numbers"]

_CONSTANT_DIGITS = 100

_CONSTANT_BITS = 2**20
"""Constants below 2^−this are 0 and those above 2^this are refused: exact ones would take as many bits."""


class Instruction(NamedTuple):
    """One operation on earlier registers.

    ``operation`` is ``"input"`` (``value`` the input's index), ``"constant"`` (``value`` a Fraction),
    ``"add"``, ``"sub"``, ``"mul"``, ``"div"``, ``"neg"``, ``"sqrt"``, ``"pow"``, ``"atan2"`` or
    the SymPy name of an elementary function.
    """

    operation: str
    operands: tuple[int, ...] = ()
    value: Any = None


@dataclass(frozen=True)
class Program:
    """A sequence of operations from inputs to outputs; instruction number i writes register i.

    Parameters
    ----------
    inputs
        The symbols the program reads, in the order of its arguments.
    instructions
        The operations, each on registers written before.
    outputs
        The registers that hold the results.
    """

    inputs: tuple[Symbol, ...]
    instructions: tuple[Instruction, ...]
    outputs: tuple[int, ...]

    def count(self, operation: str) -> int:
        """Return how many instructions are of one operation."""
        return sum(instruction.operation == operation for instruction in self.instructions)


def program(graph: Graph, outputs: Sequence[int], inputs: Sequence[Symbol]) -> Program:
    """Return the straight-line program that computes nodes of a graph.

    Parameters
    ----------
    graph
        The graph.
    outputs
        The nodes to compute.
    inputs
        The symbols the program may read.

    Raises
    ------
    KeyError
        The outputs depend on a symbol that is not an input; the message names all such symbols.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> quotient = program(graph, [graph.from_sympy(x / (x**2 + y) ** 3)], [x, y])
    >>> [step.operation for step in quotient.instructions]
    ['input', 'mul', 'input', 'add', 'mul', 'mul', 'div']
    """
    unknown = graph.all_symbols(outputs) - set(inputs)
    if unknown:
        named = ", ".join(sorted(map(str, unknown)))
        raise KeyError(f"no value for {named}: give each a number in parameters=")
    lowering = _Lowering(graph, {symbol: index for index, symbol in enumerate(inputs)})
    results = lowering.run(outputs)
    return Program(tuple(inputs), tuple(lowering.instructions), tuple(results))


def with_numbers(
    graph: Graph, expression: Expr, variables: Sequence[Symbol], parameters: Mapping[str, Fraction], what: str
) -> int:
    """Return the node of an expression of some variables, with numbers for everything else.

    Raises
    ------
    KeyError
        It holds a symbol without a number; ``what`` says in the message what it is.
    """
    general = graph.from_sympy(without_pieces(expression))
    others = graph.symbols(general) - set(variables)
    unknown = sorted(symbol.name for symbol in others if symbol.name not in parameters)
    if unknown:
        raise KeyError(f"{what} holds {', '.join(unknown)}: {_advice(unknown, variables)}")
    known = {graph.symbol(symbol): graph.number(parameters[symbol.name]) for symbol in others}
    return graph.substitute([general], known)[0] if known else general


def _advice(unknown: Sequence[str], variables: Sequence[Symbol]) -> str:
    """Return what to do about symbols without a number: some have a variable's name, or are its velocity."""
    moving = {symbol.name for symbol in variables}
    if twins := [name for name in unknown if name in moving]:
        return (
            f"another symbol than the variable {twins[0]}, for SymPy tells symbols apart by their assumptions; take "
            f"the variable's own, which is sympy.Symbol({twins[0]!r}, real=True) where it was not made by you"
        )
    if any(name.removesuffix("_dot") in moving for name in unknown if name.endswith("_dot")):
        known = ", ".join(str(symbol) for symbol in variables)
        return f"velocities are no variables here, write it in {known}"
    return "give each a number, parameters={symbol: value}"


def exact_value(graph: Graph, node: int) -> Fraction:
    """Return the value of a node without symbols: exact where rational, else to 100 digits.

    Raises
    ------
    ValueError
        The value is not real, not finite, or too large for any arithmetic here.
    """
    kind, _, value = graph.nodes[node]
    if kind == "number":
        return value
    found = graph.evaluate([node], {}, multiprecision(_CONSTANT_DIGITS))[0]
    if not hasattr(found, "man_exp"):
        raise ValueError(
            f"the constant {graph.to_sympy(node)} is not a real number; "
            "H has real values, so write it with real constants"
        )
    mantissa, exponent = found.man_exp  # of the absolute value
    places = int(mantissa).bit_length() + int(exponent)
    if places > _CONSTANT_BITS or (not mantissa and found != 0):
        raise ValueError(f"the constant {graph.to_sympy(node)} is not finite, or too large to compute with")
    if places < -_CONSTANT_BITS:
        return Fraction(0)
    size = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    return -size if found < 0 else size


class _Lowering:
    def __init__(self, graph: Graph, inputs: Mapping[Symbol, int]) -> None:
        self.graph, self.inputs = graph, inputs
        self.instructions: list[Instruction] = []
        self.register_of: dict[Instruction, int] = {}
        self.register: dict[int, int] = {}
        self.uses: dict[int, int] = {}

    def run(self, outputs: Sequence[int]) -> list[int]:
        needed = self.graph.reachable(outputs)
        used = [operand for node in needed for operand in self.graph.nodes[node].operands]
        for node in (*used, *outputs):
            self.uses[node] = self.uses.get(node, 0) + 1
        wanted = self._wanted(outputs)
        for node in needed:
            if node in wanted:
                self.register[node] = self._lower(node)
        return [self.register[node] for node in outputs]

    def _wanted(self, outputs: Sequence[int]) -> set[int]:
        """Find the nodes that get a register of their own, as against those taken into their parents."""
        wanted, waiting = set[int](), list(outputs)
        while waiting:
            node = waiting.pop()
            if node in wanted:
                continue
            wanted.add(node)
            waiting.extend(self._read(node))
        return wanted

    def _read(self, node: int) -> list[int]:
        kind, operands, _ = self.graph.nodes[node]
        if self.graph.is_constant(node):
            return []
        if self._is_negative_sum(node):
            node = operands[1]
            kind, operands, _ = self.graph.nodes[node]
        if kind == "mul":
            return [base for factor in operands for base in self._factor(factor)[0]]
        if kind == "add":
            return [read for term in operands for read in self._term(term)[1]]
        if kind == "pow" and self._exact_exponent(node) is not None:
            return [operands[0]]
        return list(operands)

    # pieces that parents take in ---------------------------------------------------------------

    def _exact_exponent(self, node: int) -> Fraction | None:
        kind, operands, _ = self.graph.nodes[node]
        exponent = self.graph.nodes[operands[1]] if kind == "pow" else None
        if exponent is None or exponent.kind != "number" or exponent.value.denominator > 2:
            return None
        return exponent.value

    def _factor(self, node: int) -> tuple[list[int], Fraction | None]:
        """Return what a product reads of a factor, and the negative exponent of one it divides by."""
        exponent = self._exact_exponent(node)
        if self.graph.is_constant(node):
            return [], None
        if exponent is None or exponent > 0 or self.uses.get(node, 0) > 1:
            return [node], None
        return [self.graph.nodes[node].operands[0]], exponent

    def _term(self, node: int) -> tuple[bool, list[int]]:
        """Return whether a sum subtracts a term −x that it takes in, and what it reads of the term."""
        kind, operands, _ = self.graph.nodes[node]
        if kind == "mul" and len(operands) == 2 and self.graph.nodes[operands[0]].value == -1:
            return True, [operands[1]]
        return False, [node]

    def _is_negative_sum(self, node: int) -> bool:
        """Return whether a product is −(a + b − c …) of a sum that nothing else reads: then it is c − (a + b)."""
        kind, operands, _ = self.graph.nodes[node]
        if kind != "mul" or len(operands) != 2 or self.graph.nodes[operands[0]].value != -1:
            return False
        return self.graph.nodes[operands[1]].kind == "add" and self.uses.get(operands[1], 0) == 1

    # emission ----------------------------------------------------------------------------------

    def _emit(self, operation: str, *operands: int, value: Any = None) -> int:
        instruction = Instruction(operation, operands, value)
        register = self.register_of.get(instruction)
        if register is None:
            register = self.register_of[instruction] = len(self.instructions)
            self.instructions.append(instruction)
        return register

    def _constant(self, value: Fraction) -> int:
        return self._emit("constant", value=value)

    def _lower(self, node: int) -> int:
        kind, operands, value = self.graph.nodes[node]
        if self.graph.is_constant(node):
            return self._constant(exact_value(self.graph, node))
        if kind == "symbol":
            return self._emit("input", value=self.inputs[value])
        if kind == "add":
            return self._sum(operands)
        if self._is_negative_sum(node):
            return self._sum(self.graph.nodes[operands[1]].operands, negated=True)
        if kind == "mul":
            return self._product(operands)
        exponent = self._exact_exponent(node)
        if exponent is not None:
            base = self.register[operands[0]]
            if exponent > 0:
                return self._power(base, exponent)
            return self._emit("div", self._constant(Fraction(1)), self._power(base, -exponent))
        return self._emit(kind, *(self.register[o] for o in operands))

    def _sum(self, terms: Sequence[int], *, negated: bool = False) -> int:
        plus, minus = list[int](), list[int]()
        for term in terms:
            subtracted, (read,) = self._term(term)
            (minus if subtracted != negated else plus).append(self.register[read])
        if not plus:
            return self._emit("neg", self._balanced("add", minus))
        total = self._balanced("add", plus)
        return self._emit("sub", total, self._balanced("add", minus)) if minus else total

    def _product(self, factors: Sequence[int]) -> int:
        constant, above, below = Fraction(1), list[int](), list[int]()
        for factor in factors:
            if self.graph.is_constant(factor):
                constant *= exact_value(self.graph, factor)
                continue
            (read,), exponent = self._factor(factor)
            if exponent is None:
                above.append(self.register[read])
            else:
                below.append(self._power(self.register[read], -exponent))
        negated = constant == -1 and bool(above or below)
        if negated:
            constant = -constant
        if constant != 1 or not above:
            above.insert(0, self._constant(constant))
        product = self._balanced("mul", above)
        if below:
            product = self._emit("div", product, self._balanced("mul", below))
        return self._emit("neg", product) if negated else product

    def _balanced(self, operation: str, registers: Sequence[int]) -> int:
        """Combine registers in pairs, pairs of pairs …: short dependency chains, small round-off."""
        level = list(registers)
        while len(level) > 1:
            pairs = [self._emit(operation, a, b) for a, b in zip(level[::2], level[1::2], strict=False)]
            level = pairs + level[len(level) - len(level) % 2 :]
        return level[0]

    def _power(self, base: int, exponent: Fraction) -> int:
        """Raise a register to a positive whole or half-integer power."""
        if exponent.denominator == 2:
            root = self._emit("sqrt", base)
            whole = exponent - Fraction(1, 2)
            return self._emit("mul", root, self._power(base, whole)) if whole else root
        times = int(exponent)
        if times == 1:
            return base
        half = self._power(base, Fraction(times // 2))
        square = self._emit("mul", half, half)
        return self._emit("mul", square, base) if times % 2 else square


def interpret(
    steps: Program, inputs: Sequence[Any], number: Callable[[Fraction], Any], functions: Mapping[str, Any]
) -> list[Any]:
    """Interpret a program in any arithmetic: the reference the compiled code is tested against."""
    registers: list[Any] = []
    for operation, operands, value in steps.instructions:
        x = [registers[o] for o in operands]
        if operation == "input":
            registers.append(inputs[value])
        elif operation == "constant":
            registers.append(number(value))
        else:
            registers.append((_ARITHMETIC.get(operation) or functions[operation])(*x))
    return [registers[o] for o in steps.outputs]


_ARITHMETIC: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
}
