"""Check every label of the corpus numerically, with mpmath alone.

    python tests/data/identities/verify.py [subject …]

Nothing of canon and nothing of SymPy takes part: the texts are read by Python's ``ast`` (a node that is not
listed here is an error) and evaluated by mpmath. Points are dyadic, hence exact in binary: small integers and
halves, several scales from 1/1024 to 1024, all signs the assumptions allow, and the box of the entry. At each
point the working precision is doubled from 80 digits until both sides stand still to 60 digits and the
precision exceeds what the largest intermediate value can have cancelled by 65 digits.

* A true entry needs 200 points of its domain where both sides are defined and no difference above 1e-55.
* A false entry needs one point with a difference above 1e-50 that stands still when the precision is doubled.

This can refute a label, not prove one: each true entry has also been derived by hand, or is in the textbooks.
"""

from __future__ import annotations

import ast
import functools
import operator
import random
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mpmath as mp
from mpmath import mpc, mpf

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

HERE = Path(__file__).parent
WANTED_POINTS = 200
STEADY, ZERO, NONZERO = mpf(10) ** -60, mpf(10) ** -55, mpf(10) ** -50
DIGITS = (80, 160, 320, 640, 1280, 2560, 5120)

Number = Any
Functions = dict[str, "Arbitrary"]


class UndefinedError(ArithmeticError):
    """The expression has no value at this point."""


class Evaluation:
    """Values of expression texts at one point, with one choice of the arbitrary functions."""

    def __init__(self, point: Mapping[str, Number], functions: Functions) -> None:
        self.point = dict(point)
        self.functions = functions
        self.largest = mpf(1)  # largest intermediate value: what may have cancelled

    def value(self, node: ast.expr) -> Number:
        found = self._value(node)
        if isinstance(found, mpc) and found.imag == 0:
            found = found.real
        if isinstance(found, (mpf, mpc)) and not mp.isfinite(found):
            raise UndefinedError
        self.largest = max(self.largest, abs(found))
        return found

    def _value(self, node: ast.expr) -> Number:
        match node:
            case ast.Constant(value=bool() as truth):
                return truth
            case ast.Constant(value=int() | float()):
                return mpf(ast.unparse(node))
            case ast.Name(id=name):
                return self._name(name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.value(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.value(operand)
            case ast.BinOp(left=left, op=op, right=right):
                return ARITHMETIC[type(op)](self.value(left), self.value(right))
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return COMPARISONS[type(op)](*reals(self.value(left), self.value(right)))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]):
                return self._call(name, args)
            case _:
                raise ValueError(f"not in the language: {ast.unparse(node)}")

    def _name(self, name: str) -> Number:
        if name in self.point:
            return self.point[name]
        if name in CONSTANTS:
            return CONSTANTS[name]()
        raise ValueError(f"undeclared symbol {name}")

    def _call(self, name: str, args: list[ast.expr]) -> Number:
        if name == "Piecewise":
            return self._piecewise(args)
        if name == "Derivative":
            return self._derivative(args)
        values = [self.value(arg) for arg in args]
        if name in self.functions:
            return self.functions[name](*values)
        if name in FUNCTIONS:
            return FUNCTIONS[name](*values)
        raise ValueError(f"unknown function {name}")

    def _piecewise(self, branches: list[ast.expr]) -> Number:
        for branch in branches:
            if not isinstance(branch, ast.Tuple):
                raise ValueError("Piecewise takes pairs")
            expression, condition = branch.elts
            if self.value(condition):
                return self.value(expression)
        raise UndefinedError

    def _derivative(self, args: list[ast.expr]) -> Number:
        expression, *variables = args
        orders: dict[str, int] = {}
        for variable in variables:
            name, order = variable.elts if isinstance(variable, ast.Tuple) else (variable, ast.Constant(1))
            key = ast.unparse(name)
            orders[key] = orders.get(key, 0) + int(ast.literal_eval(order))

        match expression:
            case ast.Call(func=ast.Name(id=function), args=inner) if function in self.functions:
                names = [ast.unparse(arg) for arg in inner]
                if set(orders) <= set(names) <= set(self.point) and len(set(names)) == len(names):
                    xs = [self.point[name] for name in names]
                    return self.functions[function].derivative(xs, [orders.get(name, 0) for name in names])

        def along(*values: Number) -> Number:
            shifted = Evaluation({**self.point, **dict(zip(orders, values, strict=True))}, self.functions)
            return shifted.value(expression)

        at = tuple(self.point[name] for name in orders)
        if len(at) == 1:
            return mp.diff(along, at[0], *orders.values())
        return mp.diff(along, at, tuple(orders.values()))


def reals(*values: Number) -> tuple[Number, ...]:
    """Return the values, refusing complex ones: order and atan2 are defined for real arguments only."""
    if any(isinstance(value, mpc) for value in values):
        raise UndefinedError
    return values


def power(base: Number, exponent: Number) -> Number:
    if base == 0 and mp.re(exponent) < 0:
        raise UndefinedError
    if base == 0 and exponent == 0:
        return mpf(1)
    if isinstance(exponent, mpf) and exponent == int(exponent) and abs(exponent) < 10**6:
        return base ** int(exponent)
    return mp.power(base, exponent)


def divided(a: Number, b: Number) -> Number:
    if b == 0:
        raise UndefinedError
    return a / b


def atan2(y: Number, x: Number) -> Number:
    y, x = reals(y, x)
    if x == 0 and y == 0:
        raise UndefinedError
    return mp.atan2(y, x)


def logarithm(z: Number) -> Number:
    if z == 0:
        raise UndefinedError
    return mp.log(z)


CONSTANTS: dict[str, Callable[[], Number]] = {"pi": lambda: +mp.pi, "I": lambda: mpc(0, 1)}
ARITHMETIC: dict[type, Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: divided,
    ast.Pow: power,
}
COMPARISONS: dict[type, Callable[[Number, Number], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
FUNCTIONS: dict[str, Callable[..., Number]] = {
    "sqrt": mp.sqrt,
    "exp": mp.exp,
    "log": logarithm,
    "sin": mp.sin,
    "cos": mp.cos,
    "tan": mp.tan,
    "cot": lambda x: divided(mp.cos(x), mp.sin(x)),
    "sec": lambda x: divided(1, mp.cos(x)),
    "csc": lambda x: divided(1, mp.sin(x)),
    "asin": mp.asin,
    "acos": mp.acos,
    "atan": mp.atan,
    "acot": lambda x: mp.atan(divided(1, x)),
    "atan2": atan2,
    "sinh": mp.sinh,
    "cosh": mp.cosh,
    "tanh": mp.tanh,
    "asinh": mp.asinh,
    "acosh": mp.acosh,
    "atanh": mp.atanh,
    "Abs": abs,
    "sign": mp.sign,
    "Max": lambda *xs: max(reals(*xs)),
    "Min": lambda *xs: min(reals(*xs)),
    "LambertW": mp.lambertw,
    "elliptic_k": mp.ellipk,
    "elliptic_e": mp.ellipe,
    "Ne": operator.ne,
    "Eq": operator.eq,
}


@dataclass(frozen=True)
class Arbitrary:
    """A smooth function without symmetry, standing for an arbitrary one: an exponential, squares and waves."""

    slopes: tuple[Number, ...]
    squares: tuple[Number, ...]
    waves: tuple[tuple[Number, tuple[Number, ...], Number], ...]

    def __call__(self, *xs: Number) -> Number:
        return self.derivative(xs, (0,) * len(xs))

    def derivative(self, xs: Sequence[Number], orders: Sequence[int]) -> Number:
        total = mp.exp(mp.fdot(self.slopes, xs)) * powers(self.slopes, orders)
        for x, factor, order in zip(xs, self.squares, orders, strict=True):
            if order == sum(orders):
                total += factor * (x * x, 2 * x, mpf(2), mpf(0))[min(order, 3)]
        for amplitude, numbers, phase in self.waves:
            angle = phase + mp.fdot(numbers, xs) + sum(orders) * mp.pi / 2
            total += amplitude * powers(numbers, orders) * mp.sin(angle)
        return total


def powers(bases: Sequence[Number], orders: Sequence[int]) -> Number:
    return mp.fprod(base**order for base, order in zip(bases, orders, strict=True))


def arbitrary(arity: int, rng: random.Random) -> Arbitrary:
    def coefficients() -> tuple[Number, ...]:
        return tuple(mpf(rng.randint(-64, 64)) / 32 + mpf(1) / 128 for _ in range(arity))

    return Arbitrary(
        slopes=tuple(s / 8 for s in coefficients()),
        squares=coefficients(),
        waves=tuple((coefficients()[0], coefficients(), coefficients()[0]) for _ in range(3)),
    )


def coordinate(assumption: str, box: list[float] | None, rng: random.Random) -> Number:
    """Return a dyadic number that the assumption allows."""
    if box is not None and rng.random() < 0.7:
        low, high = (mpf(str(end)) for end in box)
        grid = 1 if assumption == "integer" else 2**20
        value = mp.floor((low + (high - low) * rng.random()) * grid + mpf(1) / 2) / grid
    elif assumption == "integer":
        value = mpf(rng.randint(-9, 9))
    elif rng.random() < 0.25:
        value = mpf(rng.randint(-8, 8)) / rng.choice([1, 1, 2, 4])
    else:
        value = (
            mpf(rng.randint(-(2**12), 2**12)) / 2**11 * mpf(2) ** rng.choice([-8, -3, 0, 0, 1, 1, 2, 3, 5, 9])
        )
    if assumption == "positive":
        return abs(value)
    return -abs(value) if assumption == "negative" else value


def allowed(assumption: str, value: Number) -> bool:
    return assumption in ("real", "integer") or value != 0


def points(entry: dict[str, Any], rng: random.Random, attempts: int) -> Iterator[dict[str, Number]]:
    symbols: dict[str, str] = entry["symbols"]
    box = entry.get("box", {})
    conditions = [tree(text) for text in entry.get("conditions", [])]
    for _ in range(attempts):
        with mp.workdps(80):
            point = {name: coordinate(kind, box.get(name), rng) for name, kind in symbols.items()}
            if len(symbols) > 1 and rng.random() < 0.15:  # coincidences: x = y, x = -y
                first, second = rng.sample(list(symbols), 2)
                if symbols[first] == symbols[second]:
                    point[first] = point[second] * (rng.choice([1, -1]) if symbols[first] == "real" else 1)
            if not all(allowed(symbols[name], value) for name, value in point.items()):
                continue
            try:
                if all(Evaluation(point, {}).value(condition) for condition in conditions):
                    yield point
            except (UndefinedError, ZeroDivisionError):
                continue


@functools.cache
def tree(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def difference(entry: dict[str, Any], point: dict[str, Number], seed: int) -> Number | None:
    """Return |lhs − rhs| relative to max(1, |lhs|), or None where a side is undefined or does not settle."""
    sides = [tree(entry["lhs"]), tree(entry["rhs"])]
    before: list[Number] | None = None
    for digits in DIGITS:
        with mp.workdps(digits):
            rng = random.Random(seed)
            functions = {name: arbitrary(len(args), rng) for name, args in entry.get("functions", {}).items()}
            evaluation = Evaluation(point, functions)
            try:
                values = [evaluation.value(side) for side in sides]
            except (UndefinedError, ZeroDivisionError, mp.libmp.NoConvergence):
                return None
            scale = max(mpf(1), *(abs(value) for value in values))
            enough = digits > 65 + mp.log10(evaluation.largest / scale)
            settled = before is not None and all(
                abs(a - b) <= STEADY * scale for a, b in zip(values, before, strict=True)
            )
            if settled and enough:
                return abs(values[0] - values[1]) / scale
            before = values
    return None


def verdict(
    entry: dict[str, Any], points_wanted: int = WANTED_POINTS, *, how_often: bool = False
) -> tuple[str, int, int]:
    """Return (what is wrong with the label, points used, points with a difference).

    One point is enough of a false entry, unless it is asked how often it fails.
    """
    rng = random.Random(entry["id"])
    wanted = points_wanted if entry["symbols"] else 1
    used = different = 0
    enough = wanted if entry["truth"] else 50 * wanted  # a claim may fail at rare points only
    for point in points(entry, rng, attempts=400 * wanted):
        gap = difference(entry, point, seed=rng.randrange(2**32))
        if gap is None:
            continue
        used += 1
        if entry["truth"] and ZERO < gap < NONZERO:
            return f"unclear difference {mp.nstr(gap, 5)} at {shown(point)}", used, different
        if gap >= NONZERO:
            different += 1
            if entry["truth"]:
                return f"called true, differs by {mp.nstr(gap, 5)} at {shown(point)}", used, different
            if not how_often:
                return "", used, different
        if used >= enough or (used >= wanted and different):
            break
    if not entry["truth"] and different == 0:
        return "called false, no point found where it fails", used, different
    if used < wanted:
        return f"only {used} points found", used, different
    return "", used, different


def shown(point: Mapping[str, Number]) -> str:
    return ", ".join(f"{name} = {mp.nstr(value, 12)}" for name, value in point.items())


def main(subjects: list[str]) -> int:
    wrong = 0
    for path in sorted(HERE.glob("*.toml")):
        if subjects and path.stem not in subjects:
            continue
        started = time.perf_counter()
        entries = tomllib.loads(path.read_text(encoding="utf-8"))["identity"]
        rare: list[str] = []
        for entry in entries:
            complaint, used, different = verdict(entry, how_often=True)
            if complaint:
                wrong += 1
                sys.stdout.write(f"{path.stem}: {entry['id']}: {complaint}\n")
            elif different and different < 0.1 * used:
                rare.append(f"{entry['id']} ({different}/{used})")
        true = sum(entry["truth"] for entry in entries)
        report = (
            f"{path.stem}: {true} true, {len(entries) - true} false, {time.perf_counter() - started:.1f} s"
        )
        sys.stdout.write(report + (f"; fails at few points: {', '.join(rare)}\n" if rare else "\n"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
