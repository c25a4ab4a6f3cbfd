"""Texts that are taken apart before they are read: vectors, matrices, lists, operators; and what is left alone."""

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.exercise.sheet.equations.defined_vectors import without_defined_vectors
from canon.exercise.sheet.equations.matrix_products import equations_of_products
from canon.exercise.sheet.equations.program_lists import listed_plainly
from canon.exercise.sheet.equations.typed_indices import equations_by_index
from canon.exercise.sheet.equations.typed_matrices import equations_of_matrices
from canon.exercise.sheet.equations.vector_operators import components_of_operator
from canon.exercise.sheet.field_texts import of_matrix, with_texts
from canon.exercise.sheet.sheet import Claim, SheetError, read_sheet
from canon.exercise.sheet.signs_apart import signs_apart
from canon.exercise.sheet.sympy_trees import shown
from canon.expression.text.scope import Scope
from canon.frozen_mapping import FrozenMapping

PLANE = {"q": ["x", "y"]}
FORCES = r"\vec F = (0, 1), \vec G = (1, 0), \vec K = (1, 1)"


def scope_of(moving, fixed):
    return Scope({s.name: s for s in (*coordinates(moving), *parameters(fixed))})


def test_three_forces_are_defined_behind_an_equation_and_each_has_its_components():
    bare, vectors = without_defined_vectors(rf"m\ddot{{\vec r}} = \vec F + \vec G + \vec K, {FORCES}", PLANE)
    assert bare == r"m\ddot{\vec r} = \vec F + \vec G + \vec K"
    assert [(bare[begin:end], entries) for begin, end, entries in vectors] == [
        (r"\vec F", ("0", "1")), (r"\vec G", ("1", "0")), (r"\vec K", ("1", "1")),
    ]  # fmt: skip


def test_a_place_by_another_letter_is_not_read_beside_an_r_of_its_own():
    text = r"m\ddot{\mathbf x} = -k\mathbf{x}, \mathbf x = (x, y)"
    assert without_defined_vectors(text, PLANE) == (r"m\ddot{\vec r} = -k\vec r", [])
    two = text.replace(",", r" + \vec r,", 1)
    assert without_defined_vectors(two, PLANE) == (two, [])


COLUMN = r"\begin{pmatrix} x \\ y \end{pmatrix}"


@pytest.mark.parametrize(("right", "equations"), [
    (r"\begin{pmatrix} 1 \\ 2 \end{pmatrix}", ["$(x) = (1)", "$(y) = (2)"]),
    (r"\begin{pmatrix} 1 \\ 2 \\ \end{pmatrix}", ["$(x) = (1)", "$(y) = (2)"]),  # nothing stands in a third row
    (r"\begin{pmatrix} 1 \\ 2 \\ 3 \end{pmatrix}", []),
    (r"\begin{pmatrix} 1 \\ 2", []),
    (r"\begin{pmatrix} 1 \\ \begin{pmatrix} 2 \end{pmatrix} \end{pmatrix}", []),
    ("Matrix([1, 2])", ["$(x) = (1)", "$(y) = (2)"]),
    ("Matrix([1, 2]", []),
    ("Matrix([1, 2", []),
])  # fmt: skip
def test_matrices_are_closed_and_have_equally_many_rows_on_both_sides(right, equations):
    assert equations_of_products(f"{COLUMN} = {right}", str) == equations


@pytest.mark.parametrize(("text", "entries"), [
    (r"$\begin{pmatrix} y \\ -x \end{pmatrix}$", ["$ y", "$ -x"]),
    (r"$\begin{pmatrix} y \\ -x \\ \end{pmatrix}$", ["$ y", "$ -x"]),
    (r"$\begin{pmatrix} y \\ -x \\ 0 \end{pmatrix}$", ["$ y", "$ -x", "$ 0"]),
    ("Matrix([x, y, z]) = Matrix([1, 2])", []),
])  # fmt: skip
def test_entries_of_one_column(text, entries):
    assert [entry.strip() for entry in of_matrix(text)] == entries


@pytest.mark.parametrize(("text", "plain"), [
    ("{x' -> y, y' -> -x}", "x' =  y; y' =  -x"),
    ("{x' -> y, y' = -x}", "{x' -> y, y' = -x}"),  # half of it is no rule
    ("{x, {y -> 1}}", "{x, {y -> 1}}"),
    ("x -> {1, 2}", "x -> {1, 2}"),  # where x tends to
])  # fmt: skip
def test_lists_of_rules_are_equations_and_nothing_else_is(text, plain):
    assert listed_plainly(text).strip() == plain


@pytest.mark.parametrize(("behind", "read"), [
    ("(m_1, m_2) = (m, k)", "m x_1'' = -a x_1; k x_2'' = -a x_2"),
    ("(m_1, m_2) = (m, k, a)", None),  # one value too many
    ("(m, m_2) = (k, a)", None),  # m is a name of the question
])  # fmt: skip
def test_names_with_an_index_have_one_value_each(behind, read):
    text = f"m_i x_i'' = -a x_i, i = 1, 2, {behind}"
    assert equations_by_index(text, scope_of("x1 x2", "m k a")) == (read or text)


NEWTON = "M q'' = 0, M = diag(m, k), q = (x, y)^T"


@pytest.mark.parametrize(("text", "read"), [
    (NEWTON, "((m)*(x'') + (0)*(y'')) = 0; ((0)*(x'') + (k)*(y'')) = 0"),
    (NEWTON.replace("q''", "q'").replace("(x", "(x'"), "((m)*(x'') + (0)*(y')) = 0; ((0)*(x'') + (k)*(y')) = 0"),
    (NEWTON.replace("(x", "(x'"), None),  # a third derivative
    (NEWTON.replace("(x", "(2*x"), None),
    (NEWTON.replace("k)", "k"), None),
    ("d/dt [x; y] = [0 1; -k 0] [x; y]", "x' = ((0)*(x) + (1)*(y)); y' = ((-k)*(x) + (0)*(y))"),
    ("d/dt [x; y] = [0 1; -k 0] [x; y", None),
])  # fmt: skip
def test_matrices_by_name(text, read):
    assert equations_of_matrices(text, scope_of("x y", "m k")) == (read or text)


def test_t_raised_is_no_transpose_where_it_is_a_period():
    assert equations_of_matrices(NEWTON, scope_of("x y", "m k T")) == NEWTON


@pytest.mark.parametrize(("text", "components"), [
    ("[X, Y] = x ∂_x = x ∂_x", ["x", "0"]),
    ("[X, Y] = x ∂_x = y ∂_y", []),
    ("[X, Y] = x ∂_x = y", []),
    ("[X, Y] = x ∂_x; y ∂_y", []),
])  # fmt: skip
def test_an_operator_has_components_where_it_is_said_once(text, components):
    scope = Scope({name: sp.Symbol(name, real=True) for name in "xy"})
    assert components_of_operator(text, ["x", "y"], scope) == components


def test_texts_are_exchanged_in_lists_and_tables_and_numbers_stay():
    assert with_texts(("a", 3, FrozenMapping({"k": ["a", "c"]})), {"a": "b"}) == ["b", 3, {"k": ["b", "c"]}]


@pytest.mark.parametrize(("kind", "key", "value", "signs"), [
    ("poisson-bracket", "pairs", [{"f": "q", "g": "p", "value": "±1"}], ("+1", "-1")),
    ("solution", "solution", {"x": "±1"}, ("+1", "-1")),
    ("canonicity", "Q", ["∓1", 3], ("-1", "+1")),
])  # fmt: skip
def test_both_signs_are_parted_wherever_they_stand(kind, key, value, signs):
    said = (
        with_texts(value, {"±1": signs[0], "∓1": signs[0]}),
        with_texts(value, {"±1": signs[1], "∓1": signs[1]}),
    )
    apart = signs_apart(Claim("a", kind, {key: value}), lambda _, error: error)
    assert tuple(each.keys[key] for each in apart) == said


def test_a_sheet_may_hold_mappings_of_any_class_and_nothing_that_is_no_text():
    claim = {"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "2/2"}
    assert read_sheet({"claims": [FrozenMapping(claim)]}).claims == read_sheet({"claims": [claim]}).claims
    with pytest.raises(SheetError, match="hold what no sheet does"):
        read_sheet({"claims": [{**claim, "rhs": {1, 2}}]})


def test_slopes_at_a_place_are_shown_by_a_name_only_where_the_place_moves_with_it_at_unit_rate():
    t, x, y = sp.symbols("t x y")
    V, W = sp.Function("V"), sp.Function("W")
    assert shown(V(y - x).diff(x)) == "Derivative(V(-x + y), x)"
    assert shown(sp.Subs(W(x, y).diff(x), x, t + y)) == "Derivative(W(t + y, y), t)"
    for f in (
        V(2 * x).diff(x) / 2,
        sp.Subs(x * V(x).diff(x), x, sp.Integer(2)),
        V(x**2).diff(x) / (2 * x),
        sp.Subs(W(x, y).diff(x), x, sp.Integer(2)),
        sp.Subs(W(x, y).diff(x), x, y),  # W has y in its other place too
        sp.Subs(W(x, y).diff(x, y), (x, y), (t, 2 * t)),
    ):
        assert shown(f) == str(f)
