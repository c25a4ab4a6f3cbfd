"""What a study is made of: products of lists from Python and from files, with one's own Hamiltonians."""

from __future__ import annotations

import pytest

from canon import RK4, Hamiltonian, Splitting, Taylor, coordinates, parameters
from canon.mechanics import field_of_function
from canon.scene import find
from canon.study.cases.case import Case
from canon.study.cases.study import Study, read_study
from canon.study.energy_drift.drift_study import StudyError
from canon.study.motion.hamiltonian_text import Formula


def test_a_study_from_a_file(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(
        """
        [[study]]
        system = "kepler"
        start = ["e=0.6", "e=0.0167"]
        method = ["kahan-li-8", "rk4", { gauss = 4 }]
        step = [0.01, 0.02]
        periods = 100

        [[study]]
        system = "simple-pendulum"
        method = "taylor"
        tolerance = [1e-8, 1e-12]
        span = 50.0
        parameters = { l = 2.0 }
        """
    )
    cases = read_study(file).cases
    assert len(cases) == 2 * 3 * 2 + 2
    assert cases[-1] == Case("simple-pendulum", Taylor(), 50.0, parameters=(("l", 2.0),), tolerance=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[[study]]\nsystem = 'keplr'\nmethod='rk4'\nstep=1\nperiods=1",
            "study 1: there is no scene 'keplr'; did you mean kepler",
        ),
        ("[[study]]\nsystem = 'kepler'\nmethod='rk5'\nstep=1\nperiods=1", "no method is called .rk5"),
        ("[[study]]\nsystem = 'kepler'\nmethod='rk4'\nperiods=1", "RK4 needs a size of steps: give step"),
        ("[[study]]\nsystem = 'kepler'\nmethod='rk4'\nstep=1", "duration as periods or as span"),
        ("[[study]]\nsystem = 'kepler'\nmethod='rk4'\nsteps=1\nperiods=1", "unknown key 'steps'"),
        ("[[study]]\nsystem = 'kepler'\nperiods=1", "'method' is missing"),
        ("system = 'kepler'", "holds \\[\\[study\\]\\] tables"),
        ("[[study]\n", "study.toml"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(tmp_path, text, message):
    file = tmp_path / "study.toml"
    file.write_text(text)
    with pytest.raises(StudyError, match=message):
        read_study(file)


OWN = """
[system.quartic]
H = "p**2/(2*m) + k*q**4/4"
q = "q"
p = "p"
parameters = { m = 1.0, k = 2.0 }
period = 7.0
starts = { near = [0.5, 0.0], far = [2.0, 0.0] }

[system.coupled]
H = "(p_x**2 + p_y**2)/2 + x**2*y**2/2 + (x**4 + y**4)/4"
q = ["x", "y"]

[[study]]
system = ["quartic", "harmonic-oscillator"]
method = ["verlet", { gauss = 2 }, "taylor"]
steps_per_period = [20.5, 40.5]
periods = 100

[[study]]
system = "quartic"
start = ["near", "far", [1.0, 0.5]]
parameters = { k = [1.0, 2.0, 3.0], m = 4 }
method = "rk4"
step = 0.1
span = 50

[[study]]
system = "coupled"
start = [[1.0, 0.5, 0.0, 0.0]]
method = "verlet"
step = 0.1
span = 50
"""


def test_own_hamiltonians_starts_and_parameters_in_a_file(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text(OWN)
    cases = read_study(file).cases
    assert len(cases) == 2 * (2 * 2 + 1) + 3 * 3 + 1
    first, last = cases[0], cases[-1]
    assert (first.system_name, first.span, first.step) == ("quartic", 700.0, 7.0 / 20.5)
    assert first.state == (0.5, 0.0)
    assert first.values == {"m": 1.0, "k": 2.0}
    assert last.state == (1.0, 0.5, 0.0, 0.0)
    varied = [case for case in cases if case.span == 50.0 and case.system_name == "quartic"]
    assert [case.values["k"] for case in varied] == [1.0] * 3 + [2.0] * 3 + [3.0] * 3
    assert {case.values["m"] for case in varied} == {4.0}
    assert [case.state for case in varied[:3]] == [(0.5, 0.0), (2.0, 0.0), (1.0, 0.5)]


def test_hamiltonians_and_scenes_from_python():
    x, k = coordinates("x"), parameters("k", positive=True)
    own = Hamiltonian(x.momentum**2 / 2 + k * x**4 / 4, [x], [x.momentum])
    study = Study.of(
        system=own,
        parameters={"k": [1.0, 4.0]},
        start=[[1.0, 0.0]],
        method=[Splitting("verlet"), Taylor()],
        step=0.1,
        span=10.0,
    )
    assert [case.values for case in study.cases] == [{"k": 1.0}] * 2 + [{"k": 4.0}] * 2
    assert str(study.cases[0].hamiltonian.p_dot[0]) == "-k*x**3"
    scenes = Study.of(
        system=[find("simple-pendulum"), Formula("free", "p**2/2", ("q",), ("p",))],
        start=[[1.0, 0.0]],
        method=RK4(),
        step=0.1,
        span=10.0,
    )
    assert [case.system_name for case in scenes.cases] == ["simple-pendulum", "free"]


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ({"methods": ["rk4"]}, "unknown key 'methods'; is method meant?"),
        ({"method": "rk4", "t_span": (0, 9)}, r"unknown key 't_span'; is span \(a duration\) meant?"),
        ({"method": "rk4", "y0": [[1.0, 0.0]]}, "unknown key 'y0'; is start meant?"),
        ({"method": "rk4", "stride": 2}, "unknown key 'stride'; there are system, start"),
        (
            {"method": "rk4", "start": [1.0, 0.0]},
            r"start = 1.0: a start is a name or a list .* \[\[1.0, 0.0\]\]",
        ),
    ],
)
def test_the_words_of_other_functions_are_told(axes, message):
    with pytest.raises(StudyError, match=message):
        Study.of(**{"system": "kepler", "step": 0.1, "span": 9.0} | axes)


def test_a_function_is_told_how_it_becomes_a_vector_field():
    def swing(t, y):
        return [y[1], -y[0]]

    how = {"start": [[1.0, 0.0]], "method": "taylor", "span": 9.0, "observables": {"size": "y_0**2 + y_1**2"}}
    with pytest.raises(StudyError, match=r"give canon.mechanics.field_of_function\(f, n\)"):
        Study.of(system=swing, **how)
    assert len(Study.of(system=field_of_function(swing, 2), **how).cases) == 1


def test_shares_are_the_study():
    study = Study.of(system="kepler", method="rk4", step=[0.01, 0.02, 0.03, 0.04, 0.05], span=10.0)
    shares = [study.share(k, 3).cases for k in (1, 2, 3)]
    assert sorted(case.step for share in shares for case in share) == [0.01, 0.02, 0.03, 0.04, 0.05]
    assert [len(share) for share in shares] == [2, 2, 1]
    with pytest.raises(StudyError, match="no share 4 of 3"):
        study.share(4, 3)


PLAIN = "method='rk4'\nstep=0.1\nspan=50\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[system.a]\nq='q'\n[[study]]\nsystem='a'\n", "system a: 'H' is missing"),
        ("[system.a]\nH='p**2'\nq='q'\nmass=1\n[[study]]\n", "unknown key 'mass'; there are H, q, p"),
        (
            "[system.a]\nH='p_q**2/2 + k*q'\nq='q'\n[[study]]\n",
            r"a, H: column 12: k is not declared; the names here are q, p_q",
        ),
        ("[system.a]\nH='__import__(\"os\")'\nq='q'\n[[study]]\n", "system a, H: column"),
        ("[system.a]\nH='p**2'\nq='q'\np='q'\n[[study]]\n", "'q' is declared twice"),
        ("[system.a]\nH='p**2'\nq='q r'\np='p'\n[[study]]\n", "2 coordinates and 1 momentum"),
        (
            "[system.a]\nH='p_q**2'\nq='q'\nstarts={x=[1.0]}\n[[study]]\n",
            r"the start 'x' needs 2 finite numbers",
        ),
        ("[system.a]\nH=3\nq='q'\n[[study]]\n", "H is text in quotation marks, not 3"),
        (f"[system.a]\nH='p_q**2'\nq='q'\n[[study]]\nsystem='a'\n{PLAIN}", "a needs a start; it has none"),
        (
            f"[system.a]\nH='p_q**2'\nq='q'\nstarts={{b=[1,0]}}\n[[study]]\nsystem='a'\nstart='c'\n{PLAIN}",
            "a has no start 'c'; there are: b",
        ),
        (
            "[system.a]\nH='p_q**2'\nq='q'\nstarts={b=[1,0]}\n[[study]]\nsystem='a'\nmethod='taylor'\nperiods=3",
            "periods needs the system's period",
        ),
        (f"[[study]]\nsystem='kepler'\nstart='e=0.7'\n{PLAIN}", "kepler has no start 'e=0.7'"),
        (f"[[study]]\nsystem='kepler'\nstart=[[1.0, 2.0]]\n{PLAIN}", "a start needs 4 numbers"),
        (f"[[study]]\nsystem='kepler'\nparameters={{ g = 1 }}\n{PLAIN}", "kepler has no parameter 'g'"),
        (f"[[study]]\nsystem='kepler'\nsamples=100\n{PLAIN}", "100 samples are too few .* at least 256"),
        (f"[[study]]\nsystem='kepler'\nparts=0\n{PLAIN}", "parts = 0: give a whole number"),
        ("[[study]]\nsystem='kepler'\nmethod='rk4'\nstep=-1\nspan=5", "a step of -1.0 makes no sense"),
        ("[[study]]\nsystem='kepler'\nmethod='rk4'\nstep=1\nspan=inf", "a time of inf makes no sense"),
    ],
)
def test_what_is_wrong_with_a_system_or_a_case_is_named(tmp_path, text, message):
    file = tmp_path / "study.toml"
    file.write_text(text)
    with pytest.raises(StudyError, match=message) as caught:
        read_study(file)
    assert "study.toml" in str(caught.value)
