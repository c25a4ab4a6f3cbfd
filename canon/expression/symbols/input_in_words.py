"""Words for what users hand over: how many, and of which kind, without loading SymPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["counted", "described", "given_kind", "listed", "module_of", "of_sympy"]

Kind = TypeVar("Kind")

_SHOWN = 60
_NAMED = 12


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number of things in words: ``1 momentum``, ``2 momenta``.

    Parameters
    ----------
    number
        How many there are.
    one, many
        What one of them is called, and several; one with an s unless given.

    Examples
    --------
    >>> counted(1, "momentum", "momenta"), counted(0, "step")
    ('1 momentum', '0 steps')
    """
    return f"{number} {one if number == 1 else many or f'{one}s'}"


def listed(names: Iterable[object]) -> str:
    """Return names in a row, of very many the first ones and the last.

    Examples
    --------
    >>> listed("xyz"), listed(f"q{k}" for k in range(80))
    ('x, y, z', 'q0, q1, q2, q3, q4, q5, …, q79')
    """
    said = [str(name) for name in names]
    return ", ".join(said if len(said) <= _NAMED else (*said[: _NAMED // 2], "…", said[-1]))


def given_kind(x: Any, kinds: type[Kind] | tuple[type[Any], ...], name: str, instead: str = "") -> Any:
    """Return what was given if it is of one of these kinds.

    Parameters
    ----------
    x
        What was given.
    kinds
        What it may be.
    name
        What it is called where it was given.
    instead
        What to write instead.

    Raises
    ------
    TypeError
        Where it is something else.

    Examples
    --------
    >>> given_kind("fast", int, "jobs")
    Traceback (most recent call last):
        ...
    TypeError: jobs should be an int, not the text 'fast'
    """
    if isinstance(x, kinds):
        return x
    several = kinds if isinstance(kinds, tuple) else (kinds,)
    wanted = " or ".join(_with_article(kind.__name__) for kind in several)
    raise TypeError(f"{name} should be {wanted}, not {described(x)}{f'; {instead}' if instead else ''}")


def of_sympy(x: Any) -> bool:
    """Tell whether something is of a class of SymPy's, or of one derived from it.

    Examples
    --------
    >>> import sympy
    >>> of_sympy(sympy.Symbol("x")), of_sympy("x")
    (True, False)
    """
    return any(module_of(kind).partition(".")[0] == "sympy" for kind in type(x).__mro__)


def module_of(kind: type) -> str:
    """Return the name of the module of a class; SymPy's classes of applied functions, ``dynamicsymbols``, have none.

    Examples
    --------
    >>> import sympy
    >>> module_of(sympy.Symbol), module_of(type(sympy.Function("f")(1)))
    ('sympy.core.symbol', '')
    """
    return kind.__module__ or ""


def described(x: Any) -> str:
    """Return what was given, in words and not too long.

    Examples
    --------
    >>> described("fast"), described([1, 2])
    ("the text 'fast'", 'a list ([1, 2])')
    """
    if of_sympy(x):
        return _described_by_sympy(x)
    shown = _cut(repr(x))
    if isinstance(x, str):
        return f"the text {shown}"
    if isinstance(x, int | float) or x is None:
        return shown
    return f"{_with_article(type(x).__name__)} ({shown})"


def _described_by_sympy(x: Any) -> str:
    from sympy import Basic
    from sympy.logic.boolalg import Boolean

    if isinstance(x, Basic):
        return f"the condition {_cut(str(x))}" if isinstance(x, Boolean) else _cut(str(x))
    return f"{_with_article(type(x).__name__)} ({_cut(repr(x))})"


def _cut(shown: str) -> str:
    return shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}…"


def _with_article(word: str) -> str:
    return f"{'an' if word[0] in 'AEIOUaeiou' else 'a'} {word}"
