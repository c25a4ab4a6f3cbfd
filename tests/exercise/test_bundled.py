"""The sheet that comes with canon: the example copy is the same, and its verdicts are the expected ones."""

from pathlib import Path

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import bundled_sheet
from canon.exercise.sheet_check import check

EXAMPLE = Path(__file__).parents[2] / "examples" / "sheets" / "tour.toml"


def test_the_example_is_the_bundled_sheet():
    import canon.exercise

    bundled = Path(canon.exercise.__file__).parent / "sheets" / "tour.toml"
    assert EXAMPLE.read_text("utf-8") == bundled.read_text("utf-8")


def test_verdicts_in_this_process_and_in_the_worker_agree():
    sheet = bundled_sheet()
    assert not sheet.errors
    report = check(sheet, jobs=2)
    assert report.unexpected == ()
    assert [j.status for j in report.judgements] == [judge(c).status.value for c in sheet.claims]
    assert report.exit_status == 1
    assert all(j.seconds < c.budget for j, c in zip(report.judgements, sheet.claims, strict=True))
    assert "13 claims: 8 holds, 5 fails" in str(report)
    assert len(report.json_lines().splitlines()) == 13
