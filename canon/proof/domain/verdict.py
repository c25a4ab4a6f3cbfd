"""Verdicts: holds, fails with a counterexample, or undecided."""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from canon.display import preformatted

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import sympy as sp

__all__ = ["Counterexample", "Evidence", "Status", "Undecided", "Verdict", "all_hold"]


class Status(enum.Enum):
    """Status of a verdict: proved, refuted, or neither."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDECIDED = "undecided"

    def __str__(self) -> str:
        return self.value


class Undecided(Exception):
    """Raised when a verdict that was not decided is used as a truth value."""


@dataclass(frozen=True)
class Counterexample:
    """A point of the domain where the two sides certainly differ.

    Parameters
    ----------
    point
        Exact value of each symbol, as text by name.
    left, right
        The two sides there, as decimal text; ``right`` is ``"0"`` where one expression should vanish.
    digits
        Digits of ``left`` and ``right`` that are certain.
    """

    point: Mapping[str, str]
    left: str
    right: str
    digits: int

    def __str__(self) -> str:
        where = ", ".join(f"{name} = {value}" for name, value in self.point.items()) or "every point"
        return f"at {where}: {self.left} against {self.right}"


@dataclass(frozen=True)
class Evidence:
    """Something that speaks for or against a claim without deciding it."""

    kind: str
    text: str


@dataclass(frozen=True)
class Verdict:
    """Verdict on a claim: the answer, how it was reached, and what it rests on.

    ``bool(verdict)`` is True only for HOLDS, False for FAILS, and raises :class:`Undecided` otherwise: an
    unproved thing is never taken for a proved one.

    Parameters
    ----------
    status
        HOLDS is only said of what was proved, FAILS only of what was certainly refuted.
    question
        What was asked, in words.
    certificate
        How it was decided: ``exact``, ``ball``, ``structure`` …; empty while undecided.
    residual
        What should have vanished and did not, or the part that was left undecided.
    counterexample
        A point where the claim is certainly wrong, for FAILS.
    assumed
        What the proof had to take for granted, such as a nonzero denominator.
    evidence
        What is known besides.
    seconds
        Time spent.
    feedback
        One sentence for a person.
    """

    status: Status
    question: str = ""
    certificate: str = ""
    residual: sp.Basic | sp.MatrixBase | None = None
    counterexample: Counterexample | None = None
    assumed: tuple[str, ...] = ()
    evidence: tuple[Evidence, ...] = ()
    seconds: float = 0.0
    feedback: str = ""

    def __bool__(self) -> bool:
        if self.status is Status.UNDECIDED:
            raise Undecided(
                f"{self.question or 'the question'} was not decided, so it is neither true nor false; "
                "look at verdict.evidence, give a larger budget, or narrow the domain"
            )
        return self.status is Status.HOLDS

    @property
    def holds(self) -> bool:
        """Whether the claim was proved."""
        return self.status is Status.HOLDS

    @property
    def fails(self) -> bool:
        """Whether the claim was certainly refuted."""
        return self.status is Status.FAILS

    @property
    def undecided(self) -> bool:
        """Whether the claim was neither proved nor refuted."""
        return self.status is Status.UNDECIDED

    def about(self, question: str) -> Verdict:
        """Return the same verdict as the answer to ``question``."""
        return replace(self, question=question)

    def witness(self, *evidence: Evidence) -> Verdict:
        """Return the same verdict with this evidence added; the status never changes.

        Examples
        --------
        >>> seen = Evidence("drift of an integral", "kept to 2e-15 over t = 0 … 20")
        >>> print(Verdict(Status.UNDECIDED, "energy is conserved").witness(seen))
        UNDECIDED  energy is conserved
          drift of an integral: kept to 2e-15 over t = 0 … 20
        """
        return replace(self, evidence=(*self.evidence, *evidence))

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold of this verdict."""
        from canon.expression.symbols.magnitude import written

        example = self.counterexample
        return {
            "status": self.status.value,
            "question": self.question,
            "certificate": self.certificate,
            "residual": None if self.residual is None else written(self.residual),
            "counterexample": None
            if example is None
            else {"point": dict(example.point), "left": example.left, "right": example.right},
            "assumed": list(self.assumed),
            "evidence": [{"kind": e.kind, "text": e.text} for e in self.evidence],
            "seconds": round(self.seconds, 6),
            "feedback": self.feedback,
        }

    def __repr__(self) -> str:
        return f"<{self.status.name}: {_cut(self.question)}>" if self.question else f"<{self.status.name}>"

    def __str__(self) -> str:
        lines = [f"{self.status.name}  {self.question}".rstrip()]
        if self.certificate:
            lines.append(f"  decided by: {self.certificate}")
        if self.counterexample is not None:
            lines.append(f"  {self.counterexample}")
        elif self.residual is not None:
            lines.append(f"  left over: {_short(self.residual)}")
        lines.extend(f"  assumed: {proviso}" for proviso in self.assumed)
        lines.extend(f"  {e.kind}: {e.text}" for e in self.evidence)
        if self.feedback:
            lines.append(f"  {self.feedback}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        word = self.status.name
        return preformatted(str(self).removeprefix(word), lead=word, colour=_COLOURS[self.status])


_COLOURS = {Status.HOLDS: "#1a7f4b", Status.FAILS: "#b3261e", Status.UNDECIDED: "#8a6100"}


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"


LONGEST_SHOWN = 80
"""Characters of the question that a verdict's ``repr`` shows."""

LONGEST_PRINTED = 60
"""Operations of a residual that are still printed; it is kept whole in ``residual``."""


def _short(residual: sp.Basic | sp.MatrixBase) -> str:
    from sympy import MatrixBase, count_ops, preorder_traversal

    from canon.expression.symbols.magnitude import has_huge_number, written

    entries: list[sp.Basic] = list(residual.flat()) if isinstance(residual, MatrixBase) else [residual]
    if any(
        map(has_huge_number, entries)
    ):  # whose sign SymPy's count would ask for, by a value that may not exist
        nodes = [node for entry in entries for node in preorder_traversal(entry) if node.args]
        operations = sum(max(len(node.args) - 1, 1) for node in nodes)
    else:
        operations = int(count_ops(residual))
    if operations <= LONGEST_PRINTED:
        return written(residual)
    return f"an expression of {operations} operations (in .residual)"


def all_hold(verdicts: Iterable[Verdict], question: str = "") -> Verdict:
    """Return one verdict on a claim that holds where all the verdicts given do.

    FAILS as soon as one fails (later ones are not asked for when ``verdicts`` is lazy); otherwise
    UNDECIDED if one is; HOLDS only if every one holds. What any of them assumed is kept.

    Examples
    --------
    >>> all_hold([Verdict(Status.HOLDS), Verdict(Status.FAILS, certificate="ball")]).status
    <Status.FAILS: 'fails'>
    """
    assumed: dict[str, None] = {}
    evidence: list[Evidence] = []
    seconds = 0.0
    open_: Verdict | None = None
    certificates: dict[str, None] = {}
    for verdict in verdicts:
        seconds += verdict.seconds
        if verdict.fails:
            return replace(verdict, question=question or verdict.question, seconds=seconds)
        assumed.update(dict.fromkeys(verdict.assumed))
        evidence.extend(verdict.evidence)
        if verdict.undecided:
            open_ = verdict if open_ is None else open_
        elif verdict.certificate:
            certificates[verdict.certificate] = None
    status, certificate = Status.HOLDS, " + ".join(certificates) or "exact"
    rest = Verdict(status, question, certificate, None, None, tuple(assumed), tuple(evidence), seconds)
    if open_ is None:
        return rest
    return replace(
        open_,
        question=question or open_.question,
        assumed=rest.assumed,
        evidence=rest.evidence,
        seconds=seconds,
    )
