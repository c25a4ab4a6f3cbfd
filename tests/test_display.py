"""What people see of public values: a short line in a list, and more of it in a notebook."""

from tempfile import TemporaryDirectory

import pytest
from sympy import cos, eye, sin, symbols

import canon
from canon.scene import find

x = symbols("x", real=True)


def examples():
    """One value of every public type whose fields would fill a screen."""
    theta = canon.coordinates("theta")
    pendulum = canon.Hamiltonian(theta.momentum**2 / 2 - cos(theta), [theta], [theta.momentum])
    scene = find("henon-heiles")
    methods = [canon.Splitting("verlet"), canon.RK4()]
    motion = canon.propagate(scene.hamiltonian, (0, 100), scene.state(), method=methods[0], step=0.1)
    claim = {"id": "c", "kind": "equality-only", "lhs": "x", "rhs": "x", "parameters": {"x": "real"}}
    sheet = canon.exercise.Sheet("A sheet", (canon.exercise.Claim("c", "equality-only", claim),))
    choice = canon.choose(scene, 100.0, accuracy=1e-3, methods=methods)
    crossed = canon.propagate(
        pendulum, (0, 10), [1.0, 0.0], method=canon.Taylor(), events=[canon.Event(theta)]
    )
    with TemporaryDirectory() as folder:
        study = canon.Study.of(system="kepler", method="rk4", step=0.1, span=10.0)
        canon.run_study(study, f"{folder}/results.sqlite")
        results = canon.results_of(f"{folder}/results.sqlite")
    return {
        "verdict": canon.vanishes(sin(x) ** 2 + cos(x) ** 2 - 1),
        "domain": canon.Domain((x > 0,)),
        "scene": scene,
        "trajectory": motion,
        "jacobian": canon.flow_jacobian(pendulum, (0, 1), [1.0, 0.0], method=methods[0], step=0.1),
        "drift": canon.drift(motion.t, motion.energy_error),
        "row": canon.drift_study(scene, methods=methods, periods=20).rows[0],
        "methods": canon.drift_study(scene, methods=methods, periods=20),
        "choice": choice,
        "work": canon.work_precision(scene, 5.0, methods=methods, steps=[0.1, 0.05]),
        "study": canon.Study.of(system="kepler", method="rk4", step=[0.01, 0.02], span=10.0),
        "claim": sheet.claims[0],
        "sheet": sheet,
        "judgement": canon.check(sheet).judgements[0],
        "error": motion.error_estimate(),
        "crossing": crossed.events[0],
        "witness": canon.flow.symplectic_flow(pendulum, (0, 1), [1.0, 0.0]),
        "candidate": choice.candidates[0],
        "result": results[0],
        "body": canon.RigidBody(x, (), (x, x, x), rotation=eye(3)),
        "splitting": canon.WisdomHolman(corrector=11),
        "row of a table": canon.Splitting("kahan-li-8"),
    }


@pytest.fixture(scope="module")
def shown():
    return examples()


def test_a_line_says_what_it_is(shown):
    for name, value in shown.items():
        assert "\n" not in repr(value), name
        assert len(repr(value)) < 200, name
    assert repr(shown["verdict"]) == "<HOLDS: the expression is zero>"
    assert repr(shown["domain"]) == "<Domain: x > 0>"
    assert repr(shown["study"]) == "<Study: 2 cases; kepler; RK4>"
    assert repr(shown["judgement"]) == "<Judgement 'c': equality-only, holds>"
    assert repr(shown["error"]).startswith("<ErrorEstimate: relative error up to ")
    assert repr(shown["crossing"]).startswith("<Crossing: theta = 0 falling at t = ")
    assert repr(shown["witness"]) == "<Witness: symplectic flow: speaks for it>"
    assert repr(shown["result"]).startswith("<Result: kepler; RK4, h = 0.1: ")
    assert "energy to " in repr(shown["work"].rows[0])
    assert repr(shown["splitting"]) == "WisdomHolman(corrector=11)"
    assert repr(shown["drift"]).startswith(f"<Drift: {shown['drift'].verdict.value}, ")


def test_a_notebook_shows_tables_and_escapes_them(shown):
    for name in ("verdict", "drift", "choice", "methods", "work", "error", "judgement", "witness"):
        page = shown[name]._repr_html_()
        assert page.startswith("<pre style="), name
        assert "script" not in page
    hostile = canon.Verdict(canon.proof.Status.FAILS, "<script>alert(1)</script>")
    assert "<script>" not in hostile._repr_html_()
    assert "FAILS" in hostile._repr_html_()


def test_a_picture_shows_itself_in_a_notebook(shown):
    from canon.plot import plot_energy_error

    axes = plot_energy_error(shown["trajectory"])
    assert axes._repr_png_().startswith(b"\x89PNG")
    assert axes.figure._repr_png_() == axes._repr_png_()


def test_systems_are_shown_as_formulas():
    r, (m, g) = canon.coordinates("r"), canon.parameters("m g", positive=True)
    fall = canon.GibbsAppell([canon.Particle(m, [r])], [r], V=m * g * r)
    assert fall._repr_latex_() == (
        r"$\displaystyle \begin{aligned}S &= \frac{m \ddot{r}^{2}}{2} \\ "
        r"\partial S/\partial \ddot{r} &= - g m\end{aligned}$"
    )
    turned = canon.CanonicalTransformation([r], [r.momentum], new_q=[r.momentum], new_p=[-r])
    assert turned._repr_latex_() == r"$\displaystyle \begin{aligned}Q &= p_{r} \\ P &= - r\end{aligned}$"
