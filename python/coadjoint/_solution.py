"""Runs and what comes of them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._errors import asking
from ._state import Array, State, aligned, numbers
from ._system import BoundSystem, arity, scheme_name

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas


def span_of(t_span: Any) -> tuple[float, float]:
    """Start and end of a run."""
    span = numbers(t_span, "t_span")
    if span.shape == ():
        span = np.array([0.0, float(span)])
    if span.shape != (2,) or not np.isfinite(span).all():
        raise ValueError(f"t_span must be an end, or a start and an end, finite; not {t_span!r}")
    return float(span[0]), float(span[1])


def step_of(step: Any, span: tuple[float, float]) -> float:
    """The step in the direction of the span, which alone says where a run goes."""
    if isinstance(step, bool) or not isinstance(step, (int, float, np.floating, np.integer)):
        raise TypeError(f"the step must be a number, not {type(step).__name__}")
    step = float(step)
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step is a length, finite and above zero, and `t_span` says the direction: not {step}")
    return math.copysign(step, span[1] - span[0])


def law(system: BoundSystem, controls: Any) -> tuple[Any, str, Callable[[float], Array] | None]:
    """A law as the native half takes it, its kind, and the function if it is one of time."""
    layout = system.system._controls
    if controls is None:
        return None, "held", None
    if not layout.quantities:
        raise ValueError(f"{system.name} has no controls")
    if callable(controls):

        def chosen(value: Any) -> Array:
            if value is None:
                raise TypeError("the function of the controls returned None")
            return system._control(value)

        if arity(controls) == 1:

            def driven(t: float) -> Array:
                return chosen(controls(t))

            return ("driven", driven, None), "driven", driven

        def feedback(t: float, y: Array) -> Array:
            return chosen(controls(t, State(system.system._state, y)))

        return ("feedback", feedback, None), "feedback", None
    if isinstance(controls, tuple) and len(controls) == 2 and not np.isscalar(controls[0]):
        times = numbers(controls[0], "the times of the controls")
        if times.ndim != 1 or not len(times) or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
            raise ValueError("the times of the controls must be finite, and increase")
        values = layout.rows(controls[1], None, np.zeros(layout.length)) if isinstance(controls[1], Mapping) else numbers(
            controls[1], "the controls"
        )
        values = values.reshape(len(times), -1) if values.ndim == 1 and layout.length == 1 else values
        if values.shape != (len(times), layout.length):
            raise ValueError(f"the controls: an array of shape {values.shape} in place of ({len(times)}, {layout.length})")
        return ("grid", times, np.ascontiguousarray(values).ravel()), "grid", None
    return system._control(controls), "held", None


def watched(system: BoundSystem, events: Any) -> list[Any]:
    """Events as the native half takes them."""
    if events is None:
        return []
    layout, all_ = system.system._state, [events] if callable(events) or isinstance(events, str) else list(events)
    made: list[Any] = []
    for event in all_:
        if isinstance(event, str):
            described = system._native.events
            if event not in described:
                known = f"it has {', '.join(f'`{name}`' for name in described)}" if described else "`event=` gives it some"
                raise ValueError(f"the description has no event {event!r}: {known}")
            made.append((described.index(event), 0.0, 0, None, None))
            continue
        if not callable(event):
            raise TypeError(f"an event is a function of `t, y`, or the name of one of the description's, not {type(event).__name__}")
        terminal, points = getattr(event, "terminal", 0), getattr(event, "points", None)
        apply = getattr(event, "apply", None)

        def condition(t: float, y: Array, event: Callable[..., Any] = event) -> float:
            return float(event(t, State(layout, y)))

        action = None
        if apply is not None:

            def action(t: float, y: Array, apply: Callable[..., Any] = apply) -> Array | None:
                state = State(layout, y)
                following = apply(t, state)
                # changed in place, or returned
                return state.flat if following is None else layout.flat(following, state.flat)

        if terminal is not True and (int(terminal) != terminal or terminal < 0):
            raise ValueError(f"`terminal` of an event must be a bool or a count, not {terminal!r}")
        made.append((condition, float(getattr(event, "direction", 0.0)), int(terminal), points, action))
    return made


def run(
    system: BoundSystem,
    y0: Any,
    t_span: Any,
    step: float | None,
    scheme: str | None,
    order: int | None,
    tolerance: float | None,
    max_step: float | None,
    controls: Any,
    events: Any,
    t_eval: ArrayLike | None,
    every: int,
    dense_output: bool | None,
    progress: Callable[[float], Any] | None,
) -> Solution:
    span = span_of(t_span)
    start = system._start(y0, span[0])
    if (step is None) == (tolerance is None):
        raise TypeError("a run needs either a `step` or a `tolerance`")
    if tolerance is not None and not (scheme is None and order is None):
        raise TypeError("a `tolerance` takes Taylor steps, of the order that it asks for: neither `scheme` nor `order` goes with it")
    if max_step is not None and (tolerance is None or not max_step > 0):
        raise ValueError(f"`max_step` is a positive bound of the steps that a `tolerance` chooses, not {max_step!r}")
    name = scheme_name(system.system, scheme, order)
    own = None if step is None else step_of(step, span)
    if int(every) != every or every < 1:
        raise ValueError(f"`every` must be a whole number of steps, 1 or more, not {every!r}")
    samples = None
    if t_eval is not None:
        samples = numbers(t_eval, "t_eval")
        forward = span[1] >= span[0]
        ordered = np.diff(samples) if forward else -np.diff(samples)
        low, high = min(span), max(span)
        if samples.ndim != 1 or not ((samples >= low) & (samples <= high)).all():
            raise ValueError(f"t_eval must be times within t_span = {span}")
        if (ordered <= 0).any():
            raise ValueError("t_eval must be in the order of the run, each time once")
    acting, kind, driven = law(system, controls)
    if kind == "driven" and tolerance is None and name.startswith("HamiltonJacobi"):
        what = "Hamilton–Jacobi steps hold the controls' value at their middle: with a function of time they are of order 2"
        warnings.warn(f"{what}; `order=4` composes steps that keep the order, and a `tolerance` follows it", stacklevel=3)
    if kind == "feedback" and tolerance is not None and max_step is None:
        what = "the law is asked before each step, and a `tolerance` knows nothing of its change within one: its steps may be long"
        warnings.warn(f"{what}; `max_step` bounds them, and a law that is written into the description is followed", stacklevel=3)
    dense = samples is None if dense_output is None else dense_output
    keeps = samples is None or dense
    watching = watched(system, events)
    with asking(system.system):
        found = system._native.run(
            name,
            start,
            span,
            step=own,
            tolerance=tolerance,
            max_step=max_step,
            controls=acting,
            every=int(every) if keeps else None,
            samples=samples,
            events=watching,
            progress=progress,
        )
    width, inputs = system.system._state.length, system.system._controls.length
    ticks = found["ticks"]
    shown = ticks if samples is None else found["samples"]
    times, flat, held = shown
    count = len(watching)
    t_events, y_events = [], []
    for number in range(count):
        hits = [one for one in found["events"] if one[0] == number]
        t_events.append(np.array([one[1] for one in hits]))
        states = np.array([one[2] for one in hits]).reshape(len(hits), width)
        y_events.append(State(system.system._state, states))
    error = found["error"]
    solution = Solution(
        system,
        times,
        State(system.system._state, flat.reshape(-1, width)),
        State(system.system._controls, held.reshape(-1, inputs)) if inputs else None,
        t_events,
        y_events,
        scheme=name,
        step=own,
        tolerance=tolerance,
        max_step=max_step,
        nsteps=found["steps"],
        niterations=found["iterations"],
        status=-1 if error is not None else 1 if found["stopped"] else 0,
        message=str(error) if error is not None else "",
    )
    solution._known = ticks if dense else None
    solution._driven = driven
    solution._exact = kind not in ("feedback", "grid") or every == 1
    solution.end = State(system.system._state, found["end"][1])
    solution.t_end = found["end"][0]
    if error is not None:
        error.solution = solution
        raise error
    return solution


class Solution:
    """What came of a run: times and states, and what follows from them.

    The words are scipy's where the things are: `t`, `t_events`, `y_events`, `status`, `nfev` is `niterations` here. `y` is by name, `sol.y.momentum`, with
    times along the first axis; `sol.y.flat` is the array as it is.
    """

    #: The system that moved.
    system: BoundSystem
    #: The times.
    t: Array
    #: The states at these times.
    y: State
    #: The controls that were held over the steps that led there, if there are any.
    controls: State | None
    #: For each event the times at which it came.
    t_events: list[Array]
    #: For each event the states that led there.
    y_events: list[State]
    #: 0 if the end was reached, 1 if an event ended the run, -1 if a step could not be taken.
    status: int
    #: What went wrong, if anything did.
    message: str
    #: The last state, and its time.
    end: State
    t_end: float

    def __init__(
        self,
        system: BoundSystem,
        t: Array,
        y: State,
        controls: State | None,
        t_events: list[Array],
        y_events: list[State],
        *,
        scheme: str,
        step: float | None,
        tolerance: float | None,
        max_step: float | None,
        nsteps: int,
        niterations: int,
        status: int,
        message: str,
    ) -> None:
        self.system, self.t, self.y, self.controls = system, t, y, controls
        self.t_events, self.y_events = t_events, y_events
        self.scheme, self.step, self.tolerance, self.max_step = scheme, step, tolerance, max_step
        self.nsteps, self.niterations, self.status, self.message = nsteps, niterations, status, message
        self._known: tuple[Array, Array, Array] | None = None
        self._driven: Callable[[float], Array] | None = None
        self._exact = True

    @property
    def success(self) -> bool:
        """Whether the end, or a terminal event, was reached."""
        return self.status >= 0

    @cached_property
    def energy(self) -> Array:
        """The energy at the times."""
        energies: Array = self.system.energy(self.y, self.t, None if self.controls is None else self.controls.flat)
        return energies

    @cached_property
    def casimirs(self) -> Array:
        """The Casimirs at the times, one column for each of `system.casimir_names`."""
        return self.system.casimirs(self.y)

    def __call__(self, t: ArrayLike) -> State:
        """The state at any time of the run, or at many: where the scheme's own shorter step leads to, on its group and with its Casimirs."""
        if self._known is None:
            raise ValueError("this solution has no dense output: run with `dense_output=True`, or without `t_eval`")
        if not self._exact:
            raise ValueError("what a law or a table held between recorded states is not kept: run with `every=1`")
        times = numbers(t, "t")
        ticks = self._known[0]
        low, high = min(ticks[0], ticks[-1]), max(ticks[0], ticks[-1])
        if not ((times >= low) & (times <= high)).all():
            raise ValueError(f"the solution is known from {low} to {high} alone")
        flat = self.system._native.dense(
            self.scheme,
            self._known,
            times.ravel(),
            step=self.step,
            tolerance=self.tolerance,
            max_step=self.max_step,
            input=self._driven,
        )
        return State(self.system.system._state, flat.reshape(*times.shape, self.system.system._state.length))

    def gradient(self, covectors: Any) -> Gradient:
        """The gradient of a function of the states, from its derivatives by them: backwards through all steps.

        covectors: the derivatives of the function by the numbers of `y.flat`, an array of that shape; or by those of the last state alone. The
        description needs `derivatives`, or `derivatives="state"` with `controls` and `parameters` where these are wanted, and every step must be
        recorded.
        """
        if self._known is None or self.tolerance is not None or self._driven is not None:
            raise ValueError("gradients are of runs with steps of one size that are all recorded, without a function of time")
        times, states, controls = self._known
        if self.nsteps != len(times) - 1:
            raise ValueError("every step must be recorded: run with `every=1`, and no events that change the state")
        width = self.system.system._state.length
        rows = states.reshape(-1, width)
        given = np.asarray(covectors.flat if isinstance(covectors, State) else covectors, dtype=np.float64)
        if given.shape == (width,):
            given = np.concatenate([np.zeros((len(rows) - 1, width)), given[None]])
        if given.shape != rows.shape:
            raise ValueError(f"covectors: an array of shape {given.shape} in place of {rows.shape} or ({width},)")
        native = self.system._native
        tangent = np.zeros((len(rows), native.dimension))
        for place in np.flatnonzero(given.any(axis=1)):
            tangent[place] = self.system.tangent_map(rows[place]).T @ given[place]
        with asking(self.system.system):
            first, by_parameters, by_controls = native.pull_back(self.scheme, times, states, controls, tangent.ravel())
        maps = self.system.tangent_map(rows[0])
        # the covector on the stored numbers that is least of those with this one on tangent vectors
        stored = maps @ np.linalg.solve(maps.T @ maps, first)
        layout = self.system.system
        inputs, parameters = layout._controls, layout._parameters
        # arrays of nothing where the description does not ask for them
        return Gradient(
            State(layout._state, stored),
            first,
            State(parameters, by_parameters) if by_parameters.size == parameters.length else None,
            State(inputs, by_controls.reshape(len(rows), inputs.length)) if inputs.length and by_controls.size else None,
        )

    def to_pandas(self) -> pandas.DataFrame:
        """A table: one column for each number of the state, its energy and its Casimirs, indexed by time."""
        import pandas as pd

        layout = self.system.system._state
        table = pd.DataFrame(self.y.flat, index=pd.Index(self.t, name="t"), columns=layout.columns(), copy=False)
        more = {"energy": self.energy}
        more |= dict(zip(self.system.system.casimir_names, self.casimirs.T, strict=True))
        return pd.concat([table, pd.DataFrame(more, index=table.index)], axis=1)

    def plot(self, names: Sequence[str] | None = None) -> matplotlib.figure.Figure:
        """A picture: the quantities of these names, by default all, and how far energy and Casimirs are off their first values."""
        import matplotlib.pyplot as plt

        layout = self.system.system._state
        chosen = [layout.ranges[name][2] if name in layout.ranges else None for name in names or layout.ranges]
        for name, found in zip(names or layout.ranges, chosen, strict=True):
            if found is None:
                raise ValueError(layout.missing(name))
        figure, axes = plt.subplots(
            len(chosen) + 1, 1, sharex=True, figsize=(8, 1.8 * (len(chosen) + 1)), layout="constrained", squeeze=False
        )
        for axis, one in zip(axes[:, 0], chosen, strict=False):
            assert one is not None
            values = self.y[one.name].reshape(len(self.t), -1)
            for column, component in zip(values.T, one.components, strict=True):
                axis.plot(self.t, column, label=component or one.name, linewidth=1)
            axis.set_ylabel(one.name + (f" [{one.unit}]" if one.unit else ""))
            if len(one.components) > 1:
                axis.legend(loc="right", fontsize="small")
        last = axes[-1, 0]
        errors = {"energy": self.energy - self.energy[0]}
        errors |= {
            name: one - one[0] for name, one in zip(self.system.system.casimir_names, self.casimirs.T, strict=True)
        }
        for name, error in errors.items():
            size = np.abs(error)
            # zeros are not on a logarithmic axis
            last.semilogy(self.t, np.where(size > 0, size, np.nan), label=name, linewidth=1)
        last.set_ylabel("error")
        last.set_xlabel("t")
        last.legend(loc="right", fontsize="small")
        return figure

    def view(self, program: str = "coadjoint", height: int = 600) -> Any:
        """The motion in three dimensions, in a notebook: a page of the program `coadjoint`, which must be installed."""
        from ._view import view

        return view(self, program, height)

    def __len__(self) -> int:
        return len(self.t)

    def __reduce__(self) -> tuple[Any, ...]:
        return _solution, ({key: value for key, value in self.__dict__.items() if key not in ("_driven", "energy", "casimirs")},)

    def __repr__(self) -> str:
        how = {0: "reached the end", 1: "ended by an event", -1: self.message}[self.status]
        steps = f"step {self.step:g}" if self.step is not None else f"tolerance {self.tolerance:g}"
        name = self.scheme if self.tolerance is None else "Taylor steps"
        return f"<solution of {self.system.name}: {self.nsteps} steps, {name}, {steps}, to t = {self.t_end:g}; {how}>"


class Gradient:
    """The gradient of a function of a run's states."""

    #: By the first state's stored numbers; of rotations in the directions that stay on their group.
    y0: State
    #: By the first state, in the coordinates of tangent vectors.
    tangent: Array
    #: By the parameters; none unless `derivatives` asks for them.
    parameters: State | None
    #: By the controls, each at the end of the step over which it is held; likewise.
    controls: State | None

    def __init__(self, y0: State, tangent: Array, parameters: State | None, controls: State | None) -> None:
        self.y0, self.tangent, self.parameters, self.controls = y0, tangent, parameters, controls


def _solution(parts: dict[str, Any]) -> Solution:
    solution = Solution.__new__(Solution)
    for name, part in parts.items():
        if isinstance(part, np.ndarray):
            part = aligned(part)
        elif name == "_known" and part is not None:
            part = tuple(map(aligned, part))
        solution.__dict__[name] = part
    driven = "_driven" in solution.__dict__
    if not driven:
        solution._driven = None
    return solution
