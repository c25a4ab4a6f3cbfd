"""Ignorable coordinates taken out: the rest moves as in the full model."""

from __future__ import annotations

import numpy as np
import pytest

from canon.scene import SceneError, find
from canon.scene.reduced import reduced
from canon.scene.scene_motion import run


@pytest.mark.parametrize(
    ("name", "start"),
    [
        ("spherical-pendulum", "precessing"),
        ("lagrange-top", "loops"),
        ("stormer", "bouncing"),
        ("routh-two-degree", "turning"),
        ("kovalevskaya-top", "slow"),
    ],
)
def test_the_rest_moves_as_in_the_full_model(name, start):
    full = find(name)
    rest = reduced(full, start)
    whole, part = run(full, start, 5.0, 50), run(rest, None, 5.0, 50)
    for i, s in enumerate(rest.q):
        j = full.q.index(s)
        size = np.abs(whole.q[j]).max()
        np.testing.assert_allclose(part.q[i] / size, whole.q[j] / size, atol=1e-11)
    other = rest.with_parameters(**{rest.parameters[-1].name: rest.parameters[-1].value * 1.1})
    assert not np.allclose(run(other, None, 5.0, 50).q, part.q, rtol=1e-6, atol=0.0)


def test_nothing_to_leave_out():
    with pytest.raises(SceneError, match="nothing can be left out"):
        reduced(find("double-pendulum"))
    with pytest.raises(SceneError, match="has constraints"):
        reduced(find("rolling-disc"))
