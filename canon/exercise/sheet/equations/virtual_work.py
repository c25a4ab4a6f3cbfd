"""Virtual work in place of generalized forces: ``δW = F δx + M δθ`` says Q_x = F and Q_θ = M."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.exercise.sheet.declared_symbols import as_list
from canon.expression.parse import LanguageError, parse_expression, statements_of
from canon.mechanics.hamilton.pfaffian_form import displacements

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.text.scope import Scope

__all__ = ["forces_of_work"]

_WORK = re.compile(r"(?:δ|delta_?)(?:W|A)(?:_\w{1,9})?")
"""``δW``, ``δA`` in German books."""


def forces_of_work(text: str, names: str | Sequence[str], scope: Scope) -> list[str]:
    """Return the factors of the virtual displacements in a virtual work, one for each coordinate; none of other texts.

    Parameters
    ----------
    text
        What was typed.
    names, scope
        The names of the coordinates, and all declared ones.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.parse import Scope
    >>> (x, theta), (F, l) = coordinates("x theta"), parameters("F l")
    >>> scope = Scope({s.name: s for s in (x, theta, F, l)})
    >>> forces_of_work("δW = F δx + F l cos θ δθ", ["x", "theta"], scope)
    ['F', 'F*l*cos(theta)']
    """
    q = [scope.names[name] for name in as_list(names) if name in scope.names]
    deltas = displacements(q)[1]
    beside = replace(scope, names={**scope.names, **{d.name: d for d in deltas}})
    try:
        statements = statements_of(text, scope)
        sides = statements[0].sides
        if len(statements) > 1 or len(sides) < 2 or not _WORK.fullmatch(sides[0].said):
            return []
        work = parse_expression(sides[-1].text, beside)
    except LanguageError:  # it is told where it is read
        return []
    forces = [work.diff(d) for d in deltas]
    linear = not any(force.has(*deltas) for force in forces)
    return [str(f) for f in forces] if linear and work.xreplace(dict.fromkeys(deltas, 0)) == 0 else []
