"""System extremes: threads, forks, interrupts, memory, homes, locales, dependencies and processors."""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from extremes.row import Outcome, Row, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(__file__).parents[2]

USES = """
import hashlib, numpy as np, sympy as sp
from canon import Gauss, Hamiltonian, RK4, Splitting, Taylor, coordinates, propagate, vanishes
def proof():
    x = sp.Symbol("x", real=True)
    held = vanishes(sp.sin(x)**2 + sp.cos(x)**2 - 1).status.value
    return held, vanishes(sp.sin(2*x) - 2*sp.sin(x)).status.value
def motion(method=None, precision="double"):
    q = coordinates("q")
    p = q.momentum
    pendulum = Hamiltonian(p**2/2 - sp.cos(q), [q], [p])
    step = None if isinstance(method, Taylor) else 0.05
    method = method or Splitting("blanes-moan-4")
    return propagate(pendulum, (1.25, 0.5), (0.0, 100.0), method=method, step=step, precision=precision)
def bits(found):
    return hashlib.sha256(np.ascontiguousarray(np.asarray(found.q, float)).tobytes()).hexdigest()[:32]
"""
"""A proof and a motion, for scripts of their own."""


def rows() -> Iterator[Row]:
    """Yield the rows."""
    yield from _together()
    yield from _ended()
    yield from _surroundings()
    yield from _processors()
    yield from _versions()


def ran(
    script: str, expected: str, *, python: str = sys.executable, timeout: float = 100.0, **how: Any
) -> Outcome:
    """Run a script in an interpreter of its own and judge its last line."""
    options = how.pop("options", ())
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **how.pop("env", {})}
    environment = {name: value for name, value in environment.items() if value is not None}
    done = subprocess.run(
        [python, *options, "-c", USES + script], capture_output=True, text=True, timeout=timeout,
        env=environment, check=False, **how,
    )  # fmt: skip
    last = (done.stdout.strip().splitlines() or [""])[-1]
    if done.returncode == 0:
        return Outcome(shown(last, 160), right=re.search(expected, last) is not None)
    error = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
    return Outcome(shown(f"status {done.returncode}: {error}", 160), right=False)


def _prove(k: int) -> str:
    import sympy as sp

    from canon import vanishes

    x = sp.Symbol("x", real=True)
    zero = sp.expand((x + sp.sqrt(k + 2)) ** 6) - (x + sp.sqrt(k + 2)) ** 6
    return vanishes(zero).status.value + vanishes(zero + x).status.value


def _move(k: int) -> str:
    import numpy as np
    import sympy as sp

    from canon import Hamiltonian, Splitting, coordinates, propagate

    q = coordinates("q")
    pendulum = Hamiltonian(q.momentum**2 / 2 - sp.cos(q), [q], [q.momentum])
    found = propagate(
        pendulum, (0.0, 50.0), (1.0 + k / 100, 0.5), method=Splitting("blanes-moan-4"), step=0.05
    )
    return hashlib.sha256(np.ascontiguousarray(found.q).tobytes()).hexdigest()


def _in_threads(work: Callable[[int], str]) -> Outcome:
    alone = [work(k) for k in range(6)]
    found = [""] * 6

    def do(k: int) -> None:
        found[k] = work(k)

    threads = [threading.Thread(target=do, args=(k,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return Outcome(
        f"6 threads: {sum(a == b for a, b in zip(alone, found, strict=True))} of 6 as alone",
        right=alone == found,
    )


def _in_processes(work: Callable[[int], str], how: str) -> Outcome:
    alone = [work(k) for k in range(2)]
    with multiprocessing.get_context(how).Pool(2) as pool:
        found = pool.map_async(work, range(2)).get(timeout=60)
    return Outcome(
        f"2 processes ({how}): {sum(a == b for a, b in zip(alone, found, strict=True))} of 2 as alone",
        right=alone == found,
    )


def _together() -> Iterator[Row]:
    for name, work, said in (
        ("proofs", _prove, "six proofs and their twins"), ("motions", _move, "six motions, compiled each, bit for bit")
    ):  # fmt: skip
        yield Row(
            f"threads-{name}",
            f"{said} in six threads at once",
            lambda work=work: _in_threads(work),
            limit=120.0,
        )
        for how in ("fork", "spawn"):
            yield Row(
                f"{how}-{name}", f"two processes at once by {how} after the parent used canon",
                lambda work=work, how=how: _in_processes(work, how), limit=120.0,
            )  # fmt: skip

    def fork_while_compiling() -> Outcome:
        _move(0)  # a module half imported at the fork stays locked in the child: that is Python's, not ours
        stop = threading.Event()

        def compile_on() -> None:
            k = 0
            while not stop.is_set():
                k += 1
                _move(k)

        thread = threading.Thread(target=compile_on)
        thread.start()
        time.sleep(1.0)
        ended = 0
        for _ in range(5):
            pid = os.fork()
            if pid == 0:
                os._exit(0 if _move(1) else 1)
            deadline = time.monotonic() + 30.0
            while time.monotonic() < deadline:
                done, status = os.waitpid(pid, os.WNOHANG)
                if done:
                    ended += status == 0
                    break
                time.sleep(0.05)
            else:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
        stop.set()
        thread.join()
        return Outcome(f"{ended} of 5 children compiled and ran", right=ended == 5)

    yield Row(
        "fork-while-compiling", "five children forked while another thread compiles; each compiles too",
        fork_while_compiling, limit=200.0,
    )  # fmt: skip


def _ended() -> Iterator[Row]:
    def interrupted() -> Outcome:
        script = USES + (
            "print('ready', flush=True)\n"
            "s = sp.symbols('s0:9', real=True)\n"
            "from canon import Domain\nfrom canon.proof.worker.budget import prove_in_worker\n"
            "hard = sp.Add(*(sp.sin(sp.Add(*s)*k)*sp.sqrt(sp.Add(*s[:k])) for k in range(1, 9)))**9 - 1\n"
            "try:\n    prove_in_worker([hard], Domain(), 60.0)\nexcept KeyboardInterrupt:\n    "
            "print('stopped', flush=True)\n"
            "print(*proof(), flush=True)\n"
        )
        return _interrupted(script, "stopped", "holds fails")

    def interrupted_motion() -> Outcome:
        script = USES + (
            "motion()\nprint('ready', flush=True)\n"
            "q = coordinates('q')\n"
            "try:\n    propagate(Hamiltonian(q.momentum**2/2 - sp.cos(q), [q], [q.momentum]), (0.0, 1e8), "
            "(1.25, 0.5), method=Splitting('verlet'), step=0.01, samples=3)\n"
            "except BaseException as e:\n    print(type(e).__name__, flush=True)\n"
            "print(*proof(), flush=True)\n"
        )
        return _interrupted(script, "Interrupted|KeyboardInterrupt", "holds fails")

    yield Row(
        "interrupt-proof", "SIGINT during a proof of a minute; the next proof works", interrupted, limit=90.0
    )
    yield Row(
        "interrupt-motion", "SIGINT during 10¹⁰ steps; what follows works", interrupted_motion, limit=90.0
    )

    def in_a_kernel() -> Outcome:
        from jupyter_client.manager import start_new_kernel

        manager, client = start_new_kernel(env={**os.environ, "PYTHONPATH": str(ROOT)})
        try:
            hard = (
                "s = sp.symbols('s0:9', real=True)\nfrom canon import Domain\n"
                "from canon.proof.worker.budget import prove_in_worker\n"
                "prove_in_worker([sp.Add(*(sp.sin(sp.Add(*s)*k)*sp.sqrt(sp.Add(*s[:k])) for k in range(1, "
                "9)))**9 - 1], Domain(), 60.0)"
            )
            client.execute_interactive(USES, timeout=60, output_hook=lambda _: None)
            asked = client.execute(hard)
            time.sleep(3.0)
            sent = time.monotonic()
            manager.interrupt_kernel()
            while (reply := client.get_shell_msg(timeout=30))["parent_header"].get("msg_id") != asked:
                pass
            seconds = time.monotonic() - sent
            time.sleep(1.0)  # a kernel drops what was asked right after an error
            said: list[str] = []
            client.execute_interactive(
                "print(*proof())", timeout=60,
                output_hook=lambda m: said.append(str(m["content"].get("text", ""))),
            )  # fmt: skip
            name, after = reply["content"].get("ename"), "".join(said).strip()
            return Outcome(
                f"{name} after {seconds:.1f} s, then {after}",
                right=name == "KeyboardInterrupt" and seconds < 3.0 and after == "holds fails",
            )
        finally:
            client.stop_channels()
            manager.shutdown_kernel(now=True)

    yield Row(
        "interrupt-jupyter",
        "a Jupyter kernel interrupted during a proof; the next cell works",
        in_a_kernel,
        limit=120.0,
    )

    limited = "import resource\nresource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))\n"
    yield Row(
        "memory-1GiB-proof", "RLIMIT_AS of 1 GiB: proofs",
        lambda: ran(limited + "print(*proof())", "holds fails"), limit=120.0,
    )  # fmt: skip
    yield Row(
        "memory-1GiB-motion", "RLIMIT_AS of 1 GiB: a compiled motion",
        lambda: ran(limited + "print(motion().q.shape[1] > 1)", "True"), limit=120.0,
    )  # fmt: skip
    yield Row(
        "memory-1GiB-sheet", "RLIMIT_AS of 1 GiB: a sheet judged by workers",
        lambda: ran(
            limited + "from canon import check\nfrom canon.exercise import Claim, Sheet\n"
            "print(check(Sheet('s', (Claim('a', 'equality-only', {'lhs': '1+1', 'rhs': '2'}),))).counts)",
            "'holds': 1",
        ),
        limit=120.0,
    )  # fmt: skip
    yield Row(
        "memory-300MiB-swelling", "a claim whose proof swells, in 300 MiB more than the interpreter has",
        lambda: ran(
            "import resource, os\nproof()\nused = int(open('/proc/self/statm').read().split()[0])*4096\n"
            "resource.setrlimit(resource.RLIMIT_AS, (used + 300*2**20,)*2)\n"
            "s = sp.symbols('s0:12', real=True)\n"
            "print(vanishes(sp.expand(sp.Add(*s)**4) - sp.Add(*s)**4 + sp.sin(sp.Add(*s))**40 - "
            "(1-sp.cos(sp.Add(*s))**2)**20, budget=10.0).status.value)",
            "holds|undecided",
        ),
        limit=120.0,
    )  # fmt: skip


def _interrupted(script: str, first: str, then: str) -> Outcome:
    listening = (
        "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"  # in the background too
    )
    process = subprocess.Popen(
        [sys.executable, "-c", listening + script], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(3.0)
    sent = time.monotonic()
    process.send_signal(signal.SIGINT)
    line = process.stdout.readline().strip()
    seconds = time.monotonic() - sent
    rest = process.stdout.read().strip()
    right = re.search(first, line) is not None and seconds < 3.0 and then in rest and process.wait() == 0
    return Outcome(shown(f"{line} after {seconds:.2f} s, then {rest}", 160), right=right)


def _surroundings() -> Iterator[Row]:
    both = "print(*proof(), motion().q.shape[1] > 1)"
    good = "holds fails True"
    yield Row(
        "home-read-only", "HOME is no folder that can be written, nor is the current one",
        lambda: ran(both, good, env={"HOME": "/proc/1/none"}, cwd="/proc"), limit=120.0,
    )  # fmt: skip
    yield Row(
        "home-none",
        "no HOME, no TMPDIR, no user name",
        lambda: ran(both, good, env={"HOME": None, "TMPDIR": None, "USER": None, "LOGNAME": None}),
        limit=120.0,
    )
    yield Row(
        "environment-empty",
        "an empty environment but for the path of the package",
        lambda: ran(both, good, env=dict.fromkeys(os.environ, None) | {"PYTHONPATH": str(ROOT)}),
        limit=120.0,
    )
    yield Row("python-O", "python -O: no assertions", lambda: ran(both, good, options=("-O",)), limit=120.0)
    yield Row(
        "python-OO",
        "python -OO: no docstrings either",
        lambda: ran(both, good, options=("-OO",)),
        limit=120.0,
    )
    yield Row(
        "python-I-u",
        "python -u -X dev, warnings are errors",
        lambda: ran(both, good, options=("-u", "-X", "dev", "-W", "error")),
        limit=120.0,
    )
    yield Row("ascii-only", "LC_ALL=C, standard output in ASCII", lambda: ran(
        "from canon import judge\nfrom canon.exercise import Claim\n"
        "v = str(judge(Claim('a', 'lie-bracket', {'x': ['x'], 'X': ['x'], "
        "'Y': ['1'], 'claim': ['1']})))\nprint(v.split()[0])",
        "FAILS",
        env={"LC_ALL": "C", "PYTHONIOENCODING": "ascii:backslashreplace", "PYTHONUTF8": "0"}), limit=120.0)  # fmt: skip
    yield Row("cli-ascii", "canon check where the terminal knows ASCII only", _check_in_ascii, limit=120.0)
    yield Row(
        "locale-comma",
        "a locale with decimal commas (de_DE), set for the C library too",
        _with_commas,
        limit=120.0,
    )
    yield Row("digits-limit", "int_max_str_digits of 640", lambda: ran(
        "import sys\nsys.set_int_max_str_digits(640)\nx = sp.Symbol('x', real=True)\n"
        "print(vanishes((x + 1)*10**3000 - x*10**3000 - 10**3000).status.value, vanishes(x*10**3000 - "
        "x).status.value)",
        "holds fails"), limit=120.0)  # fmt: skip
    yield Row("recursion-limit", "a recursion limit of 200", lambda: ran(
        "import sys\nproof()\nsys.setrecursionlimit(200)\nx = sp.Symbol('x', "
        "real=True)\nprint(vanishes(sp.sin(x)**2 + sp.cos(x)**2 - 1).status.value)",
        "holds|undecided"), limit=120.0)  # fmt: skip
    yield Row(
        "no-file-descriptors",
        "at most 16 open files",
        lambda: ran("import resource\nresource.setrlimit(resource.RLIMIT_NOFILE, (16, 16))\n" + both, good),
        limit=120.0,
    )
    yield Row(
        "closed-stdin",
        "standard input closed",
        lambda: ran("import os\nos.close(0)\n" + both, good),
        limit=120.0,
    )


def _check_in_ascii() -> Outcome:
    with tempfile.TemporaryDirectory() as folder:
        sheet = Path(folder, "s.json")
        sheet.write_text(
            '{"claims": [{"id": "θ", "kind": "equality-only", "lhs": "θ", "rhs": "2*θ", '
            '"parameters": {"theta": "real"}}]}',
            encoding="utf-8",
        )
        done = subprocess.run(
            [sys.executable, "-m", "canon.cli", "check", str(sheet)], capture_output=True, check=False,
            env={**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
        )  # fmt: skip
    said = (done.stdout + done.stderr).decode("ascii", "replace")
    return Outcome(
        shown(f"status {done.returncode}: {said}", 120),
        right=done.returncode == 1 and "Traceback" not in said,
    )


def _with_commas() -> Outcome:
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run(
            ["localedef", "-i", "de_DE", "-f", "UTF-8", f"{folder}/de_DE.UTF-8"],
            capture_output=True,
            check=False,
        )
        if made.returncode not in (0, 1) or not Path(folder, "de_DE.UTF-8").exists():
            return Outcome("the locale could not be made here, so this was not tried", refused=True)
        script = (
            "import locale\nbefore = bits(motion())\nlocale.setlocale(locale.LC_ALL, 'de_DE.UTF-8')\n"
            "assert locale.localeconv()['decimal_point'] == ','\n"
            "import ctypes\nassert b',' in (lambda b: (ctypes.CDLL(None).snprintf(b, 20, b'%.1f', "
            "ctypes.c_double(1.5)), b.value)[1])(ctypes.create_string_buffer(20))\n"
            "x = sp.Symbol('x', real=True)\nfound = vanishes(x - sp.Rational(3, 2))\n"
            "print(*proof(), bits(motion()) == before, found.counterexample.left)"
        )
        return ran(script, r"holds fails True -?\d+\.\d+", env={"LOCPATH": folder})


def _processors() -> Iterator[Row]:
    yield Row(
        "x86-64-targets",
        "pendulum and Kepler by splitting, Gauss and Runge–Kutta methods, doubles and double-doubles, "
        "compiled for the host, "
        "AVX2 without AVX-512 and FMA, and baseline x86-64: bit for bit",
        _targets, limit=300.0,
    )  # fmt: skip
    yield Row(
        "aarch64-assembly", "the same loops compiled for aarch64 with LLVM; fused operations would change bits",
        _aarch64, limit=200.0,
    )  # fmt: skip


CASES = """
import canon.kernel.llvm.machine_code as L
import llvmlite.binding as llvm
def target(cpu, features):
    def machine():
        llvm.initialize_native_target(); llvm.initialize_native_asmprinter()
        return llvm.Target.from_default_triple().create_target_machine(cpu=cpu, features=features, opt=3, jit=True)
    L._target_machine = machine
    L.simd_bytes.cache_clear()
def kepler(method, precision):
    x, y = coordinates("x y")
    H = Hamiltonian((x.momentum**2 + y.momentum**2)/2 - 1/sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum])
    return propagate(H, (0.0, 20.0), (0.4, 0.0, 0.0, 2.0), method=method, step=0.01, precision=precision)
def all_bits():
    found = []
    for run in (motion, kepler):
        for method in (Splitting("verlet"), Splitting("kahan-li-8"), Gauss(2), RK4()):
            for precision in ("double", "double-double"):
                try:
                    found.append(bits(run(method, precision)))
                except (ValueError, TypeError, NotImplementedError) as error:
                    found.append(type(error).__name__ + str(error)[:60])
    return found
"""


def _targets() -> Outcome:
    script = CASES + (
        "host = all_bits()\n"
        "lanes = L.simd_bytes\n"
        "target('haswell', '+avx2,-fma,-avx512f')\navx2 = all_bits()\n"
        "target('x86-64', '')\nL.simd_bytes = lambda: 16\nbase = all_bits()\n"
        "ran = sum(len(b) == 32 for b in host)\n"
        "print(ran, 'of', len(host), 'ran;', sum(a == b for a, b in zip(host, avx2)), 'alike with AVX2,', "
        "sum(a == b for a, b in zip(host, base)), 'with baseline', 'SAME' if host == avx2 == base and ran > "
        "8 else 'DIFFERENT', [h for h in host if len(h) != 32][:1])"
    )
    return ran(script, "SAME", timeout=290)


def _aarch64() -> Outcome:
    script = CASES + (
        "llvm.initialize_all_targets(); llvm.initialize_all_asmprinters()\n"
        "kept = []\nplain = llvm.parse_assembly\n"
        "def parse(ir, *rest):\n    kept.append(ir)\n    return plain(ir, *rest)\n"
        "llvm.parse_assembly = parse\nall_bits()\n"
        "llvm.parse_assembly = plain\n"
        "machine = llvm.Target.from_triple('aarch64-unknown-linux-gnu').create_target_machine(cpu='generic', opt=3)\n"
        "lines = fused = x87 = bad = 0\n"
        "for ir in kept:\n"
        "    if 'x86_fp80' in ir:\n        x87 += 1\n        continue\n"
        "    module = llvm.parse_assembly(ir)\n"
        "    module.triple = 'aarch64-unknown-linux-gnu'\n"
        "    tuning = llvm.create_pipeline_tuning_options(speed_level=3)\n"
        "    builder = llvm.create_pass_builder(machine, tuning)\n"
        "    builder.getModulePassManager().run(module, builder)\n"
        "    text = machine.emit_assembly(module)\n"
        "    lines += text.count(chr(10))\n"
        "    here = sum(text.count(w) for w in ('fmadd', 'fmla', 'fmsub', 'fnmsub', 'fmls', 'fnmadd'))\n"
        "    fused += here; bad += here and 'llvm.fma' not in ir\n"
        "asked = sum(ir.count('llvm.fma') for ir in kept)\n"
        "print(len(kept), 'modules,', lines, 'lines of aarch64,', fused, 'fused operations,', asked, 'asked "
        "for,', x87, 'of x87 numbers left out,', bad, 'modules with fused operations that did not ask', "
        "'BAD' if bad or x87 or not kept else 'GOOD')"
    )
    return ran(script, "GOOD", timeout=190)


def _versions() -> Iterator[Row]:
    for variable, said in (
        ("CANON_OLDEST_PYTHON", "the oldest supported dependencies"),
        ("CANON_NEWEST_PYTHON", "the newest Python and dependencies"),
    ):  # fmt: skip
        yield Row(
            variable.removeprefix("CANON_").removesuffix("_PYTHON").lower(),
            f"{said} (the interpreter named by {variable})",
            lambda variable=variable: _of_versions(variable), limit=200.0,
        )  # fmt: skip


def _of_versions(variable: str) -> Outcome:
    python = os.environ.get(variable, "")
    if not python:
        return Outcome(f"{variable} is not set, so this was not tried", refused=True)
    return ran(
        "import sys, importlib.metadata as m\n"
        "names = ('sympy', 'numpy', 'scipy', 'heyoka', 'llvmlite', 'python-flint', 'lark')\n"
        "print(*proof(), motion().q.shape[1] > 1, motion(Taylor()).q.shape[1] > 1, 'Python', "
        "sys.version.split()[0], *(f'{n} {m.version(n)}' for n in names))",
        "holds fails True True", python=python, timeout=190,
    )  # fmt: skip
