"""One line a stage of a study: what is being done, how far it is, how long it took."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager


class Progress:
    """Prints ``[2/6] what is done ...... 3.1 s``; a stage can report its parts by `part` in between."""

    def __init__(self, stages: int):
        self._stages = stages
        self._stage = 0
        self._line = ""
        self._shown = 0.0

    @contextmanager
    def stage(self, text: str):
        self._stage += 1
        self._line = f"[{self._stage}/{self._stages}] {text:<72}"
        print(self._line, end="", flush=True)
        self._shown = start = time.perf_counter()
        yield
        print(f"{self._back()}{time.perf_counter() - start:6.1f} s", flush=True)

    def part(self, done: int, total: int) -> None:
        """`done` of `total` parts of the stage are finished. Shown on a terminal, at most five times a second."""
        now = time.perf_counter()
        if sys.stdout.isatty() and now - self._shown > 0.2:
            self._shown = now
            print(f"{self._back()}{100 * done / total:5.0f} %", end="", flush=True)

    def _back(self) -> str:
        return f"\r{self._line}" if sys.stdout.isatty() else ""
