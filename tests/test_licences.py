"""The table of licences: it names all that pyproject.toml requires, and no package without a licence."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HOME = Path(__file__).parents[1]
PAGE = (HOME / "docs" / "licences.md").read_text("utf-8")
PROJECT = tomllib.loads((HOME / "pyproject.toml").read_text("utf-8"))["project"]
ROWS = dict(re.findall(r"^\| (\S+) \| [^|]+ \| (.+) \|$", PAGE, re.MULTILINE))
TOOLS = ("dev", "docs")


def required():
    extras = PROJECT["optional-dependencies"]
    lines = [*PROJECT["dependencies"], *(line for e in extras if e not in TOOLS for line in extras[e])]
    return {canonicalize_name(Requirement(line).name) for line in lines}


def test_every_dependency_has_its_licence():
    assert required() <= set(ROWS), f"run python docs/licences.py: {sorted(required() - set(ROWS))}"
    assert all(
        re.search(r"MIT|BSD|Apache|MPL|PSF|Python Software|see its", ROWS[name]) for name in required()
    )


def test_the_page_is_what_its_script_says_of_its_head():
    script = (HOME / "docs" / "licences.py").read_text("utf-8")
    assert PAGE.split("| package |")[0] in script.replace("\\\n", "")
