"""Ensembles: many members side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from ._errors import asking
from ._native import Statistics
from ._rows import Rows
from ._solution import span_of, step_of
from ._state import Array, State, aligned
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
    #: The states that members started from.
    start: State
    #: The parameters of each member.
    parameters: State
    #: Members that could not take a step, in order: their states are the last that they reached.
    failed: list[Failed]

    def __init__(
        self, system: BoundSystem, t: Array, y: State, start: State, parameters: State, failed: list[Failed]
    ) -> None:
        self.system, self.t, self.y, self.start = system, t, y, start
        self.parameters, self.failed = parameters, failed

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
            energies[:, member] = own.energy(np.ascontiguousarray(self.y.flat[:, member]), aligned(self.t))
        return energies

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        members = self.y.flat.shape[1]
        failed = f", {len(self.failed)} failed" if self.failed else ""
        return f"<ensemble of {self.system.name}: {members} members to t = {self.t[-1]:g}{failed}>"


class EnsembleStatistics:
    """What is known of an ensemble's members: how quantities are distributed over them, at each time.

    `known["nutation"][k].mean` is the mean of that quantity at time `known.t[k]`. Parts of an ensemble are merged in any
    order, to the same digits.
    """

    #: The times.
    t: Array
    #: How many members there are.
    members: int
    #: Members that could not take a step, in order. From that step on they are not among those that are counted.
    failed: list[Failed]

    def __init__(self, t: Array, members: int, failed: list[Failed], of: dict[str, list[Statistics]]) -> None:
        self.t, self.members, self.failed, self._of = t, members, failed, of

    def keys(self) -> list[str]:
        """The names of the quantities."""
        return list(self._of)

    def __getitem__(self, name: str) -> list[Statistics]:
        return self._of[name]

    def merge(self, other: EnsembleStatistics) -> None:
        """Adds what is known of other members."""
        if self.keys() != other.keys() or not np.array_equal(self.t, other.t):
            raise ValueError("these are not parts of one ensemble: quantities or times differ")
        self.members += other.members
        self.failed = sorted(self.failed + other.failed)
        for name, all_times in self._of.items():
            for one, more in zip(all_times, other[name], strict=True):
                one.merge(more)

    def __repr__(self) -> str:
        failed = f", {len(self.failed)} failed" if self.failed else ""
        names = ", ".join(self.keys())
        return f"<statistics of {names}: {self.members} members to t = {self.t[-1]:g}{failed}>"


#: What users may ask of members: functions of a solution, with a number for each time and member, or for each member.
Quantities = Mapping[str, Callable[[EnsembleSolution], Any]]


class _Work(NamedTuple):
    """What all blocks of an ensemble have in common."""

    system: BoundSystem
    #: What draws a member, and the seed of its random numbers; or arrays hold them.
    draw: Callable[[int, np.random.Generator], Any] | None
    seed: int
    #: As they are in `ensemble`.
    keys: dict[str, Any]
    quantities: Quantities
    rows: Rows | None


class _Block(NamedTuple):
    """Members that follow each other."""

    members: range
    #: Their states and parameters, unless they are drawn.
    states: Array | None
    parameters: Array | None
    controls: Any


def _known(work: _Work, block: _Block) -> EnsembleStatistics:
    """Runs a block of members, here or on a worker: what is known of them."""
    system, keys = work.system, work.keys
    if work.draw is not None:
        states, parameters = _drawn(system, work.draw, work.seed, block.members)
    else:
        assert block.states is not None and block.parameters is not None
        states, parameters = block.states, block.parameters
    sol = ensemble(system, states, parameters, n=len(states), controls=block.controls, **keys)
    span = span_of(keys["t_span"])
    taken = np.rint((sol.t - span[0]) / step_of(keys["step"], span))
    # who has failed is not asked
    has_failed = np.zeros((len(sol.t), len(states)), dtype=bool)
    for one in sol.failed:
        has_failed[:, one.member] = taken >= one.step
    found = {}
    for name, quantity in work.quantities.items():
        values = np.array(quantity(sol), dtype=np.float64)
        if values.shape == (len(states),):
            # what was drawn, and what else is the same at all times
            values = np.tile(values, (len(sol.t), 1))
        if values.shape != has_failed.shape:
            wanted = f"{has_failed.shape}: a number for each time and member"
            raise ValueError(f"the quantity `{name}`: an array of shape {values.shape} in place of {wanted}")
        values[has_failed] = np.nan
        found[name] = values
    first = block.members.start
    if work.rows is not None:
        work.rows.write(first, sol.t, found)
    of = {name: [Statistics(row) for row in values] for name, values in found.items()}
    failed = [one._replace(member=first + one.member) for one in sol.failed]
    return EnsembleStatistics(sol.t, len(states), failed, of)


def _drawn(
    system: BoundSystem, draw: Callable[[int, np.random.Generator], Any], seed: int, members: range
) -> tuple[Array, Array]:
    """The states and parameters of these members. Random numbers are the member's own, whoever draws it."""
    layout, defaults = system.system, system._defaults()
    states = np.empty((len(members), layout._state.length))
    parameters = np.tile(system._numbers, (len(members), 1))
    for row, member in enumerate(members):
        key = np.array([seed, member], dtype=np.uint64)
        made = draw(member, np.random.Generator(np.random.Philox(key=key)))
        if isinstance(made, tuple):
            made, own = made
            parameters[row] = layout._parameters.flat(own, system._numbers)
        if isinstance(made, Mapping):
            made, moved, said = layout._state.of_velocities(made)
            states[row] = layout._state.flat(made, defaults)
            if moved:
                states[row] = BoundSystem(layout, parameters[row].copy())._of_velocity(states[row], moved, said)
        else:
            states[row] = layout._state.flat(made, defaults)
    return states, parameters


def _given(system: BoundSystem, states: Any, parameters: Any, n: int | None) -> tuple[Array, Array]:
    """The states and parameters of all members, of arrays or dicts."""
    layout = system.system
    moved, said = set[str](), set[str]()
    if isinstance(states, Mapping):
        states, moved, said = layout._state.of_velocities(states)
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
    if moved:
        own = (BoundSystem(layout, field.copy()) for field in fields)
        rows = np.array([one._of_velocity(row, moved, said) for one, row in zip(own, rows, strict=True)])
    return rows, fields


def _mapped(client: Any, work: _Work, blocks: list[_Block]) -> Iterator[EnsembleStatistics]:
    """What is known of each block, by whoever runs it."""
    run = partial(_known, work)
    if client is None:
        yield from map(run, blocks)
    elif hasattr(client, "gather"):
        # Dask's: one by one, so that what was merged can be forgotten
        futures = client.map(run, blocks, pure=False)
        futures.reverse()
        while futures:
            yield client.gather(futures.pop())
    elif hasattr(client, "map"):
        yield from client.map(run, blocks)
    else:
        raise TypeError(f"`client` must have a method `map`, as a Client of Dask, an Executor or a Pool has: {client!r}")


def statistics(
    system: BoundSystem,
    states: Any,
    parameters: Any,
    *,
    n: int | None,
    controls: Any,
    progress: Callable[[float], Any] | None,
    seed: int,
    quantities: Quantities,
    rows: Any,
    block: int,
    client: Any,
    **keys: Any,
) -> EnsembleStatistics:
    if not quantities:
        raise ValueError("`quantities` is empty: there is nothing to know of the members")
    to = None if rows is None else Rows(rows, quantities)
    # before a worker is asked
    step_of(keys["step"], span_of(keys["t_span"]))
    if int(block) != block or block < 1:
        raise ValueError(f"`block` must be a number of members, 1 or more, not {block!r}")
    draw = starts = fields = held = None
    if callable(states):
        draw, count = states, _count(n, parameters, seed)
    else:
        starts, fields = _given(system, states, parameters, n)
        count = len(starts)
    if controls is not None and not callable(controls):
        inputs = system.system._controls
        held = inputs.rows(controls, count, np.zeros(inputs.length))
    blocks = []
    for first in range(0, count, int(block)):
        cut = slice(first, min(first + int(block), count))
        states, parameters, own = (None if all is None else all[cut] for all in (starts, fields, held))
        blocks.append(_Block(range(count)[cut], states, parameters, controls if own is None else own))
    known: EnsembleStatistics | None = None
    work = _Work(system, draw, int(seed), keys, dict(quantities), to)
    if to is not None:
        to.begin()
    for done, part in enumerate(_mapped(client, work, blocks)):
        if known is None:
            known = part
        else:
            known.merge(part)
        if progress:
            progress((done + 1) / len(blocks))
    assert known is not None
    return known


def _count(n: int | None, parameters: Any, seed: int) -> int:
    """How many members are to be drawn."""
    if n is None or int(n) != n or n < 1:
        raise ValueError(f"`n` says how many members are drawn: 1 or more, not {n!r}")
    if parameters is not None:
        raise ValueError("who draws a state returns parameters too, behind it: `return state, parameters`")
    if int(seed) != seed or not 0 <= seed < 2**64:
        raise ValueError(f"`seed` must be a whole number from 0 to 2**64 - 1, not {seed!r}")
    return int(n)


def ensemble(
    system: BoundSystem,
    states: Any,
    parameters: Any,
    *,
    t_span: Any,
    step: float,
    scheme: str | None,
    order: int | None,
    n: int | None,
    controls: Any,
    every: int | None,
    device: str,
    progress: Callable[[float], Any] | None = None,
    seed: int = 0,
) -> EnsembleSolution:
    span = span_of(t_span)
    own = step_of(step, span)
    layout = system.system
    if callable(states):
        rows, fields = _drawn(system, states, int(seed), range(_count(n, parameters, seed)))
    else:
        rows, fields = _given(system, states, parameters, n)
    if every is not None and (int(every) != every or every < 1):
        raise ValueError(f"`every` must be a whole number of steps, 1 or more, not {every!r}")
    whole = (span[1] - span[0]) / own
    steps = round(whole)
    if abs(whole - steps) > 1e-9 * max(whole, 1.0):
        raise ValueError(f"an ensemble takes whole steps: {whole} steps of {own} lead from {span[0]} to {span[1]}")
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
    with asking(layout):
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
    y, start = State(layout._state, np.array(recorded)), State(layout._state, rows)
    return EnsembleSolution(system, np.array(times), y, start, State(layout._parameters, fields), failed)

