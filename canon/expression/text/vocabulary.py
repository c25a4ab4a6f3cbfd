"""Vocabulary of the expression language: functions, constants, relations, and their other spellings."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.symbols.jacobi_functions import (
    jacobi_am,
    jacobi_cn,
    jacobi_dn,
    jacobi_epsilon,
    jacobi_sn,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sympy import Expr

__all__ = ["CONSTANTS", "FUNCTIONS", "LEGENDRES", "MAX_CHOICES", "OTHER_NAMES", "RELATIONS", "WRITTEN_OUT"]

MAX_CHOICES = 16
"""Most arguments of Max and Min and most pieces of Piecewise: SymPy compares them pairwise."""


def _acot(x: Expr, *, evaluate: bool = True) -> Expr:
    """Return acot x as it was written: SymPy makes acot(−x) to −acot x, which is wrong at x = 0, where acot is π/2."""
    extracted = bool(x.free_symbols) and x.could_extract_minus_sign()
    return sp.acot(x, evaluate=evaluate and not extracted)


def _sech(x: Expr, *, evaluate: bool = True) -> Expr:
    """Return sech x as 1/cosh x, which every room knows."""
    return sp.Pow(sp.cosh(x, evaluate=evaluate), -1, evaluate=evaluate)


def _csch(x: Expr, *, evaluate: bool = True) -> Expr:
    return sp.Pow(sp.sinh(x, evaluate=evaluate), -1, evaluate=evaluate)


def _coth(x: Expr, *, evaluate: bool = True) -> Expr:
    return sp.Pow(sp.tanh(x, evaluate=evaluate), -1, evaluate=evaluate)


def _elliptic_pi(*arguments: Expr, evaluate: bool = True) -> Expr:
    """Return Π(n, m) or Π(n, φ, m); SymPy's formulas for special n and m of the latter are wrong for φ > π/2."""
    return sp.elliptic_pi(*arguments, evaluate=evaluate and len(arguments) == 2)


FUNCTIONS: Mapping[str, tuple[Callable[..., Expr], int, int]] = MappingProxyType(
    {
        **{
            name: (getattr(sp, name), 1, 1)
            for name in (
                "sqrt", "exp", "sin", "cos", "tan", "cot", "sec", "csc", "asin", "acos", "atan",
                "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "Abs", "sign", "LambertW", "elliptic_k",
            )
        },
        "acot": (_acot, 1, 1),
        "sech": (_sech, 1, 1),
        "csch": (_csch, 1, 1),
        "coth": (_coth, 1, 1),
        "log": (sp.log, 1, 2),
        "atan2": (sp.atan2, 2, 2),
        "elliptic_e": (sp.elliptic_e, 1, 2),
        "elliptic_f": (sp.elliptic_f, 2, 2),
        "elliptic_pi": (_elliptic_pi, 2, 3),
        "jacobi_am": (jacobi_am, 2, 2),
        "jacobi_sn": (jacobi_sn, 2, 2),
        "jacobi_cn": (jacobi_cn, 2, 2),
        "jacobi_dn": (jacobi_dn, 2, 2),
        "jacobi_epsilon": (jacobi_epsilon, 2, 2),
        "Max": (sp.Max, 1, MAX_CHOICES),
        "Min": (sp.Min, 1, MAX_CHOICES),
    }
)  # fmt: skip
"""Every function of the language, with the least and the greatest number of its arguments."""

CONSTANTS: Mapping[str, Expr] = MappingProxyType({"pi": sp.pi, "I": sp.I})
RELATIONS = {"<": sp.Lt, "<=": sp.Le, ">": sp.Gt, ">=": sp.Ge, "!=": sp.Ne, "==": sp.Eq}
OTHER_NAMES = {"ln": "log", "Log": "log", "arcsin": "asin", "arccos": "acos", "arctan": "atan", "abs": "Abs",
                "cotan": "cot", "max": "Max", "min": "Min", "e": "exp(1)", "E": "exp(1)", "i": "I", "j": "I",
                "diff": "Derivative", "tg": "tan", "sen": "sin", "arcsen": "asin", "arctg": "atan", "cth": "coth",
                "ctg": "cot", "cotg": "cot",
                "sh": "sinh", "ch": "cosh", "th": "tanh", "arccot": "acot",
                "arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh", "arsinh": "asinh", "arcosh": "acosh",
                "artanh": "atanh", "arctan2": "atan2", "fabs": "Abs", "sgn": "sign", "cosec": "csc",
                "ArcSin": "asin", "ArcCos": "acos", "ArcTan": "atan", "ArcSinh": "asinh", "ArcCosh": "acosh",
                "ArcTanh": "atanh", "ArcCot": "acot", "elliptic_kc": "elliptic_k", "elliptic_ec": "elliptic_e",
                "EllipticK": "elliptic_k", "EllipticE": "elliptic_e", "EllipticF": "elliptic_f",
                "EllipticPi": "elliptic_pi", "JacobiAmplitude": "jacobi_am",
                "JacobiSN": "jacobi_sn", "JacobiCN": "jacobi_cn",
                "JacobiDN": "jacobi_dn", "JacobiEpsilon": "jacobi_epsilon",
                "am": "jacobi_am", "sn": "jacobi_sn", "cn": "jacobi_cn", "dn": "jacobi_dn", "ProductLog": "LambertW",
                "signum": "sign"}  # fmt: skip
WHICH_E = "is e Euler's number, or a name that is not declared, as that of an eccentricity?"
WRITTEN_OUT = {
    **dict.fromkeys(
        ("Integral", "integrate", "Integrate", "quad", "int"),
        "write the integral out, as a function of its ends",
    ),
    **dict.fromkeys(
        ("Sum", "Product", "summation", "sum", "prod", "Sigma"),
        "write its terms one by one, with + or * between",
    ),
    **dict.fromkeys(("Matrix", "Vector", "ImmutableMatrix"), "write the components one by one, in a list"),
    **dict.fromkeys(("Limit", "limit"), "write its value"),
    **dict.fromkeys(("const", "constant", "Const"), "write what is constant, or leave it out"),
}
"""What is no function of the language, and what to write instead."""
LEGENDRES = MappingProxyType(
    {"K": "elliptic_k(m)", "E": "elliptic_e(m)", "F": "elliptic_f(phi, m)", "Pi": "elliptic_pi(n, m)"}
)
"""Letters of Legendre's integrals. Books take the modulus k in K(k), some the parameter m = k²: it has to be said."""
