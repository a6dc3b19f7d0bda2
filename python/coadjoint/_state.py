"""Names and shapes: quantities, their layout in flat arrays, and states as views of these."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
#: What is `velocity` in the name of the velocity that belongs to a momentum.
_VELOCITY = re.compile(r"momentum(?=(?:_\d+)?$)")


class Quantity(NamedTuple):
    """What a parameter, a part of the state or a control is."""

    #: Its name.
    name: str
    #: What it is to the system: `parameter`, `configuration`, `momentum`, `advected` or `control`.
    role: str
    #: What it is mathematically, such as `vector` or `unit quaternion`.
    kind: str
    #: The shape of its array.
    shape: tuple[int, ...]
    #: The names of its components, in the order in which they are stored: of a quaternion `w, x, y, z`.
    components: tuple[str, ...]
    #: Where its directions are among those of all: see `System.jacobian`.
    tangent: tuple[int, int]
    #: Its unit, if the description says one.
    unit: str | None
    #: The first line of its documentation.
    doc: str

    @property
    def columns(self) -> list[str]:
        """The names of its columns in tables."""
        return [f"{self.name}_{component}" if component else self.name for component in self.components]

    def described(self) -> str:
        """One line about it."""
        shape = {
            "scalar": "number",
            "unit quaternion": "rotation (w, x, y, z)",
            "unit complex": "rotation (cos, sin), or an angle in radians",
        }
        kind = shape.get(self.kind) or " × ".join(map(str, self.shape)) + f" {self.kind}"
        unit = f" [{self.unit}]" if self.unit else ""
        return f"{self.name}{unit}: {kind}" + (f". {self.doc}" if self.doc else "")

    def neutral(self) -> Array:
        """The identity of a configuration, zero of anything else."""
        numbers = np.zeros(len(self.components))
        if self.role != "configuration":
            return numbers
        if self.kind == "matrix":
            return np.eye(self.shape[0]).ravel()
        if self.kind not in ("scalar", "vector"):
            numbers[0] = 1.0
        return numbers


class Layout:
    """Where quantities are in a flat array."""

    __slots__ = ("what", "quantities", "ranges", "length", "arrays")

    def __init__(self, what: str, quantities: list[Quantity]) -> None:
        self.what, self.quantities = what, tuple(quantities)
        ends = np.cumsum([0] + [len(one.components) for one in quantities]).tolist()
        self.ranges = {
            one.name: (start, end, one) for one, start, end in zip(quantities, ends, ends[1:], strict=False)
        }
        self.length: int = ends[-1]
        #: The names of what is an array in the description, `g` of `g_0`, `g_1` …, and how many there are.
        self.arrays: dict[str, int] = {}
        for name in self.ranges:
            array, _, place = name.rpartition("_")
            if array not in self.ranges and place == str(self.arrays.get(array, 0)):
                self.arrays[array] = int(place) + 1

    def missing(self, name: object) -> str:
        import difflib

        if name in self.arrays:
            return f"`{name}` is an array: it has {', '.join(f'{name}_{k}' for k in range(self.arrays[str(name)]))}"
        near = difflib.get_close_matches(str(name), self.ranges, 1)
        known = ", ".join(self.ranges)
        if self.what == "the state":
            hint = f"; did you mean `{near[0]}`?" if near else f": it has {known or 'nothing'}"
            return f"the state has no `{name}`{hint}"
        kind = self.what.removeprefix("the ").removesuffix("s")
        hint = f"; did you mean `{near[0]}`?" if near else f"; known: {known or 'none'}"
        return f"there is no {kind} `{name}`{hint}"

    def of_velocities(self, given: Mapping[str, Any]) -> tuple[Mapping[str, Any], set[str], set[str]]:
        """What is given, with velocities in the places of momenta; the names of these momenta, and of those that are given as such."""
        parts = {one.name: {one.name} for one in self.quantities if one.role == "momentum"}
        parts |= {name: {f"{name}_{k}" for k in range(count)} for name, count in self.arrays.items() if f"{name}_0" in parts}
        # an advected quantity may have that name
        names = {_VELOCITY.sub("velocity", name): name for name in parts}
        names = {velocity: name for velocity, name in names.items() if velocity not in self.ranges}
        placed: dict[str, Any] = {}
        moved: set[str] = set()
        for name, value in given.items():
            place = names.get(name, name)
            if place != name:
                moved |= parts[place]
            placed[place] = value
        said = set().union(*(parts[name] for name in given if name in parts))
        for name in given:
            if name in names and parts[names[name]] & said:
                raise ValueError(f"{self.what}: `{name}` and `{names[name]}` say the same, one of them is enough")
        return placed, moved, said

    def spread(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """What is given, with the parts of arrays by their own names."""
        if not any(name in self.arrays for name in given):
            return given
        parts: dict[str, Any] = {}
        for name, value in given.items():
            if name not in self.arrays:
                parts[name] = value
                continue
            count, one = self.arrays[name], self.ranges[f"{name}_0"][2]
            shape = (count, *one.shape)
            array = numbers(rotation(one, value, len(shape)), f"{self.what}, `{name}`")
            if array.shape[-len(shape) :] != shape:
                raise ValueError(f"{self.what}, `{name}`: an array of shape {array.shape} in place of {shape}")
            axis = array.ndim - len(shape)
            parts |= {f"{name}_{k}": array.take(k, axis) for k in range(count)}
        return parts

    def columns(self) -> list[str]:
        return [column for one in self.quantities for column in one.columns]

    def flat(self, given: Any, defaults: Array | None = None) -> Array:
        """One flat array of what is given: an array, a `State`, or a mapping of names. What a mapping leaves out is as in `defaults`."""
        if isinstance(given, State):
            given = given.flat
        if not isinstance(given, Mapping):
            array = numbers(given, self.what)
            if array.shape != (self.length,):
                raise ValueError(f"{self.what}: an array of shape {array.shape} in place of ({self.length},)")
            return array.copy() if array is given else array
        given = self.spread(given)
        flat = np.full(self.length, np.nan) if defaults is None else defaults.copy()
        for name, value in given.items():
            if name not in self.ranges:
                raise ValueError(self.missing(name))
            start, end, one = self.ranges[name]
            flat[start:end] = component(one, value, self.what)
        for name, (start, end, _) in self.ranges.items():
            if name not in given and np.isnan(flat[start:end]).any():
                raise ValueError(f"{self.what}: `{name}` is not given, and there is nothing to take in its place")
        return flat

    def rows(self, given: Any, count: int | None, defaults: Array | None = None) -> Array:
        """Rows of numbers: one for each member. What is the same for all need be given once."""
        if isinstance(given, State):
            given = given.flat
        if isinstance(given, Mapping):
            arrays, given = {}, self.spread(given)
            for name, value in given.items():
                if name not in self.ranges:
                    raise ValueError(self.missing(name))
                one = self.ranges[name][2]
                array = numbers(rotation(one, value), f"{self.what}, `{name}`")
                if array.shape == one.shape:
                    array = array[None]
                if array.ndim != len(one.shape) + 1 or array.shape[1:] != one.shape:
                    raise ValueError(f"{self.what}, `{name}`: an array of shape {array.shape} in place of (n, {str(one.shape)[1:]}")
                arrays[name] = array.reshape(len(array), -1)
            sizes = {len(array) for array in arrays.values()} - {1}
            if count is not None:
                sizes |= {count} - ({1} if sizes else set())
            if len(sizes) > 1:
                raise ValueError(f"{self.what}: there are {sorted(sizes)} members, and there must be as many of each")
            size = sizes.pop() if sizes else 1
            base = np.full(self.length, np.nan) if defaults is None else defaults
            flat = np.tile(base, (size, 1))
            for name, array in arrays.items():
                start, end, _ = self.ranges[name]
                flat[:, start:end] = array
            for name, (start, end, _) in self.ranges.items():
                if name not in given and np.isnan(flat[:, start:end]).any():
                    raise ValueError(f"{self.what}: `{name}` is not given, and there is nothing to take in its place")
            return flat
        array = numbers(given, self.what)
        if array.shape == (self.length,):
            array = np.tile(array, (count or 1, 1))
        if array.ndim != 2 or array.shape[1] != self.length or (count not in (None, 1) and len(array) not in (1, count)):
            wanted = f"({count if count else 'n'}, {self.length})"
            raise ValueError(f"{self.what}: an array of shape {array.shape} in place of {wanted}")
        if count is not None and len(array) == 1:
            array = np.tile(array, (count, 1))
        return array


def numbers(given: ArrayLike, what: str) -> Array:
    """A contiguous array of `float64`; whatever would lose something on the way is refused."""
    array = np.asarray(given)
    if array.dtype == object or array.dtype.kind not in "fiub":
        raise TypeError(f"{what}: numbers are needed, not an array of {array.dtype}")
    return aligned(array.astype(np.float64, copy=False)) if array.ndim else np.array(array, dtype=np.float64)


def aligned(array: Array) -> Array:
    """The array, or a copy that is contiguous and starts where a number may: what was sent to a worker lies anywhere."""
    return np.require(array, requirements=["C", "A"])


def rotation(quantity: Quantity, value: Any, axes: int = 1) -> Any:
    """What a value is as an array: rotations of scipy are quaternions, numbers in the place of `cos, sin` are angles.

    axes: how many its array has at least.
    """
    if quantity.kind == "unit quaternion" and hasattr(value, "as_quat"):
        # scipy's own order has the real part at the end
        return np.roll(np.asarray(value.as_quat()), 1, axis=-1)
    if quantity.kind == "unit complex":
        angles = np.asarray(value)
        if angles.dtype.kind in "fiu" and (angles.ndim < axes or angles.shape[-1] != 2):
            if angles.ndim > axes - 1 and angles.shape[-1] == 1:
                angles = angles[..., 0]
            return np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    return value


def component(quantity: Quantity, value: Any, what: str) -> Array:
    array = numbers(rotation(quantity, value), f"{what}, `{quantity.name}`")
    # a number stands for a vector of one
    if array.shape != quantity.shape and not (array.size == 1 and quantity.shape in ((), (1,))):
        raise ValueError(f"{what}, `{quantity.name}`: an array of shape {array.shape} in place of {quantity.shape}")
    return array.ravel()


class State:
    """A state, or many of them, by name: views of one flat array.

    `state.momentum`, or `state["momentum"]`, is a view of the momentum: an array with the axes of `flat` but for the last one, and those of the
    quantity behind them. What is written to it is written to the state. `state[k]` is the k-th of many.
    """

    __slots__ = ("_layout", "flat")

    _layout: Layout
    #: All numbers, in the order of the system's `state_quantities`, along the last axis.
    flat: Array

    def __init__(self, layout: Layout, flat: Array) -> None:
        object.__setattr__(self, "_layout", layout)
        object.__setattr__(self, "flat", flat)

    def __getattr__(self, name: str) -> Array:
        if name.startswith("__"):
            raise AttributeError(name)
        found = self._layout.ranges.get(name)
        if found is None:
            raise AttributeError(self._layout.missing(name))
        start, end, one = found
        view: Array = self.flat[..., start:end]
        return view.reshape(view.shape[:-1] + one.shape) if len(one.shape) != 1 else view

    def __setattr__(self, name: str, value: Any) -> None:
        found = self._layout.ranges.get(name)
        if found is None:
            raise AttributeError(self._layout.missing(name))
        start, end, one = found
        array = numbers(rotation(one, value), name)
        self.flat[..., start:end] = array.reshape(array.shape[: array.ndim - len(one.shape)] + (-1,))

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            try:
                return getattr(self, key)
            except AttributeError:
                raise KeyError(self._layout.missing(key)) from None
        if self.flat.ndim == 1:
            raise IndexError("this is one state: its quantities have names")
        return State(self._layout, self.flat[key if isinstance(key, tuple) else (key, Ellipsis)])

    def __setitem__(self, key: str, value: Any) -> None:
        setattr(self, key, value)

    def __len__(self) -> int:
        return self.flat.shape[0] if self.flat.ndim > 1 else len(self._layout.quantities)

    def __iter__(self) -> Iterator[Any]:
        if self.flat.ndim == 1:
            return iter(self.keys())
        return (self[k] for k in range(len(self)))

    def keys(self) -> list[str]:
        """The names of its quantities."""
        return list(self._layout.ranges)

    def copy(self) -> State:
        """A state of its own."""
        return State(self._layout, self.flat.copy())

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.flat, dtype=dtype) if copy or dtype is not None else self.flat

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._layout.ranges]

    def __reduce__(self) -> tuple[Any, ...]:
        return _state, (self._layout.what, self._layout.quantities, self.flat)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, State) and self.keys() == other.keys() and np.array_equal(self.flat, other.flat)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        if self.flat.ndim > 1:
            return f"<{' × '.join(map(str, self.flat.shape[:-1]))} states of {', '.join(self.keys())}>"
        parts = []
        for name, (start, end, one) in self._layout.ranges.items():
            unit = f" {one.unit}" if one.unit else ""
            values = self.flat[start:end]
            shown = f"{values[0]:.6g}" if one.shape == () else np.array2string(values.reshape(one.shape), precision=6)
            parts.append(f"{name}={shown}{unit}")
        return f"State({', '.join(parts)})"


def _state(what: str, quantities: tuple[Quantity, ...], flat: Array) -> State:
    return State(Layout(what, list(quantities)), np.require(flat, requirements=["C", "A", "W"]))
