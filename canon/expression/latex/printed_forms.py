r"""Printed forms: letters with decorations, conditions of cases, ``\partial_x``, SymPy's special functions."""

from __future__ import annotations

import re

__all__ = [
    "CLAUSE",
    "CONDITION",
    "DECORATIONS",
    "OF_SPECIAL_FUNCTIONS",
    "OTHERWISE",
    "PARTIAL",
    "PLAIN",
    "PRINTED_CALL",
]

DECORATIONS = {
    **dict.fromkeys(("bar", "overline"), ("bar",)), **dict.fromkeys(("hat", "widehat"), ("hat",)),
    **dict.fromkeys(("tilde", "widetilde"), ("tilde",)), "vec": ("vec",), "mathcal": ("cal",), "mathscr": ("scr",),
    **dict.fromkeys(("mathbf", "boldsymbol", "bm"), ("vec", "bf")),
}  # fmt: skip
CONDITION = re.compile(
    r"\\(?:text|mathrm|textrm|mbox)\s*\{[\s~]*(for|if|when|otherwise|else|wenn|sonst)[\s~:,.]*\}|\\(?:wedge|land|vee|lor)(?![A-Za-z])"
)
"""What stands before a condition in ``cases``, or in its place."""
CLAUSE = re.compile(
    r"\((?:[^()<>=\\]|\\(?!wedge|vee|land|lor|[lgn]eq?)[A-Za-z]*){0,400}?(?:[<>=]|\\(?:leq|geq|neq|le|ge|ne))"
)
"""A bracket in ``cases`` with a relation directly inside it."""
OTHERWISE = ("otherwise", "else", "sonst")
PLAIN = re.compile(
    r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*_(?=[A-Za-z0-9]*[A-Za-z])[A-Za-z0-9]{2,}(?![A-Za-z0-9_])"
)
"""A name as the plain language has it, ``p_theta``, which LaTeX would print otherwise."""
PARTIAL = re.compile(
    r"\\partial\s*(?:\^\s*([2-9])\s*)?_\s*(?:\{([^{}]{1,60})\}|(\\[A-Za-z]+|[A-Za-z]))(?:\s*\^\s*([2-9]))?"
)
OF_SPECIAL_FUNCTIONS = {"W": "LambertW", "K": "elliptic_k", "E": "elliptic_e"}
PRINTED_CALL = re.compile(r"(?:\^\{(?:[^{}]|\{(?:[^{}]|\{[^{}]{0,99}+\}){0,99}+\}){1,99}+\})?\\left\(")
r"""How SymPy prints their argument, after a power."""
