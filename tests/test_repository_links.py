"""Links between the pages of the repository lead to what is tracked, and built to the pages that are made of it."""

import os
import re
import runpy
import subprocess
from pathlib import Path

import pytest

HOME = Path(__file__).parents[1]
LINKS = runpy.run_path(str(HOME / "docs" / "built_links.py"))


def tracked():
    """The files of the repository; of a source archive all of them, as nothing else is in it."""
    if not (HOME / ".git").exists():
        return {path.relative_to(HOME) for path in HOME.rglob("*") if path.is_file()}
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=HOME, check=True, capture_output=True, text=True)
    return {Path(name) for name in listed.stdout.split("\0") if name}


TRACKED = tracked()
FOLDERS = {folder for path in TRACKED for folder in path.parents}
PAGES = sorted(path for path in TRACKED if path.suffix == ".md")
GENERATED = {"gallery/index", "reference/api.md", "reference/command_line.md"}


def prose(page):
    """The text of a page without its blocks of code."""
    return re.sub(r"^(`{3,}).*?^\1", "", (HOME / page).read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)


def links(page):
    """Where a page links to within the repository, with the anchor there."""
    inline = re.sub(r"(?<!`)(`+)(?!`).*?(?<!`)\1(?!`)", "code", prose(page))
    return re.findall(r"\]\((?!\w+:)([^)\s#]*)#?([^)\s]*)\)", inline)


def anchors(page):
    """The anchors of a page's headings, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ +(.+?) *$", prose(page), re.MULTILINE)
    shown = (re.sub(r"\[(.*?)\]\(.*?\)|[`*]", r"\1", heading) for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in shown}


def place(page, target):
    return Path(os.path.normpath(page.parent / target)) if target else page


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_a_link_leads_to_what_is_tracked(page):
    wrong = [target for target, _ in links(page) if place(page, target) not in TRACKED | FOLDERS]
    assert wrong == []
    there = [(place(page, target), anchor) for target, anchor in links(page) if anchor]
    assert [each for each in there if each[0].suffix == ".md" and each[1] not in anchors(each[0])] == []


@pytest.mark.parametrize("page", [page for page in PAGES if page.parts[0] == "docs"], ids=str)
def test_built_a_link_leads_to_a_page_or_to_a_file_that_is_there(page):
    """Of a script, the public names and the commands a page is made; whatever else is linked stays what it is."""
    name = page.relative_to("docs").with_suffix("").as_posix()
    before, after = (re.findall(r"\]\(([^)\s#]*)", text) for text in both(page, name))
    assert len(before) == len(after)
    for source, built in zip(before, after, strict=True):
        made = place(Path(name), built).as_posix()
        script = made.replace("gallery/", "examples/") + ".py"
        assert built == source or made in GENERATED or Path(script) in TRACKED


def both(page, name):
    text = (HOME / page).read_text("utf-8")
    return text, LINKS["with_built_links"](name, text)


def test_the_first_page_leads_to_examples_names_and_commands_here_and_built():
    _, built = both(Path("docs/index.md"), "index")
    assert all(f"]({page})" in built for page in GENERATED)
    assert not any(Path("docs", page) in TRACKED for page in GENERATED)
    assert {Path("examples"), Path("canon/__init__.pyi"), Path("canon/cli.py")} <= {
        place(Path("docs/index.md"), target) for target, _ in links(Path("docs/index.md"))
    }


@pytest.mark.parametrize(
    ("page", "source", "built"),
    [
        ("explanation/symplectic", "[a](../../examples/explore/x.py)", "[a](../gallery/explore/x)"),
        ("tutorials/9", "[a](../../canon/mechanics/__init__.pyi)", "[a](../reference/api.md)"),
        ("reference/x", "[a](../../canon/cli.py)", "[a](command_line.md)"),
        ("howto/grade", "[a](../../examples/grading/x.py)", "[a](../../examples/grading/x.py)"),
        ("index", "[a](../README.md)", "[a](../README.md)"),
    ],
)
def test_only_links_to_what_a_page_is_made_of_are_led_elsewhere(page, source, built):
    assert LINKS["with_built_links"](page, source) == built
