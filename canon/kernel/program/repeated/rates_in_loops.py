"""Drifts and kicks of sums over rows as loops: what one symplectic step of H = Σ T(p_k) + Σ V(q_k) consists of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.kernel.program.repeated.pair_function import forces_of_pair_sum
from canon.kernel.program.repeated.repeated_families import MOST_ADDENDS, families_of_sums, most_addends

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Symbol

    from canon.kernel.program.operation_families import Families
    from canon.kernel.program.repeated.pair_function import PairForces
    from canon.kernel.program.repeated.repeated_terms import RepeatedTerms

__all__ = ["RatesInLoops", "rates_in_loops"]


@dataclass(frozen=True, eq=False)
class RatesInLoops:
    """∂H/∂p and −∂H/∂q as loops over the rows of the sums that H consists of.

    Parameters
    ----------
    velocity, force
        They, but for the force of pairs; no force where that is all of it.
    pairs
        The force of every pair of rows.
    """

    velocity: Families
    force: Families | None
    pairs: PairForces | None


def rates_in_loops(sums: Sequence[RepeatedTerms], t: Symbol, n: int) -> RatesInLoops | None:
    """Return the loops of drifts and kicks, or None where sums mix coordinates and momenta, or cannot be looped over.

    Parameters
    ----------
    sums
        The sums.
    t, n
        The symbol of the time, and the number of coordinates.
    """
    if any(len(each.reads(n)) > 1 for each in sums):
        return None
    of_pairs = [each for each in sums if each.pairs]
    single = [each for each in sums if not each.pairs]
    pairs = (
        forces_of_pair_sum(of_pairs[0], n) if len(of_pairs) == 1 and of_pairs[0].reads(n) == {"q"} else None
    )
    if len(of_pairs) != (pairs is not None) or (single and most_addends(single) > MOST_ADDENDS):
        return None
    velocity = [each for each in single if each.reads(n) == {"p"}]
    force = [each for each in single if each.reads(n) == {"q"}]
    return RatesInLoops(
        families_of_sums(velocity, t, n, negated=False, shift=n),
        families_of_sums(force, t, n, negated=True, shift=0) if force or pairs is None else None,
        pairs,
    )
