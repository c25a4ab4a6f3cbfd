"""Continuity: proved, refuted by a certified jump, or not known.

Derivatives do not show a jump: sign(q), atan(1/q) + atan(q) and q − atan(tan(πq))/π have the derivatives of a constant
function wherever they have any. A jump is a fault where a continuous function with the same differential exists. The
differential of an angle such as atan(q/p) is regular but for the place p = q = 0 around which the angle winds: no
continuous function has it, and such an angle is taken as it is.
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.analytic import is_positive_between, is_uncut, proved_sign
from canon.proof.continuity.beside_poles import meet_beside_poles
from canon.proof.continuity.branching import open_surfaces
from canon.proof.continuity.constant_steps import Fault, nonzero, step_between_pieces
from canon.proof.continuity.hidden_jumps import hidden_jump
from canon.proof.continuity.jumps import Jump, continued, find_jump, real_sides
from canon.proof.continuity.one_sided import (
    Cut,
    cuts_of,
    off_the_kinks,
    proportion,
    with_moduli,
    without_complex_logarithms,
    without_functions_of_parameters,
)
from canon.proof.continuity.smooth import PIECED
from canon.proof.continuity.winding_centre import centre_of
from canon.proof.continuity.windings import turns_undone
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.reality import certainly_real
from canon.proof.domain.relations import parts_of
from canon.proof.domain.verdict import Counterexample, Evidence, Status, Verdict
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.sympy_types import arguments, free_symbols
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["continuity", "meets"]

CONTINUOUS = "is continuous"
LARGE = 2000
"""Size of an expression that is still multiplied out."""
LOOKED_AT = 3.0
"""Seconds for one question about a surface where a function branches."""
FEW = 4
"""Terms of which every sum is looked at."""


def continuity(
    f: Expr,
    variables: Iterable[Symbol],
    domain: Domain = EVERYWHERE,
    budget: float = 20.0,
    name: str = "",
    given: Iterable[Expr] = (),
    *,
    angles: bool = True,
) -> Verdict:
    """Tell whether a function is continuous wherever it has a value near both sides, poles left aside.

    It may jump only where a function with pieces has its cuts, where both continuations must be proved equal, and where
    roots and logarithms branch or a function is taken of a pole, where :mod:`canon.proof.continuity.branching` must
    prove it. What is not real on one side of such a surface is claimed on the other only.

    Parameters
    ----------
    f
        The function.
    variables
        What it depends on; other symbols are parameters.
    domain
        Where it should be continuous.
    budget
        Seconds.
    name
        What a person would call it.
    given
        Functions that are given and may jump: where they do, so may this one.
    angles
        Whether angles that wind are taken as they are; otherwise they should not jump either.

    Returns
    -------
    Verdict
        FAILS with the place of a certified jump; UNDECIDED where the function may jump; HOLDS otherwise, with the
        angles named in ``assumed`` that are taken as they are.

    Examples
    --------
    >>> q, p = sp.symbols("q p", real=True)
    >>> continuity(q - sp.atan(sp.tan(sp.pi * q)) / sp.pi, [q]).feedback
    'q - atan(tan(pi*q))/pi jumps at q = 1/2 from 0 to 1, which its derivatives do not show'
    >>> continuity(sp.atan(q / p), [q, p]).assumed
    ('atan(q/p) is an angle that winds around p = 0, q = 0; where it jumps is a matter of choice',)
    """
    deadline, moving, name = time.monotonic() + budget, tuple(variables), name or str(f)
    given = tuple(given)
    f = without_functions_of_parameters(f, moving, domain)
    f = without_complex_logarithms(with_moduli(off_the_kinks(f)))
    f = sp.expand_mul(f) if anatomy([f]).tree <= LARGE else f
    terms = [t for t in sp.Add.make_args(f) if t.has(*moving)]
    rough = [term for term in terms if _is_rough(term, moving, domain)]
    excused = _excused(rough, given, moving, domain, deadline)
    rough = [term for term in rough if term not in excused]
    beside = sp.Add(f, *(-term for term in rough))
    found = _of_cuts(sp.Add(*rough), beside, moving, domain, deadline, name, angles=angles)
    found = replace(found, assumed=(*found.assumed, *(text.format(name) for text in excused.values())))
    if found.fails:
        return found
    step = _step(rough, [*excused], moving, domain, deadline)
    if step is not None:
        return _failed(name, step)
    if found.holds:
        found = _through_branches(f, found, given, moving, domain, deadline, name)
    if found.holds and rough and time.monotonic() > deadline:
        why = f"whether {name} jumps was not decided in {budget:g} s"
        return Verdict(Status.UNDECIDED, found.question, evidence=(Evidence("open", why),), feedback=why)
    return found


def _step(
    rough: Sequence[Expr], excused: Sequence[Expr], moving: Sequence[Symbol], domain: Domain, deadline: float
) -> Fault | None:
    """Return a step of a sum of some terms whose derivatives vanish, on one side of where terms are excused."""
    borders = _gaps_of(excused, moving, domain)
    both: list[tuple[Expr, Sequence[Expr]]] = [(part, ()) for part in _parts(rough, moving)]
    both += [(part, borders) for part in _parts([*rough, *excused], moving)] if excused else []
    steps = (step_between_pieces(part, moving, domain, deadline, between) for part, between in both)
    return next((step for step in steps if step is not None), None)


def _through_branches(
    f: Expr,
    found: Verdict,
    given: Sequence[Expr],
    moving: Sequence[Symbol],
    domain: Domain,
    deadline: float,
    name: str,
) -> Verdict:
    """Tell of what is continuous at its cuts whether it is so where it branches, and at poles inside functions."""
    surfaces = open_surfaces(f, moving, domain)
    given = [without_complex_logarithms(g) for g in given]
    excused = {s.gap for g in (given if surfaces else ()) for s in open_surfaces(g, moving, domain)}
    assumed: list[str] = []
    left: list[Expr] = []
    for surface in surfaces:
        if surface.gap in excused:
            assumed.append(f"{name} may jump where {surface.gap} = 0, as what is given does")
            continue
        until = min(deadline, time.monotonic() + LOOKED_AT)
        real = None if f.has(sp.I) else real_sides(f, surface.gap, moving, domain, until)
        if real == 1:
            assumed.append(f"{name} is claimed where it is real")
        elif real != 0:
            until = min(deadline, time.monotonic() + LOOKED_AT)
            jump = hidden_jump(f, surface, moving, domain, until)
            if jump is not None:
                return _failed(name, _fault_of(jump))
            left.append(surface.gap)
    if left:
        where = " or ".join(f"{gap} = 0" for gap in left)
        why = (
            f"{name} may jump where {where}, which its derivatives do not show; narrow the domain to one side"
        )
        return Verdict(Status.UNDECIDED, found.question, evidence=(Evidence("open", why),), feedback=why)
    return replace(found, assumed=tuple(dict.fromkeys((*found.assumed, *assumed))))


def _failed(name: str, fault: Fault) -> Verdict:
    return Verdict(
        Status.FAILS,
        f"{name} {CONTINUOUS}",
        "ball",
        counterexample=Counterexample(fault.point, fault.before, fault.after, 8),
        feedback=f"{name} {fault.said}, which its derivatives do not show",
    )


def _is_rough(term: Expr, moving: Sequence[Symbol], domain: Domain) -> bool:
    """Tell whether a term may jump, or is of more than one piece, as logarithms of what may be negative are."""
    cuts = _open_cuts(term, moving, domain)
    if any(not cut.bends for cut in cuts):
        return True
    if _is_divided(term, moving, domain) and (cuts or _touching_roots(term, moving, domain)):
        return True
    return any(_is_pieced(part, domain) for part in term.atoms(sp.Function, sp.Pow) if part.has(*moving))


def _is_divided(term: Expr, moving: Sequence[Symbol], domain: Domain) -> bool:
    """Tell whether a term has a denominator that may vanish; at places that the domain leaves out too."""
    domain = Domain(tuple(c for c in parts_of(domain.conditions) if not isinstance(c, sp.Ne)))
    poles = [p.base for p in term.atoms(sp.Pow) if p.exp.is_negative and p.has(*moving)]
    return not all(
        proved_sign(base, domain) in ("+", "-") or is_positive_between(base, domain) for base in poles
    )


def _open_cuts(f: Expr, moving: Sequence[Symbol], domain: Domain) -> list[Cut]:
    """Return the cuts whose surface is not proved to lie outside the domain or to be touched only."""
    found: dict[Expr, str] = {}
    left: list[Cut] = []
    for cut in cuts_of(f, moving):
        sign = found.get(cut.gap)
        if sign is None:
            sign = found[cut.gap] = proved_sign(cut.gap, domain)
        beyond = "" if cut.beyond is None else proved_sign(cut.beyond, domain)
        apart = sign in ("+", "-") or beyond == "+"
        touched = not apart and (sign != "" or beyond == "0+")
        if not (apart or touched) or (touched and _vanish_on_a_surface(cut, moving, domain)):
            left.append(cut)
    return left


def _vanish_on_a_surface(cut: Cut, moving: Sequence[Symbol], domain: Domain) -> bool:
    """Tell whether y ≥ 0 and x of atan2(y, x) may vanish together on a whole surface, as |q| and q do."""
    if cut.around is None or cut.beyond is None:
        return False
    present = [s for s in moving if any(side.has(s) for side in cut.around)]
    if proved_sign(sp.expand(sp.Add(*(side**2 for side in cut.around))), domain) == "+":
        return False
    return len(present) == 1 or any(inner.bends for side in cut.around for inner in cuts_of(side, moving))


def _touching_roots(term: Expr, moving: Sequence[Symbol], domain: Domain) -> list[Expr]:
    """Return roots whose radicand may come down to zero on a surface and rise again, as 1 − sin² does.

    Of |u| with a slope that does not vanish both sides are looked at by its cut.
    """
    roots = [p for p in term.atoms(sp.Pow) if p.exp.is_integer is False and p.base.has(*moving)]
    cuts = cuts_of(term, moving)
    known = {cut.part for cut in cuts} | {p for p in roots for cut in cuts if _follows(p.base, cut, moving)}
    touching = [r for r in roots if r not in known and proved_sign(r.base, domain) == "0+"]
    return [
        r for r in touching if not (is_uncut(r.base, r.exp, domain) or is_positive_between(r.base, domain))
    ]


def _follows(base: Expr, cut: Cut, moving: Sequence[Symbol]) -> bool:
    """Tell whether what a root is taken of is |u|, and u changes its sign wherever it vanishes."""
    slopes = (cast("Expr", cut.gap.diff(s)) for s in moving)
    return base == cut.part and isinstance(base, sp.Abs) and any(f.is_number and f.is_nonzero for f in slopes)


def _is_pieced(part: Expr, domain: Domain) -> bool:
    """Tell whether a function is analytic on both sides of a place where it is infinite, and no further."""
    match part:
        case sp.log():
            return proved_sign(arguments(part)[0], domain) != "+"
        case sp.Pow():
            if part.exp.is_integer is not False or part.base.is_positive:
                return False
            return not proved_sign(part.base, domain).endswith("+")
        case sp.atan() | sp.acot() | sp.asinh():
            return not certainly_real(arguments(part)[0])
        case (
            sp.acoth() | sp.atanh() | sp.acsch() | sp.asech() | sp.asec() | sp.acsc() | sp.acosh() | sp.arg()
        ):
            return True
        case sp.asin() | sp.acos():
            return bool(part.args[0].has(sp.I))
        case _:
            return False


def _parts(terms: Sequence[Expr], moving: Sequence[Symbol]) -> Iterator[Expr]:
    """Yield sums of terms that might be locally constant: whole groups, and a few terms without pieces of each."""
    for group in _groups(terms, moving):
        yield sp.Add(*group)
        smooth = [term for term in group if not term.has(*PIECED)]
        if len(smooth) <= FEW:
            for size in range(2, min(len(smooth) + 1, len(group))):
                yield from (sp.Add(*few) for few in combinations(smooth, size))


def _groups(terms: Sequence[Expr], moving: Sequence[Symbol]) -> Iterator[list[Expr]]:
    """Yield the terms that share variables, each with all that are connected by them."""
    left = list(terms)
    while left:
        group = [left.pop(0)]
        names = free_symbols(group[0]) & set(moving)
        while found := [t for t in left if names & free_symbols(t)]:
            group += found
            left = [t for t in left if t not in found]
            names |= {s for t in found for s in free_symbols(t) & set(moving)}
        yield group


def _gaps_of(terms: Sequence[Expr], moving: Sequence[Symbol], domain: Domain) -> list[Expr]:
    """Return the surfaces at which terms jump."""
    return list(
        {cut.gap: None for term in terms for cut in _open_cuts(term, moving, domain) if not cut.bends}
    )


def _excused(
    terms: Sequence[Expr], given: Iterable[Expr], moving: Sequence[Symbol], domain: Domain, deadline: float
) -> dict[Expr, str]:
    """Return the terms that may jump only where something jumps that is given, and what is assumed of them.

    What is given in pieces that meet, as |q| may be, or by an angle, as cos 2θ, does not jump.
    """
    plain = [without_complex_logarithms(g) for g in given] if terms else []
    cuts = [(g, cut) for g in plain for cut in _open_cuts(g, moving, domain) if not cut.bends]
    gaps = [cut.gap for g, cut in cuts if not _meets(g, cut, moving, domain, deadline)]
    found: dict[Expr, str] = {}
    for term in terms if gaps else ():
        own = {cut.gap for cut in _open_cuts(term, moving, domain) if not cut.bends}
        if own and all(any(proportion(gap, mine) is not None for gap in gaps) for mine in own):
            where = " or ".join(f"{gap} = 0" for gap in sorted(own, key=str))
            found[term] = f"{{}} may jump where {where}, as what is given does"
    return found


def _of_cuts(
    f: Expr,
    beside: Expr,
    moving: Sequence[Symbol],
    domain: Domain,
    deadline: float,
    name: str,
    *,
    angles: bool,
) -> Verdict:
    """Tell whether a function jumps at its cuts; values are told with the terms ``beside`` it that do not."""
    cuts = _open_cuts(f, moving, domain)
    centres = {cut.part: centre_of(cut, moving, domain) for cut in cuts}
    winding = _winding(f, [cut for cut in cuts if centres[cut.part]], moving, domain) if angles else set()
    assumed = tuple(
        f"{angle} is an angle that winds around {centre}; where it jumps is a matter of choice"
        for angle, centre in centres.items()
        if angle in winding
    )
    at_angles = [cut for cut in cuts if cut.part in winding]
    open_ = _open_roots(f, moving, domain)
    for cut in (cut for cut in cuts if cut.part not in winding):
        jump = find_jump(f, cut, moving, domain, deadline)
        if jump is None and _meets(f, cut, moving, domain, deadline):
            continue
        told = centres[cut.part] is not None and not _is_at_one_of(at_angles, cut)
        if jump is not None and told:
            return _failed(name, _fault_of(_in_full(f, beside, jump, cut, moving, domain, deadline)))
        open_.append(cut.part)
    if not open_:
        return Verdict(Status.HOLDS, f"{name} {CONTINUOUS}", "structure", assumed=assumed)
    why = f"{name} may jump, which its derivatives do not show; narrow the domain to where it does not"
    return Verdict(Status.UNDECIDED, f"{name} {CONTINUOUS}", evidence=(Evidence("open", why),), feedback=why)


def _winding(f: Expr, angles: Sequence[Cut], moving: Sequence[Symbol], domain: Domain) -> set[Expr]:
    """Return the angles of a function that wind about a centre, others that wind about it not undoing their turns."""
    return {cut.part for cut in angles} - turns_undone(f, angles, moving, domain)


def _open_roots(f: Expr, moving: Sequence[Symbol], domain: Domain) -> list[Expr]:
    """Return the roots that touch zero in terms with a denominator."""
    divided = [term for term in sp.Add.make_args(f) if _is_divided(term, moving, domain)]
    return [root for term in divided for root in _touching_roots(term, moving, domain)]


def _in_full(
    f: Expr, beside: Expr, jump: Jump, cut: Cut, moving: Sequence[Symbol], domain: Domain, deadline: float
) -> Jump:
    """Return a jump of part of a function as one of the whole, where that is found too."""
    whole = find_jump(f + beside, cut, moving, domain, deadline) if beside != 0 else None
    return whole or jump


def _fault_of(jump: Jump) -> Fault:
    where = ", ".join(f"{x} = {place}" for x, place in jump.point.items())
    return Fault(jump.point, jump.before, jump.after, f"jumps at {where} from {jump.before} to {jump.after}")


def _is_at_one_of(angles: Sequence[Cut], cut: Cut) -> bool:
    """Whether a function may jump at a cut just because an angle does."""
    return any(proportion(angle.gap, cut.gap) is not None for angle in angles)


def _meets(f: Expr, cut: Cut, moving: Sequence[Symbol], domain: Domain, deadline: float) -> bool:
    left = deadline - time.monotonic()
    return left > 0 and meets(f, cut.gap, moving, domain, left)


def meets(f: Expr, gap: Expr, moving: Sequence[Symbol], domain: Domain, budget: float) -> bool:
    """Tell whether a function is proved to be continuous across a surface: both continuations are equal on it.

    Where they have no value on it, as their denominators vanish, both must be infinite.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> [meets(f, x, [x], EVERYWHERE, 1.0) for f in (abs(x), sp.sign(x), x * sp.sign(x) + sp.sign(x - 1))]
    [True, False, True]
    """
    above, below = (continued(f, gap, moving, up=up) for up in (True, False))
    if (above - below).has(sp.nan, sp.zoo):
        return False
    ratio = proportion(above - below, gap)
    if above - below == 0 or (ratio is not None and sp.expand(above - below - ratio * gap) == 0):
        return True
    plain: dict[Expr, Expr] = {s: sp.Dummy(s.name, real=True) for s in nonzero(gap, moving)}
    kept = (c for c in parts_of(domain.conditions) if not isinstance(c, sp.Ne))
    on_gap = (*kept, cast("Boolean", sp.Eq(gap, 0, evaluate=False)))
    there = Domain(tuple(cast("Boolean", c.xreplace(plain)) for c in on_gap))
    above, below, gap = (cast("Expr", g.xreplace(plain)) for g in (above, below, gap))
    verdict = vanishes(above - below, there, budget)
    if verdict.holds or verdict.certificate == "ball":
        return verdict.holds
    free = [plain.get(s, s) for s in moving]
    return meet_beside_poles(above, below, gap, [s for s in free if isinstance(s, sp.Symbol)], there, budget)
