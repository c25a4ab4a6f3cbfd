"""Claims about the Hamilton–Jacobi equation: complete integrals, and coordinates in which it separates.

A complete integral is judged by what defines it: it satisfies the equation identically, and its mixed Hessian
∂²W/∂q∂α is regular (C. G. J. Jacobi, Vorlesungen über Dynamik, lectures 19 and 20; H. Goldstein, Classical Mechanics,
chapter 10). No integral is looked for.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.jumping_system import check_has_no_jumps
from canon.exercise.question.question import (
    Part,
    Question,
    Regular,
    Same,
    Stated,
    fails,
    opposite,
    wrong_variables,
)
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.possible_motion import motion_is_real, where_real
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.separability import is_separable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["complete_integral", "separable"]

SEPARABLE = "separable"
SHARE = 0.8
"""Part of the budget for Levi-Civita's conditions."""


def complete_integral(reading: Reading) -> Iterator[Question]:
    """H(q, ∂W/∂q) = E, or ∂S/∂t + H(q, ∂S/∂q, t) = 0, identically, and det ∂²W/∂q∂α ≠ 0."""
    q, p = reading.phase_space("q", "p")
    H, t, constants = reading.expression("H"), reading.time, reading.symbols("constants")
    _check_constants(reading, H, constants)
    name = next(key for key in ("S", "W", "gradient") if reading.has(key))
    if name != "S" and H.has(t):
        reading.fault(
            name, f"H depends on {t}, so no energy is kept; claim S(q, α, {t}) with ∂S/∂{t} + H = 0"
        )
    if len(constants) != len(q):
        wanted = counted(len(q), "constant")
        why = f"a complete integral has {wanted} beside an additive one, not {len(constants)}"
        yield fails("the number of constants", why)
        return
    whole = None if name == "gradient" else reading.expression(name)
    slopes = reading.expressions("gradient", like="q") if whole is None else tuple(map(whole.diff, q))
    rest = None if whole is None else _without_quadratures(reading, whole, name, slopes)
    for f in slopes if whole is None else (whole,):
        wrong = tuple(wrong_variables(f, (*p, *((t,) if name != "S" else ())), name, _variables_of(name)))
        if wrong:
            yield wrong[0]
            return
    rate = sp.S.Zero if whole is None else whole.diff(t)
    energy = sp.S.Zero if name == "S" else _energy(reading, constants)
    equation = substitute(H, dict(zip(p, slopes, strict=True))) + rate
    parts = [Part(_equation_of(name), equation, energy)]
    if name == "S":
        parts += _told_energy(reading, H, rate, constants)
    parts += [
        Part(f"∂p_{a}/∂{b} = ∂p_{b}/∂{a}", f.diff(b), g.diff(a))
        for (a, f), (b, g) in combinations(zip(q, slopes, strict=True), 2)
        if name == "gradient"
    ]
    real = where_real((*slopes, *([] if rest is None else [rest])), reading.domain, slopes)
    yield Same(tuple(parts), real, _no_answer)
    _check_slopes_go_on(name, Hamiltonian(H, q, p, t), real)
    yield Regular(
        sp.Matrix([[f.diff(c) for c in constants] for f in slopes]),
        "∂²W/∂q∂α",
        reading.domain,
        "the constants are not independent: det ∂²W/∂q∂α = 0, so the integral is not complete",
    )
    variables = (*q, *constants, t)
    if rest is not None:
        yield is_continuous(rest, variables, real, name, (H,))
    for x, slope in zip(p, slopes, strict=True):
        yield is_continuous(slope, variables, real, f"{x} = ∂W/∂q", (H,))
    for verdict in motion_is_real(dict(zip(p, slopes, strict=True)), reading.domain):
        yield (
            replace(verdict, feedback="a momentum p = ∂W/∂q is not real there") if verdict.fails else verdict
        )


def _check_slopes_go_on(name: str, H: Hamiltonian, domain: Domain) -> None:
    """Refuse slopes of W given alone where H has a step: those along the step would have to go on across it."""
    if name == "gradient" and len(H.q) > 1:
        check_has_no_jumps(H, domain)


def _without_quadratures(reading: Reading, whole: Expr, name: str, slopes: Sequence[Expr]) -> Expr:
    """Return W or S without its terms c ∫ f dx, which are continuous: as c is a constant, their slopes are c f."""
    if any(slope.has(sp.Integral) for slope in (*slopes, whole.diff(reading.time))):
        reading.fault(
            name, "what stands beside an integral without limits, as its factor, has to be a constant"
        )
    return exchanged(whole, dict.fromkeys(whole.atoms(sp.Integral), sp.S.Zero))


def _check_constants(reading: Reading, H: Expr, constants: Sequence[Symbol]) -> None:
    inside = [str(c) for c in constants if H.has(c)]
    if inside:
        reading.fault(
            "constants", f"{inside[0]} stands in H, so it is a parameter and no constant of integration"
        )


def _energy(reading: Reading, constants: Sequence[Symbol]) -> Expr:
    """Return E as a function of the constants: ``energy``, or the constant named E, or the only one."""
    if reading.has("energy"):
        energy = reading.expression("energy")
        foreign = [
            str(s) for s in (*reading.symbols("q"), *reading.symbols("p"), reading.time) if energy.has(s)
        ]
        if foreign:
            reading.fault("energy", f"holds {foreign[0]}; the energy is a function of the constants")
        if not energy.has(*constants):
            reading.fault("energy", "should depend on the constants")
        return energy
    named = [c for c in constants if c.name == "E"]
    if not named and len(constants) > 1:
        reading.fault("constants", 'which of them is the energy? Name it E, or say energy = "…"')
    return named[0] if named else constants[0]


def _told_energy(reading: Reading, H: Expr, rate: Expr, constants: Sequence[Symbol]) -> Iterator[Part]:
    """Yield the question whether −∂S/∂t is the energy that the claim says it is."""
    if reading.has("energy"):
        if H.has(reading.time):
            reading.fault("energy", f"H depends on {reading.time}, so no energy is kept")
        yield Part("−∂S/∂t", -rate, _energy(reading, constants))


def _variables_of(name: str) -> str:
    return "q, t and the constants" if name == "S" else "q and the constants"


def _equation_of(name: str) -> str:
    return "∂S/∂t + H(q, ∂S/∂q, t)" if name == "S" else "H(q, ∂W/∂q)"


def _no_answer() -> None:
    """Return nothing: a Hamilton–Jacobi equation has many complete integrals."""


def separable(reading: Reading) -> Iterator[Question]:
    """Levi-Civita's conditions hold for all pairs of coordinates, or fail for one."""
    q, p = reading.phase_space("q", "p")
    H = reading.expression("H")
    if H.has(reading.time):
        reading.fault("H", f"depends on {reading.time}; take it as a coordinate: H + p_t, with its momentum")
    said = tuple(" ".join(word.lower().strip(" .").split()) for word in reading.words("is"))
    if said not in ((SEPARABLE,), (f"not {SEPARABLE}",)):
        reading.fault("is", f"should be {SEPARABLE} or not {SEPARABLE}")
    verdict = is_separable(Hamiltonian(H, q, p, reading.time), reading.domain, SHARE * reading.claim.budget)
    if said == (SEPARABLE,):
        yield Stated(verdict)
        return
    names = ", ".join(map(str, q))
    yield Stated(
        opposite(verdict, f"it separates: Levi-Civita's conditions hold for all pairs among {names}")
    )
