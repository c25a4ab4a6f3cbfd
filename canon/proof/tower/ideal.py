"""Ideals of polynomials over the rationals: whether one is a combination of others, by a Gröbner basis of FLINT's."""

from __future__ import annotations

from dataclasses import dataclass
from math import lcm
from typing import TYPE_CHECKING, cast

from flint import Ordering, fmpq, fmpq_mpoly_ctx, fmpz_mpoly_ctx, fmpz_mpoly_vec

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from flint import fmpq_mpoly, fmpz_mpoly

__all__ = ["Ideal"]

MOST_POLYNOMIALS, MOST_TERMS, MOST_BITS = 60, 400, 2_000
"""Size of a basis at which Buchberger's algorithm is left."""


@dataclass(frozen=True)
class Ideal:
    """Polynomials, a Gröbner basis of what they generate where one of bearable size was found.

    Examples
    --------
    >>> x, y = fmpq_mpoly_ctx.get(("x", "y"), Ordering.lex).gens()
    >>> Ideal.of([x * y - 1, y**2 - x]).holds(x**2 - 1)
    False
    >>> Ideal.of([x * y - 1, y**2 - x]).holds(x - y**2 + y**3 - 1)
    True
    """

    basis: tuple[fmpq_mpoly, ...]

    @classmethod
    def of(cls, generators: Sequence[fmpq_mpoly]) -> Ideal:
        """Return the ideal that polynomials of one context generate."""
        names = generators[0].context().names()
        whole = fmpz_mpoly_ctx.get(names, Ordering.degrevlex)
        start = fmpz_mpoly_vec([whole.from_dict(_whole_terms(p)) for p in generators], whole)
        found, success = start.buchberger_naive(limits=(MOST_POLYNOMIALS, MOST_TERMS, MOST_BITS))
        context = fmpq_mpoly_ctx.get(names, Ordering.degrevlex)
        basis = cast("Iterable[fmpz_mpoly]", found if success else start)
        return cls(tuple(context.from_dict({m: fmpq(c) for m, c in p.to_dict().items()}) for p in basis))

    def holds(self, p: fmpq_mpoly) -> bool:
        """Tell whether a polynomial is certainly a combination of those that generate the ideal."""
        rest = self.basis[0].context().from_dict(p.to_dict())
        divided = True
        while divided and not rest.is_zero():
            divided = False
            for q in self.basis:
                quotient, rest = divmod(rest, q)
                divided = divided or not quotient.is_zero()
        return bool(rest.is_zero())


def _whole_terms(p: fmpq_mpoly) -> dict[tuple[int, ...], int]:
    """Return the terms of a whole multiple of a polynomial."""
    terms = p.to_dict()
    common = 1
    for c in terms.values():
        common = lcm(common, int(c.q))
    return {powers: int(c.p) * (common // int(c.q)) for powers, c in terms.items()}
