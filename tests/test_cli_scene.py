"""``canon scene``: what it prints, writes and returns."""

from __future__ import annotations

import re

import pytest

from canon.cli import main
from canon.scene import names


def out(capsys, *arguments):
    status = main(["scene", *arguments])
    found = capsys.readouterr()
    return status, found.out, found.err


def test_all_scenes_are_listed(capsys):
    status, text, _ = out(capsys)
    assert status == 0
    assert [line.split()[0] for line in text.splitlines()] == list(names())
    assert out(capsys, "list")[1] == text


def test_a_scene_shows_its_equations(capsys):
    status, text, _ = out(capsys, "spherical-pendulum")
    assert status == 0
    for line in (
        "coordinates: theta, phi",
        "H = -g*l*m*cos(theta) + p_phi**2/(2*l**2*m*sin(theta)**2) + p_theta**2/(2*l**2*m)",
        "R = g*l*m*cos(theta) + l**2*m*theta_dot**2/2 - p_phi**2/(2*l**2*m*sin(theta)**2)",
        "angular momentum about the vertical: I1 = p_phi",
    ):
        assert f"  {line}\n" in text


def test_latex(capsys):
    status, text, _ = out(capsys, "simple-pendulum", "--latex")
    assert status == 0
    assert r"g l m \sin{\left(\theta \right)} + l^{2} m \ddot{\theta} = 0" in text


def test_constraints_and_multipliers_are_shown(capsys):
    _, text, _ = out(capsys, "chaplygin-sleigh")
    assert "  -x_dot*sin(theta) + y_dot*cos(theta) = 0\n" in text
    assert "lambda1" in text
    assert "Hamiltonian" not in text


def test_long_formulas_are_shown_when_asked_for(capsys):
    _, short, _ = out(capsys, "fput")
    _, whole, _ = out(capsys, "fput", "--all")
    assert "… 54 more; --all shows them" in short
    assert "dq31/dt = p_q31" not in short
    assert "dq31/dt = p_q31" in whole


def test_a_run_is_checked(capsys):
    status, text, _ = out(capsys, "kepler", "--start", "e=0.6", "--run", "--periods", "5")
    assert status == 0
    lines = text.splitlines()
    assert all(line.startswith("✓ ") for line in lines)
    measured = r"angular momentum: \d\.\de-\d+ ≤ 1e-13 relative \(e=0.6, 5 periods\)"
    assert any(re.search(measured, line) for line in lines)
    assert "✓ angular momentum: conserved by the equations: HOLDS" in lines
    assert any("Kepler's equation" in line for line in lines)


def test_a_failed_check_is_an_exit_status(capsys, monkeypatch):
    from dataclasses import replace

    import canon.scene

    scene = canon.scene.find("harmonic-oscillator")
    wrong = replace(scene, solutions=(replace(scene.solutions[0], value=lambda v, t: 0.2 * t),))
    monkeypatch.setattr(canon.scene, "find", lambda _: wrong)
    status, text, _ = out(capsys, "harmonic-oscillator", "--run", "--periods", "2")
    assert status == 1
    assert "✗ place: 10 cm cos ωt:" in text
    assert "EXCEEDS" in text


def test_pictures_are_written(capsys, tmp_path):
    picture, film = tmp_path / "a.png", tmp_path / "a.gif"
    status, text, _ = out(
        capsys,
        "spring-pendulum",
        "--periods",
        "0.2",
        "--plot",
        str(picture),
        "--animate",
        str(film),
        "--seconds",
        "1",
    )
    assert status == 0
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert film.read_bytes()[:6] == b"GIF89a"
    assert "animation" in text


def test_a_picture_is_written_without_a_film(capsys, tmp_path):
    picture = tmp_path / "a.png"
    status, text, _ = out(capsys, "harmonic-oscillator", "--periods", "0.2", "--plot", str(picture))
    assert status == 0
    assert f"picture: {picture}\n" in text
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert "animation" not in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["keplr"], "did you mean kepler"),
        (["kepler", "--start", "e=2"], "has no start"),
        (["kepler", "--set", "mu=-1"], "must be positive"),
        (["kepler", "--set", "mu"], "write a parameter's name"),
        (["kepler", "--run", "--periods", "-1"], "give a positive, finite number"),
        (["kepler", "--animate", "a.avi"], "written as .gif or .mp4"),
    ],
)
def test_bad_usage_says_what_to_do(capsys, arguments, message):
    status, _, error = out(capsys, *arguments)
    assert status == 2
    assert message in error
