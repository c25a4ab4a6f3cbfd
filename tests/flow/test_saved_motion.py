"""Motions kept in files: the same bits come back and go on; damage, pickles and what can't be kept are refused."""

import hashlib
import io
import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from canon import (
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    TimeTransformed,
    coordinates,
    load_motion,
    propagate,
)
from canon.flow import record_file
from canon.flow.propagation import Interrupted
from canon.flow.record_data import _Writer
from canon.flow.record_file import record_in
from canon.flow.run.event import Event

x, y = coordinates("x y")
k = sp.Symbol("k")
PENDULUM = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
STIFF = Hamiltonian(x.momentum**2 / 2 - k * sp.cos(x), [x], [x.momentum])
r = sp.sqrt(x**2 + y**2)
KEPLER = Hamiltonian((x.momentum**2 + y.momentum**2) / 2 - 1 / r, [x, y], [x.momentum, y.momentum])
DAMPED = Lagrangian(x.dot**2 / 2 + sp.cos(x), [x], forces=[-x.dot / 5])
VERLET = {"method": "verlet", "step": 0.125}

CASES = {
    "taylor": (PENDULUM, [1.0, 0.0], {}),
    "taylor-extended": (PENDULUM, [1.0, 0.0], {"precision": "extended", "max_step": 0.5}),
    "taylor-quad": (PENDULUM, ["1/3", 0], {"precision": "quad"}),
    "taylor-40-digits": (PENDULUM, ["1/3", 0], {"precision": 40}),
    "taylor-events": (PENDULUM, [1.0, 0.0], {"events": [Event(x), Event(sp.sin(x) - sp.Float("0.1", 30), 1)]}),
    "dop853": (PENDULUM, [1.0, 0.0], {"method": "DOP853"}),
    "verlet-followed": (PENDULUM, [1.0, 0.0], {"cadence": 2, "observables": {"a": x**2}, **VERLET}),
    "verlet-kicked": (PENDULUM, [1.0, 0.0], {"events": [Event(x, action={x.momentum: -x.momentum / 2})], **VERLET}),
    "orbits": (PENDULUM, np.array([[1.0, 0.5, 0.25], [0, 0.1, 0.2]]), VERLET),
    "parameter-by-orbit": (STIFF, [1.0, 0.0], {"parameters": {k: np.array([1.0, 2.0])}, **VERLET}),
    "own-splitting": (PENDULUM, [1.0, 0.0], {"method": Splitting(a=[0.5, 0.5], b=[1]), "step": 0.125}),
    "double-double": (PENDULUM, [1.0, 0.0], {"method": "kahan-li-8", "step": 0.125, "precision": "double-double"}),
    "gauss": (PENDULUM, [1.0, 0.0], {"method": Gauss(3), "step": 0.125, "precision": "extended"}),
    "transformed": (KEPLER, [0.5, 0, 0, 1.5], {"method": TimeTransformed(Gauss(2), g=r), "step": 0.01}),
    "damped": (DAMPED, {x: 1, x.dot: 0}, {}),
    "rolling-disc": ("rolling-disc", None, {}),
}  # fmt: skip


def equal(a, b):
    for one, other in (
        (a.t, b.t),
        (a.y, b.y),
        (a.carried, b.carried),
        *zip(a.energies, b.energies, strict=True),
    ):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype
    assert (a.method, a.precision, a.step, a.steps) == (b.method, b.precision, b.step, b.steps)
    assert a.observables.keys() == b.observables.keys()
    assert a.statistics.keys() == b.statistics.keys()
    for name in a.statistics:
        np.testing.assert_array_equal(a.statistics[name].mean, b.statistics[name].mean)
    assert [(str(e.event), e.t, e.y.tolist()) for e in a.events] == [
        (str(e.event), e.t, e.y.tolist()) for e in b.events
    ]


@pytest.mark.parametrize("case", CASES)
def test_what_was_saved_comes_back_and_goes_on_bit_for_bit(case, tmp_path):
    system, start, how = CASES[case]
    motion = propagate(system, (0, 4), start, samples=8, **how)
    motion.save(tmp_path / "motion.npz")
    again = load_motion(tmp_path / "motion.npz")
    assert repr(again) == repr(motion)
    equal(again, motion)
    equal(again.resume(8, samples=8), motion.resume(8, samples=8))
    if not isinstance(system, str):
        np.testing.assert_array_equal(again[x**2], motion[x**2])


@pytest.mark.parametrize("case", ["taylor-quad", "gauss", "verlet-followed"])
def test_an_interrupted_motion_is_saved_and_completed(case, tmp_path):
    system, start, how = CASES[case]

    def impatient(fraction):
        if fraction > 0.4:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as caught:
        propagate(system, (0, 40), start, samples=20, progress=impatient, **how)
    part = caught.value.motion
    part.save(tmp_path / "part.npz")
    completed = load_motion(tmp_path / "part.npz").resume()
    assert len(part.t) < len(completed.t)
    equal(completed, propagate(system, (0, 40), start, samples=20, **how))


def test_another_process_goes_on_with_the_same_bits(tmp_path):
    motion = propagate(PENDULUM, (0, 4), [1.0, 0.0], samples=8)
    motion.save(tmp_path / "motion.npz")
    goes_on = "import sys; from canon import load_motion; print(load_motion(sys.argv[1]).resume(8).y.tobytes().hex())"
    done = subprocess.run(
        [sys.executable, "-c", goes_on, str(tmp_path / "motion.npz")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == motion.resume(8).y.tobytes().hex()


def test_no_flipped_bit_and_no_cut_goes_unnoticed(tmp_path):
    path = tmp_path / "motion.npz"
    propagate(PENDULUM, (0, 4), [1.0, 0.0], samples=2, **VERLET).save(path)
    whole = path.read_bytes()
    assert load_motion(path).t[-1] == 4
    bits = np.random.default_rng(7).integers(8, size=len(whole))
    for place, bit in enumerate(bits.tolist()):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << bit
        with pytest.raises(ValueError, match=r"is damaged|holds no motion"):
            record_in(bytes(damaged), "motion.npz")
    for length in range(0, len(whole), 61):
        with pytest.raises(ValueError, match=r"is damaged|holds no motion"):
            record_in(whole[:length], "motion.npz")
    path.write_bytes(whole + b"0")
    with pytest.raises(ValueError, match="is damaged"):
        load_motion(path)


def rewritten(path, change):
    """Change a file's meaning, as somebody might who also sets its checksum right."""
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    meaning = json.loads(arrays["meaning"].tobytes())
    change(meaning, arrays)
    arrays["meaning"] = np.frombuffer(json.dumps(meaning).encode(), dtype=np.uint8)
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    with zipfile.ZipFile(stream, "a") as archive:
        archive.comment = b"0" * 64
    content = stream.getvalue()[:-64]
    path.write_bytes(content + hashlib.sha256(content).hexdigest().encode())


class Burglar:
    def __reduce__(self):
        return (pytest.fail, ("a pickle was executed",))


@pytest.mark.parametrize(
    "change",
    [
        lambda _, arrays: arrays.update(array_0=np.array([Burglar()], dtype=object)),
        lambda meaning, _: meaning["objects"].append(["Popen", {"args": "true"}]),
        lambda meaning, _: meaning.update(record={"eval": "1 + 1"}),
        lambda meaning, _: meaning.update(record={"expression": [["system", "true"]]}),
        lambda meaning, _: meaning.update(record=7),
        lambda meaning, _: meaning.pop("symbols"),
        lambda meaning, _: meaning["objects"][0][1]["nodes"].append(["sin", 10**6]),
        lambda meaning, _: meaning["objects"][0][1]["nodes"].append(["__import__", 0]),
    ],
)
def test_what_canon_has_not_written_is_refused_and_never_executed(change, tmp_path):
    path = tmp_path / "motion.npz"
    propagate(PENDULUM, (0, 4), [1.0, 0.0], samples=2, **VERLET).save(path)
    rewritten(path, lambda meaning, arrays: None)
    assert load_motion(path).t[-1] == 4
    rewritten(path, change)
    with pytest.raises(ValueError, match="holds no motion that canon has written"):
        load_motion(path)


def test_another_format_is_named(tmp_path, monkeypatch):
    path = tmp_path / "motion.npz"
    monkeypatch.setattr(record_file, "_FORMAT", 2)
    propagate(PENDULUM, (0, 4), [1.0, 0.0], samples=2, **VERLET).save(path)
    monkeypatch.undo()
    with pytest.raises(ValueError, match=r"has format 2.* reads format 1"):
        load_motion(path)


def test_no_motion_at_all(tmp_path):
    path = tmp_path / "motion.txt"
    path.write_text("t x\n0 1\n")
    with pytest.raises(ValueError, match="holds no motion"):
        load_motion(path)
    with pytest.raises(FileNotFoundError):
        load_motion(tmp_path / "nowhere.npz")


def test_what_can_not_be_kept_exactly_says_so(tmp_path):
    path = tmp_path / "motion.npz"
    with pytest.raises(ValueError, match=r"dense=True .*times="):
        propagate(PENDULUM, (0, 4), [1.0, 0.0], dense=True).save(path)

    class Own(sp.Symbol):
        pass

    z = Own("z", real=True)
    falling = Hamiltonian(x.momentum**2 / 2 + z * x, [x], [x.momentum])
    motion = propagate(falling, (0, 1), [1.0, 0.0], parameters={"z": 2}, events=[Event(x - z)])
    with pytest.raises(ValueError, match="z is a Own, a class of symbols that files do not know"):
        motion.save(path)
    assert not list(tmp_path.iterdir())


def test_a_file_is_replaced_as_a_whole(tmp_path):
    path = tmp_path / "motion.npz"
    for end in (4, 8):
        propagate(PENDULUM, (0, end), [1.0, 0.0], samples=2, **VERLET).save(path)
    assert load_motion(path).t[-1] == 8
    assert [each.name for each in tmp_path.iterdir()] == ["motion.npz"]


def test_numbers_of_64_bits_are_kept_as_sums_of_two_doubles_or_not_at_all():
    fine = 1 + np.longdouble(2) ** -60
    writer = _Writer()
    (high, low) = (writer.arrays[each["array"]] for each in writer.of(np.array([fine]))["sum"])
    assert np.longdouble(high[0]) + np.longdouble(low[0]) == fine
    for power in (-400, 400):
        with pytest.raises(ValueError, match="beyond the range of doubles"):
            writer.of(np.array([np.longdouble(10) ** power]))


def test_a_file_of_canon_before_sums_over_rows_is_read():
    """It was written by commit 4ad42462: verlet, step 0.1, until t = 10, with q² as observable."""
    before = load_motion(Path(__file__).parents[1] / "data/motions/pendulum_2026_11_26.npz")
    q, p = sp.symbols("q p", real=True)
    how = {"method": Splitting("verlet"), "step": 0.1, "observables": {"square": q**2}}
    now = propagate(Hamiltonian(p**2 / 2 - sp.cos(q), q, p), (0, 10), [1, 0], samples=5, **how)
    for one, other in ((before, now), (before.resume(until=20), now.resume(until=20))):
        assert np.array_equal(one.y, other.y)
        assert np.array_equal(one.energy_change, other.energy_change)
        assert np.array_equal(one.observables["square"], other.observables["square"])
