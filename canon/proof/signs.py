"""Signs of polynomials over a tower, as far as inspection of their terms can prove them."""

from __future__ import annotations

from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from canon.proof.tower import Tower

__all__ = ["Signs"]

MOST_FACTS = 12


class Signs:
    """What is known of the signs of a tower's generators and of some polynomials in them.

    A generator's sign is one of ``"+"`` (positive), ``"0+"`` (not negative), ``"-"``, ``"0-"``,
    ``"real"`` and ``""`` (possibly complex).
    """

    def __init__(self, tower: Tower) -> None:
        self.tower = tower
        self._of: dict[int, str] = {}
        self._facts: list[tuple[fmpq_mpoly, bool]] = []

    def declare(self, generator: int, sign: str) -> None:
        """Record the sign of a generator."""
        self._of[generator] = sign

    def learn(self, p: fmpq_mpoly, *, strict: bool) -> None:
        """Record that p > 0 (strict) or p ≥ 0 on the domain."""
        if len(self._facts) < MOST_FACTS:
            self._facts.append((p, strict))

    def real(self, p: fmpq_mpoly) -> bool:
        """Tell whether every generator of ``p`` is real on the domain."""
        return all(self._of.get(k, "") for k in self.tower.used(p))

    def of(self, p: fmpq_mpoly) -> str:
        """Return the proven sign of ``p``: ``"+"``, ``"0+"``, ``"-"``, ``"0-"`` or ``""``."""
        p = self.tower.reduce(p)
        for sign, candidate in (("+", p), ("-", -p)):
            found = self._inspect(candidate)
            if found:
                return found.replace("+", sign)
        if not self.real(p) or len(p) > 60:
            return ""
        for sign, candidate in (("+", p), ("-", -p)):
            found = self._from_facts(candidate)
            if found:
                return found.replace("+", sign)
        return ""

    def _inspect(self, p: fmpq_mpoly) -> str:
        """Return "+" or "0+" when every term is so: a sum of nonnegative terms with a positive one is positive."""
        strict = False
        terms = self.tower.terms(p)
        if not terms:
            return ""
        for monomial, coefficient in terms:
            positive, known = coefficient > 0, True
            nonzero = True
            for k, e in monomial:
                sign = self._of.get(k, "")
                if not sign:
                    return ""
                if e % 2 == 0:
                    nonzero = nonzero and sign in ("+", "-")
                elif sign == "real":
                    known = False
                    break
                else:
                    nonzero = nonzero and sign in ("+", "-")
                    positive = positive != sign.endswith("-")
            if not known or not positive:
                return ""
            strict = strict or nonzero
        return "+" if strict else "0+"

    def _from_facts(self, p: fmpq_mpoly) -> str:
        """Return a sign when p minus a positive multiple of a fact, or of two facts' product, has one."""
        known = [(self.tower.reduce(fact), strict) for fact, strict in self._facts]
        products = list(known)
        for (a, strict_a), (b, strict_b) in combinations_with_replacement(known, 2):
            if len(a) * len(b) <= 400:
                products.append((self.tower.product(a, b), strict_a and strict_b))
        wanted = dict(self.tower.terms(p))
        for fact, strict in products:
            for monomial, coefficient in self.tower.terms(fact):
                ratio = wanted.get(monomial)
                if ratio is None or (ratio > 0) != (coefficient > 0):
                    continue
                rest = self.tower.reduce(p - fact * self.tower.constant(ratio / coefficient))
                if rest.is_zero():
                    return "+" if strict else "0+"
                found = self._inspect(rest)
                if found:
                    return "+" if strict or found == "+" else "0+"
        return ""
