"""What a project needs beside its code: workflows, recipes and templates say what pyproject.toml says."""

import os
import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement

import canon

HOME = Path(__file__).parents[1]
PROJECT = tomllib.loads((HOME / "pyproject.toml").read_text("utf-8"))["project"]
GITHUB = HOME / ".github"
CONDA_NAMES = {"heyoka": "heyoka.py", "matplotlib": "matplotlib-base"}
TOOLS_OF_LINUX_ONLY = {"basedpyright", "complexipy", "import-linter", "ruff", "selenium"}

if not GITHUB.exists():  # the source archive leaves it out
    pytest.skip("no checkout: nothing to compare", allow_module_level=True)


def read(path):
    return yaml.safe_load((HOME / path).read_text("utf-8"))


def bounds(lines):
    """Return the lower bound of each package, as conda names it; canon's own extras aside."""
    found = {}
    for requirement in map(Requirement, lines):
        if requirement.name != PROJECT["name"]:
            name = CONDA_NAMES.get(requirement.name, requirement.name)
            found[name] = str(requirement.specifier)
    return found


def conda_bounds(lines):
    words = (re.fullmatch(r"([\w.-]+) ?(>=[\d.]+)?", line) for line in lines)
    return {word[1]: word[2] for word in words if word}


def pythons():
    return {c.rpartition(" ")[2] for c in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", c)}


def test_the_environment_for_conda_has_what_pyproject_asks_for():
    extras = PROJECT["optional-dependencies"]
    wanted = bounds([*PROJECT["dependencies"], *(line for e in extras if e != "docs" for line in extras[e])])
    given = conda_bounds(read(".github/environment.yml")["dependencies"])
    assert {name: given.get(name) for name in wanted.keys() - TOOLS_OF_LINUX_ONLY} == {
        name: bound for name, bound in wanted.items() if name not in TOOLS_OF_LINUX_ONLY
    }


def test_the_recipe_for_conda_asks_for_what_the_wheel_does():
    recipe = read(".github/conda/recipe.yaml")
    given = conda_bounds(recipe["requirements"]["run"])
    assert given == bounds(PROJECT["dependencies"])
    assert recipe["context"]["version"] == canon.__version__
    assert f">={recipe['context']['python_min']}" == PROJECT["requires-python"]
    (entry,) = recipe["build"]["python"]["entry_points"]
    assert entry == f"canon = {PROJECT['scripts']['canon']}"


def test_macos_and_windows_run_the_tests_with_every_python():
    matrix = read(".github/workflows/elsewhere.yml")["jobs"]["tests"]["strategy"]["matrix"]
    assert {name.partition("-")[0] for name in matrix["os"]} == {"macos", "windows"}
    assert set(matrix["python"]) == pythons()


def test_what_workflows_call_exists_and_can_be_run():
    called = set()
    for path in (GITHUB / "workflows").glob("*.yml"):
        for job in yaml.safe_load(path.read_text("utf-8"))["jobs"].values():
            called |= {
                step["run"].split()[0] for step in job["steps"] if step.get("run", "").startswith(".ci/")
            }
    assert {".ci/run", ".ci/wheel", ".ci/oldest", ".ci/pythons", ".ci/build"} == called
    assert all(os.access(HOME / name, os.X_OK) for name in called)


def test_only_the_step_that_publishes_has_a_right_beyond_reading():
    """And it keeps no password: trusted publishing is an identity token."""
    rights = {}
    for path in (GITHUB / "workflows").glob("*.yml"):
        workflow = yaml.safe_load(path.read_text("utf-8"))
        assert workflow["permissions"] == {"contents": "read"}, path.name
        rights |= {
            (path.stem, n): j["permissions"] for n, j in workflow["jobs"].items() if "permissions" in j
        }
        assert "secrets." not in path.read_text("utf-8")
    assert rights == {("release", "publish"): {"id-token": "write"}}


def test_read_the_docs_builds_the_pages_as_the_readme_does():
    settings = read(".readthedocs.yaml")
    assert (HOME / settings["sphinx"]["configuration"]).exists()
    assert settings["sphinx"]["fail_on_warning"] is True
    (installed,) = settings["python"]["install"]
    assert set(installed["extra_requirements"]) <= set(PROJECT["optional-dependencies"])
    assert settings["build"]["tools"]["python"] in pythons()


def test_issue_forms_ask_each_thing_once_and_for_the_version():
    forms = [path for path in (GITHUB / "ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml"]
    assert len(forms) == 3
    for path in forms:
        form = yaml.safe_load(path.read_text("utf-8"))
        fields = [each for each in form["body"] if each["type"] != "markdown"]
        assert form["name"]
        assert form["description"]
        assert len({each["id"] for each in fields}) == len(fields)
        assert path.stem == "wish" or "version" in {each["id"] for each in fields}


def test_no_link_of_the_project_files_leads_nowhere():
    for path in GITHUB.glob("*.md"):
        for target in re.findall(r"\]\((?!http)([^)#]+)", path.read_text("utf-8")):
            assert (path.parent / target).exists(), f"{path.name}: {target}"


def test_the_citation_names_this_version():
    assert str(read("CITATION.cff")["version"]) == canon.__version__


PAPER = (HOME / "docs" / "paper" / "paper.md").read_text("utf-8")
REFERENCES = (HOME / "docs" / "paper" / "paper.bib").read_text("utf-8")


def test_the_paper_cites_what_its_bibliography_has_and_nothing_else():
    cited = set(re.findall(r"@([a-z]+\d*)", PAPER))
    assert cited == set(re.findall(r"^@\w+\{(\w+),", REFERENCES, re.MULTILINE))
    entries = re.split(r"^@", REFERENCES, flags=re.MULTILINE)[1:]
    assert all(re.search(r"\b(doi|isbn|publisher) = ", entry) for entry in entries)


def test_the_paper_has_the_sections_and_the_length_that_its_journal_asks_for():
    """https://joss.readthedocs.io, as read in November 2026: 750 to 1750 words."""
    sections = re.findall(r"^# (.+)$", PAPER, re.MULTILINE)
    assert sections == [
        "Summary", "Statement of need", "State of the field", "Software design", "Research impact statement",
        "AI usage disclosure", "Acknowledgements", "References",
    ]  # fmt: skip
    assert 750 < len(PAPER.rpartition("---")[2].split()) < 1750
    for figure in re.findall(r"!\[.*?\]\((.+?)\)", PAPER):
        assert (HOME / "docs" / "paper" / figure).exists()


def test_the_numbers_of_the_paper_are_those_that_were_measured():
    measured = (HOME / "docs" / "measured.md").read_text("utf-8")
    identities = re.search(r"^(\d+) identities, (\d+) true and (\d+) false", measured, re.MULTILINE)
    proved = re.search(r"^canon +(\d+)/\d+ +(\d+)/\d+ +(\d+) +(\d+) +", measured, re.MULTILINE)
    told = (
        f"of {identities[1]} identities, {identities[2]} of them true, canon proves {proved[1]}, refutes all "
        f"{proved[2]} false ones, and is wrong about none; {proved[4]} stay undecided"
    )
    assert proved[3] == "0"
    assert told in " ".join(PAPER.split())
    seeds = (HOME / "docs" / "seeds.md").read_text("utf-8")
    judged = re.search(
        r"^(\d+) entries; (\d+) of them .* in (\d+) claims: \d+ holds, (\d+) fails", seeds, re.MULTILINE
    )
    assert f"{judged[2]} of {judged[1]} entries" in " ".join(PAPER.split())
    assert f"in {judged[3]} claims; {judged[4]} of these fail" in " ".join(PAPER.split())
