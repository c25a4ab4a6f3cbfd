"""Write the map of the rooms into docs/architecture.md.

First a picture of each room's inside, drawn from the import contracts in pyproject.toml, which lint-imports holds; then
every module with the first line of its docstring.
"""

import ast
import tomllib
from pathlib import Path

DOCS = Path(__file__).parent
PACKAGE = DOCS.parent / "canon"
PAGE = DOCS / "architecture.md"
BEGIN, END = "<!-- rooms: written by docs/rooms.py -->\n", "<!-- end of rooms -->\n"
ORDER = (
    "expression", "proof", "mechanics", "kernel", "flow", "scene", "study", "exercise", "plot", "serve", "command",
)  # fmt: skip


def first_line(module: Path) -> str:
    text = (
        ast.get_docstring(ast.parse(module.read_text(encoding="utf-8"))) or f"{module.name} has no docstring"
    )
    return text.splitlines()[0].rstrip(".").replace("``", "`").replace("|", r"\|")


def floors(room: str) -> list[list[str]]:
    """The places of a room, those that may import the others first."""
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = (c["layers"] for c in contracts if c["name"].startswith(f"Inside {room}:"))
    return [[place.strip().rpartition(".")[2] for place in floor.split("|")] for floor in layers]


def picture() -> str:
    """Each room as a chain: what stands on the left is imported by what stands to its right."""
    width = max(map(len, ORDER))
    chains = (" ← ".join(" · ".join(floor) for floor in reversed(floors(room))) for room in ORDER)
    return "\n".join(f"{room:{width}}  {chain}" for room, chain in zip(ORDER, chains, strict=True))


def table(folder: Path) -> list[str]:
    modules = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
    if not modules:
        return []
    rows = [f"| `{path.name}` | {first_line(path)} |" for path in modules]
    return ["| module | subject |", "|---|---|", *rows, ""]


def rooms() -> str:
    lines = ["```", picture(), "```", ""]
    for room in ORDER:
        folder = PACKAGE / room
        lines += [f"### {room}", "", f"{first_line(folder / '__init__.py')}.".replace("?.", "?"), ""]
        lines += table(folder)
        for place in sorted(path.parent for path in folder.glob("*/**/__init__.py")):
            lines += [
                f"#### {place.relative_to(PACKAGE).as_posix()}",
                "",
                f"{first_line(place / '__init__.py')}.",
                "",
                *table(place),
            ]
    return "\n".join(lines)


def with_rooms(page: str) -> str:
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{rooms()}\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(with_rooms(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
