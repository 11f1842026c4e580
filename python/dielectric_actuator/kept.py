"""Files that are written: a table at once, or one that grows on disk while it is made, so that what is done is kept and
the same work goes on from there."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TextIO

import numpy as np

Columns = Mapping[str, np.ndarray]


class AnotherTable(ValueError):
    """The unfinished file holds other work."""


def writable(path: str | Path) -> Path:
    """The file that a path and its links lead to, in a folder that is there; IsADirectoryError for a folder."""
    path = Path(path)
    if path.is_dir():
        raise IsADirectoryError(f"{path} is a folder; name a file in it")
    if _is_device(path):
        return path
    found = path.resolve()
    found.parent.mkdir(parents=True, exist_ok=True)
    return found


def _is_device(path: Path) -> bool:
    """Whether it is a terminal, a pipe or the like, which has no place to put a file into."""
    return path.exists() and not path.is_file()


def write_table(path: str | Path, columns: Columns) -> None:
    """Write a CSV file, each column's values as exact decimal numbers."""
    with writable(path).open("w", newline="", encoding="utf-8") as file:
        _write_rows(file, columns, header=True)


def _write_rows(file: TextIO, columns: Columns, *, header: bool) -> None:
    writer = csv.writer(file, lineterminator="\n")
    if header:
        writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values())))


class KeptTable:
    """Rows of a CSV file, written next to it and put into its place when all are there.

    `work` tells one piece of work from another. ``done`` says how many rows an earlier attempt has left.
    Raises `AnotherTable` where it was one of other work. A terminal or a pipe gets each row at once, and keeps none.
    """

    def __init__(self, path: str | Path, work: str):
        self.path = Path(path)
        self._file_in_place = writable(path)
        self._mark = f"# {hashlib.sha256(work.encode()).hexdigest()}\n"
        self.done = 0
        self._unfinished: Path | None = None
        if _is_device(self.path):
            self._file = self.path.open("w", newline="", encoding="utf-8")
        else:
            self._unfinished = self._file_in_place.with_name(self._file_in_place.name + ".unfinished")
            if self._unfinished.exists():
                self.done = self._take_over(self._unfinished)
            if not self.done:
                self._unfinished.write_text(self._mark, encoding="utf-8")
            self._file = self._unfinished.open("a", newline="", encoding="utf-8")
        self._headed = self.done > 0

    def __enter__(self) -> KeptTable:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._file.close()
        if self._unfinished and not self._headed:
            self._unfinished.unlink(missing_ok=True)

    def _take_over(self, unfinished: Path) -> int:
        """Count whole rows, and cut off one that was being written."""
        text = unfinished.read_bytes()
        whole = text[: text.rfind(b"\n") + 1]
        if whole.count(b"\n") <= 2:
            return 0
        if not whole.startswith(self._mark.encode()):
            raise AnotherTable(f"{unfinished} holds the unfinished rows of other work; remove it or write elsewhere")
        unfinished.write_bytes(whole)
        return whole.count(b"\n") - 2

    def add(self, columns: Columns) -> None:
        """Append rows, each column's values as exact decimal numbers."""
        _write_rows(self._file, columns, header=not self._headed)
        self._headed = True
        self._file.flush()

    def complete(self) -> Path:
        """Put the file into its place and return its path."""
        self._file.close()
        if self._unfinished is not None:
            rows = self._unfinished.read_text(encoding="utf-8").removeprefix(self._mark)
            self._unfinished.write_text(rows, encoding="utf-8")
            self._unfinished.replace(self._file_in_place)
        return self.path
