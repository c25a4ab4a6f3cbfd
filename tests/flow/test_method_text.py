"""Methods by name, as classes, as text and as pickles: whatever says which one leads to the same value."""

import copy
import pickle

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import (
    Hamiltonian,
    Lagrangian,
    choose,
    coordinates,
    drift_study,
    flow_jacobian,
    propagate,
    work_precision,
)
from canon.flow.method.composition import COMPOSITIONS
from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.engine import FICTITIOUS_TIME, FIXED_STEPS, HEYOKA, SCIPY
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor, TimeTransformed
from canon.flow.method.method_text import method_from, method_named, method_of
from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.flow.method.solvable_splitting import SABA, SBAB, SolvableSplitting, WisdomHolman
from canon.flow.method.variational_method import GalerkinVariational
from canon.kernel.schemes.perturbed_schemes import saba
from canon.kernel.schemes.splitting_schemes import SCHEMES
from canon.scene import find

x = coordinates("x")
PENDULUM = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
MOTION = {"y0": [1.0, 0.0], "t_span": (0, 5)}

NAMED = {
    **{name: Splitting(name) for name in SCHEMES},
    **{f"gauss-{stages}": Gauss(stages) for stages in range(1, 9)},
    **{f"saba-{stages}": SABA(stages) for stages in range(1, 9)},
    **{f"sbab-{stages}": SBAB(stages) for stages in range(1, 9)},
    **{f"semiexplicit-{order}": SemiexplicitSplitting(order) for order in COMPOSITIONS},
    **{f"rattle-{order}": Rattle(order) for order in COMPOSITIONS},
    **{f"lie-poisson-{order}": LiePoissonSplitting(order) for order in COMPOSITIONS},
    **{f"nonholonomic-leapfrog-{order}": NonholonomicLeapfrog(order) for order in COMPOSITIONS},
    "nonholonomic-leapfrog": NonholonomicLeapfrog(),
    "lie-poisson": LiePoissonSplitting(),
    **{f"boris-{order}": Boris(order) for order in COMPOSITIONS},
    **{f"magnetic-{order}": MagneticSplitting(order) for order in COMPOSITIONS},
    **{f"avf-{order}": AverageVectorField(order) for order in range(2, 17, 2)},
    "avf": AverageVectorField(),
    **{f"galerkin-{degree}": GalerkinVariational(degree) for degree in range(1, 9)},
    "galerkin": GalerkinVariational(),
    "boris": Boris(),
    "rattle": Rattle(),
    "gauss": Gauss(),
    "rk4": RK4(),
    "taylor": Taylor(),
    "dop853": DOP853(),
    "wisdom-holman": WisdomHolman(),
    "aba-8-6-4": SABA("8-6-4"),
    "aba-10-6-4": SABA("10-6-4"),
}
TWO_COPIES = SemiexplicitSplitting(8), ExtendedPhaseSpace(6, omega=0.1), ExtendedPhaseSpace(2, omega=1e-7)
KINDS = [
    Splitting("verlet"),
    Splitting(a=["1/3", "2/3"], b=["1/2", "1/2"]),
    Splitting("verlet", parts=(x.momentum**2, x**4)),
    Gauss(3),
    Rattle(6),
    NonholonomicLeapfrog(4),
    LiePoissonSplitting(6),
    Boris(4),
    MagneticSplitting(6),
    AverageVectorField(4),
    GalerkinVariational(3, 5, "lobatto"),
    AverageVectorField(6, points=9, iteration="newton"),
    SemiexplicitSplitting(6),
    ExtendedPhaseSpace(4, omega=2.5),
    RK4(),
    Taylor(1e-9),
    DOP853(),
    WisdomHolman(corrector=7, coordinates="democratic-heliocentric"),
    SABA(4),
    SABA("10-6-4", corrector=3),
    SBAB(3, commutator=True),
    TimeTransformed(Splitting("verlet")),
    TimeTransformed(Gauss(2), g=x**2),
]


@given(st.sampled_from(sorted(NAMED)), st.booleans(), st.sampled_from(["-", "", " ", "_"]))
def test_every_name_is_read_in_any_case_and_with_any_hyphens(name, upper, hyphen):
    written = (name.upper() if upper else name).replace("-", hyphen)
    assert method_named(written) == NAMED[name]
    assert method_of(written) == method_from(written) == NAMED[name]


@given(st.sampled_from(sorted(NAMED)), st.integers(0, 9))
def test_another_name_is_refused_with_those_that_are_near(name, digit):
    wrong = f"{name}{digit}x"
    with pytest.raises(ValueError, match="no method is called") as refused:
        method_named(wrong)
    assert name in str(refused.value) or "did you mean" in str(refused.value)
    with pytest.raises(ValueError, match="there are verlet"):
        method_named("§§§§")


@pytest.mark.parametrize("wrong", ["gauss-9", "gauss-0", "SABA 9", "sbab-100"])
def test_a_wrong_number_of_stages_is_told_as_such(wrong):
    with pytest.raises(ValueError, match="the number of stages is 1 … 8"):
        method_named(wrong)


def test_the_words_of_a_method_name_it():
    for method in (
        Gauss(6),
        Gauss(3, iteration="newton"),
        RK4(),
        Taylor(),
        Splitting("kahan-li-8"),
        SABA(5),
        SABA("8-6-4"),
        SBAB(2),
        GalerkinVariational(8),
        GalerkinVariational(3, quadrature="lobatto"),
        GalerkinVariational(3, points=5),
        GalerkinVariational(3, 5, "lobatto"),
        AverageVectorField(),
        AverageVectorField(10, iteration="newton"),
        AverageVectorField(4, points=8),
        AverageVectorField(4, points=12, iteration="newton"),
        *TWO_COPIES,
    ):
        assert method_named(str(method)) == method


@pytest.mark.parametrize("method", KINDS, ids=str)
def test_methods_survive_pickling_and_copying(method):
    for again in (pickle.loads(pickle.dumps(method)), copy.deepcopy(method)):
        assert again == method
        assert hash(again) == hash(method)
        assert type(again) is type(method)
        assert (repr(again), str(again), again.order) == (repr(method), str(method), method.order)


def test_a_method_is_shown_as_the_call_that_makes_it():
    shown = [WisdomHolman(), WisdomHolman(corrector=7), SABA(4), SABA("10-6-4", corrector=3)]
    assert [repr(method) for method in shown] == [
        "WisdomHolman()",
        "WisdomHolman(corrector=7)",
        "SABA(4)",
        "SABA('10-6-4', corrector=3)",
    ]
    assert repr(SBAB(3, commutator=True)) == "SBAB(3, commutator=True)"
    assert repr(SABA(2, parts=(x.momentum**2, x**2))) == "SABA(2, parts=(p_x**2, x**2))"


def test_methods_by_solvable_parts_are_classes():
    assert isinstance(SABA(4), SABA)
    assert isinstance(SBAB(4), SBAB)
    assert isinstance(WisdomHolman(), WisdomHolman)
    assert not isinstance(SBAB(4), SABA)
    assert SABA(1) != SolvableSplitting(saba(1))
    assert SABA(4) != SABA(5)
    assert SABA(4).solvable == SABA(4)
    assert Splitting("verlet").solvable is None
    with pytest.raises(AttributeError):
        SABA(4).corrector = 3


def test_methods_answer_for_themselves():
    symplectic = {type(method).__name__ for method in KINDS if method.is_symplectic}
    copies = {
        "MagneticSplitting",
        "LiePoissonSplitting",
        "Rattle",
        "GalerkinVariational",
        "ExtendedPhaseSpace",
        "SemiexplicitSplitting",
    }
    assert symplectic == {"Splitting", "Gauss", "WisdomHolman", "SABA", "SBAB", "TimeTransformed"} | copies
    engines = {type(method).__name__: method.engine for method in KINDS}
    assert engines.pop("TimeTransformed") is FICTITIOUS_TIME
    assert engines.pop("Taylor") is HEYOKA
    assert engines.pop("DOP853") is SCIPY
    assert set(engines.values()) == {FIXED_STEPS}
    assert [each.takes_step for each in (FIXED_STEPS, FICTITIOUS_TIME, HEYOKA, SCIPY)] == [
        True,
        True,
        False,
        False,
    ]
    assert [each.wider for each in (FIXED_STEPS, HEYOKA, SCIPY)] == [
        ("extended", "double-double"),
        ("extended", "quad"),
        (),
    ]
    families = [method.family for method in KINDS]
    assert families[:4] == ["splitting", "splitting", "solvable", "gauss"]


@pytest.mark.parametrize(
    ("name", "value"), [("RK4", RK4()), ("verlet", Splitting("verlet")), ("gauss-2", Gauss(2))]
)
def test_a_run_by_name_is_the_run_by_value(name, value):
    runs = [propagate(PENDULUM, **MOTION, method=each, step=0.1, samples=5) for each in (name, value)]
    assert runs[0].method == value
    assert (runs[0].y == runs[1].y).all()


@pytest.mark.parametrize("given_as", [RK4, "RK4", "rk4", "rk-4"])
def test_a_method_that_takes_a_step_is_never_said_to_choose_its_own(given_as):
    assert propagate(PENDULUM, **MOTION, method=given_as, step=0.1).steps == 50
    with pytest.raises(ValueError, match="RK4 takes fixed steps: give step="):
        propagate(PENDULUM, **MOTION, method=given_as)
    with pytest.raises(ValueError, match="give step=, not tolerance="):
        propagate(PENDULUM, **MOTION, method=given_as, tolerance=1e-9)
    with pytest.raises(ValueError, match="Taylor chooses its own steps"):
        propagate(PENDULUM, **MOTION, method="taylor", step=0.1)


def test_classes_that_need_arguments_are_told_to_have_them():
    assert propagate(PENDULUM, **MOTION, method=Gauss, step=0.1).method == Gauss()
    with pytest.raises(ValueError, match=r"say which splitting: Splitting\('kahan-li-8'\)"):
        propagate(PENDULUM, **MOTION, method=Splitting, step=0.1)
    for kind, needed in ((SABA, r"SABA\(stages\)"), (TimeTransformed, r"TimeTransformed\(method\)")):
        with pytest.raises(TypeError, match=f"is a class: give a method made of it, {needed}"):
            propagate(PENDULUM, **MOTION, method=kind, step=0.1)
    for wrong in (7, 0.1, [RK4()], object, int):
        with pytest.raises(TypeError, match="is no method: give one by name"):
            propagate(PENDULUM, **MOTION, method=wrong, step=0.1)
    with pytest.raises(ValueError, match="no method is called 'RK44'; did you mean rk4"):
        propagate(PENDULUM, **MOTION, method="RK44")


def test_studies_and_jacobians_take_names():
    jacobian = flow_jacobian(PENDULUM, **MOTION, method="Verlet", step=0.1)
    assert (jacobian.M == flow_jacobian(PENDULUM, **MOTION, method=Splitting("verlet"), step=0.1).M).all()
    scene = find("henon-heiles")
    study = drift_study(scene, methods=["Verlet", RK4], periods=30)
    assert [row.method for row in study.rows] == [Splitting("verlet"), RK4()]
    assert choose(scene, 50.0, accuracy=1e-3, methods=["verlet"]).method == Splitting("verlet")
    assert work_precision(scene, 5.0, methods=["rk4"], steps=[0.1], repetitions=1).rows[0].method == RK4()


def test_names_are_read_for_any_system():
    pendulum = Lagrangian(x.dot**2 / 2 + sp.cos(x), [x])
    assert propagate(pendulum, method="rk4", step=0.1, t_span=(0, 5), y0=[1.0, 0.0]).method == RK4()
    with pytest.raises(ValueError, match="verlet is made for a Hamiltonian"):
        propagate(pendulum, method="verlet", step=0.1, t_span=(0, 5), y0=[1.0, 0.0])
