"""Derived parts: answers judged by their derivatives, as components with their right values.

K is right up to a function of time and I up to a constant; here one of the right ones is found, so that a
claimed one can be compared with it term by term.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis, judged_to_hold
from canon.exercise.diagnose.effort import JUDGEMENT_STEPS
from canon.exercise.diagnose.repairs.answer_places import answers_of
from canon.exercise.diagnose.repairs.screening import screening
from canon.exercise.judges.canonical import map_values
from canon.exercise.judges.conserved import motion_of
from canon.exercise.judges.lagrangian import appell_system
from canon.exercise.question.deadline import PROOF_SECONDS, unless_spent
from canon.exercise.question.question import Part, Same
from canon.expression.symbols.symbol import time_derivative, velocity
from canon.mechanics.algebra.linear import SingularMatrixError, solve_affine
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.new_hamiltonian import rate_form
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = [
    "acceleration_energy_part",
    "generating_part",
    "momentum_parts",
    "new_hamiltonian_part",
    "second_lagrangian_part",
    "time_term",
]
MOST_OPERATIONS = 60


def new_hamiltonian_part(reading: Reading) -> Iterator[Part]:
    """Yield K beside H + ∂F/∂t, where the latter is found; the map should be canonical.

    From the inverse map K = H(z(Z, t), t) − R with the R of that map.
    """
    there, domain = map_values(reading)
    H, K, t = reading.expression("H"), reading.expression("K"), reading.time
    old, new = ("q", "p"), ("new_q", "new_p")
    if reading.has("inverse_map"):
        old, new = new, old
    (q, p), names = reading.phase_space(*old), [s for key in new for s in reading.symbols(key)]
    images, n = [there[s] for s in names], len(q)
    map_ = CanonicalTransformation(q, p, images[:n], images[n:], domain, t)
    form = rate_form(map_)
    R = _integrated(form, map_.variables, domain)
    if R is None:
        return
    if reading.has("inverse_map"):
        right = substitute(H, there) - R
    elif not (back := _linear_inverse(images, map_.variables, names)):
        yield Part("K", K, H + R, there, "K")
        return
    else:
        right = substitute(H + R, back)
    rest = substitute(K - right, dict.fromkeys(_all(reading), sp.S.Zero))
    yield Part("K", K, right if rest.has(sp.nan, sp.zoo, sp.oo) else right + rest, key="K")


def _all(reading: Reading) -> list[Symbol]:
    return [s for key in ("new_q", "new_p") for s in reading.symbols(key)]


def _integrated(form: Sequence[Expr], z: Sequence[Symbol], domain: Domain) -> Expr | None:
    found = _of_polynomials(form, z)
    if found is not None:
        return found
    start = time.monotonic()
    return unless_spent(potential(form, z, domain, budget=PROOF_SECONDS), start, PROOF_SECONDS)


def _of_polynomials(form: Sequence[Expr], z: Sequence[Symbol]) -> Expr | None:
    """Return G with ∂G/∂zⱼ = aⱼ for a closed form of polynomials: the integral of Σ zⱼ aⱼ(λz) from 0 to 1."""
    terms: list[Expr] = []
    for a, x in zip(form, z, strict=True):
        try:
            poly = sp.Poly(a, *z)
        except sp.PolynomialError:
            return None
        for powers, c in poly.terms():
            terms.append(c * x * sp.Mul(*(s**k for s, k in zip(z, powers, strict=True))) / (sum(powers) + 1))
    return sp.Add(*terms)


def _linear_inverse(
    images: Sequence[Expr], z: Sequence[Symbol], names: Sequence[Symbol]
) -> dict[Symbol, Expr] | None:
    """Return the old variables in terms of the new ones for an affine map, None for another."""
    if any(f.diff(a).has(*z) for f in images for a in z):
        return None
    try:
        return solve_affine([f - name for f, name in zip(images, names, strict=True)], z)
    except (SingularMatrixError, Undecided):
        return None


def momentum_parts(reading: Reading) -> tuple[Part, ...]:
    """Return the new momenta of a point transformation beside Σ (∂Q/∂q)⁻ᵀ p and what they are at p = 0."""
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    if any(f.has(*p) for f in Q) or any(f.diff(a).has(*p) for f in P for a in p):
        return ()
    valence, new = reading.expression("valence", sp.S.One), [sp.Dummy(f"P{i}") for i in range(len(p))]
    equations = [
        sum((y * f.diff(x) for y, f in zip(new, Q, strict=True)), -valence * z)
        for x, z in zip(q, p, strict=True)
    ]
    try:
        found = solve_affine(equations, new, reading.domain)
    except (SingularMatrixError, Undecided):
        return ()
    gauge = [substitute(f, dict.fromkeys(p, sp.S.Zero)) for f in P]
    rights = [found[y] + g for y, g in zip(new, gauge, strict=True)]
    names = [f"P{i}" for i in range(1, len(p) + 1)] if len(p) > 1 else ["P"]
    compared = enumerate(zip(names, P, rights, strict=True))
    return tuple(Part(name, f, r, key=f"P[{i}]") for i, (name, f, r) in compared)


def generating_part(finding: Finding) -> Iterator[Part]:
    """Yield F beside a generating function of the map, with the constant that makes them alike at the origin."""
    reading, question = finding.reading, finding.question
    if not (isinstance(question, Same) and question.answer is not None and reading.has("F")):
        return
    try:
        right = question.answer()
    except (ValueError, Undecided):
        return
    if not isinstance(right, sp.Expr):
        return
    F = reading.expression("F")
    variables = [s for key in ("q", "p", "new_q", "new_p") for s in reading.symbols(key)]
    rest = substitute(F - right, dict.fromkeys(variables, sp.S.Zero))
    yield Part("F", F, right if rest.has(sp.nan, sp.zoo, sp.oo) else right + rest, key="F")


def acceleration_energy_part(reading: Reading) -> Part:
    """Return S beside Σ ½ m a² + ½ I α² and what the claimed one holds without accelerations."""
    appell = appell_system(reading)
    S, right = appell.kinematics.along(reading.expression("S")), appell.gibbs_function
    rest = substitute(S - right, dict.fromkeys(appell.u_dot, sp.S.Zero))
    natural = appell.kinematics.u == tuple(velocity(x) for x in appell.q)
    through = {} if natural else appell.kinematics.through
    return Part("S", reading.expression("S"), sp.expand(right + rest), through, key="S")


def second_lagrangian_part(reading: Reading) -> Part:
    """Return L₂ beside L₁ + dF/dt."""
    q, F = reading.symbols("q"), reading.expression("F")
    right = reading.expression("L1") + time_derivative(F, q, reading.time)
    return Part("L2", reading.expression("L2"), right, key="L2")


def time_term(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield the term of a constant of the motion that holds the time explicitly, where it was lost.

    If dI/dt is the same all along the motion, I − t dI/dt is conserved.
    """
    reading = wrong.reading
    I, t = reading.expression("I"), reading.time
    if I.has(t) or reading.has("restrict"):
        return
    rates = motion_of(reading)
    rate = sp.Add(*(I.diff(x) * value for x, value in rates.items()))
    screen = screening(reading, dict(answers_of(reading)))
    somewhere = {x: sp.Integer(i) for i, x in enumerate(rates, 1)}
    for growth in (
        substitute(rate, somewhere),
        rate,
    ):  # the same in every state, or a constant of the motion itself
        if growth.has(t, sp.nan, sp.zoo, sp.oo) or growth == 0 or sp.count_ops(growth) > MOST_OPERATIONS:
            continue
        if screen is not None and not any(
            screen.passes({"I": f}) for f in (I - growth * t, I + growth - growth * t)
        ):
            wrong.effort.spend(JUDGEMENT_STEPS)  # of the judgement on it, which values tell to be needless
            continue
        growth = sp.cancel(growth)
        if -growth in sp.Add.make_args(I):  # it stands there, without t
            repaired = reading.with_instead("I", I + growth - growth * t)
            change = Change.of(Mistake.FACTOR_MISSING, -growth, t, place="I")
        else:
            repaired = reading.with_instead("I", I - growth * t)
            change = Change.of(Mistake.TIME_TERM_MISSING, growth, -growth * t, place="I")
        if judged_to_hold(repaired, wrong.effort):
            yield Diagnosis((change,), repaired, judged=True)
            return
