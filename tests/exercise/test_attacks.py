"""What strangers may hand in to do harm, as docs/security.md says: nothing runs or hangs, the next claim is judged."""

import ast
import json
import os
import random
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from canon import coordinates, parameters
from canon.exercise import judging_process
from canon.exercise.judging_process import GRACE, HEARD, MEMORY, Worker
from canon.exercise.sheet.sheet import Claim, SheetError, claim_from, sheet_from
from canon.exercise.sheet_check import check, judged
from canon.expression.mathml import formula
from canon.expression.parse import LanguageError, parse_condition, parse_equation
from canon.expression.text.scope import Scope
from canon.process import Late

from .endless_claim import ENDLESS

ROOT = Path(__file__).parents[2]
GOOD = {
    "id": "good",
    "kind": "equality-only",
    "lhs": "sin(2*x)",
    "rhs": "2*sin(x)*cos(x)",
    "parameters": {"x": "real"},
}
HEAD = b'{"claims": [{"id": "a", "kind": "equality-only", '
NAMES = json.dumps({"claims": [{**GOOD, "parameters": {f"x{i}": "real" for i in range(100_000)}}]}).encode()
ONE = b'[[claim]]\nid = "a"\nkind = "equality-only"\nlhs = "1"\n'
HEX = b"0x" + b"f" * 100_000

BOMBS = {
    "numbers without end": (b'{"claims": [' + b"9" * 5_000_000 + b"]}", False),
    "an exponent beyond any decimal": (HEAD + b'"lhs": 1e%d}]}' % 10**25, False),
    "nan as a budget": (ONE + b'rhs = "1"\nbudget = nan\n', True),
    "infinity as a side": (ONE + b"rhs = inf\n", True),
    "a budget of 10**-999999999": (b'{"claims": [{"id": "a", "kind": "x", "budget": 1e-999999999}]}', False),
    "a hexadecimal number of 400 000 bits": (ONE + b"rhs = " + HEX + b"\n", True),
    "a box of 400 000 bits": (ONE + b'rhs = "1"\nbox = {x = [0, ' + HEX + b"]}\n", True),
    "a box up to 10**999999999": (HEAD + b'"box": {"x": [0, 1e999999]}}]}', False),
    "a key twice among 60 000": (HEAD + b",".join(b'"k%d":1' % i for i in range(60_000)) + b',"k1":2}]}', False),
    "20 000 unknown keys": (HEAD + b",".join(b'"lh%d":1' % i for i in range(20_000)) + b"}]}", False),
    "a key of 200 000 parts": (b"a." * 200_000 + b"a = 1\n", True),
    "a quoted key of 100 000 parts": (b'"a".' * 100_000 + b"a = 1\n", True),
    "a spaced key of 100 000 parts": (b"a \t. " * 100_000 + b"a = 1\n", True),
    "a header of 100 000 parts": (b"[" + b"a." * 100_000 + b"a]\n", True),
    "inline tables in each other": (b"a = " + b"{a = " * 50_000, True),
    "arrays in each other": (b'{"claims": ' + b"[" * 200_000, False),
    "100 000 tables": (b"[[claim]]\n" * 100_000, True),
    "9 MB of TOML": (b'a = "' + b"x" * 9_000_000 + b'"', True),
    "a date as an expression": (ONE + b"rhs = 1979-05-27T07:32:00-08:00\n", True),
    "100 000 names": (NAMES, False),
    "half a character": (HEAD + b'"lhs": "\\udfff", "title": "\\ud800", "rhs": "1"}]}', False),
}  # fmt: skip


JUDGED = ("infinity as a side", "half a character")
"""What is refused only where it is read as an expression."""


def refused(data, toml):
    """Return what is said against a sheet."""
    try:
        return [str(error) for error in sheet_from(data, toml=toml).errors]
    except SheetError as error:
        return [str(error)]


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_cost_no_time(name):
    data, toml = BOMBS[name]
    start = time.process_time()
    told = refused(data, toml)
    assert time.process_time() - start < 2.0
    assert told or name in JUDGED
    assert len(told) < 25
    assert all(len(line) < 2_000 for line in told)


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe has a name as POSIX gives it")
def test_a_pipe_without_end_is_read_to_the_limit_only(tmp_path):
    endless = subprocess.Popen(
        [sys.executable, "-c", "while True: print('[' * 9999)"], stdout=subprocess.PIPE
    )
    try:
        with pytest.raises(SheetError, match="are read; split the sheet"):
            check(f"/dev/fd/{endless.stdout.fileno()}")
    finally:
        endless.kill()
        endless.wait()
        endless.stdout.close()


FORBIDDEN = ("eval", "exec", "compile", "__import__", "parse_expr", "sp.S", "sympy.S", "sp.parse_expr")


def test_no_module_evaluates_text():
    """No call of eval, exec, parse_expr or sympy.S; sympify only with strict=True, which refuses text."""
    for path in sorted((ROOT / "canon").rglob("*.py")):
        for call in (
            node for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Call)
        ):
            name = ast.unparse(call.func)
            numbered_names_only = (path.name, name) == ("written_steps.py", "compile")
            assert name not in FORBIDDEN or numbered_names_only, f"{path}:{call.lineno}"
            if name.endswith("sympify"):
                assert "strict=True" in ast.unparse(call), f"{path}:{call.lineno}"


TRAP = "import pathlib; pathlib.Path({marker!r}).write_text('owned')\nraise SystemExit('owned')\n"


def test_modules_in_the_folder_of_the_answers_are_not_run(tmp_path):
    """A lecturer who judges in the folder that students filled runs none of their files."""
    marker = tmp_path / "owned"
    for name in (
        "json",
        "queue",
        "sympy",
        "lark",
        "flint",
        "mpmath",
        "canon",
        "sitecustomize",
        "decimal",
        "signal",
    ):
        (tmp_path / f"{name}.py").write_text(TRAP.format(marker=str(marker)), "utf-8")
    (tmp_path / "s.json").write_text(json.dumps({"claims": [GOOD]}), "utf-8")
    code = f"import sys; sys.path.insert(0, {str(ROOT)!r}); from canon.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, "check", "s.json"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
    )  # as the installed command does, which has no folder of its own on its path
    assert not marker.exists()
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="no groups of processes")
def test_a_killed_worker_leaves_no_process_behind():
    with Worker() as worker:
        worker.judge(claim_from(GOOD))
        group = worker._child.pid
        assert os.getpgid(group) == group
        limits = Path(f"/proc/{group}/limits")
        if limits.exists():
            assert f"Max address space         {MEMORY}" in limits.read_text("utf-8")
        late = worker.judge(replace(claim_from(ENDLESS), budget=0.3))
        assert late.known == "its budget of 0.3 s was spent"
    while runs(group):  # a process of the proofs that goes on would hang here
        time.sleep(0.05)


def runs(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_leaving_early_stops_the_workers(processor_seconds):
    slow = [
        Claim(f"c{i}", "equality-only", {**GOOD, "lhs": f"sin(x)**{40 + i}*exp(x)**99"}, budget=60.0)
        for i in range(4)
    ]
    used = processor_seconds()
    for judgement in judged([claim_from(GOOD), *slow], jobs=2):
        assert judgement.status == "holds"
        break
    assert processor_seconds() - used < 30.0


DEEP = r"\frac{1}{" * 60 + "x" + "}" * 60
ATTACKS = {
    "code": {"lhs": "__import__('os').system('touch owned')"},
    "code in a comprehension": {"lhs": "[c for c in ().__class__.__mro__[1].__subclasses__()]"},
    "code in braces": {"lhs": "{x.__init__.__globals__}"},
    "format": {"lhs": "'{0.__class__}'.format(x)"},
    "walrus": {"lhs": "(y := 9**9**9)"},
    "star arguments": {"lhs": "Max(*x)"},
    "keyword": {"lhs": "sqrt(x, evaluate=False)"},
    "look-alike letters": {"lhs": "ѕіn(x)"},
    "full width": {"lhs": "ｓｉｎ(x)"},
    "digits of another script": {"lhs": "x**٣"},
    "mark over mark": {"lhs": "x" + "\u0307" * 5_000},
    "thousands of primes": {"lhs": "x" + "'" * 40_000},
    "zero width": {"lhs": "si\u200bn(x)"},
    "right to left": {"lhs": "\u202ex + 1\u202c"},
    "tower": {"lhs": "9**9**9"},
    "tower below": {"lhs": "2**-(9**9)"},
    "tower of exponentials": {"lhs": "exp(exp(exp(exp(exp(10)))))"},
    "tower of exponentials times x": {"lhs": "x*exp(exp(exp(exp(exp(10)))))"},
    "tower in a sine": {"lhs": "sin(exp(exp(exp(3))))"},
    "tower below a tower": {"lhs": "exp(-exp(exp(exp(exp(10)))))/cosh(cosh(cosh(cosh(9))))"},
    "tower that is compared": {"lhs": "Max(x, exp(exp(exp(exp(10))))) + Abs(exp(exp(exp(exp(10)))) - x)"},
    "tower in a domain": {"domain": ["x < exp(exp(exp(exp(exp(10)))))"]},
    "tower over x": {"lhs": "exp(exp(exp(exp(exp(10 + x)))))"},
    "tower at an instant": {"kind": "solution", "q": ["q"], "equations": ["q_ddot + q"],
        "solution": {"q": "exp(exp(exp(exp(exp(10 + t)))))"}, "initial": {"q": "1", "q_dot": "0"}},
    "tower of symbols": {"lhs": "**".join(["x"] * 60)},
    "roots of large numbers": {"lhs": f"sqrt({'7' * 990})*sqrt({'3' * 990}) + {'9' * 990}**(1/3)"},
    "factors of large numbers": {"lhs": f"({10**900 + 7})**(1/2)"},
    "hundred digits below": {"lhs": "+".join(f"x/{10**99 + i}" for i in range(300))},
    "numbers longer than Python writes": {"lhs": "10**999*10**999*10**999*10**999*x**2"},
    "a bracket of long numbers": {"kind": "poisson-bracket", "q": ["q"], "p": ["p"], "pairs": [
        {"f": "(q + 1)**2*10**999*10**999*10**999*10**999", "g": "p**2*10**999*10**999*10**999", "value": "1"}]},
    "motion with long numbers": {"kind": "euler-lagrange", "q": ["x"], "claim": ["x_ddot*10**999*10**999 + x"],
        "L": "x_dot**2*10**999*10**999*10**999/2 - x**2*7**999*7**999*7**999*7**999/2"},
    "power of a long sum": {"lhs": "(" + "+".join(f"x**{i}" for i in range(200)) + ")**500"},
    "products of sums": {"lhs": "*".join(f"(x + {i})" for i in range(900))},
    "10**5 terms": {"lhs": "+".join(["x"] * 100_000)},
    "9 000 terms": {"lhs": "+".join(f"{i}*x" for i in range(1, 5_000))},
    "9 000 sines": {"lhs": "+".join(f"sin({i}*x)" for i in range(1, 4_000))},
    "deep brackets": {"lhs": "(" * 5_000 + "x" + ")" * 5_000},
    "deep functions": {"lhs": "sin(exp(" * 31 + "x" + "))" * 31},
    "deep powers": {"lhs": "((" * 30 + "x" + ")**2+1)**2" * 30},
    "nested maxima": {"lhs": "Max(x, Min(" * 15 + "x, 1" + "))" * 15},
    "nested pieces": {"lhs": "Piecewise((1, x < 1), (" * 12 + "x" + ", True))" * 12},
    "derivatives of towers": {"lhs": "Derivative(" * 8 + "exp(sin(x)**x)**x" + ", (x, 8))" * 8},
    "absolute values": {"lhs": "Abs(x + " * 40 + "1" + ")" * 40},
    "LaTeX fractions": {"lhs": f"${DEEP}$"},
    "LaTeX braces": {"lhs": "$" + "{" * 20_000 + "x"},
    "LaTeX letters": {"lhs": "$" + "xt" * 20_000 + "$"},
    "LaTeX subscripts": {"lhs": "$" + "x_{" * 900 + "1" + "}" * 900},
    "LaTeX bars": {"lhs": "$" + "|x" * 3_000 + "$"},
    "LaTeX spaces": {"lhs": "$" + "\\, " * 12_000 + "x$"},
    "LaTeX primes": {"lhs": "$x" + "^{" + "\\prime " * 5_000 + "}$"},
    "units without end": {"lhs": "1 [" + "m " * 20_000 + "]"},
    "brackets of blanks": {"lhs": "+".join("1 [m" + " " * 60 + "s]" for _ in range(500))},
    "side by side": {"lhs": "x " * 9_000, "implicit_multiplication": True},
    "one long name": {"lhs": "xt" * 20_000, "implicit_multiplication": True},
    "conditions": {"domain": [f"x > -{i}" for i in range(400)]},
    "a condition that is a tower": {"domain": ["exp(exp(exp(exp(exp(9))))) > x"]},
    "cases": {"domain": ["Ne(Max(" + ",".join(f"sin(x+{i})" for i in range(16)) + "), 0)"]},
    "a box from 0 to 10**300": {"box": {"x": [0, 10**300]}},
    "everywhere infinite": {"lhs": "1/(x - x)"},
    "nowhere real": {"lhs": "log(-1 - x**2)**(1/3)"},
    "many coordinates": {"kind": "euler-lagrange", "q": [f"q{i}" for i in range(60)],
                         "L": "+".join(f"q{i}_dot**2*exp(q{(i * 7) % 60}*q{i})" for i in range(60)),
                         "claim": [f"q{i}_ddot" for i in range(60)]},
    "a large bracket": {"kind": "poisson-bracket", "q": [f"q{i}" for i in range(99)], "p": [f"p{i}" for i in range(99)],
                        "pairs": [{"f": "*".join(f"q{i}" for i in range(99)), "g": "*".join(f"p{i}" for i in range(99)),
                                   "value": "0"}] * 20},
    "a large map": {"kind": "canonicity", "q": [f"q{i}" for i in range(40)], "p": [f"p{i}" for i in range(40)],
                    "Q": [f"q{i}*exp(sin(p{(i + 1) % 40}))" for i in range(40)], "P": [f"p{i}" for i in range(40)]},
    "a singular body": {"kind": "gibbs-appell", "q": ["a"], "bodies": [{"m": "0", "r": ["0"]}] * 200, "S": "0"},
}  # fmt: skip


TRUE = ("conditions", "cases", "a box from 0 to 10**300", "a singular body")
"""What is right all the same."""


@pytest.fixture(scope="module")
def worker():
    with Worker() as worker:
        assert worker.judge(claim_from(GOOD)).status == "holds"
        yield worker


def attack(name, budget):
    keys = {key: value for key, value in {**GOOD, **ATTACKS[name]}.items() if value is not None}
    if "kind" in ATTACKS[name]:
        keys = {key: value for key, value in keys.items() if key not in ("lhs", "rhs", "parameters")}
    keys |= {"id": name} | ({"parameters": {"x": "real"}} if keys["kind"] == "equality-only" else {})
    return replace(claim_from(keys), budget=budget)


def answered(worker, name, budget, processor_seconds):
    """Judge an attack, and tell how long the processor worked for that beyond the start of a process."""
    worker._running()
    used = processor_seconds()
    told = worker.judge(attack(name, budget))
    return told, processor_seconds() - used


@pytest.mark.parametrize(
    "name", ["products of sums", "many coordinates", "derivatives of towers", "a large bracket"]
)
def test_a_verdict_is_there_within_half_a_second_of_its_budget(worker, name, processor_seconds):
    """Whatever SymPy is at work on. A shared core makes seconds longer, never shorter: the best of three counts."""
    for budget in (0.1, 0.4):
        assert any(answered(worker, name, budget, processor_seconds)[1] < budget + 0.5 for _ in range(3))


class Slow:
    """A process that is ready at once, and answers after so many seconds each on a clock of its own."""

    usable, pid, processor_seconds = True, 0, None

    def __init__(self, *answers):
        self.answers, self.now = [(0.0, b"ready"), (0.0, HEARD), *answers], 100.0

    def monotonic(self):
        return self.now

    def receive(self, deadline):
        seconds, answer = self.answers.pop(0)
        if self.now + seconds > deadline:
            self.now = deadline
            raise Late
        self.now += seconds
        return answer

    def send(self, make, seconds):
        make()

    def kill(self):
        pass


def said_of_good(*, last):
    return json.dumps({"id": "good", "kind": "equality-only", "status": "holds", "last": last}).encode()


@pytest.mark.parametrize(
    ("answers", "waited"),
    [
        ([(0.75, said_of_good(last=True))], 0.75),
        ([(0.25, said_of_good(last=False)), (0.5, said_of_good(last=True))], 0.25),
        ([(9.0, said_of_good(last=True))], 1.0 + GRACE),
    ],
    ids=["verdict", "explanation", "no answer"],
)
def test_the_seconds_that_are_told_are_those_for_which_a_verdict_was_waited(monkeypatch, answers, waited):
    slow = Slow(*answers)
    monkeypatch.setattr(judging_process, "time", slow)
    told = Worker(slow).judge(replace(claim_from(GOOD), budget=1.0))
    assert told.seconds == pytest.approx(waited, abs=1e-12)
    assert told.status == ("undecided" if waited > 1.0 else "holds")


@pytest.mark.slow
def test_attacks_are_answered_in_their_budget_and_the_next_claim_is_judged(
    tmp_path, monkeypatch, processor_seconds
):
    monkeypatch.chdir(tmp_path)
    budget = 1.0
    with Worker() as worker:
        for name in ATTACKS:
            told, seconds = answered(worker, name, budget, processor_seconds)
            assert told.status in ("invalid", "undecided", "fails", "holds"), name
            assert told.status != "holds" or name in TRUE, (
                name,
                told,
            )
            assert seconds < budget + GRACE + 0.5, name
            for text in (told.known, told.feedback, *told.lines()):
                assert "Traceback" not in text
                assert "broke off" not in text, name
                assert "Error" not in text, (name, text)
            assert len(json.dumps(told.to_dict())) < 20_000, name
            assert worker.judge(claim_from(GOOD)).status == "holds", name
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name", ["code", "look-alike letters", "10**5 terms", "LaTeX braces", "tower", "one long name"]
)
def test_some_attacks_are_invalid_at_once(worker, name, processor_seconds):
    told, seconds = answered(worker, name, 5.0, processor_seconds)
    assert told.status == "invalid"
    assert "column" in told.known
    assert seconds < 2.0


def test_numbers_too_large_to_be_computed_with_are_named(worker):
    """Never by the words of Python; and what stands beside them is judged."""
    for name in (name for name in ATTACKS if "tower" in name):
        told = worker.judge(attack(name, 3.0))
        assert told.status in ("invalid", "undecided", "fails"), name
        for text in (told.known, told.feedback, *told.lines()):
            assert "Error" not in text, (name, text)
            assert "broke off" not in text, (name, text)
            assert "int too large" not in text, (name, text)
    for lhs, rhs in (("exp(1000)*exp(x)", "exp(x + 1000)"), ("sin(10**50 + x - x)", "sin(10**50)")):
        keys = {"id": "r", "kind": "equality-only", "lhs": lhs, "rhs": rhs, "parameters": {"x": "real"}}
        assert worker.judge(claim_from(keys)).status == "holds", lhs
        assert worker.judge(claim_from({**keys, "rhs": f"{rhs} + 1"})).status == "fails", lhs


def test_a_page_of_attacks_is_written_in_no_time():
    from canon.exercise.report.judgement import Judgement
    from canon.exercise.report.page import page
    from canon.exercise.report.report import Report

    claims = tuple(attack(name, 1.0) for name in ATTACKS)
    report = Report("attacks", tuple(Judgement(c.id, c.kind, "invalid", known="no") for c in claims), claims)
    start = time.process_time()
    text = page(report)
    assert time.process_time() - start < 10.0
    assert len(text) < 3_000_000
    assert "<script" not in text


TOKENS = [
    "theta", "x", "m", "g", "l", "E", "V", "f", "t", "I", "pi", "theta_dot", "θ̈", "'", "''", "2", "0", "0.5",
    "1e3", "9" * 50, "10**9", "+", "-", "*", "/", "**", "(", ")", "(", ")", ",", "=", "<", ">=", "!=", " ",
    "  ", "sin(", "sqrt(", "log(", "exp(", "Abs(", "Max(", "atan2(", "Piecewise((", "Derivative(", "LambertW(",
    "Ne(", "True", "[m/s^2]", "m/s^2", "kg", "[", "]", "^", "²", "{", "}", "\\frac", "\\dot", "\\ddot",
    "\\theta", "\\sin", "\\left(", "\\right)", "\\mathrm{m}", "\\sqrt", "_1", "_", "$", "|", "e", "d",
    "\\partial", "\\,", "zz", "λ", "ｘ", "\u202e", "\x00", "\n", "1/", "x**x**",
]  # fmt: skip
(THETA, X), (M, G, L, E) = coordinates("theta x"), parameters("m g l E")
SCOPE = Scope({s.name: s for s in (THETA, X, M, G, L, E)}, {"V": ("x",), "f": ("x", "t")})


def refused_at(parse, text, scope):
    """Return the column at which a text is refused, 0 where it is read."""
    try:
        parse(text, scope)
    except LanguageError as error:
        return error.column if str(error) else -1
    return 0


@pytest.mark.slow
def test_forty_thousand_soups_of_tokens():
    """Whatever is thrown together, it is read or refused at a column of it; as a formula it is set or left as text."""
    read = 0
    for number in range(40_000):
        chance = random.Random(number)
        text = "".join(chance.choice(TOKENS) for _ in range(chance.randrange(1, 14)))
        text = f"${text}" if chance.random() < 0.35 else text
        scope = replace(SCOPE, implicit=chance.random() < 0.5)
        for parse in (parse_equation, parse_condition):
            column = refused_at(parse, text, scope)
            read += column == 0
            assert 0 <= column <= len(text) + 1, text
        formula(text, scope)
    assert read > 500
