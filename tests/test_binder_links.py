"""Links to Binder: under the title of tutorials, where the build knows a public repository."""

import runpy
from pathlib import Path

BINDER = runpy.run_path(str(Path(__file__).parents[1] / "docs" / "binder.py"))
TUTORIALS = sorted((Path(__file__).parents[1] / "docs" / "tutorials").glob("*.md"))


def test_every_tutorial_gets_its_link_once_and_under_its_title():
    assert len(TUTORIALS) >= 10
    for tutorial in TUTORIALS:
        source = tutorial.read_text("utf-8")
        page = f"tutorials/{tutorial.stem}"
        linked = BINDER["with_a_link"](page, source, "someone/canon")
        title, _, link, *_ = linked[linked.index("\n# ") + 1 :].split("\n")
        assert title.startswith("# ")
        assert link.endswith(
            f"(https://mybinder.org/v2/gh/someone/canon/HEAD?urlpath=lab/tree/docs/{page}.md)"
        )
        assert linked.replace(f"\n\n{link}", "", 1) == source
        assert BINDER["with_a_link"](page, source, "") == source


def test_the_repository_is_what_the_build_says():
    said = {"READTHEDOCS_GIT_CLONE_URL": "git@github.com:someone/canon.git"}
    assert BINDER["repository"](said) == "someone/canon"
    assert BINDER["repository"]({**said, "GITHUB_REPOSITORY": "other/canon"}) == "other/canon"
    assert BINDER["repository"]({"READTHEDOCS_GIT_CLONE_URL": "https://example.org/canon.git"}) == ""
