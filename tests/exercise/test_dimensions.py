"""Dimensions of quantities: decided where an expression scales, told of what is impossible, never judged by."""

import json
from fractions import Fraction
from itertools import pairwise

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from canon.exercise.diagnose.repairs.impossible_dimension import impossible_dimensions
from canon.exercise.question.declared_dimensions import declared_dimensions
from canon.exercise.question.expression_dimension import analysed, dimension_of
from canon.exercise.question.question import Part
from canon.exercise.sheet.quantities.dimension_texts import NUMBER, Dimension, DimensionError, dimension_from
from canon.exercise.sheet.reading import Reading
from canon.exercise.sheet.sheet import SheetError, claim_from, read_sheet
from canon.exercise.sheet_check import check
from canon.proof.domain.domain import EVERYWHERE

BASES = (length, mass, time) = sp.symbols("length mass time", positive=True)
angle, unknown = sp.symbols("angle unknown", positive=True)
KNOWN = {
    **{base.name: Dimension.of(*(int(i == k) for i in range(3))) for k, base in enumerate(BASES)},
    "angle": NUMBER,
}
VALUES = {
    length: sp.Rational(7, 5),
    mass: sp.Rational(3, 7),
    time: sp.Rational(11, 9),
    angle: sp.Rational(2, 3),
}
POWERS = (Fraction(1, 2), Fraction(-1), Fraction(2), Fraction(-2, 3))


def grown(inner):
    return st.one_of(
        st.tuples(inner, inner).map(lambda ab: ab[0] + ab[1]),
        st.tuples(inner, inner).map(lambda ab: ab[0] * ab[1]),
        st.tuples(inner, inner).map(lambda ab: ab[0] / ab[1]),
        st.tuples(inner, st.sampled_from(POWERS)).map(
            lambda fe: fe[0] ** sp.Rational(*fe[1].as_integer_ratio())
        ),
        st.tuples(inner, st.sampled_from([sp.exp, sp.sinh, sp.atan, sp.Abs])).map(lambda fg: fg[1](fg[0])),
    )


EXPRESSIONS = st.recursive(st.sampled_from([*BASES, *BASES, angle, sp.Integer(2)]), grown, max_leaves=8)
"""Expressions that are positive where their symbols are."""


def scaled(f, by):
    """Return log f(λx)/f(x), the base quantities being scaled by their factors."""
    there = {s: VALUES[s] * by.get(s, 1) for s in VALUES}
    return sp.log((f.subs(there) / f.subs(VALUES)).n(60)).n(50)


@settings(max_examples=150, deadline=None)
@given(EXPRESSIONS)
def test_what_has_a_dimension_scales_with_it_and_what_clashes_does_not_scale(f):
    found = dimension_of(f, KNOWN)
    clashes = analysed(f, KNOWN)
    factors = dict(zip(BASES, (sp.Rational(5, 4), sp.Rational(4, 3), sp.Rational(6, 5)), strict=True))
    if found is not None:
        assert not clashes or not any(clash.is_of_a_sum for clash in clashes if clash.node == f)
        wanted = sum(
            p.numerator * sp.log(factors[base]) / p.denominator
            for base, p in zip(BASES, found.powers, strict=False)
        )
        assert abs(scaled(f, factors) - wanted) < 1e-25
    elif not clashes:
        assert f.has(sp.zoo, sp.nan)  # every symbol is known, so that nothing is left open without a reason
    for clash in clashes:
        assert clash.node.is_number is False
        base = next(
            b for i, b in enumerate(BASES) if len({d.powers[i] for _, d in (*clash.parts, (0, NUMBER))}) > 1
        )
        if clash.is_of_a_sum and len({d.powers[BASES.index(base)] for _, d in clash.parts}) == 1:
            base = next(b for i, b in enumerate(BASES) if len({d.powers[i] for _, d in clash.parts}) > 1)
        for part, dimension in clash.parts:
            slope = dimension.powers[BASES.index(base)]
            wanted = sp.Rational(slope.numerator, slope.denominator) * sp.log(2)
            assert abs(scaled(part, {base: 2}) - wanted) < 1e-25
        if (
            clash.is_of_a_sum and clash.all_decided
        ):  # log Σ aᵢ λ^dᵢ is strictly convex in log λ where the dᵢ differ
            here = [scaled(clash.node, {base: 2**k}) for k in range(3)]
            steps = [b - a for a, b in pairwise(here)]
            assert steps[1] - steps[0] > 1e-25


@given(EXPRESSIONS)
@settings(max_examples=50, deadline=None)
def test_nothing_is_decided_of_what_holds_an_unknown_symbol_as_a_factor(f):
    assume(not f.has(sp.zoo, sp.nan))
    assert dimension_of(f * unknown, KNOWN) is None
    assert dimension_of(f + unknown, KNOWN) is None
    assert {c.node for c in analysed(f * unknown, KNOWN)} <= {c.node for c in analysed(f, KNOWN)}


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (sp.log(length / mass), None),
        (angle**angle, "number"),
        (length**angle, None),
        (length**1000000, None),
        (sp.sqrt(length**2), "length"),
        (sp.atan2(length, 2 * length), "number"),
        (sp.Max(length, 3 * length), "length"),
        (sp.Function("mass")(length).diff(length), "mass/length"),
        (sp.Function("V")(length).diff(length), None),
        (sp.Piecewise((length, length > 1), (mass, True)), None),
        (sp.S.Zero, None),
        (sp.pi * sp.E, "number"),
        (sp.sign(length) * mass, "mass"),
    ],
)  # fmt: skip
def test_other_functions(f, said):
    found = dimension_of(f, KNOWN)
    assert (None if found is None else str(found)) == said
    assert analysed(f, KNOWN) == ()


@pytest.mark.parametrize("f", [sp.atan2(length, mass), sp.Max(length, mass), sp.sin(length), angle**length])
def test_functions_that_make_no_sense(f):
    assert [clash.node for clash in analysed(f, KNOWN)] == [f]


@given(st.lists(st.fractions(-6, 6, max_denominator=12), min_size=6, max_size=6))
def test_a_dimension_is_read_as_it_is_written(powers):
    dimension = Dimension(tuple(powers))
    assume(not dimension.name or " or " not in dimension.name)
    if all(abs(p.numerator) <= 12 for p in powers):
        assert dimension_from(str(dimension)) == dimension


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("energy", "kg m^2 s^-2"), ("energy", "N m"), ("force", "kg*m/s²"), ("moment of inertia", "kg*m^2"),
        ("Angular momentum", "J*s"), ("angular  velocity", "rad/s"), ("1", "number"), ("angle", "deg"),
        ("length/time/time", "acceleration"), ("length^(1/2)", "m**(1/2)"), ("stiffness", "N/m"), ("km/h", "velocity"),
        ("mass/(length*time)", "kg/(m s)"), ("spring constant*length", "force"),
    ],
)  # fmt: skip
def test_what_a_teacher_types(one, other):
    assert dimension_from(one) == dimension_from(other)


def test_brackets_are_counted() -> None:
    assert dimension_from("(" * 8 + "m" + ")" * 8) == dimension_from("length")
    assert dimension_from("*".join(["(m)"] * 12)) == dimension_from("m^12")
    with pytest.raises(DimensionError, match="more than 8 brackets inside each other"):
        dimension_from("(" * 9 + "m" + ")" * 9)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("furlong", "is no dimension and no unit"), ("", "at its end"), ("mass+length", "not read at '+length'"),
        ("J/kg K", "below the stroke"), ("length^13", "none that anyone means"), ("m^(1/0)", "none that anyone means"),
        ("length^999999999", "none that anyone means"), ("m" * 500, "characters"),
        ("((((((((((m))))))))))", "brackets"),
        ("(m", "not closed"), ("m**m", "not read"), ("m)", "not read"), ("__import__", "is no dimension"),
        ("2 m", "not read"),
    ],
)  # fmt: skip
def test_what_is_no_dimension(text, why):
    with pytest.raises(DimensionError, match=why.replace("+", r"\+")):
        dimension_from(text)


PENDULUM = {
    "kind": "euler-lagrange", "q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "parameters": {"m": "positive", "l": "positive", "g": "positive"},
    "dimensions": {"m": "mass", "l": "length", "g": "m/s^2", "theta": "1"},
}  # fmt: skip
LEGENDRE = {**PENDULUM, "kind": "legendre-hamiltonian", "p": ["p"]}
ENERGY, FORCE = "the dimension of energy or torque", "the dimension of force"


def told(**keys):
    (judgement,) = check({"claims": [{"id": "a", **keys}]})
    return judgement


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({**PENDULUM, "claim": ["m*l**2*theta_ddot + m*g*sin(theta) = 0"]},
         f"g*m*sin(theta) has {FORCE}, and l**2*m*theta_ddot has {ENERGY}: one of them is wrong"),
        ({**PENDULUM, "claim": ["m*l**2*theta_ddot + m*l**2*theta_dot**2 + 7*m*g*cos(theta)**5 = 0"]},
         f"7*g*m*cos(theta)**5 has {FORCE}, the other terms have {ENERGY}: one of them is wrong"),
        ({**PENDULUM, "claim": ["l*theta_ddot + g*sin(m*theta) = 0"]},
         "m*theta has the dimension of mass, and in sin(m*theta) only a pure number makes sense"),
        ({**PENDULUM, "claim": ["m*l**2*theta_ddot + 7*m*l*theta_dot + m*g + 1 = 0"]}, "not all of them can be right"),
        ({**LEGENDRE, "H": "p**2/(2*m*l) - m*g*l*cos(theta)"},
         f"the dimension length^3*mass/time^2, and -g*l*m*cos(theta) has {ENERGY}: one of them is wrong"),
        ({**LEGENDRE, "H": "7*g*l*p**3"},
         f"H has the dimension length^8*mass^3/time^5, and the right one has {ENERGY}"),
        ({"kind": "equality-only", "lhs": "x", "rhs": "7*x**2*y**3", "parameters": {"x": "positive", "y": "positive"},
          "dimensions": {"x": "m", "y": "s"}},
         "rhs has the dimension length^2*time^3, and the right one has the dimension of length"),
    ],
)  # fmt: skip
def test_what_is_impossible_is_told(keys, said):
    judgement = told(**keys)
    assert judgement.status == "fails"
    assert judgement.feedback.endswith(said), judgement.feedback
    without = told(**{key: value for key, value in keys.items() if key != "dimensions"})
    assert without.status == "fails"
    assert "dimension" not in without.feedback
    assert judgement.feedback.startswith(without.feedback)


@pytest.mark.parametrize(
    "keys",
    [
        # possible as far as dimensions go
        {**PENDULUM, "claim": ["m*l**2*theta_ddot - m*g*l*sin(theta) = 0"]},
        {**PENDULUM, "claim": ["theta_ddot + 7*g/l*cos(theta)**5 = 0"]},
        {**LEGENDRE, "H": "p**2/(m*l**2) - m*g*l*cos(theta)"},
        # the factor that is lost has an unknown dimension
        {**PENDULUM, "dimensions": {"m": "mass", "g": "m/s^2", "theta": "1"},
         "claim": ["m*l**2*theta_ddot + m*g*sin(theta)"]},
        # a logarithm, and an exponent that is no number
        {**PENDULUM, "claim": ["l*theta_ddot + 7*g*cos(theta)*log(l)**3"]},
        # what clashes vanishes
        {**PENDULUM, "claim": ["m*l**2*theta_ddot - m*g*l*sin(theta) + m*(sin(theta)**2 + cos(theta)**2 - 1) = 0"]},
        # the equation with a strange sum is right; another is wrong
        {"kind": "euler-lagrange", "q": ["x", "a"], "L": "m*x_dot**2/2 + J*a_dot**2/2 - k*x**2/2",
         "parameters": {"m": "positive", "J": "positive", "k": "positive"},
         "dimensions": {"m": "mass", "J": "moment of inertia", "k": "stiffness", "x": "length", "a": "angle"},
         "claim": ["m*x_ddot + k*x + J*a_ddot", "J*a_ddot + a*J = 0"]},
    ],
)  # fmt: skip
def test_nothing_is_told_of_what_is_possible_or_unknown(keys):
    judgement = told(**keys)
    assert judgement.status == "fails"
    if "x" in keys["q"]:
        assert "equation 1" not in judgement.feedback
    else:
        assert "dimension" not in judgement.feedback
        assert "pure number" not in judgement.feedback


def test_an_answer_refused_for_its_variables_is_not_blamed_for_its_terms():
    free = {
        "kind": "constant-of-motion",
        "q": ["x"],
        "p": ["p"],
        "H": "p**2/(2*m)",
        "parameters": {"m": "positive"},
    }
    sizes = {"dimensions": {"m": "mass", "x": "length", "p": "momentum"}}
    assert told(**free, **sizes, I="p**2/(2*m) + p").status == "holds"
    judgement = told(**free, **sizes, I="p**2/(2*m) + p", **{"in": ["x"]})
    assert judgement.status == "fails"
    assert "dimension" not in judgement.feedback
    assert "one of them is wrong" in told(**free, **sizes, I="p**2/(2*m) + p*x").feedback


@pytest.mark.parametrize(
    "claim", ["l*theta_ddot + g*sin(theta)", "m*l*theta_ddot + g*sin(theta)", "theta_ddot + g/l*theta"]
)
@pytest.mark.parametrize(
    "table", [None, {"m": "mass"}, {"l": "1", "g": "1", "t": "1", "theta": "1"}, {"theta": "furlong"}]
)
def test_a_verdict_never_depends_on_dimensions(claim, table):
    keys = {key: value for key, value in PENDULUM.items() if key != "dimensions"}
    plain = told(**keys, claim=[claim])
    with_table = told(**keys, claim=[claim], **({} if table is None else {"dimensions": table}))
    bad = table is not None and "furlong" in table.values()
    assert with_table.status == ("invalid" if bad else plain.status)


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ({"g": "furlong"}, "key dimensions.g: furlong is no dimension"),
        ({"k": "mass"}, "key dimensions.k: is not declared"),
        ({"theta_dot": "1/s"}, "follows from that of its coordinate"),
        ({"g": "mass"}, "in L that is given the terms of a sum differ"),
        ({"m": ["mass"]}, "should be a table"),
        ({"θ": "1"}, "write theta for θ"),
        ({"m": "m^" + "9" * 400}, "characters"),
    ],
)  # fmt: skip
def test_bad_declarations_are_refused_whatever_the_answer(keys, why):
    for claim in ("l*theta_ddot + g*sin(theta)", "theta_ddot"):
        judgement = told(**{**PENDULUM, "dimensions": {**PENDULUM["dimensions"], **keys}}, claim=[claim])
        assert judgement.status == "invalid"
        assert why in judgement.known


def test_a_momentum_of_another_dimension_than_its_lagrangian_gives_is_refused():
    sizes = PENDULUM["dimensions"]
    judgement = told(**{**LEGENDRE, "dimensions": {**sizes, "p": "momentum"}}, H="p")
    assert (
        "p is declared as momentum, and follows from L or H as action or angular momentum" in judgement.known
    )
    right = told(
        **{**LEGENDRE, "dimensions": {**sizes, "p": "action"}}, H="p**2/(2*m*l**2) - m*g*l*cos(theta)"
    )
    assert right.status == "holds"


def test_a_table_beside_the_claims_is_meant_for_the_names_of_each():
    plain = {key: value for key, value in PENDULUM.items() if key != "dimensions"}
    claims = [
        {"id": "a", **plain, "claim": ["m*l**2*theta_ddot + m*g*sin(theta) = 0"]},
        {"id": "b", "kind": "equality-only", "lhs": "x", "rhs": "x", "parameters": {"x": "real"}},
    ]
    sheet = {"title": "s", "dimensions": {**PENDULUM["dimensions"], "x": "length"}, "claims": claims}
    first, second = check(sheet)
    assert first.feedback.endswith("one of them is wrong")
    assert second.status == "holds"
    with pytest.raises(SheetError, match="dimensions: 'y' is declared by no claim"):
        read_sheet({**sheet, "dimensions": {"y": "length"}})
    assert all("table" in c.errors[0].reason for c in read_sheet({**sheet, "dimensions": "mass"}).claims)


def test_what_is_told_stands_in_the_json_and_on_the_page():
    report = check({"claims": [{"id": "a", **PENDULUM, "claim": ["m*l**2*theta_ddot + m*g*sin(theta) = 0"]}]})
    assert "has the dimension of force" in json.loads(report.to_json())["claims"][0]["feedback"]
    assert "has the dimension of force" in report.to_html()
    assert "has the dimension of force" in str(report)


def test_moduli_signs_products_with_zero_and_slopes():
    f = sp.Function("f")
    known = {**KNOWN, "f": KNOWN["mass"]}
    assert dimension_of(mass * sp.Abs(length - 2 * length, evaluate=False), known) == dimension_from(
        "mass*length"
    )
    assert dimension_of(mass * sp.sign(length - 1, evaluate=False), known) == dimension_from("mass")
    nothing = sp.Mul(0, mass, evaluate=False)
    assert analysed(sp.Add(length, nothing, evaluate=False), known) == ()
    assert len(analysed(sp.Add(length, mass, evaluate=False), known)) == 1
    assert dimension_of(f(length).diff(length), known) == dimension_from("mass/length")
    assert dimension_of(f(unknown).diff(unknown), known) is None


TWO = {
    "q": ["x", "y"], "p": ["px", "py"], "L": "m*x_dot**2/2 + m*y_dot**2/2", "parameters": {"m": "positive"},
}  # fmt: skip


def test_momenta_have_dimensions_where_their_coordinates_have():
    def known(**more):
        return declared_dimensions(
            Reading(claim_from({"id": "a", "kind": "legendre-hamiltonian", **TWO, **more}))
        )

    assert known() == {}
    one = known(dimensions={"m": "mass", "x": "length"})
    assert (one["px"], "py" in one) == (dimension_from("momentum"), False)
    assert known(dimensions={"m": "mass", "x": "length", "y": "length"})["py"] == dimension_from("momentum")


def test_what_may_vanish_is_not_told_to_be_impossible():
    keys = {"H": "px", "dimensions": {"m": "mass", "x": "length", "y": "length"}}
    reading = Reading(claim_from({"id": "a", "kind": "legendre-hamiltonian", **TWO, **keys}))
    one = sp.sin(sp.S.One) ** 2 + sp.cos(sp.S.One) ** 2
    m, p = (reading.scope.names[name] for name in ("m", "px"))

    def told(claimed, right, key="H"):
        answered = reading.with_instead("H", claimed)
        return [
            change.mistake.name
            for change in impossible_dimensions(
                answered, (Part("H", claimed, right, key=key),), EVERYWHERE, 3
            )
        ]

    energy = p**2 / m
    assert told(energy + m, energy) == ["TERMS_OF_OTHER_DIMENSION"]
    assert told(energy + m * (one - 1), 2 * energy) == []  # no term at all
    assert told(energy, energy) == []
    assert told(energy + m, energy, key="") == ["TERMS_OF_OTHER_DIMENSION"]  # what is right is not known
    assert told(p, energy) == ["DIMENSION_OF_ANSWER"]
    assert told(energy * sp.sin(reading.scope.names["x"]), energy) == ["NO_NUMBER"]
