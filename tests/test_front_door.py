"""The front door: every public name is there, and ``import canon`` loads nothing heavy."""

import subprocess
import sys

import pytest

import canon


def test_every_public_name_resolves():
    for name in canon.__all__:
        assert getattr(canon, name) is not None


def test_the_typed_names_are_the_lazy_ones():
    """The imports for type checkers and the lazy table say the same."""
    import ast
    import pathlib

    tree = ast.parse(pathlib.Path(canon.__file__).read_text(encoding="utf-8"))
    block = next(n for n in tree.body if isinstance(n, ast.If))
    typed = {
        (node.module, alias.name)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    lazy = {(room, name) for room, names in canon._ROOMS.items() for name in names}
    assert typed == lazy


def test_an_unknown_name_is_an_attribute_error():
    assert not hasattr(canon, "poison_bracket")


def loaded_after(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(' '.join({{name.split('.')[0] for name in sys.modules}}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_import_canon_loads_no_room():
    assert not {"sympy", "numpy", "scipy", "heyoka", "llvmlite", "matplotlib", "flint"} & loaded_after(
        "import canon"
    )


def test_a_verdict_needs_no_integrator():
    loaded = loaded_after(
        "import canon\n"
        "(x,) = canon.coordinates('x')\n"
        "assert canon.vanishes(x - x).holds\n"
        "canon.Lagrangian(x.dot**2/2, (x,)).equations"
    )
    assert "sympy" in loaded
    assert not {"scipy", "heyoka", "llvmlite", "matplotlib"} & loaded


def test_a_mistyped_name_is_told_the_nearest():
    with pytest.raises(AttributeError, match="did you mean poisson_bracket"):
        assert canon.poison_bracket


def test_rooms_open_when_they_are_named():
    done = subprocess.run(
        [sys.executable, "-c", "import canon; print(canon.scene.find('kepler').name, canon.plot.COLOURS[0])"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout.split() == ["kepler", "#0072B2"]
