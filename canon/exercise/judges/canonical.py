"""Claims about brackets, canonical maps, generating functions and the new Hamiltonian."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.question.answer import open_brackets
from canon.exercise.question.answer_values import what_may_vanish, without_value_on
from canon.exercise.question.continuous_answer import is_continuous
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.generating_answer import generating_function_of
from canon.exercise.question.implicit_point import refuted_at_a_point, solved_somewhere
from canon.exercise.question.question import (
    Determines,
    Part,
    Question,
    Regular,
    Same,
    decide,
    fails,
    wrong_variables,
)
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError, inhabited, on_manifold, transported
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.map_branches import near_the_identity, over_the_old
from canon.mechanics.hamilton.bracket import lagrange_bracket, lie_bracket, poisson_bracket, symplectic_unit
from canon.mechanics.hamilton.pfaffian_form import bilinear_covariant, displacements
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.algebra.constraint_manifold import Branch
    from canon.proof.domain.domain import Domain

__all__ = [
    "bilinear",
    "canonicity",
    "generating",
    "lagrange_brackets",
    "lie_brackets",
    "new_hamiltonian",
    "poisson_brackets",
]


def poisson_brackets(reading: Reading) -> Iterator[Question]:
    """{f, g} is what was claimed, for all pairs."""
    q, p = reading.phase_space("q", "p")
    pairs = reading.brackets("f", "g")
    parts = tuple(
        Part(f"{{f, g}} of pair {i}", value, poisson_bracket(f, g, q, p), key=f"pairs[{i - 1}].value")
        for i, (f, g, value) in enumerate(pairs, 1)
    )
    yield Same(parts, reading.domain)
    firsts, seconds = (tuple(dict.fromkeys(pair[i] for pair in pairs)) for i in (0, 1))
    wanted = tuple(product(firsts, seconds))
    yield Determines(lambda: open_brackets(wanted, [(f, g) for f, g, _ in pairs]))


def lagrange_brackets(reading: Reading) -> Iterator[Question]:
    """[u, v] is what was claimed, for all pairs."""
    variables, q = reading.symbols("variables"), reading.expressions("q")
    p = reading.expressions("p")
    if len(p) != len(q):
        reading.fault("p", f"{counted(len(p), 'momentum', 'momenta')} for {counted(len(q), 'coordinate')}")
    parts: list[Part] = []
    pairs = reading.brackets("u", "v")
    for i, (u, v, value) in enumerate(pairs):
        for letter, symbol in (("u", u), ("v", v)):
            if symbol not in variables:
                reading.fault(f"pairs[{i}].{letter}", f"{symbol} is not one of the variables")
        bracket = sp.Add(*(a.diff(u) * b.diff(v) - a.diff(v) * b.diff(u) for a, b in zip(q, p, strict=True)))
        parts.append(Part(f"[{u}, {v}]", value, bracket, key=f"pairs[{i}].value"))
    yield Same(tuple(parts), reading.domain)
    wanted = tuple(combinations(variables, 2))
    yield Determines(lambda: open_brackets(wanted, [(u, v) for u, v, _ in pairs]))


def lie_brackets(reading: Reading) -> Iterator[Question]:
    """[X, Y] is what was claimed, component by component."""
    x = reading.symbols("x")
    X, Y, claim = (reading.expressions(key, like="x") for key in ("X", "Y", "claim"))
    right = lie_bracket(X, Y, x)
    parts = tuple(
        Part(f"component {s}", c, r, key=f"claim[{i}]")
        for i, (s, c, r) in enumerate(zip(x, claim, right, strict=True))
    )
    yield Same(parts, reading.domain, lambda: right)


def canonicity(reading: Reading) -> Iterator[Question]:
    """M J Mᵀ = c J for an explicit map, or for one that equations define."""
    valence = reading.expression("valence", sp.S.One)
    q, p = reading.phase_space("q", "p")
    if reading.has("valence"):
        if valence.has(*q, *p):
            reading.fault("valence", "a valence is the same at all points: it can't depend on q and p")
        yield Regular(
            sp.Matrix([[valence]]), "the valence", reading.domain, "the valence is zero", exceptions=True
        )
    if reading.has("implicit"):
        yield from _implicit_canonicity(reading, q, p, valence)
    else:
        Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
        yield Same(canonical_parts(Q, P, q, p, valence), reading.domain)


def canonical_parts(
    Q: Sequence[Expr], P: Sequence[Expr], q: Sequence[Symbol], p: Sequence[Symbol], valence: Expr = sp.S.One
) -> tuple[Part, ...]:
    """Return {Q, Q} = {P, P} = 0 and {Q, P} = c as parts, the diagonal first."""
    n = len(q)
    names = [f"{letter}{i + 1 if n > 1 else ''}" for letter in "QP" for i in range(n)]
    pairs = sorted(combinations(range(2 * n), 2), key=lambda pair: pair[1] - pair[0] != n)
    new = (*Q, *P)
    return tuple(
        Part(
            f"{{{names[i]}, {names[j]}}}",
            poisson_bracket(new[i], new[j], q, p),
            valence if j - i == n else sp.S.Zero,
            bracket_of=(names[i], names[j]),
        )
        for i, j in pairs
    )


def _implicit_canonicity(
    reading: Reading, q: Sequence[Symbol], p: Sequence[Symbol], valence: Expr
) -> Iterator[Question]:
    """G(z, Z) = 0: with A = ∂G/∂Z and B = ∂G/∂z the map has M = −A⁻¹B, and M J Mᵀ = c J says B J Bᵀ = c A J Aᵀ."""
    Q, P = reading.phase_space("new_q", "new_p")
    if len(Q) != len(q):
        reading.fault("new_q", f"{counted(len(Q), 'new coordinate')} for {len(q)} old; give one each")
    equations = reading.equations("implicit")
    if len(equations) != 2 * len(q):
        reading.fault("implicit", f"{counted(len(equations), 'equation')} for {2 * len(q)} new variables")
    old, new = (*q, *p), (*Q, *P)
    A = sp.Matrix([[g.diff(z) for z in new] for g in equations])
    B = sp.Matrix([[g.diff(z) for z in old] for g in equations])
    J = symplectic_unit(len(q))
    difference = B * J * B.T - valence * A * J * A.T
    entries: list[Expr] = [difference[i, j] for i, j in combinations(range(2 * len(q)), 2)]
    keep = set(reading.scope.names.values()) - {*old, *new} | {reading.time}
    yield _defines_a_map(equations, old, new, tuple(keep), reading.domain)
    yield from _valued_on_the_map(reading, equations, old, new, tuple(keep))
    if all(sp.expand(entry) == 0 for entry in entries):
        yield Regular(A, "∂(equations)/∂(new variables)", reading.domain)
        return
    try:
        branches = on_manifold(equations, reading.domain, keep=tuple(keep), prefer=(*new, *old))
    except Undecided:
        wanted = {f"M J Mᵀ − c J, {i + 1}": entry for i, entry in enumerate(entries)}
        found = refuted_at_a_point(equations, old, new, wanted, reading.domain)
        if found is None:
            raise
        yield found
        return
    if len(branches) > 1:
        branches = over_the_old(branches, old, new)
        branches = near_the_identity(equations, branches, old, new, reading.domain) or branches
    asked = [_canonicity_on(branch, A, entries) for branch in branches]
    _check_agreement(asked, Deadline.after(reading.claim.budget / 4))
    for questions in asked:
        yield from questions


def _canonicity_on(branch: Branch, A: sp.Matrix, entries: Sequence[Expr]) -> tuple[Question, Question]:
    """Return the questions whether equations determine a map on a branch of their solutions, a canonical one."""
    there = A.applyfunc(lambda entry: substitute(entry, branch.values))
    parts = tuple(Part("M J Mᵀ − c J", entry, through=branch.values) for entry in entries)
    return Regular(there, "∂(equations)/∂(new variables)", branch.domain), Same(parts, branch.domain)


def _check_agreement(asked: Sequence[Sequence[Question]], deadline: Deadline) -> None:
    """Refuse equations of which one solution is a canonical map and another is none.

    Raises
    ------
    Undecided
        Where they are not of one kind, and the one near the identity was not told apart.
    """
    verdicts = [[decide(q, deadline) for q in each] for each in asked] if len(asked) > 1 else []
    wrong = any(verdict.fails for each in verdicts for verdict in each)
    if wrong and any(all(verdict.holds for verdict in each) for each in verdicts):
        raise Undecided(
            "the equations have several solutions, of which only some are canonical, and which one is near the "
            "identity was not decided; give the range of the step in the box, or equations that have one solution"
        )


def _valued_on_the_map(
    reading: Reading,
    equations: Sequence[Expr],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    keep: Sequence[Symbol],
) -> Iterator[Verdict]:
    """Yield what speaks against equations having values where they hold; a point at which they have some speaks for."""
    open_ = [
        u
        for u in what_may_vanish(reading, "implicit", new)
        if refuted_at_a_point(equations, old, new, {"": u}, reading.domain) is None
    ]
    if not open_:
        return
    try:
        branches = on_manifold(equations, reading.domain, keep=keep, prefer=(*new, *old))
    except Undecided:
        if any(equation.has(AppliedUndef) for equation in equations):  # of which no point is looked at
            return
        raise
    seen = [(branch.values, branch.domain) for branch in branches]
    yield from without_value_on(reading, "implicit", new, lambda: seen, "on the map")


def _defines_a_map(
    equations: Sequence[Expr],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    keep: Sequence[Symbol],
    domain: Domain,
) -> Verdict:
    """Tell whether equations have a regular solution at all: without one they are no map, canonical or not."""
    question = "the equations define a map"
    if solved_somewhere(equations, old, new, domain):
        return Verdict(Status.HOLDS, question, "ball")
    try:
        inhabited(on_manifold(equations, domain, keep=keep, prefer=(*new, *old)))
    except EmptyDomainError:
        return fails(question, "these equations define no map: they have no real solution")
    except Undecided:
        pass
    open_ = "it was not shown that the equations have a real solution, and thus define a map"
    return Verdict(Status.UNDECIDED, question, evidence=(Evidence("open", open_),))


def bilinear(reading: Reading) -> Iterator[Question]:
    """The bilinear covariant of a Pfaffian form, or its invariance under a map."""
    if reading.has("form"):
        x = reading.symbols("x")
        d, delta = displacements(x)
        extended = reading.with_names({s.name: s for s in (*d, *delta)})
        form = reading.expressions("form", like="x")
        right = bilinear_covariant(form, x, d, delta)
        yield Same(
            (Part("the bilinear covariant", extended.expression("claim"), right, key="claim"),),
            reading.domain,
            lambda: right,
        )
        return
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    factor, n, z = reading.expression("factor"), len(q), (*q, *p)
    parts = tuple(
        Part(
            f"the coefficient of δ{z[j]} d{z[i]} − d{z[j]} δ{z[i]}",
            factor if j - i == n else sp.S.Zero,
            lagrange_bracket(z[i], z[j], Q, P),
        )
        for i, j in sorted(combinations(range(2 * n), 2), key=lambda pair: pair[1] - pair[0] != n)
    )
    yield Same(parts, reading.domain)


def generating(reading: Reading) -> Iterator[Question]:
    """The rules of the type hold identically on the map, and the mixed Hessian is regular."""
    number, F = reading.kind.implied["type"], reading.expression("F")
    there, domain = map_values(reading)
    rules = rules_of(reading, number, F)
    on_the_map = substitute(F, there)
    independent = [z for key in ("q", "p", "new_q", "new_p") for z in reading.symbols(key)]
    yield Same(rules.on(there), domain, lambda: generating_function_of(reading, number), answers="F")
    yield Regular(
        rules.mixed_hessian.applyfunc(lambda entry: substitute(entry, there)),
        "the mixed Hessian",
        domain,
        f"the mixed Hessian ∂²F/∂{rules.old[0]}∂{rules.new[0]} is singular: F of type {number} generates no map",
    )
    foreign = ", ".join(sorted(str(s) for s in F.free_symbols & set(rules.foreign)))
    if foreign:
        why = f"F of type {number} depends on {foreign}, and may depend on {rules.old + rules.new} only"
        yield Verdict(Status.FAILS, "the variables of F", certificate="structure", residual=F, feedback=why)
        return
    yield is_continuous(on_the_map, (*independent, reading.time), domain, "F", there.values())


@dataclass(frozen=True)
class Rules:
    """The rules of one type of generating function.

    Parameters
    ----------
    old, new
        The variables F depends on.
    foreign
        The variables that the rules give.
    mixed_hessian
        ∂²F/∂old ∂new.
    texts, values
        Each rule in words, and the derivative of F in it, for the variables in ``foreign``.
    """

    old: tuple[Symbol, ...]
    new: tuple[Symbol, ...]
    foreign: tuple[Symbol, ...]
    mixed_hessian: sp.Matrix
    texts: tuple[str, ...]
    values: tuple[Expr, ...]

    def on(self, there: Mapping[Symbol, Expr]) -> tuple[Part, ...]:
        """Return the rules as parts, on a map."""
        return tuple(
            Part(text, value, substitute(variable, there), there)
            for text, value, variable in zip(self.texts, self.values, self.foreign, strict=True)
        )


def rules_of(reading: Reading, number: int, F: Expr) -> Rules:
    """Return the rules of a generating function of type 1, 2, 3 or 4."""
    q, p, Q, P = (reading.symbols(key) for key in ("q", "p", "new_q", "new_p"))
    old, other_old, old_sign = (q, p, 1) if number in (1, 2) else (p, q, -1)
    new, other_new, new_sign = (Q, P, -1) if number in (1, 3) else (P, Q, 1)
    given = [(y, x, old_sign) for y, x in zip(other_old, old, strict=True)]
    given += [(y, x, new_sign) for y, x in zip(other_new, new, strict=True)]
    return Rules(
        old,
        new,
        (*other_old, *other_new),
        sp.Matrix([[F.diff(a).diff(b) for b in new] for a in old]),
        tuple(f"{y} = {'−' if sign < 0 else ''}∂F/∂{x}" for y, x, sign in given),
        tuple(sign * F.diff(x) for _, x, sign in given),
    )


def map_values(reading: Reading) -> tuple[dict[Symbol, Expr], Domain]:
    """Return what the dependent variables are on the map, and the domain in the independent ones."""
    q, p = reading.phase_space("q", "p")
    Q, P = reading.phase_space("new_q", "new_p")
    if len(Q) != len(q):
        reading.fault("new_q", f"{counted(len(Q), 'new coordinate')} for {len(q)} old; give one each")
    if reading.has("map"):
        dependent, images = (*Q, *P), reading.lists("map", {"Q": "new_q", "P": "new_p"})
        key = "map"
    else:
        dependent, images = (*q, *p), reading.lists("inverse_map", {"q": "q", "p": "p"})
        key = "inverse_map"
    flat = [f for image in images for f in image]
    if any(f.has(*dependent) for f in flat):
        reading.fault(key, "the variables on the left can't occur in the expressions")
    there = dict(zip(dependent, flat, strict=True))
    return there, transported(reading.domain, there)


def new_hamiltonian(reading: Reading) -> Iterator[Question]:
    """The map is canonical and ∂_t Z = {Z, K − H} for each new variable Z, which fixes K up to a function of t.

    With the inverse map the same is asked of the old variables, the parts of H and K exchanged.
    """
    there, domain = map_values(reading)
    before, after, t = reading.expression("H"), reading.expression("K"), reading.time
    old, new = ("q", "p"), ("new_q", "new_p")
    if reading.has("inverse_map"):
        old, new, before, after = new, old, after, before
    q, p = reading.phase_space(*old)
    names = (*reading.symbols(new[0]), *reading.symbols(new[1]))
    images = [there[name] for name in names]
    n = len(q)
    yield from wrong_variables(
        reading.expression("K"), (*reading.symbols("q"), *reading.symbols("p")), "K", "Q, P and t"
    )
    yield Same(canonical_parts(images[:n], images[n:], q, p), domain)
    difference = substitute(after, there) - before
    parts = tuple(
        Part(f"the equation of {name}", poisson_bracket(image, difference, q, p), image.diff(t))
        for name, image in zip(names, images, strict=True)
    )
    yield Same(parts, domain)
    yield is_continuous(difference, (*q, *p), domain, "K", images)
