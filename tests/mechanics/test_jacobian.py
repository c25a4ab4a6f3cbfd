"""Maps composed many times: their trees are exponentially larger than their distinct parts."""

import pytest
import sympy as sp
from sympy import Rational, sin

from canon import CanonicalTransformation
from canon.mechanics.algebra.jacobian import is_large, jacobian
from canon.proof.vanish import vanishes

q, p = sp.symbols("q p", real=True)


def standard_map(times, off=sp.S.Zero):
    kick = CanonicalTransformation(q, p, q, p - sin(q))
    drift = CanonicalTransformation(q, p, q + p, p + off * q * p)
    whole = kick.then(drift)
    for _ in range(times - 1):
        whole = whole.then(kick).then(drift)
    return whole


def test_large_maps_are_canonical_or_not_in_a_moment():
    assert standard_map(12).is_canonical(budget=5.0).holds
    off = standard_map(8, Rational(1, 10**40))
    assert is_large(off.images)
    assert off.is_canonical(budget=5.0).fails


@pytest.mark.parametrize("z", [q, p])
def test_derivatives_on_the_graph_are_those_of_sympy(z):
    images = standard_map(6, Rational(1, 3)).images
    assert is_large(images)
    for row, f in zip(jacobian(images, [z]), images, strict=True):
        assert vanishes(row[0] - f.diff(z)).holds
