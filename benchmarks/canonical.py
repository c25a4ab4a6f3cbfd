"""How well and how fast canon recognizes canonical maps and finds their generating functions.

Prints, for the collection of maps in tests/mechanics/map_collection.py: whether the types that exist are told
from those that do not, how many generating functions come in closed form (each verified by proof before it is
returned) or parametrically, and the times. Run it with canon installed, -v prints every function:

    python benchmarks/canonical.py -v
"""

import statistics
import sys
import time as clock
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "mechanics"))

from map_collection import MAPS, NOTES, linear_symplectic

from canon.mechanics.canonical.find_generating_function import generating_function
from canon.mechanics.canonical.generating_function import GeneratingFunction, NoGeneratingFunctionError


def timed(function, *arguments, **keywords):
    start = clock.perf_counter()
    value = function(*arguments, **keywords)
    return value, clock.perf_counter() - start


def found(T, kind):
    """What comes out for one (map, type): closed, parametric or none, and the function."""
    try:
        F = generating_function(T, kind)
    except NoGeneratingFunctionError:
        return "none", None
    return ("closed" if isinstance(F, GeneratingFunction) else "parametric"), F


def generating_functions(verbose):
    seconds, outcomes, wrong, unproved = [], [], [], []
    for name, case in MAPS.items():
        for kind in (1, 2, 3, 4):
            (outcome, F), spent = timed(found, case.map, kind)
            if (outcome != "none") != (kind in case.kinds):
                wrong.append((name, kind, outcome))
            if outcome == "none":
                continue
            seconds.append(spent)
            outcomes.append(outcome)
            right = F.generates(case.map, F.domain) if outcome == "closed" else F.is_right()
            if not right.holds:
                unproved.append((name, kind, outcome, right.status.name))
            if verbose:
                print(f"  {name:28s} F{kind}  {outcome:10s} {spent:6.2f} s  {F.F}")
    pairs = len(MAPS) * 4
    closed = outcomes.count("closed")
    print(
        f"(map, type) pairs: {pairs}, of which exist: {len(outcomes)}; existence told wrongly: {wrong or 'none'}"
    )
    print(
        f"in closed form: {closed} of {len(outcomes)} ({100 * closed / len(outcomes):.1f} %), the rest parametric"
    )
    print(f"not proved to be right: {unproved or 'none'}")
    seconds.sort()
    print(
        f"seconds a pair: median {statistics.median(seconds):.3f}, "
        f"90 % below {seconds[int(0.9 * len(seconds))]:.2f}, largest {seconds[-1]:.2f}"
    )


def tests_of_canonicity():
    print("transformations of the notes by all five tests:")
    for name, case in NOTES.items():
        verdict, spent = timed(case.map.is_canonical, by="all")
        twins = [timed(twin.is_canonical, by="all") for twin in case.twins]
        refused = all(v.fails for v, _ in twins)
        print(
            f"  {name:28s} {verdict.status.name} in {spent:.2f} s; "
            f"{len(twins)} twin(s) {'refused' if refused else 'NOT REFUSED'} in {sum(s for _, s in twins):.2f} s"
        )
    oscillator = NOTES["oscillator"].map
    spent = sum(timed(generating_function, oscillator, kind)[1] for kind in (1, 2, 3, 4))
    print(f"F1-F4 of the oscillator: {spent:.2f} s together")
    case, _ = timed(linear_symplectic, 10)
    verdict, spent = timed(case.map.is_canonical)
    refused, again = timed(case.twins[0].is_canonical)
    print(
        f"linear map of 10 degrees: {verdict.status.name} in {spent:.2f} s, "
        f"its twin {refused.status.name} in {again:.2f} s"
    )


if __name__ == "__main__":
    tests_of_canonicity()
    generating_functions(verbose="-v" in sys.argv[1:])
