"""JUnit XML of a report, which every CI can show: a claim is a test case."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from canon.printable import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.exercise.report.judgement import Judged, Judgement

__all__ = ["junit"]


def junit(report: Judged) -> str:
    """Return a report as JUnit XML.

    A claim that FAILS is a failure, an invalid one an error, an undecided one is skipped. Where a claim says what
    its author expects, the test passes when the verdict is that, and fails when it is not. Warnings are its output.

    Examples
    --------
    >>> from canon.exercise.report.judgement import Judgement
    >>> from canon.exercise.report.report import Report
    >>> print(junit(Report("s", (Judgement("a", "equality-only", "fails", 0.5, feedback="sign"),))))
    <?xml version='1.0' encoding='utf-8'?>
    <testsuites tests="1" failures="1" errors="0" skipped="0" time="0.500">
      <testsuite name="s" tests="1" failures="1" errors="0" skipped="0" time="0.500">
        <testcase classname="s" name="a" time="0.500">
          <failure message="fails: sign" type="fails">sign</failure>
        </testcase>
      </testsuite>
    </testsuites>
    """
    root = Element("testsuites", _totals(report.judgements))
    for file, group in groupby(report.judgements, key=lambda judgement: judgement.file):
        judgements = list(group)
        name = _text(file or report.title or "claims")
        suite = SubElement(root, "testsuite", {"name": name, **_totals(judgements)})
        for judgement in judgements:
            seconds = f"{judgement.seconds:.3f}"
            case = SubElement(
                suite, "testcase", {"classname": name, "name": _text(judgement.id), "time": seconds}
            )
            _told(case, judgement)
            if judgement.warnings:
                SubElement(case, "system-out").text = _text("\n".join(judgement.warnings))
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True).decode("utf-8")


def _outcome(judgement: Judgement) -> str:
    """Return the element that tells the outcome, nothing for a test that passes."""
    if judgement.expect:
        return "" if judgement.as_expected else "failure"
    return {"fails": "failure", "invalid": "error", "undecided": "skipped"}.get(judgement.status, "")


def _told(case: Element, judgement: Judgement) -> None:
    outcome = _outcome(judgement)
    if not outcome:
        return
    reasons = judgement.reasons or [judgement.feedback or judgement.known]
    expected = f" (expected: {judgement.expect})" if not judgement.as_expected else ""
    message = _text(f"{judgement.status}{expected}: {reasons[0]}".rstrip(": "))
    told = SubElement(case, outcome, {"message": message})
    if outcome != "skipped":
        told.set("type", judgement.status)
    told.text = _text("\n".join(reasons))


def _totals(judgements: Sequence[Judgement]) -> dict[str, str]:
    outcomes = Counter(map(_outcome, judgements))
    seconds = sum(judgement.seconds for judgement in judgements)
    return {
        "tests": str(len(judgements)),
        "failures": str(outcomes["failure"]),
        "errors": str(outcomes["error"]),
        "skipped": str(outcomes["skipped"]),
        "time": f"{seconds:.3f}",
    }


def _text(text: str) -> str:
    """Return a text without the characters that XML can't hold."""
    return printable(text).replace("\ufffe", "�").replace("\uffff", "�")
