"""Fractions over a tower of generators: kernels, their signs and meanings, and arithmetic with them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.proof.domain.limits import THOROUGH, Limits
from canon.proof.tower.signs import Signs
from canon.proof.tower.tower import Fraction, Tower

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from flint import fmpq, fmpq_mpoly
    from sympy import Expr

    from canon.proof.domain.domain import Domain

__all__ = ["Forms"]


class Forms(ABC):
    """What the rules for functions work with; :class:`~canon.proof.functions.normal_form.NormalForm` adds the rules.

    Parameters
    ----------
    domain
        Conditions from which signs are taken.
    parts
        For each kernel the number of parts it is divided into; grows when :class:`~canon.proof.domain.limits.Refine`
        is raised, after which the work starts again.
    deadline
        Value of :func:`time.monotonic` to stop at.
    limits, capacity
        See :class:`~canon.proof.tower.tower.Tower`.
    """

    def __init__(
        self,
        domain: Domain,
        parts: dict[Hashable, Any],
        deadline: float = float("inf"),
        limits: Limits = THOROUGH,
        capacity: int = 16,
    ) -> None:
        self.domain = domain
        self.tower = Tower(deadline, limits, capacity)
        self.signs = Signs(self.tower, self.sign_of_constant)
        self.parts = parts
        self.arguments: dict[Hashable, Fraction] = {}
        self.atoms: dict[Hashable, Fraction] = {}
        self.ranges: dict[Hashable, tuple[Expr, Expr, bool]] = {}
        self.moduli: list[tuple[Fraction, tuple[Fraction, Fraction]]] = []
        self.integrals: dict[Hashable, tuple[Fraction, Fraction]] = {}
        self.known_roots: dict[Hashable, Fraction] = {}
        self.squares: list[tuple[fmpq_mpoly, Fraction]] = []
        self.amplitudes: dict[Hashable, tuple[Fraction, Fraction]] = {}
        self.inside_root = False
        self.independent: dict[Hashable, Fraction] = {}
        self.gammas: list[tuple[Fraction, Fraction]] = []
        self.polygammas: dict[int, list[tuple[Fraction, Fraction]]] = {}
        self.number_logs: list[tuple[fmpq_mpoly, Fraction]] = []
        self._numbers: dict[Hashable, int] = parts.setdefault("numbers", {})
        self._meaning: dict[int, Callable[[], Expr]] = {}
        self._expressions: dict[int, Expr] = {}
        self.powers_of_zero: set[int] = set()
        self.empty = False

    # -- rules -----------------------------------------------------------------------------------

    @abstractmethod
    def form(self, expr: sp.Basic) -> Fraction:
        """Return the normal form of an expression."""

    @abstractmethod
    def root(self, f: Fraction, exponent: fmpq) -> Fraction:
        """Return f**exponent, the principal value."""

    @abstractmethod
    def exponential(self, f: Fraction) -> Fraction:
        """Return exp(f)."""

    @abstractmethod
    def logarithm(self, f: Fraction) -> Fraction:
        """Return log(f), the principal value."""

    @abstractmethod
    def modulus(self, f: Fraction) -> Fraction:
        """Return |f|."""

    @abstractmethod
    def cos_sin_of_arc(self, kernel: tuple[object, ...], r: fmpq) -> tuple[Fraction, Fraction] | None:
        """Return cos and sin of r times an inverse circular function, where there is a rule."""

    @abstractmethod
    def sign_of_constant(self, p: fmpq_mpoly) -> str:
        """Return the proven sign of a polynomial in numbers, or in waves of one frequency."""

    def is_constant(self, generator: int) -> bool:
        """Tell whether a generator is a number."""
        kernel = self.tower.generators[generator]
        if kernel[0] in ("pi", "I", "cyclotomic"):
            return True
        argument = self.arguments.get(kernel)
        if argument is None or kernel[0] == "atan2":
            return False
        below = [k for i, _ in argument.den for k in self.tower.used(self.tower.base(i))]
        return all(self.is_constant(k) for k in (*self.tower.used(argument.num), *below))

    # -- atoms -----------------------------------------------------------------------------------

    def atom(self, kernel: Hashable, sign: str, meaning: Callable[[], Expr]) -> Fraction:
        """Return the generator for a kernel, of the given sign ("" where it may be complex)."""
        index = self.tower.generator(kernel)
        if index not in self._meaning:
            self.signs.declare(index, sign)
            self._meaning[index] = meaning
        return Fraction(self.tower.monomial(index))

    @property
    def pi(self) -> Fraction:
        """The number π."""
        return self.atom(("pi",), "+", lambda: sp.pi)

    @property
    def imaginary_unit(self) -> Fraction:
        """The number i, with i² = −1."""
        fresh = not self.tower.knows(("I",))
        unit = self.atom(("I",), "", lambda: sp.I)
        if fresh:
            self.tower.relate(self.tower.generator(("I",)), 2, self.tower.constant(-1))
        return unit

    def only_kernel(self, f: Fraction) -> tuple[Any, ...] | None:
        """Return the kernel that ``f`` is, to the first power and without coefficient, if it is one."""
        if f.den or len(f.num) != 1 or f.num.total_degree() != 1 or f.num.leading_coefficient() != 1:
            return None
        return self.tower.generators[self.tower.used(f.num)[0]]

    # -- fractions -------------------------------------------------------------------------------

    def negative(self, f: Fraction) -> Fraction:
        """Return −f."""
        return Fraction(-f.num, f.den)

    def minus(self, f: Fraction, g: Fraction) -> Fraction:
        """Return f − g."""
        return self.tower.sum([f, self.negative(g)])

    def over(self, f: Fraction, g: Fraction) -> Fraction:
        """Return f/g."""
        return self.tower.times(f, self.tower.reciprocal(g))

    def scaled(self, number: Any, f: Fraction) -> Fraction:
        """Return a rational multiple."""
        return Fraction(f.num * self.tower.constant(number), f.den)

    def denominator(self, f: Fraction) -> fmpq_mpoly:
        """Return the denominator multiplied out."""
        t = self.tower
        total = t.constant(1)
        for i, e in f.den:
            total = t.product(total, t.polynomial_power(t.base(i), e))
        return total

    def fraction_key(self, f: Fraction) -> Hashable:
        """Return a number that is the same for equal canonical fractions, also when work starts again."""
        bases = frozenset((self.tower.key(self.tower.base(i)), e) for i, e in f.den)
        return self._numbers.setdefault((self.tower.key(f.num), bases), len(self._numbers))

    def is_real(self, f: Fraction) -> bool:
        """Tell whether a fraction is proven real wherever it is defined."""
        return self.signs.real(f.num) and all(self.signs.real(self.tower.base(i)) for i, _ in f.den)

    def sign(self, f: Fraction) -> str:
        """Return the proven sign of a fraction.

        Every base of the denominator must be real, and have a sign where its power is odd. It is not zero
        where the fraction is defined, except that 1/exp(y log u) may stand for u^−y = 0 at u = 0.
        """
        sign = self.signs.of(f.num)
        for i, e in f.den:
            base = self.tower.base(i)
            below = self.signs.of(base) if e % 2 else "+" if self.signs.real(base) else ""
            if not sign or not below:
                return ""
            if self.powers_of_zero.intersection(self.tower.used(base)):
                sign = "0" + sign[-1]
            sign = sign.translate(str.maketrans("+-", "-+")) if below.endswith("-") else sign
        return sign

    def expression(self, p: fmpq_mpoly) -> Expr:
        """Return a polynomial over the tower as a SymPy expression."""
        terms: list[Expr] = []
        for monomial, coefficient in self.tower.terms(p):
            factors: list[Expr] = [sp.Rational(int(coefficient.p), int(coefficient.q))]
            factors.extend(self._kernel_expression(k) ** e for k, e in monomial)
            terms.append(sp.Mul(*factors))
        return sp.Add(*terms)

    def _kernel_expression(self, generator: int) -> Expr:
        found = self._expressions.get(generator)
        if found is None:
            found = self._expressions[generator] = self._meaning[generator]()
        return found

    def fraction_expression(self, f: Fraction) -> Expr:
        """Return a fraction as a SymPy expression."""
        return self.expression(f.num) / self.expression(self.denominator(f))
