"""Methods of fixed step size: their compiled loops, their coefficients, ensembles and sampling."""

from __future__ import annotations

import dataclasses
import functools
import math
import os
import threading
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.job import Watch
from canon.flow.measure import values_in
from canon.flow.method import RK4, FixedStep, Gauss, Splitting
from canon.flow.partial import PartialSteps, State, coefficient_pairs
from canon.flow.sampling import Plan, Sampling, fixed_plan, steps_over
from canon.flow.solvable import SolvableSplitting
from canon.flow.solvable import loop_of as solvable_loop_of
from canon.flow.stepping import Interruption, Run, run
from canon.flow.trajectory import Array, Samples
from canon.flow.watchful import run_with_events
from canon.kernel.gauss import gauss_coefficients, gauss_loop
from canon.kernel.llvm import simd_bytes
from canon.kernel.loop import Loop, runge_kutta_loop, splitting_loop
from canon.kernel.machine import DOUBLE, DOUBLE_DOUBLE, MachineType
from canon.kernel.watch import watching_function, wide_number

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.flow.event import Prepared
    from canon.flow.job import Memory
    from canon.flow.precision import Precision
    from canon.kernel.llvm import MachineCode
    from canon.kernel.structure import Equations

__all__ = ["compiled_loop", "fixed_steps", "planned", "steps_between", "watch_for"]

_KEPT = 64
"""Compiled loops kept for the next call."""

_INTERLEAVED = 4
"""SIMD registers' worth of orbits stepped together: while one waits for a root or a quotient, others compute."""

_SMALL = 200
"""Up to this many operations in the force the registers hold that many orbits."""


def compiled_loop(system: Equations, method: FixedStep, precision: Precision, orbits: int = 1) -> Loop:
    """Return the machine code that steps a system with a method, kept from an earlier call if there was one.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    orbits
        How many orbits will be stepped together: several run side by side in SIMD lanes.

    Raises
    ------
    ValueError
        A splitting is asked of a Hamiltonian that does not split; a Nyström method of one whose kinetic energy
        is not quadratic; or a Gauss method in other numbers than doubles and double-double.
    """
    if isinstance(method, Splitting) and method.parts is not None:
        method = SolvableSplitting(method.scheme, parts=method.parts)
    if isinstance(method, SolvableSplitting):
        return solvable_loop_of(system, method, precision)
    number = _with_lanes(precision.number, system) if orbits > 1 else precision.number
    if isinstance(method, Gauss):
        if precision.number not in (DOUBLE, DOUBLE_DOUBLE):
            raise ValueError(
                f"precision={precision.name!r}: Gauss methods have 'double', 'compensated' and 'double-double'"
            )
        return _kept_gauss(system, method.stages, precision.number, compensated=precision.compensated)
    if isinstance(method, RK4):
        return _kept_runge_kutta(system, number, compensated=precision.compensated)
    if not system.separable:
        raise ValueError(
            "H is not a sum T(p, t) + V(q, t), so it does not split into drifts and kicks; use Gauss(6), which is "
            "symplectic for every H, or Taylor()"
        )
    if method.scheme.nystrom and not system.quadratic_kinetic:
        raise ValueError(
            f"{method} keeps its order only for kinetic energies quadratic in p with constant coefficients; "
            "use Splitting('blanes-moan-6') or Splitting('kahan-li-8')"
        )
    kick_first = method.scheme.kick_first and system.autonomous
    return _kept_splitting(
        system, len(method.scheme.b), number, compensated=precision.compensated, kick_first=kick_first
    )


def _with_lanes(number: MachineType, system: Equations) -> MachineType:
    if number.scalar == "x86_fp80":  # x87 numbers have no SIMD instructions
        return number
    small = len(system.program(system.force).instructions) <= _SMALL
    return dataclasses.replace(
        number, lanes=simd_bytes() // number.alignment * (_INTERLEAVED if small else 1)
    )


@functools.lru_cache(maxsize=_KEPT)
def _kept_splitting(
    system: Equations, stages: int, number: MachineType, *, compensated: bool, kick_first: bool
) -> Loop:
    return splitting_loop(system, stages, number=number, compensated=compensated, kick_first=kick_first)


@functools.lru_cache(maxsize=_KEPT)
def _kept_runge_kutta(system: Equations, number: MachineType, *, compensated: bool) -> Loop:
    return runge_kutta_loop(system, number=number, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_gauss(system: Equations, stages: int, number: MachineType, *, compensated: bool) -> Loop:
    return gauss_loop(system, stages, compensated=compensated, number=number)


def planned(wanted: Sampling, step: float | None, method: FixedStep) -> Plan:
    """Return the plan of a run: the largest step, not above the given one, that divides the span.

    Raises
    ------
    ValueError
        The step is missing or makes no sense.
    """
    steps = steps_over(wanted.start, wanted.end, step, method)
    return fixed_plan(wanted.start, (wanted.end - wanted.start) / steps, tuple(wanted.stops(steps)))


def steps_between(loop: Loop, method: FixedStep, plan: Plan) -> PartialSteps:
    """Return what takes steps of any length between those of a run."""
    assert plan.h is not None
    coefficients = loop.coefficients or functools.partial(_coefficients, method, loop.number)
    return PartialSteps(loop, coefficients, plan.start, plan.h)


def fixed_steps(
    system: Equations,
    loop: Loop,
    method: FixedStep,
    states: tuple[Array, Array],
    plan: Plan,
    progress: Callable[[float], None],
    watch: Watch | None = None,
    so_far: Samples | None = None,
    events: Sequence[Prepared] = (),
) -> Samples:
    """Step along a plan and sample on the way; an interruption ends that at the last sample reached by all orbits.

    Parameters
    ----------
    system
        The equations.
    loop, method
        The compiled loop and the method it was compiled for.
    states
        The states to start from as sums of two doubles, each of shape (2n, orbits).
    plan
        The steps, and after which of them to sample.
    progress
        Called now and then with the fraction done.
    watch
        Observables to follow inside the loop.
    so_far
        What was done before, where the motion is resumed.
    events
        Events, of one orbit.
    """
    steps, orbits = steps_between(loop, method, plan), states[0].shape[1]
    first = 0 if so_far is None else len(so_far.t) - 1
    stops, memory = plan.stops[first:], None if so_far is None else so_far.beyond
    if watch is not None and not np.diff([stop // watch.cadence for stop in stops]).all():
        raise ValueError(
            f"cadence={watch.cadence} steps is longer than the shortest interval between samples, "
            f"{int(np.diff(stops).min())} steps: take a smaller cadence or fewer samples"
        )
    pairs = coefficient_pairs(steps.coefficients, steps.t0, steps.h)
    met, end = (), Fraction(0)
    if events:
        start = State(*states, memory)
        found, met, end = run_with_events(system, steps, start, stops, events, progress)
        runs = [found]
    else:
        runs = _on_threads(loop, states, pairs, stops, progress, watch, memory, np.array(system.rows))
    samples = min(found.high.shape[1] for found in runs)
    runs = [found.first(samples) for found in runs]
    high, low = (np.concatenate(parts, axis=2) for parts in ([r.high for r in runs], [r.low for r in runs]))
    t = plan.instants[first : first + samples].copy()
    taken = stops[samples - 1] - stops[0]
    if met and met[-1].event.action == "stop":
        t[-1], taken = met[-1].t, math.ceil(end) - stops[0]
    beyond = np.concatenate([found.beyond[-1] for found in runs])
    iterations = taken * orbits
    if loop.implicit:
        iterations = round(float(beyond[:, 0].sum() - (0 if memory is None else memory[:, 0].sum())))
    return Samples(
        t=t,
        y=high[:, :, :orbits],
        carried=low[:, :, :orbits],
        steps=taken,
        evaluations=iterations * method.stages,
        step=float(steps.h),
        cpu_seconds=sum(r.cpu_seconds for r in runs),
        compile_seconds=loop.code.seconds,
        watched=_statistics(runs, stops[:samples], watch, orbits),
        beyond=beyond,
        crossings=met,
    )


def watch_for(
    system: Equations,
    nodes: Sequence[int],
    loop: Loop,
    states: tuple[Array, Array],
    t0: Fraction,
    cadence: int,
) -> Watch:
    """Return what follows nodes of a system's graph inside a loop, every so many steps.

    Raises
    ------
    ValueError
        The cadence is no positive whole number; or the state is in x87 numbers or double-double and an
        observable holds a function that double-double does not have.
    """
    if cadence < 1 or cadence != int(cadence):
        raise ValueError(f"cadence={cadence}: give a number of steps, 1 or more")
    wide = wide_number(loop.number)
    high, low = states
    if not loop.compensated:  # the loop starts from the state rounded to its numbers
        one = dataclasses.replace(loop.number, lanes=1)
        high, low = (part.reshape(high.shape) for part in one.unpacked(one.packed(high.ravel(), low.ravel())))
    found = values_in(wide, system, nodes, float(t0), high, low)
    start = np.moveaxis(found, 0, 1)
    return Watch(_kept_watching(system, tuple(nodes), loop), int(cadence), start)


@functools.lru_cache(maxsize=_KEPT)
def _kept_watching(system: Equations, nodes: tuple[int, ...], loop: Loop) -> MachineCode:
    return watching_function(system, nodes, loop)


def _statistics(runs: Sequence[Run], stops: Sequence[int], watch: Watch | None, orbits: int) -> Array | None:
    """Return mean, least and greatest change, shape (observables, 3, times − 1, orbits)."""
    parts = [each.watched for each in runs if each.watched is not None]
    if watch is None or not parts:
        return None
    if len(stops) == 1:
        return np.empty((watch.start.shape[1], 3, 0, orbits))
    found = np.concatenate(parts, axis=1)[:, :orbits].transpose(2, 3, 0, 1).copy()
    counts = np.diff([stop // watch.cadence for stop in stops])
    found[:, 0] /= counts[:, np.newaxis]
    if not np.isfinite(found).all():
        raise ArithmeticError(
            "the energy or an observable was not finite inside the loop: it left its own domain"
        )
    return found


def _on_threads(
    loop: Loop,
    states: tuple[Array, Array],
    coefficients: tuple[Array, Array],
    stops: Sequence[int],
    progress: Callable[[float], None],
    watch: Watch | None,
    memory: Memory | None,
    rows: Memory,
) -> list[Run]:
    """Run orbits on as many threads as there are processors, each a whole number of blocks."""
    (high, low), lanes = states, loop.number.lanes
    orbits = high.shape[1]
    blocks = -(-orbits // lanes)
    if blocks == 1 and lanes == 1:
        return [run(loop, high, low, coefficients, stops, progress, watch, memory, rows)]
    # The last block is filled up with copies of the last orbit.
    filled = np.minimum(np.arange(blocks * lanes), orbits - 1)
    parts = np.array_split(filled.reshape(blocks, lanes), min(os.cpu_count() or 1, blocks))
    own_blocks = np.array_split(np.arange(blocks), len(parts))
    stopped, done, lock = threading.Event(), [0.0] * len(parts), threading.Lock()

    def part(k: int) -> Run:
        def report(fraction: float) -> None:
            if stopped.is_set():
                raise Interruption
            with lock:
                done[k] = fraction
                if k == 0:
                    progress(min(done))

        chosen = parts[k].ravel()
        own = None if watch is None else dataclasses.replace(watch, start=watch.start[chosen])
        kept = None if memory is None else memory[own_blocks[k]]
        found = run(loop, high[:, chosen], low[:, chosen], coefficients, stops, report, own, kept, rows)
        if found.high.shape[1] < len(stops):
            stopped.set()
        return found

    with ThreadPoolExecutor(len(parts)) as pool:
        futures = [pool.submit(part, k) for k in range(len(parts))]
        try:
            wait(futures, return_when=FIRST_EXCEPTION)
        except KeyboardInterrupt:
            pass
        finally:
            stopped.set()
        found = [future.result() for future in futures]
    if min(each.high.shape[1] for each in found) == len(stops):
        progress(1.0)
    return found


def _coefficients(method: FixedStep, number: MachineType, h: Fraction) -> list[Fraction]:
    if isinstance(method, Gauss):
        return gauss_coefficients(method.stages, h, number)
    if isinstance(method, RK4):
        return [h / 2, h / 6, h / 3]
    a, b = method.scheme.a, method.scheme.b
    return [h * c for pair in zip(a, b, strict=False) for c in pair] + [h * a[-1]]
