"""How a text is read, asked without a service around it: what stands in a claim, what is wrong with a question."""

import pytest

from canon.serve.reading_process import how_read


def plain(**asked):
    found = how_read(asked)
    assert found["read"], found
    return [statement["plain"] for statement in found["statements"]]


def refused(**asked):
    found = how_read(asked)
    assert not found["read"]
    assert found["error"]["reason"]
    return found["error"]


def test_a_text_alone_is_read_by_its_declared_names():
    assert plain(text="theta'' + sin(theta) = 0", q=["theta"]) == ["theta_ddot + sin(theta) = 0"]
    assert plain(text="p^2/2", q=["x"], p=["p"]) == ["p**2/2"]
    assert refused(text="p^2/2", q=["x"])["column"] == 1


def test_what_stands_under_a_key_is_read_as_there():
    asked = {"kind": "hamilton-equations", "q": ["x"], "p": ["p"], "H": "p**2/2 + x**2/2"}
    assert plain(key="q_dot", text=["x' = p"], **asked) == ["p"]
    assert refused(key="q_dot", text=["p' = p"], **asked)["place"] == "q_dot[0]"
    assert plain(kind="lie-bracket", key="claim", x=["x", "y"], X=["y", "0"], Y=["0", "x"], text=["-x", "y"])


def test_chains_show_what_stands_between_their_sides():
    found = plain(
        kind="legendre-hamiltonian", key="H", q=["x"], p=["p"], L="x_dot**2/2", text="H = p x' - L = p^2/2"
    )
    assert found[0] == "p**2/2"


@pytest.mark.parametrize(
    ("asked", "place"),
    [
        ({"q": ["x"]}, "text"),
        ({"text": 3, "q": ["x"]}, "text"),
        ({"text": "x", "q": ["x"], "kind": 3}, "kind"),
        ({"text": "x", "q": ["x"], "kind": "no-such-kind"}, "kind"),
        ({"text": "x", "q": ["x"], "x": ["y"], "slow": ["s"]}, "kind"),
        ({"text": "x", "q": "x y z " * 9, "kind": "euler-lagrange", "key": "claim"}, "q"),
    ],
)
def test_a_question_that_makes_no_sense_is_told_where(asked, place):
    assert refused(**asked)["place"] == place
