"""Measured data: read from CSV, and checked so that a fault is named by row and column."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .fmu import UnknownName

Floats = NDArray[np.float64]


def read(path: str | Path, columns: Iterable[str]) -> dict[str, Floats]:
    """The named columns of a CSV file whose first line names its columns; rows are counted from 1 after it.

    Raises `UnknownName` for a column that the file does not have, ValueError with row and column for a value that
    is no number.
    """
    try:
        return _read(Path(path), list(columns))
    except (csv.Error, UnicodeDecodeError) as reason:
        raise ValueError(f"{path} cannot be read as a table: {reason}") from None


def _read(path: Path, columns: list[str]) -> dict[str, Floats]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        reader = csv.reader(file, skipinitialspace=True)
        header = [name.strip() for name in next(reader, [])]
        for name in columns:
            if name not in header:
                raise UnknownName(f"column in {path}:", name, header)
        places = [header.index(name) for name in columns]
        table: list[list[float]] = []
        for number, row in enumerate((row for row in reader if row), start=1):
            table.append([_number(row, place, name, number) for place, name in zip(places, columns)])
    values = np.array(table, dtype=float).reshape(len(table), len(columns))
    return {name: values[:, place] for place, name in enumerate(columns)}


def _number(row: list[str], place: int, name: str, number: int) -> float:
    text = row[place] if place < len(row) else ""
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{name} in row {number} is {text.strip() or 'missing'!r}; it must be a number") from None


def check(
    time: ArrayLike, columns: Mapping[str, ArrayLike], *, clock: str = "time"
) -> tuple[Floats, dict[str, Floats]]:
    """The time and the columns as arrays; messages count rows from 1 and call the time `clock`.

    Raises ValueError where columns are empty or differ in length, a value is no finite number, or the time does not
    increase.
    """
    time = np.atleast_1d(np.asarray(time, dtype=float))
    if not len(time):
        raise ValueError(f"{clock} has no rows")
    checked = {name: np.asarray(column, dtype=float) for name, column in columns.items()}
    for name, column in {clock: time, **checked}.items():
        if column.shape != (len(time),):
            raise ValueError(f"{name} has the shape {column.shape}; it must have {len(time)} rows, as {clock} has")
        bad = np.flatnonzero(~np.isfinite(column))
        if bad.size:
            raise ValueError(f"{name} in row {bad[0] + 1} is {column[bad[0]]}; it must be a finite number")
    back = np.flatnonzero(np.diff(time) <= 0)
    if back.size:
        row = back[0]
        raise ValueError(f"{clock} in row {row + 2} is {time[row + 1]:g} after {time[row]:g}; it must increase")
    return time, checked
