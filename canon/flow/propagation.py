"""Propagation: from a system and a starting state to a trajectory, and from one prepared system and many states."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Never

from canon.flow.checked_request import hamilton_equations_of
from canon.flow.request import Request, refuse_unknown
from canon.flow.run.hamiltonian_system import HamiltonianSystem
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run_record import recorded
from canon.flow.system_request import any_task, course_before_start, task_from
from canon.flow.trajectory import Interrupted, Trajectory, finished
from canon.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr, Symbol

    from canon.flow.checked_request import HamiltonianCourse
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.run.event import Event
    from canon.flow.system.recognised_system import MovableSystem

__all__ = [
    "HamiltonianSystem", "Interrupted", "NonFiniteStateError", "PreparedMotion", "Trajectory", "is_separable",
    "prepare", "prepared", "propagate", "propagated",
]  # fmt: skip


def propagate(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    max_step: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    times: npt.ArrayLike | None = None,
    observables: Mapping[str, Expr] | None = None,
    cadence: int | None = None,
    events: Sequence[Event] = (),
    dense: bool = False,
    progress: Callable[[float], None] | bool | None = None,
    **unknown: Never,
) -> Trajectory:
    """Integrate the equations of motion of any system from a starting state.

    Parameters
    ----------
    system
        In any consistent units. The time in it is ``canon.time``, the same symbol as ``sympy.Symbol("t", real=True)``;
        a bare ``Symbol("t")``, as SymPy's ``dynamicsymbols._t`` is, is taken for it. The state y0 is in this order:

        - a Hamiltonian: (q, p);
        - a Lagrangian with its forces, or a ``ConstrainedLagrangian``: (q, q̇). Constraints are differentiated and
          stabilised, so that they stay kept to round-off; those that follow from others at the start are left out;
        - a ``UnilateralLagrangian``, whose contacts open and close: (q, q̇); ``motion.regimes`` says which held when;
        - ``GibbsAppell``, SymPy's ``KanesMethod``: (q, u) with the quasi-velocities u;
        - ``NewtonEuler``: (q, q̇), the reactions being known along the motion by their names;
        - a ``Routhian``: (q, s, q̇, p) with the ignored coordinates s, which are reconstructed, and their momenta;
        - a ``PoissonSystem``, such as a rotating body: its variables;
        - a ``VectorField``, or heyoka's list of pairs (variable, right-hand side): their variables;
        - a function f(t, y) as SciPy's ``solve_ivp`` takes it: y. It is read as formulas, see
          :func:`canon.mechanics.field_of_function`;
        - SymPy's ``LagrangesMethod``: (q, q̇);
        - a scene or its name: (q, p) where a Hamiltonian says all, else (q, q̇); its parameters have values already.
    t_span
        The first and the last time; the last may be the earlier one. Two equal times are refused.
    y0
        The starting state, shape (2n,), or many of them, shape (2n, orbits); or a number for each variable by symbol or
        name, ``{theta: 0.1, "theta_dot": 0}``. Floats are taken for the numbers they are; text, fractions and long
        doubles keep what a double would lose. A pandas series or frame and an xarray array are read by their labels as
        a mapping is, in order where the labels are 0, 1, …. Of a scene: the name of one of its starts, the first where
        not given.
    method
        ``Splitting(...)``, ``Gauss(...)``, ``RK4()``, ``Taylor(...)`` or ``DOP853(...)``; ``Taylor()`` where
        not given. By exactly solvable parts: ``WisdomHolman(...)``, ``SABA(...)``, ``SBAB(...)``; with steps that
        vary: ``TimeTransformed(...)``; explicit where H does not split: ``canon.flow.SemiexplicitSplitting(...)`` and
        ``canon.flow.ExtendedPhaseSpace(...)``; for holonomic constraints ``canon.flow.Rattle(...)``; for
        constraints on velocities ``canon.flow.NonholonomicLeapfrog(...)``; for rotating bodies
        ``canon.flow.LiePoissonSplitting(...)``; for charges in fields ``canon.flow.Boris(...)`` and
        ``canon.flow.MagneticSplitting(...)``; not symplectic, but keeping the energy:
        ``canon.flow.AverageVectorField(...)``; for a Lagrangian with its forces
        ``canon.flow.GalerkinVariational(...)``. Or a method by its name, such as ``"verlet"``,
        ``"kahan-li-8"``, ``"RK4"``, ``"gauss-6"``, ``"taylor"``, ``"saba-4"``: case, hyphens and blanks are of
        no account, and all names are on the page *My problem is …*. The number in ``"gauss-6"`` and ``"saba-4"`` is
        that of the stages, in ``"kahan-li-8"`` and most others that of the order.
    step
        Step size of a fixed-step method. The step taken is the largest one not above it that divides the
        span; ``Trajectory.step`` has it, and a motion is resumed to a time a whole number of those away. Of a
        time-transformed method: the size in t of the first step.
    tolerance
        Relative tolerance of an adaptive method, in place of the method's own. Of Taylor's method it is a part of the
        largest number in the state, coordinates and momenta alike, in whatever units: a variable that is small beside
        it may have as many digits less. Of DOP853 it is a part of each component and of the largest of its kind, see
        :class:`canon.DOP853`.
    max_step
        The longest step that an adaptive method may take; as long as its tolerance allows where not given.
    precision
        Fixed steps: ``"single"``, ``"double"``, ``"compensated"`` (the default: doubles, what rounding takes
        from the state being carried along so that little is lost), ``"extended"`` (64 bits, x86 only),
        ``"double-double"`` (106 bits; all functions but the inverse hyperbolic ones). Taylor: ``"double"``,
        ``"extended"``, ``"quad"`` or decimal digits. What is beyond doubles stands in ``Trajectory.carried``.
    parameters
        A number for every parameter of H, by symbol or name; or, where it differs from orbit to orbit, an array
        of shape (orbits,), beside numbers for the others. A single start, shape (2n,), is then that of every orbit.
    samples
        How many sampled states to keep after the first, 1 or more, evenly spaced up to a step; 1000 where not given,
        and with fixed steps no more than there are. Of one time-transformed orbit: about so many up to twice as many,
        evenly spaced in steps.
    times
        In place of ``samples``: times at which to keep the state, within the span, in the order in which they are
        passed (falling, where the last time is the earlier one), each once. Both ends of the span are kept as well
        where they are not among the times. Taylor and DOP853 are evaluated exactly there; methods of fixed steps keep
        the state after the step nearest to each, and ``Trajectory.t`` has the times of those steps. Time-transformed
        methods land there: each state is reached from the motion's last step before by a part of a step, found in
        about two trials, which leaves the motion as it is.
    observables
        Further functions of (q, p, t) to evaluate at the samples, by name.
    cadence
        Follow H and the observables inside the loop of a fixed-step method too, every so many steps, in wider
        numbers than the state's: ``Trajectory.statistics`` has of each the mean, the least and the greatest
        change over every block of steps between two samples, and running extremes. 10⁹ steps with
        ``samples=1000, cadence=1`` keep 1000 rows.
    events
        What is to happen where functions of the state cross zero, see :class:`canon.Event`. Many orbits go one by one
        then, each as by itself, and ``motion.events[k]`` has those of orbit k.
    dense
        Keep Taylor's polynomials, so that the trajectory can be called with any time: ``motion(t)``. Methods of
        fixed steps need nothing kept for that.
    progress
        A function to call now and then with the fraction done, 0 … 1; or True for a bar with an estimate on
        standard error, where that is a terminal.
    **unknown
        Nothing: what other libraries call an argument (``t_eval``, ``rtol``, ``args``, …) is refused with a sentence
        that names the one here.

    Returns
    -------
    Trajectory
        Sampled states, energies evaluated in higher precision than the states, and the cost. What moves is read
        by name, ``motion["theta"]``. Where forces or the time do work, that is integrated along, by whatever method,
        and ``energy_error`` is the defect of the energy balance; not so of a Hamiltonian that depends on time, whose
        ``energy_change`` is the work, and of which there is no ``energy_error``. Many orbits
        run side by side in SIMD lanes and on threads (splittings and RK4) and give arrays with a last axis
        for the orbits. Time-transformed orbits have steps of their own and run one by one, their states kept at
        common times.

    Raises
    ------
    KeyError
        A parameter has no value or a value is for no parameter, a variable no start; nothing has such a name.
    TypeError
        What was given is no system that moves, or there is no such argument.
    ValueError
        A start is not on the constraints, or the equations do not determine the accelerations there.
    ValueError
        The state's shape is wrong or it is not finite; a step is missing or makes no sense; the Hamiltonian
        is not separable and the method a splitting.
    NonFiniteStateError
        The motion ran into a collision or out of H's domain, or the stages of an implicit method did not
        converge; the error has the last good time and state.
    Interrupted
        Ctrl-C: a KeyboardInterrupt whose ``motion`` is the trajectory so far; ``motion.resume()`` completes it.

    Examples
    --------
    >>> from canon import Hamiltonian, Splitting, coordinates, parameters, propagate
    >>> import sympy
    >>> theta = coordinates("theta")
    >>> g = parameters("g", positive=True)
    >>> pendulum = Hamiltonian(theta.momentum**2 / 2 - g * sympy.cos(theta), [theta], [theta.momentum])
    >>> motion = propagate(
    ...     pendulum, (0, 1000), [1.0, 0.0], method=Splitting("kahan-li-8"), step=0.1, parameters={g: 9.81}
    ... )
    >>> motion.steps, bool(abs(motion.energy_error).max() < 1e-8)
    (10000, True)

    A Lagrangian with damping, and a scene:

    >>> from canon import Lagrangian
    >>> L = Lagrangian(theta.dot**2 / 2 + g * sympy.cos(theta), [theta], forces=[-theta.dot / 5])
    >>> damped = propagate(L, (0, 20), {theta: 1, theta.dot: 0}, parameters={g: 9.81})
    >>> float(damped["theta"][-1].round(6)), bool(abs(damped.energy_error).max() < 1e-14)
    (0.048501, True)
    >>> propagate("rolling-disc", (0, 1)).residuals.shape
    (2, 1001)
    """
    refuse_unknown(unknown)
    return propagated(
        Request(
            system, t_span, y0, method=method, step=step, tolerance=tolerance, max_step=max_step,
            precision=precision, parameters=parameters, samples=samples, times=times, observables=observables,
            cadence=cadence, events=events, dense=dense,
        ),
        progress,
    )  # fmt: skip


def propagated(request: Request, progress: Callable[[float], None] | bool | None = None) -> Trajectory:
    """Return the motion of a request, as :func:`propagate` does.

    Raises
    ------
    KeyError, TypeError, ValueError, NonFiniteStateError, Interrupted
        As :func:`propagate` documents them.
    """
    task, moving = any_task(request)
    with reporting(progress) as report:
        return finished(recorded(task, report, moving=moving))


@dataclass(frozen=True, eq=False)
class PreparedMotion:
    """A motion without its start, made by :func:`canon.flow.prepare`.

    Parameters
    ----------
    request
        What is to be done, as :func:`canon.propagate` takes it.
    course
        What was made of it before any start; None of systems whose equations depend on the start.
    """

    request: Request
    course: HamiltonianCourse | None = field(repr=False)

    def propagate(
        self,
        y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
        *,
        progress: Callable[[float], None] | bool | None = None,
    ) -> Trajectory:
        """Return the motion from a start, bit for bit the one of :func:`canon.propagate`.

        Parameters
        ----------
        y0, progress
            As :func:`canon.propagate` takes them.

        Raises
        ------
        KeyError, TypeError, ValueError, NonFiniteStateError, Interrupted
            As :func:`canon.propagate` documents them; all that depends on the start is checked each time.

        Examples
        --------
        >>> from canon.flow import prepare
        >>> prepare("kepler", (0, 10), samples=2).propagate([1.0, 0.0, 0.0]).final
        Traceback (most recent call last):
            ...
        ValueError: y0 has shape (3,); 2 coordinates and 2 momenta make a state (q, p) of shape (4,), ...
        """
        if self.course is None:
            return propagated(replace(self.request, y0=y0), progress)
        task = task_from(self.course, self.request, y0)
        with reporting(progress) as report:
            return finished(recorded(task, report))


def prepare(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    max_step: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    times: npt.ArrayLike | None = None,
    observables: Mapping[str, Expr] | None = None,
    cadence: int | None = None,
    events: Sequence[Event] = (),
    dense: bool = False,
    **unknown: Never,
) -> PreparedMotion:
    """Check and work out all of a motion but its start, for many starts one after the other.

    A call of its ``propagate`` takes a part of the time that :func:`canon.propagate` takes beside the steps
    (``benchmarks/preparation.py``), and finds the same to the last bit. Many starts that are known together go side
    by side instead, ``propagate(system, t_span, y0)`` with y0 of shape (2n, orbits).

    Parameters
    ----------
    system, t_span, method, step, tolerance, max_step, precision, parameters, samples, times, observables, cadence
        As :func:`canon.propagate` takes them. Gained is on Hamiltonians, their scenes and maps; the equations of other
        systems depend on where they start, and are looked at each time.
    events, dense
        Likewise.
    **unknown
        Nothing: what other libraries call an argument is refused, as by :func:`canon.propagate`.

    Returns
    -------
    PreparedMotion
        A frozen value; ``prepared.propagate(y0)`` returns a :class:`canon.flow.Trajectory`.

    Raises
    ------
    KeyError, TypeError, ValueError
        As :func:`canon.propagate`, for what is wrong whatever the start.

    Examples
    --------
    >>> from canon import Splitting, propagate
    >>> from canon.flow import prepare
    >>> by = {"method": Splitting("kahan-li-8"), "step": 0.1, "samples": 10}
    >>> prepared = prepare("simple-pendulum", (0, 100), **by)
    >>> motions = [prepared.propagate([angle, 0.0]) for angle in (0.5, 1.0, 1.5)]
    >>> alone = propagate("simple-pendulum", (0, 100), [1.5, 0.0], **by)
    >>> bool((motions[2].y == alone.y).all()), bool(abs(motions[0].energy_error).max() < 1e-8)
    (True, True)
    """
    refuse_unknown(unknown, "prepare")
    return prepared(
        Request(
            system, t_span, method=method, step=step, tolerance=tolerance, max_step=max_step, precision=precision,
            parameters=parameters, samples=samples, times=times, observables=observables, cadence=cadence,
            events=events, dense=dense,
        )
    )  # fmt: skip


def prepared(request: Request) -> PreparedMotion:
    """Return the motion of a request without its start, as :func:`prepare` does.

    Raises
    ------
    KeyError, TypeError, ValueError
        As :func:`canon.propagate` documents them.
    """
    return PreparedMotion(replace(request, y0=None), course_before_start(request))


def is_separable(hamiltonian: HamiltonianSystem, parameters: Mapping[Symbol | str, Any]) -> bool:
    """Tell whether H = T(p, t) + V(q, t), so that splitting methods apply.

    Parameters
    ----------
    hamiltonian
        The Hamiltonian.
    parameters
        A number for every parameter of H, by symbol or name.

    Examples
    --------
    >>> from canon.scene import find
    >>> kepler, pendulum = find("kepler"), find("double-pendulum")
    >>> is_separable(kepler.hamiltonian, kepler.values), is_separable(pendulum.hamiltonian, pendulum.values)
    (True, False)
    """
    return hamilton_equations_of(hamiltonian, parameters).separable
