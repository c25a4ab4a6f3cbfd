"""Claims about reactions along a motion, and where a one-sided contact is lost.

With d/dt ∂L/∂q̇ − ∂L/∂q = Q + Σ λₐ ∂fₐ/∂q (∂gₐ/∂q̇ for constraints on velocities). ``integrals`` are first integrals
with their values, such as the energy of a start from rest: the motions meant are those on which they hold.
"""

from __future__ import annotations

import time
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.constrained import bound_by, is_one_of
from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.judges.lagrangian import lagrangian_of
from canon.exercise.question.answer import stay_open
from canon.exercise.question.answer_values import what_may_vanish, without_value_on
from canon.exercise.question.deadline import SIDE_SECONDS, Deadline
from canon.exercise.question.implicit_point import refuted_at_a_point
from canon.exercise.question.question import TELLING, Determines, Part, Question, Same, Stated, decide, fails
from canon.exercise.sheet.kept_parses import parsed
from canon.expression.as_written import as_written
from canon.expression.symbols.symbol import Rate, acceleration, velocity
from canon.expression.text.open_readings import is_angle
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError, check_not_empty, on_manifold
from canon.mechanics.algebra.solve_for_symbol import named
from canon.mechanics.algebra.substitution import exchanged, substitute, symbols_of
from canon.mechanics.reduction.constrained_motion import motions_with_integrals
from canon.proof.analytic import proved_sign
from canon.proof.definedness.definedness import lack_of_value
from canon.proof.definedness.formula_around import put_in
from canon.proof.definedness.hazards import hazards
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict, all_hold
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.polynomial import polynomial_factors

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Basic

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.algebra.constraint_manifold import Branch
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.mechanics.reduction.constrained_motion import MotionOnManifold
    from canon.proof.domain.domain import Domain

__all__ = ["leaving_condition", "reaction"]


def reaction(reading: Reading) -> Iterator[Question]:
    """Multipliers or generalized forces of constraint are what is claimed, on every motion that is meant."""
    q, multipliers = reading.symbols("q"), reading.symbols("multipliers")
    constraints = reading.equations("constraints")
    bound = (*map(acceleration, q), *multipliers)
    risky = any(what_may_vanish(reading, key, bound) for key in ("values", "force"))
    if not (reading.has("values") or risky) and _force_is_the_rest(reading, constraints, multipliers):
        check_not_empty(constraints, q, reading.domain, reading.time)
        yield Verdict(Status.HOLDS, "the forces of constraint", "exact")
        yield Determines(lambda: stay_open(_held(reading, multipliers)))
        return
    if reading.has("integrals"):  # which bind the state too
        bound += (*q, *map(velocity, q))
    values = reading.table("values") if reading.has("values") else {}
    claimed = reading.expressions("force", like="q") if reading.has("force") else ()
    for motion in _motions(reading, constraints, multipliers, (*values.values(), *claimed)):
        parts = (*_of_multipliers(reading, motion, values), *_of_forces(motion, q, claimed))
        yield Same(parts, motion.branch.domain, lambda parts=parts: _answer(parts))
        seen = [({**motion.jets, **motion.branch.values, **motion.solution}, motion.branch.domain)]
        for key in ("values", "force"):
            yield from without_value_on(reading, key, bound, lambda seen=seen: seen)
    left = _held(reading, multipliers) if claimed else [s for s in multipliers if s.name not in values]
    yield Determines(lambda: stay_open(left))


def _held(reading: Reading, multipliers: Sequence[Symbol]) -> list[Symbol]:
    """Return the multipliers that claimed forces hold without a value: they stay open."""
    claimed = reading.expressions("force", like="q") if reading.has("force") else ()
    known = reading.claim.keys.get("values", {})
    return [s for s in multipliers if s.name not in known and any(force.has(s) for force in claimed)]


def _part(motion: MotionOnManifold, name: str, claimed: Expr, right: Expr, key: str) -> Part:
    """Return a claimed value beside the right one; what the claim may hold of the motion is put in."""
    value = exchanged(claimed, motion.jets)
    known = {s: f for s, f in motion.solution.items() if value.has(s)}
    written = {symbol: function for function, symbol in motion.jets.items()}
    return Part(name, value, right, {**motion.branch.values, **known}, key, written)


def _of_forces(motion: MotionOnManifold, q: Sequence[Symbol], claimed: Sequence[Expr]) -> Iterator[Part]:
    """Yield the claimed forces of constraint; none where none is claimed."""
    for i, (x, value) in enumerate(zip(q, claimed, strict=False)):
        force = motion.along(motion.forces[i])
        yield _part(motion, f"the force of constraint on {x}", value, force, f"force[{i}]")


def _of_multipliers(reading: Reading, motion: MotionOnManifold, values: Mapping[str, Expr]) -> Iterator[Part]:
    names = {s.name: s for s in reading.symbols("multipliers")}
    for name, value in values.items():
        if name not in names:
            reading.fault(f"values.{name}", "is not among the multipliers")
        if value.has(*names.values()):
            reading.fault(f"values.{name}", "should be in coordinates, velocities and time only")
        yield _part(motion, name, value, motion.solution[names[name]], f"values.{name}")


def leaving_condition(reading: Reading) -> Iterator[Question]:
    """The reaction of the contact f ≥ 0 vanishes exactly where the claimed equation holds."""
    contact = reading.expression("contact")
    if contact.has(*(velocity(x) for x in reading.symbols("q"))):
        reading.fault("contact", "a contact f ≥ 0 depends on coordinates and time only")
    others = reading.equations("constraints") if reading.has("constraints") else ()
    multipliers = tuple(sp.Dummy(f"lam{i}", real=True) for i in range(1 + len(others)))
    (leaves,) = reading.equations("leaves")
    deadline = Deadline.after(0.8 * reading.claim.budget)
    met, elsewhere = list[dict[Symbol, Expr]](), list[tuple[dict[Symbol, Expr], str]]()
    for motion in _motions(reading, (contact, *others), multipliers, (leaves,)):
        force = sp.cancel(sp.together(motion.solution[multipliers[0]]))
        claimed = motion.along(leaves)
        if claimed == 0 or vanishes_off_kinks(claimed, motion.branch.domain, budget=SIDE_SECONDS).holds:
            yield fails(TELLING, "this says nothing about the motion: it holds all along the contact")
            return
        if claimed.is_nonzero or proved_sign(claimed, motion.branch.domain) in ("+", "-"):
            elsewhere.append(_place_and_sense(motion))
            continue
        met.append(_place_and_sense(motion)[0])
        q = reading.symbols("q")
        verdict = _same_zeros(force, claimed, motion.branch, q, deadline)
        if verdict.fails and (place := _place_of_an_angle(leaves, force, q)) is not None:
            verdict = _same_zeros(force, motion.along(place), motion.branch, q, deadline)
        if verdict.holds:
            verdict = all_hold(
                [verdict, *_valued_at_zeros(_leaves_as_written(reading), force, motion, deadline)]
            )
        yield Stated(verdict, lambda force=force: f"the reaction {shown_short(sp.factor_terms(force))} = 0")
    if not met or any(place not in met for place, _ in elsewhere):
        reading.fault("leaves", "holds nowhere along the contact")
    yield Determines(lambda: stay_open([sense for _, sense in elsewhere]))


def _place_and_sense(motion: MotionOnManifold) -> tuple[dict[Symbol, Expr], str]:
    """Return where a motion is, and in words which way it goes."""
    place = {s: f for s, f in motion.branch.values.items() if not isinstance(s, Rate)}
    senses = [f"{s} = {shown_short(f)}" for s, f in motion.branch.values.items() if s not in place]
    return place, f"the motion with {', '.join(senses)}"


def _force_is_the_rest(reading: Reading, constraints: Sequence[Expr], multipliers: Sequence[Symbol]) -> bool:
    """Whether the claim only says that Σ λ a is d/dt ∂L/∂q̇ − ∂L/∂q − Q, which needs no solution, for any L."""
    bound, ordered = bound_by(reading, _lagrangian(reading), constraints, multipliers)
    claimed, system = reading.expressions("force", like="q"), bound.equations_of_motion(ordered)
    return all(
        is_one_of(f - force, system) for f, force in zip(claimed, bound.reactions_of(ordered), strict=True)
    )


def _lagrangian(reading: Reading) -> Lagrangian:
    forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else None
    return lagrangian_of(reading, forces=forces)


def _motions(
    reading: Reading, constraints: Sequence[Expr], multipliers: Sequence[Symbol], claims: Sequence[Expr]
) -> Iterator[MotionOnManifold]:
    """Yield the motions that are meant; those that do not keep "integrals" are refused, as no whole motion is meant."""
    integrals = reading.equations("integrals") if reading.has("integrals") else ()
    bound, ordered = bound_by(reading, _lagrangian(reading), constraints, multipliers)
    for motion in motions_with_integrals(bound, integrals, ordered, reading.domain, beside=claims):
        for i, rate in enumerate(motion.rates):
            part = Part("rate", rate)
            kept = decide(Same((part,), motion.branch.domain), Deadline.after(reading.claim.budget / 4))
            if kept.fails:
                reading.fault(
                    f"integrals[{i}]", "is not constant along the motion, so no whole motion satisfies it"
                )
            if kept.undecided:
                raise Undecided(
                    f"whether integrals[{i}] is constant along the motion was not decided; "
                    "give a larger budget, or narrow the domain"
                )
        yield motion


def _answer(parts: Sequence[Part]) -> tuple[str, ...]:
    return tuple(f"{part.name} = {shown_short(sp.factor_terms(part.right))}" for part in parts)


def _place_of_an_angle(leaves: Expr, force: Expr, q: Sequence[Symbol]) -> Expr | None:
    """Return cos θ − cos c for ``θ = c``, where the reaction is the same after whole turns and on the other side.

    Who writes ``θ = arccos(2/3)`` means these places too; None where the reaction tells them apart.
    """
    for x in q:
        factor = leaves.diff(x)
        c = sp.expand(x - leaves / factor) if factor.is_number and factor != 0 else x
        waves = [f for f in force.atoms(sp.sin, sp.cos) if f.has(x)]
        inside = force.xreplace({f: sp.Dummy() for f in waves})
        whole = not inside.has(x) and all(cast("Expr", f.args[0]).diff(x).is_integer for f in waves)
        even = is_angle(x.name) and sp.expand(force - substitute(force, {x: -x})) == 0
        if even and whole and waves and not c.has(*q):
            return sp.cos(x) - sp.cos(c)
    return None


def _same_zeros(
    force: Expr, claimed: Expr, branch: Branch, q: Sequence[Symbol], deadline: Deadline
) -> Verdict:
    """Tell whether two expressions vanish at the same points of a domain."""
    name = "the reaction of the contact"
    ratio = sp.fraction(sp.cancel(sp.together(force / claimed)))
    if all(proved_sign(side, branch.domain) in ("+", "-") for side in ratio):
        return Verdict(Status.HOLDS, name, "exact")
    both = [
        _follows(claimed, force, "there the reaction does not vanish", branch, q, deadline),
        _follows(force, claimed, "the reaction vanishes elsewhere too", branch, q, deadline),
    ]
    return all_hold(both, name)


def _leaves_as_written(reading: Reading) -> Expr:
    """Return the claimed equation with nothing cancelled in it."""
    (text,) = reading.words("leaves")
    plain = reading.equations("leaves")[0]
    return plain if "leaves[0]" in reading.instead else parsed(as_written, text, reading.scope)


def _valued_at_zeros(
    written: Expr, force: Expr, motion: MotionOnManifold, deadline: Deadline
) -> Iterator[Verdict]:
    """Yield what speaks against an equation having a value where the reaction vanishes, nothing if it has.

    (3 cos θ − 2)²/(3 cos θ − 2) = 0 is true at no point: where the quotient could vanish it has no value. Cancelled it
    would be another equation, so it is asked as it was written, at every zero of the reaction.
    """
    risky = [h for h in hazards(anatomy([written]).parts) if h.argument.free_symbols]
    if not risky:
        return
    try:
        zeros = on_manifold([force], motion.branch.domain)
    except EmptyDomainError:
        return
    except Undecided as reason:
        why = f"whether the equation has a value where the reaction vanishes was not decided: {reason}"
        yield Verdict(Status.UNDECIDED, evidence=(Evidence("open", why),))
        return
    known: dict[Basic, Basic] = {
        s: f for s, f in {**motion.branch.values, **motion.solution}.items() if written.has(s)
    }
    for b in zeros:
        there = put_in(put_in(exchanged(written, motion.jets), known), dict(b.values.items()))
        lack = lack_of_value(there, b.domain, time.monotonic() + min(SIDE_SECONDS, deadline.left))
        if lack is not None:
            sentence = lack.sentence("the equation, where the reaction vanishes,")
            if lack.proved:
                yield fails("the equation has a value", sentence)
            yield Verdict(Status.UNDECIDED, evidence=(Evidence("open", sentence),))
        elif risk := _lacking_at_one_place(there, b.domain):
            sentence = f"the equation has no value at one of the places where the reaction vanishes: {risk}"
            yield Verdict(Status.UNDECIDED, evidence=(Evidence("open", sentence),))


def _lacking_at_one_place(there: Expr, domain: Domain) -> str:
    """Say what has no value at the first of the places that a whole number counts, as at θ = c of θ = c + 2π n."""
    for s, n in product((s for s in symbols_of(there) if s.is_integer), range(-2, 3)):
        for risk in hazards(anatomy([put_in(there, {s: sp.Integer(n)})]).parts):
            if vanishes_off_kinks(risk.argument, domain, SIDE_SECONDS).holds:
                return str(risk)
    return ""


def _follows(
    given: Expr, wanted: Expr, feedback: str, branch: Branch, q: Sequence[Symbol], deadline: Deadline
) -> Verdict:
    """Tell whether one expression vanishes wherever another does."""
    place = ""
    try:
        verdicts: list[Verdict] = []
        for b in on_manifold([given], branch.domain):
            verdicts.append(_vanishes_there(wanted, b, deadline))
            if verdicts[-1].fails:
                place = _place(b, q)
                break
        verdict = all_hold(verdicts)
    except EmptyDomainError:  # it vanishes nowhere
        return Verdict(Status.HOLDS, certificate="structure")
    except Undecided as reason:
        verdict = Verdict(Status.UNDECIDED, evidence=(Evidence("open", str(reason)),))
        for x in symbols_of(given):
            if x in q:
                found = refuted_at_a_point(
                    [given], [sp.Dummy(x.name, real=True)], [x], {"the reaction": wanted}, branch.domain
                )
                verdict = found if found is not None else verdict
    if not verdict.fails:
        return verdict
    return Verdict(
        Status.FAILS,
        verdict.question,
        verdict.certificate,
        verdict.residual,
        verdict.counterexample,
        feedback=feedback + place,
    )


def _vanishes_there(wanted: Expr, branch: Branch, deadline: Deadline) -> Verdict:
    """Tell whether an expression vanishes on a branch; one factor that does is enough."""
    factors = polynomial_factors(wanted)
    for factor, _ in factors if len(factors) > 1 else ():
        found = vanishes_off_kinks(substitute(factor, branch.values), branch.domain, budget=deadline.left / 4)
        if found.holds:
            return found
    return decide(Same((Part("the reaction", wanted, through=branch.values),), branch.domain), deadline)


def _place(branch: Branch, q: Sequence[Symbol]) -> str:
    """Say where coordinates are at a place that is given by parameters."""
    known = {x: named(f) for x, f in branch.values.items() if x in q and not f.has(*q)}
    return f", as at {', '.join(f'{x} = {shown_short(f)}' for x, f in known.items())}" if known else ""
