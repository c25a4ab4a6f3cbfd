"""A user's program, as mypy and pyright should read it: with canon's types, told by the wheel's py.typed."""

from typing import assert_type

from sympy import cos

from canon import (
    RK4,
    CanonicalTransformation,
    Hamiltonian,
    Lagrangian,
    coordinates,
    drift,
    hamiltonian,
    parameters,
    propagate,
)
from canon.flow import Trajectory
from canon.proof import Status
from canon.study import Growth

theta, (m, l, g) = coordinates("theta"), parameters("m l g", positive=True)
pendulum = Lagrangian(m * l**2 * theta.dot**2 / 2 + m * g * l * cos(theta), [theta])
assert_type(hamiltonian(pendulum), Hamiltonian)
run = propagate(
    hamiltonian(pendulum), (0, 10), [1, 0], method=RK4(), step=0.05, parameters={m: 1, l: 1, g: 9.81}
)
assert_type(run, Trajectory)
assert_type(drift(run).verdict, Growth)
q, p = coordinates("q"), parameters("p")
assert_type(CanonicalTransformation([q], [p], new_q=[p], new_p=[-q]).is_canonical().status, Status)
