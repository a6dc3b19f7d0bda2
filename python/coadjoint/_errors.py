"""Exceptions, with what they know."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._solution import Solution
    from ._system import System


#: What messages say of fields in Rust's words, and how it is written in keywords.
_FIELDS = [
    (r"Mark one field with `#\[inertia\]`, or give a", 'Give `inertia="…"`, or a'),
    (r"mark one field with `#\[inertia\((.+?)\)\]`", r'give `inertia={"\1": "…"}`'),
    (r"are marked; keep one `#\[inertia\]`", "are given as `inertia`; others are `parameters`"),
    (r"`#\[inertia\(…\)\]` names the factors of each", 'give one of each factor, `inertia={"factor": "…"}`'),
    (r"stands on its field: `#\[unit\(\"(.*?)\"\)\]`", r"stands behind its type: `[\1]`"),
    (
        r"a parameter is `f64`.* or `SMatrix<f64, R, C>`; or an array of these, such as `\[f64; 3\]`",
        "a parameter is `float`, `Vector1` to `Vector6`, `SVector<f64, N>`, `Matrix1` to `Matrix6` or `SMatrix<f64, R, C>`; "
        "or an array of these, such as `[float; 3]`",
    ),
    (r"with `#\[expression\]` above them", "in `definitions`, with `#[expression]` above them"),
]
#: The same of keys.
_KEYS = [
    (r"`#\[lie_poisson_system\((.*?), …\)\]`", r"`\1`"),
    (r'`units\((\w+) = "([^`]*)"\)`', r'`units={"\1": "\2"}`'),
    (r"`(group|potential|hamiltonian|lagrangian|force|invariance) = ([^`]+)`", r'`\1="\2"`'),
    (r"`(group|advected|control|force|event|methods|retractions|derivatives)\(([^`]+)\)`", r'`\1="\2"`'),
    (r"`(derivatives|taylor)` in its description", r"`\1=True` in its description"),
    (r"`derivatives` alone", "`derivatives=True`"),
]


def spoken(message: str, of_keys: bool = True) -> str:
    """A message of the library in the words of keywords; of keys too, unless they were written as in Rust."""
    for theirs, ours in _FIELDS + (_KEYS if of_keys else []):
        message = re.sub(theirs, ours, message)
    return message


@contextmanager
def asking(system: System) -> Iterator[None]:
    """Says what the description of a system lacks as it is written in Python, unless it is Rust's."""
    try:
        yield
    except ValueError as error:
        said = spoken(str(error))
        if system._module is not None or said == str(error):
            raise
        raise ValueError(said) from None


class Place:
    """A place in a string of a description: its name, line and column (from 1 on), how many characters, and the line's text."""

    __slots__ = ("source", "line", "column", "width", "text")

    def __init__(self, source: str, line: int, column: int, width: int, text: str) -> None:
        self.source, self.line, self.column, self.width, self.text = source, line, column, width, text

    def __repr__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}"


class Problem:
    """What is wrong with a description, and where."""

    __slots__ = ("message", "place")

    def __init__(self, message: str, place: Place | None) -> None:
        self.message, self.place = message, place

    def __repr__(self) -> str:
        return f"Problem({self.message!r}, {self.place!r})"

    def shown(self, kind: str = "error") -> str:
        """The problem with its line, and carets below the words."""
        place = self.place
        if place is None:
            return f"{kind}: {self.message}"
        number = str(place.line)
        margin = " " * len(number)
        # no terminal shows a line of thousands
        start = max(place.column - 61, 0) if len(place.text) > 180 else 0
        text = "".join(c if c.isprintable() else " " for c in place.text[start : start + 180])
        width = max(min(place.width, 180 - (place.column - 1 - start)), 1)
        carets = " " * (place.column - 1 - start) + "^" * width
        return (
            f"{kind}: {self.message}\n{margin}--> {place.source}:{place.line}:{place.column}\n"
            f"{margin} |\n{number} | {text}\n{margin} | {carets}"
        )


class DescriptionError(ValueError):
    """A description that no system can be made of: all its problems, each at its place in the string it stands in."""

    __module__ = "coadjoint"

    #: All that is wrong, in the order of the strings.
    problems: list[Problem]

    def __init__(self, message: str, problems: list[Any] | None = None) -> None:
        super().__init__(message)
        self.problems = [
            one if isinstance(one, Problem) else Problem(one[0], one[1] and Place("description", *one[1]))
            for one in problems or []
        ]


class StepError(ArithmeticError):
    """A step that could not be taken; the time and the state from which, and of a run what it led to until then."""

    __module__ = "coadjoint"

    #: The time from which the step could not be taken.
    t: float
    #: The state at that time, as a flat array.
    y: np.ndarray
    #: The number of the step, from 1 on, if it is one of a run.
    step: int | None
    #: Of a run, what was reached.
    solution: Solution | None

    def __init__(self, message: str, t: float = np.nan, y: np.ndarray | None = None, step: int | None = None) -> None:
        super().__init__(message)
        self.t, self.y, self.step, self.solution = t, np.empty(0) if y is None else y, step, None

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.t, self.y, self.step)
