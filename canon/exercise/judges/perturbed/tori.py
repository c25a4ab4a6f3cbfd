"""Claims about actions, angles and frequencies of separable systems.

Actions are (1/2π) ∮ p dq over one cycle of each coordinate. The right ones are known in closed form where the loop
integral is a known one, recognised and certified on tori (:func:`canon.mechanics.closed_actions`); elsewhere a claim is
refuted by certified quadrature, or not decided. A formula holds for motions of one kind: where the domain has several,
such as the librations and rotations of a pendulum, it must be narrowed. Rotations in both senses are judged each by
itself. Where a coordinate falls, its action is counted along it, and negative, or along the motion: both are right.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, cast

import numpy as np
import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.canonical import canonical_parts
from canon.exercise.judges.perturbed.domain_tori import BITS, DIGITS, by_senses, falls, may_be
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.question import Part, Question, Same, Stated, wrong_variables
from canon.expression.symbols.user_input import counted
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.constraint_manifold import transported
from canon.mechanics.algebra.possible_motion import real_somewhere
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.verdict import Counterexample, Evidence, Status, Undecided, Verdict, all_hold
from canon.proof.kinks import off_kinks, vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import arb

    from canon.exercise.judges.perturbed.domain_tori import Tori
    from canon.exercise.sheet.reading import Reading

__all__ = ["action_angle", "frequency", "slow_invariant"]

POLES = (sp.tan, sp.cot, sp.sec, sp.csc)
"""Functions of an angle across whose poles a map may jump."""


def action_angle(reading: Reading) -> Iterator[Question]:
    """J are the actions; or a map is canonical, and its new momenta are the actions up to a unimodular matrix."""
    H = _hamiltonian(reading)
    if not reading.has("J"):
        yield from _map_to_actions(reading, H)
        return
    claimed, at_energy = reading.expressions("J", like="q"), _at_energy(reading, H)
    of_state = [substitute(J, at_energy) for J in claimed]
    for domain, tori in by_senses(H, reading):
        if not tori.in_closed_form:
            refuted = _refuted(of_state, [torus.J for torus in tori.tori], tori, "the action of", domain)
            if refuted is not None:
                yield Stated(refuted)
                return
        right = tori.along_the_motion(of_state, [*map(tori.of_state, tori.known())], tori.tori[0].J, domain)
        parts = _components("the action", "J", H.q, claimed, right, at_energy)
        yield Same(parts, tori.where_valid(domain), tori.shown, _whole_loop)
        yield tori.of_one_kind(domain)


def _components(
    name: str,
    key: str,
    q: Sequence[Symbol],
    claimed: Sequence[Expr],
    right: Sequence[Expr],
    through: Mapping[Symbol, Expr],
) -> tuple[Part, ...]:
    return tuple(
        Part(f"{name} of {x}", f, due, FrozenMapping(through), key=f"{key}[{i}]")
        for i, (x, f, due) in enumerate(zip(q, claimed, right, strict=True))
    )


def _whole_loop(part: Part) -> str:
    """Say whether 1/2π was forgotten, as where ∮ p dq itself is called the action."""
    return f"this is ∮ p dq; {part.name} is that divided by 2π" if _is_times(part, 2 * sp.pi) else ""


def _turns_alone(part: Part) -> str:
    """Say whether turns are counted, not radians."""
    return f"this counts turns; {part.name} is 2π times that" if _is_times(part, 1 / (2 * sp.pi)) else ""


def _is_times(part: Part, factor: Expr) -> bool:
    return vanishes_off_kinks(part.seen(part.claimed) - factor * part.right, EVERYWHERE, PROOF_SECONDS).holds


def _map_to_actions(reading: Reading, H: Hamiltonian) -> Iterator[Question]:
    """{Q, P} is the unit matrix, and the actions are A P + constants with an integer matrix A, det A = ±1."""
    new_q, new_p = reading.phase_space("new_q", "new_p")
    if len(new_q) != len(H.q):
        reading.fault("new_q", f"{counted(len(new_q), 'angle')} for {counted(len(H.q), 'coordinate')}")
    table, n = reading.table("transformation"), len(H.q)
    new, old = ({s.name: s for s in side} for side in ((*new_q, *new_p), (*H.q, *H.p)))
    if set(table) == set(new):
        images, (q, p), written = [table[name] for name in new], (H.q, H.p), new
        momenta, seen = images[n:], FrozenMapping[Symbol, Expr]({})
    elif set(table) == set(old):
        images, (q, p), written = [table[name] for name in old], (new_q, new_p), old
        momenta, seen = list(new_p), FrozenMapping(dict(zip((*H.q, *H.p), images, strict=True)))
    else:
        reading.fault("transformation", f"should say what {', '.join(new)} are, or what {', '.join(old)} are")
    if any(f.has(*written.values()) for f in images):
        reading.fault("transformation", "the variables on the left can't occur in the expressions")
    for name, f in table.items():
        yield from wrong_variables(f, (reading.time,), name, "the other variables alone, as H is")
    whole = transported(reading.domain, seen) if seen else reading.domain
    yield Same(canonical_parts(images[:n], images[n:], q, p), whole)
    yield from _is_one_map(dict(zip(written, images, strict=True)), new_q, (*q, *p), whole)
    said = "the new momenta are not the actions (1/2π) ∮ p dq: the angles do not grow by 2π in a turn"
    for there, tori in by_senses(H, reading):
        valid = tori.where_valid(there)
        domain = transported(valid, seen) if seen else valid
        right = [substitute(tori.of_state(J), seen) for J in tori.known()]
        yield Same(_up_to_units(H.q, momenta, right, (*q, *p), domain), domain, tori.shown, lambda _: said)
        yield tori.of_one_kind(there)


def _is_one_map(
    images: Mapping[str, Expr], angles: Sequence[Symbol], state: Sequence[Symbol], domain: Domain
) -> Iterator[Question]:
    """Ask whether a map is real, and continuous but for the turns of angles: brackets show neither."""
    real = real_somewhere([*images.values()], domain, "the map is real")
    yield replace(real, feedback="the map is imaginary all over the domain") if real.fails else real
    for name, f in images.items():
        if name in {s.name for s in angles}:
            yield _winds(name, f, state, domain)
        elif f.atoms(*POLES):
            why = f"{name} may jump where {f} has poles; write it without tangents and secants"
            yield Verdict(
                Status.UNDECIDED, f"{name} is continuous", evidence=(Evidence("open", why),), feedback=why
            )
        else:
            yield is_continuous(f, state, domain, name)


def _winds(name: str, f: Expr, state: Sequence[Symbol], domain: Domain) -> Verdict:
    """Tell whether an angle steps as arcs do at their cuts, or by whole turns only: sin θ and cos θ are continuous."""
    steps = continuity_but_for_turns(f, state, domain, PROOF_SECONDS, name)
    if steps.holds:
        return steps
    waves = [is_continuous(wave(f), state, domain, f"{wave}({name})") for wave in (sp.sin, sp.cos)]
    if any(wave.fails for wave in waves):
        return next(wave for wave in waves if wave.fails)
    return all_hold(waves)


def _up_to_units(
    names: Sequence[Symbol],
    momenta: Sequence[Expr],
    right: Sequence[Expr],
    z: Sequence[Symbol],
    domain: Domain,
) -> tuple[Part, ...]:
    """Return whether actions are A P + constants: all derivatives are the same."""
    A = _integer_matrix(right, momenta, z, domain)
    rows = (sp.Add(*(k * P for k, P in zip(A.row(i), momenta, strict=True))) for i in range(len(right)))
    return tuple(
        Part(f"∂/∂{s} of the action of {x}", row.diff(s), J.diff(s))
        for x, row, J in zip(names, rows, right, strict=True)
        for s in z
    )


def _integer_matrix(
    right: Sequence[Expr], momenta: Sequence[Expr], z: Sequence[Symbol], domain: Domain
) -> sp.Matrix:
    """Return the unimodular integer matrix that takes momenta to actions; the unit matrix where none does."""
    unit = sp.eye(len(right))
    symbols = {s for f in (*right, *momenta) for s in f.free_symbols if isinstance(s, Symbol)} | {*z}
    for point in domain.points(symbols, 6):
        due, given = (
            np.array([[complex(sp.N(substitute(f.diff(s), point))) for s in z] for f in functions])
            for functions in (right, momenta)
        )
        if not (np.isfinite(due).all() and np.isfinite(given).all()):
            continue
        if np.linalg.matrix_rank(given) == len(right):
            found = np.linalg.lstsq(given.T, due.T, rcond=None)[0].T.real
            A = sp.Matrix(np.rint(found).astype(int).tolist())
            return A if A.det() in (1, -1) else unit
    return unit


def frequency(reading: Reading) -> Iterator[Question]:
    """ω_i = ∂H/∂J_i: by Cramer's rule the quotient of a cofactor of ∂J/∂α and its determinant."""
    H = _hamiltonian(reading)
    names = reading.symbols("actions")
    if names and len(names) != len(H.q):
        reading.fault("actions", "should name one action for each coordinate, or be left out")
    claimed, at_energy = reading.expressions("omega", like="q"), _at_energy(reading, H)
    for domain, tori in by_senses(H, reading):
        if not names and not tori.in_closed_form:
            numbers = [substitute(f, at_energy) for f in claimed]
            frequencies = [torus.frequencies for torus in tori.tori]
            refuted = _refuted(numbers, frequencies, tori, "the frequency of", domain)
            if refuted is not None:
                yield Stated(refuted)
                return
        omega, energy = tori.frequencies(), tori.integral.energy
        through = at_energy | {name: tori.of_state(f) for name, f in zip(names, tori.known(), strict=False)}
        right = tori.along_the_motion(
            [substitute(f, through) for f in claimed],
            [*map(tori.of_state, omega)],
            tori.tori[0].frequencies,
            domain,
        )
        answer = tuple(substitute(f, {energy: Symbol("E", real=True)}) for f in omega)
        parts = _components("the frequency", "omega", H.q, claimed, right, through)
        yield Same(parts, tori.where_valid(domain), lambda answer=answer: answer, _turns_alone)
        yield tori.of_one_kind(domain)


def slow_invariant(reading: Reading, I: Expr, tau: Symbol, H: Expr, H0: Expr) -> Iterator[Question]:
    """I is a function of the action of H₀ at fixed τ: their gradients in (q, p, τ) are parallel.

    Ignorable coordinates of H are left out, and their momenta are constants: I is a function of the action and of them.
    """
    q, p = reading.phase_space("q", "p")
    moving = [(x, y) for x, y in zip(q, p, strict=True) if H.has(x)]
    if not moving:
        yield from wrong_variables(I, (*q, tau), "I", "the momenta, which are constant")
        return
    if len(moving) != 1:
        raise Undecided(
            "to lowest order invariants of one degree of freedom beside ignorable coordinates are judged; for more, "
            "claim I with order = 1"
        )
    ((x, y),) = moving
    idle = [z for z in q if z != x]
    yield from wrong_variables(I, idle, "I", f"{x}, the momenta and {tau}, as H is")
    said = f"I is no function of the action: its mean changes as {tau} does"
    for domain, tori in by_senses(Hamiltonian(H0, [x], [y], reading.time), reading):
        J = tori.of_state(tori.known()[0])
        parts = tuple(
            Part(f"∂(I, J)/∂({a}, {b})", I.diff(a) * J.diff(b) - I.diff(b) * J.diff(a))
            for a, b in combinations((x, y, tau), 2)
        )
        yield Same(parts, tori.where_valid(domain), lambda J=J: J, lambda _: said)
        yield tori.of_one_kind(domain)


def _hamiltonian(reading: Reading) -> Hamiltonian:
    q, p = reading.phase_space("q", "p")
    H = reading.expression("H")
    if H.has(reading.time):
        reading.fault("H", f"depends on {reading.time}; actions are those of motions with a fixed energy")
    return Hamiltonian(H, q, p, reading.time)


def _at_energy(reading: Reading, H: Hamiltonian) -> dict[Symbol, Expr]:
    """Return H for the name of the energy, which is ``energy``, or E where it is declared."""
    name = reading.word("energy") if reading.has("energy") else "E"
    E = reading.scope.symbol(name)
    if reading.has("energy") and (E is None or E in (*H.q, *H.p) or H.H.has(E)):
        reading.fault("energy", f"should be a name among the parameters that does not stand in H, not {name}")
    return {} if E is None or E in (*H.q, *H.p) or H.H.has(E) else {E: H.H}


def _refuted(
    claimed: Sequence[Expr], balls: Sequence[Sequence[arb]], tori: Tori, name: str, domain: Domain
) -> Verdict | None:
    """Return FAILS where a claimed number is outside of the ball of certified quadrature on some torus, off kinks."""
    off = off_kinks(claimed, domain).strictly
    beside = [cast("sp.Ne", c) for c in off.conditions if c not in domain.conditions]
    kinks = [cast("Expr", c.lhs) - cast("Expr", c.rhs) for c in beside]
    with precision(BITS):
        for torus, right in zip(tori.tori, balls, strict=True):
            if any(tori.number(gap, torus).contains(0) for gap in kinks):
                continue
            for i, (x, f, due) in enumerate(zip(torus.integral.H.q, claimed, right, strict=True)):
                value = tori.number(f, torus)
                if may_be(value, due) or (falls(torus, i) and may_be(value, -due)):
                    continue
                point = {s.name: str(v) for s, v in torus.values.items() if s not in torus.integral.constants}
                example = Counterexample(point, value.str(8, radius=False), due.str(8, radius=False), DIGITS)
                return Verdict(Status.FAILS, f"{name} {x}", "ball", counterexample=example)
    return None
