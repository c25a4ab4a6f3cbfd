"""Write the map of the rooms into docs/architecture.md: every module with the first line of its docstring."""

import ast
from pathlib import Path

DOCS = Path(__file__).parent
PACKAGE = DOCS.parent / "canon"
PAGE = DOCS / "architecture.md"
BEGIN, END = "<!-- rooms: written by docs/rooms.py -->\n", "<!-- end of rooms -->\n"
ORDER = (
    "expression", "proof", "mechanics", "kernel", "flow", "scene", "study", "exercise", "plot", "command",
)  # fmt: skip


def first_line(module: Path) -> str:
    text = (
        ast.get_docstring(ast.parse(module.read_text(encoding="utf-8"))) or f"{module.name} has no docstring"
    )
    return text.splitlines()[0].rstrip(".").replace("``", "`").replace("|", r"\|")


def rooms() -> str:
    lines: list[str] = []
    for room in ORDER:
        folder = PACKAGE / room
        lines += [f"### {room}", "", f"{first_line(folder / '__init__.py')}.".replace("?.", "?"), ""]
        lines += ["| module | subject |", "|---|---|"]
        modules = sorted(path for path in folder.glob("*.py") if path.name != "__init__.py")
        lines += [f"| `{path.name}` | {first_line(path)} |" for path in modules]
        lines.append("")
    return "\n".join(lines)


def with_rooms(page: str) -> str:
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n{rooms()}\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(with_rooms(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
