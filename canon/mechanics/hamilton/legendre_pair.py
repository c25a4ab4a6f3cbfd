"""Legendre's transformation both ways: the Hamiltonian of a Lagrangian, the Lagrangian of a Hamiltonian."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import momentum, velocity
from canon.expression.symbols.user_input import counted, given_kind
from canon.mechanics.algebra.all_vanish import having_values
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.legendre import (
    LegendreError,
    check_momenta,
    eliminate_velocities,
    is_dual,
    legendre_residual,
    where_root_is_real,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Status, Verdict, all_hold
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

__all__ = ["LegendreError", "hamiltonian", "has_hamiltonian", "is_hamiltonian_of", "lagrangian"]


def hamiltonian(
    lagrangian: Lagrangian, p: Sequence[Symbol] | None = None, domain: Domain | None = None
) -> Hamiltonian:
    """Return H(q, p, t) = Σ p q̇ − L with the velocities eliminated.

    Momenta linear in the velocities are solved by elimination, others (such as relativistic ones) in
    closed form on the branch that the domain determines, and that branch is proved.

    Parameters
    ----------
    lagrangian
        A Lagrangian without non-potential forces.
    p
        Symbols for the momenta; ``q.momentum`` unless given.
    domain
        Conditions on q, q̇ and t, such as a speed below that of light.

    Raises
    ------
    LegendreError
        With the null direction, where the velocity Hessian is singular; where the velocities have no
        closed form; or where forces without a potential act.
    ValueError
        The number of momenta is wrong, or one is called as another symbol in L is.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> (r, phi) = coordinates("r phi")
    >>> m = parameters("m", positive=True)
    >>> hamiltonian(Lagrangian(m*(r.dot**2 + r**2*phi.dot**2)/2, [r, phi])).H
    p_phi**2/(2*m*r**2) + p_r**2/(2*m)

    A Lagrangian is meant where it is real, here below the speed of light:

    >>> from sympy import sqrt
    >>> x, c = coordinates("x"), parameters("c", positive=True)
    >>> hamiltonian(Lagrangian(-m*c**2*sqrt(1 - x.dot**2/c**2), [x])).H
    c*sqrt(c**2*m**2 + p_x**2)
    """
    given_kind(lagrangian, Lagrangian, "what hamiltonian() transforms", "lagrangian() goes the other way")
    _check_no_forces(lagrangian)
    momenta = coordinate_symbols(p) if p is not None else tuple(momentum(q) for q in lagrangian.q)
    if len(momenta) != len(lagrangian.q):
        raise ValueError(
            f"{counted(len(momenta), 'momentum', 'momenta')} for "
            f"{counted(len(lagrangian.q), 'coordinate')}; each needs one"
        )
    check_momenta(momenta, lagrangian, "hamiltonian(L, p=[…])")
    H = eliminate_velocities(
        lagrangian.L, lagrangian.velocities, momenta, as_domain(domain), "L", "velocities"
    )
    return Hamiltonian(H, lagrangian.q, momenta, lagrangian.t)


def _check_no_forces(lagrangian: Lagrangian) -> None:
    if any(Q != 0 for Q in lagrangian.forces):
        raise LegendreError(
            "the system has forces without a potential; Hamilton's equations of H alone would miss them. "
            "Put what has a potential into L, or stay with Lagrange's equations"
        )


def lagrangian(hamiltonian: Hamiltonian, domain: Domain | None = None) -> Lagrangian:
    """Return L(q, q̇, t) = Σ p q̇ − H with the momenta eliminated.

    Parameters
    ----------
    hamiltonian
        A Hamiltonian, regular in its momenta.
    domain
        Conditions on q, p and t that choose the branch.

    Raises
    ------
    LegendreError
        Where ∂²H/∂p² is singular, or p cannot be found as a function of q̇ in closed form.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> lagrangian(Hamiltonian(x.momentum**2/6, x, x.momentum)).L
    3*x_dot**2/2
    """
    given_kind(hamiltonian, Hamiltonian, "what lagrangian() transforms", "hamiltonian() goes the other way")
    H, velocities = hamiltonian, tuple(velocity(q) for q in hamiltonian.q)
    L = eliminate_velocities(H.H, H.p, velocities, as_domain(domain), "H", "momenta")
    return Lagrangian(L, H.q, t=H.t)


def has_hamiltonian(lagrangian: Lagrangian, domain: Domain | None = None) -> Verdict:
    """Tell whether the velocities can be eliminated: whether ∂²L/∂q̇² is regular at generic points.

    Raises
    ------
    LegendreError
        Where forces without a potential act.

    Examples
    --------
    >>> from canon import coordinates
    >>> (x, y) = coordinates("x y")
    >>> has_hamiltonian(Lagrangian((x.dot + y.dot)**2, [x, y])).feedback
    'the velocity Hessian is singular: it maps the direction (-1, 1) to zero'
    """
    _check_no_forces(lagrangian)
    return is_regular(lagrangian.mass_matrix, domain, "the velocity Hessian")


def is_hamiltonian_of(
    lagrangian: Lagrangian, H: Expr, p: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether H is the Hamiltonian of a Lagrangian.

    The velocity Hessian must be regular and H(q, ∂L/∂q̇, t) = Σ p q̇ − L, so nothing has to be inverted.

    Raises
    ------
    LegendreError
        Where forces without a potential act.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> L = Lagrangian(x.dot**2/2 - x**2, [x])
    >>> is_hamiltonian_of(L, x.momentum**2/2 + x**2, [x.momentum]).status.name
    'HOLDS'
    >>> is_hamiltonian_of(L, x.momentum**2/2 - x**2, [x.momentum]).status.name
    'FAILS'
    """
    _check_no_forces(lagrangian)
    domain = where_root_is_real(lagrangian.L, lagrangian.velocities, as_domain(domain))
    question = "H is the Hamiltonian of L"

    momenta = coordinate_symbols(p)
    energy = plain(H, (*lagrangian.q, *momenta), lagrangian.t)

    def verdicts() -> Iterator[Verdict]:
        yield has_hamiltonian(lagrangian, domain)
        residual = legendre_residual(
            energy, dict(zip(momenta, lagrangian.momenta, strict=True)), lagrangian.jacobi_energy
        )
        plainly = vanishes_off_kinks(residual, domain)
        if plainly.status is Status.UNDECIDED and len(momenta) == 1:
            (v,), (p,) = lagrangian.velocities, momenta
            if is_dual(energy, lagrangian.L, v, p):
                plainly = Verdict(Status.HOLDS, question, "exact")
        yield plainly

    there = substitute(energy, dict(zip(momenta, lagrangian.momenta, strict=True)))
    return having_values(all_hold(verdicts(), question), {"H": there}, [lagrangian.L], domain)
