"""The core of the actuator where no host is in the loop: ensembles in SIMD lanes, and sensitivities.

A small shared library in the package does the work (`python/native` of the sources), without FMI.
"""

from __future__ import annotations

import ctypes
import functools
import math
import os
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import fmu
from .fmu import UnknownName
from .measured import check

Floats = NDArray[np.float64]

DEFAULT_TOLERANCE = 1e-10
"""Relative tolerance of the stretch, as the FMU's."""

_DATA = Path(__file__).resolve().parent / "data" / "native"
_CHECKOUT = Path(__file__).resolve().parents[2] / "target" / "native"
_FOLDERS = {
    ("Linux", "x86_64"): ("linux64", "so"),
    ("Linux", "aarch64"): ("aarch64-linux", "so"),
    ("Windows", "AMD64"): ("win64", "dll"),
    ("Darwin", "x86_64"): ("darwin64", "dylib"),
}

_OUTCOME = np.dtype([
    ("lambda", "f8"), ("lambda_dot", "f8"), ("lambda_lowest", "f8"), ("lambda_highest", "f8"),
    ("pull_in_time", "f8"), ("failed", "f8"),
])  # fmt: skip
_CHUNK = 128
"""Scenes that a thread follows at a time (`CHUNK` of the native library)."""
_PART = 0.3
"""Seconds that a part of an ensemble takes about: that long Ctrl-C waits, and progress is reported as often."""


class Collapse(RuntimeError):
    """The actuator was pulled in before the end; `time` is when."""

    def __init__(self, time: float):
        self.time = time
        super().__init__(f"the actuator is pulled in at time {time:.6g}, before the last sample")


@functools.cache
def _library() -> ctypes.CDLL:
    system = platform.system(), platform.machine()
    if system not in _FOLDERS:
        raise OSError(f"the package has no native library for {' '.join(system)}; `Actuator` and `sweep` do without")
    folder, extension = _FOLDERS[system]
    below = Path(folder) / f"dielectric_actuator_native.{extension}"
    path = next((path for path in (_DATA / below, _CHECKOUT / below) if path.is_file()), None)
    if path is None:
        raise OSError(f"there is no native library at {_DATA / below}; in a checkout, make native builds it")
    library = ctypes.CDLL(str(path))
    for names in (library.dea_scene_names, library.dea_known_names):
        names.restype = ctypes.c_char_p
    pointer, number, size = ctypes.c_void_p, ctypes.c_double, ctypes.c_size_t
    library.dea_sweep.argtypes = [pointer, size, number, number, size, pointer]
    library.dea_sensitivities.argtypes = [pointer, pointer, number, pointer, size, pointer, size, pointer, pointer]
    return library


@functools.cache
def scene_names() -> tuple[str, ...]:
    """Names of the variables that make up a scene of an ensemble; they are those of the FMU."""
    return tuple(_library().dea_scene_names().decode().split())


@functools.cache
def known_names() -> tuple[str, ...]:
    """What `sensitivities` differentiates with respect to: parameters and start by their names in the FMU, the
    prestress ``S``, and the factors ``phi_scale`` and ``time_scale`` of the given voltage and times."""
    return tuple(_library().dea_known_names().decode().split())


@functools.cache
def limits() -> dict[str, tuple[float, float, float]]:
    """Start value, smallest and largest value of each of `scene_names` and `known_names`."""
    found = fmu.limits("nondimensional", {*scene_names(), *known_names()})
    return {**found, "phi_scale": (1.0, -math.inf, math.inf), "time_scale": (1.0, math.ulp(0.0), math.inf)}


def _column(name: str, values: Floats) -> Floats:
    """The values of a column; ValueError with the row, counted from 1, where a value is NaN or out of range."""
    _, lowest, highest = limits()[name]
    bad = np.flatnonzero(~((lowest <= values) & (values <= highest) & np.isfinite(values)))
    if bad.size:
        raise ValueError(
            f"{name} in row {bad[0] + 1} is {values[bad[0]]:g}; it must be a number from {lowest:g} to {highest:g}"
        )
    return values


def ensemble(
    scenes: Mapping[str, ArrayLike],
    *,
    stop_time: float,
    tolerance: float = DEFAULT_TOLERANCE,
    workers: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> np.ndarray:
    """Follow many actuators from time 0 to `stop_time` at once, in SIMD lanes and on `workers` threads (0: one a core).

    `scenes` holds a column for each variable that is not at its start value, of `scene_names`; numbers and
    columns are broadcast. Voltage and prestress are constant but for the built-in alternating voltage. The
    result is a structured array, a row a scene, with the FMU's names: ``lambda`` and ``lambda_dot`` at the end or
    where the actuator was pulled in, ``lambda_lowest`` and ``lambda_highest`` on the way, located between steps, the
    same of ``lambda3``, ``pulled_in`` and ``pull_in_time`` (+inf where it was not). Where the integration
    cannot go on the numbers are NaN. `progress` is called with the number of scenes done and that of all.

    Raises `UnknownName` for a column with an unknown name, ValueError with row and column for a value that is NaN or
    out of range, before any scene is followed. Ctrl-C stops it within a second or so.
    """
    rows = scene_rows(scenes)
    found = []
    for part in parts(rows, stop_time=stop_time, tolerance=tolerance, workers=workers):
        found.append(part)
        if progress:
            progress(sum(map(len, found)), len(rows))
    return np.concatenate(found) if found else _with_thickness(np.empty(0, dtype=_OUTCOME))


def scene_rows(scenes: Mapping[str, ArrayLike]) -> Floats:
    """The scenes of an `ensemble` as rows, with a column for each of `scene_names`; raises what `ensemble` does."""
    names = scene_names()
    for name in scenes:
        if name not in names:
            raise UnknownName("variable", name, names)
    columns = np.broadcast_arrays(
        *(np.atleast_1d(np.asarray(scenes.get(name, limits()[name][0]), dtype=float)) for name in names)
    )
    if columns[0].ndim != 1:
        raise ValueError(f"the columns have {columns[0].ndim} dimensions; they must have one, as `grid` makes them")
    table = {name: _column(name, column) for name, column in zip(names, columns)}
    start, lowest, highest = (table[name] for name in ("lambda_start", "lambda_min", "lambda_max"))
    bad = np.flatnonzero(~((lowest < start) & (start < highest)))
    if bad.size:
        row = bad[0]
        raise ValueError(
            f"lambda_start in row {row + 1} is {start[row]:g}; it must lie between lambda_min = {lowest[row]:g} and "
            f"lambda_max = {highest[row]:g}"
        )
    return np.ascontiguousarray(np.column_stack([*table.values()]))


def parts(
    rows: Floats, *, stop_time: float, tolerance: float = DEFAULT_TOLERANCE, workers: int = 0
) -> Iterator[np.ndarray]:
    """The result of an `ensemble` of `scene_rows` part by part, in their order, for a caller that keeps each."""
    if not (math.isfinite(stop_time) and stop_time > 0):
        raise ValueError(f"stop_time is {stop_time:g}; it must be a number above 0")
    _check_tolerance(tolerance)
    if not (isinstance(workers, (int, np.integer)) and workers >= 0):
        raise ValueError(f"workers is {workers}; it must be a whole number above 0, or 0 for one a core")
    threads = int(workers) or os.cpu_count() or 1

    def followed() -> Iterator[np.ndarray]:
        start, chunks = 0, threads
        while start < len(rows):
            begin = time.perf_counter()
            part = rows[start : start + chunks * _CHUNK]
            outcomes = np.empty(len(part), dtype=_OUTCOME)
            ending = _library().dea_sweep(
                part.ctypes.data, len(part), stop_time, tolerance,
                min(threads, -(-len(part) // _CHUNK)), outcomes.ctypes.data,
            )  # fmt: skip
            if ending:
                raise RuntimeError("a fault in the native library: the ensemble could not be followed")
            yield _with_thickness(outcomes)
            start += len(part)
            taken = max(time.perf_counter() - begin, _PART / 8)
            chunks = max(threads, int(chunks * _PART / taken))

    return followed()


def _check_tolerance(tolerance: float) -> None:
    if not 1e-14 <= tolerance <= 1e-2:
        raise ValueError(f"tolerance is {tolerance:g}; it must be from 1e-14 to 1e-2")


def _with_thickness(outcomes: np.ndarray) -> np.ndarray:
    fields = [(name, "f8") for name in _OUTCOME.names[:-1]] if _OUTCOME.names else []
    table = np.empty(
        len(outcomes), dtype=[*fields, ("lambda3_lowest", "f8"), ("lambda3_highest", "f8"), ("pulled_in", "?")]
    )
    for name, _ in fields:
        table[name] = outcomes[name]
    table["lambda3_lowest"] = outcomes["lambda_highest"] ** -2.0
    table["lambda3_highest"] = outcomes["lambda_lowest"] ** -2.0
    table["pulled_in"] = np.isfinite(outcomes["pull_in_time"])
    return table


def sensitivities(
    values: Mapping[str, float],
    time: ArrayLike,
    voltage: ArrayLike,
    *,
    at: ArrayLike | None = None,
    interpolation: str = "linear",
    tolerance: float = DEFAULT_TOLERANCE,
) -> tuple[Floats, Floats]:
    """The stretch under a given voltage, and its derivatives by each of `known_names`.

    The derivatives are integrated along with the motion, over its steps: none is a difference of two runs.

    The voltage is ``phi_scale`` times the given one, which is a straight line between two samples
    (`interpolation` "linear") or keeps its value up to the next ("hold"); the times are multiplied by
    ``time_scale``. The motion starts at the first time. Returns λ at the times `at` (default: `time`) and an
    array with a row for each of them and a column for each of `known_names`: the variational equations along the
    trajectory, solved with the substeps of the motion.

    Raises `Collapse` where the actuator is pulled in on the way, ValueError with the row where the times do not
    increase, those of `at` go back or lie before the first, or a value is no number or out of range, and RuntimeError
    where the way is too long to be followed.
    """
    names = known_names()
    for name in values:
        if name not in names:
            raise UnknownName("parameter", name, names)
    knowns = np.array([
        _column(name, np.array([float(values.get(name, limits()[name][0]))]))[0] for name in names
    ])  # fmt: skip
    _check_tolerance(tolerance)
    time, columns = check(time, {"voltage": voltage})
    sampled = np.ascontiguousarray(time if at is None else at, dtype=float)
    if sampled.ndim != 1:
        raise ValueError(f"at has {sampled.ndim} dimensions; it must be a row of times")
    back = np.flatnonzero(~((np.diff(sampled, prepend=time[0]) >= 0) & np.isfinite(sampled)))
    if back.size:
        raise ValueError(
            f"at in row {back[0] + 1} is {sampled[back[0]]:g}; it must not go back, nor start before "
            "time, nor be infinite"
        )
    bounds = np.array([limits()["lambda_min"][0], limits()["lambda_max"][0]])
    ramps = _ramps(time, columns["voltage"], interpolation)
    samples = np.empty((len(sampled), 1 + len(names)))
    when = np.zeros(1)
    ending = _library().dea_sensitivities(
        knowns.ctypes.data, bounds.ctypes.data, tolerance, ramps.ctypes.data, len(ramps),
        sampled.ctypes.data, len(sampled), samples.ctypes.data, when.ctypes.data,
    )  # fmt: skip
    if ending == 1:
        raise Collapse(float(when[0]))
    if ending:
        raise RuntimeError("the integration could not go on" if ending == 2 else "a fault in the native library")
    return samples[:, 0], samples[:, 1:]


def _ramps(time: Floats, voltage: Floats, interpolation: str) -> Floats:
    """Rows of time, voltage and slope; a row that continues the line of the row before is left out."""
    slopes = np.zeros(len(time))
    if interpolation == "linear":
        slopes[:-1] = np.diff(voltage) / np.diff(time)
    elif interpolation != "hold":
        raise ValueError(f"interpolation is {interpolation!r}; it must be 'linear' or 'hold'")
    ramps = np.column_stack([time, voltage, slopes])
    new = np.ones(len(ramps), dtype=bool)
    new[1:] = (ramps[1:, 2] != 0) | (ramps[:-1, 2] != 0) | (ramps[1:, 1] != ramps[:-1, 1])
    return np.ascontiguousarray(ramps[new])


def grid(**axes: Sequence[float] | Floats) -> dict[str, Floats]:
    """Every combination of the given values as columns, the last name varying fastest."""
    columns: Any = np.meshgrid(*(np.asarray(axis, dtype=float) for axis in axes.values()), indexing="ij")
    return {name: column.ravel() for name, column in zip(axes, columns)}
