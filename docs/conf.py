"""Sphinx: every notebook is executed, every warning is an error, nothing is fetched.

Build with ``sphinx-build -W -b html docs docs/_build``. While you write, ``-D nb_execution_mode=cache`` executes only
the pages that changed.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

from binder import repository, with_a_link  # noqa: E402
from built_links import with_built_links  # noqa: E402
from fetch_inventories import mapping  # noqa: E402

from canon import __version__  # noqa: E402  (the checkout's canon, found through the line above)
from canon.cli import COMMANDS, main  # noqa: E402
from canon.doors import LINE  # noqa: E402


def homes(package: str) -> dict[str, str]:
    """Return the module of each public name of a package, as its stub says it."""
    stub = importlib.import_module(package).__file__ or ""
    text = Path(stub).with_suffix(".pyi").read_text(encoding="utf-8")
    return {name: f"{package}.{module}" for module, name in LINE.findall(text) if name != "__version__"}


FRONT_DOOR = homes("canon")
DOORS = ("mechanics", "flow", "study", "exercise", "expression", "proof", "serve")
"""Rooms with public names beyond the front door's."""
ROOM_DOORS = {name: module for room in DOORS for name, module in homes(f"canon.{room}").items()}

os.environ["COLUMNS"] = "100"  # what argparse wraps help to

project = "canon"
author = copyright = "The canon developers"  # noqa: A001  (Sphinx's own name)
version = release = __version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.intersphinx",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "jupyter_execute", "_templates", "README.md", "paper", "gallery/**.ipynb"]

nb_execution_mode = "force"  # a cached page would not know that canon has changed
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
nb_render_markdown_format = "myst"  # CommonMark, the default, has no tables: they stood there as pipes

JOBS = ("derive", "transform", "reduce", "judge", "integrate", "measure", "explore", "bring_your_own")
"""Folders of worked examples, in the order in which one would read them; the others hold sheets and graders."""
sphinx_gallery_conf = {
    "examples_dirs": ["../examples"],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"examples/(grading|sheets)/",
    "subsection_order": [f"../examples/{job}" for job in JOBS],
    "within_subsection_order": "FileNameSortKey",
    "default_thumb_file": str(HERE / "figures" / "verdict.png"),
    "capture_repr": (),  # what a script prints is its result
    "abort_on_example_error": True,
    "run_stale_examples": True,  # as the notebooks: canon may have changed
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
    "download_all_examples": False,
    "min_reported_time": 1e9,  # a time of this machine says nothing
}

autosummary_generate = True
templates_path = ["_templates"]  # a page a name: how it is imported, all its members
autosummary_context = {"at_the_front_door": {*FRONT_DOOR}, "at_a_room": {*ROOM_DOORS}}
autodoc_typehints = "signature"  # the numpydoc sections say it in words, the signatures in types
python_maximum_signature_line_length = 88
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

intersphinx_mapping = mapping()  # kept in the repository, so that a build needs no network

html_theme = "furo"
html_title = "canon"
html_static_path = ["_static"]
html_css_files = ["wide.css"]
html_favicon = "../canon/serve/page/icon.svg"
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

SUBJECTS = {
    "expression": "Writing mechanics",
    "proof": "Is it zero?",
    "mechanics": "Lagrange, Hamilton, Routh, Jacobi",
    "flow": "Methods and trajectories",
    "scene": "Scenes",
    "study": "Drift, cost and choice",
    "exercise": "Judging answers",
    "plot": "Pictures",
    "serve": "Over HTTP",
}

RETURNED = {
    "expression": (
        "expression.symbols.repeated_sum.RepeatedSum",
        "expression.symbols.symbol.Momentum",
        "expression.symbols.symbol.Rate",
        "expression.text.tokens.LanguageError",
        "expression.graph.sympy_conversion.NotModelledError",
    ),
    "mechanics": (
        "mechanics.algebra.constraint_manifold.Branch",
        "mechanics.algebra.constraint_manifold.EmptyDomainError",
        "mechanics.lagrange.dependence.DependentConstraintsError",
        "mechanics.canonical.generating_function.NoGeneratingFunctionError",
        "mechanics.canonical.generating_function.Rule",
        "mechanics.canonical.inverse.inverse_transformation.NoClosedInverseError",
        "mechanics.hamilton.legendre.LegendreError",
        "mechanics.algebra.linear.SingularMatrixError",
        "mechanics.canonical.parametric_generating_function.ParametricGeneratingFunction",
        "mechanics.lagrange.quasi_velocity.Kinematics",
        "mechanics.reduction.routh.Routhian",
        "mechanics.lagrange.sympy_bridge.QuasiMotion",
    ),
    "flow": (
        "flow.estimate.error_estimate.ErrorEstimate",
        "flow.equations.contact_regimes.ContactRegime",
        "flow.run.event.Crossing",
        "flow.geometry.flow_jacobian.FlowJacobian",
        "flow.geometry.flow_series.FlowSeries",
        "flow.method.solvable_splitting.SolvableSplitting",
        "flow.run_record.Energies",
        "flow.run.samples.Statistics",
        "flow.geometry.numeric_evidence.Witness",
        "kernel.solvable.kepler_terms.UnsolvableError",
        "kernel.schemes.splitting_schemes.Scheme",
    ),
    "scene": (
        "scene.parts.Condition",
        "scene.parts.Integral",
        "scene.parts.Parameter",
        "scene.parts.SceneError",
        "scene.parts.Solution",
        "scene.parts.Start",
    ),
    "study": (
        "study.energy_drift.block_means.Blocks",
        "study.cases.case.Case",
        "study.method_choice.candidate.Candidate",
        "study.method_choice.slow_times.Outlook",
        "study.energy_drift.drift_study.DriftStudy",
        "study.energy_drift.drift.Growth",
        "study.errors.StudyError",
        "study.cases.export.ExportError",
        "study.method_choice.work_precision.WorkPrecision",
        "study.method_choice.work_precision.WorkRow",
        "study.cases.result.Result",
        "study.cases.result.State",
        "study.cases.run_study.StudyStatus",
        "study.energy_drift.drift_rows.DriftRow",
        "study.cases.store_tables.StoreError",
    ),
    "exercise": ("exercise.sheet.sheet.ClaimError",),
}
"""What public names return and raise that is not itself at the front door."""


def public_names() -> str:
    """Return the page that lists every name of the front door, of scenes and of pictures, each with its own page."""
    by_room: dict[str, list[str]] = {}
    for name, module in {**ROOM_DOORS, **FRONT_DOOR}.items():
        by_room.setdefault(module.split(".")[1], []).append(f"{module}.{name}")
    for room, named in (
        ("scene", ("find", "names", "Scene")),
        ("plot", importlib.import_module("canon.plot").__all__),
    ):
        found = [getattr(importlib.import_module(f"canon.{room}"), name) for name in named]
        by_room[room] = [f"{each.__module__}.{each.__name__}" for each in found if callable(each)]
    lines = [
        "# Every public name",
        "",
        "Written when the pages are built, from the stubs `canon/__init__.pyi` and `canon/ROOM/__init__.pyi`. What",
        "most people need is imported from `canon`, as `from canon import propagate`; the rest from its room, as",
        "`from canon.flow import lyapunov_spectrum`; scenes and pictures from `canon.scene` and `canon.plot`. The page",
        "of each name begins with the line that imports it.",
        "",
    ]
    for room, names in sorted(by_room.items(), key=lambda item: list(SUBJECTS).index(item[0])):
        about = (importlib.import_module(f"canon.{room}").__doc__ or "").splitlines()[0]
        lines += [f"## {SUBJECTS[room]}", "", about, ""]
        lines += _listed(names)
        at_a_door = {*ROOM_DOORS, *FRONT_DOOR}
        others = [name for name in RETURNED.get(room, ()) if name.rpartition(".")[2] not in at_a_door]
        if others:
            lines += ["What these return and raise, imported from where it stands:", ""]
            lines += _listed([f"canon.{name}" for name in others])
    return "\n".join(lines)


def _listed(names: list[str]) -> list[str]:
    in_order = sorted(names, key=lambda name: name.rsplit(".", 1)[1].lower())
    lines = ["```{eval-rst}", ".. autosummary::", "   :toctree: generated", ""]
    return [*lines, *(f"   ~{name}" for name in in_order), "```", ""]


def command_line() -> str:
    """Return the page that shows what ``canon --help`` prints, and the help of every command and action."""
    lines = [
        "# The command line",
        "",
        "Written when the pages are built. `python -m canon` is the same as `canon`.",
        "",
    ]
    lines += _console("canon")
    for name in COMMANDS:
        lines += [f"## canon {name}", "", *_console(f"canon {name}")]
        for action in re.findall(r"^    (\w+)  +\S", help_of(name).partition("  action\n")[2], re.MULTILINE):
            lines += [f"### canon {name} {action}", "", *_console(f"canon {name} {action}")]
    return "\n".join(lines)


def help_of(*words: str) -> str:
    """Return what a command prints when asked for help."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
        main([*words, "--help"])
    return printed.getvalue().rstrip()


def _console(command: str) -> list[str]:
    return ["```console", f"$ {command} --help", help_of(*command.split()[1:]), "```", ""]


COLON = "\ue000"
"""Stands for a colon while napoleon reads properties: it takes what is before one for a type."""


def hide_colons(
    _app: object, what: str, _name: str, _object: object, _options: object, lines: list[str]
) -> None:
    """Hide the colons in the first paragraph of a property's description."""
    if what == "property":
        end = lines.index("") if "" in lines else len(lines)
        lines[:end] = [line.replace(":", COLON) for line in lines[:end]]


def show_colons(
    _app: object, what: str, _name: str, _object: object, _options: object, lines: list[str]
) -> None:
    """Put the colons back."""
    if what == "property":
        lines[:] = [line.replace(COLON, ":") for line in lines]


def link_to_binder(_: Sphinx, page: str, source: list[str]) -> None:
    """Put a link under a tutorial's title with which it is run on Binder, where the repository is public."""
    source[0] = with_a_link(page, source[0], repository())


def link_to_built_pages(_: Sphinx, page: str, source: list[str]) -> None:
    """Lead links to scripts, the public names and the commands to the pages that are made of them."""
    source[0] = with_built_links(page, source[0])


def setup(app: Sphinx) -> None:
    """Write the list of public names and the commands' help before Sphinx reads them."""
    app.connect("autodoc-process-docstring", hide_colons, priority=400)  # napoleon's is 500
    app.connect("autodoc-process-docstring", show_colons, priority=600)
    app.connect("source-read", link_to_binder)
    app.connect("source-read", link_to_built_pages)
    for name, text in (("api", public_names()), ("command_line", command_line())):
        page = HERE / "reference" / f"{name}.md"
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")
