"""Steps of an evaluation written as one Python function: the same operations in the same order, sooner done.

The text holds numbered names and signs only: nothing a user wrote reaches Python's compiler.
"""

from __future__ import annotations

import operator
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import TypeAlias

    from sympy import Symbol

    Step: TypeAlias = tuple[Callable[..., Any] | None, tuple[int, ...], Any]
    """A function, the places of its operands among what was done before, and the value of a constant or a symbol."""

__all__ = ["function_of_text", "squared", "value_of", "written_steps"]

_AT_ONCE = 40
"""So many terms stand in one line: Python's compiler nests them."""


def value_of(values: Mapping[Symbol, Any], symbol: Symbol) -> Any:
    """Return the value of a symbol.

    Raises
    ------
    KeyError
        There is none.
    """
    if symbol not in values:
        raise KeyError(f"no value given for the symbol {symbol}; give it one")
    return values[symbol]


def squared(x: Any) -> Any:
    """Return x·x, rounded once; a power need not be."""
    return x * x


def written_steps(
    steps: Sequence[Step], places: Sequence[int]
) -> Callable[[Mapping[Symbol, Any]], list[Any]]:
    """Return a function of the symbols' values that does steps and returns what was found at some of them.

    Parameters
    ----------
    steps
        What is done, in order; :func:`value_of` reads a symbol, and no function is a constant.
    places
        The steps whose values are wanted.

    Examples
    --------
    >>> from sympy import Symbol
    >>> x = Symbol("x")
    >>> f = written_steps([(value_of, (), x), (None, (), 3.0), (operator.mul, (0, 1, 0), None)], [2])
    >>> f({x: 2.0})
    [12.0]
    """
    symbols = [value for function, _, value in steps if function is value_of]
    known: dict[str, Any] = {"missing": lambda values: [value_of(values, each) for each in symbols]}
    read = [f"  v{k} = values[s{k}]" for k, step in enumerate(steps) if step[0] is value_of]
    lines = ["def f(values):", " try:", *read, "  pass", " except KeyError:", "  return missing(values)"]
    for k, (function, operands, value) in enumerate(steps):
        if function is None:
            known[f"v{k}"] = value
        elif function is value_of:
            known[f"s{k}"] = value
        elif function in _SIGNS:
            lines += _chain(f"v{k}", [f"v{o}" for o in operands], _SIGNS[function])
        elif function is squared:
            lines.append(f" v{k} = v{operands[0]}*v{operands[0]}")
        else:
            known[f"f{k}"] = function
            lines.append(f" v{k} = f{k}({','.join(f'v{o}' for o in operands)})")
    lines.append(f" return [{','.join(f'v{place}' for place in places)}]")
    return function_of_text("\n".join(lines), known)


def function_of_text(text: str, names: dict[str, Any]) -> FunctionType:
    r"""Return the function that a text defines, of numbered names and those given: nothing a user wrote is in it.

    Examples
    --------
    >>> function_of_text("def f(x):\n return n0*x", {"n0": 3.0})(2.0)
    6.0
    """
    module = compile(text, "<expression graph>", "exec")
    code = next(constant for constant in module.co_consts if isinstance(constant, CodeType))
    return FunctionType(code, names)


_SIGNS: dict[Callable[..., Any], str] = {operator.add: "+", operator.mul: "*"}


def _chain(name: str, operands: Sequence[str], sign: str) -> list[str]:
    """Return lines that add or multiply from the left."""
    parts = [operands[k : k + _AT_ONCE] for k in range(0, len(operands), _AT_ONCE)]
    return [f" {name} = {sign.join(part if not k else [name, *part])}" for k, part in enumerate(parts)]
