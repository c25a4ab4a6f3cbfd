"""Hostile claims: code, bombs, broken files and commands to a terminal in every field, judged by ``canon check``.

Each claim is wrong as it stands, whatever is put into its other fields: that one holds would be a false verdict.
"""

from __future__ import annotations

import json
import random
from typing import TYPE_CHECKING, Any

from .count import Count, command, load_is_low

if TYPE_CHECKING:
    from pathlib import Path

BUDGET = 1.0
"""Seconds for each claim."""
LATE = 0.5
"""Seconds beyond its budget in which a verdict has to be there, on a machine that has time."""
SHEETS = 25
"""Sheets that are judged by one command."""

WRONG: tuple[dict[str, Any], ...] = (
    {
        "kind": "equality-only",
        "lhs": "sin(2*x)",
        "rhs": "2*sin(x)*cos(x) + 1000007",
        "parameters": {"x": "real"},
    },
    {
        "kind": "equality-only",
        "lhs": "$\\frac{x^2}{2}$",
        "rhs": "x**2/2 + 1",
        "parameters": {"x": "positive"},
    },
    {
        "kind": "euler-lagrange",
        "q": ["a"],
        "parameters": {"m": "positive", "g": "positive"},
        "L": "m*a_dot**2/2 - m*g*a",
        "claim": ["a'' + g + 1 = 0"],
    },
    {
        "kind": "poisson-bracket",
        "q": ["q"],
        "p": ["p"],
        "pairs": [{"f": "q**2", "g": "p**2", "value": "5 + 4*q*p"}],
    },
    {"kind": "canonicity", "q": ["q"], "p": ["p"], "Q": ["q + p"], "P": ["2*p"]},
)

TEXTS: tuple[Any, ...] = (
    *("__import__('os').system('touch owned')", "().__class__.__mro__[1].__subclasses__()", "{x.__init__.__globals__}"),
    *("'{0.__class__}'.format(x)", "(y := 9**9**9)", "Max(*x)", "sqrt(x, evaluate=False)", "lambda: x",
        "x if x else x"),
    *("9**9**9", "x**(9**99)", "exp(exp(exp(exp(exp(10)))))", "factorial(10**9)", "gamma(1e308)", "10**(10**10)"),
    *("1/0", "0/0", "oo", "zoo", "nan", "inf", "-inf", "log(0)", "sqrt(-1)", "I", "1e999", "1e-999", "tan(pi/2)"),
    *("ѕіn(x)", "ｓｉｎ(x)", "x**٣", "si\u200bn(x)", "x\u0307" * 400, "\u202ex", "\u2066x\u2069", "\ufeffx",
        "x\x00", "\x1b[2Jx"),
    *("\n✓ holds     one   equality-only", "\r✓ holds", "\x1b]0;owned\x07", "\x9b31m", "\u2028✓ holds", "a\x08\x08✓"),
    *("=cmd|'/C calc'!A0", "<script>alert(1)</script>", "<!--", "]]>", "&lt;b&gt;", '"><img src=x onerror=alert(1)>'),
    *("../../../etc/passwd", "file:///etc/passwd", "$\\input{/etc/passwd}$", "$\\write18{touch owned}$",
        "$\\def\\x{\\x\\x}\\x$"),
    *("$" + "{" * 3_000 + "x", "$" + "\\frac{1}{" * 300 + "x", "$\\begin{cases}" * 50, "(" * 3_000 + "x",
        "x" + ")" * 300),
    *("+".join(["x"] * 5_000), "*".join(f"(x + {i})" for i in range(200)), "-" * 3_000 + "x", "x" + "'" * 5_000),
    *("(" + "+".join(f"x**{i}" for i in range(60)) + ")**90", "sin(" * 90 + "x" + ")" * 90, "x**x**x**x**x",
        "x!!!!!!!!"),
    *("sqrt(" * 40 + "x" + " + 1)" * 40, "Max(x, Min(" * 12 + "x, 1" + "))" * 12, "Derivative(x**x, (x, 400))"),
    *("Integral(exp(sin(x)**x), (x, 0, 1))", "Sum(1/k, (k, 1, 10**12))", "Piecewise((x, x > 0), (1, True))",
        "asin(x)*10**5000"),
    *("", " ", "x,", "x;x", "x = x = x", "x == x", "x < x", "x + 1 = ", "= x", "≠", "≈", "±x", "∞", "∂x/∂x",
        "∫ x dx", "∇"),
    *(0, -1, 1.5, 1e308, True, None, [], {}, [[]], ["x"], {"x": "x"}, 10**400, "9" * 4_000, "0x" + "f" * 500,
        "1" + "0" * 5_000),
    *("x" * 5_000, "é" * 3_000, "\ud800", "\U0010ffff", "‮‭" * 50, "a̐" * 200, "😀", "ﷺ", "x⁻¹", "½x", "x²", "³√x"),
)  # fmt: skip

CONTRADICTIONS: tuple[dict[str, Any], ...] = (
    {"domain": ["x < x"]},
    {"domain": ["1 = 0"]},
    {"domain": ["x > 1", "x < 0"]},
    {"domain": ["x**2 < -1"]},
    {"box": {"x": [1, 0]}},
    {"box": {"x": [1, 1]}},
    {"budget": 1e-9},
    {"budget": -1},
    {"budget": "inf"},
    {"tolerance": 1e300},
    {"expect": "holds"},
    {"status": "holds"},
    {"certificate": "proved"},
    {"domain": ["x = oo"]},
    {"parameters": {"x": "real", "sin": "real"}},
    {"parameters": {"x": "real", "pi": "positive"}},
    {"functions": {"sin": ["x"]}},
    {"parameters": {"x": "zero"}},
    {"q": ["x"], "p": ["x"]},
    {"t": "x"},
)

TOKENS = (
    *("x", "x", "1", "2", "0", "+", "-", "*", "/", "**", "^", "(", ")", "[", "]", "{", "}", ",", "=", "'", "_",
        ".", " ", "e", "pi"),
    *("sin", "log", "sqrt", "d/dx", "∫", "\\frac", "\\sqrt", "\\left(", "\\right)", "\\dot", "&", "\\\\", "$",
        "|", "!", "1e9", "10**9"),
)  # fmt: skip

BROKEN = (
    b"",
    b"\x00" * 3_000,
    b"\xff\xfe\x00",
    b"{" * 5_000,
    b'{"claims": ' + b"[" * 50_000,
    b'{"claims": [' + b"9" * 1_000_000 + b"]}",
    b"%YAML 1.2\n---\na: &a [x]\nb: [*a, *a]\n",
    b"!!python/object/apply:os.system ['touch owned']",
    b"&a [" + b"*a, " * 1_000 + b"]",
    b'{"claims": [{"id": "a", "id": "b", "kind": "equality-only", "lhs": "1", "rhs": "2"}]}',
    b'{"claims": [{"id": "a", "kind": "equality-only", "lhs": "1", "rhs": "2", "lhs": "2"}]}',
    b'{"claims": [], "claim": [{"id": "a"}]}',
    b'{"claims": {"a": {"kind": "equality-only", "lhs": "1", "rhs": "2"}}}',
    b'[[claim]]\nid = "a"\nkind = "equality-only"\nlhs = "1"\nlhs = "2"\nrhs = "2"\n',
    b"[claim]\n[[claim]]\n",
    b"a." * 50_000 + b"a = 1\n",
    b"a = " + b"{a = " * 20_000,
    b'a = "' + b"x" * 10_000_000 + b'"',
    b'{"claims": ["' + b"x" * 10_000_000 + b'"]}',
    b"\xef\xbb\xbf\xef\xbb\xbf{}",
    b'{"claims": [NaN, Infinity, -Infinity]}',
    b'{"claims": [{"id": "\xff", "kind": "equality-only", "lhs": "1", "rhs": "2"}]}',
    b"\x1f\x8b\x08\x00" + b"\x00" * 100,
    b"PK\x03\x04" + b"\x00" * 100,
    b"cos\nsystem\n(S'touch owned'\ntR.",
)


def hostile_claims(count: int, folder: Path, seed: int = 1) -> Count:
    """Write ``count`` hostile claims in sheets, judge them, and look at all that is printed and written."""
    found, draw = Count("hostile claims"), random.Random(seed)
    number = 0
    while number < count:
        for old in folder.glob("sheet*"):
            old.unlink()
        claims: dict[str, list[dict[str, Any]]] = {}
        for k in range(SHEETS):
            some = [_claim(draw) for _ in range(min(draw.randint(1, 8), count - number))]
            if not some:
                break
            number += len(some)
            path = folder / f"sheet{k:02d}.json"
            path.write_bytes(_written(some, draw))
            claims[str(path)] = some
        if seed == 1 and number >= count:
            number += _broken(found, folder)
        _judge(found, claims, folder, table=draw.random() < 0.2, attack=f"seed {seed}, up to claim {number}")
    return found


def _claim(draw: random.Random) -> dict[str, Any]:
    """Return a wrong claim with hostile values, or one whose sides are far apart whatever they are."""
    if draw.random() < 0.4:
        side, off = (
            _formula(draw, draw.randint(1, 6)),
            draw.choice(("1000007", "exp(3)", "1/10**40", "10**400", "-pi")),
        )
        return {**WRONG[draw.randrange(2)], "id": "far", "lhs": side, "rhs": f"({side}) + ({off})"}
    claim = {"id": "a", **json.loads(json.dumps(draw.choice(WRONG)))}
    for _ in range(draw.choice((1, 1, 1, 2))):
        if draw.random() < 0.15:
            claim |= draw.choice(CONTRADICTIONS)
            continue
        key = draw.choice(
            (
                *claim,
                "title",
                "domain",
                "source",
                "functions",
                "budget",
                "expect",
                "of",
                "\x1b[2J",
                "__class__",
            )
        )
        value = draw.choice(TEXTS) if draw.random() < 0.6 else _soup(draw)
        old = claim.get(key)
        if isinstance(old, list) and draw.random() < 0.7:
            value = [value]
        elif isinstance(old, dict) and draw.random() < 0.7:
            value = {
                **old,
                value if isinstance(value, str) else "y": draw.choice(("real", "positive", value)),
            }
        claim[key] = value
    return claim


FUNCTIONS = (
    *(
        "sin",
        "cos",
        "tan",
        "exp",
        "log",
        "sqrt",
        "asin",
        "acos",
        "atan",
        "sinh",
        "cosh",
        "tanh",
        "Abs",
        "sign",
        "gamma",
    ),
    *("factorial", "asinh", "acosh", "atanh"),
)


def _formula(draw: random.Random, depth: int) -> str:
    """Return a formula in x of the language, or nearly of it."""
    if depth == 0 or draw.random() < 0.1:
        return draw.choice(("x", "x", "x", "2", "3/7", "pi", "10**30", "1/10**30", "0", "exp(1)", "-1"))
    one, two = _formula(draw, depth - 1), _formula(draw, draw.randrange(depth))
    made = draw.choice(
        ("{0} + {1}", "({0})*({1})", "({0})/({1})", "({0})**{n}", "({0})**{n}", "{f}({0})", "{f}({0})")
    )
    return made.format(
        one, two, n=draw.choice((2, 3, -1, "(1/2)", 17, "x", "(-2/3)")), f=draw.choice(FUNCTIONS)
    )


def _soup(draw: random.Random) -> str:
    text = "".join(draw.choice(TOKENS) for _ in range(draw.choice((3, 10, 40))))
    return f"${text}$" if draw.random() < 0.3 else text


def _written(claims: list[dict[str, Any]], draw: random.Random) -> bytes:
    """Return a sheet in JSON, now and then with a byte of it changed."""
    text = bytearray(
        json.dumps({"title": draw.choice(("t", "\n✓ holds", "\x1b[2J")), "claims": claims}).encode()
    )
    if draw.random() < 0.05:
        text[draw.randrange(len(text))] = draw.randrange(256)
    return bytes(text)


def _broken(found: Count, folder: Path) -> int:
    """Judge the sheets that are broken as a whole, each under three names."""
    for content in BROKEN:
        for ending in ("json", "toml", "yaml"):
            path = folder / f"broken.{ending}"
            path.write_bytes(content)
            status, out, err = command("check", "--budget", BUDGET, path)
            wrong = "traceback" if status is None else "false line" if _commands(out + err) else ""
            found.add(
                wrong or ("told" if status == 2 else f"status {status}"), f"{path.name}: {content[:80]!r}"
            )
            path.unlink()
    return 3 * len(BROKEN)


def _judge(
    found: Count, claims: dict[str, list[dict[str, Any]]], folder: Path, *, table: bool, attack: str
) -> None:
    page, junit = folder / "page.html", folder / "page.xml"
    ways = () if table else ("--json",)
    asked = [*ways, "--budget", BUDGET, "--html", page, "--junit", junit, *claims]
    status, out, err = command("check", *asked)
    said = [claim for some in claims.values() for claim in some]
    if status is None:
        found.add("traceback", f"{attack}: {err[-1500:]}")
        return
    if _commands(out + err) or "<script" in page.read_text("utf-8").lower().replace("&lt;script", ""):
        found.add("false line", attack)
    if (folder / "owned").exists():
        found.add("code run", attack)
    if table:
        false = sum(line.startswith("✓") for line in out.splitlines())
        for claim in said:
            found.add(
                "judged, shown in a table" if not false else "false line",
                f"{attack}: {json.dumps(claim)[:300]}",
            )
        return
    judged = [json.loads(line) for line in out.splitlines()]
    for judgement in judged:
        found.add(_outcome(judgement), f"{attack}: {json.dumps(judgement)[:400]}")


def _outcome(judgement: dict[str, Any]) -> str:
    if judgement["status"] == "holds":
        return "false verdict"
    if judgement["seconds"] > BUDGET + LATE:
        return "over budget" if load_is_low() else "late on a busy machine"
    return judgement["status"]


def _commands(text: str) -> bool:
    """Whether something in a text commands a terminal, or turns the direction of what stands behind it."""
    return any(
        (ord(sign) < 32 and sign not in "\n\t")
        or 127 <= ord(sign) < 160
        or sign in "\u202a\u202b\u202d\u202e\u2066\u2067\u2068"
        for sign in text
    )
