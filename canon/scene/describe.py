"""Description of a scene, line by line: Lagrangian, equations, Hamiltonian, Routhian, integrals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.expression.symbols.user_input import counted
from canon.scene.parts import multiplier

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr

    from canon.scene.scene import Scene

__all__ = ["Section", "ShownFormula", "description"]


@dataclass(frozen=True)
class ShownFormula:
    """A formula, left = right.

    Parameters
    ----------
    left
        What is defined, or None where the right side is set equal to 0.
    right
        The expression.
    about
        What it is, in words.
    """

    left: Expr | str | None
    right: Expr
    about: str = ""

    def __str__(self) -> str:
        text = f"{self.right} = 0" if self.left is None else f"{self.left} = {self.right}"
        return f"{self.about}: {text}" if self.about else text

    @property
    def latex(self) -> str:
        """The formula in LaTeX, without dollars."""
        import sympy as sp

        right = sp.latex(self.right)
        if self.left is None:
            return f"{right} = 0"
        left = self.left if isinstance(self.left, str) else sp.latex(self.left)
        return f"{left} = {right}"


@dataclass(frozen=True)
class Section:
    """Formulas under a heading, and a remark on them."""

    title: str
    formulas: tuple[ShownFormula, ...]
    remark: str = ""


def description(scene: Scene) -> Iterator[Section]:
    """Yield what a scene says of itself, each section derived when it is asked for.

    Examples
    --------
    >>> from canon.scene import find
    >>> for section in description(find("simple-pendulum")):
    ...     print(section.title, *section.formulas[:1], section.remark, sep=" | ")
    Lagrangian | L = g*l*m*cos(theta) + l**2*m*theta_dot**2/2 |
    Lagrange's equations | g*l*m*sin(theta) + l**2*m*theta_ddot = 0 |
    Hamiltonian | H = -g*l*m*cos(theta) + p_theta**2/(2*l**2*m) |
    Routhian | no coordinate is ignorable, so R = L
    """
    if scene.has_lagrangian:
        lagrangian = scene.lagrangian
        yield Section("Lagrangian", (ShownFormula("L", lagrangian.L),))
        if lagrangian.forces:
            pairs = zip(scene.q, lagrangian.forces, strict=True)
            yield Section(
                "Forces without potential", tuple(ShownFormula(f"Q_{s}", Q) for s, Q in pairs if Q != 0)
            )
        yield from _equations(scene)
    if scene.is_free:
        hamiltonian = scene.hamiltonian
        yield Section("Hamiltonian", (ShownFormula("H", hamiltonian.H),))
        if not scene.has_lagrangian:
            variables = (*hamiltonian.q, *hamiltonian.p)
            rates = zip(variables, hamiltonian.vector_field, strict=True)
            yield Section("Hamilton's equations", tuple(ShownFormula(f"d{x}/dt", rate) for x, rate in rates))
        yield from _routhian(scene)
    found = scene.constants().items()
    if found:
        yield Section(
            "Constants of the motion besides the energy",
            tuple(ShownFormula(f"I{i}", f, name) for i, (name, f) in enumerate(found, 1)),
        )


def _equations(scene: Scene) -> Iterator[Section]:
    if not scene.is_constrained:
        equations = scene.lagrangian.equations
        yield Section("Lagrange's equations", tuple(ShownFormula(None, e) for e in equations))
        return
    bound = scene.constrained
    constraints = (*bound.holonomic, *bound.nonholonomic)
    yield Section("Constraints", tuple(ShownFormula(None, f) for f in constraints))
    multipliers = [multiplier(i) for i in range(1, len(constraints) + 1)]
    with_reactions = bound.equations(multipliers)[: len(scene.q)]
    yield Section(
        "Lagrange's equations with multipliers",
        tuple(ShownFormula(None, e) for e in with_reactions),
        f"{counted(len(scene.q), 'coordinate')}, {counted(len(constraints), 'constraint')} on the velocities",
    )


def _routhian(scene: Scene) -> Iterator[Section]:
    if not scene.has_lagrangian and all(scene.hamiltonian.H.has(s) for s in scene.q):
        yield Section("Routhian", (), "no coordinate is ignorable, so R = L")
        return
    from canon.mechanics.reduction.routh import routhian

    found = routhian(scene.lagrangian)
    yield Section("Routhian", (ShownFormula("R", found.R),) if found.ignorable else (), found.note)
