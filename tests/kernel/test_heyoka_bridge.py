"""Hamilton's equations as canon derives them, against heyoka's own."""

import heyoka as hy
import numpy as np
import pytest
import sympy as sp

from canon import Gauss, Hamiltonian, propagate
from canon.kernel.heyoka_bridge import heyoka_equations, heyoka_expressions
from canon.kernel.program.hamilton_equations import equations
from tests.flow.systems import DOUBLE_PENDULUM, DRIVEN, HENON_HEILES, KEPLER, PENDULUM, System, x


@pytest.mark.parametrize("system", [PENDULUM, HENON_HEILES, KEPLER, DRIVEN, DOUBLE_PENDULUM], ids=range(5))
def test_hamiltons_equations_agree_with_heyokas(system):
    made = equations(system.H, system.q, system.p, system.t, {})
    ours = heyoka_equations(made)
    n = len(system.q)
    variables = [variable for variable, _ in ours]
    table = {**dict(zip((*system.q, *system.p), variables, strict=True)), system.t: hy.time}
    (H,) = heyoka_expressions(made.graph, [made.hamiltonian], table)
    theirs = hy.hamiltonian(H, variables[:n], variables[n:])
    assert [str(variable) for variable, _ in theirs] == [str(variable) for variable in variables]
    points = np.random.default_rng(1).uniform(0.3, 1.2, (2 * n, 20))
    values = [
        hy.cfunc([rate for _, rate in pairs], variables)(points, time=np.linspace(0, 2, 20))
        for pairs in (ours, theirs)
    ]
    np.testing.assert_allclose(values[0], values[1], rtol=1e-13, atol=1e-14)


def test_every_function_reaches_heyoka():
    real = sp.Symbol("x", real=True)
    names = [
        "sin",
        "cos",
        "tan",
        "exp",
        "asin",
        "acos",
        "atan",
        "sinh",
        "cosh",
        "tanh",
        "asinh",
        "atanh",
        "Abs",
    ]
    functions = [getattr(sp, name) for name in names]
    graph_of = equations(sum(f(real) for f in functions), (real,), (sp.Symbol("p"),), sp.Symbol("t"), {})
    terms = [graph_of.node(f(real), "f") for f in functions]
    variable = hy.expression("x")
    found = hy.cfunc(heyoka_expressions(graph_of.graph, terms, {real: variable}), [variable])([0.4])
    true = [float(f(sp.Rational(2, 5))) for f in functions]
    np.testing.assert_allclose(found, true, rtol=1e-14)


def test_a_jump_is_refused():
    jump = System(x.momentum**2 / 2 + sp.Abs(x), (x,), (x.momentum,))
    with pytest.raises(ValueError, match="sign"):
        heyoka_equations(equations(jump.H, jump.q, jump.p, jump.t, {}))


@pytest.mark.parametrize("power", [3, 4, 5, 6, 9])
def test_a_motion_starts_where_a_power_vanishes(power):
    """heyoka's series of x ** 3 divides by x; from x = 0 the motion is that of another method all the same."""
    q, p = sp.symbols("q p", real=True)
    hamiltonian = Hamiltonian(p**2 / 2 + q**2 / 2 + q**power / power, q, p)
    motion = propagate(hamiltonian, (0.0, 3.0), [0.0, 0.5], samples=1)
    other = propagate(hamiltonian, (0.0, 3.0), [0.0, 0.5], method=Gauss(6), step=0.01, samples=1)
    np.testing.assert_allclose(motion.final, other.final, atol=1e-13)
