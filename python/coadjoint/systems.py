"""The catalogue: systems to run, and to copy from.

>>> from coadjoint import systems
>>> systems.heavy_top
<system HeavyTop: A rigid body that turns about a fixed point under gravity
...
>>> top, y0 = systems.heavy_top.example, systems.heavy_top.state()
>>> top.run(y0, 10, step=0.01)
<solution of HeavyTop: 1000 steps, Exponential, step 0.01, to t = 10; reached the end>

Each is read and derived when it is asked for first. `names()` has them all; `example` is one with the numbers of the program's example, whose state is
`state()`.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from . import _describe, _native
from ._state import State
from ._system import BoundSystem, System


class Listed(System):
    """A system of the catalogue, with an example."""

    def __init__(self, name: str, text: str, numbers: dict[str, Any]) -> None:
        whole = _describe.Text()
        whole.piece(f"{name}.rs", text)
        self._set(whole, None)
        self._example = numbers

    @property
    def example(self) -> BoundSystem:
        """The system with the parameters of the program's example."""
        return self(self._example["parameters"])

    def state(self) -> State:
        """The state that the example starts from."""
        return self.example.state(self._example["state"])

    @property
    def step(self) -> float:
        """A step that suits the example."""
        return float(self._example["step"])

    @property
    def duration(self) -> float:
        """How long the example is run."""
        return float(self._example["duration"])


@cache
def _texts() -> dict[str, str]:
    return dict(_native.catalogue())


@cache
def _examples() -> dict[str, Any]:
    examples: dict[str, Any] = json.loads(Path(__file__).with_name("catalogue.json").read_text(encoding="utf-8"))
    return examples


@cache
def _listed(name: str) -> Listed:
    return Listed(name, _texts()[name], _examples()[name])


def names() -> list[str]:
    """The names of all systems."""
    return list(_texts())


def __getattr__(name: str) -> Listed:
    if name in _texts():
        return _listed(name)
    import difflib

    near = difflib.get_close_matches(name, _texts(), 1)
    raise AttributeError(f"the catalogue has no `{name}`" + (f"; did you mean `{near[0]}`?" if near else ""))


def __dir__() -> list[str]:
    return ["Listed", "names", *_texts()]
