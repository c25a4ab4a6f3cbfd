"""What studies keep: the motion, a section, the exponent, results of functions; exactly, and told where damaged."""

from __future__ import annotations

import io
import json
import math
import random
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace

import numpy as np
import pytest

from canon import (
    Event,
    Splitting,
    Study,
    TimeTransformed,
    coordinates,
    flow_jacobian,
    propagate,
    results_of,
    run_study,
)
from canon.cli import main
from canon.flow import megno
from canon.study import DamagedChunk, StudyError, mend
from canon.study.cases import kept_of_case, store
from canon.study.cases.case import Case, key_of
from canon.study.cases.run_study import resume, status_of
from canon.study.cases.store import Store, StoreError
from canon.study.kept.chunk_file import ChunkFolder
from canon.study.kept.keep_choice import chosen_functions

from .kept_studies import FUNCTIONS, STUDY, all_of


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("kept") / "study.sqlite"
    assert run_study(STUDY, path, keep=FUNCTIONS).finished == 2
    return path


@pytest.fixture
def path(tmp_path, whole):
    shutil.copy(whole, tmp_path / "study.sqlite")
    shutil.copytree(ChunkFolder(whole).path, ChunkFolder(tmp_path / "study.sqlite").path)
    return tmp_path / "study.sqlite"


def command(*arguments):
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = main(["study", *map(str, arguments)])
    return status, out.getvalue(), err.getvalue()


def test_the_motion_is_the_one_that_propagate_gives(whole):
    """Fixed steps: the parts of a run are the run in one piece, state by state."""
    kept = results_of(whole)[0].kept["motion"]
    case = STUDY.cases[0]
    motion = propagate(
        case.hamiltonian, (0, case.span), case.state, method=case.method, step=case.step,
        parameters=case.values, times=kept["t"],
    )  # fmt: skip
    assert list(kept) == ["t", "x", "y", "p_x", "p_y", "energy_change"]
    for name in ("x", "y", "p_x", "p_y"):
        np.testing.assert_array_equal(kept[name], motion[name])
    np.testing.assert_allclose(kept["energy_change"], motion.energy_change, rtol=1e-9, atol=1e-17)


def test_the_section_is_where_the_motion_passes(whole):
    for result in results_of(whole):
        section, case = result.kept["section"], result.case
        x = coordinates("x")
        motion = propagate(
            case.hamiltonian, (0, case.span), case.state, method=case.method, step=case.step,
            parameters=case.values, events=[Event(x, 1)],
        )  # fmt: skip
        np.testing.assert_allclose(section["t"], [met.t for met in motion.events], rtol=1e-10)
        assert len(section["t"]) >= 8
        assert abs(section["x"]).max() < 1e-12
        assert (section["p_x"] > 0).all()


def test_the_section_of_an_oscillator_is_known(tmp_path):
    """x = cos t rises through 1/2 at 2πk − π/3, where p = √3/2."""
    keep = {"section": "x - 1/2", "direction": "rising"}
    study = Study.of(
        system="harmonic-oscillator", start=[[1.0, 0.0]], parameters={"m": 1.0, "k": 1.0}, method="taylor",
        span=60.0, samples=512, parts=7, keep=keep,
    )  # fmt: skip
    run_study(study, tmp_path / "s.sqlite")
    (result,) = results_of(tmp_path / "s.sqlite")
    section = result.kept["section"]
    expected = 2 * math.pi * np.arange(1, 10) - math.pi / 3
    np.testing.assert_allclose(section["t"], expected, rtol=1e-13)
    (momentum,) = (name for name in section if name.startswith("p"))
    np.testing.assert_allclose(section[momentum], math.sqrt(3) / 2, rtol=1e-13)


def test_the_exponent_is_that_of_the_tangent_map(whole):
    for result in results_of(whole):
        found, case = result.kept["exponent"], result.case
        M = flow_jacobian(
            case.hamiltonian, (0, case.span), case.state, method=case.method, step=case.step, parameters=case.values
        ).final  # fmt: skip
        assert found["largest"][-1] == pytest.approx(math.log(abs(M).max()) / case.span, rel=1e-9)
        assert found["t"][-1] == case.span


def test_the_exponent_of_an_unstable_fixed_point_is_known(tmp_path):
    """An upright pendulum leaves as e^t: ln(cosh t)/t."""
    x = coordinates("x")
    from canon import Hamiltonian

    inverted = Hamiltonian(x.momentum**2 / 2 - x**2 / 2, [x], [x.momentum])
    study = Study.of(
        system=inverted, start=[[0.0, 1e-9]], method="taylor", span=20.0, samples=256, keep="exponent"
    )
    run_study(study, tmp_path / "s.sqlite")
    found = results_of(tmp_path / "s.sqlite")[0].kept["exponent"]
    np.testing.assert_allclose(found["largest"], np.log(np.cosh(found["t"])) / found["t"], rtol=1e-12)


def test_whether_a_case_is_chaotic_is_kept_with_its_limit(tmp_path):
    study = Study.of(
        system="henon-heiles", start=["regular", "chaotic"], method="kahan-li-8", step=0.2, span=3000.0, samples=256,
        keep="chaos",
    )  # fmt: skip
    run_study(study, tmp_path / "s.sqlite")
    for result, verdict in zip(results_of(tmp_path / "s.sqlite"), (-1.0, 1.0), strict=True):
        kept, case = result.kept["chaos"], result.case
        found = megno(
            case.hamiltonian, (0, case.span), case.state, method=case.method, step=case.step, samples=64,
            parameters=case.values,
        )  # fmt: skip
        assert (kept["verdict"] == verdict).all()
        assert kept["megno"].tolist() == found.history[1:].tolist()
        assert (kept["detection_limit"] == found.detection_limit).all()


def test_a_functions_result_is_kept(whole):
    for result in results_of(whole):
        motion, found = result.kept["motion"], result.kept["spread"]
        assert found["of_x"] == motion["x"].std()
        assert found["corners"].tolist() == [motion["x"][:2].tolist(), motion["y"][:2].tolist()]


def test_parts_and_legs_change_no_bit(tmp_path, whole):
    """Each checkpoint goes through text; threads bring the cases back in any order."""
    with ThreadPoolExecutor(2) as pool:
        run_study(STUDY, tmp_path / "legs.sqlite", pool, checkpoint_seconds=0.0, keep=FUNCTIONS)
    assert all_of(tmp_path / "legs.sqlite") == all_of(whole)


def test_the_numbers_do_not_depend_on_what_is_kept(tmp_path, whole):
    """But heyoka computes a section along with the motion, which changes last bits of it."""
    bare = Study(tuple(replace(case, keep=()) for case in STUDY.cases))
    run_study(bare, tmp_path / "bare.sqlite")
    keeping = Study(tuple(replace(case, keep=case.keep[:2]) for case in STUDY.cases))
    run_study(keeping, tmp_path / "keeping.sqlite", keep=FUNCTIONS)
    verlet, taylor = results_of(tmp_path / "bare.sqlite")
    others = results_of(tmp_path / "keeping.sqlite")
    assert [other.numbers for other in others] == [verlet.numbers, taylor.numbers]
    assert results_of(whole)[0].numbers == verlet.numbers
    np.testing.assert_allclose(results_of(whole)[1].numbers["final"], taylor.numbers["final"], rtol=1e-12)
    assert len(verlet.kept) == 0
    assert len({result.key for result in (verlet, others[0], results_of(whole)[0])}) == 3
    assert not ChunkFolder(tmp_path / "bare.sqlite").path.exists()


def test_cases_that_keep_nothing_have_the_key_they_had():
    case = STUDY.cases[0]
    assert "keep" not in replace(case, keep=()).to_dict()
    assert Case.from_dict(json.loads(json.dumps(case.to_dict()))) == case
    assert (
        len({key_of(each) for each in (case, replace(case, keep=()), replace(case, keep=case.keep[:1]))}) == 3
    )


def test_nothing_is_read_until_it_is_asked_for(path):
    results = results_of(path)
    shutil.rmtree(ChunkFolder(path).path)
    assert list(results[0].kept) == ["motion", "exponent", "section", "spread"]
    assert results[0].kept.shapes["motion.x"] == (513,)
    assert ("motion" in results[0].kept, "orbit" in results[0].kept, len(results[0].kept)) == (True, False, 4)
    with pytest.raises(DamagedChunk, match="is not there; 'canon study mend"):
        results[0].kept["motion"]
    with pytest.raises(KeyError, match="no 'orbit' was kept of the case; there is motion, exponent"):
        results[0].kept["orbit"]


def test_every_flipped_bit_of_a_chunk_is_told(path):
    """The wrong twin of each file: one bit of it, anywhere."""
    draw, results = random.Random(3), results_of(path)
    for _ in range(60):
        result = draw.choice(results)
        file = ChunkFolder(path).path / result.kept.chunk.file_name
        content = bytearray(file.read_bytes())
        at, bit = draw.randrange(len(content)), 1 << draw.randrange(8)
        content[at] ^= bit
        file.write_bytes(content)
        for name in result.kept:
            with pytest.raises(DamagedChunk, match="is damaged"):
                result.kept[name]
        content[at] ^= bit
        file.write_bytes(content)
    assert results[0].kept["spread"]["of_x"] == results_of(path)[0].kept["spread"]["of_x"]


def test_damage_is_told_by_case_set_aside_and_computed_again(path, whole):
    first, second = ChunkFolder(path).files()
    content = bytearray(first.read_bytes())
    content[len(content) // 2] ^= 4
    first.write_bytes(content)
    second.unlink()
    (first.parent / "ab0123456789abcd-0123456789abcdef.npz").write_bytes(b"left by a kill")
    status, out, err = command("status", path)
    assert status == 2
    assert out.count("damaged: what was kept") == 2
    assert "of henon-heiles; verlet, h = 0.1" in out
    assert "canon study mend" in err
    status, out, _ = command("mend", path)
    assert status == 3
    assert [out.count(why) for why in ("it is damaged", "it is not there", "no record names it")] == [1, 1, 1]
    assert {file.name for file in (first.parent / "aside").iterdir()} == {
        first.name, "ab0123456789abcd-0123456789abcdef.npz",
    }  # fmt: skip
    assert status_of(Store(path)).pending == 2
    run_study(STUDY, path, keep=FUNCTIONS)
    assert all_of(path) == all_of(whole)
    assert mend(path).chunks == ()


def test_mending_beside_a_running_study_takes_nothing_from_it(tmp_path, monkeypatch):
    """Mending that comes between a chunk and its row waits; for no longer than its patience, then says so."""
    path, written, write = tmp_path / "s.sqlite", [], ChunkFolder.write
    monkeypatch.setattr(store, "PATIENCE", 0.05)

    def interrupted(folder, chunk, content):
        write(folder, chunk, content)
        with pytest.raises(StoreError, match="another process has been writing"):
            mend(path)
        written.append(chunk.file_name)

    monkeypatch.setattr(ChunkFolder, "write", interrupted)
    study = Study.of(
        system="henon-heiles", method=["verlet", "rk4"], step=0.1, span=60.0, samples=256, keep="motion"
    )
    assert run_study(study, path).finished == 2
    assert mend(path).chunks == ()
    assert sorted(written) == [file.name for file in ChunkFolder(path).files()]
    assert all(len(result.kept["motion"]["t"]) == 257 for result in results_of(path))


def test_a_kill_between_chunk_and_record_costs_nothing(path, whole):
    Store(path).forget([results_of(path)[0].key])
    assert run_study(STUDY, path, keep=FUNCTIONS).pending == 0
    assert all_of(path) == all_of(whole)


def test_what_is_kept_is_merged(tmp_path, whole):
    merged = Store(tmp_path / "all.sqlite")
    merged.add_from(Store(whole))
    assert all_of(merged.path) == all_of(whole)


def test_a_damaged_chunk_is_not_merged(tmp_path, path):
    file = ChunkFolder(path).files()[0]
    file.write_bytes(file.read_bytes()[:-1])
    merged = Store(tmp_path / "all.sqlite")
    with pytest.raises(DamagedChunk):
        merged.add_from(Store(path))
    assert merged.cases() == {}


def test_a_file_that_keeps_a_functions_results_goes_on_with_that_function_only(path):
    Store(path).forget([result.key for result in results_of(path)])

    def another(motion):
        return 1.0

    for keep in ({}, {"spread": another}):
        with pytest.raises(StudyError, match=r"'spread'.* resume from Python, with keep="):
            resume(path, keep=keep)
    status, _, err = command("resume", path)
    assert status == 2
    assert "'spread'" in err
    assert resume(path, keep=FUNCTIONS).finished == 2


def test_a_function_that_changes_is_another(tmp_path):
    def size(motion):
        return abs(motion["x"]).max()

    largest = size

    def size(motion):
        return abs(motion["x"]).max() ** 2

    study, path = Study(STUDY.cases[:1]), tmp_path / "s.sqlite"
    for function in (largest, size, size):
        run_study(study, path, keep={"size": function})
    first, second = (result.kept["size"] for result in results_of(path))
    assert second == first**2 != first


@pytest.mark.parametrize(
    ("value", "why"),
    [
        (math.nan, "not finite"),
        ("text", "no number"),
        (1j, "no number"),
        ({"a b": 1.0}, "no names"),
        (2**63 - 1, "doubles can't"),
    ],
)
def test_what_a_function_returns_has_to_be_numbers(tmp_path, value, why):
    run_study(Study(STUDY.cases[:1]), tmp_path / "s.sqlite", keep={"f": lambda motion: value})
    (result,) = results_of(tmp_path / "s.sqlite")
    assert result.state.value == "failed"
    assert why in result.failure


def of_verlet_only(motion):
    return {"end": motion["x"][-1] + (None if abs(motion.energy_change).max() > 1e-5 else 1.0)}


@pytest.mark.parametrize(
    ("function", "told"),
    [(of_verlet_only, "spread raised TypeError: unsupported operand"),
     (lambda motion: motion.nothing, "spread raised AttributeError: 'KeptMotion' object has no attribute 'nothing'"),
     (lambda motion: motion["z"], "spread raised KeyError")],
    ids=["a wrong type", "an attribute", "a name"],
)  # fmt: skip
def test_a_function_that_raises_fails_its_case_and_no_other(tmp_path, function, told):
    """What it raised is told with its place; the other cases of the study go on."""
    study = Study.of(system="henon-heiles", method=["verlet", "rk4"], step=0.1, span=60.0, samples=256)
    status = run_study(study, path := tmp_path / "s.sqlite", keep={"spread": function})
    both = function is not of_verlet_only
    assert (status.finished, status.failed, status.pending) == (0 if both else 1, 2 if both else 1, 0)
    failed = [result for result in results_of(path) if result.state.value == "failed"]
    for result in failed:
        assert told in result.failure
        assert f"(test_kept.py:{function.__code__.co_firstlineno + (0 if both else 1)} in " in result.failure
    said = command("status", path)[1]
    assert told in said


def test_an_error_of_canon_itself_ends_the_study(tmp_path, monkeypatch):
    """A fault in canon's own code is no result of a case."""
    study = Study.of(
        system="henon-heiles", method="verlet", step=0.1, span=60.0, samples=256, keep="exponent"
    )

    def broken(case):
        raise TypeError("a fault of canon")

    monkeypatch.setitem(kept_of_case.COMPUTED_ANEW, "exponent", broken)
    with pytest.raises(TypeError, match="a fault of canon"):
        run_study(study, tmp_path / "s.sqlite")
    assert status_of(Store(tmp_path / "s.sqlite")).pending == 1


@pytest.mark.parametrize(
    "keep",
    ["orbit", 5, [["motion"]], {"section": ""}, {"section": "x", "way": 1}, {"section": "x", "direction": "up"},
     [{"section": "x"}, {"section": "y"}], {"section": "unknown_thing"}, None, {"spread": 3}],
)  # fmt: skip
def test_a_choice_that_means_nothing_is_refused(keep):
    with pytest.raises(StudyError):
        Study.of(system="henon-heiles", method="verlet", step=0.1, span=60.0, keep=keep)


@pytest.mark.parametrize("keep", [{"motion": len}, {"a b": lambda m: 1}, {"motion": lambda m: 1}])
def test_functions_have_names_of_their_own(keep):
    with pytest.raises((TypeError, ValueError), match="kept"):
        chosen_functions(keep)


def test_a_driven_motion_is_kept_in_its_own_variables(tmp_path):
    study = Study.of(
        system="parametric-pendulum", method={"gauss": 2}, step=0.02, span=30.0, samples=256, parts=3,
        keep=["motion", {"section": "theta"}], start="hanging",
    )  # fmt: skip
    run_study(study, tmp_path / "s.sqlite")
    (result,) = results_of(tmp_path / "s.sqlite")
    variables = result.case.variables
    assert list(result.kept["motion"]) == ["t", *variables, "energy_change"]
    q, t = result.kept["motion"][variables[0]], result.kept["motion"]["t"]
    crossings = np.flatnonzero(np.sign(q[1:]) * np.sign(q[:-1]) < 0)
    assert len(crossings) == len(result.kept["section"]["t"]) > 2
    inside = (t[crossings] <= result.kept["section"]["t"]) & (result.kept["section"]["t"] <= t[crossings + 1])
    assert inside.all()


@pytest.mark.parametrize(
    "given",
    [
        {"system": "chaplygin-sleigh", "method": "taylor", "keep": ["motion", {"section": "theta - 1"}]},
        {
            "system": "kepler",
            "method": TimeTransformed(Splitting("kahan-li-8")),
            "step": 0.01,
            "keep": "motion",
        },
        {
            "system": "kepler",
            "method": "dop853",
            "keep": ["motion", {"section": "y", "direction": "falling"}],
        },
    ],
    ids=lambda given: given["system"],
)
def test_motions_of_every_kind_are_kept(tmp_path, given):
    """Second route: propagate, at the times that were kept."""
    run_study(Study.of(span=20.0, samples=300, **given), tmp_path / "s.sqlite")
    (result,) = results_of(tmp_path / "s.sqlite")
    assert result.failure == ""
    motion, case = result.kept["motion"], result.case
    found = propagate(
        case.hamiltonian, (0, case.span), case.state, method="taylor", parameters=case.values, times=motion["t"]
    )  # fmt: skip
    tolerance = 1e-6
    for name in case.variables:
        np.testing.assert_allclose(motion[name], found[name], rtol=tolerance, atol=tolerance)
    assert "section" not in result.kept or len(result.kept["section"]["t"]) > 0
    for name in result.kept["section"] if len(result.kept) > 1 else ():
        assert np.isfinite(result.kept["section"][name]).all()
