"""What is kept as datasets: lazily, the same numbers as case by case, and in NetCDF files."""

from __future__ import annotations

import shutil
import sys

import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st

from canon import Study, results_of, run_study
from canon.cli import main
from canon.study import DamagedChunk, ExportError, StudyError
from canon.study.cases import export
from canon.study.cases.export import write_kept
from canon.study.kept.chunk_file import Chunk, ChunkFolder
from canon.study.kept.kept_arrays import Kept
from canon.study.kept.kept_dataset import SideBySide

STUDY = Study.of(
    system=["henon-heiles", "simple-pendulum"], method=["verlet", "taylor"], step=0.1, span=40.0, samples=300,
    parts=3, keep="motion", tags="kept",
)  # fmt: skip


def corner(motion):
    return motion.y[:2, :3]


def ragged(motion):
    return {"crossings": motion["t"][np.flatnonzero(np.diff(np.sign(motion.y[0])))], "one": 1.5}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("dataset") / "study.sqlite"
    run_study(STUDY, path, keep={"corner": corner, "ragged": ragged})
    run_study(Study.of(system="double-pendulum", method="verlet", step=0.1, span=50.0), path)
    return path


def test_a_dataset_has_the_numbers_of_every_case(path):
    results = results_of(path)
    for name in ("motion", "corner", "ragged"):
        dataset = results.to_xarray(name)
        assert dataset.sizes["case"] == 5
        for number, result in enumerate(results):
            found = result.kept.get(name, {})
            arrays = found if isinstance(found, dict) else {name: found}
            for variable, whole in dataset.data_vars.items():
                part = whole[number].values
                if variable not in arrays:
                    assert np.isnan(part).all(), "a case that is not finished has no numbers"
                    continue
                own = arrays[variable]
                np.testing.assert_array_equal(part[tuple(map(slice, own.shape))], own)
                assert np.isnan(part).sum() == part.size - own.size


def test_its_coordinates_are_the_inputs(path):
    motions = results_of(path).where(system="simple-pendulum").to_xarray("motion")
    assert set(motions.data_vars) == {"t", "theta", "p_theta", "energy_change"}
    assert motions.method.values.tolist() == ["verlet", "Taylor"]
    assert motions.tags.values.tolist() == ["kept"] * 2
    assert motions.isel(case=0).step == 0.1


def test_only_what_is_used_is_read(tmp_path, path, monkeypatch):
    read, whole = [], ChunkFolder.content
    monkeypatch.setattr(
        ChunkFolder, "content", lambda self, chunk: read.append(chunk.key) or whole(self, chunk)
    )
    results = results_of(path)
    motions = results.to_xarray("motion")
    repr(motions)
    slow = motions.x.isel(sample=slice(0, 300, 7))
    assert read == []
    slow[1].values.sum()
    assert read == [results[1].key]
    chunked = motions.chunk(case=1)
    mean = chunked.x[:2].mean("sample")
    assert len(read) == 1
    np.testing.assert_array_equal(mean.values, [result.kept["motion"]["x"].mean() for result in results[:2]])
    assert set(read) == {results[0].key, results[1].key}


def test_damage_is_told_on_reading(tmp_path, path):
    shutil.copy(path, tmp_path / "study.sqlite")
    shutil.copytree(ChunkFolder(path).path, ChunkFolder(tmp_path / "study.sqlite").path)
    results = results_of(tmp_path / "study.sqlite")
    motions = results.to_xarray("motion")
    file = ChunkFolder(tmp_path / "study.sqlite").path / results[0].kept.chunk.file_name
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 1
    file.write_bytes(content)
    with pytest.raises(DamagedChunk):
        motions.x.load()
    assert np.isfinite(motions.x[1].values).all()
    with pytest.raises(DamagedChunk):
        write_kept(results, "motion", tmp_path / "motion.nc")


def test_a_netcdf_file_has_all_of_it(tmp_path, path, capsys):
    file = tmp_path / "motion.nc"
    assert main(["study", "export", str(path), str(file), "--kept", "motion", "--tag", "kept"]) == 0
    assert capsys.readouterr().out == f"NetCDF: {file}\n"
    with xarray.open_dataset(file, engine="scipy") as written:
        expected = results_of(path).where(tag="kept").to_xarray("motion")
        for name in expected.data_vars:
            np.testing.assert_array_equal(written[name].values, expected[name].values)
        assert written.method.values.tolist() == expected.method.values.tolist()


def test_what_can_not_be_written_is_said(tmp_path, path, capsys, monkeypatch):
    assert main(["study", "export", str(path), str(tmp_path / "a.nc"), "--kept", "orbit"]) == 2
    assert (
        "no 'orbit' was kept of any of the cases; there is motion, corner, ragged" in capsys.readouterr().err
    )
    assert main(["study", "export", str(path), str(tmp_path / "a.csv"), "--kept", "motion"]) == 2
    assert "what is kept is written as NetCDF" in capsys.readouterr().err
    monkeypatch.setattr(export, "LARGEST_VARIABLE", 100)
    with pytest.raises(StudyError, match="write fewer cases a file, by their tags"):
        write_kept(results_of(path), "motion", tmp_path / "a.nc")
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ExportError, match=r"canon-mechanics\[export\]"):
        write_kept(results_of(path), "motion", tmp_path / "a.nc")
    assert list(tmp_path.iterdir()) == []


def test_arrays_of_other_dimensions_are_not_put_side_by_side(tmp_path):
    folder = ChunkFolder(tmp_path / "s.sqlite")
    kept = tuple(Kept(folder, Chunk.of("k", {"a": np.zeros(shape)})[0]) for shape in ((2,), (2, 2)))
    with pytest.raises(ValueError, match="a has 1 and 2 dimensions in different cases"):
        _ = SideBySide(kept, "a").shape


INDEX = st.one_of(
    st.integers(0, 2),
    st.slices(3),
    st.lists(st.integers(0, 2), min_size=1, max_size=4).map(np.array),
)


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Arrays of three cases in files, and the same as one array."""
    folder = ChunkFolder(tmp_path_factory.mktemp("parts") / "parts.sqlite")
    kept, whole = [], np.full((3, 3, 3), np.nan)
    for number, shape in enumerate(((3, 1), (2, 3), (1, 2))):
        array = np.arange(float(np.prod(shape))).reshape(shape) + 10 * number
        chunk, content = Chunk.of(str(number), {"a": array})
        folder.write(chunk, content)
        kept.append(Kept(folder, chunk))
        whole[number, : shape[0], : shape[1]] = array
    return SideBySide(tuple(kept), "a"), whole


@given(st.tuples(INDEX, INDEX, INDEX))
def test_a_part_is_the_part_of_the_whole(parts, key):
    """Second route: NumPy's own array, an axis at a time."""
    found, whole = parts
    for axis in (2, 1, 0):
        whole = whole[(slice(None),) * axis + (key[axis],)]
    np.testing.assert_array_equal(found[key], whole)
