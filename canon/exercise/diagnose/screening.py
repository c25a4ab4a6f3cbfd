"""Whether a claim with another answer could be right, as far as values and slopes at two points tell.

For the kinds whose claims are judged as a whole: the answer is differentiated there, so that a candidate would
have to be differentiated, and its residual refuted, before it is dropped. Here each costs some evaluations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb

from canon.exercise.diagnose import screen_tests as tests
from canon.exercise.diagnose.point_derivatives import BITS, Examples, Neighbourhood
from canon.exercise.judges.canonical import map_values
from canon.exercise.judges.conserved import motion_of
from canon.exercise.question.constraint_manifold import EmptyDomainError
from canon.exercise.sheet.reading import InvalidClaim
from canon.expression.symbols.symbol import velocity
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.diagnose.screen_tests import Test
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["Screening", "screening"]

POINTS = 2


@dataclass(frozen=True)
class Screening:
    """The places at which candidates are looked at, and how."""

    answers: Mapping[str, Expr]
    test: Test
    places: Sequence[Neighbourhood]

    def passes(self, changed: Mapping[str, Expr]) -> bool:
        """Whether the claim could be right with some answers changed."""

        def answer(key: str) -> Expr:
            return changed[key] if key in changed else self.answers[key]

        try:
            with precision(BITS):
                return all(self.test(answer, place) for place in self.places)
        except Unmodelled:
            return True
        except (Undefined, NotDecided, ZeroDivisionError):
            return False


def screening(reading: Reading, answers: Mapping[str, Expr]) -> Screening | None:
    """Return the screening of a claim's answers, None for kinds or domains in which there is none.

    Parameters
    ----------
    reading
        A claim.
    answers
        What it answers, by keys such as ``Q[0]``.
    """
    try:
        found = _test_of(reading)
    except (InvalidClaim, EmptyDomainError, SingularMatrixError, Undecided):
        return None
    if found is None:
        return None
    test, symbols, domain, given = found
    examples = Examples((*answers.values(), *given))
    with precision(BITS):
        places = [
            Neighbourhood({s: acb(int(v.p)) / acb(int(v.q)) for s, v in point.items()}, examples)
            for point in domain.points(symbols, POINTS, seed=23, but_functions=True)
        ]
    return Screening(answers, test, places) if len(places) == POINTS else None


def _test_of(reading: Reading) -> tuple[Test, Sequence[Symbol], Domain, Sequence[Expr]] | None:
    """Return the test of a kind, what needs a value, where, and the expressions that are not answered."""
    kind, names = reading.claim.kind, (*reading.scope.names.values(), reading.time)
    given: list[Expr] = []
    domain = reading.domain
    if kind.startswith("canonicity") and reading.has("implicit"):
        test = tests.implicit(reading)
    elif kind.startswith("canonicity") or (kind == "bilinear-covariant" and reading.has("Q")):
        test = tests.canonical_map(reading)
    elif kind == "equality-only":
        test = tests.equality()
    elif kind == "poisson-bracket":
        test = tests.poisson_brackets(reading)
    elif kind == "lagrange-bracket":
        test = tests.lagrange_brackets(reading)
        given += [value for *_, value in reading.brackets("u", "v")]
    elif kind.startswith("generating"):
        test, domain = tests.generating(reading), map_values(reading)[1]
        names = tuple(s for s in names if s not in tests.dependent(reading))
    elif kind == "transformed-hamiltonian-K":
        test, domain = tests.new_hamiltonian(reading), map_values(reading)[1]
        names = tuple(s for s in names if s not in tests.dependent(reading))
        given.append(reading.expression("H"))
    elif kind == "constant-of-motion" and not reading.has("restrict"):
        rates = motion_of(reading)
        test, names = tests.constant(reading, rates), (*names, *rates)
        given += rates.values()
    elif kind == "lagrangian-equivalence" and reading.has("F"):
        test, names = tests.gauge(reading), (*names, *(velocity(q) for q in reading.symbols("q")))
        given += [reading.expression("L1")]
    elif kind == "hamilton-equations" and reading.has("solution"):
        test = tests.solution(reading)
        given.append(reading.expression("H"))
    else:
        return None
    return test, names, domain, given
