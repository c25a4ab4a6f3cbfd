"""Mutants drawn by a seed: from every room as many as it has lines of canon, each at a place of its own."""

from __future__ import annotations

import ast
import random
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code

from mutants.operators import operators

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Mutant", "drawn", "is_there", "lines_of_rooms", "mutated_source", "room_of"]

_LEAST = 4
"""So many mutants has every room at least."""
_Place = tuple[int, int]
_CHANGED = {
    "operator",
    "number",
    "keyword",
    "comparison",
    "factor",
    "not_test",
    "if_stmt",
    "while_stmt",
    "assert_stmt",
    "test",
    "for_stmt",
    "return_stmt",
    "atom_expr",
    "subscript",
}
"""Types of the nodes that some operator changes; to ask every operator about every node takes minutes."""
_NEVER_CHANGED = frozenset("()[]{},.:;=") | {"->", ":="}


@dataclass(frozen=True)
class Mutant:
    """One change of one place: the file, the operator, and the lines before and after."""

    file: str
    line: int
    column: int
    operator: str
    occurrence: int
    before: str
    after: str

    @property
    def key(self) -> str:
        """What the mutant is called: it stays the same while lines above it come and go."""
        return f"{self.file}: {self.before} → {self.after}"


def room_of(file: str) -> str:
    """Return the room that a file of canon stands in."""
    parts = Path(file).parts
    return parts[1] if len(parts) > 2 else "top level"


def lines_of_rooms(home: Path) -> dict[str, dict[str, int]]:
    """Return the modules of each room, by their paths below ``home``, with their lines."""
    found: dict[str, dict[str, int]] = defaultdict(dict)
    for path in sorted((home / "canon").rglob("*.py")):
        file = path.relative_to(home).as_posix()
        found[room_of(file)][file] = path.read_text(encoding="utf-8").count("\n")
    return dict(sorted(found.items()))


def is_there(home: Path, mutant: Mutant) -> bool:
    """Tell whether the line that a mutant changes still stands in its module."""
    path = home / mutant.file
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return any(line.strip() == mutant.before for line in lines)


def mutated_source(home: Path, mutant: Mutant) -> str | None:
    """Return the whole source of a mutant's module; None where what it changes is no longer there.

    Lines above it may have come or gone since it was drawn.
    """
    path = home / mutant.file
    source = path.read_text(encoding="utf-8")
    lines = source.splitlines()
    found = _changed(source, mutant, mutant.line, mutant.occurrence)
    if found is not None:
        return found
    same = {k + 1 for k, line in enumerate(lines) if line.strip() == mutant.before}
    for (line, _), ways in _places(path).items():
        for operator, occurrence in ways if line in same else ():
            found = _changed(source, mutant, line, occurrence) if operator == mutant.operator else None
            if found is not None:
                return found
    return None


def _changed(source: str, mutant: Mutant, line: int, occurrence: int) -> str | None:
    """Return a changed module, where that is the mutant's change."""
    lines = source.splitlines()
    if line > len(lines) or lines[line - 1].strip() != mutant.before:
        return None
    whole = mutate_code(source, operators()[mutant.operator], occurrence)
    if whole is None or _after(lines, whole, line, mutant.operator, mutant.column) != mutant.after:
        return None
    return str(whole)


def _after(lines: list[str], whole: str, line: int, operator: str, column: int) -> str:
    """Return a line after its change, or what was done where the module has more lines or fewer since."""
    new = whole.splitlines()
    return new[line - 1].strip() if len(lines) == len(new) else f"{operator} at column {column}"


def drawn(home: Path, count: int, seed: int) -> list[Mutant]:
    """Return ``count`` mutants, or a few more, the same ones for the same sources and seed."""
    lines = lines_of_rooms(home)
    total = sum(sum(each.values()) for each in lines.values())
    found: list[Mutant] = []
    for room, files in lines.items():
        wanted = max(_LEAST, round(count * sum(files.values()) / total))
        found += _of_room(home, files, wanted, random.Random(f"{seed} {room}"))
    random.Random(seed).shuffle(found)
    return found


def _of_room(home: Path, lengths: dict[str, int], wanted: int, draw: random.Random) -> list[Mutant]:
    files, weights = list(lengths), list(lengths.values())
    taken: set[tuple[str, _Place]] = set()
    keys: set[str] = set()
    found: list[Mutant] = []
    while len(found) < wanted:
        (file,) = draw.choices(files, weights)
        places = _places(home / file)
        free = [place for place in places if (file, place) not in taken]
        if not free:
            continue
        place = draw.choice(free)
        taken.add((file, place))
        mutant = _mutant(home, file, place, *draw.choice(places[place]))
        if mutant is not None and mutant.key not in keys:
            keys.add(mutant.key)
            found.append(mutant)
    return found


def _mutant(home: Path, file: str, place: _Place, operator: str, occurrence: int) -> Mutant | None:
    """Return a mutant; None where the change is none, or no Python."""
    source = (home / file).read_text(encoding="utf-8")
    whole = mutate_code(source, operators()[operator], occurrence)
    try:
        if whole is None or ast.dump(ast.parse(whole)) == ast.dump(ast.parse(source)):
            return None
        compile(whole, file, "exec", dont_inherit=True)
    except SyntaxError:
        return None
    lines, (line, column) = source.splitlines(), place
    after = _after(lines, whole, line, operator, column)
    return Mutant(file, line, column, operator, occurrence, lines[line - 1].strip(), after)


@cache
def _places(path: Path) -> dict[_Place, list[tuple[str, int]]]:
    """Return the places of a module that can be changed, each with its operators and their occurrences."""
    source = path.read_text(encoding="utf-8")
    left_out = list(_left_out(source))
    found: dict[_Place, list[tuple[str, int]]] = defaultdict(list)
    tried = operators()
    count = dict.fromkeys(tried, 0)
    for node in ast_nodes(get_ast(source)):
        if node.type not in _CHANGED or (node.type == "operator" and node.value in _NEVER_CHANGED):
            continue
        for name, operator in tried.items():
            for start, _ in operator.mutation_positions(node):
                if not any(first <= start < end for first, end in left_out):
                    found[start].append((name, count[name]))
                count[name] += 1
    return dict(found)


def _left_out(source: str) -> Iterator[tuple[_Place, _Place]]:
    """Yield where nothing is changed: annotations, decorators, `__all__`, imports for types, errors raised."""
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        for part in _silent_parts(node):
            yield (
                _column(lines, part.lineno, part.col_offset),
                _column(lines, part.end_lineno, part.end_col_offset),
            )


def _silent_parts(node: ast.AST) -> list[Any]:
    if isinstance(node, ast.arg | ast.AnnAssign):
        return [node.annotation] if node.annotation else []
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        returns = None if isinstance(node, ast.ClassDef) else node.returns
        return node.decorator_list + ([returns] if returns else [])
    if isinstance(node, ast.If):
        return [node] if "TYPE_CHECKING" in ast.unparse(node.test) else []
    if isinstance(node, ast.Assign):
        return [node] if ast.unparse(node.targets[0]) == "__all__" else []
    if isinstance(node, ast.Raise):
        return [node.exc] if node.exc else []
    return []


def _column(lines: list[str], line: int, offset: int) -> _Place:
    """Return a place with its column in characters, where `ast` counts bytes."""
    return line, len(lines[line - 1].encode()[:offset].decode())
