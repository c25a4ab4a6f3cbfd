"""The front door: every public name is there, and ``import canon`` loads nothing heavy."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import canon


def test_every_public_name_resolves():
    for name in canon.__all__:
        assert getattr(canon, name) is not None


def test_the_front_door_keeps_what_people_type_first():
    assert len(canon.__all__) <= 62


ROOMS = ("mechanics", "flow", "study", "exercise", "expression", "proof")


@pytest.mark.parametrize("room", ROOMS)
def test_every_name_of_a_room_resolves(room):
    door = getattr(canon, room)
    assert door.__all__
    for name in door.__all__:
        assert getattr(door, name) is not None


@pytest.mark.parametrize("room", ROOMS)
def test_the_front_door_and_the_rooms_have_the_same_things(room):
    """A public name of the front door that a room has too is the same thing there."""
    door = getattr(canon, room)
    for name in {*door.__all__} & {*canon.__all__}:
        assert getattr(door, name) is getattr(canon, name)


def test_the_time_symbol_is_there_but_does_not_shadow_the_standard_library():
    code = "import time\nfrom canon import *\nprint(time.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["time"]
    assert canon.time.name == "t"


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(canon, "poison_bracket")


def modules_after(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def loaded_after(statement: str) -> set[str]:
    return {name.split(".")[0] for name in modules_after(statement)}


def test_a_choice_of_methods_loads_neither_constraints_nor_proofs():
    loaded = modules_after("from canon.study import choose\nchoose")
    assert "canon.study.method_choice.candidate" in loaded
    assert (
        not {
            "canon.proof.vanish",
            "canon.flow.equations.lagrangian_motion",
            "canon.flow.equations.constrained.holonomic_motion",
            "canon.mechanics.lagrange.constraint",
        }
        & loaded
    )


def test_import_canon_loads_no_room():
    assert not {"sympy", "numpy", "scipy", "heyoka", "llvmlite", "matplotlib", "flint"} & loaded_after(
        "import canon"
    )


MOVED = (
    "import canon\n"
    "x = canon.coordinates('x')\n"
    "H = canon.Hamiltonian(x.momentum**2/2 + x**4/4, x, x.momentum)\n"
    "canon.propagate(H, (0, 1), [1.0, 0.0], method={method}, step={step})"
)
NOT_ASKED_FOR = {
    "heyoka",
    "canon.proof.vanish",
    "canon.flow.equations.lagrangian_motion",
    "canon.kernel.magnetic.boris",
}


@pytest.mark.parametrize(
    ("method", "step", "own", "other"),
    [
        ("'verlet'", 0.1, "canon.kernel.loops.splitting", "canon.kernel.loops.gauss"),
        ("canon.Gauss(3)", 0.1, "canon.kernel.loops.gauss", "canon.kernel.loops.splitting"),
        ("canon.DOP853()", None, "canon.flow.adaptive.dop853", "canon.flow.adaptive.taylor_motion"),
    ],
)
def test_a_motion_loads_no_proofs_and_no_other_method(method, step, own, other):
    loaded = modules_after(MOVED.format(method=method, step=step))
    assert own in loaded
    assert not {other, *NOT_ASKED_FOR} & loaded


def test_a_verdict_needs_no_integrator():
    loaded = loaded_after(
        "import canon\n"
        "x = canon.coordinates('x')\n"
        "assert canon.vanishes(x - x).holds\n"
        "canon.Lagrangian(x.dot**2/2, (x,)).equations"
    )
    assert "sympy" in loaded
    assert not {"scipy", "heyoka", "llvmlite", "matplotlib"} & loaded


def test_a_mistyped_name_is_told_the_nearest():
    with pytest.raises(AttributeError, match="did you mean poisson_bracket"):
        assert canon.poison_bracket


def test_rooms_open_when_they_are_named():
    done = subprocess.run(
        [sys.executable, "-c", "import canon; print(canon.scene.find('kepler').name, canon.plot.COLOURS[0])"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.split() == ["kepler", "#0072B2"]


def test_no_module_has_the_name_of_what_its_room_gives():
    """It would hide it: ``from room import name`` then gives the module."""
    stubs = Path(canon.__file__).parent.rglob("__init__.pyi")
    hidden = [
        f"{stub.parent.name}: {name}"
        for stub in stubs
        for name in re.findall(r"^from \.(\w+) import \1 as", stub.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert hidden == []
