"""Ensembles: many members side by side."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ._solution import span_of, step_of
from ._state import Array, State
from ._system import BoundSystem, scheme_name


class Failed(NamedTuple):
    """A member that could not take a step."""

    #: Which, from 0.
    member: int
    #: Which step, from 1.
    step: int
    #: Why.
    reason: str


class EnsembleSolution:
    """What came of an ensemble's run: states with times along the first axis, and members along the second."""

    #: The system, with the parameters that members have where they have none of their own.
    system: BoundSystem
    #: The times.
    t: Array
    #: The states: `y.momentum[k, i]` is that of member `i` at time `t[k]`.
    y: State
    #: The parameters of each member.
    parameters: State
    #: Members that could not take a step, in order: their states are the last that they reached.
    failed: list[Failed]

    def __init__(self, system: BoundSystem, t: Array, y: State, parameters: State, failed: list[Failed]) -> None:
        self.system, self.t, self.y, self.parameters, self.failed = system, t, y, parameters, failed

    @property
    def end(self) -> State:
        """The last states, one for each member."""
        end: State = self.y[-1]
        return end

    @property
    def ok(self) -> np.ndarray:
        """Which members took all steps."""
        ok = np.ones(self.y.flat.shape[1], dtype=bool)
        ok[[one.member for one in self.failed]] = False
        return ok

    @cached_property
    def energy(self) -> Array:
        """The energies of all members at all times, without controls."""
        energies = np.empty(self.y.flat.shape[:2])
        for member, row in enumerate(self.parameters.flat):
            own = BoundSystem(self.system.system, row.copy())
            energies[:, member] = own.energy(np.ascontiguousarray(self.y.flat[:, member]), self.t)
        return energies

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        members = self.y.flat.shape[1]
        failed = f", {len(self.failed)} failed" if self.failed else ""
        return f"<ensemble of {self.system.name}: {members} members to t = {self.t[-1]:g}{failed}>"


def ensemble(
    system: BoundSystem,
    states: Any,
    parameters: Any,
    t_span: Any,
    step: float,
    scheme: str | None,
    order: int | None,
    n: int | None,
    controls: Any,
    every: int | None,
    device: str,
    progress: Callable[[float], Any] | None,
) -> EnsembleSolution:
    span = span_of(t_span)
    own = step_of(step, span)
    layout = system.system
    rows = layout._state.rows(states, n, system._defaults())
    count = len(rows) if n is None and len(rows) > 1 else n
    fields = (
        np.tile(system._numbers, (count or 1, 1))
        if parameters is None
        else layout._parameters.rows(parameters, count, system._numbers)
    )
    if len(rows) == 1 and len(fields) > 1:
        rows = np.tile(rows, (len(fields), 1))
    if len(rows) != len(fields):
        raise ValueError(f"there are {len(rows)} states, and parameters of {len(fields)} members")
    if every is not None and (int(every) != every or every < 1):
        raise ValueError(f"`every` must be a whole number of steps, 1 or more, not {every!r}")
    whole = (span[1] - span[0]) / own
    steps = round(whole)
    if abs(whole - steps) > 1e-9 * max(whole, 1.0):
        raise ValueError(f"an ensemble takes whole steps: {whole} steps of {own} lead from {span[0]} to {span[1]}")
    if scheme is None and any("<Cayley" in known for known in layout.schemes):
        # as the program: of systems that are compiled ahead these steps alone are there side by side
        scheme = "cayley"
    name = scheme_name(layout, scheme, order)
    if device != "cpu":
        if device != "cuda":
            raise ValueError(f"there is no device {device!r}: 'cpu' or 'cuda'")
        from . import _cuda

        return _cuda.ensemble(system, rows, fields, span, own, steps, name, every, controls, progress)
    if span[0] != 0.0:
        # their clock starts at zero
        facts = layout._model.facts
        if not facts["autonomous"]:
            raise ValueError(f"{layout.name} depends on time: ensembles of it start at time 0")
    native = system._native.ensemble(name, own, rows.ravel(), np.ascontiguousarray(fields).ravel())
    members, width, inputs = len(rows), layout._state.length, layout._controls.length

    def held(given: Any) -> Array:
        array = layout._controls.rows(given, members, np.zeros(inputs))
        return np.ascontiguousarray(array).ravel()

    law = controls if callable(controls) else None
    if controls is not None and not inputs:
        raise ValueError(f"{layout.name} has no controls")
    if controls is not None and law is None:
        native.control(held(controls))
    times, recorded = [span[0]], [rows.copy()]
    interval, done = (int(every) if every else max(steps, 1)), 0

    def share(part: float, done: int, some: int) -> Any:
        assert progress is not None
        return progress((done + part * some) / steps)

    while done < steps:
        some = min(interval, steps - done)
        if law is None:
            tell = (lambda part, done=done, some=some: share(part, done, some)) if progress else None
            native.run(some, tell)
        else:
            for k in range(some):
                now = State(layout._state, native.states().reshape(members, width))
                native.control(held(law(span[0] + (done + k) * own, now)))
                native.run(1)
            if progress:
                progress((done + some) / steps)
        done += some
        times.append(span[0] + done * own)
        recorded.append(native.states().reshape(members, width))
    if every is None and steps:
        times, recorded = times[-1:], recorded[-1:]
    failed = [Failed(*one) for one in native.failed]
    return EnsembleSolution(
        system, np.array(times), State(layout._state, np.array(recorded)), State(layout._parameters, fields), failed
    )

