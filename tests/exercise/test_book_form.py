"""Book forms: clearly shorter, the same by algebra, proved before they are shown, and bounded whatever the answer."""

import time
from pathlib import Path

import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose import right_answer
from canon.exercise.diagnose.diagnosis import judged_to_hold
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.right_answer import corrected
from canon.exercise.explained_judgement import judgements
from canon.exercise.question.book_form import CLEARLY, book_forms
from canon.exercise.sheet.sheet import read_sheet
from canon.mechanics.algebra.substitution import size

CLAIMS = Path(__file__).parent.parent / "data" / "claims"
EVERY = {claim.id: claim for path in CLAIMS.glob("*.json") for claim in read_sheet(path).claims}
a, b, x, y = sp.symbols("a b x y", real=True)
PLACE = {a: sp.Rational(7, 5), b: sp.Rational(11, 7), x: sp.Rational(5, 9), y: sp.Rational(13, 8)}


def grown(inner):
    return st.one_of(
        st.tuples(inner, inner).map(lambda fg: fg[0] + fg[1]),
        st.tuples(inner, inner).map(lambda fg: fg[0] - fg[1]),
        st.tuples(inner, inner).map(lambda fg: fg[0] * fg[1]),
        st.tuples(inner, inner).map(lambda fg: fg[0] / fg[1]),
        inner.map(lambda f: f**2),
    )


LEAVES = [a, b, x, y, sp.sin(x), sp.cos(x), sp.sin(x) ** 2, sp.cos(x) ** 2, sp.Integer(2), sp.sqrt(a**2 + 1)]
EXPRESSIONS = st.recursive(st.sampled_from(LEAVES), grown, max_leaves=10)


@settings(max_examples=100, deadline=None)
@given(EXPRESSIONS)
def test_a_form_is_the_same_and_clearly_shorter(f):
    assume(not f.has(sp.zoo, sp.nan))
    here = f.subs(PLACE).n(50)
    assume(here.is_finite)
    for form in book_forms(f):
        assert abs(form.subs(PLACE).n(50) - here) <= sp.Float(10) ** -35 * (1 + abs(here))
        assert size(form) <= CLEARLY * size(f)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("BC-07a", "dpr δr = 1;"),
        ("LB-03a", "[A, phi] = -A*m*w"),
        ("LH-04a", "Omega*(px*y - py*x) + (px**2 + py**2)/(2*m)"),
        ("GA-05a", "-g*m*sin(alpha) + 3*m*v_dot/2 = 0"),
        ("LH-01a", "-g*l*m*cos(theta) + p**2/(2*l**2*m)"),
    ],
)
def test_right_answers_as_they_are_shown(name, said):
    assert said in corrected(examine(EVERY[name]))


def test_a_form_that_is_not_proved_is_not_shown(monkeypatch):
    finding = examine(EVERY["LB-03a"])
    monkeypatch.setattr(right_answer, "book_forms", lambda f: [-f, sp.S.One])
    assert corrected(finding) == "[A, phi] = -A*m*w*sin(phi + t*w)**2 - A*m*w*cos(phi + t*w)**2"


def test_where_the_steps_are_spent_an_answer_stands_as_it_is(monkeypatch):
    finding = examine(EVERY["LB-03a"])
    monkeypatch.setattr(right_answer, "MOST_PROOFS", -1)
    assert corrected(finding) == "[A, phi] = -A*m*w*sin(phi + t*w)**2 - A*m*w*cos(phi + t*w)**2"


@pytest.mark.parametrize(
    "f",
    [
        (a + b + x + y + 1) ** 60,
        (a + b) ** 10**6 + x * (a + b) ** 10**6,
        sp.prod([a + b**i + x**i + 1 for i in range(12)]),
        sp.Add(*(1 / (a + b * i + x**i) for i in range(12))),
        sp.Add(*(sp.sin(i * x) ** 6 * (a + b) ** 4 for i in range(40))),
        sp.cos(x) ** 1000000 * sp.sin(x) ** 1000000,
        1 / (a + b + x + y) ** 40 + 1 / (a - b + x * y) ** 40,
    ],
    ids=lambda f: str(f)[:20],
)
def test_what_is_large_costs_little(f):
    start = time.process_time()
    book_forms(f)
    assert time.process_time() - start < 3.0


def test_short_answers_keep_their_style():
    m, g, z = sp.symbols("m g z")
    assert book_forms(m * g + m * z) == ()
    assert book_forms(a * (x + y)) == ()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("CT-01a", "Q = -p*sin(t*w) - q*cos(t*w)"),
        ("CA-06b", "P1 = -pf*sin(phi)/r + pr*cos(phi); P2 = pf*cos(phi)/r + pr*sin(phi)"),
        ("CA-09a", "Q + h**2*Derivative(V(q), q)/m - h*p/m - q = 0"),
        ("SL-04a", "x = m*v0*(1 - exp(-c*t/m))/c"),
        ("LE-01a", "L2 = m*x_dot**2/2"),
        ("CA-13a", ""),
    ],
)
def test_a_repaired_answer_is_shown_where_canon_has_no_other(name, said):
    *_, (judgement, _) = judgements(EVERY[name])
    assert judgement.corrected == said
    if said:
        repaired = diagnosis(examine(EVERY[name])).repaired
        assert judged_to_hold(repaired, Effort(60.0))
        assert set(said.replace(" = 0", "").split("; ")) & {
            part for f in repaired.instead.values() for part in (str(f), *(f"{k} = {f}" for k in NAMES))
        }


NAMES = ("Q", "P1", "P2", "x", "L2")
