"""The worker's side of a sweep: one loaded actuator, reset between scenes.

A measure is a function ``(actuator, scene) -> results`` that runs one scene, given as start values by
variable name, and returns its results by column name.
"""

from __future__ import annotations

import hashlib
import math
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from distributed import WorkerPlugin, get_worker

from .actuator import Actuator

Measure = Callable[[Actuator, Mapping[str, float]], Mapping[str, float]]

_loaded = threading.local()


class CarryFmu(WorkerPlugin):  # type: ignore[misc]
    """Puts the packed FMU into the folder of each worker, of one that joins late too."""

    def __init__(self, name: str, packed: bytes):
        self.name = name
        self._packed = packed

    def setup(self, worker: Any) -> None:
        # a folder for each content, so that a cluster that stays up may see the FMU change
        path = Path(worker.local_directory) / hashlib.sha256(self._packed).hexdigest()[:16] / self.name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(self._packed)
        worker.actuator_fmu = path


def loaded_actuator(path: Path) -> Actuator:
    """The actuator of this thread, loaded at its first scene and kept."""
    if getattr(_loaded, "path", None) != path:
        _loaded.actuator, _loaded.path = Actuator(path), path
    actuator: Actuator = _loaded.actuator
    return actuator


def run_batch(measure: Measure, scenes: list[dict[str, float]]) -> list[dict[str, object]]:
    """The task that the scheduler hands to a worker: `run_scenes` with the worker's actuator."""
    return run_scenes(loaded_actuator(get_worker().actuator_fmu), measure, scenes)


def run_scenes(actuator: Actuator, measure: Measure, scenes: list[dict[str, float]]) -> list[dict[str, object]]:
    """Results of each scene in order; of one that fails, its reason under ``failure``."""
    results: list[dict[str, object]] = []
    for scene in scenes:
        try:
            found = {name: _plain(value) for name, value in measure(actuator, scene).items()}
            results.append({**found, "failure": None})
        except Exception as failure:  # whatever one scene raises, the others go on
            reason = " ".join([f"{type(failure).__name__}: {failure}", *getattr(failure, "__notes__", [])])
            results.append({"failure": reason})
    return results


def _plain(value: Any) -> object:
    """A number of NumPy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value


def frequency_response(actuator: Actuator, scene: Mapping[str, float], *, stop_time: float) -> dict[str, float]:
    """Half the range of λ₃ from rest to `stop_time` (the paper's λ₃ᵃ), in a single communication step.

    The FMU locates the extremes between communication points, so that nothing needs to be sampled.
    """
    actuator.start({**scene, "record_extremes": True})
    actuator.advance(stop_time)
    lowest, highest, pulled_in = actuator.get("lambda3_lowest", "lambda3_highest", "pulled_in")
    return {
        "lambda3_amplitude": (highest - lowest) / 2,
        "lambda3_lowest": lowest,
        "lambda3_highest": highest,
        "pulled_in": bool(pulled_in),
    }


def pull_in(actuator: Actuator, scene: Mapping[str, float], *, stop_time: float) -> dict[str, float]:
    """Whether and when the actuator is pulled in before `stop_time`, and the thresholds beside it."""
    actuator.start({**scene, "record_extremes": True})
    actuator.advance(stop_time)
    pulled_in, time, lowest, dynamic, static = actuator.get(
        "pulled_in", "pull_in_time", "lambda3_lowest", "phi_pull_in", "phi_pull_in_static"
    )
    return {
        "pulled_in": bool(pulled_in),
        "pull_in_time": time if math.isfinite(time) else None,
        "lambda3_lowest": lowest,
        "phi_pull_in": dynamic,
        "phi_pull_in_static": static,
    }
