r"""A constant of the motion that is told by its rate: ``d/dt (m r² φ̇) = 0`` says that m r² φ̇ is kept."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.notation import closing_of, is_latex
from canon.expression.text.statement import Side

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.text.scope import Scope

__all__ = ["without_rate"]

_D = r"(?:\\(?:mathrm|text|rm)\s*\{?\s*)?d\s*\}?\s*"
_BEFORE = re.compile(
    rf"[\s$]*(?:\\[dt]?frac\s*\{{\s*{_D}\}}\s*\{{\s*{_D}t\s*\}}|{_D}/\s*(?:{_D}t|\(\s*{_D}t\s*\)))\s*"
)
_AROUND = re.compile(
    rf"[\s$]*(?:\\[dt]?frac\s*\{{\s*{_D}(?P<above>[(\[].*[)\]])\s*\}}\s*\{{\s*{_D}t\s*\}}"
    rf"|{_D}(?P<slashed>[(\[].*[)\]])\s*/\s*(?:{_D}t|\(\s*{_D}t\s*\)))[\s$.,;]*"
)
_SIZES = re.compile(r"\\(?:left|right|[bB]igg?[lr]?)(?![A-Za-z])")
_OPENING = ("(", "[")


def without_rate(sides: Sequence[Side], scope: Scope) -> Sequence[Side]:
    r"""Return what is kept where an equation says that its rate is zero, else the sides as they are.

    Parameters
    ----------
    sides
        The sides of one equation.
    scope
        The declared names: where d is one of them, or the time is not t, nothing is taken for a rate.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> [side.text for side in without_rate([Side("d/dt (r² φ')"), Side("               0", "0")], Scope())]
    ["      r² φ' "]
    >>> [side.text for side in without_rate([Side("d/dt (r²) φ'"), Side("               0", "0")], Scope())]
    ["d/dt (r²) φ'", '               0']
    """
    if len(sides) != 2 or "0" not in (sides[0].said, sides[1].said):
        return sides
    if scope.declares("d") or scope.time.name != "t":
        return sides
    text = sides[sides[0].said == "0"].text
    bare = _SIZES.sub(lambda found: " " * len(found.group()), text)
    if around := _AROUND.fullmatch(bare):
        begin, end = around.span("above" if around["above"] else "slashed")
    elif before := _BEFORE.match(bare):
        begin, end = before.end(), len(bare.rstrip(" $.,;"))
    else:
        return sides
    if bare[begin : begin + 1] not in _OPENING or closing_of(bare, begin) != end - 1:
        return sides
    kept = f"{' ' * (begin + 1)}{bare[begin + 1 : end - 1]}{' ' * (len(bare) - end + 1)}"
    return [Side(f"${kept[1:]}" if is_latex(text) else kept)]
