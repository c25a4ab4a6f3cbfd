"""Normal form of Jacobi's sn, cn and dn: written with few of them, related by sn² + cn² = 1 and dn² + m sn² = 1.

The addition theorem is used at real arguments for m ≤ 1 alone, where its denominator 1 − m sn² sn² is positive; the two
relations hold wherever the functions are defined (NIST DLMF 22.8.1–3, 22.6.1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpq

from canon.expression.symbols.jacobi_functions import jacobi_cn, jacobi_dn, jacobi_sn
from canon.proof.functions.angles import combination, cos_sin, divided
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    import sympy as sp

    from canon.proof.tower.forms import Forms

    Triple = tuple[Fraction, Fraction, Fraction]

__all__ = ["elementary", "is_ordinary", "sn_cn_dn"]

LARGEST_MULTIPLE = 12
"""Multiples of an argument that are still written out; of more the functions are kernels of their own."""


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return sn, cn or dn through those of simpler arguments."""
    if not isinstance(expr, jacobi_sn | jacobi_cn | jacobi_dn):
        return None
    u, m = (n.tower.canonical(n.form(a)) for a in expr.args)
    s, c, d = sn_cn_dn(n, u, m)
    return s if isinstance(expr, jacobi_sn) else c if isinstance(expr, jacobi_cn) else d


def is_ordinary(n: Forms, m: Fraction) -> bool:
    """Tell whether m < 1 is proved of a real parameter, so that K(m) is finite and am increases without end."""
    return n.is_real(m) and n.sign(n.minus(n.tower.number(1), m)) == "+"


def sn_cn_dn(n: Forms, u: Fraction, m: Fraction) -> Triple:
    """Return sn, cn and dn of u and the parameter m."""
    t = n.tower
    if t.is_zero(m):
        cosine, sine = cos_sin(n, u)
        return sine, cosine, t.number(1)
    terms = combination(n, u)
    below_one = n.is_real(m) and n.sign(n.minus(t.number(1), m)).endswith("+")
    if not (below_one and all(n.is_real(atom) for atom, _ in terms)):
        return _kernels(n, u, m)
    total = (t.number(0), t.number(1), t.number(1))
    for atom, r in terms:
        total = _sum(n, total, _special(n, atom, r, m) or _multiple_of_kernels(n, atom, r, m), m)
    return total


def _sum(n: Forms, first: Triple, second: Triple, m: Fraction) -> Triple:
    t = n.tower
    (s1, c1, d1), (s2, c2, d2) = first, second
    if t.is_zero(s1) and t.is_zero(n.minus(c1, t.number(1))):
        return second
    ss = t.times(s1, s2)
    below = t.reciprocal(n.minus(t.number(1), t.times(m, ss, ss)))
    return (
        t.times(t.sum([t.times(s1, c2, d2), t.times(s2, c1, d1)]), below),
        t.times(n.minus(t.times(c1, c2), t.times(ss, d1, d2)), below),
        t.times(n.minus(t.times(d1, d2), t.times(m, ss, c1, c2)), below),
    )


def _multiple(n: Forms, triple: Triple, k: int, m: Fraction) -> Triple:
    """Return the functions of a whole multiple of an argument from those of the argument."""
    total = (n.tower.number(0), n.tower.number(1), n.tower.number(1))
    for _ in range(abs(k)):
        total = _sum(n, total, triple, m)
    return (n.negative(total[0]), *total[1:]) if k < 0 else total


def _special(n: Forms, atom: Fraction, r: fmpq, m: Fraction) -> Triple | None:
    """Return the functions of multiples of K(m)/2, and of whole multiples of F(φ, m), where sn = sin φ."""
    t, kernel = n.tower, n.only_kernel(atom)
    if kernel is None or not is_ordinary(n, m):
        return None
    if kernel == ("K", n.fraction_key(m)) and r.q in (1, 2):
        return _quarter_periods(n, int(r.p) * (2 // int(r.q)), m)
    if kernel[0] == "F" and kernel[2] == n.fraction_key(m) and r.q == 1 and abs(r) <= LARGEST_MULTIPLE:
        phi = n.amplitudes[kernel][0]
        cosine, sine = cos_sin(n, phi)
        d = n.root(n.minus(t.number(1), t.times(m, sine, sine)), fmpq(1, 2))
        return _multiple(n, (sine, cosine, d), int(r.p), m)
    return None


def _quarter_periods(n: Forms, halves: int, m: Fraction) -> Triple:
    """Return the functions of a number of halves of K(m): sn K/2 = 1/√(1 + k′), dn K/2 = √k′, dn K = k′."""
    t = n.tower
    one = t.number(1)
    complement = n.root(n.minus(one, m), fmpq(1, 2))
    quarter = {0: (0, 1, one), 1: (1, 0, complement), 2: (0, -1, one), 3: (-1, 0, complement)}
    s, c, d = quarter[halves // 2 % 4]
    whole = t.number(s), t.number(c), d
    if halves % 2 == 0:
        return whole
    below = t.reciprocal(n.root(t.sum([one, complement]), fmpq(1, 2)))
    root = n.root(complement, fmpq(1, 2))
    return _sum(n, whole, (below, t.times(root, below), root), m)


def _multiple_of_kernels(n: Forms, atom: Fraction, r: fmpq, m: Fraction) -> Triple:
    parts = divided(n, "jacobi", (n.fraction_key(atom), n.fraction_key(m)), r)
    times, part = int((r * parts).p), fmpq(1, parts)
    if abs(times) > LARGEST_MULTIPLE:
        times, part = (1 if times > 0 else -1), abs(r)
    return _multiple(n, _kernels(n, n.scaled(part, atom), m), times, m)


def _kernels(n: Forms, u: Fraction, m: Fraction) -> Triple:
    """Return sn, cn and dn of one argument as generators, dn over a multiple of the denominator of m.

    At real arguments all are real; dn is positive for m < 1, as dn² ≥ 1 − m, and for m = 1, as sech.
    """
    t = n.tower
    key = (n.fraction_key(u), n.fraction_key(m))
    fresh, one = not t.knows(("sn", *key)), t.number(1)
    real = n.is_real(u) and n.is_real(m)
    kind, below = "real" if real else "", n.denominator(m)
    positive = real and n.sign(n.minus(one, m)).endswith("+")

    def meaning(f: type) -> sp.Expr:
        return f(n.fraction_expression(u), n.fraction_expression(m))

    s = n.atom(("sn", *key), kind, lambda: meaning(jacobi_sn))
    c = n.atom(("cn", *key), kind, lambda: meaning(jacobi_cn))
    wide = positive and n.signs.of(below) == "+"
    scaled = n.atom(("dn", *key), "+" if wide else kind, lambda: n.expression(below) * meaning(jacobi_dn))
    d = n.over(scaled, Fraction(below))
    if fresh:
        t.relate(t.generator(("cn", *key)), 2, 1 - s.num**2)
        square = t.product(below, below) - t.product(t.product(m.num, below), s.num**2)
        t.relate(t.generator(("dn", *key)), 2, square)
        if positive:
            for bound in (1 - s.num, 1 + s.num, 1 - s.num**2, 1 - c.num, 1 + c.num):
                n.signs.learn(bound, strict=False, combine=False)
        if wide:
            short = below - t.product(m.num, s.num**2)
            n.signs.learn(short, strict=True, combine=False)
            n.squares.append((short, t.times(d, n.root(Fraction(below), fmpq(1, 2)))))
    return s, c, d
