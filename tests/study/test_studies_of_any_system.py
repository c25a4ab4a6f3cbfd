"""Choices, studies and work diagrams of systems that are no Hamiltonians: what should stay is the balance of energy."""

from __future__ import annotations

from dataclasses import replace

import heyoka as hy
import numpy as np
import pytest
import sympy as sp
from sympy.physics import mechanics as me

from canon import (
    RK4,
    ConstrainedLagrangian,
    GibbsAppell,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Study,
    Taylor,
    VectorField,
    choose,
    coordinates,
    drift,
    parameters,
    propagate,
    results_of,
    routhian,
    run_study,
    time,
    work_precision,
)
from canon.mechanics import VERTICAL, heavy_top
from canon.mechanics.lagrange.body import Particle, RigidBody, euler_rotation
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler, weights
from canon.study.cases.case import key_of, part_count
from canon.study.cases.checkpointed_run import Checkpoint, advance
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.drift_study import drift_study
from canon.study.errors import StudyError
from canon.study.motion.system_table import system_from
from canon.study.motion.system_text import system_in, system_text


def damped_and_driven() -> Lagrangian:
    x = coordinates("x")
    return Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 100 + sp.cos(time / 3) / 5])


def exact(t):
    """x″ + x′/100 + x = cos(t/3)/5 from x = 1 at rest."""
    gain = 0.2 / (8.0 / 9.0 + 1j / 300.0)
    root = -0.005 + 1j * np.sqrt(1.0 - 0.005**2)
    forced, rate = gain.real, (gain * 1j / 3.0).real
    a = 1.0 - forced
    b = (-rate - root.real * a) / root.imag
    free = np.exp(root.real * t) * (a * np.cos(root.imag * t) + b * np.sin(root.imag * t))
    return (gain * np.exp(1j * t / 3.0)).real + free


def test_the_choice_for_a_position_is_kept():
    choice = choose(damped_and_driven(), 300.0, [1.0, 0.0], accuracy=1e-7, observable="position")
    assert choice.reached
    assert {str(each.method).partition("(")[0] for each in choice.candidates} == {"Taylor", "DOP853", "RK4"}
    motion = choice.run()
    assert np.abs(motion.q[0] - exact(motion.t)).max() <= 1e-7 * np.abs(motion.q).max()


@pytest.mark.parametrize("method", [RK4(), Taylor()])
def test_the_choice_for_the_balance_of_energy_is_kept(method):
    choice = choose(damped_and_driven(), 2000.0, [1.0, 0.0], accuracy=1e-7, methods=[method])
    assert choice.reached
    motion = choice.run()
    assert choice.predicted_error / 5.0 < np.abs(motion.energy_error).max() <= 1e-7
    assert np.abs(motion.energy_change).max() > 0.1


def test_the_balance_drifts_by_truncation_and_wanders_by_rounding():
    found = drift_study(damped_and_driven(), [1.0, 0.0], span=2000.0, step=0.05)
    runge_kutta, taylor = (row.drift for row in found.rows)
    assert runge_kutta.verdict is not Growth.ROUND_OFF
    assert runge_kutta.bound > 1e-8
    assert taylor.bound < 1e-12
    with pytest.raises(StudyError, match="no Hamiltonian the energy has a name"):
        drift_study(damped_and_driven(), [1.0, 0.0], span=100.0, step=0.05, observables=["momenta"])


def test_work_and_precision_of_a_damped_motion():
    found = work_precision(
        damped_and_driven(), 50.0, [1.0, 0.0], methods=[RK4()], steps=[0.1, 0.05], repetitions=1
    )
    coarse, fine = found.rows
    assert np.log2(coarse.position_error / fine.position_error) == pytest.approx(4.0, abs=0.2)


def test_drift_takes_a_damped_motion():
    motion = choose(damped_and_driven(), 2000.0, [1.0, 0.0], accuracy=1e-6, methods=[RK4()]).run()
    assert drift(motion).cause == "truncation"
    assert drift(motion).bound == pytest.approx(np.abs(motion.energy_error).max())


# every sort of system ----------------------------------------------------------------------------------


def _systems():
    x, y, theta, phi, r = coordinates("x y theta phi r")
    m, l, g, k, c = parameters("m l g k c", positive=True)
    S, a, b = sp.Symbol("S", real=True), *sp.symbols("a b", real=True)
    u, v = hy.make_vars("u", "v")
    bob = Particle(m, (l * sp.sin(theta), -l * sp.cos(theta)))
    weight = [*weights([bob], (0, -g)), Load(0, (-S * sp.sin(theta), S * sp.cos(theta)))]
    q, (Q, U) = me.dynamicsymbols("q"), me.dynamicsymbols("Q U")
    frame, point = me.ReferenceFrame("N"), me.Point("O")
    point.set_vel(frame, 0)
    arm = frame.orientnew("A", "Axis", [Q, frame.z])
    arm.set_ang_vel(frame, U * frame.z)
    end = point.locatenew("P", -arm.y)
    end.v2pt_theory(point, frame, arm)
    kane = me.KanesMethod(frame, q_ind=[Q], u_ind=[U], kd_eqs=[Q.diff() - U])
    kane.kanes_equations([me.Particle("bob", end, m)], [(end, -m * g * frame.y)])
    hung = {"m": 1.0, "l": 1.0, "g": 9.8}
    ring = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y]), [x**2 + y**2 - 1])
    blade = GibbsAppell([bob], [theta], -m * g * l * sp.cos(theta), forces=[-c * theta.dot])
    return {
        "damped and driven": (damped_and_driven(), [1.0, 0.0], {}, ""),
        "on a ring": (ring, [0.6, -0.8, 0.8, 0.6], {"g": 9.8}, ""),
        "Gibbs and Appell": (blade, [0.5, 0.0], {**hung, "c": 0.02}, ""),
        "Newton and Euler": (NewtonEuler([bob], [theta], weight, [S]), [0.5, 0.0], hung, ""),
        "Routh": (
            routhian(Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2 + k / r, [r, phi])),
            [1.0, 0.3, 0.1, 1.2],
            {"m": 1.0, "k": 1.0},
            "",
        ),
        "a top": (
            heavy_top([1, 1, k], g * VERTICAL[2]),
            [0.1, 0.0, 2.0, 0.6, 0.0, 0.8],
            {"k": 1.5, "g": 1.0},
            "",
        ),
        "a field": (VectorField([b, -sp.sin(a)], [a, b]), [0.5, 0.0], {}, "b**2/2 - cos(a)"),
        "heyoka's list": ([(u, v), (v, -hy.sin(u))], [0.5, 0.0], {}, "v**2/2 - cos(u)"),
        "SymPy's Lagrange": (
            me.LagrangesMethod(m * q.diff() ** 2 / 2 + m * g * sp.cos(q), [q]),
            [0.5, 0.0],
            {"m": 1.0, "g": 9.8},
            "",
        ),
        "SymPy's Kane": (kane, [0.5, 0.0], {"m": 1.0, "g": 9.8}, "U**2/2 - g*cos(Q)"),
    }


SYSTEMS = _systems()


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_study_takes_every_sort_of_system(name, tmp_path):
    """RK4's bound falls by its order, an energy's by up to two more; what is read back is the same system."""
    system, start, values, kept = SYSTEMS[name]
    study = Study.of(
        system=system,
        start=[start],
        parameters=values,
        method="RK4",
        step=[0.04, 0.02],
        span=20.0,
        samples=500,
        observables={"kept": kept} if kept else (),
    )
    assert run_study(study, tmp_path / "any.sqlite").failed == 0
    results = results_of(tmp_path / "any.sqlite")
    coarse, fine = (result.numbers["bound"] for result in results)
    assert 2.0**3 < coarse / fine < 2.0**7
    for result, case in zip(results, study.cases, strict=True):
        assert result.case == case
        assert key_of(result.case) == key_of(case)


def test_the_numbers_of_a_study_are_those_of_the_motion(tmp_path):
    """Part by part, the balance of energy against the work of the forces; resumed with the same bits."""
    study = Study.of(
        system=damped_and_driven(),
        start=[[1.0, 0.0]],
        method="RK4",
        step=0.05,
        span=200.0,
        samples=512,
        parts=4,
    )
    (case,) = study.cases
    whole = advance(case).numbers
    point = None
    for _ in range(3):
        point = Checkpoint.from_text(advance(case, point, seconds=0.0).to_text())
    assert advance(case, point).numbers == whole
    motion = propagate(damped_and_driven(), (0, 200), [1, 0], method="RK4", step=0.05, samples=512)
    assert whole["bound"] == pytest.approx(np.abs(motion.energy_error).max(), rel=1e-3)
    assert np.abs(motion.energy_change).max() > 1e3 * whole["bound"]  # the energy itself is not kept


def test_motions_with_constraints_are_one_part_and_stay_on_them(tmp_path):
    system, start, values, _ = SYSTEMS["on a ring"]
    options = {"start": [start], "parameters": values, "step": 0.02, "span": 50.0, "parts": 5}
    (case,) = Study.of(system=system, method="RK4", **options).cases
    assert part_count(case) == 1
    assert advance(case).numbers["bound"] < 1e-3
    (scene,) = Study.of(system="rolling-disc", method="taylor", span=2.0).cases
    assert advance(scene).numbers["bound"] < 1e-13


def test_what_a_study_cannot_take_is_told():
    field, start, _, _ = SYSTEMS["a field"]
    rest = {"start": [start], "step": 0.1, "span": 10.0}
    with pytest.raises(StudyError, match="no energy is known of VectorField: name what should stay constant"):
        Study.of(system=field, method="rk4", **rest)
    with pytest.raises(StudyError, match="verlet is made for Hamiltonians, which Lagrangian is not; Taylor"):
        Study.of(system=damped_and_driven(), method="verlet", **rest)
    with pytest.raises(StudyError, match="the system holds c, g, l, m: give each a value"):
        Study.of(system=SYSTEMS["Gibbs and Appell"][0], method="rk4", **rest)
    with pytest.raises(StudyError, match=r"needs 2 finite numbers \(x, x_dot\), not \[1.0\]"):
        Study.of(system=damped_and_driven(), method="rk4", step=0.1, span=10.0, start=[[1.0]])


def test_files_hold_data_and_no_code():
    text = system_text(damped_and_driven(), "damped")
    assert system_in(text) == damped_and_driven()
    theta, phi, psi = coordinates("theta phi psi")
    body = RigidBody(1, (0, 0, 0), (1, 1, 2), euler_rotation(phi, theta, psi))
    turning = GibbsAppell([body], [theta, phi, psi], sp.cos(theta))
    assert system_in(system_text(turning)) == turning
    forged = replace(text, written=text.written.replace('"Lagrangian"', '"Popen"'))
    with pytest.raises(StudyError, match="damped: its equations are not such as canon writes"):
        system_in(forged)


# systems without energy ---------------------------------------------------------------------------------


def test_a_field_is_judged_by_its_positions_or_by_what_it_keeps():
    field, start, _, _ = SYSTEMS["a field"]
    a, b = field.x
    with pytest.raises(
        StudyError, match='no energy is known of a vector field: ask for observable="position"'
    ):
        choose(field, 100.0, start, accuracy=1e-7)
    by_position = choose(field, 100.0, start, accuracy=1e-7, observable="position", methods=["taylor"])
    assert by_position.reached
    by_energy = choose(
        field, 100.0, start, accuracy=1e-7, observable="E", integral=b**2 / 2 - sp.cos(a), methods=[RK4()]
    )
    motion = by_energy.run()
    assert by_energy.reached
    assert np.abs(motion["E"] / motion["E"][0] - 1).max() <= 1e-7
    with pytest.raises(StudyError, match="no energy is known of this system: name what should stay constant"):
        drift_study(field, start, span=100.0, step=0.05)
    kept = drift_study(field, start, span=100.0, step=0.05, observables={"E": b**2 / 2 - sp.cos(a)})
    assert [row.drift.bound < 1e-6 for row in kept.rows] == [True, True]
    diagram = work_precision(field, 10.0, start, methods=[RK4()], steps=[0.1], repetitions=1)
    assert "–" in str(diagram).splitlines()[5]


def test_methods_for_hamiltonians_are_refused_of_others():
    with pytest.raises(StudyError, match="verlet: made for Hamiltonians, which Lagrangian is not; Taylor"):
        choose(damped_and_driven(), 100.0, [1.0, 0.0], accuracy=1e-7, methods=["verlet"])


def test_starts_by_name_and_scenes_by_name():
    by_name = choose(damped_and_driven(), 50.0, {"x": 1, "x_dot": 0}, accuracy=1e-7, methods=["taylor"])
    assert by_name.question.y0.tolist() == [1.0, 0.0]
    found = drift_study("rolling-disc", span=2.0, step=0.01, methods=["taylor"])
    assert found.rows[0].drift.bound < 1e-13
    assert choose("kepler", 50.0, accuracy=1e-7, methods=["taylor"]).reached


SPARE = {
    "H": "p**2/2 + q**2/2", "q": "q", "p": "p", "parameters": {"k": 2.0}, "starts": {"near": [0.5, 0.0]}, "period": 6.0,
}  # fmt: skip
WITHOUT_H = {
    "L": "q_dot**2/2 - q**2/2",
    **{key: SPARE[key] for key in ("q", "parameters", "starts", "period")},
}


@pytest.mark.parametrize("table", [SPARE, WITHOUT_H])
def test_a_table_may_have_parameters_that_do_not_matter(tmp_path, table):
    """One that stands nowhere, or only in what is followed along the motion."""
    study = Study.of(
        system=system_from("own", table),
        method="taylor",
        span=60.0,
        samples=512,
        keep=[{"section": "q - k/10"}],
    )
    status = run_study(study, tmp_path / "s.sqlite")
    assert (status.finished, status.failed) == (len(study.cases), 0)
    assert len(study.cases) > 0


def test_a_scene_may_have_parameters_that_do_not_matter():
    """The radius of the hollow cylinder is not in its Hamiltonian."""
    study = drift_study("hollow-cylinder-second-kind", methods=[Splitting("verlet")], periods=20)
    assert [row.failure for row in study.rows] == [""]
    assert choose("hollow-cylinder-second-kind", 5.0, accuracy=1e-4).reached


def test_a_parameter_that_a_users_own_hamiltonian_has_not_is_refused():
    q = coordinates("q")
    with pytest.raises(KeyError, match="the system has no parameter k, it has none"):
        drift_study(
            Hamiltonian(q.momentum**2 / 2 + q**2 / 2, [q], [q.momentum]), [0.5, 0.0],
            methods=[Splitting("verlet")], step=0.1, span=60.0, parameters={"k": 2.0},
        )  # fmt: skip
