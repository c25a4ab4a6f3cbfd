"""Momenta called by their coordinates, p_theta where p is declared, and p where there is only one."""

from __future__ import annotations

import pytest

from tests.exercise.test_found_by_a_cheat import judged

PENDULUM = {
    "kind": "legendre-hamiltonian", "q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "parameters": dict.fromkeys(("m", "g", "l"), "positive"),
}  # fmt: skip
PLANE = {
    "kind": "constant-of-motion", "q": ["x", "y"], "p": ["p1", "p2"],
    "H": "(p1**2 + p2**2)/2 + x**2/2 + y**2/2",
}  # fmt: skip


@pytest.mark.parametrize(
    "typed",
    [r"$H = \frac{p_\theta^2}{2ml^2} - mgl\cos\theta$", "p_θ²/(2ml²) - mgl cosθ", "p²/(2ml²) - mgl cosθ"],
)
@pytest.mark.parametrize("declared", ["p", "p_theta", "ptheta"])
def test_one_momentum(typed: str, declared: str) -> None:
    assert judged(**PENDULUM, p=[declared], H=typed).status == "holds"
    assert judged(**PENDULUM, p=[declared], H=typed.replace("2ml", "ml")).status == "fails"
    assert judged(**PENDULUM, p=[declared], H=typed.replace("-", "+")).status == "fails"


def test_two_momenta() -> None:
    assert judged(**PLANE, I="x*p_y - y*p_x").status == "holds"
    assert judged(**PLANE, I="x*p_y + y*p_x").status == "fails"
    assert judged(**PLANE, I="x*p").status == "invalid"  # which of the two?


def test_names_that_are_declared_keep_their_meaning() -> None:
    of_p = {
        **PENDULUM,
        "p": ["pi_1"],
        "parameters": {**PENDULUM["parameters"], "p_theta": "positive", "p": "positive"},
    }
    assert judged(**of_p, H="pi_1**2/(2*m*l**2) - m*g*l*cos(theta)").status == "holds"
    assert judged(**of_p, H="p**2/(2*m*l**2) - m*g*l*cos(theta)").status == "fails"
    assert judged(**of_p, H="p_theta**2/(2*m*l**2) - m*g*l*cos(theta)").status == "fails"
    assert judged(**PENDULUM, p=["P"], H="p**2/(2*m*l**2) - m*g*l*cos(theta)").status == "invalid"
