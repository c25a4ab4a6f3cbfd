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
