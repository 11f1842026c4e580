"""Many runs of the FMU on a chosen number of processes, each with one loaded instance that it resets.

Unpacking, loading and instantiating cost 40 ms, a reset 20 µs, and 2000 time units of motion 0.1 ms: what a
study of many scenes must not pay for again and again is the first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import util
from pathlib import Path
from typing import Any

from dielectric_actuator import Actuator
from progress import Progress

_actuator: Actuator | None = None


def _open(fmu: Path) -> None:
    global _actuator
    _actuator = Actuator(fmu)
    # a worker process runs no atexit functions; these it does
    util.Finalize(None, _actuator.close, exitpriority=1)


def _call(task_and_item: tuple[Callable, Any]) -> Any:
    task, item = task_and_item
    return task(_actuator, item)


class Workers:
    """A context manager. `count` processes, or none but this one if `count` is 1."""

    def __init__(self, fmu: Path, count: int, progress: Progress):
        self.count = count
        self._progress = progress
        self._pool = ProcessPoolExecutor(count, initializer=_open, initargs=(fmu,)) if count > 1 else None
        self.actuator = Actuator(fmu)
        """This process' own instance, for single runs."""

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_exception) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)
        self.actuator.close()

    def map(self, task: Callable[[Actuator, Any], Any], items: Iterable) -> list:
        """`task` (a function of a module) for each item, in the order of the items; the stage shows how far it is."""
        count = len(jobs := [(task, item) for item in items])
        here = (task(self.actuator, item) for _, item in jobs)
        results: Iterator[Any] = here if self._pool is None else self._pool.map(_call, jobs)
        collected = []
        for result in results:
            collected.append(result)
            self._progress.part(len(collected), count)
        return collected
