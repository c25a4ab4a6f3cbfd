"""Signs of polynomials over a tower, proved by a few rules.

A sign is ``"+"`` (positive), ``"0+"`` (not negative), ``"-"``, ``"0-"`` or ``""`` (not known). Every rule
is about all points of the domain at which the generators are defined.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator

    from flint import fmpq, fmpq_mpoly

    from canon.proof.tower.tower import Tower

__all__ = ["Signs"]

Monomial = tuple[tuple[int, int], ...]

MOST_SEARCHES = 400
"""Polynomials whose sign is looked for by more than their terms, in one tower."""

MOST_SUBTRACTIONS = 30
"""Multiples of facts that are subtracted in one search."""

MOST_CONDITIONS = 8
MOST_FACTS = 80
DEEPEST = 4
WIDEST = 6
"""Terms of a fact that are tried to cancel a term."""

LONGEST = 60


class Signs:
    """What is known of the signs of a tower's generators and of some polynomials in them.

    Parameters
    ----------
    tower
        The generators.
    of_constant
        Decides the sign of a polynomial in constants (roots of numbers, π, …) by balls; ``""`` for others.
    """

    def __init__(self, tower: Tower, of_constant: Callable[[fmpq_mpoly], str]) -> None:
        self.tower = tower
        self._of_constant = of_constant
        self._of: dict[int, str] = {}
        self._facts: list[tuple[fmpq_mpoly, bool]] = []
        self._conditions: list[tuple[fmpq_mpoly, bool]] = []
        self._found: dict[Hashable, str] = {}
        self._nonzero: set[Hashable] = set()
        self._searches = 0
        self._left = MOST_SUBTRACTIONS

    def declare(self, generator: int, sign: str) -> None:
        """Record the sign of a generator: one of the signs above, "real", or "" where it may be complex."""
        self._of[generator] = sign

    def declared(self, generator: int) -> str:
        """Return what was declared of a generator."""
        return self._of.get(generator, "")

    def learn(self, p: fmpq_mpoly, *, strict: bool, combine: bool = True) -> None:
        """Record that p > 0 (strict) or p ≥ 0 on the domain; with ``combine`` also its products with others."""
        if combine and len(self._conditions) < MOST_CONDITIONS:
            self._conditions.append((p, strict))
            for q, strict_q in self._conditions:
                if len(p) * len(q) <= 100:
                    self._facts.append((self.tower.product(p, q), strict and strict_q))
        if len(self._facts) < MOST_FACTS:
            self._facts.append((p, strict))
        self._found.clear()
        if strict and combine and self.real(p):
            self._learn_factors(p)

    def _learn_factors(self, p: fmpq_mpoly) -> None:
        """From fg > 0 and f + g of one sign both factors have that sign, as c ± v from c² > v² and c > 0."""
        unit, factors = self.tower.factors(p)
        if len(factors) != 2 or any(e != 1 for _, e in factors):
            return
        f, g = (factor for factor, _ in factors)
        g = g if unit > 0 else -g
        total = self.of(f + g)
        for factor in (f, g) if total in ("+", "-") else ():
            self.learn(factor if total == "+" else -factor, strict=True, combine=False)

    def learn_nonzero(self, p: fmpq_mpoly) -> None:
        """Record that p ≠ 0 wherever the claim is about."""
        for factor, _ in self.tower.factors(p)[1]:
            self._nonzero.add(self.tower.key(factor))

    def nonzero(self, p: fmpq_mpoly) -> bool:
        """Tell whether p is proven not to vanish wherever the claim is about."""
        p = self.tower.reduce(p)
        return self.of(p) in ("+", "-") or (not p.is_constant() and self._known_nonzero(p))

    def forget_nonzero(self) -> None:
        """Forget what :meth:`learn_nonzero` recorded: excluded points may cut a domain in two."""
        self._nonzero.clear()
        self._found.clear()

    def real(self, p: fmpq_mpoly) -> bool:
        """Tell whether every generator of ``p`` is real on the domain."""
        return all(self._of.get(k, "") for k in self.tower.used(p))

    def of(self, p: fmpq_mpoly) -> str:
        """Return the proven sign of ``p``."""
        return self._sign(self.tower.reduce(p), DEEPEST)

    def _sign(self, p: fmpq_mpoly, depth: int) -> str:
        if p.is_constant():
            return "" if p.is_zero() else "+" if p.leading_coefficient() > 0 else "-"
        key = self.tower.key(p)
        found = self._found.get(key)
        if found is None:
            self._found[key] = ""
            found = self._search(p, depth)
            if found.startswith("0") and (self._known_nonzero(p) or self._nonzero_by_relations(p, depth)):
                found = found[1:]
            self._found[key] = found
            if not found and depth < DEEPEST:
                del self._found[key]
        return found

    def contradicts(self, p: fmpq_mpoly, *, strict: bool) -> bool:
        """Tell whether p > 0 (strict) or p ≥ 0 is refuted by the signs of p's factors."""
        p = self.tower.reduce(p)
        if p.is_constant() or len(p) > LONGEST or not self.real(p):
            return False
        found = self._by_factors(p, DEEPEST)
        return found == "-" or (strict and found == "0-")

    def _known_nonzero(self, p: fmpq_mpoly) -> bool:
        return bool(self._nonzero) and all(
            self.tower.key(f) in self._nonzero for f, _ in self.tower.factors(p)[1]
        )

    def _nonzero_by_relations(self, p: fmpq_mpoly, depth: int) -> bool:
        """Tell whether relations gⁿ = R show that no factor of p vanishes.

        g and R vanish together: |t| ≠ 0 where t² ≠ 0. What divides R vanishes only where g does: 1 − cos t, which
        divides sin² t = 1 − cos² t, is not zero where sin t > 0.
        """
        if depth == 0 or len(p) > LONGEST:
            return False
        return all(self._is_nonzero_factor(f, depth - 1) for f, _ in self.tower.factors(p)[1])

    def _is_nonzero_factor(self, f: fmpq_mpoly, depth: int) -> bool:
        t = self.tower
        if len(f) == 1:
            (k,) = t.used(f)
            relation = t.relation(k)
            below = "" if relation is None else self._sign(relation[1], depth)
            return below in ("+", "-") or self._of.get(k, "") in ("+", "-") or self._known_nonzero(f)
        roots = ((k, t.relation(k)) for k, sign in self._of.items() if sign in ("+", "-"))
        powers = [relation[1] for _, relation in roots if relation is not None]
        return self._known_nonzero(f) or any(t.quotient(power, f) is not None for power in powers)

    def _search(self, p: fmpq_mpoly, depth: int) -> str:
        by_terms = self._by_terms(p)
        if by_terms.startswith("0"):
            return by_terms[1:] if self._strictly(p if by_terms == "0+" else -p) else by_terms
        if by_terms or not self.real(p):
            return by_terms
        constant = self._of_constant(p)
        self._searches += 1
        if constant or len(p) > LONGEST or self._searches > MOST_SEARCHES:
            return constant
        by_facts = ""
        for steps in (1, 2, 3):
            self._left = MOST_SUBTRACTIONS
            by_facts = self._by_facts(p, steps) or _opposite(self._by_facts(-p, steps))
            if by_facts:
                break
        if by_facts or depth == 0:
            return by_facts
        return self._by_factors(p, depth) or self._by_root(p, depth) or self._by_square(p, depth)

    def _by_terms(self, p: fmpq_mpoly) -> str:
        """A sum of terms of one sign has that sign, strictly if one of them has it strictly."""
        signs = {self._of_term(monomial, coefficient > 0) for monomial, coefficient in self.tower.terms(p)}
        if signs <= {"+", "0+"}:
            return "+" if "+" in signs else "0+"
        if signs <= {"-", "0-"}:
            return "-" if "-" in signs else "0-"
        return ""

    def _of_term(self, monomial: Monomial, positive: bool) -> str:
        strict = True
        for k, e in monomial:
            sign = self._of.get(k, "")
            if not sign:
                return ""
            strict = strict and sign in ("+", "-")
            if e % 2:
                if sign == "real":
                    return ""
                positive = positive != sign.endswith("-")
        return ("" if strict else "0") + ("+" if positive else "-")

    def _by_facts(self, p: fmpq_mpoly, steps: int) -> str:
        """p ≥ 0 where p minus nonnegative multiples of known facts is so; the terms of p do not show its sign.

        Each step cancels the first term of p that may be negative, by a fact times a positive number and
        a monomial that is not negative; half of the number is tried too.
        """
        terms = self.tower.terms(p)
        bad, ratio = next((m, c) for m, c in terms if not self._of_term(m, positive=c > 0).endswith("+"))
        for known, strict, multiple, coefficient in self._cancelling(bad, positive=ratio > 0):
            sign = self._of_term(multiple, positive=True)
            if not sign.endswith("+"):
                continue
            for share in (1, 2) if steps > 1 and not multiple else (1,):
                found = self._without(p, known, multiple, ratio / coefficient / share, steps)
                if found:
                    return "+" if (strict and sign == "+") or found == "+" else "0+"
        return ""

    def _cancelling(
        self, term: Monomial, *, positive: bool
    ) -> Iterator[tuple[fmpq_mpoly, bool, Monomial, fmpq]]:
        """Yield facts, and by what monomial to multiply them so that one of their terms cancels the given one."""
        for known, strict in self._facts:
            for cancelled, coefficient in self.tower.terms(known)[:WIDEST]:
                multiple = _quotient(term, cancelled)
                if multiple is not None and positive == (coefficient > 0):
                    yield known, strict, multiple, coefficient

    def _strictly(self, p: fmpq_mpoly) -> bool:
        """Tell whether p, a sum of nonnegative terms, stays one less a multiple of a positive fact."""
        wanted = dict(self.tower.terms(p)[:WIDEST])
        for known, strict in self._facts:
            for monomial, coefficient in self.tower.terms(known)[:WIDEST] if strict else ():
                ratio = wanted.get(monomial)
                if ratio is not None and (ratio > 0) == (coefficient > 0):
                    rest = p - known * self.tower.constant(ratio / coefficient)
                    if rest.is_zero() or self._by_terms(rest).endswith("+"):
                        return True
        return False

    def _without(self, p: fmpq_mpoly, known: fmpq_mpoly, multiple: Monomial, ratio: fmpq, steps: int) -> str:
        """Return the sign, if it is not negative, of p minus a multiple of a fact ("0+" if nothing is left)."""
        self._left -= 1
        if self._left < 0:
            return ""
        factor = self.tower.constant(ratio)
        for k, e in multiple:
            factor = factor * self.tower.monomial(k, e)
        rest = self.tower.reduce(p - self.tower.product(known, factor))
        if rest.is_zero():
            return "0+"
        found = self._by_terms(rest)
        if found or steps == 1 or len(rest) > len(p) + 1:
            return found if found.endswith("+") else ""
        return self._by_facts(rest, steps - 1)

    def _by_factors(self, p: fmpq_mpoly, depth: int) -> str:
        """The sign of a product is the product of the signs."""
        unit, factors = self.tower.factors(p)
        if len(factors) == 1 and factors[0][1] == 1:
            return ""
        positive, strict = unit > 0, True
        for factor, e in factors:
            if e % 2 == 0:
                strict = strict and self._sign(factor, depth - 1) in ("+", "-")
                continue
            sign = self._sign(factor, depth - 1)
            if not sign:
                return ""
            strict = strict and sign in ("+", "-")
            positive = positive != sign.endswith("-")
        return ("" if strict else "0") + ("+" if positive else "-")

    def _by_root(self, p: fmpq_mpoly, depth: int) -> str:
        """A + Bρ with ρ = √R ≥ 0 has the sign of the larger of |A| and |B|ρ: compare A² with B²R."""
        t = self.tower
        for k in reversed(t.used(p)):
            relation = t.relation(k)
            if relation is None or relation[0] != 2 or not self._of[k].endswith("+"):
                continue
            a, b = (*t.coefficients(p, k), t.constant(0))[:2]
            gap = t.reduce(t.product(a, a) - t.product(t.product(b, b), relation[1]))
            comparison = self._sign(gap, depth - 1)
            if comparison.endswith("-") and (sign_b := self._sign(b, depth - 1)):
                return ("" if comparison == "-" else "0") + sign_b[-1]
            if comparison.endswith("+") and (sign_a := self._sign(a, depth - 1)):
                return ("" if comparison == "+" else "0") + sign_a[-1]
        return ""

    def _by_square(self, p: fmpq_mpoly, depth: int) -> str:
        """a v² + b v + c with a > 0 and 4ac − b² ≥ 0 is not negative; positive if that is positive."""
        t = self.tower
        for k in t.used(p):
            if t.relation(k) is not None:
                continue
            parts = t.coefficients(p, k)
            if len(parts) != 3 or parts[1].is_zero():
                continue
            c, b, a = parts
            leading = self._sign(a, depth - 1)
            if leading not in ("+", "-"):
                continue
            gap = t.reduce(4 * t.product(a, c) - t.product(b, b))
            if gap.is_zero():
                return "0" + leading
            comparison = self._sign(gap, depth - 1)
            if comparison.endswith("+"):
                return leading if comparison == "+" else "0" + leading
        return ""


def _quotient(monomial: Monomial, divisor: Monomial) -> Monomial | None:
    """Return monomial/divisor if it is a monomial."""
    left = dict(monomial)
    for k, e in divisor:
        if left.get(k, 0) < e:
            return None
        left[k] -= e
    return tuple((k, e) for k, e in left.items() if e)


def _opposite(sign: str) -> str:
    return sign.translate(str.maketrans("+-", "-+"))
