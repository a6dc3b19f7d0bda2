"""Systems: descriptions that were read, and what they are with their parameters."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _describe, _native
from ._errors import asking
from ._state import Array, Layout, Quantity, State, numbers

if TYPE_CHECKING:
    from ._ensemble import EnsembleSolution, EnsembleStatistics, Quantities
    from ._solution import Solution

#: Words for schemes that are named after the map that they move by, and the library's names for them.
RETRACTIONS = dict(_native.retractions())
#: Words for all schemes.
SCHEMES = RETRACTIONS | dict(_native.steps())
ORDERS = (4, 6, 8, 10)


def scheme_name(system: System, scheme: str | None, order: int | None) -> str:
    """The library's name of a scheme: a word in small letters, or that name itself, of this order. A word is on the exponential, where there is one."""
    retraction = "exponential" if any("<Exponential" in known for known in system.schemes) else "cayley"
    if scheme is None:
        scheme = retraction
    if not isinstance(scheme, str):
        raise TypeError(f"a scheme is a string such as 'exponential' or 'Midpoint<Cayley>', not {type(scheme).__name__}")
    if scheme == "hamilton-jacobi":
        start = f"HamiltonJacobi<{SCHEMES[retraction]}, "
        derived = [known[len(start) : -1] for known in system.schemes if known.startswith(start)]
        if order is None:
            order = int(derived[0]) if len(derived) == 1 else 6
        return f"{start}{order}>"
    name = SCHEMES.get(scheme, scheme)
    if scheme in SCHEMES and scheme not in RETRACTIONS and retraction == "cayley":
        name = f"{name}<Cayley>"
    if order in (None, 2):
        return name
    if order not in ORDERS:
        raise ValueError(f"the order must be 2, or 4, 6, 8 or 10 of steps that are composed, not {order}")
    return f"Order{order}<{name}>"


class System:
    """A mechanical system, as it is described: without numbers.

    Call it with its parameters to get one that moves:

    >>> import coadjoint as co
    >>> HeavyTop = co.System(
    ...     group="SO3",
    ...     advected="gamma: R3",
    ...     potential="weight * gamma.dot(&chi)",
    ...     inertia="inertia: Vector3 [kg m²]",
    ...     parameters="weight: float [N], chi: Vector3 [m]",
    ...     name="HeavyTop",
    ... )
    >>> top = HeavyTop(inertia=[1, 10, 100], weight=1, chi=[0, 0, 1])
    >>> sol = top.run(dict(momentum=[1, 1, 1], gamma=[0, 0, 1]), t_span=(0, 10), step=0.01)
    >>> bool(abs(sol.energy - sol.energy[0]).max() < 1e-3)
    True

    What is described is said by keywords, one for each key of the language, with a string each; or all in one string, as the macro of
    the Rust library takes it:

    >>> top = co.System("group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi)",
    ...                 inertia="inertia: Vector3", parameters="weight: float, chi: Vector3")
    >>> [one.name for one in top.state_quantities]
    ['attitude', 'momentum', 'gamma']

    Of a group of several factors, inertias stand by the factors that they are of:

    >>> drone = co.System(group={"attitude": "SO3", "place": "R3"}, inertia={"attitude": "inertia: Vector3", "place": "mass: float"},
    ...                   parameters="gravity: float", potential="mass * gravity * place.z")
    >>> [one.name for one in drone.parameter_quantities]
    ['inertia', 'mass', 'gravity']

    or by a whole text of Rust, a file of the catalogue for example. What is wrong is told at its place in the string:

    >>> co.System(group="SO3", potential="weigth * attitude.w", inertia="inertia: Vector3", parameters="weight: float")
    Traceback (most recent call last):
    coadjoint.DescriptionError: error: there is no `weigth` here; did you mean `weight`?
     --> potential:1:1
      |
    1 | weigth * attitude.w
      | ^^^^^^
    """

    def __init__(
        self,
        description: str | None = None,
        /,
        *,
        name: str | None = None,
        doc: str | None = None,
        group: str | Mapping[str, str] | None = None,
        inertia: str | Mapping[str, str] | None = None,
        parameters: str | Mapping[str, str] | None = None,
        advected: str | Mapping[str, str] | None = None,
        control: str | Mapping[str, str] | None = None,
        potential: str | None = None,
        hamiltonian: str | None = None,
        lagrangian: str | None = None,
        force: str | Mapping[str, str] | None = None,
        event: str | Mapping[str, str] | None = None,
        invariance: str | None = None,
        methods: str | None = None,
        retractions: str | None = None,
        derivatives: str | bool | None = None,
        taylor: bool = False,
        units: Mapping[str, str] | None = None,
        definitions: str | None = None,
    ) -> None:
        keys = {
            "doc": doc,
            "inertia": inertia,
            "parameters": parameters,
            "definitions": definitions,
            "group": group,
            "advected": advected,
            "control": control,
            "potential": potential,
            "hamiltonian": hamiltonian,
            "lagrangian": lagrangian,
            "force": force,
            "event": event,
            "invariance": invariance,
            "methods": methods,
            "retractions": retractions,
            "derivatives": derivatives,
            "taylor": taylor,
            "units": units,
        }
        text, struct = _describe.compose(description, name, keys)
        self._set(text, struct)

    def _set(self, text: _describe.Text, struct: str | None) -> None:
        self._model = _describe.derive(text, struct)
        #: The whole text of the description, as the Rust library takes it.
        self.text = str(text)
        self._struct = struct
        self._module: str | None = None
        for message, place in self._model.warnings:
            warnings.warn(text.problem(message, place).shown("warning"), stacklevel=3)
        self._describe()

    def _describe(self) -> None:
        parameters, state, controls = self._model.quantities
        layouts = [
            Layout(what, [Quantity(n, r, k, tuple(s), tuple(c), t, u, d) for n, r, k, s, c, t, u, d in all])
            for what, all in (("the parameters", parameters), ("the state", state), ("the controls", controls))
        ]
        self._parameters, self._state, self._controls = layouts
        self.__doc__ = self.describe()

    @property
    def name(self) -> str:
        """Its name."""
        return self._model.name

    @property
    def about(self) -> str:
        """The first line of its documentation."""
        return self._model.about

    @property
    def parameter_quantities(self) -> tuple[Quantity, ...]:
        """Its parameters."""
        return self._parameters.quantities

    @property
    def state_quantities(self) -> tuple[Quantity, ...]:
        """What a state consists of, in the order of flat arrays."""
        return self._state.quantities

    @property
    def control_quantities(self) -> tuple[Quantity, ...]:
        """Its controls."""
        return self._controls.quantities

    @property
    def casimir_names(self) -> list[str]:
        """The names of its Casimirs: what is conserved whatever the energy is."""
        return self._model.casimirs

    @property
    def schemes(self) -> list[str]:
        """The schemes whose steps were derived; others are composed of these, or asked for by `methods` and `retractions`."""
        return self._model.schemes

    def describe(self) -> str:
        """What it is, in some lines."""
        lines = [f"{self.name}: {self.about}" if self.about else self.name]
        for title, layout in (("parameters", self._parameters), ("state", self._state), ("controls", self._controls)):
            if layout.quantities:
                lines += ["", title, *(f"  {one.described()}" for one in layout.quantities)]
        if self.casimir_names:
            lines += ["", "Casimirs", *(f"  {name}" for name in self.casimir_names)]
        return "\n".join(lines)

    def __call__(self, parameters: ArrayLike | Mapping[str, Any] | None = None, /, **named: Any) -> BoundSystem:
        """The system with these parameters, by name, or all in one flat array."""
        if parameters is not None and named:
            raise TypeError("parameters are given by name, or all in one array or dict")
        return BoundSystem(self, self._parameters.flat(named if parameters is None else parameters))

    def __repr__(self) -> str:
        return f"<system {self.describe()}>"

    def __reduce__(self) -> tuple[Any, ...]:
        if self._module is not None:
            return _of_module, (self._module, self.name)
        return _of_text, (self.text, self._struct)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, System) and (self.text, self._struct) == (other.text, other._struct)

    def __hash__(self) -> int:
        return hash((self.text, self._struct))


@lru_cache(maxsize=32)
def _of_text(text: str, struct: str | None) -> System:
    """A system of a whole text; on a worker the same one again, which is derived and compiled once."""
    system = System.__new__(System)
    whole = _describe.Text()
    whole.piece("description", text)
    with warnings.catch_warnings():
        # they were shown when it was made
        warnings.simplefilter("ignore")
        system._set(whole, struct)
    return system


def compiled(model: Any, module: str) -> System:
    """A system that is compiled ahead: that of a module of its own."""
    system = System.__new__(System)
    system._model, system._module = model, module
    system.text, system._struct = f"compiled: {module}.{model.name}", None
    system._describe()
    return system


def _of_module(module: str, name: str) -> System:
    import importlib

    system: System = getattr(importlib.import_module(module), name)
    return system


class Certificate(NamedTuple):
    """A claim of a scheme, measured."""

    #: What was measured.
    name: str
    #: The worst figure of all states.
    figure: float
    #: What it must keep to; none if the scheme claims nothing.
    bound: float | None
    #: Whether it must not be larger than the bound, or not smaller.
    at_most: bool | None
    #: `passed`, `FAILED`, `not claimed` or `not measured`.
    verdict: str
    #: The state that it belongs to.
    state: int


class Report:
    """Certificates of the steps of one scheme."""

    #: All of them.
    certificates: tuple[Certificate, ...]
    #: Whether no claim is wrong.
    passed: bool
    #: A table of them.
    text: str

    def __init__(self, certificates: tuple[Certificate, ...], passed: bool, text: str) -> None:
        self.certificates, self.passed, self.text = certificates, passed, text

    def __repr__(self) -> str:
        return self.text

    def __iter__(self) -> Iterator[Certificate]:
        return iter(self.certificates)

    def __getitem__(self, name: str) -> Certificate:
        for one in self.certificates:
            if one.name == name:
                return one
        raise KeyError(name)


class Jacobian(NamedTuple):
    """A step with its derivatives, in coordinates of tangent vectors: see `BoundSystem.jacobian`."""

    #: The next state.
    y: State
    #: By the state before.
    state: Array
    #: By the controls; no columns unless `derivatives` asks for them.
    control: Array
    #: By the parameters, likewise.
    parameters: Array


class BoundSystem:
    """A system with its parameters: what moves."""

    def __init__(self, system: System, parameters: Array) -> None:
        parameters = numbers(parameters, "the parameters")
        #: The description.
        self.system = system
        self._native: _native.System = system._model.system(parameters)
        self._numbers = parameters
        self._numbers.flags.writeable = False
        self.__doc__ = system.__doc__

    @property
    def name(self) -> str:
        """The system's name."""
        return self.system.name

    @property
    def parameters(self) -> State:
        """Its parameters by name; they cannot be changed. `replace` makes a system with others."""
        return State(self.system._parameters, self._numbers)

    def replace(self, **named: Any) -> BoundSystem:
        """The system with some parameters replaced."""
        return BoundSystem(self.system, self.system._parameters.flat(named, self._numbers))

    # -- states ------------------------------------------------------------------------------------------------------------------------------

    def state(self, given: Any = None, /, **named: Any) -> State:
        """A state by name: configurations that are left out are the identity, momenta zero. Advected quantities must be said.

        A rotation of the plane is `cos, sin`, or its angle in radians. In place of momenta there may be velocities, at time 0 and without controls:
        `velocity` for `momentum`, `hull_velocity` for `hull_momentum`. Factors of which neither is given are at rest then.

        >>> import coadjoint as co
        >>> top = co.systems.heavy_top.example
        >>> top.state(momentum=[0, 0, 5], gamma=[0, 0, 1]).attitude
        array([1., 0., 0., 0.])
        >>> top.state(velocity=[0, 0, 5], gamma=[0, 0, 1]).momentum / top.parameters.inertia
        array([0., 0., 5.])
        """
        if given is not None and named:
            raise TypeError("a state is given by name, or as one array or dict")
        return State(self.system._state, self._start(named or given))

    def _start(self, given: Any, t: float = 0.0) -> Array:
        """The flat array of a state at a time; velocities among its names become momenta."""
        layout = self.system._state
        if given is not None and not isinstance(given, Mapping):
            return layout.flat(given, self._defaults())
        given, moved, said = layout.of_velocities({} if given is None else given)
        flat = layout.flat(given, self._defaults())
        return self._of_velocity(flat, moved, said, t) if moved else flat

    def _of_velocity(self, flat: Array, moved: set[str], said: set[str], t: float = 0.0) -> Array:
        """A state in which velocities stand in the places of some momenta, and others are said; factors of which there is neither are at rest."""
        ranges = self.system._state.ranges
        control = np.zeros(self.system._controls.length)
        velocities = flat.copy()
        for name in said:
            velocities[slice(*ranges[name][:2])] = 0.0
        state = self._native.with_velocity(velocities, t, control)
        for name in said:
            state[slice(*ranges[name][:2])] = flat[slice(*ranges[name][:2])]
        if not said:
            return state
        # with these momenta, is the velocity still the one that was asked for?
        motion = self._native.motion(state, np.array([t]), control)
        all_ = self.system.state_quantities
        for factor, one in zip(all_, all_[1:], strict=False):
            asked = flat[slice(*ranges[one.name][:2])]
            if one.name in moved and not np.allclose(motion[slice(*factor.tangent)], asked, rtol=1e-9, atol=1e-12):
                others = ", ".join(f"`{name}`" for name in sorted(said))
                raise ValueError(
                    f"the state: the velocity of `{factor.name}` depends on {others} too: give velocities of all factors, or momenta"
                )
        return state

    def _defaults(self) -> Array:
        neutral = [
            np.full(len(one.components), np.nan) if one.role == "advected" else one.neutral()
            for one in self.system.state_quantities
        ]
        return np.concatenate(neutral) if neutral else np.empty(0)

    def _control(self, given: Any) -> Array:
        layout = self.system._controls
        if given is None:
            return np.zeros(layout.length)
        return layout.flat(given, np.zeros(layout.length))

    def _each(self, states: Any, t: Any, control: Any) -> tuple[Array, Array, Array, tuple[int, ...]]:
        """States, times and controls side by side, and the axes before those of the states."""
        flat = states.flat if isinstance(states, State) else None
        if flat is None:
            flat = self.state(states).flat if isinstance(states, Mapping) else numbers(states, "states")
        width, controls = self.system._state.length, self.system._controls.length
        if flat.shape[-1:] != (width,):
            raise ValueError(f"states: an array of shape {flat.shape} in place of (…, {width})")
        shape = flat.shape[:-1]
        times = np.ascontiguousarray(np.broadcast_to(numbers(t, "t"), shape))
        if control is None:
            given = np.zeros(shape + (controls,))
        else:
            given = self._control(control) if isinstance(control, Mapping) else numbers(control, "the controls")
            given = np.ascontiguousarray(np.broadcast_to(given, shape + (controls,)))
        return np.ascontiguousarray(flat).ravel(), times.ravel(), given.ravel(), shape

    def energy(self, y: Any, t: ArrayLike = 0.0, control: Any = None) -> Any:
        """The energy of a state, or of each of many."""
        states, times, controls, shape = self._each(y, t, control)
        energies = self._native.energy(states, times, controls).reshape(shape)
        return energies if shape else float(energies)

    def casimirs(self, y: Any) -> Array:
        """The Casimirs of a state, or of each of many, along the last axis."""
        states, _, _, shape = self._each(y, 0.0, None)
        return self._native.casimirs(states).reshape(*shape, len(self.system.casimir_names))

    def deviation(self, y: Any) -> Any:
        """How far a state is off its group: whether rotations are of unit length, for example."""
        states, _, _, shape = self._each(y, 0.0, None)
        off = self._native.deviation(states).reshape(shape)
        return off if shape else float(off)

    def rhs(self, t: ArrayLike, y: Any, control: Any = None) -> Array:
        """The motion as the derivative of the stored numbers: what `scipy.integrate.solve_ivp` takes as `fun`, to compare with."""
        states, times, controls, shape = self._each(y, t, control)
        return self._native.vector_field(states, times, controls).reshape(*shape, self.system._state.length)

    def with_velocity(self, y: Any, t: float = 0.0, control: Any = None) -> State:
        """The state whose momenta belong to the velocities that stand in their places.

        `state(velocity=…)` names them; this takes a whole state, a time and a control.
        """
        try:
            t = float(t)
        except TypeError:
            raise TypeError(
                f"with_velocity takes a state that has velocities in the places of its momenta, then a time, which {t!r} is not; "
                "`state(velocity=…)` takes them by name"
            ) from None
        layout = self.system._state
        state = layout.flat(layout.of_velocities(y)[0] if isinstance(y, Mapping) else y, self._defaults())
        return State(self.system._state, self._native.with_velocity(state, t, self._control(control)))

    def displace(self, y: Any, by: ArrayLike) -> State:
        """The state displaced by a tangent vector, in the coordinates of `jacobian`.

        A configuration `g` becomes `g exp(δ)`, or `exp(δ) g` with `invariance="right"`; to all else its components are added.
        """
        return State(self.system._state, self._native.displace(self.state(y).flat, numbers(by, "the tangent vector")))

    # -- steps -------------------------------------------------------------------------------------------------------------------------------

    def stepper(self, step: float, scheme: str | None = None, order: int | None = None, t: float = 0.0) -> _native.Stepper:
        """What takes steps one by one, each with one call that changes the state's array.

        >>> import coadjoint as co
        >>> top = co.systems.heavy_top.example
        >>> stepper, y = top.stepper(0.01), co.systems.heavy_top.state()
        >>> for _ in range(10):
        ...     stepper.step(y)
        >>> stepper.t
        0.1
        """
        with asking(self.system):
            stepper = self._native.stepper(scheme_name(self.system, scheme, order), float(step))
        if t:
            stepper.t = t
        return stepper

    def run(
        self,
        y0: Any,
        t_span: float | tuple[float, float],
        *,
        step: float | None = None,
        scheme: str | None = None,
        order: int | None = None,
        tolerance: float | None = None,
        max_step: float | None = None,
        controls: Any = None,
        events: str | Callable[..., Any] | Sequence[str | Callable[..., Any]] | None = None,
        t_eval: ArrayLike | None = None,
        every: int = 1,
        dense_output: bool | None = None,
        progress: Callable[[float], Any] | None = None,
    ) -> Solution:
        """Runs from a state over a span of time.

        y0: the state: by name in a dict, a `State`, or a flat array.
        t_span: start and end; a number is the end of a run from 0.
        step: the length of the steps; their direction is that of `t_span`. The last one is shorter where whole steps do not lead to the end.
        scheme, order: the steps: `exponential`, the default, `cayley`, `midpoint`, `verlet` … or the library's name, `Midpoint<Cayley>`; of order 2, or composed
            to 4, 6, 8 or 10. Words are on the exponential, or on the Cayley map where that alone was derived; `hamilton-jacobi` has the order that was
            derived, and order 2 with controls that are a function of `t`.
        tolerance: in place of `step`, Taylor steps, each as long as this error allows: the description needs `taylor`.
        max_step: with a `tolerance`, no step is longer. What comes and goes within a step, as a pulse does, may not be seen.
        controls: an array or a dict that is held; `(times, values)`, each held until the next time, without a line or a curve between them, and with a
            `step` from the next step's start on; a function of `t`, such as a `CubicSpline` of scipy; or one of `t, y`, asked before each step.
        events: functions of `t, y` whose zeros are found within the steps. As in scipy, an attribute `terminal`, a bool or a count, ends the run,
            and `direction` says which zeros count. `apply`, a function of `t, y`, changes the state there; `points` says at how many points to look in each step.
            Or names of the description's own, `event="apogee = …"`: of these none is missed with a `tolerance`.
        t_eval: times at which to record states, in place of those after every `every` steps.
        dense_output: whether the solution can be called: by default without `t_eval`.
        progress: called now and then with the share of the run that is done.
        """
        from ._solution import run

        return run(
            self,
            y0,
            t_span,
            step,
            scheme,
            order,
            tolerance,
            max_step,
            controls,
            events,
            t_eval,
            every,
            dense_output,
            progress,
        )

    @overload
    def ensemble(
        self,
        states: Any,
        parameters: Any = None,
        *,
        t_span: float | tuple[float, float],
        step: float,
        scheme: str | None = None,
        order: int | None = None,
        n: int | None = None,
        seed: int = 0,
        controls: Any = None,
        every: int | None = None,
        device: str = "cpu",
        progress: Callable[[float], Any] | None = None,
    ) -> EnsembleSolution: ...
    @overload
    def ensemble(
        self,
        states: Any,
        parameters: Any = None,
        *,
        t_span: float | tuple[float, float],
        step: float,
        scheme: str | None = None,
        order: int | None = None,
        n: int | None = None,
        seed: int = 0,
        controls: Any = None,
        every: int | None = None,
        device: str = "cpu",
        progress: Callable[[float], Any] | None = None,
        quantities: Quantities,
        rows: str | os.PathLike[str] | None = None,
        block: int = 2048,
        client: Any = None,
    ) -> EnsembleStatistics: ...
    def ensemble(
        self,
        states: Any,
        parameters: Any = None,
        *,
        t_span: float | tuple[float, float],
        step: float,
        scheme: str | None = None,
        order: int | None = None,
        n: int | None = None,
        seed: int = 0,
        controls: Any = None,
        every: int | None = None,
        device: str = "cpu",
        progress: Callable[[float], Any] | None = None,
        quantities: Quantities | None = None,
        rows: str | os.PathLike[str] | None = None,
        block: int = 2048,
        client: Any = None,
    ) -> EnsembleSolution | EnsembleStatistics:
        """Runs many members side by side, on all cores.

        states: the states they start from: an array with one row for each, or a dict of arrays. What is the same for all need be given once.
            Angles of the plane may be one number for each; two numbers are `cos, sin` for all, two angles are `[[a], [b]]`.
            Or a function of a member's number and its random numbers, `k, rng`, that returns its state, or state and parameters as a pair.
        parameters: likewise, of those that differ from this system's.
        n: how many there are, if that does not follow from the arrays.
        seed: where random numbers start. Those of a member are its own, whoever draws it, in whatever order.
        scheme, order: as of a run.
        controls: an array, or one with a row for each member, that is held; or a function of `t, y` of all members at once, asked before each step.
        every: records the states after every so many steps; by default the last ones alone.
        device: `cpu`, or `cuda` by way of CuPy.

        With `quantities`, members are run in blocks and forgotten: what is returned are statistics.

        quantities: by name, functions of a block's solution, with a number for each time and member: `lambda sol: sol.y.gamma[..., 2]`.
            Or one for each member, if it is the same at all times: `lambda sol: sol.parameters.weight`.
        rows: a new directory, to which each block writes a row for each time and member. Its name ends in `.csv`, or in `.parquet` for pyarrow.
        block: so many members are run at a time.
        client: who runs the blocks: what has a method `map`, such as a `Client` of Dask, an `Executor`, or a `Pool` of Ray. By default this process.

        >>> import coadjoint as co
        >>> top = co.systems.heavy_top.example
        >>> def member(k, rng):
        ...     return {"momentum": rng.normal([0, 0, 5], 0.1), "gamma": [0, 0, 1]}
        >>> known = top.ensemble(member, n=5000, t_span=1, step=0.01, every=50, quantities={"energy": lambda sol: sol.energy})
        >>> known
        <statistics of energy: 5000 members to t = 1>
        >>> [one.members for one in known["energy"]]
        [5000, 5000, 5000]
        >>> bool(known["energy"][-1].deviation > 0)
        True
        """
        from ._ensemble import ensemble, statistics

        keys: dict[str, Any] = dict(n=n, seed=seed, controls=controls, progress=progress)
        keys |= dict(t_span=t_span, step=step, scheme=scheme, order=order, every=every, device=device)
        if quantities is not None:
            return statistics(
                self, states, parameters, quantities=quantities, rows=rows, block=block, client=client, **keys
            )
        if rows is not None:
            raise ValueError("rows are of `quantities`: say of which")
        if client is not None:
            raise ValueError("a client's workers send statistics alone: say of what, by `quantities`")
        return ensemble(self, states, parameters, **keys)

    def certify(
        self,
        states: Any,
        scheme: str | None = None,
        order: int | None = None,
        *,
        controls: Any = None,
        step: float | None = None,
    ) -> Report:
        """Measures what a scheme promises of its steps, at a state, or at a list or array of them.

        >>> import coadjoint as co
        >>> top = co.systems.heavy_top.example
        >>> y = top.state(attitude=[0.5, 0.5, 0.5, 0.5], momentum=[0.4, -0.8, 1.5], gamma=[0.6, 0, 0.8])
        >>> report = top.certify(y)
        >>> report.passed, report["Poisson map"].figure < 1e-9
        (True, True)
        """
        if isinstance(states, State):
            rows = np.atleast_2d(states.flat)
        elif isinstance(states, Mapping):
            rows = self.state(states).flat[None]
        elif isinstance(states, (list, tuple)) and any(isinstance(one, (State, Mapping)) for one in states):
            rows = np.stack([self.state(one).flat for one in states])
        else:
            rows = self.system._state.rows(states, None)
        inputs = self._control(controls) if controls is None or isinstance(controls, Mapping) else numbers(controls, "the controls")
        with asking(self.system):
            text, passed, certificates = self._native.certify(
                scheme_name(self.system, scheme, order), np.ascontiguousarray(rows).ravel(), inputs.ravel(), step
            )
        return Report(tuple(Certificate(*one) for one in certificates), passed, text)

    # -- derivatives -------------------------------------------------------------------------------------------------------------------------

    def jacobian(
        self, y: Any, step: float, scheme: str | None = None, order: int | None = None, *, t: float = 0.0, control: Any = None
    ) -> Jacobian:
        """One step with its derivatives; the description needs `derivatives`.

        Rows and columns are coordinates of tangent vectors: of a vector its components, of a rotation the turn about the axes of the body, or
        about those of space with `invariance="right"`. `Quantity.tangent` says where each quantity has its own, `displace` moves a state along them,
        and `tangent_map` says how its stored numbers change by them.
        """
        state = self.state(y).flat
        with asking(self.system):
            following, parts = self._native.jacobian(
                scheme_name(self.system, scheme, order), float(step), state, float(t), self._control(control)
            )
        rows = self._native.dimension
        matrices = [entries.reshape(columns, rows).T for columns, entries in parts]
        return Jacobian(State(self.system._state, following), *matrices)

    def tangent_map(self, y: Any) -> Array:
        """How the stored numbers of a state change by each coordinate of a tangent vector: one column for each."""
        state = self.state(y).flat
        return self._native.tangent_map(state).reshape(self._native.dimension, len(state)).T

    # -- manners -----------------------------------------------------------------------------------------------------------------------------

    def __repr__(self) -> str:
        parts = []
        for name, (start, end, one) in self.system._parameters.ranges.items():
            values = self._numbers[start:end].reshape(one.shape).tolist()
            parts.append(f"{name}={values}" + (f" {one.unit}" if one.unit else ""))
        return f"{self.name}({', '.join(parts)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return BoundSystem, (self.system, np.array(self._numbers))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, BoundSystem)
            and self.system == other.system
            and np.array_equal(self._numbers, other._numbers)
        )

    def __hash__(self) -> int:
        return hash((self.system, self._numbers.tobytes()))


def arity(function: Callable[..., Any]) -> int:
    """How many arguments a function takes by place: 1 or 2."""
    import inspect

    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return 2
    if any(one.kind is one.VAR_POSITIONAL for one in parameters):
        return 2
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    required = [one for one in parameters if one.kind in kinds and one.default is one.empty]
    if len(required) not in (1, 2):
        raise TypeError(f"a control is a function of `t` or of `t, y`, not of {len(required)} arguments")
    return len(required)
