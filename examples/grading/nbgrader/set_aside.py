"""After ``nbgrader autograde``: what canon could not read, or not decide, loses its 0 and waits for a person.

A cell of nbgrader's that raises is worth 0. This looks for the cells that raised because there is no mark yet, takes
the 0 away and sets "needs manual grade", so that formgrader shows them.

python set_aside.py ASSIGNMENT autograded/*/ASSIGNMENT/*.ipynb
"""

import json
import sys
from pathlib import Path

OPEN = ("canon: unreadable", "canon: undecided")


def open_cells(notebook):
    """Return the grade_id of each cell that has no mark yet, with what canon said."""
    found = {}
    for cell in notebook["cells"]:
        for output in cell.get("outputs", ()):
            said = str(output.get("evalue", ""))
            if output["output_type"] == "error" and said.startswith(OPEN):
                found[cell["metadata"]["nbgrader"]["grade_id"]] = said
    return found


def set_aside(gradebook, assignment, path):
    """Take the 0 of each such cell of one student's notebook; return what was set aside."""
    student, notebook = path.parts[-3], path.stem
    found = open_cells(json.loads(path.read_text("utf-8")))
    for cell in found:
        grade = gradebook.find_grade(cell, notebook, assignment, student)
        grade.auto_score, grade.needs_manual_grade = None, True
    gradebook.db.commit()
    return found


def main(assignment, *paths):
    from nbgrader.api import Gradebook

    with Gradebook("sqlite:///gradebook.db") as gradebook:
        for path in map(Path, paths):
            for cell, said in set_aside(gradebook, assignment, path).items():
                print(f"{path.parts[-3]}, {cell}: {said}")


if __name__ == "__main__":
    main(*sys.argv[1:])
