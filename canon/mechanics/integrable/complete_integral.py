"""The Hamilton–Jacobi equation: complete integrals by separation of variables, as quadratures, proved."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.classical_coordinates import Chart, charts_for, isotropic_coefficient
from canon.mechanics.integrable.function_splitting import common_factor
from canon.mechanics.integrable.separability import is_separable
from canon.mechanics.integrable.separated_momenta import (
    NotSeparatedError,
    SeparatedMomentum,
    separated_momenta,
)
from canon.proof.domain.domain import EVERYWHERE, Domain, as_domain
from canon.proof.domain.verdict import Status, Verdict
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["CompleteIntegral", "hamilton_jacobi"]


@dataclass(frozen=True)
class CompleteIntegral:
    """A complete integral W(q, α) of H(q, ∂W/∂q) = E: a sum of quadratures, kept as their integrands.

    Parameters
    ----------
    H
        The Hamiltonian in the coordinates in which it separates.
    momenta
        p_i = ∂W/∂q_i as functions of q_i and the constants.
    constants
        The constants α, the energy last.
    defined_as
        The constants as functions of (q, p): integrals of the motion in involution.
    separable
        What was found of Levi-Civita's conditions.
    chart
        The classical coordinates, and how the given ones follow from them; None where the given ones separate.
    domain
        Where all this is meant.

    Examples
    --------
    >>> r, m, k = sp.symbols("r m k", positive=True)
    >>> phi, p_r, p_phi = sp.symbols("phi p_r p_phi", real=True)
    >>> kepler = hamilton_jacobi(Hamiltonian(p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r, [r, phi], [p_r, p_phi]))
    >>> kepler.constants
    (alpha_phi, E)
    >>> kepler.momenta[0].square
    2*E*m - alpha_phi**2/r**2 + 2*k*m/r
    >>> kepler.is_complete_integral().status.name
    'HOLDS'
    """

    H: Hamiltonian
    momenta: tuple[SeparatedMomentum, ...]
    constants: tuple[Symbol, ...]
    defined_as: Mapping[Symbol, Expr] = field(repr=False)
    separable: Verdict = field(repr=False)
    chart: Chart | None = None
    domain: Domain = field(default=EVERYWHERE, repr=False)

    @property
    def energy(self) -> Symbol:
        """The symbol of the energy, the last of the constants."""
        return self.constants[-1]

    @cached_property
    def W(self) -> Expr:
        """Hamilton's characteristic function Σ ∫ p_i dq_i, with each root positive and integrals as they stand."""
        return sp.Add(*(_quadrature(m.value(), m.q) for m in self.momenta))

    @cached_property
    def mixed_derivatives(self) -> sp.ImmutableDenseMatrix:
        """∂²W/∂q_i∂α_j = ∂p_i/∂α_j, of shape (n, n)."""
        return sp.ImmutableDenseMatrix([[m.value().diff(c) for c in self.constants] for m in self.momenta])

    @cached_property
    def motion(self) -> tuple[Expr, ...]:
        """∂W/∂α_j as integrals over the coordinates: constants of the motion, but for t + constant at the energy."""
        return tuple(
            sp.Add(*(_quadrature(m.value().diff(c), m.q) for m in self.momenta)) for c in self.constants
        )

    def is_complete_integral(self, budget: float = 10.0) -> Verdict:
        """Tell whether H(q, ∂W/∂q) = E identically, for both signs of each root, and det ∂²W/∂q∂α ≠ 0.

        Returns
        -------
        Verdict
            HOLDS with what was proved of both; FAILS where either is certainly wrong.
        """
        question = "W is a complete integral of the Hamilton–Jacobi equation"
        solved = all_vanish(
            self._equations(),
            question,
            self.domain,
            budget / 2,
        )
        if not solved.holds:
            return solved
        determinant = self._determinant()
        if determinant == 0:
            why = "det ∂²W/∂q∂α = 0: the constants are not independent"
            return Verdict(Status.FAILS, question, "exact", determinant, feedback=why)
        independent = vanishes_off_kinks(determinant, self.domain, budget / 2)
        if independent.fails:
            return solved
        why = "det ∂²W/∂q∂α vanishes" if independent.holds else "whether det ∂²W/∂q∂α ≠ 0 was not decided"
        status = Status.FAILS if independent.holds else Status.UNDECIDED
        return Verdict(status, question, independent.certificate, determinant, feedback=why)

    def _determinant(self) -> Expr:
        """Return det ∂²W/∂q∂α, multiplied out but for what each row has in common, such as 1/√(p_i²)."""
        rows = [self.mixed_derivatives.row(i).tolist()[0] for i in range(len(self.momenta))]
        common = [common_factor(row) for row in rows]
        plain = sp.Matrix([[f / g for f in row] for row, g in zip(rows, common, strict=True)])
        return sp.Mul(*common, cast("Expr", plain.det(method="berkowitz")))

    def _equations(self) -> list[tuple[str, Expr]]:
        """Return H(q, ∂W/∂q) − E for the signs of the roots: all positive, then each of them negative alone.

        H is of second degree in each momentum without products of them, so that these are all signs.
        """
        positive = {m.p: m.value() for m in self.momenta}
        cases = [("H(q, ∂W/∂q) = E", positive)]
        cases += [
            (f"H(q, ∂W/∂q) = E with {m.p} < 0", positive | {m.p: m.value(-1)})
            for m in self.momenta
            if m.square is not None
        ]
        return [(name, substitute(self.H.H, p) - self.energy) for name, p in cases]

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle W = {sp.latex(self.W)}$"


def hamilton_jacobi(
    H: Hamiltonian,
    coordinates: str = "given",
    focal: Expr | None = None,
    domain: Domain | None = None,
    energy: Symbol | None = None,
    budget: float = 10.0,
) -> CompleteIntegral:
    """Return a complete integral of H(q, ∂W/∂q) = E by separation of variables, proved.

    Parameters
    ----------
    H
        A Hamiltonian without the time in it, at most quadratic in each momentum; any consistent units.
    coordinates
        ``"given"``: those of H. ``"any"``: those, and then the classical ones over Cartesian coordinates of a plane or
        of space, one after another until H separates. Or one of them by name: ``"polar"``, ``"parabolic"``,
        ``"elliptic"``, ``"spherical"``, ``"cylindrical"``, ``"paraboloidal"``, ``"prolate"``.
    focal
        Half the distance of the foci, for elliptic and prolate coordinates, which are left out without it. The foci of
        the elliptic ones are on the first axis, those of the prolate ones on the third.
    domain
        Where the given coordinates are meant.
    energy
        The symbol of the energy; E unless given.
    budget
        Seconds for the conditions of each kind of coordinates, and again for the proof of what was found.

    Raises
    ------
    NotSeparatedError
        Where H separates in none of the coordinates, with the condition that fails; or where it does but the separated
        equations were not found.
    ValueError
        Where H depends on the time, or holds a symbol of the name of the energy's.

    Examples
    --------
    >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    >>> k = sp.Symbol("k", positive=True)
    >>> central = Hamiltonian((px**2 + py**2)/2 - k/sp.sqrt(x**2 + y**2), [x, y], [px, py])
    >>> found = hamilton_jacobi(central, "any")
    >>> found.chart.name, [str(m.square) for m in found.momenta]
    ('polar', ['2*E - alpha_phi**2/r**2 + 2*k/r', 'None'])
    >>> henon_heiles = Hamiltonian((px**2 + py**2 + x**2 + y**2)/2 + x**2*y - y**3/3, [x, y], [px, py])
    >>> try:
    ...     hamilton_jacobi(henon_heiles)
    ... except NotSeparatedError as error:
    ...     print(str(error)[:61])
    H does not separate in x, y: x and y do not separate: Levi-Ci
    """
    given_kind(H, Hamiltonian, "what hamilton_jacobi() takes", "give Hamiltonian(H, q, p)")
    domain = as_domain(domain)
    E = Symbol("E", real=True) if energy is None else energy
    if E.name in {s.name for s in (*H.q, *H.p, H.t, *symbols_of(H.H))}:
        raise ValueError(f"{E} already stands in H; give another symbol for the energy: energy=Symbol(…)")
    refused: list[str] = []
    if coordinates in ("given", "any"):
        verdict = is_separable(H, domain, budget)
        if verdict.holds:
            return _integral(H, E, domain, verdict, None, budget)
        refused.append(_refusal(verdict, ", ".join(map(str, H.q))))
    if coordinates != "given":
        found = _in_charts(H, E, charts_for(H, coordinates, focal), budget, refused)
        if found is not None:
            return found
    elif isotropic_coefficient(H) is not None and len(H.q) > 1:
        refused.append('coordinates="any" tries the classical ones, such as polar')
    raise NotSeparatedError("; ".join(refused))


def _in_charts(
    H: Hamiltonian, E: Symbol, charts: Sequence[Chart], budget: float, refused: list[str]
) -> CompleteIntegral | None:
    """Return the integral in the first coordinates that separate H; add why the others do not to ``refused``."""
    for chart in charts:
        lifted = chart.hamiltonian(H)
        verdict = is_separable(lifted, EVERYWHERE, budget)
        if not verdict.holds:
            refused.append(_refusal(verdict, f"{chart.name} coordinates"))
            continue
        try:
            return _integral(lifted, E, EVERYWHERE, verdict, chart, budget)
        except NotSeparatedError as error:
            refused.append(f"in {chart.name} coordinates {error}")
    return None


def _integral(
    H: Hamiltonian, E: Symbol, domain: Domain, separable: Verdict, chart: Chart | None, budget: float
) -> CompleteIntegral:
    momenta, constants = separated_momenta(H, E, domain)
    domain = replace(
        domain, conditions=(*domain.conditions, *(m.where for m in momenta if m.where != sp.true))
    )
    found = CompleteIntegral(
        H, momenta, tuple(c for c, _ in constants), dict(constants), separable, chart, domain
    )
    proved = found.is_complete_integral(budget)
    if not proved.holds:
        raise NotSeparatedError(
            f"H separates, but the integral that was found is not proved: {proved.feedback or proved.status.value}; "
            "declare what is positive, or give a domain"
        )
    return found


def _refusal(verdict: Verdict, where: str) -> str:
    if verdict.fails:
        return f"H does not separate in {where}: {verdict.feedback}"
    return (
        f"whether H separates in {where} was not decided; declare what is positive, or give a larger budget"
    )


def _quadrature(f: Expr, q: Symbol) -> Expr:
    """Return ∫ f dq as it stands; a constant times q where f does not depend on q."""
    if not f.has(q):
        return f * q
    return sp.Integral(f, q)
