"""Declared symbols: what the names of a claim stand for, and what else people call them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

from sympy import Symbol

from canon.cached_property import cached_property
from canon.exercise.sheet.key_shapes import ASSUMPTIONS
from canon.exercise.sheet.kind import Kind, Shape
from canon.expression.parse import Scope
from canon.expression.symbols.symbol import Coordinate, Momentum, acceleration, velocity
from canon.frozen_mapping import FrozenMapping

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

__all__ = ["NAME_KEYS", "DeclaredSymbols", "as_list"]

NAME_KEYS = (
    "q", "p", "x", "variables", "new_q", "new_p", "cyclic", "momenta",
    "multipliers", "quasi", "constants", "actions", "slow",
)  # fmt: skip
"""Keys that declare names."""
_MAKERS: Mapping[str, Callable[..., Symbol]] = FrozenMapping(
    {"q": Coordinate, "p": Momentum, "quasi": Coordinate, "new_p": Momentum, "momenta": Momentum}
)
_MOVING = ("q", "p", "x", "variables", "new_q", "new_p", "quasi")
"""Keys of names that stand for what changes in time."""
_OF_OMEGA = re.compile(r"w(?:_?[0-9])?")
_CARTESIAN = re.compile(r"[xyz](?:_?[0-9])?")


@dataclass(frozen=True)
class DeclaredSymbols:
    """The names that a claim declares.

    Parameters
    ----------
    keys
        The claim as written.
    kind
        Its kind.
    fault
        Refuses the claim for what stands under a key.
    """

    keys: Mapping[str, Any]
    kind: Kind
    fault: Callable[[str, str], NoReturn]

    @cached_property
    def time(self) -> Symbol:
        """The symbol of the time."""
        name = str(self.keys.get("t", "t"))
        if not (name.isidentifier() and name.isascii()):
            self.fault("t", "should be the name of the time")
        return Symbol(name, **self.assumptions(name))

    def scope(self, added: Mapping[str, Symbol]) -> Scope:
        """Return variables, parameters, functions, and other names of them, beside names that a judge adds."""
        keys, names = self.keys, self._variables()
        functions = {name: tuple(as_list(args)) for name, args in keys.get("functions", {}).items()}
        for name in keys.get("parameters", {}):
            if name not in functions and name != self.time.name and not _is_rate(name, names):
                names.setdefault(name, Symbol(name, **self.assumptions(name)))
        if self.is_names("quasi"):
            rates = {f"{u}_dot": velocity(names[u]) for u in as_list(keys["quasi"])}
            names = {**rates, **names}
        for name in functions:
            if name in names:
                self.fault("functions", f"{name} is declared as a symbol too")
        taken = {*added, *names, *functions, self.time.name, *self.kind.answer}
        other = {name: symbol for name, symbol in self._other_names(names) if name not in taken}
        signs = {name: self.assumptions(name) for name in functions}
        implicit = keys.get("implicit_multiplication") is True
        moving = frozenset(name for key in _MOVING if self.is_names(key) for name in as_list(keys[key]))
        return Scope(
            {**added, **names}, functions, self.time, signs, implicit, moving, FrozenMapping(other),
            independent=self.kind.independent or self.kind.two_sided, dependent=self._dependent(),
            timed=frozenset(as_list(keys["multipliers"]) if self.is_names("multipliers") else ()),
        )  # fmt: skip

    def _dependent(self) -> frozenset[str]:
        """Return the names that depend on others in a way that is not written; the energy is E unless it is named."""
        named = {key: as_list(self.keys[key]) for key in self.kind.dependent if key in self.keys}
        if "energy" in self.kind.dependent:
            named.setdefault("energy", ["E"])
        return frozenset(str(name) for names in named.values() for name in names)

    def is_names(self, key: str) -> bool:
        """Whether a list of names stands under a key."""
        return key in self.keys and self.kind.shapes.get(key) is Shape.NAMES

    def words(self, key: str) -> tuple[str, ...]:
        """Return a list of words as written."""
        return tuple(map(str, as_list(self.keys[key])))

    def assumptions(self, name: str) -> dict[str, bool]:
        """Return what is assumed of a name, for SymPy."""
        word = self.keys.get("parameters", {}).get(name, "real")
        if word not in ASSUMPTIONS:
            self.fault("parameters", f"{word} can't be assumed of {name}; write {', '.join(ASSUMPTIONS)}")
        return {"real": True} if word == "real" else {"real": True, word: True}

    def _variables(self) -> dict[str, Symbol]:
        """Return the symbols of the names that stand under keys of their own, each declared once."""
        names: dict[str, Symbol] = {}
        declared = ((key, name) for key in NAME_KEYS if self.is_names(key) for name in self.words(key))
        for key, name in declared:
            if name == self.time.name:
                self.fault(key, f"{name} is the name of the time; choose another, or say t = 'tau'")
            if key == "cyclic":
                continue
            if name in names:
                self.fault(key, f"{name} is declared twice")
            real = key not in self.kind.complex_names
            said = self.assumptions(name) if real else {"complex": True}
            names[name] = _MAKERS.get(key, Symbol)(name, **said)
        for name in names:
            if _is_rate(name, names):
                self.fault("q", f"{name} is the velocity of a coordinate that is declared too; rename one")
        return names

    def _other_names(self, names: Mapping[str, Symbol]) -> Iterator[tuple[str, Symbol]]:
        """Yield what else names are called: ``omega`` for w, ``p_theta`` for p, p for ``p_theta``, ``v_x`` for x'."""
        for name, symbol in names.items():
            if _OF_OMEGA.fullmatch(name):
                yield f"omega{name[1:]}", symbol
            moves = isinstance(symbol, Coordinate) and not self.is_names("p")  # there x' follows from p
            if moves and _CARTESIAN.fullmatch(name):  # v_theta would be r θ'
                first, second = velocity(symbol), acceleration(symbol)
                rates = ((f"v_{name}", first), (f"v_{name}_dot", second), (f"a_{name}", second))
                yield from (rate for rate in rates if rate[0][0] not in names)  # ax may be a x
        if not (self.is_names("q") and self.is_names("p")):
            return
        pairs = list(zip(self.words("q"), self.words("p"), strict=False))
        yield from ((f"p_{q}", names[p]) for q, p in pairs if p != f"p{q}")  # which is read as p_q already
        if len(pairs) == 1 and pairs[0][1].startswith("p"):
            yield "p", names[pairs[0][1]]


def _is_rate(name: str, names: Mapping[str, Symbol]) -> bool:
    """Whether a name is that of a declared coordinate's velocity or acceleration."""
    bases = (name.removesuffix(ending) for ending in ("_ddot", "_dot") if name.endswith(ending))
    return any(isinstance(names.get(base), Coordinate) for base in bases)


def as_list(value: Any) -> list[Any]:
    """Return a list as it is, and anything else as the one entry of one."""
    return value if isinstance(value, list) else [value]
