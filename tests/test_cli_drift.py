"""``canon drift`` from its arguments to its table, lines, figure and exit status."""

import json

import pytest

from canon import RK4, Splitting
from canon.cli import main
from canon.scene import find
from canon.study.energy_drift.drift_study import drift_study


def drift(*arguments):
    return main(["drift", "henon-heiles", "--periods", "100", *arguments])


def test_the_table_tells_symplectic_from_not(capsys):
    assert drift("--method", "kahan-li-8", "--method", "rk4") == 0
    printed = capsys.readouterr().out
    rows = {line.split()[0]: line for line in printed.splitlines() if line.startswith(("kahan-li-8", "RK4"))}
    assert "bounded" in rows["kahan-li-8"]
    assert "secular" in rows["RK4"]


def test_lines_are_json_with_numbers_only(capsys):
    assert drift("--json", "--method", "verlet", "--method", "taylor", "--tolerance", "1e-10") == 0
    lines = [
        json.loads(line, parse_constant=pytest.fail)  # NaN and Infinity are no JSON and no data
        for line in capsys.readouterr().out.splitlines()
    ]
    assert [line["method"] for line in lines] == ["verlet", "Taylor(1e-10)"]
    assert lines[0]["order"] == 2
    assert lines[0]["bound"] > lines[1]["bound"] > 0
    assert lines[0]["span"] == pytest.approx(100 * lines[0]["period"])


def test_a_figure_is_written(tmp_path, capsys):
    file = tmp_path / "energy.png"
    assert drift("--method", "verlet", "--plot", str(file)) == 0
    assert file.read_bytes().startswith(b"\x89PNG")
    assert str(file) in capsys.readouterr().out


def test_a_figure_has_a_panel_for_every_observable():
    from canon.plot import plot_errors

    study = drift_study(
        find("kepler"),
        methods=[Splitting("verlet"), RK4()],
        periods=30.0,
        observables=["energy", "integrals"],
    )
    panels = plot_errors(study)
    labels = [panel.get_ylabel() for panel in panels]
    assert labels[0] == "largest relative energy error |ΔE/E|"
    assert labels[1] == "largest relative error |ΔI/I|"
    assert panels[1].get_title("left") == "angular momentum"
    assert len(panels) == len(panels[0].figure.axes) == 4
    assert all(panel.lines for panel in panels)


def test_a_run_that_fails_is_a_row_and_an_exit_status(capsys):
    """Verlet with a step beyond its stability limit h ω = 2 blows up; RK4 at that step does too."""
    assert drift("--method", "verlet", "--method", "taylor", "--step", "4") == 1
    printed = capsys.readouterr().out
    assert "failed" in printed
    assert "nan" not in printed.lower()


def test_gauss_methods_take_any_hamiltonian(capsys):
    """The double pendulum does not split into T(p) + V(q); Gauss's methods do not ask for that."""
    arguments = ["drift", "double-pendulum", "--periods", "40", "--method", "verlet", "--method", "gauss-4"]
    assert main(arguments) == 1
    printed = capsys.readouterr().out
    assert "verlet failed: H is not separable, T(p, t) + V(q, t)" in printed
    assert "Gauss(4) failed" not in printed


def test_observables_by_name(capsys):
    arguments = ["drift", "kepler", "--periods", "100", "--method", "verlet", "--json"]
    assert main([*arguments, "--observable", "energy", "--observable", "angular momentum"]) == 0
    energy, momentum = map(json.loads, capsys.readouterr().out.splitlines())
    assert (energy["observable"], momentum["observable"]) == ("energy", "angular momentum")
    assert momentum["bound"] < 1e-13 < energy["bound"]


def test_several_orbits(capsys):
    assert drift("--method", "rk4", "--orbits", "3") == 0
    assert "orbits: 3 secular" in capsys.readouterr().out
    assert drift("--method", "rk4", "--orbits", "3", "--json") == 0
    assert json.loads(capsys.readouterr().out)["orbits"] == ["secular"] * 3


def test_a_duration_in_units_of_time_and_more_digits(capsys):
    arguments = ["drift", "henon-heiles", "--span", "100", "--method", "taylor", "--precision", "extended"]
    assert main([*arguments, "--json"]) == 0
    line = json.loads(capsys.readouterr().out)
    assert line["span"] == 100.0
    assert line["precision"] == "extended"


def test_progress_is_silent_when_piped(capsys):
    assert drift("--method", "verlet") == 0
    assert capsys.readouterr().err == ""


def test_scenes_are_listed(capsys):
    assert main(["drift", "list"]) == 0
    printed = capsys.readouterr().out
    assert "henon-heiles" in printed
    assert "double-pendulum" in printed
    free, others = printed.split("with constraints or forces without potential")
    assert "hemisphere" not in free
    assert "hemisphere" in others


def test_a_scene_with_constraints_is_judged_by_the_balance_of_energy(capsys):
    assert main(["drift", "hemisphere", "--method", "taylor", "--span", "1", "--json"]) == 0
    (line,) = map(json.loads, capsys.readouterr().out.splitlines())
    assert line["bound"] < 1e-13


def test_a_scene_driven_in_time_is_taken(capsys):
    assert main(["drift", "parametric-pendulum", "--periods", "100", "--method", "rk4"]) == 0
    assert "energy less the work done from outside" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["drift", "henon-heile"], "did you mean henon-heiles"),
        (["drift", "hemisphere", "--method", "verlet"], "made for a Hamiltonian"),
        (["drift", "kepler", "--method", "leapfrog"], "leapfrog"),
        (["drift", "kepler", "--method", "gauss-9"], "the number of stages is 1 … 8"),
        (["drift", "simple-pendulum", "--set", "l"], "--set l: write a parameter's name"),
        (["drift", "simple-pendulum", "--set", "l=nan"], "--set l=nan"),
        (["drift", "simple-pendulum", "--set", "l=-1"], "must be positive"),
        (["drift", "simple-pendulum", "--set", "size=1"], "has no parameter 'size'"),
        (["drift", "kepler", "--observable", "spin"], "there is no observable 'spin'"),
        (["drift", "henon-heiles", "--observable", "momenta"], "no momentum is constant"),
        (["drift", "henon-heiles", "--orbits", "0"], "run at least one"),
        (["drift", "henon-heiles", "--step", "-0.1"], "positive"),
        (["drift", "henon-heiles", "--periods", "0"], "positive"),
        (["drift", "henon-heiles", "--periods", "nan"], "positive"),
    ],
)
def test_bad_usage_says_what_to_do(arguments, told, capsys):
    assert main(arguments) == 2
    assert told in capsys.readouterr().err
