"""Arguments and methods as other libraries call them: refused, with the name that they have here."""

import pytest

from canon import Taylor, propagate
from canon.flow.method.method_text import method_named


@pytest.mark.parametrize(
    ("name", "here"),
    [
        ("t_eval", "times="), ("args", "parameters="), ("rtol", "tolerance="), ("atol", "tolerance="),
        ("dense_output", "dense=True"), ("first_step", "max_step="), ("dt", "step="), ("until", "t_span="),
        ("x0", "y0="), ("tolerence", "tolerance="), ("wibble", "precision"),
    ],
)  # fmt: skip
def test_an_argument_of_another_library_is_named_as_here(name, here):
    with pytest.raises(TypeError, match=f"no argument {name}=.*{here}"):
        propagate("kepler", (0, 1), **{name: 1})


def test_all_unknown_arguments_are_told_at_once():
    with pytest.raises(TypeError, match=r"rtol=.*; .*t_eval="):
        propagate("kepler", (0, 1), rtol=1e-8, t_eval=[0, 1])


def test_known_arguments_are_not_refused():
    assert propagate("kepler", (0, 1), method=Taylor(), samples=3).steps > 0


@pytest.mark.parametrize(
    ("name", "here"),
    [
        ("RK45", "dop853"), ("RK23", "taylor"), ("LSODA", "gauss-2"), ("Radau", "gauss-2"), ("BDF", "gauss-2"),
        ("leapfrog", "verlet"), ("Störmer-Verlet", "verlet"), ("yoshida4", "forest-ruth"), ("WHFast", "wisdom-holman"),
        ("IAS15", "taylor"), ("implicit midpoint", "gauss-1"),
    ],
)  # fmt: skip
def test_a_method_of_another_library_is_named_as_here(name, here):
    with pytest.raises(ValueError, match=f"{name!r} here.*{here}"):
        method_named(name)
    assert method_named(here)  # what the sentence names is there
