"""What a left side of an answer names: what is asked for, something else, or nothing that the question knows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.left_sides import (
    OTHER_SPELLINGS,
    Quantity,
    has_primes,
    is_asked,
    is_of_another,
    label_of,
)
from canon.exercise.sheet.quantities.known_vectors import with_angular_momenta
from canon.expression.text.declared_names import key_of

if TYPE_CHECKING:
    from canon.exercise.sheet.equations.sides import Sides
    from canon.exercise.sheet.kind import Kind
    from canon.expression.text.statement import Side

__all__ = ["NamesAsked"]


@dataclass(frozen=True)
class NamesAsked:
    """The names of what one claim asks for.

    Parameters
    ----------
    kind
        Its kind.
    sides
        What is known of the sides of equations in it.
    """

    kind: Kind
    sides: Sides

    def refuse_other_names(self, place: str, text: str, side: Side, asked: Quantity) -> None:
        """Refuse a left side that is the name of something else."""
        label = label_of(side.said)
        given = self.sides.given(place)
        if self._is_slope_asked(place, side):
            return
        if place.startswith("values.") and asked.shown in re.findall(r"[^\W\d_]+(?:_\w+)?", side.said):
            raise self.contradiction(place, text, side, asked)
        if is_of_another(side.said) and self.sides.is_origin(place, side, asked.shown):
            if given.worked_out(side.said) is None:
                raise self.contradiction(place, text, side, asked)
            return
        if label is None or place in ("lhs", "rhs"):
            return
        worked_out = asked.shown == "I" and given.put_in(side.text) is not None
        if not worked_out and (label.name or asked.bracket):
            raise self.contradiction(place, text, side, asked)

    def _is_slope_asked(self, place: str, side: Side) -> bool:
        """Tell whether a side is ``∂W/∂q`` for that component of a gradient."""
        found = re.fullmatch(r"∂[WSF]_?\w{0,2}/∂(\S{1,20})", side.said)
        index = re.fullmatch(r"gradient\[(\d+)\]", place)
        q: Any = self.sides.keys.get("q", [])
        q = q if isinstance(q, list) else [q]
        return bool(found and index and key_of(q[int(index[1])]) == key_of(found[1]))

    def contradiction(self, place: str, text: str, side: Side, asked: Quantity) -> Exception:
        """Return the error of a left side that is not what is asked."""
        shown = side.text.strip().strip("$").strip()[:40]
        remedy = f"write {asked.shown} = … if that is meant, or only what stands on the right"
        return self.sides.told(
            place, text, side, f"{asked.shown} is asked for here, and this says {shown} = …", remedy
        )

    def is_asked(self, side: Side, asked: Quantity) -> bool:
        """Tell whether a side is a name of what is asked; of a constant of the motion, any name that is free."""
        label = label_of(side.said)
        if asked.shown == "K" and "angles" in self.kind.shapes and re.fullmatch("⟨H⟩|<H>", side.said):
            return True  # the mean of H, which the averaged Hamiltonian is
        if asked.shown == "I" and label is not None and label.name and not label.rates:
            given = self.sides.scope.declares(label.name) or isinstance(self.sides.keys.get(label.name), str)
            asked = asked if given else Quantity("I", ((label.name, 0),))
        if asked.shown == "I" and label is None and self._is_of_free_name(side):
            return True
        rate = label is not None and label.rates > 0 and not has_primes(side.text)
        if rate and asked.shown in OTHER_SPELLINGS:
            return False  # dH/dt and Ḣ are no names of what H' is a name of
        if asked.bracket and label is not None and not label.name:
            known = with_angular_momenta(self.sides.keys, self.sides.scope)
            return any(is_asked(label, asked, scope) for scope in (self.sides.scope, known))
        return is_asked(label, asked, self.sides.scope)

    def _is_of_free_name(self, side: Side) -> bool:
        """Tell whether a side is a multiple or power of one free name, ``2T`` or ``L²``, constant as that is."""
        found = re.fullmatch(
            r"(?:\d{1,3}\*?)?(?P<name>[^\W\d]\w{0,9})(?:\^?\{?[2-9]\}?|[²³⁴]|\*\*[2-9])?", side.said
        )
        label = label_of(found["name"]) if found else None
        if label is None or not label.name or label.rates or self.sides.can_read(side):
            return False
        vector = re.search(r"\\(?:vec|mathbf|boldsymbol|bm)", side.text) is not None
        given = isinstance(self.sides.keys.get(label.name), str) and not vector
        return not (given or self.sides.scope.declares(label.name))

    def refuse_lagrangian(self, place: str, text: str, side: Side) -> None:
        """Refuse ``L = …`` as a constant of the motion where L is the Lagrangian of the claim."""
        said = re.fullmatch(r"\|?L\|?(?:\^?\{?2\}?|\*\*2|²)?", side.said)
        free = side.said != "L" and self._is_of_free_name(side)
        if place == "I" and said and not free and isinstance(self.sides.keys.get("L"), str):
            reason = "is L the Lagrangian here, or a name of the constant?"
            raise self.sides.told(
                place, text, side, reason, "write L_z = …, or only what stands on the right"
            )

    def is_constant(self, place: str, side: Side) -> bool:
        """Tell whether a side only says that the others are constant."""
        of_motion = place == "I" or place.startswith("conserved")
        return (
            of_motion
            and not self.sides.scope.declares("const")
            and field_texts.says_constant(side.text, self.sides.scope)
        )
