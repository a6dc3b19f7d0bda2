"""Rows of an ensemble's members: a directory with a file for each block."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np

from ._state import Array

#: The columns that are not quantities.
MEMBER, TIME = "member", "time"


class Rows:
    """Where rows are written to, in the form that the directory's name ends with."""

    def __init__(self, directory: str | os.PathLike[str], quantities: Mapping[str, Any]) -> None:
        # a worker stands elsewhere
        self.directory = Path(directory).absolute()
        self.ending = self.directory.suffix
        if self.ending not in (".csv", ".parquet"):
            raise ValueError(f"`rows` is a directory whose name ends in `.csv` or `.parquet`, not {str(directory)!r}")
        if self.ending == ".parquet":
            try:
                import pyarrow.parquet  # noqa: F401
            except ImportError:
                raise ImportError("rows as Parquet need pyarrow, which is not installed: `pip install pyarrow`, or `.csv`") from None
        for name in (MEMBER, TIME):
            if name in quantities:
                raise ValueError(f"rows have a column `{name}` already: the quantity needs another name")

    def begin(self) -> None:
        """Makes the directory; what is in one already is not mixed with."""
        self.directory.mkdir(parents=True, exist_ok=True)
        if any(self.directory.iterdir()):
            raise FileExistsError(f"{self.directory} is not empty: rows are not mixed with what is there")

    def path(self, first: int) -> Path:
        """The file of the block that begins with this member."""
        return self.directory / f"members-{first:012}{self.ending}"

    def write(self, first: int, t: Array, quantities: Mapping[str, Array]) -> None:
        """Writes a block: a row for each time and member."""
        if not self.directory.is_dir():
            raise FileNotFoundError(f"{self.directory} is not there on this worker: rows go to a directory that all workers share")
        count = next(iter(quantities.values())).shape[1]
        columns = {
            MEMBER: np.tile(np.arange(first, first + count), len(t)),
            TIME: np.repeat(t, count),
            **{name: values.ravel() for name, values in quantities.items()},
        }
        # a block may be run twice at a time, or be killed: its file is there when it is whole
        half = self.directory / f".{uuid4().hex}"
        try:
            with half.open("xb") as file:
                _table(self.ending, file, columns)
            half.replace(self.path(first))
        except BaseException:
            half.unlink(missing_ok=True)
            raise


def _table(ending: str, file: Any, columns: Mapping[str, np.ndarray]) -> None:
    if ending == ".parquet":
        import pyarrow
        import pyarrow.parquet

        pyarrow.parquet.write_table(pyarrow.table(dict(columns)), file)
        return
    text = io.TextIOWrapper(file, encoding="utf-8", newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    # each number as the shortest text that reads back as the same
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    text.flush()
    text.detach()
