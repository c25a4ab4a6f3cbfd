"""Methods as values."""

from fractions import Fraction

import pytest

from canon.flow.method.engine import needs_hamiltonian
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor, TimeTransformed
from canon.flow.system.equations_for_method import KEEPING_CONSTRAINTS
from canon.kernel.schemes.splitting_schemes import SCHEMES


@pytest.mark.parametrize("name", SCHEMES)
def test_named_splittings_say_what_they_are(name):
    method = Splitting(name)
    assert repr(method) == f"Splitting('{name}')"
    assert method == Splitting(name)
    assert method.order == SCHEMES[name].order
    assert "doi:" in method.citation
    assert hash(method) == hash(Splitting(name))


def test_own_coefficients_are_measured_and_completed():
    verlet = Splitting(a=[0.5, 0.5], b=[1.0])
    assert (verlet.order, verlet.stages) == (2, 1)
    euler = Splitting(a=[1], b=[1])
    assert euler.order == 1
    assert euler.scheme.a == (1, 0)
    kahan_li = SCHEMES["kahan-li-8"]
    assert Splitting(a=list(map(float, kahan_li.a)), b=list(map(float, kahan_li.b))).order == 8
    assert Splitting(a=["1/3", "2/3"], b=["1"]).scheme.a == (Fraction(1, 3), Fraction(2, 3))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "say which"),
        ({"name": "verlet", "a": [1], "b": [1]}, "say which"),
        ({"a": [1]}, "say which"),
        ({"name": "leapfrog"}, "kahan-li-8"),
        ({"a": [0.5, 0.6], "b": [1]}, "add up to 1.1"),
        ({"a": [0.5, 0.5], "b": [0.9]}, "add up to 0.9"),
        ({"a": [1.0], "b": [0.5, 0.5]}, "alternate"),
        ({"a": [float("nan"), 1], "b": [1]}, "finite"),
        ({"a": [], "b": []}, "alternate"),
    ],
)
def test_wrong_splittings_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Splitting(**arguments)


@pytest.mark.parametrize("inner", ["verlet", 3, None, RK4(), Taylor(), Splitting])
def test_what_time_is_transformed_for_is_a_splitting_or_a_gauss_method(inner):
    with pytest.raises(TypeError, match=r"TimeTransformed\(Splitting\('verlet'\)\)"):
        TimeTransformed(inner)
    assert str(TimeTransformed(Splitting("verlet"))) == "verlet, time-transformed"


def test_tolerances_are_checked_and_shown():
    assert str(Taylor(1e-9)) == "Taylor(1e-09)"
    assert Taylor(1e-9).order < Taylor().order
    assert str(RK4()) == "RK4"
    assert (Gauss(6).order, str(Gauss(6))) == (12, "Gauss(6)")
    for stages in (0, 9, 2.5):
        with pytest.raises(ValueError, match="1 … 8"):
            Gauss(stages)
    for wrong in (0.0, -1e-9, 2.0, float("nan")):
        with pytest.raises(ValueError, match="between 0 and 1"):
            Taylor(wrong)
        with pytest.raises(ValueError, match="between 0 and 1"):
            DOP853(wrong)


def test_methods_that_keep_constraints_need_no_hamiltonian():
    assert not any(map(needs_hamiltonian, KEEPING_CONSTRAINTS))
    assert all(map(needs_hamiltonian, ("splitting", "solvable", "boris")))
