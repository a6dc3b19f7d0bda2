"""From strings and keywords to one text, and back from places in it to places in the strings.

What stands in a string stays in its place: before the strings are put together, each is looked at alone.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from . import _native
from ._errors import DescriptionError, Place, Problem, spoken

#: Keys of a description that are written `key(value)`; others are written `key = value`.
LISTED = ("advected", "control", "event", "methods", "retractions", "derivatives")
#: Keys that may be a dict, and what stands there between a name and its value.
NAMED = {"group": ":", "advected": ":", "control": ":", "force": "=", "event": "="}
#: What one string of a key is, if not a formula.
ONE = {"group": "group", "control": "type", "advected": "space", "invariance": "word", "parameters": "type", "inertia": "type"}
#: Other words for types of fields.
TYPES = {"float": "f64", "scalar": "f64", "number": "f64"}
_TYPE = re.compile(r"\b((?:Vector|Matrix)\d+|float|scalar|number)\b(?!\s*<)")
#: One of them in the place of a type.
_NUMBER = re.compile(r"(?P<before>[:\[]\s*)(?P<word>float|scalar|number)\b")
#: What a dict's keys are; those of forces and inertias may be parts of arrays.
_NAME = re.compile(r"[^\W\d]\w*(?:\[\d+\])?")
#: Where comments and literals begin, or all of them; what is in a literal may look like anything.
_COMMENT = re.compile(r"//[^\n]*|/\*")
_NESTED = re.compile(r"/\*|\*/")
_HIDDEN = re.compile(
    r"""//[^\n]* | /\* | (?<!\w)[bc]?r(?P<hashes>\#*)".*?"(?P=hashes) | (?<!\w)[bc]?r\#*" | "(?:\\.|[^"\\])*" | " | '(?:\\.[^'\n]*|[^'\\\n])'""",
    re.S | re.X,
)
_FIELD = re.compile(r"^(?P<lead>\s*)(?P<body>[^\[\]]*(?:\[[^\[\]]*;[^\[\]]*\])?)\s*(?:\[(?P<unit>[^\[\];]*)\])?\s*$")


class Text:
    """A text that is put together of pieces, each of which starts a line of its own."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        #: For each line: what string it is of, its number there, how many columns it is moved, and its text there.
        self.origins: list[tuple[str, int, int, str] | None] = []
        #: What is wrong with the user's strings before they are put together.
        self.problems: list[Problem] = []
        #: The fields' names.
        self.fields: set[str] = set()
        #: Whether the user wrote fields as keywords, and whether all keys too, and not Rust.
        self.has_fields = self.has_keys = False

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

    def wrong(self, source: str, given: str, at: int, message: str, width: int = 1) -> None:
        """Something wrong at a place of a string."""
        self.problems.append(Problem(message, _place(source, given, at, width)))

    def unbalanced(self) -> Place | None:
        """The first bracket or quote of the user's strings that is not closed where it was opened, or was not opened."""
        strings: dict[str, dict[int, str]] = {}
        for origin in self.origins:
            if origin is not None:
                strings.setdefault(origin[0], {})[origin[1]] = origin[3]
        for source, lines in strings.items():
            text = "\n".join(lines.get(number, "") for number in range(1, max(lines) + 1))
            found = _unclosed(_bare(text))
            if found is not None:
                return _place(source, text, found[0])
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


def _place(source: str, given: str, at: int, width: int = 1) -> Place:
    """The place of a character of a string."""
    before = given[:at]
    line = before.count("\n") + 1
    return Place(source, line, at - before.rfind("\n"), width, given.split("\n")[line - 1].rstrip("\r"))


def _bare(text: str, hidden: re.Pattern[str] = _HIDDEN) -> str:
    """The text with blanks in place of its comments and literals. What is not closed stays as it is, and all behind it."""
    parts, at = [], 0
    while (found := hidden.search(text, at)) is not None:
        start, end = found.span()
        parts.append(text[at:start])
        if found[0] == "/*":
            # they may be nested
            depth = 1
            while depth and (mark := _NESTED.search(text, end)) is not None:
                depth += 1 if mark[0] == "/*" else -1
                end = mark.end()
            closed = depth == 0
        else:
            closed = found[0].startswith("/") or len(found[0].lstrip("bcr#")) > 1
        at = start
        if not closed:
            break
        parts.append(re.sub(r"[^\n]", " ", text[start:end]))
        at = end
    return "".join(parts) + text[at:]


def _unclosed(bare: str, quotes: bool = True) -> tuple[int, str] | None:
    """Where something is not closed, or closes what was not opened, and what is wrong."""
    pairs, opened = {")": "(", "]": "[", "}": "{"}, []
    for at, char in enumerate(bare):
        if char in "([{":
            opened.append((at, char))
        elif char in pairs:
            if not opened or opened[-1][1] != pairs[char]:
                return at, "this bracket closes none that was opened here"
            opened.pop()
        elif bare.startswith("/*", at):
            return at, "this comment is not closed"
        elif char == '"' and quotes:
            return at, "a bracket or a quote is not closed"
    return (opened[-1][0], "a bracket or a quote is not closed") if opened else None


def _comma(bare: str, is_type: bool) -> int | None:
    """Where the first comma is that stands in no brackets. In formulas those of types begin with `::<`."""
    opened: list[str] = []
    for at, char in enumerate(bare):
        if char in "([{":
            opened.append(char)
        elif char in ")]}":
            while opened.pop() == "<":
                pass
        elif char == "<" and (is_type or opened[-1:] == ["<"] or bare.startswith("::", max(at - 2, 0))):
            opened.append(char)
        elif char == ">" and opened[-1:] == ["<"]:
            opened.pop()
        elif char == "," and not opened:
            return at
    # brackets of types that are not closed hide nothing
    return bare.find(",") if opened and "," in bare else None


def _look(text: Text, source: str, given: str, one: str | None = None, quotes: bool = True) -> None:
    """Looks at a string alone: its brackets are its own, and where one thing is expected there are not two.

    one: the word for what that is, nothing if it is a list.
    """
    bare = _bare(given, _HIDDEN if quotes else _COMMENT)
    found = _unclosed(bare, quotes)
    if found is not None:
        text.wrong(source, given, *found)
    elif one is not None:
        if source.startswith("event["):
            # the direction, which is a word, may follow
            bare = re.sub(r",(?=\s*\w+\s*$)", " ", bare, count=1)
        at = _comma(bare, one not in ("formula", "group"))
        if at is not None:
            more = "several are a dict, by name" if source in NAMED else "each key is a keyword of its own"
            text.wrong(source, given, at, f"one {one} is expected here, and a comma is behind it; {more}")


def _named(text: Text, source: str, name: Any, many: bool = False) -> bool:
    """Whether a key of a dict is a name; many: or several, with commas between them."""
    names = name.split(",") if many and isinstance(name, str) else [name]
    if all(isinstance(one, str) and _NAME.fullmatch(one.strip()) for one in names):
        return True
    text.wrong(source, str(name), 0, f"a name is expected, not {name!r}", max(len(str(name)), 1))
    return False


def _entries(text: str) -> list[tuple[int, int, str]]:
    """The entries of a list with commas or lines between them, outside of brackets: the line and the column of each."""
    entries, depth, start, line, column = [], 0, (1, 0), 1, 0
    current = ""
    for char in _bare(text, _COMMENT) + ",":
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
            of_factor = factor is not None and _is_named(kind)
            if not _named(text, source, name, many=of_factor):
                continue
            if of_factor:
                _fields(text, f"{source}[{name!r}]", kind, name)
                continue
            _look(text, f"{source}[{name!r}]", kind, "type", quotes=False)
            _field(text, f"{source}[{name!r}]", 1, 0, kind, kind, factor, name)
        return
    if not isinstance(given, str):
        raise TypeError(f"{source} must be a string such as 'weight: f64 [N], chi: Vector3 [m]', or a dict")
    lines = given.split("\n")
    _look(text, source, given, quotes=False)
    for line, column, entry in _entries(given):
        _field(text, source, line, column, lines[line - 1], entry, factor, None)


def _field(
    text: Text, source: str, line: int, column: int, shown: str, entry: str, factor: str | None, name: str | None
) -> None:
    written = re.match(r"(\w+)\s*:", entry)
    own, wide = (name, len(shown)) if name is not None else (written[1], len(written[1])) if written else (None, 0)
    if own in text.fields:
        place = Place(source, line, column + 1, max(wide, 1), shown)
        text.problems.append(Problem(f"`{own}` is given twice: a name is that of one parameter", place))
    elif own is not None:
        text.fields.add(own)
    if "=" in entry:
        place = Place(source, line, column + entry.index("=") + 1, 1, shown)
        text.problems.append(Problem("a parameter is described by its type alone: numbers are given when the system is called", place))
    match = _FIELD.match(entry)
    body, unit = (match["body"].rstrip(), match["unit"]) if match else (entry, None)
    if factor:
        # `inertia={factor: …}`: what is wrong with the factor is at that key
        text.line("inertia", 1, factor, -len("#[inertia("), f"#[inertia({factor})]")
    elif factor is not None:
        text.glue("#[inertia]")
    if unit is not None:
        text.line(source, line, shown, column, f"#[unit({_quoted(unit)})]")
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
    text.has_fields, text.has_keys = True, positional is None
    name = "System" if name is None else name
    if not name.isidentifier():
        raise ValueError(f"the name of a system must be an identifier, not {name!r}")
    doc = keys.pop("doc", None)
    inertia, parameters, definitions = (keys.pop(key, None) for key in ("inertia", "parameters", "definitions"))
    if definitions is not None:
        _look(text, "definitions", _string("definitions", definitions))
        text.piece("definitions", definitions)
    for line in (doc or "").splitlines():
        text.glue(f"/// {line}")
    text.glue("#[lie_poisson_system(")
    if positional is not None:
        if not isinstance(positional, str):
            raise TypeError(f"a description is a string, not {type(positional).__name__}")
        _look(text, "description", positional)
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
            if _named(text, "units", name):
                text.line("units", 1, repr(dict(value)), 0, f"{name} = {_quoted(_string('units', unit))},")
        text.glue("),")
    elif isinstance(value, Mapping):
        if key not in NAMED:
            raise TypeError(f"{key} must be a string")
        text.glue(f"{key}(")
        for name, one in value.items():
            source = f"{key}[{name!r}]"
            one = _string(source, one)
            if not _named(text, key, name):
                continue
            _look(text, source, one, ONE.get(key, "formula"))
            text.glue(f"{name} {NAMED[key]}")
            text.piece(source, _numbers(f":{one}")[1:] if key == "control" else one, one)
            text.glue(",")
        text.glue("),")
    else:
        value = _string(key, value)
        # `group = SO3`, but `group(attitude: SO3, position: R3)`; `force = u`, but `force(attitude = u)`
        listed = key in LISTED or (key == "group" and _is_named(value)) or (key == "force" and _is_assigned(value))
        _look(text, key, value, None if listed else ONE.get(key, "formula"))
        text.glue(f"{key}(" if listed else f"{key} =")
        text.piece(key, _numbers(value) if key == "control" else value, value)
        text.glue(")," if listed else ",")


def _quoted(unit: str) -> str:
    """A unit as a literal."""
    escaped = unit.strip().replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _is_assigned(text: str) -> bool:
    """Whether a string is `attitude = moment, position = thrust`, and not a formula alone."""
    return re.match(r"^\s*\w+\s*(?:\[\s*\d+\s*\]\s*)?=(?!=)", _bare(text)) is not None


def _is_named(text: str) -> bool:
    """Whether a string is `attitude: SO3, position: R3`, and not a group or a type alone."""
    return re.match(r"^\s*\w+\s*:(?!:)", text) is not None


def _numbers(types: str) -> str:
    """Types with `f64` for other words; what follows them stays in its columns."""
    return _NUMBER.sub(lambda m: m["before"] + TYPES[m["word"]].ljust(len(m["word"])), types)


def derive(text: Text, name: str | None) -> _native.Model:
    """The model of a text; problems are at their places in the user's strings."""
    problems = text.problems
    if not problems:
        try:
            return _native.Model(str(text), name)
        except DescriptionError as error:
            problems = _at_home(text, error.problems)
    raise DescriptionError("\n\n".join(one.shown() for one in problems), problems)


def _at_home(text: Text, found: list[Problem]) -> list[Problem]:
    """Problems of the whole text at their places in the user's strings, each once, and in words of keywords."""
    problems: list[Problem] = []
    for one in found:
        at = one.place
        problem = text.problem(one.message, None if at is None else (at.line, at.column, at.width, at.text))
        if "no text of Rust" in problem.message:
            # the lexer tells of brackets that are ours too
            problem.place = text.unbalanced() or problem.place
        if text.has_fields:
            problem.message = spoken(problem.message, text.has_keys)
        if all(repr(problem) != repr(other) for other in problems):
            problems.append(problem)
    return problems
