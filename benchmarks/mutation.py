"""Print how many mutants of canon its tests kill: small changes of the code, one at a time.

pip install cosmic-ray pytest-cov
python benchmarks/mutation.py --count 520 --seed 1           # what is not done yet, then the table
python benchmarks/mutation.py --count 520 --seed 1 --again   # survivors once more, by the tests that are there now
python benchmarks/mutation.py --count 520 --seed 1 --again --part 2/3   # a third of them, beside two other processes

The changes are those of cosmic-ray's operators, and of a few that it lacks (`mutants/operators.py`), at places drawn
by the seed. First the quick tests run under coverage.py, so that each line is known with the tests that execute it;
not where every survivor has a test that was written for it.
Then each mutant meets those tests, the quickest first, up to a bound of time. What does not end is killed too. Tests
that fail on canon as it is do not count. Every survivor is read; `mutants/survivors.toml` says why it changes nothing,
or which test was written for it. What came of them is kept in results/mutation, and all else in out/mutation, so an
interrupted run goes on where it stopped, on another machine too.
"""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from collections import Counter
from dataclasses import asdict, replace
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent))

from days import in_words
from mutants.choice_of_tests import quickest, tests_for, tests_once_more
from mutants.record_of_tests import Record, places_of_tests, read_record, record_place
from mutants.sampling import Mutant, drawn, is_there, lines_of_rooms, room_of
from mutants.trial import ONCE_MORE, Trial, copy_of_checkout, failing, trial, warm_up

HOME = Path(__file__).parents[1]
KEPT = HOME / "out" / "mutation"
RECORD, CACHES = (KEPT / name for name in ("record", "caches"))
FOUND = Path(__file__).parent / "results" / "mutation"
SURVIVORS = Path(__file__).parent / "mutants" / "survivors.toml"


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=520, help="mutants, or a few more")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="try the survivors once more")
    parser.add_argument("--part", type=_part, default=(1, 1), help="which of how many processes this is, 2/3")
    said = parser.parse_args(arguments)
    place = Place(KEPT / f"checkout-{said.part[0]}", KEPT / f"log-{said.part[0]}")
    explained = {key for key, each in explanations().items() if "test" not in each}
    results = FOUND / f"results-{said.count}-{said.seed}.jsonl"
    mutants = kept_or_drawn(said.count, said.seed)
    found = read_results(results)
    alive = {key for key, each in found.items() if each.outcome == "survived" and key not in explained}
    left = [m for m in mutants if m.key not in found or (said.again and m.key in alive)]
    left = left[said.part[0] - 1 :: said.part[1]]
    gone = [mutant for mutant in left if not is_there(HOME, mutant)]
    if gone:
        print(
            f"{len(gone)} mutants are of lines that have changed; delete {FOUND} to draw anew",
            file=sys.stderr,
        )
        left = [mutant for mutant in left if mutant not in gone]
    if left:
        copy_of_checkout(HOME, place.copy)
        if not said.again or any(not written_for(mutant) for mutant in left):
            for name, tests in places_of_tests(place.copy).items():
                record_place(place.copy, name, tests, RECORD)
        try_all(mutants, left, read_record(RECORD), results, place, again=said.again)
        found = read_results(results)
    tell([mutant for mutant in mutants if mutant.key in found], found, explanations())


class Place(NamedTuple):
    """Where a process writes mutants, and what pytest says there."""

    copy: Path
    log: Path


def _part(text: str) -> tuple[int, int]:
    part, _, parts = text.partition("/")
    return int(part), int(parts)


def kept_or_drawn(count: int, seed: int) -> list[Mutant]:
    """Return the mutants of a seed; they stay what they were when the sources change."""
    path = FOUND / f"mutants-{count}-{seed}.jsonl"
    if not path.exists():
        FOUND.mkdir(parents=True, exist_ok=True)
        lines = [json.dumps(asdict(mutant), ensure_ascii=False) for mutant in drawn(HOME, count, seed)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [Mutant(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines()]


def read_results(path: Path) -> dict[str, Trial]:
    """Return what became of the mutants, the last word on each."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {key: Trial(**found) for key, found in map(json.loads, lines)}


def explanations() -> dict[str, dict[str, str]]:
    """Return what was said of survivors: why they change nothing, or the test that was written for them."""
    return {each["mutant"]: each for each in tomllib.loads(SURVIVORS.read_text("utf-8"))["survivor"]}


def try_all(
    mutants: list[Mutant], left: list[Mutant], record: Record, results: Path, place: Place, *, again: bool
) -> None:
    """Try what is left of the mutants and write what came of each; then those anew whose killers always fail."""
    warm_up()
    CACHES.mkdir(parents=True, exist_ok=True)
    while left:
        for k, mutant in enumerate(left):
            found = (try_once_more if again else try_one)(mutant, record, place)
            with results.open("a", encoding="utf-8") as out:
                out.write(json.dumps([mutant.key, asdict(found)], ensure_ascii=False) + "\n")
            told = f"{k + 1}/{len(left)} {found.outcome:9}{found.seconds:6.1f} s  {mutant.key}"
            print(told, file=sys.stderr, flush=True)
        known = read_results(results)
        killers = {mutant.key: known[mutant.key].by for mutant in mutants if mutant.key in known}
        always = failing(
            {test: 30.0 for test in killers.values() if ".py" in test}, place.copy, CACHES, place.log
        )
        record.unfit |= always
        left = [mutant for mutant in mutants if killers.get(mutant.key) in always]


def try_one(mutant: Mutant, record: Record, place: Place) -> Trial:
    """Try a mutant: by a few tests, whose modules are soon imported, then by the others."""
    tests = tests_for(mutant, record, place.copy, written_for(mutant))
    found = Trial("survived", "", "no test", 0, 0.0)
    for part in (first := quickest(tests)), {t: s for t, s in tests.items() if t not in first}:
        if part and found.outcome == "survived":
            after = trial(mutant, part, place.copy, CACHES, place.log)
            found = replace(after, tests=found.tests + after.tests, seconds=found.seconds + after.seconds)
    return found


def try_once_more(mutant: Mutant, record: Record, place: Place) -> Trial:
    """Try a survivor by the test that was written for it, or by many more tests."""
    tests = dict.fromkeys(written_for(mutant), 5.0) or tests_once_more(mutant, record, place.copy)
    return trial(mutant, tests, place.copy, CACHES, place.log, ONCE_MORE)


def written_for(mutant: Mutant) -> list[str]:
    known = explanations().get(mutant.key, {})
    return [known["test"]] if "test" in known else []


def tell(mutants: list[Mutant], found: dict[str, Trial], said: dict[str, dict[str, str]]) -> None:
    """Print the table by rooms, and what is known of every survivor."""
    rooms = {room: sum(lines.values()) for room, lines in lines_of_rooms(HOME).items()}
    counts = {room: Counter[str]() for room in rooms}
    print(f"measured on {in_words(found[mutant.key].day for mutant in mutants)}")
    for mutant in mutants:
        counts[room_of(mutant.file)][fate(mutant, found, said)] += 1
    print(
        f"{'room':12}{'lines':>8}{'mutants':>9}{'killed':>8}{'by new tests':>14}{'no change':>11}{'alive':>7}"
    )
    for room, lines in rooms.items():
        print(row(room, lines, counts[room]))
    total = sum(counts.values(), Counter[str]())
    print(row("all", sum(rooms.values()), total))
    change = total.total() - total["equal"]
    print(f"\n{change} change what canon does, {share(total)} % of them are killed, ", end="")
    print(f"{100 * total['killed'] / change:.1f} % by tests that were there when the sample was drawn")
    for key, title in FATES.items():
        told = [m for m in mutants if fate(m, found, said) == key]
        print(f"\n{title}: {len(told)}")
        for mutant in sorted(told, key=lambda m: m.key):
            print(f"  {mutant.key}\n      {words(said.get(mutant.key, {}))}")


FATES = {"equal": "Change nothing", "new": "Killed by tests written for them", "alive": "Alive"}


def fate(mutant: Mutant, found: dict[str, Trial], said: dict[str, dict[str, str]]) -> str:
    """Return "killed", "new" where by a test written for it, "equal" where nothing changes, else "alive"."""
    known = said.get(mutant.key, {})
    if found[mutant.key].outcome == "killed":
        return "new" if "test" in known else "killed"
    return "equal" if "equal" in known else "alive"


def row(name: str, lines: int, count: Counter[str]) -> str:
    """Return a line of the table."""
    numbers = f"{count['killed'] + count['new']:8}{count['new']:14}{count['equal']:11}{count['alive']:7}"
    return f"{name:12}{lines:8}{count.total():9}{numbers}{share(count):>8} %"


def share(count: Counter[str]) -> str:
    """Return how many percent of the mutants that change something are killed."""
    killed = count["killed"] + count["new"]
    change = killed + count["alive"]
    return f"{100 * killed / change:.1f}" if change else "–"


def words(known: dict[str, str]) -> str:
    return known.get("equal") or known.get("test") or known.get("alive") or "not read yet"


if __name__ == "__main__":
    main(sys.argv[1:])
