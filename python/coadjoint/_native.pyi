"""The native half: flat arrays of `float64` in, flat arrays out."""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Ensemble", "Model", "Statistics", "Stepper", "System", "__version__", "catalogue", "cuda", "retractions", "steps"]

__version__: str

_Array = NDArray[np.float64]
_Place = tuple[int, int, int, str] | None
_Described = tuple[str, str, str, list[int], list[str], tuple[int, int], str | None, str]

def catalogue() -> list[tuple[str, str]]:
    """The names and the texts of the catalogue's systems."""

def cuda(text: str, scheme: str, name: str | None = None) -> tuple[str, str]:
    """The header of a description's steps with a scheme, and what the names in it begin with."""

def retractions() -> list[tuple[str, str]]:
    """The words for retractions, and the library's names."""

def steps() -> list[tuple[str, str]]:
    """The words for steps on a retraction that need no number, and the library's names."""

@final
class Model:
    """A description that was read and derived."""

    def __new__(cls, text: str, name: str | None = None) -> Model: ...
    @property
    def name(self) -> str: ...
    @property
    def about(self) -> str: ...
    @property
    def warnings(self) -> list[tuple[str, _Place]]: ...
    @property
    def quantities(self) -> list[list[_Described]]: ...
    @property
    def casimirs(self) -> list[str]: ...
    @property
    def facts(self) -> dict[str, Any]: ...
    @property
    def schemes(self) -> list[str]: ...
    def system(self, parameters: _Array) -> System:
        """The system with these parameters."""

@final
class System:
    """A system with its parameters."""

    @property
    def parameters(self) -> _Array: ...
    @property
    def events(self) -> list[str]: ...
    @property
    def dimension(self) -> int: ...
    def stepper(self, scheme: str, step: float) -> Stepper: ...
    def ensemble(self, scheme: str, step: float, states: _Array, parameters: _Array) -> Ensemble: ...
    def deviation(self, states: _Array) -> _Array: ...
    def energy(self, states: _Array, times: _Array, controls: _Array) -> _Array: ...
    def casimirs(self, states: _Array) -> _Array: ...
    def vector_field(self, states: _Array, times: _Array, controls: _Array) -> _Array: ...
    def motion(self, states: _Array, times: _Array, controls: _Array) -> _Array: ...
    def with_velocity(self, state: _Array, time: float, control: _Array) -> _Array: ...
    def displace(self, state: _Array, by: _Array) -> _Array: ...
    def tangent_map(self, state: _Array) -> _Array: ...
    def jacobian(
        self, scheme: str, step: float, state: _Array, time: float, control: _Array
    ) -> tuple[_Array, list[tuple[int, _Array]]]: ...
    def pull_back(
        self, scheme: str, times: _Array, states: _Array, controls: _Array, covectors: _Array
    ) -> tuple[_Array, _Array, _Array]: ...
    def certify(
        self, scheme: str, states: _Array, controls: _Array, step: float | None = None
    ) -> tuple[str, bool, list[tuple[str, float, float | None, bool | None, str, int]]]: ...
    def run(
        self,
        scheme: str,
        state: _Array,
        span: tuple[float, float],
        *,
        step: float | None = None,
        tolerance: float | None = None,
        max_step: float | None = None,
        controls: Any,
        every: int | None = None,
        samples: _Array | None = None,
        events: list[Any],
        progress: Callable[[float], Any] | None = None,
    ) -> dict[str, Any]: ...
    def dense(
        self,
        scheme: str,
        known: tuple[_Array, _Array, _Array],
        times: _Array,
        *,
        step: float | None = None,
        tolerance: float | None = None,
        max_step: float | None = None,
        input: Callable[[float], _Array] | None = None,
    ) -> _Array: ...

@final
class Stepper:
    """Takes steps of one size, one call for each."""

    def step(self, state: Any, control: _Array | Sequence[float] | None = None) -> None:
        """Takes one step: the state's array is the next one afterwards."""
    def steps(self, state: Any, count: int, control: _Array | None = None) -> None:
        """Takes some steps, with a control that is held."""
    @property
    def t(self) -> float:
        """The time at which the next step starts."""
    @t.setter
    def t(self, time: float) -> None: ...
    @property
    def step_size(self) -> float:
        """The length of the steps."""
    @property
    def steps_taken(self) -> int:
        """The steps taken since the start, or since the time was set."""
    def snapshot(self) -> list[float]:
        """What is carried from one step to the next."""
    def restore(self, memory: list[float]) -> None:
        """Takes back what `snapshot` gave."""

@final
class Ensemble:
    """Many states of one system that move at the same time, each with parameters of its own."""

    def control(self, controls: _Array) -> None: ...
    def run(self, steps: int, progress: Callable[[float], Any] | None = None) -> int: ...
    def states(self) -> _Array: ...
    @property
    def failed(self) -> list[tuple[int, int, str]]: ...
    @property
    def t(self) -> float: ...
    @property
    def width(self) -> int: ...

@final
class Statistics:
    """How a quantity is distributed over members that come in parts."""

    def __new__(cls, values: ArrayLike | None = None, /) -> Statistics: ...
    @staticmethod
    def from_bytes(data: bytes, /) -> Statistics:
        """Reads what `to_bytes` wrote."""
    def to_bytes(self) -> bytes:
        """Writes what is known; of the same members always the same bytes."""
    def merge(self, other: Statistics, /) -> None:
        """Adds what is known of other members."""
    @property
    def members(self) -> int:
        """How many members there are."""
    @property
    def mean(self) -> float:
        """Their mean: the exact one, rounded once."""
    @property
    def deviation(self) -> float:
        """Their standard deviation from the mean: the root of the exact variance, which is rounded once."""
    @property
    def min(self) -> float:
        """The least value."""
    @property
    def max(self) -> float:
        """The greatest value."""
    @property
    def quantiles(self) -> dict[float, float]:
        """Quantiles by their levels: 0, 0.05, 0.25, 0.5, 0.75, 0.95, 1."""
    @property
    def relative_error(self) -> float:
        """How far a quantile may be off, relative to the size of the values next to it; 0 where they are exact."""
    def __eq__(self, other: object, /) -> bool: ...
