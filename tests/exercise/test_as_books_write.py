"""Answers as books write them: ±, quadratures, parts of an integral, actions by the energy; each with a wrong twin."""

from __future__ import annotations

import pytest

from canon.exercise import Claim, judge
from canon.exercise.claim_verdict import examine
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.reading import InvalidClaim

OSCILLATOR = {
    "q": ["q"],
    "p": ["p"],
    "H": "p^2/(2m) + m w^2 q^2/2",
    "parameters": {"m": "positive", "w": "positive", "E": "positive"},
}
WITH_ENERGY = OSCILLATOR | {"constants": ["E"], "parameters": {"m": "positive", "w": "positive"}}
KEPLER = {
    "q": ["r", "phi"],
    "p": ["pr", "pphi"],
    "H": "(pr^2 + pphi^2/r^2)/(2m) - k/r",
    "constants": ["E", "l"],
    "parameters": {"m": "positive", "k": "positive", "r": "positive"},
}
SLOW = {
    "q": ["q"],
    "p": ["p"],
    "small": ["eps"],
    "slow": ["tau"],
    "functions": {"w": ["tau"]},
    "parameters": {"eps": "positive", "w": "positive"},
    "H": "p^2/2 + w(tau)^2 q^2/2",
}


def verdict(kind: str, keys: dict, **answer) -> str:
    return judge(Claim("a", kind, {**keys, **answer}, budget=20)).status.name


# -- complete integrals ---------------------------------------------------------------------------------

INTEGRALS = [
    (WITH_ENERGY, "W", "W = ±∫ √(2mE − m²ω²q²) dq", "W = ±∫ √(2mE − mω²q²) dq"),
    (WITH_ENERGY, "W", r"$W = \pm\int\sqrt{2mE - m^2\omega^2q^2}\,dq$", r"$W = \pm\int\sqrt{mE - m^2\omega^2q^2}\,dq$"),
    (WITH_ENERGY, "W", r"$\int^q \sqrt{2mE - m^2\omega^2 q'^2}\,dq'$", r"$\int^q \sqrt{2mE - m^2\omega^2 q'}\,dq'$"),
    (WITH_ENERGY, "W", "∫^q √(2mE − m²ω²q'²) dq'", "∫^q √(2mE + m²ω²q'²) dq'"),
    (WITH_ENERGY, "W", "∫ dq √(2mE − m²ω²q²)", "∫ dq √(2mE − m²ω²q²)/2"),
    (
        WITH_ENERGY, "W",
        "W = E/ω (φ + sin φ cos φ), φ = arcsin(q √(mω²/(2E)))",
        "W = E/ω (φ - sin φ cos φ), φ = arcsin(q √(mω²/(2E)))",
    ),
    (
        WITH_ENERGY, "W",
        "q/2 sqrt(2 m E - m^2 w^2 q^2) + E/w asin(q sqrt(m w^2/(2E)))",
        "q/2 sqrt(2 m E - m^2 w^2 q^2) + E/(2w) asin(q sqrt(m w^2/(2E)))",
    ),
    (WITH_ENERGY, "S", "S = W − Et, W = ∫ √(2mE − m²ω²q²) dq", "S = W + Et, W = ∫ √(2mE − m²ω²q²) dq"),
    (WITH_ENERGY, "S", "S = W - E t = ∫ sqrt(2mE - m²ω²q²) dq - E t", "S = W - E t = ∫ sqrt(2mE - m²ω²q²) dq - 2 E t"),
    (WITH_ENERGY, "S", "S = ∫ p dq − E t = ∫ √(2mE − m²ω²q²) dq − E t", "S = ∫ p dq − E t = ∫ √(2mE − m²ωq²) dq − E t"),
    (WITH_ENERGY, "S", "∫ dq √(2mE − m²ω²q²) - E t", "∫ dq √(2mE − m²ω²q²) + E t"),
    (
        KEPLER, "W",
        "W = W_r(r) + W_φ(φ) = ∫ √(2m(E + k/r) − l²/r²) dr + lφ",
        "W = W_r(r) + W_φ(φ) = ∫ √(2m(E + k/r) − l²/r²) dr + 2lφ",
    ),
    (KEPLER, "W", "W = lφ + ∫ dr √(2m(E + k/r) − l²/r²)", "W = lφ + ∫ dr √(2m(E + k/r) + l²/r²)"),
    (KEPLER, "W", "W = lφ ± ∫ √(2m(E + k/r) − l²/r²) dr", "W = lφ ± ∫ √(2m(E - k/r) − l²/r²) dr"),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "key", "right", "wrong"), INTEGRALS)
def test_complete_integrals(keys, key, right, wrong):
    assert verdict("hamilton-jacobi", keys, **{key: right}) == "HOLDS"
    assert verdict("hamilton-jacobi", keys, **{key: wrong}) == "FAILS"


def test_the_end_of_an_integral_is_not_taken_for_its_variable():
    with pytest.raises(InvalidClaim, match="the variable of the integral, or its end"):
        verdict("hamilton-jacobi", WITH_ENERGY, W=r"$\int^q \sqrt{2mE - m^2\omega^2 q^2}\,dq'$")
    with pytest.raises(InvalidClaim, match="goes up to q, and its variable is x"):
        verdict("hamilton-jacobi", WITH_ENERGY, W=r"$\int^q \sqrt{2mE - m^2\omega^2 x^2}\,dx$")


def test_what_follows_a_differential_ends_at_a_sign_where_its_variable_is_done():
    with pytest.raises(InvalidClaim, match="does what follows belong to the integral"):
        verdict("hamilton-jacobi", WITH_ENERGY, W="∫ dq √(2mE − m²ω²q²) + q")


# -- both signs -----------------------------------------------------------------------------------------


def test_both_signs_are_claimed():
    plane = {"q": ["x", "y"], "p": ["px", "py"], "H": "(px^2+py^2)/2+(x^2+y^2)/2"}
    found = examine(Claim("a", "constant-of-motion", plane | {"I": "(px^2+x^2)/2 ± (py^2+y^2)/2"}))
    assert found.verdict.holds
    assert "both must be right" in found.reading.warnings[-1]
    assert verdict("constant-of-motion", plane, I="x*py ± y*px") == "FAILS"  # the lower signs alone are right
    assert verdict("constant-of-motion", plane, I="x*py ∓ y*px") == "FAILS"  # the upper signs alone are right
    assert verdict("constant-of-motion", plane, I="x*py - y*px ∓ (px^2 + x^2)") == "HOLDS"


def test_the_sign_that_is_wrong_is_told():
    plane = {"q": ["x", "y"], "p": ["px", "py"], "H": "(px^2+py^2)/2+(x^2+y^2)/2"}
    for typed in ("x*py ± y*px", "x*py ∓ y*px"):
        *_, (found, _) = judgements(Claim("a", "constant-of-motion", plane | {"I": typed}))
        assert "the sign of py*x is wrong" in found.feedback
        assert found.corrected == "I = px*y - py*x"


def test_a_gradient_may_have_both_signs():
    gradient = ["pr = ±sqrt(2m(E+k/r) - l^2/r^2)", "pphi = l"]
    assert verdict("hamilton-jacobi", KEPLER, gradient=gradient) == "HOLDS"
    assert verdict("hamilton-jacobi", KEPLER, gradient=[gradient[0].replace("±", "±2*"), "l"]) == "FAILS"
    with pytest.raises(InvalidClaim, match="chosen together, or each by itself"):
        verdict("hamilton-jacobi", KEPLER, gradient=[gradient[0], "±l"])


def test_one_wrong_sign_is_wrong():
    falling = {"q": ["x"], "L": "m x'^2/2 - m g x", "parameters": {"m": "positive", "g": "positive"}}
    assert verdict("euler-lagrange", falling, claim=["x'' = -g"]) == "HOLDS"
    assert verdict("euler-lagrange", falling, claim=["x'' = ±g"]) == "FAILS"


# -- actions, frequencies and invariants by the energy --------------------------------------------------


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("H/w", "2H/w"),
        ("J = E/w = H/w", "J = E/w = 2H/w"),
        ("J = E/ω", "J = E/2π"),
        ("J = H/w = E/w", "J = 2H/w = E/w"),
    ],
)
def test_actions_by_the_energy(right, wrong):
    assert verdict("action-angle", OSCILLATOR, J=right) == "HOLDS"
    assert verdict("action-angle", OSCILLATOR, J=wrong) == "FAILS"


def test_frequencies_that_are_equal_are_said_once():
    keys = {
        "q": ["r", "phi"],
        "p": ["pr", "l"],
        "H": "(pr^2 + l^2/r^2)/(2m) - k/r",
        "parameters": {"m": "positive", "k": "positive", "r": "positive", "l": "positive", "E": "negative"},
        "domain": ["(pr**2 + l**2/r**2)/(2*m) - k/r < 0"],
    }
    assert verdict("frequency", keys, omega="ω_r = ω_φ = (2|E|)^(3/2)/(k√m)") == "HOLDS"
    assert verdict("frequency", keys, omega="ω_r = ω_φ = (2|E|)^(3/2)/(2k√m)") == "FAILS"
    with pytest.raises(InvalidClaim):
        verdict("frequency", keys, omega="ω_r = (2|E|)^(3/2)/(k√m)")


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("E/w = (p^2 + w^2q^2)/(2w)", "E/w^2 = (p^2 + w^2q^2)/(2w)"),
        ("I = H/w", "I = H/w^2"),
        ("J = E/w = H/w(tau)", "J = E/w = H/w(tau)^2"),
    ],
)
def test_adiabatic_invariants_by_the_energy(right, wrong):
    assert verdict("adiabatic-invariant", SLOW, I=right) == "HOLDS"
    assert verdict("adiabatic-invariant", SLOW, I=wrong) == "FAILS"


@pytest.mark.parametrize("said", ["H", "E", "H^2", "I = H", "H/m"])
def test_that_the_energy_is_constant_says_nothing(said):
    """Of any system: the question asks for the constant of this one."""
    with pytest.raises(InvalidClaim):
        verdict("constant-of-motion", OSCILLATOR | {"parameters": {"m": "positive", "w": "positive"}}, I=said)


def test_the_energy_is_no_letter_where_it_is_declared():
    """With E a parameter, E/w is a number of its own and no constant that says anything of the motion."""
    keys = SLOW | {"parameters": SLOW["parameters"] | {"E": "positive"}}
    assert verdict("adiabatic-invariant", keys, I="E/w") == "FAILS"


# -- functions without their variables ------------------------------------------------------------------


def test_a_function_stands_for_its_value_beside_others():
    keys = {
        "q": ["x"],
        "p": ["p"],
        "functions": {"V": ["x"]},
        "L": "m x'^2/2 - V(x)",
        "parameters": {"m": "positive"},
    }
    assert verdict("legendre-hamiltonian", keys, H="p^2/2m + V") == "HOLDS"
    assert verdict("legendre-hamiltonian", keys, H="p^2/2m - V") == "FAILS"
    with pytest.raises(InvalidClaim, match=r"V is a function; write V\(x\)"):
        verdict("legendre-hamiltonian", keys, H="V m")


# -- virtual work ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("δW = F δx + (F l cos θ - m g l sin θ) δθ", "δW = F δx + (F l cos θ + m g l sin θ) δθ"),
        (
            r"$\delta W = F\,\delta x + (F l\cos\theta - m g l\sin\theta)\,\delta\theta$",
            r"$\delta W = F\,\delta x$",
        ),
        ("δA = (F l cos θ - m g l sin θ) δθ + F δx", "δA = (F l cos θ - m g l sin θ) δx + F δθ"),
    ],
)
def test_a_virtual_work_says_the_generalized_forces(right, wrong):
    keys = {
        "q": ["x", "theta"],
        "parameters": {"F": "real", "l": "positive", "g": "positive", "m": "positive"},
        "forces": [{"F": ["F", "-m*g"], "r": ["x + l*sin(theta)", "-l*cos(theta)"]}],
    }
    assert verdict("generalized-force", keys, Q=right) == "HOLDS"
    assert verdict("generalized-force", keys, Q=wrong) == "FAILS"
    with pytest.raises(InvalidClaim):
        verdict("generalized-force", keys, Q="δW = F δx δθ")
