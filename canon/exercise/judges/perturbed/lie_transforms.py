"""Claims of perturbation theory to an order in something small: Lie series, generators, averages, normal forms.

"To order n in ε" means that the coefficients of 1, ε … εⁿ are right; what stands beyond is not looked at.
"""

from __future__ import annotations

import time
from itertools import permutations, product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.conserved import NOT_OF_THE_STATE, same_everywhere
from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.judges.perturbed.tied_parameters import with_tied_values
from canon.exercise.judges.perturbed.tori import slow_invariant
from canon.exercise.judges.small_quantities import small_symbols
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.deadline import PROOF_SECONDS
from canon.exercise.question.question import Part, Question, Same, Tells, fails, wrong_variables
from canon.exercise.question.series_expansion import check_analytic, coefficients, without_kinks
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.averaging import AveragingError, average
from canon.mechanics.perturbation.birkhoff import NormalFormError, birkhoff_normal_form
from canon.mechanics.perturbation.coefficient_field import NoExactFieldError
from canon.mechanics.perturbation.fourier_series import NoFourierSeriesError
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError
from canon.mechanics.perturbation.taylor_parts import NotAnalyticError
from canon.proof.continuity.jumps import find_jump
from canon.proof.continuity.one_sided import Cut, cuts_of
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.perturbation.averaging import Averaged
    from canon.proof.domain.domain import Domain

__all__ = [
    "adiabatic_invariant",
    "averaged_hamiltonian",
    "generator_of_first_order",
    "lie_series",
    "normal_form",
]

MOST_ORDERS = 8
LARGE = 2_000
"""Operations of an expression up to which its fractions are cancelled."""
HIGHEST_DEGREE = 12
"""Degree in (q, p) up to which a normal form is judged."""


def lie_series(reading: Reading) -> Iterator[Question]:
    """exp(ε L_W) f = Σ εᵏ L_Wᵏ f/k! with L_W f = {f, W}, coefficient by coefficient."""
    q, p = reading.phase_space("q", "p")
    small, order = _small(reading), _order(reading)
    f, W = reading.expression("f"), reading.expression("W")
    term, series = f, f
    for k in range(1, order + 1):
        term = poisson_bracket(term, W, q, p) * small / k
        series += term
    right = _sum(_coefficients(reading, series, small, order), small)
    claimed = _to_the_order(reading, "claim", small, order)
    part = Part(f"the series to order {order} in {small}", claimed, right, key="claim")
    yield Same((part,), reading.domain, lambda: right)


def generator_of_first_order(reading: Reading) -> Iterator[Question]:
    """{H₁ + {H₀, W}, H₀} = 0: the new Hamiltonian of first order is constant along the motion of H₀.

    For von Zeipel's F₂ = Σ q P + ε S it is the same with W = −S. The generator must be one function on phase space: of
    period 2π in each angle, and continuous, or the mean of H₁ would be removed too. The new Hamiltonian of first order
    must be continuous, or an angle that goes to and fro, such as asin(sin q), would remove the mean on one way.
    """
    q, p = reading.phase_space("q", "p")
    small, H, t = _small(reading), _autonomous(reading), reading.time
    H0, H1 = _coefficients(reading, H, small, 1)
    key = "W" if reading.has("W") else "F2"
    if key == "W":
        generator, parts = reading.expression("W"), list[Part]()
        if generator.has(small, t):
            reading.fault("W", "should be a function of q and p, the coefficient of the first order")
    else:
        new_p = reading.symbols("new_p")
        if len(new_p) != len(p):
            reading.fault("new_p", f"{counted(len(new_p), 'new momentum', 'new momenta')} for {len(p)} old")
        bare, S = _coefficients(reading, reading.expression("F2"), small, 1)
        yield from wrong_variables(reading.expression("F2"), (*p, t), "F2", "q and P")
        identity = sp.Add(*(x * y for x, y in zip(q, new_p, strict=True)))
        parts = [Part("F2 without the perturbation", bare, identity)]
        generator = -substitute(S, dict(zip(new_p, p, strict=True)))
    first_order = H1 + poisson_bracket(H0, generator, q, p)
    parts.append(Part("{H1 + {H0, W}, H0}", poisson_bracket(first_order, H0, q, p)))
    said = "the generator leaves terms of first order that change along the motion of the unperturbed system"
    yield Same(tuple(parts), reading.domain, None, lambda _: said)
    yield from _one_function(reading, generator, H, key)
    yield is_continuous(first_order, (*q, *p), reading.domain, "the new Hamiltonian of first order", (H,))


def _one_function(reading: Reading, f: Expr, H: Expr, key: str) -> Iterator[Question]:
    """Ask whether an answer and its slopes have one value at each place: periodic in the angles, without jumps.

    A function that grows with each turn, such as f(J) atan2(q, p), is no function on phase space, and would remove the
    mean too.
    """
    q, p = reading.phase_space("q", "p")
    for angle in _angles(reading, H, q):
        turned = Part(f"{key} after a turn of {angle}", substitute(f, {angle: angle + 2 * sp.pi}), f)
        said = f"{key} has not the period 2π in {angle}: it changes with every turn"
        yield Same((turned,), reading.domain, None, lambda _, said=said: said)
    variables = (*q, *p)
    yield is_continuous(f, variables, reading.domain, key, (H,))
    slopes = {f"∂{key}/∂{z}": f.diff(z) for z in variables}
    windings = [_winding(slope, variables, reading.domain, name) for name, slope in slopes.items()]
    wound = [verdict for verdict in windings if verdict is not None]
    if wound:
        yield min(wound, key=lambda verdict: verdict.undecided)


def _winding(f: Expr, variables: Sequence[Symbol], domain: Domain, name: str) -> Verdict | None:
    """Tell whether an arc in a function jumps, such as atan(q/p) where p = 0: an angle that winds is no function.

    None where there is no such arc; UNDECIDED where there is one, and no jump was found.
    """
    question = f"{name} has one value at each place"
    if _arcs(f, variables) and sp.count_ops(f) < LARGE:
        f = cast("Expr", sp.cancel(f))  # d atan(q/p) has 1/p in it, and no pole there
    arcs = _arcs(f, variables)
    for cut in arcs:
        jump = find_jump(f, cut, variables, domain, time.monotonic() + PROOF_SECONDS)
        if jump is not None:
            where = ", ".join(f"{s} = {value}" for s, value in jump.point.items())
            return fails(
                question,
                f"{name} jumps at {where} from {jump.before} to {jump.after}: it is not one function",
            )
    if not arcs:
        return None
    why = f"whether {name} has one value was not decided, as it holds {arcs[0].part}; write it without"
    return Verdict(Status.UNDECIDED, question, evidence=(Evidence("open", why),), feedback=why)


def _arcs(f: Expr, variables: Sequence[Symbol]) -> list[Cut]:
    return [cut for cut in cuts_of(f, variables) if isinstance(cut.part, sp.atan | sp.acot | sp.atan2)]


def _angles(reading: Reading, H: Expr, q: Sequence[Symbol]) -> tuple[Symbol, ...]:
    """Return the coordinates that are named as angles, and those in which H has the period 2π.

    Where angles are named, one that H does not hold and that rests without the perturbation is a slow coordinate: what
    grows with it removes no mean.
    """
    named = reading.subset("angles", "q") if reading.has("angles") else ()
    momentum = dict(zip(*reading.phase_space("q", "p"), strict=True))
    moves = substitute(H, {_small(reading): sp.S.Zero}) if named else sp.S.Zero
    slow = {x for x in q if named and not H.has(x) and not moves.has(momentum[x])}
    return tuple(x for x in q if x in named or (x not in slow and _has_period(H, x, reading)))


def _has_period(H: Expr, x: Symbol, reading: Reading) -> bool:
    turned = substitute(H, {x: x + 2 * sp.pi})
    return vanishes_off_kinks(turned - H, reading.domain, budget=PROOF_SECONDS).holds


def averaged_hamiltonian(reading: Reading) -> Iterator[Question]:
    """K is the average of H over fast angles to an order, in the new variables under the names of the old ones.

    Which terms are in resonance the domain decides too.
    """
    q, p = reading.phase_space("q", "p")
    small, order, t = _small(reading), _order(reading), reading.time
    H, fast = _autonomous(reading), reading.subset("angles", "q")
    expanded = _coefficients(reading, H, small, order)
    try:
        averaged = average(
            Hamiltonian(_sum(expanded, small), q, p, t), fast, order, small, domain=reading.domain
        )
    except (AveragingError, NoFourierSeriesError) as reason:
        raise Undecided(f"the average was not found: {reason}") from None
    unique = _unique_orders(averaged, reading.expression("K"), order)
    if unique < order:
        yield _averaged_to(reading, averaged, unique)
        claimed = _to_the_order(reading, "K", small, order)
        if not vanishes_off_kinks(claimed - averaged.K, reading.domain, budget=PROOF_SECONDS).holds:
            raise Undecided(
                f"to order {unique} K is right; beyond, it depends on which generator is taken, as there are slow "
                "variables: canon takes the one without a mean over the fast angles, whose K is another one"
            )
    yield _averaged_to(reading, averaged, order)


def _averaged_to(reading: Reading, averaged: Averaged, order: int) -> Same:
    """Return the question whether K is the average to an order."""
    right = _sum(averaged.terms[: order + 1], averaged.small)
    claimed = _to_the_order(reading, "K", averaged.small, order)
    part = Part(f"K to order {order} in {averaged.small}", claimed, right, key="K")
    return Same((part,), reading.domain, lambda: right)


def _unique_orders(averaged: Averaged, K: Expr, order: int) -> int:
    """Return up to which order K is the same for all generators: the first where slow variables stand in it."""
    slow = {*averaged.source.q, *averaged.source.p} - {*averaged.actions}
    if len(averaged.angles) == 1:
        slow -= {*averaged.angles}
    return 1 if any(f.has(*slow) for f in (*averaged.terms, K)) else order


def normal_form(reading: Reading) -> Iterator[Question]:
    """K, as a function of the actions, is the normal form of H at the origin to a degree, with H there or without."""
    q, p = reading.phase_space("q", "p")
    H, t, actions = with_tied_values(reading, _autonomous(reading)), reading.time, reading.symbols("actions")
    degree = reading.claim.keys["degree"]
    if degree != int(degree) or not 2 <= degree <= HIGHEST_DEGREE or degree % 2:
        reading.fault("degree", f"should be an even number from 2 to {HIGHEST_DEGREE}, the degree in q and p")
    if len(actions) != len(q):
        reading.fault("actions", f"{counted(len(actions), 'action')} for {counted(len(q), 'coordinate')}")
    K = reading.expression("K")
    yield from wrong_variables(K, (*q, *p, t), "K", "the actions")
    try:
        form = birkhoff_normal_form(Hamiltonian(H, q, p, t), int(degree))
        known = form.in_actions()
    except (NormalFormError, NoDiagonalFormError, NoExactFieldError, NotAnalyticError) as reason:
        raise Undecided(f"the normal form was not found: {reason}") from None
    if not all(form.diagonal.is_elliptic(j) for j in range(len(q))):
        raise Undecided(
            "the origin is no elliptic equilibrium, so that K is no function of actions (q² + p²)/2: a pair grows "
            "and decays exponentially"
        )
    right = substitute(known, dict(zip(form.actions, actions, strict=True)))
    yield _same_polynomials(reading, K, right, actions, int(degree) // 2)


def _same_polynomials(
    reading: Reading, K: Expr, right: Expr, actions: Sequence[Symbol], degree: int
) -> Question:
    """Return whether K has the right coefficients up to a degree; which pair is called the first is free.

    The energy at rest may be left out.
    """
    none = (0,) * len(actions)
    exponents = [e for e in product(range(degree + 1), repeat=len(actions)) if 1 <= sum(e) <= degree]
    claimed, known = (_taylor(reading, f, actions, [*exponents, none]) for f in (K, right))
    rest = known[none]
    turns = [
        {e: known[tuple(e[i] for i in turn)] for e in exponents} for turn in permutations(range(len(actions)))
    ]
    linear = [e for e in exponents if sum(e) == 1]
    fitting = [turn for turn in turns if _agree(reading, linear, claimed, turn)] or turns[:1]
    wanted = next((turn for turn in fitting if _agree(reading, exponents, claimed, turn)), fitting[0])
    wanted |= {none: sp.S.Zero if _agree(reading, [none], claimed, {none: sp.S.Zero}) else rest}
    truncated, answer = (
        sp.Add(*(c * sp.Mul(*(J**k for J, k in zip(actions, e, strict=True))) for e, c in series.items()))
        for series in (claimed, wanted)
    )
    written = K if sp.expand(K - truncated) == 0 else truncated
    part = Part(f"K to degree {2 * degree} in q and p", written, answer, key="K")
    return Same((part,), reading.domain, lambda: answer)


def _agree(
    reading: Reading,
    exponents: Iterable[tuple[int, ...]],
    claimed: Mapping[tuple[int, ...], Expr],
    wanted: Mapping[tuple[int, ...], Expr],
) -> bool:
    return all(
        vanishes_off_kinks(claimed[e] - wanted[e], reading.domain, budget=PROOF_SECONDS).holds
        for e in exponents
    )


def _taylor(
    reading: Reading, f: Expr, actions: Sequence[Symbol], exponents: Iterable[tuple[int, ...]]
) -> dict[tuple[int, ...], Expr]:
    """Return Taylor's coefficients of a function of the actions at zero."""
    place: dict[Symbol, Expr] = dict.fromkeys(actions, sp.S.Zero)
    f = without_kinks(f, place, reading.domain)
    check_analytic(f, place, reading.domain)
    found: dict[tuple[int, ...], Expr] = {}
    for e in exponents:
        slope = f
        for J, k in zip(actions, e, strict=True):
            slope = slope.diff(J, k) if k else slope
        found[e] = substitute(slope, place) / sp.Mul(*map(sp.factorial, e))
    return found


def adiabatic_invariant(reading: Reading) -> Iterator[Question]:
    """{I, H} + ε ∂I/∂τ = O(εⁿ⁺¹) with the slow time τ = ε t; to lowest order I is a function of the action.

    To lowest order, n = 0, the rate has terms of first order, whose mean over the fast motion vanishes (V. I. Arnold,
    Mathematical Methods of Classical Mechanics, section 52 F).
    """
    q, p = reading.phase_space("q", "p")
    small, t, slow = _small(reading), reading.time, reading.symbols("slow")
    order = _order(reading, least=0) if reading.has("order") else 0 if slow else 1
    H, I = reading.expression("H"), reading.expression("I")
    for key, f in (("H", H), ("I", I)):
        if f.has(t):
            reading.fault(key, f'depends on {t}; write the slow time as a name of its own, slow = "tau"')
    if len(slow) > 1 or (order == 0 and not slow):
        reading.fault("slow", "one slow time is wanted; without one, claim an order from 1")
    (I_0, *_), (H_0, *_) = (_coefficients(reading, f, small, 0) for f in (I, H))
    yield Tells((same_everywhere((I_0,), (*q, *p), reading.domain),), NOT_OF_THE_STATE)
    rate = _rate_of_two_scales(reading, I, H, small) + sp.Add(*(small * I.diff(tau) for tau in slow))
    coefficients = _coefficients(reading, rate, small, order)
    parts = tuple(
        Part(f"dI/dt to order {k} in {small}" if k else f"dI/dt at {small} = 0", c)
        for k, c in enumerate(coefficients)
    )
    yield Same(
        parts, reading.domain, None, lambda part: f"{part.name} does not vanish: {shown_short(part.claimed)}"
    )
    yield from _one_function(reading, I, H, "I")
    if order == 0:
        yield from (found for tau in slow for found in slow_invariant(reading, I_0, tau, H, H_0))


def _rate_of_two_scales(reading: Reading, I: Expr, H: Expr, small: Symbol) -> Expr:
    """Return {I, H} of the fast pairs + ε {I, H} of the pairs whose coordinates are named under slow_q."""
    q, p = reading.phase_space("q", "p")
    slow = reading.subset("slow_q", "q") if reading.has("slow_q") else ()
    rate = sp.S.Zero
    for x, y in zip(q, p, strict=True):
        rate += poisson_bracket(I, H, [x], [y]) * (small if x in slow else 1)
    return rate


def _autonomous(reading: Reading) -> Expr:
    """Return H, which must not depend on the time."""
    H, t = reading.expression("H"), reading.time
    if H.has(t):
        reading.fault("H", f"depends on {t}; take the phase as an angle with a momentum of its own")
    return H


def _small(reading: Reading) -> Symbol:
    found = small_symbols(reading)
    if len(found) != 1:
        reading.fault("small", "should be one name")
    return found[0]


def _order(reading: Reading, least: int = 1) -> int:
    order = reading.claim.keys.get("order", 1)
    if order != int(order) or not least <= order <= MOST_ORDERS:
        reading.fault("order", f"should be a whole number from {least} to {MOST_ORDERS}")
    return int(order)


def _coefficients(reading: Reading, f: Expr, small: Symbol, order: int) -> list[Expr]:
    """Return the coefficients of 1, ε … of a function that is analytic at ε = 0."""
    place = {small: sp.S.Zero}
    f = without_kinks(f, place, reading.domain)
    check_analytic(f, place, reading.domain)
    return coefficients(f, small, order)


def _sum(coefficients: Sequence[Expr], small: Symbol) -> Expr:
    """Return c₀ + c₁ ε + … ."""
    return sp.Add(*(c * small**k for k, c in enumerate(coefficients)))


def _to_the_order(reading: Reading, key: str, small: Symbol, order: int) -> Expr:
    """Return an answer without its terms beyond the order; as it was written where it has none."""
    f = reading.expression(key)
    truncated = _sum(_coefficients(reading, f, small, order), small)
    return f if sp.expand(f - truncated) == 0 else truncated
