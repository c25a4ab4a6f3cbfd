"""Is this expression zero on this domain?"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from canon.proof.domain.domain import Domain as Domain
    from canon.proof.domain.verdict import Counterexample as Counterexample
    from canon.proof.domain.verdict import Evidence as Evidence
    from canon.proof.domain.verdict import Status as Status
    from canon.proof.domain.verdict import Undecided as Undecided
    from canon.proof.domain.verdict import Verdict as Verdict
    from canon.proof.domain.verdict import all_hold as all_hold
    from canon.proof.equivalent_equations import equivalent_equations as equivalent_equations
    from canon.proof.vanish import equal as equal
    from canon.proof.vanish import vanishes as vanishes

_HOMES = {
    "Counterexample": "verdict",
    "Domain": "domain",
    "Evidence": "verdict",
    "Status": "verdict",
    "Undecided": "verdict",
    "Verdict": "verdict",
    "all_hold": "verdict",
    "equal": "vanish",
    "equivalent_equations": "equations",
    "vanishes": "vanish",
}

__all__ = [
    "Counterexample",
    "Domain",
    "Evidence",
    "Status",
    "Undecided",
    "Verdict",
    "all_hold",
    "equal",
    "equivalent_equations",
    "vanishes",
]


def __getattr__(name: str) -> Any:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"canon.proof has no {name!r}; it has {', '.join(_HOMES)}")
    return getattr(import_module(f"canon.proof.{home}"), name)
