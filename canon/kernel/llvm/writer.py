"""Writer of LLVM IR text: registers, memory, counted loops, and straight-line programs."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import itertools
from fractions import Fraction
from typing import TYPE_CHECKING, Self

from canon.kernel.llvm.double_double import pair_functions
from canon.kernel.llvm.double_double_functions import PAIR_FUNCTIONS, call_pair_function

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.program import Program

__all__ = ["HEAP", "LIBRARY", "Writer"]

_ALGEBRA = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}

_PAGE, _APART, _LONG = 4096, 9 * 128, 128
"""Bytes of a page, and by how many of them arrays of 128 numbers and more are set apart within one.

A load waits for older stores to addresses that agree with its own in their last twelve bits and in some more that
depend on where the page lies, which no program can choose. Where loops run through several arrays at once, these begin
so far apart that such stores are done; otherwise a step takes up to twice as long in one process as in another
(``benchmarks/kernels.py --large``). Nine times 128 bytes: five arrays are 512 bytes or more from each other, and
numbers of every kind keep their alignment.
"""

_STACK, _LARGE, _LINE = 256 * 1024, 4096, 64
"""Bytes of a function's arrays that its stack has room for, also in a thread; of an array that is moved to the heap
where together they are more; and of a cache line, where arrays begin."""

LIBRARY = (
    "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh",
    "atanh", "atan2", "erf", "erfc", "pow",
)  # fmt: skip
"""Functions that come from the platform's libm."""

HEAP = ("malloc", "free")
"""What gives and takes back memory for arrays that the stack has no room for."""


class Writer:
    """Collects the lines of one LLVM function body.

    Parameters
    ----------
    number
        The floating-point type the function computes in.
    """

    def __init__(self, number: MachineType) -> None:
        self.number = number
        self.inlined = True
        """Whether double-double operations become part of the function that calls them."""
        self.reserved: list[str] = []
        self._arrays: dict[int, tuple[str, int, int]] = {}
        """The names of arrays, their bytes and their parts, by place in what is reserved."""
        self.lines: list[str] = []
        self.declarations: set[str] = set()
        self._names = itertools.count(1)
        self._ends: list[str] = []
        self._tables: dict[str, str] = {}

    def line(self, text: str) -> None:
        """Write an instruction without a result."""
        self.lines.append("  " + text)

    def let(self, text: str) -> str:
        """Write an instruction and return the register of its result."""
        name = f"%r{next(self._names)}"
        self.line(f"{name} = {text}")
        return name

    def side_by_side(self, lanes: int) -> Self:
        """Return a writer of the same function that computes in so many SIMD lanes."""
        return self.in_numbers(dataclasses.replace(self.number, lanes=lanes))

    def in_numbers(self, number: MachineType) -> Self:
        """Return a writer of the same function that computes in other numbers."""
        other = copy.copy(self)
        other.number = number
        return other

    def widened(self, value: str, kind: MachineType) -> str:
        """Turn a number of another type into one of this writer's, which is no narrower, without rounding."""
        if self.number == kind:
            return value
        if not self.number.pair:
            return self.let(f"fpext {kind.scalar} {value} to {self.number.scalar}")
        if kind.scalar != "x86_fp80":
            high = value if kind.scalar == "double" else self.let(f"fpext {kind.scalar} {value} to double")
            return self.paired(high, "0.0")
        high = self.let(f"fptrunc x86_fp80 {value} to double")
        rest = self.let(f"fsub x86_fp80 {value}, {self.let(f'fpext double {high} to x86_fp80')}")
        return self.paired(high, self.let(f"fptrunc x86_fp80 {rest} to double"))

    def as_double(self, value: str) -> str:
        """Round a scalar to a double register: its sign is kept, unless it is too small for a double."""
        if self.number.pair:
            return self.let(f"extractvalue {self.number.name} {value}, 0")
        narrowing = {"float": "fpext", "x86_fp80": "fptrunc"}.get(self.number.scalar)
        return self.let(f"{narrowing} {self.number.scalar} {value} to double") if narrowing else value

    def paired(self, high: str, low: str) -> str:
        """Make a double-double number of its two parts."""
        kind, base = f"{{ {self.number.base}, {self.number.base} }}", self.number.base
        return self.let(
            f"insertvalue {kind} {self.let(f'insertvalue {kind} poison, {base} {high}, 0')}, {base} {low}, 1"
        )

    def lesser_integer(self, a: str, b: str) -> str:
        """Return the lesser of two i64 registers."""
        return self.let(f"select i1 {self.let(f'icmp slt i64 {a}, {b}')}, i64 {a}, i64 {b}")

    def greater_integer(self, a: str, b: str) -> str:
        """Return the greater of two i64 registers."""
        return self.let(f"select i1 {self.let(f'icmp sgt i64 {a}, {b}')}, i64 {a}, i64 {b}")

    # numbers -------------------------------------------------------------------------------------

    def constant(self, value: Fraction) -> str:
        """Return an exact number as an operand."""
        return self.number.literal(value)

    def algebra(self, operation: str, a: str, b: str) -> str:
        """Write a + b, a − b, a · b or a / b."""
        if not self.number.pair:
            return self.let(f"{_ALGEBRA[operation]} {self.number.name} {a}, {b}")
        if operation == "sub":
            return self._of_pairs("add", a, self.negative(b))
        return self._of_pairs(operation, a, b)

    def _of_pairs(self, function: str, *operands: str) -> str:
        kind = self.number.name
        kinds = (self.number.base, self.number.intrinsic, self.number.flags)
        self.declarations.update(pair_functions(*kinds, inlined=self.inlined))
        return self.let(
            f"call {kind} @pair.{function}.{self.number.intrinsic}({', '.join(f'{kind} {o}' for o in operands)})"
        )

    def negative(self, a: str) -> str:
        """Write −a."""
        kind, base = self.number.name, self.number.base
        if not self.number.pair:
            return self.let(f"fneg {kind} {a}")
        result = "poison"
        for part in (0, 1):
            negated = self.let(f"fneg {base} {self.let(f'extractvalue {kind} {a}, {part}')}")
            result = self.let(f"insertvalue {kind} {result}, {base} {negated}, {part}")
        return result

    def multiply_add(self, a: str, b: str, c: str) -> str:
        """Write a · b + c, rounded once where the hardware does that."""
        if self.number.pair or self.number.scalar == "x86_fp80":
            return self.algebra("add", self.algebra("mul", a, b), c)
        return self.intrinsic("fma", a, b, c)

    def intrinsic(self, name: str, *operands: str) -> str:
        """Write a call of one of LLVM's own functions, such as ``fma`` or ``sqrt``."""
        kind, full = self.number.name, f"@llvm.{name}.{self.number.intrinsic}"
        self.declarations.add(f"declare {kind} {full}({', '.join([kind] * len(operands))})")
        return self.let(f"call {kind} {full}({', '.join(f'{kind} {o}' for o in operands)})")

    def library(self, name: str, *operands: str) -> str:
        """Write a call of a libm function, lane by lane: lanes give the bits that scalars give."""
        scalar, full = self.number.scalar, f"@{name}{self.number.library_suffix}"
        self.declarations.add(
            f"declare {scalar} {full}({', '.join([scalar] * len(operands))}) nounwind willreturn memory(none)"
        )
        if self.number.lanes == 1:
            return self.let(f"call {scalar} {full}({', '.join(f'{scalar} {o}' for o in operands)})")
        result = "poison"
        for lane in range(self.number.lanes):
            parts = [self.let(f"extractelement {self.number.name} {o}, i32 {lane}") for o in operands]
            value = self.let(f"call {scalar} {full}({', '.join(f'{scalar} {x}' for x in parts)})")
            result = self.let(f"insertelement {self.number.name} {result}, {scalar} {value}, i32 {lane}")
        return result

    def whole(self, integer: str) -> str:
        """Turn an i64 register into a number."""
        scalar = self.let(f"sitofp i64 {integer} to {self.number.scalar}")
        if not self.number.pair:
            return self.splat(scalar)
        high = self._part.splat(scalar)
        return self.let(f"insertvalue {self.number.name} zeroinitializer, {self.number.base} {high}, 0")

    def splat(self, scalar: str) -> str:
        """Put a scalar into every lane."""
        if self.number.lanes == 1:
            return scalar
        if self.number.pair:
            kind = f"{{ {self.number.scalar}, {self.number.scalar} }}"
            part = self._part
            high, low = (part.splat(self.let(f"extractvalue {kind} {scalar}, {k}")) for k in (0, 1))
            return self.paired(high, low)
        first = self.let(f"insertelement {self.number.base} poison, {self.number.scalar} {scalar}, i32 0")
        mask = f"<{self.number.lanes} x i32> zeroinitializer"
        return self.let(f"shufflevector {self.number.base} {first}, {self.number.base} poison, {mask}")

    @property
    def _part(self) -> Writer:
        """A writer of the same function in the doubles that pairs are made of."""
        return self.in_numbers(dataclasses.replace(self.number, pair=False))

    def body(self) -> str:
        """Return what was written, as the inside of a function that returns nothing."""
        reserved, freed = self._heaped()
        return "\n".join(["entry:", *reserved, *self.lines, *freed, "  ret void"])

    def _heaped(self) -> tuple[list[str], list[str]]:
        """Return what is reserved, large arrays on the heap where the stack has no room, and what frees them."""
        if sum(size for _, size, _ in self._arrays.values()) <= _STACK:
            return self.reserved, []
        self.declarations |= {
            "declare noalias ptr @malloc(i64)", "declare void @free(ptr)", "declare ptr @llvm.ptrmask.p0.i64(ptr, i64)"
        }  # fmt: skip
        reserved, freed = list(self.reserved), list[str]()
        before = 0
        for place, (name, size, parts) in self._arrays.items():
            if size >= _LARGE:
                apart = before * _APART % _PAGE
                reserved[place] = "\n".join(
                    (
                        f"  {name}.given = call noalias ptr @malloc(i64 {size + _PAGE + apart})",
                        f"  {name}.next = getelementptr inbounds i8, ptr {name}.given, i64 {_PAGE}",
                        f"  {name}.page = call ptr @llvm.ptrmask.p0.i64(ptr {name}.next, i64 {-_PAGE})",
                        f"  {name} = getelementptr inbounds i8, ptr {name}.page, i64 {apart}",
                    )
                )
                freed.append(f"  call void @free(ptr {name}.given)")
                before += parts
        return reserved, freed

    # lanes and choices ---------------------------------------------------------------------------

    def lane(self, value: str, index: int) -> str:
        """Take one lane of a value."""
        if self.number.lanes == 1:
            return value
        if self.number.pair:
            parts = [self.let(f"extractvalue {self.number.name} {value}, {k}") for k in (0, 1)]
            return self.side_by_side(1).paired(*(self._part.lane(part, index) for part in parts))
        return self.let(f"extractelement {self.number.name} {value}, i32 {index}")

    def from_lanes(self, scalars: Sequence[str]) -> str:
        """Put scalars side by side."""
        if self.number.lanes == 1:
            return scalars[0]
        if self.number.pair:
            kind = self.side_by_side(1).number.name
            parts = ([self.let(f"extractvalue {kind} {x}, {k}") for x in scalars] for k in (0, 1))
            return self.paired(*(self._part.from_lanes(part) for part in parts))
        result = "poison"
        for lane, scalar in enumerate(scalars):
            result = self.let(
                f"insertelement {self.number.name} {result}, {self.number.scalar} {scalar}, i32 {lane}"
            )
        return result

    def greatest(self, value: str) -> str:
        """Return the greatest lane."""
        kind, full = self.number, f"@llvm.vector.reduce.fmax.{self.number.intrinsic}"
        if kind.lanes == 1:
            return value
        self.declarations.add(f"declare {kind.scalar} {full}({kind.name})")
        return self.let(f"call {kind.scalar} {full}({kind.name} {value})")

    def less(self, a: str, b: str) -> str:
        """Compare: a < b, false where either is NaN; one flag a lane; of pairs by their high parts."""
        if self.number.pair:
            a, b = (self.let(f"extractvalue {self.number.name} {x}, 0") for x in (a, b))
            return self.let(f"fcmp olt {self.number.base} {a}, {b}")
        return self.let(f"fcmp olt {self.number.name} {a}, {b}")

    def equal(self, a: str, b: str) -> str:
        """Compare: a = b; one flag a lane."""
        return self.let(f"fcmp oeq {self.number.name} {a}, {b}")

    def any_lane(self, flags: str) -> str:
        """Return whether a flag is set in some lane."""
        if self.number.lanes == 1:
            return flags
        full = f"@llvm.vector.reduce.or.v{self.number.lanes}i1"
        self.declarations.add(f"declare i1 {full}(<{self.number.lanes} x i1>)")
        return self.let(f"call i1 {full}(<{self.number.lanes} x i1> {flags})")

    def select(self, flag: str, where_true: str, where_false: str) -> str:
        """Choose between two values, lane by lane."""
        kind = self.number.name
        return self.let(f"select {self.number.flags} {flag}, {kind} {where_true}, {kind} {where_false}")

    def infinity(self) -> str:
        """Return +∞ as an operand."""
        return self.number.special("inf")

    def nan(self) -> str:
        """Return NaN as an operand."""
        return self.number.special("nan")

    # memory --------------------------------------------------------------------------------------

    @property
    def _bytes(self) -> int:
        """Bytes of a number in memory."""
        kind = self.number
        return kind.alignment * kind.lanes * (1 + kind.pair)

    def gap(self, length: int) -> int:
        """Return how many numbers to leave free after so many, so that what comes next is set apart from them."""
        return (_APART - length * self._bytes) % _PAGE // self._bytes if 2 * length > _LONG else 0

    def array(self, length: int, parts: int = 1) -> str:
        """Reserve local memory for so many numbers, in so many parts that a :meth:`gap` sets apart."""
        size = length * self._bytes
        if length >= _LONG:
            size += (parts * _APART - size) % _PAGE  # where the next begins
        name = self.reserve(f"[{size // self._bytes} x {self.number.name}], align {_LINE}")
        self._arrays[len(self.reserved) - 1] = name, size, parts
        return name

    def reserve(self, what: str) -> str:
        """Reserve local memory for what LLVM calls so, and return its address."""
        # All in the function's first block: memory reserved inside a loop would pile up.
        name = f"%r{next(self._names)}"
        self.reserved.append(f"  {name} = alloca {what}")
        return name

    def at(self, array: str, index: str | int) -> str:
        """Return the address of an array's element."""
        return self.let(f"getelementptr inbounds {self.number.name}, ptr {array}, i64 {index}")

    def load(self, array: str, index: str | int) -> str:
        """Read an array's element."""
        return self.let(
            f"load {self.number.name}, ptr {self.at(array, index)}, align {self.number.alignment}"
        )

    def store(self, value: str, array: str, index: str | int) -> None:
        """Write an array's element."""
        self.line(
            f"store {self.number.name} {value}, ptr {self.at(array, index)}, align {self.number.alignment}"
        )

    def entry(self, table: Sequence[int], index: str) -> str:
        """Look an integer up in a constant table."""
        numbers = ", ".join(f"i32 {number}" for number in table)
        known = f"private unnamed_addr constant [{len(table)} x i32] [{numbers}]"
        name = self._tables.setdefault(known, f"@table{len(self._tables)}")
        self.declarations.add(f"{name} = {known}")
        address = self.let(f"getelementptr inbounds i32, ptr {name}, i64 {index}")
        return self.let(f"sext i32 {self.let(f'load i32, ptr {address}')} to i64")

    def number_table(self, values: Sequence[Fraction]) -> Callable[[str], str]:
        """Keep exact numbers in a constant table, and return what looks one up, in every lane."""
        one = self.side_by_side(1)
        kind = one.number.name
        numbers = ", ".join(f"{kind} {one.constant(value)}" for value in values)
        known = f"private unnamed_addr constant [{len(values)} x {kind}] [{numbers}], align 64"
        name = self._tables.setdefault(known, f"@table{len(self._tables)}")
        self.declarations.add(f"{name} = {known}")
        return lambda index: self.splat(one.load(name, index))

    # loops ---------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def loop(self, start: str | int, stop: str | int) -> Generator[str]:
        """Repeat what is written inside for i = start … stop − 1 and yield i."""
        label = f"loop{next(self._names)}"
        counter = self.reserve("i64")
        self.line(f"store i64 {start}, ptr {counter}")
        self.line(f"br label %{label}.test")
        self.lines.append(f"{label}.test:")
        index = self.let(f"load i64, ptr {counter}")
        more = self.let(f"icmp slt i64 {index}, {stop}")
        self.line(f"br i1 {more}, label %{label}.body, label %{label}.end")
        self.lines.append(f"{label}.body:")
        self._ends.append(f"{label}.end")
        yield index
        self._ends.pop()
        following = self.let(f"add i64 {index}, 1")
        self.line(f"store i64 {following}, ptr {counter}")
        self.line(f"br label %{label}.test")
        self.lines.append(f"{label}.end:")

    def leave_if(self, condition: str) -> None:
        """Leave the innermost loop where an i1 register is true."""
        onward = f"on{next(self._names)}"
        self.line(f"br i1 {condition}, label %{self._ends[-1]}, label %{onward}")
        self.lines.append(f"{onward}:")

    def copy(self, source: str, target: str, length: int) -> None:
        """Copy an array of so many numbers."""
        with self.loop(0, length) as i:
            self.store(self.load(source, i), target, i)

    # programs ------------------------------------------------------------------------------------

    def program(self, steps: Program, inputs: list[str]) -> list[str]:
        """Write a straight-line program and return the operands that hold its outputs."""
        registers: list[str] = []
        for operation, operands, value in steps.instructions:
            if operation == "input":
                registers.append(inputs[value])
            elif operation == "constant":
                registers.append(self.constant(value))
            else:
                registers.append(self.operation(operation, [registers[o] for o in operands]))
        return [registers[o] for o in steps.outputs]

    def operation(self, operation: str, x: list[str]) -> str:
        """Write one operation of a program."""
        if operation in _ALGEBRA:
            return self.algebra(operation, *x)
        if operation == "neg":
            return self.negative(x[0])
        if operation == "sqrt":
            return self._of_pairs("sqrt", *x) if self.number.pair else self.intrinsic("sqrt", *x)
        if self.number.pair:
            if operation in PAIR_FUNCTIONS:
                return call_pair_function(self, operation, x)
            raise ValueError(
                f"there is no {operation} in double-double; use precision='extended', or Taylor() with "
                "precision='quad'"
            )
        if operation == "Abs":
            return self.intrinsic("fabs", *x)
        if operation == "sign":
            zero, one = self.constant(Fraction(0)), self.constant(Fraction(1))
            unit = self.intrinsic("copysign", one, x[0])
            return self.select(self.equal(x[0], zero), zero, unit)
        return self.library(operation, *x)
