"""Start of a motion: states given in order or by name, and starts that constraints do not allow."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, Mapping, Set, ValuesView
from numbers import Integral, Number
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.input_in_words import described
from canon.expression.symbols.user_input import counted, listed
from canon.mechanics.algebra.dynamicsymbols import coordinate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Symbol

    from canon.array import Array
    from canon.flow.equations.first_order_motion import FirstOrderMotion

__all__ = ["check_constraints", "read_by_labels", "state_in_order"]

_NEAR = 1e-9
"""In parts of the size of its terms: what a constraint may miss at the start, being pulled back to 0."""


def read_by_labels(y0: Any) -> Any:
    """Return a pandas series or frame, or an xarray array, as numbers by its labels; other starts as they are.

    A frame has a column or a row a variable. Where the labels are 0, 1, … the numbers stand in order. A column of
    SymPy's is one state, as a list is.

    Raises
    ------
    TypeError
        It is text, one number, or has no order.
    ValueError
        The labels are other numbers, or there is no start.

    Examples
    --------
    >>> import pandas
    >>> read_by_labels(pandas.Series({"p_x": 0.0, "x": 1.0}))
    {'p_x': 0.0, 'x': 1.0}
    >>> read_by_labels(pandas.Series([1.0, 0.0]))
    array([1., 0.])
    """
    _check_is_state(y0)
    if np.ma.is_masked(y0):
        raise ValueError(f"numbers of the start are masked ({y0}): give them all")
    if getattr(y0, "is_Matrix", False) and y0.shape[1] == 1:
        return [y0[k] for k in range(y0.shape[0])]
    if isinstance(y0, Mapping):
        return y0  # pyright: ignore[reportUnknownVariableType]
    table = y0.to_pandas() if hasattr(y0, "dims") and hasattr(y0, "to_pandas") else y0
    if not (hasattr(table, "iloc") and hasattr(table, "index")):
        return y0
    for each in (table, table.T):
        named = dict(each.items())
        if not all(isinstance(label, Integral) for label in named):
            return named
    if list(table.index) != list(range(len(table))):
        raise ValueError(
            f"y0 has the labels {listed(list(map(str, table.index)))}, which are neither names of variables nor their "
            "order: give it names as labels, or its numbers alone, y0.to_numpy()"
        )
    return table.to_numpy()


def _check_is_state(y0: Any) -> None:
    """Refuse what numpy would take for a single thing, of shape ()."""
    if isinstance(y0, list | tuple | np.ndarray | Mapping):
        return
    wanted = "give a number for each variable in a list, in their order, or by name, {name: number}"
    if y0 is None:
        raise ValueError(f"no start y0 is given: {wanted}; only scenes have starts of their own")
    remedies: tuple[tuple[Any, str], ...] = (
        (str | bytes, "only scenes have starts that are called by a name"),
        (ItemsView, "leave .items() out, and give the dictionary itself"),
        (ValuesView, "give the dictionary itself"),
        (Set, "a set has no order"),
        (Iterator, "list(…) makes a list of it"),
        (Number, "a state of one variable is a list of one number"),
    )
    for kind, remedy in remedies:
        if isinstance(y0, kind):
            raise TypeError(f"y0 is {described(y0)}: {wanted}; {remedy}")


def state_in_order(y0: Any, state: Sequence[Symbol]) -> Any:
    """Return a starting state in the order of the variables: what is given by name is put in order.

    Parameters
    ----------
    y0
        Numbers in order, shape (variables,) or (variables, orbits), as they are; or a number, or an array of shape
        (orbits,), for each variable by symbol or name.
    state
        The variables.

    Raises
    ------
    KeyError
        A name is that of no variable, or a variable has no start.
    ValueError
        A variable is given twice, or the numbers are not as many as the variables.

    Examples
    --------
    >>> from canon import coordinates
    >>> theta = coordinates("theta")
    >>> state_in_order({"theta_dot": 0, theta: 0.1}, [theta, theta.dot])
    [0.1, 0]
    """
    names, y0 = [s.name for s in state], read_by_labels(y0)
    if isinstance(y0, Mapping):
        return _by_name(y0, names)
    given = np.asarray(y0)
    if given.ndim not in (1, 2) or given.shape[0] != len(names) or not given.size:
        raise ValueError(
            f"y0 has shape {given.shape}; the state is ({listed(names)}), {counted(len(names), 'number')}: give "
            f"them in this order, shape ({len(names)},), several states as ({len(names)}, orbits), or by name"
        )
    return y0


def _by_name(y0: Mapping[Any, Any], names: Sequence[str]) -> list[Any]:
    given = dict[str, Any]()
    for key, value in y0.items():
        name = key if isinstance(key, str) else coordinate(key).name
        if name not in names:
            raise KeyError(f"y0 names {name}, which is no variable of the state ({listed(names)})")
        if name in given:
            raise ValueError(f"y0 gives {name} twice; give it once")
        given[name] = value
    missing = [name for name in names if name not in given]
    if missing:
        raise KeyError(
            f"y0 has no value for {listed(missing)}: every variable needs a start, 0 where it rests"
        )
    orbits = {np.size(value) for value in given.values() if np.ndim(value)}
    if not orbits:
        return [given[name] for name in names]
    if len(orbits) > 1:
        raise ValueError(
            f"y0 has values for {' and '.join(map(str, sorted(orbits)))} orbits: give one number or as many each"
        )
    count = orbits.pop()
    return [list(given[name]) if np.ndim(given[name]) else [given[name]] * count for name in names]


def check_constraints(motion: FirstOrderMotion, start: Mapping[Symbol, Array]) -> None:
    """Refuse a start that is not on the constraints.

    Parameters
    ----------
    motion
        The equations, with what should vanish.
    start
        Numbers for the state, the time and the parameters, arrays of shape (orbits,) where orbits differ.

    Raises
    ------
    ValueError
        A constraint or its rate does not vanish; the sentence has the residual.
    """
    graph = motion.graph
    for residual, name in zip(motion.residuals, _words(motion), strict=True):
        slopes = graph.gradient(residual.node, motion.state)
        found = [np.asarray(x, dtype=np.float64) for x in graph.evaluate([residual.node, *slopes], start)]
        values = [np.asarray(start[s], dtype=np.float64) for s in motion.state]
        n = len(motion.q)
        own = slice(0, n) if residual.words == "position" else slice(n, None)
        largest = np.max([np.abs(x) * np.ones(1) for x in values[own]], axis=0)
        size = sum(
            np.abs(a) * (np.abs(x) + largest) for a, x in zip(found[1:][own], values[own], strict=True)
        )
        wrong = np.abs(found[0]) > _NEAR * size
        if np.any(wrong):
            values_there = np.ravel(found[0])
            worst = float(values_there[np.argmax(np.abs(values_there))])
            raise ValueError(
                f"the start is not on the constraints: {name} is {worst:.3g} there, not 0; choose the dependent "
                f"{'coordinates' if residual.words == 'position' else 'velocities'} so that it vanishes"
            )


def _words(motion: FirstOrderMotion) -> list[str]:
    """Return what to call what should vanish at the start."""
    counts: dict[tuple[str, bool], int] = {}
    said: list[str] = []
    for residual in motion.residuals:
        key = (residual.words, residual.left_out)
        counts[key] = counts.get(key, 0) + 1
        more = " that depends on others" if residual.left_out else ""
        said.append(
            {
                "position": f"holonomic constraint {counts[key]}{more}",
                "rate": f"the rate of constraint {counts[key]}{more}",
            }.get(residual.words, f"balance {counts[key]}{more}")
        )
    return said
