"""A table that grows on disk while it is made, so that what is done is kept and the same work goes on from there."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

import numpy as np


class AnotherTable(ValueError):
    """The unfinished file holds other work."""


class KeptTable:
    """Rows of a CSV file, written next to it and put into its place when all are there.

    `work` tells one piece of work from another. ``done`` says how many rows an earlier attempt has left.
    Raises `AnotherTable` where it was one of other work.
    """

    def __init__(self, path: str | Path, work: str):
        self.path = Path(path)
        self._unfinished = self.path.with_name(self.path.name + ".unfinished")
        self._mark = f"# {hashlib.sha256(work.encode()).hexdigest()}\n"
        self.done = self._take_over() if self._unfinished.exists() else 0
        if not self.done:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._unfinished.write_text(self._mark, encoding="utf-8")
        self._file = self._unfinished.open("a", newline="", encoding="utf-8")

    def __enter__(self) -> KeptTable:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._file.close()

    def _take_over(self) -> int:
        """Count whole rows, and cut off one that was being written."""
        text = self._unfinished.read_bytes()
        whole = text[: text.rfind(b"\n") + 1]
        if whole.count(b"\n") <= 2:
            return 0
        if not whole.startswith(self._mark.encode()):
            raise AnotherTable(
                f"{self._unfinished} holds the unfinished rows of other work; remove it or write elsewhere"
            )
        self._unfinished.write_bytes(whole)
        return whole.count(b"\n") - 2

    def add(self, columns: Mapping[str, np.ndarray]) -> None:
        """Append rows, each column's values as exact decimal numbers."""
        writer = csv.writer(self._file, lineterminator="\n")
        if self._file.tell() == len(self._mark):
            writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values())))
        self._file.flush()

    def complete(self) -> Path:
        """Put the file into its place and return its path."""
        self._file.close()
        rows = self._unfinished.read_text(encoding="utf-8").removeprefix(self._mark)
        self._unfinished.write_text(rows, encoding="utf-8")
        return self._unfinished.replace(self.path)
