"""What the numeric rows share: references, canon's outcome with its estimate, and the ordinary integrators."""

from __future__ import annotations

import importlib.util
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon import AccuracyWarning, Hamiltonian, Taylor, propagate
from canon.flow import NonFiniteStateError
from extremes.row import Outcome, Row, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Truth = Callable[[np.ndarray], np.ndarray]

__all__ = ["Problem", "by_taylor", "motion_row", "outcome_of", "truth_from", "with_warnings"]


@dataclass(frozen=True)
class Problem:
    """A Hamiltonian with its numbers put in, a start, a span, and its true motion."""

    hamiltonian: Hamiltonian
    y0: tuple[Any, ...]
    span: tuple[float, float]
    truth: Callable[[np.ndarray], np.ndarray]
    """States (2n, times) at times, as floats or numbers of more digits."""


def by_taylor(
    H: Hamiltonian, y0: Any, precision: str | int = "quad", t0: float = 0.0
) -> Callable[[np.ndarray], np.ndarray]:
    """Return the motion by heyoka's Taylor method in higher precision."""

    def truth(t: np.ndarray) -> np.ndarray:
        found = propagate(H, (t0, float(t[-1])), y0, method=Taylor(), precision=precision, times=t[1:])
        return found.y.astype(np.longdouble) + found.carried

    return truth


def truth_from(f: Callable[[float], list[Any]]) -> Callable[[np.ndarray], np.ndarray]:
    """Return a truth made of states at single times."""
    return lambda t: np.array([f(float(x)) for x in t], dtype=object).T


def sizes(y: np.ndarray) -> np.ndarray:
    largest = abs(y).max(axis=1, keepdims=True).astype(float)
    n = len(largest) // 2
    blocks = np.repeat([largest[:n].max(), largest[n:].max()], n)[:, np.newaxis]
    found = np.maximum(largest, 1e-10 * blocks)
    return np.where(found > 0, found, 1.0)


def with_warnings(run: Callable[[], Any]) -> tuple[Any, str]:
    """Return what a run returns, and canon's warning of it."""
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        found = run()
    said = [str(w.message) for w in seen if issubclass(w.category, AccuracyWarning)]
    return found, said[0] if said else ""


def missed(y: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Return the true error so far, in parts of each component's size, shape (times,)."""
    exactly = truth if truth.dtype == object else truth.astype(np.longdouble)
    own = y if truth.dtype != object else np.frompyfunc(_wide, 1, 1)(y)
    away = abs(own - exactly).astype(float)
    return np.maximum.accumulate((away / sizes(y)).max(axis=0))


def _wide(x: float) -> Any:
    import mpmath

    return mpmath.mpf(float(x))


def outcome_of(motion: Any, truth: np.ndarray, warning: str = "") -> Outcome:
    """Return a motion's true error beside its own estimate, as far as that says that the motion means something."""
    estimate = motion.error_estimate()
    stated = (estimate.error / sizes(motion.y)).max(axis=0)
    means = stated < 0.1
    last = len(means) - 1 if means.all() else max(int(np.argmin(means)) - 1, 0)
    error = missed(motion.y, truth)
    words = str(estimate).split("; by ")[0]
    said = shown((f"warning: {warning}; " if warning else "") + words, 320)
    return Outcome(
        said,
        float(error[last]),
        float(stated[last]),
        refused=last < len(means) - 1 and error[last] <= stated[last],
    )


def motion_row(
    name: str,
    tried: str,
    problem: Callable[[], Problem],
    how: Mapping[str, Any],
    *,
    samples: int = 20,
    others: tuple[str, ...] = ("SciPy DOP853", "heyoka"),
    extra: Mapping[str, Callable[[], Outcome]] | None = None,
    limit: float = 60.0,
) -> Row:
    """Return the row of one motion: canon with its estimate, SciPy and heyoka with what they leave."""

    def canon() -> Outcome:
        given = problem()
        try:
            motion, warning = with_warnings(
                lambda: propagate(given.hamiltonian, given.span, given.y0, samples=samples, **how)
            )
        except NonFiniteStateError as error:
            return Outcome(shown(f"NonFiniteStateError: {error}"), refused=True)
        return outcome_of(motion, given.truth(motion.t), warning)

    tools = {"SciPy DOP853": lambda: dop853(problem(), samples), "heyoka": lambda: heyoka(problem(), samples)}
    chosen = {tool: run for tool, run in tools.items() if tool in others}
    return Row(name, tried, canon, chosen | dict(extra or {}), limit=limit)


def gradients(given: Problem) -> tuple[list[Any], list[Any]]:
    """Return the variables and their rates, as anyone would write them with SymPy."""
    h = given.hamiltonian
    rates = [sp.diff(h.H, p) for p in h.p] + [-sp.diff(h.H, q) for q in h.q]
    names = {s: sp.Symbol(f"v{i}") for i, s in enumerate((*h.q, *h.p))}
    return list(names.values()), [_in_doubles(rate.xreplace(names)) for rate in rates]


def _in_doubles(f: Any) -> Any:
    """heyoka takes no fractions but those that doubles are."""
    odd = [r for r in f.atoms(sp.Rational) if r.q & (r.q - 1) or abs(r) > 2**52]
    return f.xreplace({r: sp.Float(float(r), 17) for r in odd})


def dop853(given: Problem, samples: int, tolerance: float = 1e-12) -> Outcome:
    """SciPy's DOP853 on the lambdified equations."""
    from scipy.integrate import solve_ivp

    state, rates = gradients(given)
    f = sp.lambdify([given.hamiltonian.t, state], rates, "numpy")
    t = np.linspace(*given.span, samples + 1)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        y0 = [float(v) for v in given.y0]
        found = solve_ivp(f, given.span, y0, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=t)
    if not found.success:
        return Outcome(
            shown(f"stops at t = {found.t[-1] if len(found.t) else given.span[0]:g}: {found.message}"),
            refused=True,
        )
    return plain(found.y, given.truth(t), f"{found.nfev} evaluations, success")


def heyoka(given: Problem, samples: int) -> Outcome:
    """heyoka's Taylor integrator as its tutorial uses it."""
    import heyoka as hy

    state, rates = gradients(given)
    names = {s: hy.expression(f"v{i}") for i, s in enumerate(state)}
    pairs = [
        (names[s], hy.from_sympy(sp.sympify(r), {**names, given.hamiltonian.t: hy.time}))
        for s, r in zip(state, rates, strict=True)
    ]
    integrator = hy.taylor_adaptive(pairs, [float(v) for v in given.y0], time=float(given.span[0]))
    t = np.linspace(*given.span, samples + 1)
    outcome, _, _, steps, _, found = integrator.propagate_grid(t)
    if outcome != hy.taylor_outcome.time_limit:
        return Outcome(f"{outcome} at t = {integrator.time:g} after {steps} steps", refused=True)
    return plain(np.array(found).T, given.truth(t), f"{steps} steps, {str(outcome).split('.')[-1]}")


def plain(y: np.ndarray, truth: np.ndarray, said: str) -> Outcome:
    """Return the outcome of a tool that states no error: wrong where nothing of the motion is right."""
    if not np.isfinite(y).all():
        return Outcome(f"{said}, but the states hold NaN or inf", right=False)
    error = float(missed(y, truth)[-1])
    return Outcome(said, error, right=False if error > 0.1 else None)


def rebound_installed() -> bool:
    return importlib.util.find_spec("rebound") is not None
