"""Methods for H = Σ (p − A)²/2m + φ, charges and rotating frames: Boris's push, and a symplectic splitting."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from canon.flow.method.composition import check_order, weights_of_order
from canon.flow.method.engine import FIXED_STEPS

__all__ = ["Boris", "MagneticSplitting"]


@dataclass(frozen=True)
class Boris:
    """Boris's push for a charged particle: explicit, symmetric, keeps phase volume; not symplectic.

    Parameters
    ----------
    order
        2, or 4, 6 or 8 by symmetric compositions.

    Raises
    ------
    ValueError
        No such order.

    Notes
    -----
    For H = Σ (p − A(q, t))²/2m + φ(q, t), the charge being part of A and φ, which is found in H whatever its gauge; A
    and φ may be any functions; and for c √(m²c² + (p − A)²) + φ of a relativistic charge. Steps keep volume, and in a
    magnetic field without E the kinetic energy; not the form dq ∧ dp. Energy errors mostly stay small for long and may
    wander where fields are strongly curved (E. Hairer, Ch. Lubich, BIT 58 (2018) 969–979,
    doi:10.1007/s10543-018-0713-1). Bodies in a rotating frame have the first form too, A = m Ω × r.

    Examples
    --------
    A charge in a uniform field, E along x, B along z, drifts by −E/B along y:

    >>> from canon import Hamiltonian, coordinates, propagate
    >>> x, y = coordinates("x y")
    >>> H = Hamiltonian(x.momentum**2 / 2 + (y.momentum - x)**2 / 2 - x / 10, [x, y], [x.momentum, y.momentum])
    >>> motion = propagate(H, (0, 1000), [0, 0, 0, 0], method=Boris(), step=0.1)
    >>> round(float(motion["y"][-1] / 1000), 3), bool(abs(motion.energy_error).max() < 1e-13)
    (-0.1, True)
    """

    order: int = 2
    engine, family, is_symplectic, solvable = FIXED_STEPS, "boris", False, None
    tolerance = None
    citation = (
        "J. P. Boris, Relativistic plasma simulation – optimization of a hybrid code, Proc. 4th Conf. Numer. Simul. "
        "Plasmas (1970) 3–67; H. Qin et al., Why is Boris algorithm so good?, Phys. Plasmas 20 (2013) 084503, "
        "doi:10.1063/1.4818428"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "Boris")

    def __str__(self) -> str:
        return f"boris-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"boris": self.order}

    @property
    def stages(self) -> int:
        """Evaluations of the fields in a step."""
        return len(weights_of_order(self.order))


@dataclass(frozen=True)
class MagneticSplitting:
    """Wu, Forest and Robin's splitting for a charged particle: explicit and symplectic, by shifts of the gauge.

    Parameters
    ----------
    order
        2, or 4, 6 or 8 by symmetric compositions.

    Raises
    ------
    ValueError
        No such order.

    Notes
    -----
    For H = Σ (p − A(q))²/2m + φ(q) where each ∫ Aᵢ dqᵢ is known in closed form, as of every polynomial A. The flow of
    each (pᵢ − Aᵢ)²/2m is exact, and so is that of φ. The motion does not depend on the gauge of A, the error of a step
    does: A with few components takes the fewest.

    Examples
    --------
    >>> from canon import Hamiltonian, coordinates, propagate
    >>> x, y = coordinates("x y")
    >>> bowl = (x**2 + y**2)**2 / 4
    >>> H = Hamiltonian(x.momentum**2 / 2 + (y.momentum - x - x**2)**2 / 2 + bowl, [x, y], [x.momentum, y.momentum])
    >>> motion = propagate(H, (0, 1000), [1, 0, 0, 1], method=MagneticSplitting(4), step=0.1)
    >>> bool(abs(motion.energy_error).max() < 1e-3)
    True
    """

    order: int = 4
    engine, family, is_symplectic, solvable = FIXED_STEPS, "magnetic", True, None
    tolerance = None
    citation = (
        "Y. K. Wu, E. Forest, D. S. Robin, Explicit symplectic integrator for s-dependent static magnetic field, "
        "Phys. Rev. E 68 (2003) 046502, doi:10.1103/PhysRevE.68.046502"
    )

    def __post_init__(self) -> None:
        check_order(self.order, "MagneticSplitting")

    def __str__(self) -> str:
        return f"magnetic-{self.order}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"magnetic": self.order}

    @property
    def stages(self) -> int:
        """Steps of order 2 in a step."""
        return len(weights_of_order(self.order))
