"""What is asked of a motion by name, what it has not, and methods as files write them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import (
    DOP853,
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    TimeTransformed,
    VectorField,
    coordinates,
    propagate,
)
from canon.flow import AverageVectorField
from canon.flow.geometry.numeric_evidence import bilinear_covariant
from canon.flow.method.method_text import method_from
from canon.flow.propagation import Interrupted
from canon.flow.record_data import _Writer
from canon.mechanics import GibbsAppell
from canon.mechanics.lagrange.body import Particle

x, y = coordinates("x y")
SWING = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
DAMPED = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 5])


def test_time_energy_and_work_are_found_by_name() -> None:
    motion = propagate(DAMPED, (0, 3), [1.0, 0.0], samples=5)
    assert (motion["t"] == motion.t).all()
    assert motion["energy"] == pytest.approx((motion["x"] ** 2 + motion["x_dot"] ** 2) / 2, abs=1e-15)
    assert motion["work"] == pytest.approx(motion["energy"] - 0.5, abs=1e-13)
    assert (np.diff(motion["work"]) < 0).all()


def test_velocities_are_quasi_velocities_of_a_kind_and_momenta_are_none() -> None:
    u = sp.Symbol("u", real=True)
    ball = Particle(1, (x, sp.S.Zero))
    fast = propagate(GibbsAppell([ball], [x], u=[u], q_dot=[2 * u]), (0, 1), [0.0, 3.0], samples=2)
    assert fast.u[0] == pytest.approx([3, 3, 3])
    assert fast.q[0] == pytest.approx([0, 3, 6], abs=1e-14)
    plain = propagate(DAMPED, (0, 1), [1.0, 0.5], samples=2)
    assert (plain.u == plain.v).all()
    field = propagate(VectorField([y, -x], [x, y]), (0, 1), [1.0, 0.0], samples=2)
    for motion in (field, propagate(SWING, (0, 1), [1.0, 0.0], samples=2)):
        with pytest.raises(AttributeError, match="the state of this system has no quasi-velocities"):
            _ = motion.u


@pytest.mark.parametrize("kind", ["multipliers", "reactions", "residuals"])
@pytest.mark.parametrize("system", [SWING, VectorField([y, -x], [x, y])])
def test_a_motion_without_constraints_has_nothing_of_theirs(system: Any, kind: str) -> None:
    motion = propagate(system, (0, 1), [1.0, 0.0], samples=2)
    with pytest.raises(AttributeError, match=f"has no constraints, so the motion has no {kind}"):
        motion.record.of_constraints(kind)


def test_the_work_done_on_a_hamiltonian_is_its_change_of_energy() -> None:
    with pytest.raises(AttributeError, match="the work done on a Hamiltonian system is its energy_change"):
        _ = propagate(SWING, (0, 1), [1.0, 0.0], samples=2).work


def test_what_a_file_would_not_give_back_is_not_kept() -> None:
    writer = _Writer()
    assert writer.of(np.array([1.5, 2.5])) == {"array": "array_0"}
    with pytest.raises(ValueError, match="an array of object can't be kept in a file exactly"):
        writer.of(np.array([{}, {}], dtype=object))
    with pytest.raises(
        ValueError, match=r"a set can't be kept in a file exactly: keep the states instead, motion\.to_x"
    ):
        writer.of({1, 2})


def test_methods_are_read_from_tables() -> None:
    assert method_from({"dop853": True}) == DOP853()
    assert method_from({"dop853": 1e-9}) == DOP853(1e-9)
    for wrong in ({"dop853": 1e-9, "step": 0.1}, {"dop853": False}, {"dop853": 9}):
        with pytest.raises(ValueError, match=r"no method is written dop853 = .*\{ dop853 = tolerance \}"):
            method_from(wrong)
    assert method_from({"splitting": {"a": ["1/2", 0.5], "b": [1]}}).order == 2
    for a in ("1/2", [1] * 10_001):
        with pytest.raises(
            ValueError, match=r"the coefficients of a splitting are a list of at most \d+ numbers"
        ):
            method_from({"splitting": {"a": a, "b": [1]}})
    assert method_from({"time_transformed": "verlet"}) == TimeTransformed(Splitting("verlet"))
    with pytest.raises(
        ValueError, match="in transformed time: a study takes the splittings, which need no function g"
    ):
        method_from({"time_transformed": "gauss-4"})
    with pytest.raises(
        ValueError, match="no splitting by solvable parts is called 'verlet'; there are wisdom-holman"
    ):
        method_from({"solvable": "verlet"})


def test_methods_name_where_they_were_published() -> None:
    """Quispel and McLaren's has order 2, Hairer's more; Mikkola and Tanikawa's time needs no function g."""
    assert AverageVectorField(2).citation.startswith("G. R. W. Quispel, D. I. McLaren, A new class")
    assert AverageVectorField(4).citation.startswith(
        "E. Hairer, Energy-preserving variant of collocation methods"
    )
    assert TimeTransformed(Splitting("verlet")).citation.startswith(
        "S. Mikkola, K. Tanikawa, Explicit symplectic"
    )
    assert TimeTransformed(Gauss(2), g=1 + x**2).citation.startswith(
        "E. Hairer, C. Lubich, G. Wanner, Geometric"
    )


def interrupted(**how: Any) -> Any:
    def impatient(fraction: float) -> None:
        if fraction >= 0.2:
            raise KeyboardInterrupt

    starts = np.array([[1.0, 0.5, 0.2], [0.0, 0.0, 0.0]])
    return propagate(SWING, (0, 60), starts, samples=50, progress=impatient, **how)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"method": "DOP853"}, "an ensemble under DOP853 is done orbit by orbit: nothing of it is kept"),
        (
            {"method": "verlet", "step": 0.1, "events": [Event(x)]},
            "orbits with events or roots are done one by one: nothing of them is kept",
        ),
    ],
)
def test_interrupted_ensembles_that_go_one_by_one_keep_nothing(how: dict[str, Any], said: str) -> None:
    with pytest.raises(KeyboardInterrupt, match=said) as told:
        interrupted(**how)
    assert not isinstance(told.value, Interrupted)


def test_variations_that_are_none_or_too_large_are_refused() -> None:
    assert bilinear_covariant(SWING, (0, 2), [1, 0], variations=[[1, 0], [0, 1]]).speaks == "for"
    with pytest.raises(ValueError, match="the covariant is of two that are not zero"):
        bilinear_covariant(SWING, (0, 2), [1, 0], variations=[[1, 0], [0, 0]])
    with pytest.raises(
        ValueError, match="the bilinear covariant is too large for doubles: look at a shorter span"
    ):
        bilinear_covariant(SWING, (0, 2), [1, 0], variations=[[1e200, 0], [0, 1e200]])
    for span, samples in (((1, 1), 5), ((0, 2), 0)):
        with pytest.raises(ValueError, match="there is no motion to look at"):
            bilinear_covariant(SWING, span, [1, 0], samples=samples)
