"""Zero test: canon.proof against SymPy's simplify, equals and is_zero on the corpus of identities.

    python benchmarks/zero_test.py                  # canon alone, and the large cases
    python benchmarks/zero_test.py --peers          # with SymPy's own (many minutes: each claim up to the limit)
    python benchmarks/zero_test.py --peers --every 10 --limit 5

Each peer works in a process of its own that is killed when a claim exceeds the limit.
"""

from __future__ import annotations

import argparse
import queue
import statistics
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import sympy as sp

sys.path.insert(0, str(Path(__file__).parents[1]))
from canon.proof import Domain, equal, vanishes
from tests.data.identities.load import identities

PEERS = ("simplify", "equals", "is_zero")


@dataclass
class Score:
    """What one method said."""

    right_true: int = 0
    right_false: int = 0
    wrong: list[str] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)
    out_of_time: int = 0
    seconds: list[float] = field(default_factory=list)

    def count(self, name: str, truth: bool, said: bool | None, seconds: float) -> None:
        self.seconds.append(seconds)
        if said is None:
            self.undecided.append(name)
        elif said != truth:
            self.wrong.append(name)
        elif truth:
            self.right_true += 1
        else:
            self.right_false += 1

    def row(self, name: str, true: int, false: int) -> str:
        ordered = sorted(self.seconds)
        return (
            f"{name:10} {self.right_true:5}/{true:<5} {self.right_false:5}/{false:<5} {len(self.wrong):6} "
            f"{len(self.undecided):10} {self.out_of_time:8} {1e3 * statistics.median(ordered):10.2f} "
            f"{1e3 * ordered[int(0.95 * (len(ordered) - 1))]:10.1f} {sum(ordered):9.1f}"
        )


def ask_canon(chosen: list, budget: float) -> Score:
    score = Score()
    for identity in chosen:
        domain = Domain(conditions=identity.conditions, box=identity.box)
        start = time.perf_counter()
        verdict = equal(identity.lhs, identity.rhs, domain, budget)
        seconds = time.perf_counter() - start
        score.count(identity.id, identity.truth, None if verdict.undecided else verdict.holds, seconds)
    return score


def peer_answer(name: str, difference: sp.Expr) -> bool | None:
    match name:
        case "simplify":
            return sp.simplify(difference) == 0
        case "equals":
            return difference.equals(0)
        case _:
            return difference.is_zero


def answer_as_peer(name: str, every: int, first: int) -> None:
    """Answer one claim a line, from claim ``first`` on."""
    for number, identity in enumerate(identities()[::every]):
        if number < first:
            continue
        start = time.perf_counter()
        try:
            said = peer_answer(name, identity.lhs - identity.rhs)
        except Exception:  # noqa: BLE001  whatever a peer raises is "no answer"
            said = None
        print(number, {True: 1, False: 0, None: -1}[said], time.perf_counter() - start, flush=True)


def ask_peer(name: str, chosen: list, every: int, limit: float) -> Score:
    score = Score()
    number = 0
    while number < len(chosen):
        command = [sys.executable, __file__, "--as-peer", name, "--every", str(every), "--first", str(number)]
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ) as process:
            lines: queue.SimpleQueue[str] = queue.SimpleQueue()
            threading.Thread(
                target=lambda p=process, q=lines: [q.put(s) for s in p.stdout], daemon=True
            ).start()
            patience = limit + 20.0
            while number < len(chosen):
                identity = chosen[number]
                try:
                    _, said, seconds = lines.get(timeout=patience).split()
                except queue.Empty:
                    score.out_of_time += 1
                    score.count(identity.id, identity.truth, None, limit)
                    number += 1
                    process.kill()
                    break
                answer = {"1": True, "0": False, "-1": None}[said]
                score.count(identity.id, identity.truth, answer, float(seconds))
                number += 1
                patience = limit
    return score


def leapfrog_residual(n: int, steps: int, *, wrong: bool = False) -> sp.Matrix:
    """Return MᵀJM − J for the Jacobian M of leapfrog steps of a chain of n coupled pendulums."""
    q, p = (list(sp.symbols(f"{name}1:{n + 1}", real=True)) for name in "qp")
    x = sp.symbols(f"x1:{n + 1}", real=True)
    h = sp.Symbol("h", positive=True)
    V = -sum(sp.cos(x[i + 1] - x[i]) for i in range(n - 1)) - sum(map(sp.cos, x))
    gradient, hessian = [V.diff(s) for s in x], sp.hessian(V, x)
    M = sp.eye(2 * n)
    for _ in range(steps):
        for kick, drift in ((h / 2, h), (h / 2, 0)):
            at = dict(zip(x, q, strict=True))
            K = sp.eye(2 * n)
            K[n:, :n] = -kick * hessian.xreplace(at)
            p = [p_i - kick * g.xreplace(at) for p_i, g in zip(p, gradient, strict=True)]
            D = sp.eye(2 * n)
            D[:n, n:] = drift * sp.eye(n)
            q = [q_i + drift * p_i for q_i, p_i in zip(q, p, strict=True)]
            M = D * K * M
    if wrong:
        M[0, n] += h**3 / 10**9
    J = sp.zeros(2 * n)
    J[:n, n:], J[n:, :n] = sp.eye(n), -sp.eye(n)
    return M.T * J * M - J


def runge_lenz_residuals() -> list[sp.Expr]:
    """Return {A_i, A_j} + 2mH ε_ijk L_k and {L_i, A_j} − ε_ijk A_k for the Kepler problem, all zero."""
    q, p = sp.symbols("x y z", real=True), sp.symbols("p_x p_y p_z", real=True)
    m, k = sp.symbols("m k", positive=True)
    r = sp.sqrt(sum(s**2 for s in q))
    H = sum(s**2 for s in p) / (2 * m) - k / r
    L = sp.Matrix(q).cross(sp.Matrix(p))
    A = sp.Matrix(p).cross(L) - m * k * sp.Matrix(q) / r

    def bracket(f: sp.Expr, g: sp.Expr) -> sp.Expr:
        return sum(f.diff(a) * g.diff(b) - f.diff(b) * g.diff(a) for a, b in zip(q, p, strict=True))

    found = []
    for i in range(3):
        found.append(bracket(A[i], H))
        for j in range(3):
            found.append(
                bracket(A[i], A[j]) + 2 * m * H * sum(sp.LeviCivita(i, j, s) * L[s] for s in range(3))
            )
            found.append(bracket(L[i], A[j]) - sum(sp.LeviCivita(i, j, s) * A[s] for s in range(3)))
    return found


def large_cases() -> None:
    print("\nlarge cases")
    start = time.perf_counter()
    verdicts = [vanishes(residual) for residual in runge_lenz_residuals()]
    print(
        f"  Runge–Lenz brackets, {len(verdicts)}: {time.perf_counter() - start:.2f} s,",
        "all proved" if all(v.holds for v in verdicts) else [v.status.value for v in verdicts],
    )
    for n, steps in ((3, 2), (10, 1), (10, 2), (10, 3)):
        for wrong in (True, False):
            residual = leapfrog_residual(n, steps, wrong=wrong)
            start = time.perf_counter()
            verdict = vanishes(residual, budget=20.0)
            kind = "with an error of 1e-9 h³" if wrong else "true"
            print(
                f"  leapfrog, n = {n}, {steps} steps, {2 * n}×{2 * n}, {kind}:",
                f"{time.perf_counter() - start:.2f} s, {verdict.status.value}",
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--every", type=int, default=1, help="take every n-th identity")
    parser.add_argument("--limit", type=float, default=10.0, help="seconds a claim")
    parser.add_argument("--as-peer", choices=PEERS, help=argparse.SUPPRESS)
    parser.add_argument("--first", type=int, default=0, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.as_peer:
        answer_as_peer(chosen.as_peer, chosen.every, chosen.first)
        return
    corpus = identities()[:: chosen.every]
    true = sum(identity.truth for identity in corpus)
    print(
        f"{len(corpus)} identities, {true} true and {len(corpus) - true} false, at most {chosen.limit:g} s each"
    )
    print(
        f"{'':10} {'proved':>11} {'refuted':>11} {'wrong':>6} {'undecided':>10} {'too long':>8}"
        f" {'median ms':>10} {'95 % ms':>10} {'total s':>9}"
    )
    score = ask_canon(corpus, chosen.limit)
    print(score.row("canon", true, len(corpus) - true))
    if score.wrong or score.undecided:
        print("  wrong:", *score.wrong, "| undecided:", *score.undecided)
    if chosen.peers:
        for name in PEERS:
            peer = ask_peer(name, corpus, chosen.every, chosen.limit)
            print(peer.row(name, true, len(corpus) - true), flush=True)
    large_cases()


if __name__ == "__main__":
    main()
