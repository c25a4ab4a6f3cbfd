"""Queries of results: the cases of a file in their order, and those among them that have what is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, overload

from canon.flow.method.method_text import method_of

if TYPE_CHECKING:
    from canon.study.cases.result import Result

__all__ = ["Results"]

OF_RESULTS = ("key", "motion", "setting", "state", "failure", "seconds", "done")

OF_CASES = ("start", "method", "step", "tolerance", "precision", "span", "samples")


@dataclass(frozen=True)
class Results(Sequence["Result"]):
    """Results of a study, in the order their cases were added.

    Parameters
    ----------
    rows
        The results.
    """

    rows: tuple[Result, ...]

    def __repr__(self) -> str:
        return f"<Results: {len(self.rows)} cases of {len(dict.fromkeys(r.motion for r in self.rows))} motions>"

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, index: int) -> Result: ...
    @overload
    def __getitem__(self, index: slice) -> Results: ...
    def __getitem__(self, index: int | slice) -> Result | Results:
        return Results(self.rows[index]) if isinstance(index, slice) else self.rows[index]

    def where(self, **wanted: Any) -> Results:
        """Return the results that have all that is asked for.

        Parameters
        ----------
        **wanted
            What is asked by name: ``system``, ``tag``, ``start``, ``method``, ``step``, ``tolerance``, ``precision``,
            ``span``, ``samples``, ``state`` (``"finished"``, ``"failed"``, ``"pending"``), a parameter, a number of the
            outcome such as ``verdict`` or ``bound``, ``seconds``, and what else a :class:`canon.study.Result` has. A
            value is asked for as it is, a list or set means any of its values, a function tells of a value whether it
            is wanted, and a class of methods all its methods. Cases that have no such value are left out.

        Raises
        ------
        ValueError
            Nothing is called so.

        Examples
        --------
        >>> import tempfile
        >>> from canon import Study, results_of, run_study
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     study = Study.of(system="henon-heiles", method=["verlet", "rk4"], step=[0.1, 0.2], span=100.0, tags="a")
        ...     _ = run_study(study, f"{folder}/study.sqlite")
        ...     results = results_of(f"{folder}/study.sqlite")
        >>> [result.setting for result in results.where(method="rk4", tag="a", step=lambda h: h < 0.15)]
        ['RK4, h = 0.1']
        >>> len(results.where(verdict="bounded")), len(results.where(step=[0.1, 0.3]))
        (2, 2)
        """
        for name in wanted:
            self._require(name)
        asked = {name: _asked(name, given) for name, given in wanted.items()}
        return Results(
            tuple(
                row
                for row in self.rows
                if all(any(_has(each, want) for each in _values(row, name)) for name, want in asked.items())
            )
        )

    def _require(self, name: str) -> None:
        """Raise ValueError where no result can have a value of that name."""
        fixed = ("system", "tag", *OF_CASES, *OF_RESULTS)
        if name in fixed or any(name in row.numbers or name in row.case.values for row in self.rows):
            return
        known = dict.fromkeys((*fixed, *(each for row in self.rows for each in (*row.numbers, *row.case.values))))
        close = get_close_matches(name, known, 1)
        meant = f"; did you mean {close[0]!r}?" if close else f"; there are {', '.join(known)}"
        raise ValueError(f"no result has anything called {name!r}{meant}")


def _asked(name: str, given: Any) -> tuple[Any, ...]:
    """Return what is asked for as alternatives."""
    each = tuple(given) if isinstance(given, list | set | frozenset) else (given,)
    if name == "method":
        return tuple(method_of(one) if isinstance(one, str) else one for one in each)
    if name == "system":
        return tuple(getattr(one, "name", one) for one in each)
    return each


def _values(row: Result, name: str) -> tuple[Any, ...]:
    """Return what a result has of a name: nothing, one value, or its tags."""
    case = row.case
    if name == "tag":
        return case.tags
    if name == "system":
        return (case.system_name,)
    if name == "state":
        return (row.state.value,)
    if name in OF_CASES or name in OF_RESULTS:
        value = getattr(case if name in OF_CASES else row, name)
    else:
        value = row.numbers.get(name, case.values.get(name))
    return () if value is None else (value,)


def _has(value: Any, wanted: tuple[Any, ...]) -> bool:
    return any(_is(value, each) for each in wanted)


def _is(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, type):
        return isinstance(value, wanted)
    if callable(wanted) and not isinstance(value, type(wanted)):
        return bool(wanted(value))
    return bool(value == getattr(wanted, "value", wanted))
