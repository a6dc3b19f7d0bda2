"""From strings and keywords to one text, and back from places in it to places in the strings."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from . import _native
from ._errors import DescriptionError, Place, Problem

#: Keys of a description that are written `key = value`, and those that are written `key(value)`.
ASSIGNED = ("potential", "hamiltonian", "lagrangian", "invariance")
LISTED = ("advected", "control", "methods", "retractions", "derivatives")
#: Other words for types of fields.
TYPES = {"float": "f64", "scalar": "f64", "number": "f64"}
_TYPE = re.compile(r"\b((?:Vector|Matrix)\d+|float|scalar|number)\b(?!\s*<)")
#: One of them in the place of a type.
_NUMBER = re.compile(r"(?P<before>[:\[]\s*)(?P<word>float|scalar|number)\b")
_FIELD = re.compile(r"^(?P<lead>\s*)(?P<body>[^\[\]]*(?:\[[^\[\]]*;[^\[\]]*\])?)\s*(?:\[(?P<unit>[^\[\];]*)\])?\s*$")


class Text:
    """A text that is put together of pieces, each of which starts a line of its own."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        #: For each line: what string it is of, its number there, how many columns it is moved, and its text there.
        self.origins: list[tuple[str, int, int, str] | None] = []

    def glue(self, line: str) -> None:
        """A line of ours."""
        self.lines.append(line)
        self.origins.append(None)

    def piece(self, source: str, text: str, shown: str | None = None) -> None:
        """A string of the user's, as it is; or with other words in the same columns, where it is said what is shown of it."""
        lines = text.split("\n")
        for number, (line, one) in enumerate(zip(lines, lines if shown is None else shown.split("\n"), strict=True), 1):
            self.lines.append(line)
            self.origins.append((source, number, 0, one.rstrip("\r")))

    def line(self, source: str, number: int, shown: str, column: int, line: str) -> None:
        """A line made of a part of one of the user's, which starts at this column there."""
        self.lines.append(line)
        self.origins.append((source, number, column, shown))

    def __str__(self) -> str:
        return "\n".join(self.lines)

    def unbalanced(self) -> Place | None:
        """The first bracket of the user's strings that is not closed where it was opened, or was not opened."""
        pairs = {")": "(", "]": "[", "}": "{"}
        seen: dict[str, list[tuple[str, int, int, str]]] = {}
        shown = set()
        for origin in self.origins:
            if origin is None or (origin[0], origin[1]) in shown:
                continue
            source, number, _, text = origin
            shown.add((source, number))
            opened = seen.setdefault(source, [])
            for column, char in enumerate(re.sub(r"//.*", "", text), 1):
                if char in "([{":
                    opened.append((char, number, column, text))
                elif char in pairs:
                    if not opened or opened[-1][0] != pairs[char]:
                        return Place(source, number, column, 1, text)
                    opened.pop()
        for source, opened in seen.items():
            if opened:
                _, number, column, text = opened[-1]
                return Place(source, number, column, 1, text)
        return None

    def problem(self, message: str, place: tuple[int, int, int, str] | None) -> Problem:
        """A problem at a place of this text, at its place in the user's string."""
        if place is None:
            return Problem(message, None)
        line, column, width, _ = place
        origin = self.origins[line - 1] if line <= len(self.origins) else None
        if origin is None:
            # it is about what stands around the user's strings
            return Problem(message, None)
        source, number, moved, text = origin
        column = max(column + moved, 1)
        return Problem(message, Place(source, number, column, max(min(width, len(text) - column + 1), 1), text))


def _entries(text: str) -> list[tuple[int, int, str]]:
    """The entries of a list with commas or lines between them, outside of brackets: the line and the column of each."""
    entries, depth, start, line, column = [], 0, (1, 0), 1, 0
    current = ""
    for char in text + ",":
        if char in "([<{":
            depth += 1
        elif char in ")]>}":
            depth -= 1
        if (char == "," and depth <= 0) or char == "\n":
            if current.strip():
                lead = len(current) - len(current.lstrip())
                entries.append((start[0], start[1] + lead, current.strip()))
            current = ""
            line, column = (line + 1, 0) if char == "\n" else (line, column + 1)
            start = (line, column)
            continue
        current += char
        column += 1
    return entries


def _fields(text: Text, source: str, given: Any, factor: str | None) -> None:
    """Fields `name: type [unit]`, of a string or of a mapping.

    factor: what they are inertias of, nothing if the group is not one of several; none of parameters. A mapping may have inertias by factor.
    """
    if isinstance(given, Mapping):
        for name, kind in given.items():
            if not isinstance(kind, str):
                raise TypeError(f"{source}: the type of `{name}` must be a string such as 'Vector3 [m]'")
            if factor is not None and _is_named(kind):
                _fields(text, f"{source}[{name!r}]", kind, name)
                continue
            _field(text, f"{source}[{name!r}]", 1, 0, kind, kind, factor, name)
        return
    if not isinstance(given, str):
        raise TypeError(f"{source} must be a string such as 'weight: f64 [N], chi: Vector3 [m]', or a dict")
    lines = given.split("\n")
    for line, column, entry in _entries(given):
        _field(text, source, line, column, lines[line - 1], entry, factor, None)


def _field(
    text: Text, source: str, line: int, column: int, shown: str, entry: str, factor: str | None, name: str | None
) -> None:
    match = _FIELD.match(entry)
    body, unit = (match["body"].rstrip(), match["unit"]) if match else (entry, None)
    if factor:
        # `inertia={factor: …}`: what is wrong with the factor is at that key
        text.line("inertia", 1, factor, -len("#[inertia("), f"#[inertia({factor})]")
    elif factor is not None:
        text.glue("#[inertia]")
    if unit is not None:
        quoted = unit.strip().replace("\\", "\\\\").replace('"', '\\"')
        text.line(source, line, shown, column, f'#[unit("{quoted}")]')
    # what is added is added behind, so that columns stay
    typed = _TYPE.sub(lambda m: TYPES.get(m[1], f"{m[1]}<f64>"), body)
    if name is not None:
        text.glue(f"{name}:")
    text.line(source, line, shown, column, typed)
    text.glue(",")


def compose(positional: str | None, name: str | None, keys: Mapping[str, Any]) -> tuple[Text, str | None]:
    """One text of what was given, and which struct of it is meant."""
    text = Text()
    keys = {key: value for key, value in keys.items() if value is not None and value is not False}
    if positional is not None and re.search(r"\bstruct\b", positional):
        if keys:
            raise TypeError(f"beside a whole text there are no keywords: {', '.join(keys)}")
        text.piece("description", positional)
        return text, name
    name = "System" if name is None else name
    if not name.isidentifier():
        raise ValueError(f"the name of a system must be an identifier, not {name!r}")
    doc = keys.pop("doc", None)
    inertia, parameters, definitions = (keys.pop(key, None) for key in ("inertia", "parameters", "definitions"))
    if definitions is not None:
        text.piece("definitions", _string("definitions", definitions))
    for line in (doc or "").splitlines():
        text.glue(f"/// {line}")
    text.glue("#[lie_poisson_system(")
    if positional is not None:
        if not isinstance(positional, str):
            raise TypeError(f"a description is a string, not {type(positional).__name__}")
        # with or without the brackets of the macro
        text.piece("description", positional)
        text.glue(",")
    for key, value in keys.items():
        _key(text, key, value)
    text.glue(")]")
    text.glue(f"struct {name} {{")
    if inertia is not None:
        _fields(text, "inertia", inertia, "")
    if parameters is not None:
        _fields(text, "parameters", parameters, None)
    text.glue("}")
    return text, name


def _string(key: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{key} must be a string, not {type(value).__name__}")
    return value


def _key(text: Text, key: str, value: Any) -> None:
    if key == "taylor" or (key == "derivatives" and value is True):
        text.glue(f"{key},")
    elif key == "units":
        if not isinstance(value, Mapping):
            raise TypeError("units must be a dict such as {'momentum': 'kg m²/s'}")
        text.glue("units(")
        for name, unit in value.items():
            text.line("units", 1, repr(dict(value)), 0, f'{name} = "{unit}",')
        text.glue("),")
    elif isinstance(value, Mapping):
        separator = "=" if key == "force" else ":"
        if key not in ("group", "advected", "control", "force"):
            raise TypeError(f"{key} must be a string")
        text.glue(f"{key}(")
        for name, one in value.items():
            source = f"{key}[{name!r}]"
            one = _string(source, one)
            text.glue(f"{name} {separator}")
            text.piece(source, _numbers(f":{one}")[1:] if key == "control" else one, one)
            text.glue(",")
        text.glue("),")
    else:
        value = _string(key, value)
        # `group = SO3`, but `group(attitude: SO3, position: R3)`; `force = u`, but `force(first = u)` is a dict
        listed = key in LISTED or (key == "group" and _is_named(value))
        text.glue(f"{key}(" if listed else f"{key} =")
        text.piece(key, _numbers(value) if key == "control" else value, value)
        text.glue(")," if listed else ",")


def _is_named(text: str) -> bool:
    """Whether a string is `attitude: SO3, position: R3`, and not a group or a type alone."""
    return re.match(r"^\s*\w+\s*:(?!:)", text) is not None


def _numbers(types: str) -> str:
    """Types with `f64` for other words; what follows them stays in its columns."""
    return _NUMBER.sub(lambda m: m["before"] + TYPES[m["word"]].ljust(len(m["word"])), types)


def derive(text: Text, name: str | None) -> _native.Model:
    """The model of a text; problems are at their places in the user's strings."""
    try:
        return _native.Model(str(text), name)
    except DescriptionError as error:
        found = error.problems
    problems = []
    for one in found:
        at = one.place
        problem = text.problem(one.message, None if at is None else (at.line, at.column, at.width, at.text))
        if "no text of Rust" in problem.message:
            # the lexer tells of brackets that are ours too
            problem.place = text.unbalanced() or problem.place
        problems.append(problem)
    raise DescriptionError("\n\n".join(one.shown() for one in problems), problems)
