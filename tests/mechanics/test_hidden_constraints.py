"""Hidden constraints: chains of rates, contradictions, branches and equations that are not affine in accelerations."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time
from canon.mechanics.lagrange.hidden_constraints import all_motions
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided

x, y = coordinates("x y")
g = parameters("g", positive=True)
push = sp.Symbol("lambda", real=True)


def motions(system, held, q=(x,), multipliers=(), domain=None):
    unknowns = (*(s.ddot for s in q), *multipliers)
    return all_motions(system, held, q, unknowns, domain or Domain(), time)


def chain(n, place):
    """ẍ₁ = x₂, ẍ₂ = x₃ … ẍₙ = λ, with x₁ held at a place."""
    q = coordinates(" ".join(f"x{k}" for k in range(1, n + 1)))
    system = [a.ddot - b for a, b in zip(q, (*q[1:], push), strict=True)]
    return motions(system, [q[0] - place, q[0].dot - sp.diff(place, time)], q, (push,)).through, q


@pytest.mark.parametrize("n", [2, 4])
def test_a_chain_is_bound_to_the_last_rate_of_what_its_first_place_is(n):
    found, q = chain(n, time**8)
    for k, s in enumerate(q):
        assert sp.expand(found[s] - (time**8).diff(time, 2 * k)) == 0
    assert sp.expand(found[push] - (time**8).diff(time, 2 * n)) == 0
    assert sp.expand(found[push] - (time**8).diff(time, 2 * n - 1)) != 0


def test_a_chain_of_more_rates_than_are_taken_is_left_undecided():
    with pytest.raises(Undecided, match="bind the state further with every rate that is taken"):
        chain(6, sp.S.Zero)


@pytest.mark.parametrize("pull", [sp.S.One, g])
def test_what_falls_is_not_held(pull):
    with pytest.raises(Undecided, match=f"the equations ask for {pull} = 0, so that there is no motion"):
        motions([x.ddot - pull], [x, x.dot])
    held_by_a_force = motions([x.ddot - pull - push], [x, x.dot], multipliers=(push,))
    assert held_by_a_force.through[push] == -pull


def test_of_two_places_the_domain_says_which():
    system, held = [x.ddot - push], [x**2 - 1, x.dot]
    with pytest.raises(Undecided, match="to several branches; split the claim by the domain"):
        motions(system, held, multipliers=(push,))
    assert motions(system, held, multipliers=(push,), domain=Domain((x > 0,))).through[x] == 1
    assert motions(system, held, multipliers=(push,), domain=Domain((x < 0,))).through[x] == -1


@pytest.mark.parametrize("f", [x.ddot**2 - 1, sp.sin(x.ddot) - y, x.ddot * y.ddot - x])
def test_equations_are_solved_where_they_are_affine_in_the_accelerations(f):
    with pytest.raises(Undecided, match=r"= 0 is not affine in the accelerations"):
        motions([f, y.ddot], [], (x, y))
    found = motions(
        [(x.ddot + 1) ** 2 - x.ddot**2 - y, y.ddot], [], (x, y)
    )  # affine, though not as it is written
    assert sp.expand(found.through[x.ddot] - (y - 1) / 2) == 0


def test_whether_a_combination_binds_the_state_may_not_be_decided():
    """Li₂(x) + Li₂(1 − x) + log x log(1 − x) = π²/6 (Euler) is not proved here, and its double is not refuted."""
    euler = sp.polylog(2, x) + sp.polylog(2, 1 - x) + sp.log(x) * sp.log(1 - x) - sp.pi**2 / 6
    inside = Domain((x > 0, x < 1))
    for f in (euler, 2 * euler):
        with pytest.raises(
            Undecided, match=r"whether the equations bind the state by .*polylog.* = 0 was not decided"
        ):
            motions([f, y.ddot - x], [], (x, y), domain=inside)
    bound = motions([y, x.ddot - x], [], (x, y), domain=inside)
    assert bound.through[y] == 0
