"""Tables of a study read back exactly, in every format."""

from __future__ import annotations

import csv
import io
import json
import math
import sys

import numpy as np
import pyarrow.parquet
import pytest
import xarray

from canon import RK4, Splitting, Taylor
from canon.study.cases.case import Case, key_of
from canon.study.cases.export import ExportError, csv_of, dataset_of, rows_of, write_netcdf, write_parquet
from canon.study.cases.result import State, results_of
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study

STUDY = Study.of(
    system="simple-pendulum",
    start=["small", [2.0, 0.0]],
    parameters={"l": [1.0, 2.0]},
    method=[Splitting("verlet"), Taylor()],
    step=0.05,
    span=100.0,
    samples=512,
)


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Eight finished cases, one that failed, one that is pending."""
    store = Store(tmp_path_factory.mktemp("export") / "study.sqlite")
    run_study(STUDY, store)
    run_study(Study.of(system="double-pendulum", method="verlet", step=0.1, span=50.0), store)
    later = Case("kepler", RK4(), span=50.0, step=0.05, parts=4)
    store.add_cases({key_of(later): json.dumps(later.to_dict())})
    store.save_checkpoint(key_of(later), 1, "…")
    return store


def test_results_say_what_became_of_each_case(store):
    results = results_of(store)
    assert [result.state for result in results] == [State.FINISHED] * 8 + [State.FAILED, State.PENDING]
    assert [result.case for result in results[:8]] == list(STUDY.cases)
    assert results[0].motion == "simple-pendulum; l = 1; from small"
    assert results[0].setting == "verlet, h = 0.05"
    assert len({(result.motion, result.setting) for result in results}) == 10
    assert (results[8].done, results[9].done) == (1.0, 0.25)
    assert "does not split" in results[8].failure


def test_csv_holds_every_case_exactly(store):
    lines, rows = list(csv.DictReader(io.StringIO(csv_of(store)))), rows_of(store)
    assert len(lines) == 10
    for line, row in zip(lines, rows, strict=True):
        assert line["key"] == row["key"]
        assert Case.from_dict(json.loads(line["inputs"])) == Case.from_dict(json.loads(row["inputs"]))
        if row["state"] == "finished":
            assert float(line["slope"]) == row["slope"]
            assert float(line["parameter l"]) in (1.0, 2.0)
            assert json.loads(line["final"]) == row["final"]
        else:
            assert line.get("bound") == ""
    assert lines[-1]["seconds"] == ""


def test_parquet_holds_every_case_with_types(store, tmp_path):
    write_parquet(store, tmp_path / "study.parquet")
    table = pyarrow.parquet.read_table(tmp_path / "study.parquet")
    rows = rows_of(store)
    assert table.num_rows == 10
    for name in table.column_names:
        assert table.column(name).to_pylist() == [row.get(name) for row in rows]
    kinds = {field.name: str(field.type) for field in table.schema}
    assert (kinds["bound"], kinds["steps"], kinds["state"]) == ("double", "int64", "string")
    assert kinds["final"].startswith("list")
    assert (kinds["relative"], kinds["parameter l"]) == ("bool", "double")


def test_netcdf_holds_numbers_means_and_curves(store, tmp_path):
    write_netcdf(store, tmp_path / "study.nc")
    results = results_of(store)
    with xarray.open_dataset(tmp_path / "study.nc", engine="scipy") as found:
        assert dict(found.sizes)["case"] == 10
        assert [str(state) for state in found["state"].values] == [each.state.value for each in results]
        for k, each in enumerate(results):
            bound = float(found["bound"][k])
            if each.state is State.FINISHED:
                assert bound == each.numbers["bound"]
                assert found["means_mean"][k].values.tolist() == each.numbers["means"]["mean"]
                curve = found["curve_largest"][k].values
                assert curve[np.isfinite(curve)].tolist() == each.numbers["curve"]["largest"]
            else:
                assert math.isnan(bound)
        assert "does not split" in str(found["failure"].values[8])
        by_length = found["bound"].groupby("parameter_l").max()
        largest = max(each.numbers["bound"] for each in results[:8] if dict(each.case.parameters)["l"] == 2.0)
        assert float(by_length.sel(parameter_l=2.0)) == largest


def test_an_empty_study_is_an_empty_table(tmp_path):
    empty = Store(tmp_path / "empty.sqlite")
    assert csv_of(empty) == "\n"
    assert dict(dataset_of(empty).sizes).get("case", 0) == 0


@pytest.mark.parametrize(("write", "library"), [(write_parquet, "pyarrow"), (write_netcdf, "xarray")])
def test_a_missing_library_says_what_to_install(store, tmp_path, monkeypatch, write, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ExportError, match=rf"needs {library}: pip install canon-mechanics\[export\]"):
        write(store, tmp_path / "study")
    assert not (tmp_path / "study").exists()
