"""Claims about numbers: values within a tolerance of the right ones, ends of the interval included.

Whether |a − v| ≤ ε is decided by rational arithmetic where all three are rational, else by balls, and by the zero test
where no ball tells the difference from zero. What none of them decides is left UNDECIDED.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Rational

from canon.exercise.question.answer import stay_open
from canon.exercise.question.question import Determines, Question, Stated
from canon.exercise.sheet.quantities.measures import Measure, measure_like, measure_of
from canon.mechanics.algebra.substitution import substitute
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.verdict import Counterexample, Status, Undecided, Verdict
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Basic, Symbol

    from canon.exercise.sheet.reading import Reading

__all__ = ["number", "sign_of"]

_BITS = (64, 256, 1024, 4096)
_DIGITS = 15
_SHARE = 0.2
"""Part of the budget for one zero test, which numbers that people mean need hundredths of a second for."""
_FAR = 0.1
"""How far from the right value, as part of it, a value is that a slip is looked for in."""


@dataclass(frozen=True)
class _Tolerance:
    """How far a value may be from the right one: absolutely, or as a part of it; seconds for telling whether it is."""

    amount: Expr
    seconds: float
    relative: bool = False

    def allows(self, claimed: Expr, right: Expr) -> bool:
        """Tell whether a value is near enough.

        Raises
        ------
        Undecided
            Where that was not decided.
        """
        if self.amount == 0 and vanishes(claimed - right, budget=self.seconds).holds:
            return True  # its square is another expression, multiplied out
        reach = self.amount**2 * (_square(right) if self.relative else 1)
        return sign_of(_square(claimed - right) - reach, self.seconds) <= 0


def number(reading: Reading) -> Iterator[Question]:
    """Each claimed value is one of the right ones, within the tolerance; a complete answer has all of these."""
    tolerance = _tolerance(reading)
    asked = _asked_unit(reading)
    right = [v for v in _values(reading, "value", asked) if v is not None]
    claimed = _values(reading, "claim", asked)
    for i, (text, a) in enumerate(zip(reading.words("claim"), claimed, strict=True)):
        shown = text.strip().strip("$").strip()
        if a is None:
            unit = reading.units[f"claim[{i}]"]
            why = f"{unit} is no unit of what is asked in {reading.word('unit')}"
            yield Stated(Verdict(Status.FAILS, "the unit", "exact", feedback=why))
        elif not any(tolerance.allows(a, v) for v in right):
            yield Stated(_wrong(shown, a, right, tolerance), lambda: ", ".join(map(_written, right)))
        else:
            yield Stated(Verdict(Status.HOLDS, shown, _certificate([a, *right])))
    found = [a for a in claimed if a is not None]
    missing = [v for v in right if not any(tolerance.allows(a, v) for a in found)]
    yield Determines(lambda: stay_open([f"{len(missing)} of {len(right)} values"]) if missing else ())


def sign_of(f: Expr, seconds: float) -> int:
    """Return the sign of a real number that is written out: −1, 0 or 1.

    Parameters
    ----------
    f
        The number.
    seconds
        The last safety of its zero test.

    Raises
    ------
    Undecided
        Where neither balls nor the zero test decide it.

    Examples
    --------
    >>> sign_of(sp.sqrt(2) + sp.sqrt(3) - sp.sqrt(5 + 2 * sp.sqrt(6)), 10.0), sign_of(sp.pi - sp.Rational(22, 7), 10.0)
    (0, -1)
    """
    if isinstance(f, Rational):
        return (f.p > 0) - (f.p < 0)
    for bits in _BITS:
        with precision(bits):
            try:
                ball = value(f, {})
            except (NotDecided, Undefined, Unmodelled):
                continue
            if ball.real > 0:
                return 1
            if ball.real < 0:
                return -1
    if vanishes(f, budget=seconds).holds:
        return 0
    raise Undecided("whether a value is within the tolerance was not decided: it is too near to its end")


def _square(f: Expr) -> Expr:
    """Return |f|²."""
    if f.is_real or isinstance(f, Rational):
        return f**2
    re, im = f.as_real_imag()
    return re**2 + im**2


def _tolerance(reading: Reading) -> _Tolerance:
    """Return the tolerance of the sheet, 0 where it says none."""
    seconds = _SHARE * reading.claim.budget
    if not reading.has("tolerance"):
        return _Tolerance(sp.S.Zero, seconds)
    (text,) = reading.words("tolerance")
    relative = text.rstrip().endswith("%")
    (amount,) = reading.inside("tolerance", [text.rstrip().removesuffix("%")])
    if not amount.is_number or amount.is_real is False or sign_of(amount, seconds) < 0:
        reading.fault(
            "tolerance", "should be a number ≥ 0 such as 0.001, or a part of the value such as 0.5 %"
        )
    return _Tolerance(amount / 100 if relative else amount, seconds, relative)


def _asked_unit(reading: Reading) -> Measure | None:
    if not reading.has("unit"):
        return None
    found = measure_of(reading.word("unit"))
    if found is None:
        reading.fault("unit", "should be a unit of the SI or one made of them, such as m/s^2 or kJ")
    return found


def _values(reading: Reading, key: str, asked: Measure | None) -> list[Expr | None]:
    """Return the values under a key in the unit that is asked for, None where one has another dimension."""
    given = {reading.scope.names[name]: f for name, f in _given(reading).items()}
    found: list[Expr | None] = []
    for i, f in enumerate(reading.expressions(key)):
        place = f"{key}[{i}]"
        f = substitute(f, given) if given else f
        if f.free_symbols or not f.is_number:
            names = ", ".join(sorted(map(str, f.free_symbols))) or "a function"
            reading.fault(place, f"a number is asked for, and this holds {names}; say its value under given")
        if f.has(sp.nan, sp.zoo, sp.oo):
            reading.fault(place, "this has no value")
        written = reading.units.get(place, "")
        unit = measure_of(written) if asked is None else measure_like(written, asked)
        if asked is None or unit is None:
            found.append(f)
        elif unit.powers != asked.powers and key == "value":
            reading.fault(
                place, f"{reading.units[place]} is no unit of what is asked in {reading.word('unit')}"
            )
        elif unit.powers != asked.powers:
            found.append(None)
        else:
            found.append(f * _factor(reading, place, unit, asked))
    return found


def _factor(reading: Reading, place: str, unit: Measure, asked: Measure) -> Expr:
    factor = unit.factor_to(asked)
    if factor is None:
        given, wanted = reading.units[place], reading.word("unit")
        reading.fault(
            place,
            f"{given} where {wanted} is asked for: 1 Hz is one cycle a second, of 2π rad; write it in {wanted}",
        )
    return factor


def _given(reading: Reading) -> dict[str, Expr]:
    """Return the values of the parameters that the sheet gives."""
    if not reading.has("given"):
        return {}
    table = reading.table("given")
    for name, f in table.items():
        if name not in reading.scope.names:
            reading.fault(f"given.{name}", f"is not declared; {reading.scope.near(name)}")
        if f.free_symbols:
            reading.fault(f"given.{name}", "should be a number")
        said = reading.claim.keys.get("parameters", {}).get(name, "real")
        if not _may_be(reading.scope.names[name], f, _SHARE * reading.claim.budget):
            reading.fault(f"given.{name}", f"{f} is not {said}, as is said of {name} under parameters")
    values = {reading.scope.names[name]: f for name, f in table.items()}
    for i, condition in enumerate(reading.domain.conditions):
        if _is_false(condition, values, _SHARE * reading.claim.budget):
            reading.fault("given", f"condition {i + 1} of the domain, {condition}, is false for these values")
    return table


def _may_be(s: Symbol, number: Expr, seconds: float) -> bool:
    """Whether a number is what is assumed of a symbol: √(g²) was read as g for a positive g, and is not for another.

    Raises
    ------
    Undecided
        Where that was not decided.
    """
    if number.is_real is False or (s.is_integer and number.is_integer is False):
        return False
    if s.is_positive or s.is_negative or s.is_nonzero:
        sign = sign_of(number, seconds)
        return sign > 0 if s.is_positive else sign < 0 if s.is_negative else sign != 0
    return True


def _is_false(condition: Basic, values: Mapping[Symbol, Expr], seconds: float) -> bool:
    """Whether given values certainly do not satisfy a condition."""
    try:
        there = condition.subs(list(values.items()), simultaneous=True)
    except TypeError:  # a side is not real
        return True
    if not isinstance(there, sp.core.relational.Relational) or there.free_symbols:
        return there is sp.false
    sign = sign_of(cast("Expr", there.lhs) - cast("Expr", there.rhs), seconds)
    return bool(there.func(sp.Integer(sign), 0) is sp.false)


def _wrong(shown: str, a: Expr, right: Sequence[Expr], tolerance: _Tolerance) -> Verdict:
    """Return FAILS for a value, with the slip that would explain it."""
    nearest = min(right, key=lambda v: abs(complex(sp.N(v - a))))
    example = Counterexample({}, _decimal(a), _decimal(nearest), _DIGITS)
    far = abs(complex(sp.N(a - nearest))) > _FAR * abs(complex(sp.N(nearest)))
    try:
        why = _slip_of(a, right, tolerance) if far else ""
        if (
            not why
            and tolerance.amount == 0
            and a.is_Rational
            and _rounded(a, shown, right, tolerance.seconds)
        ):
            why = f"{shown} is the right value rounded; the exact one is asked for"
    except Undecided as reason:
        why = f"what is wrong is undecided: {reason}"
    if not why and tolerance.amount != 0:
        why = f"{shown} is further from the right value than the tolerance allows: {_short(abs(a - nearest))}"
    return Verdict(Status.FAILS, shown, _certificate([a, nearest]), counterexample=example, feedback=why)


def _slip_of(a: Expr, right: Sequence[Expr], tolerance: _Tolerance) -> str:
    """Return the slip that would explain a value, nothing where there is none."""
    return next((told for told, b in _slips(a) if any(tolerance.allows(b, v) for v in right)), "")


def _slips(a: Expr) -> Iterator[tuple[str, Expr]]:
    """Yield what could have gone wrong, with what the value would be without it."""
    if a == 0:
        return
    yield "the value has the wrong sign", -a
    yield "the value should be its reciprocal", 1 / a
    yield "the value should be half as large", a / 2
    yield "the value should be twice as large", 2 * a
    yield "the value seems to be in degrees; it is asked in radians", a * sp.pi / 180
    yield "the value seems to be in radians; it is asked in degrees", a * 180 / sp.pi
    for ten, up in product((1, 2, 3, 6, 9), (1, -1)):
        yield f"the value is wrong by the factor 10^{ten * up}", a / Rational(10) ** (ten * up)


def _rounded(a: Expr, shown: str, right: Sequence[Expr], seconds: float) -> bool:
    """Tell whether a decimal is a right value, rounded to as many digits as it has."""
    digits = (
        len(shown.partition(".")[2]) if "." in shown and shown.strip("+-").replace(".", "").isdigit() else 0
    )
    unit = Rational(1, 2) / Rational(10) ** digits
    return digits > 1 and any(_Tolerance(unit, seconds).allows(a, v) for v in right)


def _certificate(values: Sequence[Expr]) -> str:
    return "exact" if all(isinstance(v, Rational) for v in values) else "ball"


def _decimal(f: Expr) -> str:
    return str(sp.N(f, _DIGITS))


def _short(f: Expr) -> str:
    return str(sp.N(f, 2))


def _written(f: Expr) -> str:
    return str(f) if f.is_Integer else f"{f} ≈ {_decimal(f)}"
