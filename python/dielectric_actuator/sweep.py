"""Tens of thousands of scenes on the processes of one machine, or unchanged on a Dask cluster.

    from dielectric_actuator import grid
    from dielectric_actuator.measures import pull_in
    from dielectric_actuator.sweep import sweep

    table = sweep(partial(pull_in, stop_time=500.0), grid(phi=voltages, S=prestresses), Path("map.parquet"))

The scenes travel in batches. A batch that comes back is written at once, next to the result, as a small
Parquet file; a sweep that was stopped goes on from these. The result holds one row a scene: its number,
its parameters, its results, and the reason if it failed. The FMU and the module that defines the measure are sent
to each worker; a machine of the cluster needs this package with its extra ``sweep``, in the same version. What
an `ensemble` can follow, constant inputs and the built-in drive, takes a fraction of the time there.

Nothing waits for ever: where the scheduler or every worker is lost, or the network to them, the sweep ends
after `patience` seconds without a sign of life, with what is done kept.
"""

from __future__ import annotations

import hashlib
import inspect
import queue
import time
import uuid
from asyncio import CancelledError
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as parquet
from dask.base import tokenize
from distributed import Client, Future, LocalCluster
from distributed.deploy import Cluster
from distributed.diagnostics.plugin import SchedulerUploadFile, UploadFile
from numpy.typing import ArrayLike, NDArray

from . import measures
from .fmu import UnknownName, described, located
from .measures import Measure

Row = dict[str, Any]
Floats = NDArray[np.float64]

FINGERPRINT = b"sweep"
BATCH = 100
"""Scenes that travel together: many enough to hide the millisecond that the scheduler takes for a task."""


PATIENCE = 60.0
"""Seconds without a sign of life after which a cluster counts as lost."""


class AnotherSweep(ValueError):
    """The output holds results of other scenes, another measure or another FMU."""


class Unfinished(RuntimeError):
    """Some batches were lost, or the whole cluster; what is done is kept, and the same call goes on from there."""


def sweep(
    measure: Measure,
    scenes: Mapping[str, ArrayLike],
    output: str | Path,
    *,
    cluster: str | Cluster | None = None,
    workers: int | None = None,
    batch: int = BATCH,
    fmu: str | Path = "nondimensional",
    patience: float = PATIENCE,
) -> pa.Table:
    """Run `measure` on each scene and return (and leave in the Parquet file `output`) a table of all.

    `scenes` holds a column of start values for each varied variable of the actuator `fmu`, which is given as to
    `Actuator`; numbers and columns are broadcast. A result of `measure` is a number, a Boolean, a text or None.
    `cluster` is the address of a Dask scheduler, or one of Dask's cluster objects; without it `workers` processes are
    started here (default: one a processor core).

    `output` is taken over where it holds the same sweep, by its FMU, its scenes and the code of `measure`: its source
    and settings, the constants and the functions of its module that it uses.

    Raises `UnknownName` for a column that is no variable, ValueError for columns that do not fit together,
    `AnotherSweep` if `output` holds the results of one, `Unfinished` if batches were lost or the cluster gave no sign
    of life for `patience` seconds.
    """
    packed = located(fmu)
    known = [variable.name for variable in described(packed).modelVariables]
    for name in scenes:
        if name not in known:
            raise UnknownName("variable", name, known)
    columns = _columns(scenes)
    results = _Results(Path(output), _fingerprint(measure, columns, packed))
    count = len(next(iter(columns.values())))
    pending = np.setdiff1d(np.arange(count), results.finished())
    progress = Progress(count, count - len(pending))
    lost: list[str] = []
    if len(pending):
        with _client(cluster, workers, patience) as client:
            heartbeats = Heartbeats(client, patience)
            heartbeats.bounded(_equip, client, measure, packed)
            progress.begin(heartbeats.workers())
            batches = {}
            for start in range(0, len(pending), batch):
                numbers = pending[start : start + batch]
                rows = [{name: float(column[k]) for name, column in columns.items()} for k in numbers]
                batches[client.submit(measures.run_batch, measure, rows, pure=False)] = (numbers, rows)
            for future in heartbeats.as_completed(list(batches)):
                numbers, rows = batches.pop(future)
                try:
                    found = heartbeats.result(future)
                except (Exception, CancelledError) as reason:  # whatever lost one batch, the others go on
                    heartbeats.check()
                    lost.append(f"scenes {numbers[0]} to {numbers[-1]}: {str(reason) or type(reason).__name__}")
                    continue
                results.add(numbers, rows, found)
                progress.advance([(k, row["failure"]) for k, row in zip(numbers, found) if row["failure"]], len(found))
    progress.close()
    if lost:
        raise Unfinished("\n".join([f"{len(lost)} batches were lost; run again to go on from the others", *lost[:5]]))
    return results.complete()


def _columns(scenes: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """The start values of the scenes, in columns of one length."""
    given = {name: np.atleast_1d(np.asarray(column, dtype=float)) for name, column in scenes.items()}
    lengths = {len(column) for column in given.values()} - {1} or {1}
    if not given or any(column.ndim != 1 for column in given.values()) or len(lengths) > 1 or 0 in lengths:
        shapes = ", ".join(f"{name} {column.shape}" for name, column in given.items()) or "none"
        raise ValueError(f"the columns have the shapes {shapes}; they must have one length above 0, or be numbers")
    return dict(zip(given, np.broadcast_arrays(*given.values())))


class Heartbeats:
    """Signs of life of a cluster: the heartbeats of its workers, as its scheduler tells of them."""

    def __init__(self, client: Client, patience: float):
        self._client, self._patience = client, patience
        self._heard: dict[str, float] = {}
        self._silent_since: float | None = None

    def bounded(self, coroutine: Callable[..., Any], *arguments: object) -> Any:
        """What `coroutine` returns; Unfinished if the cluster does not answer in time."""
        try:
            return self._client.sync(coroutine, *arguments, callback_timeout=self._patience)
        except (OSError, TimeoutError) as reason:
            raise Unfinished(
                f"the scheduler does not answer ({str(reason) or type(reason).__name__}); what is done is kept, "
                "run again to go on from there"
            ) from None

    def workers(self) -> int:
        """How many workers the scheduler knows; notes whether one has been heard of since the last look."""
        heard = self.bounded(_last_seen, self._client)
        if any(self._heard.get(worker) != moment for worker, moment in heard.items()):
            self._silent_since = None
        elif self._silent_since is None:
            # Not since the last look: a busy machine may have kept us from looking.
            self._silent_since = time.monotonic()
        self._heard = heard
        return len(heard)

    def check(self) -> None:
        """Unfinished if no worker has been heard of for too long."""
        workers = self.workers()
        if self._silent_since is None:
            return
        if (silence := time.monotonic() - self._silent_since) > self._patience:
            raise Unfinished(
                f"none of {workers} workers has been heard of for {silence:.0f} s; what is done is kept, run again to "
                "go on from there"
            )

    def as_completed(self, futures: Sequence[Future]) -> Iterator[Future]:
        """Each future when it is done, well or not; Unfinished when nothing is heard of the cluster any more."""
        done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        for future in futures:
            future.add_done_callback(done.put)
        returned = 0
        while returned < len(futures):
            try:
                future = done.get(timeout=min(5.0, self._patience / 4))
            except queue.Empty:
                self.check()
            else:
                returned += 1
                yield future

    def result(self, future: Future) -> Any:
        """What a task that was done has returned, or what it raised.

        If its worker died with the result, another one runs it again: that may take as long as there are signs of life.
        TimeoutError if a result that is there cannot be fetched in time.
        """
        given_up = time.monotonic() + self._patience
        while True:
            try:
                return future.result(timeout=self._patience / 4)
            except TimeoutError:
                if future.status == "error" or (future.status == "finished" and time.monotonic() > given_up):
                    raise
                if future.status != "finished":
                    given_up = time.monotonic() + self._patience
                self.check()


async def _last_seen(client: Client) -> dict[str, float]:
    """When the scheduler last heard of each worker, by the scheduler's clock."""
    if client.scheduler is None:
        raise OSError("the connection is closed")
    identity = await client.scheduler.identity(n_workers=-1)
    return {address: worker["last_seen"] for address, worker in identity["workers"].items()}


class Progress:
    """What is done, how fast, how long it will take, and each failed scene up to ten."""

    REPORTED = 10

    def __init__(self, count: int, done: int):
        self._count, self._done, self._before, self._failed = count, done, done, 0
        self._start = self._shown = time.perf_counter()

    def begin(self, workers: int) -> None:
        """The opening line; scenes are timed from here on, the start of the workers is not."""
        before = f"going on from {self._before}: " if self._before else ""
        print(f"{before}{self._count - self._before} scenes on {workers} workers", flush=True)
        self._start = self._shown = time.perf_counter()

    def advance(self, failures: list[tuple[int, str]], count: int) -> None:
        """Count scenes; a line a second at most."""
        for number, reason in failures:
            self._failed += 1
            if self._failed <= self.REPORTED:
                print(f"scene {number} failed: {reason}", flush=True)
        self._done += count
        if time.perf_counter() - self._shown >= 1:
            self._shown = time.perf_counter()
            rate = self._rate()
            left = (self._count - self._done) / rate
            print(f"{self._done:>8} of {self._count} scenes, {rate:.0f} a second, {left:.0f} s left", flush=True)

    def close(self) -> None:
        """The closing line."""
        ran, taken = self._done - self._before, time.perf_counter() - self._start
        speed = f"{ran} run in {taken:.1f} s, {self._rate():.0f} a second" if ran else "nothing left to run"
        print(f"{self._done} of {self._count} scenes done, {self._failed} failed now; {speed}", flush=True)

    def _rate(self) -> float:
        return (self._done - self._before) / (time.perf_counter() - self._start)


class _Results:
    """The result file, and the parts that grow beside it until it is complete."""

    def __init__(self, output: Path, fingerprint: bytes):
        self._output, self._fingerprint = output, fingerprint
        self._folder = output.with_name(output.name + ".parts")

    def finished(self) -> np.ndarray:
        """Numbers of the scenes whose results are there."""
        files = self._parts() or ([self._output] if self._output.exists() else [])
        for path in files:
            if (parquet.read_schema(path).metadata or {}).get(FINGERPRINT) != self._fingerprint:
                raise AnotherSweep(
                    f"{path} holds another sweep: its scenes, measure or FMU differ; remove it or write elsewhere"
                )
        return np.concatenate(
            [np.empty(0, int), *(parquet.read_table(path, columns=["scene"])["scene"].to_numpy() for path in files)]
        )

    def add(self, numbers: np.ndarray, rows: list[Row], found: list[Row]) -> None:
        """Write one batch; whole or not at all, should the sweep be stopped meanwhile."""
        self._folder.mkdir(parents=True, exist_ok=True)
        table = pa.Table.from_pylist(
            [{"scene": int(k), **row, **result} for k, row, result in zip(numbers, rows, found)],
            schema=_schema(rows, found).with_metadata({FINGERPRINT: self._fingerprint}),
        )
        self._write(table, self._folder / f"{numbers[0]:09d}.parquet")

    def complete(self) -> pa.Table:
        """Join the parts to the result file, in the order of the scenes."""
        parts = self._parts()
        if parts:
            # a batch in which every scene failed has no columns of results
            table = pa.concat_tables([parquet.read_table(path) for path in parts], promote_options="default")
            # a result that no scene has is a number that is missing
            numbers = [f.with_type(pa.float64()) if pa.types.is_null(f.type) else f for f in table.schema]
            table = table.cast(pa.schema(numbers, table.schema.metadata))
            self._write(table.sort_by("scene"), self._output)
            for path in parts:
                path.unlink()
            self._folder.rmdir()
        return parquet.read_table(self._output)

    def _parts(self) -> list[Path]:
        return sorted(self._folder.glob("*.parquet"))

    @staticmethod
    def _write(table: pa.Table, path: Path) -> None:
        unfinished = path.with_suffix(".unfinished")
        parquet.write_table(table, unfinished)
        unfinished.replace(path)


def _schema(rows: list[Row], found: list[Row]) -> pa.Schema:
    """Columns of a batch: number, parameters, results (Boolean or double), reason of a failure."""
    types = {"scene": pa.int64(), **dict.fromkeys(rows[0], pa.float64())}
    for name in dict.fromkeys(name for row in found for name in row if name != "failure"):
        types[name] = _type(name, [row[name] for row in found if row.get(name) is not None])
    return pa.schema([*types.items(), ("failure", pa.string())])


def _type(name: str, values: list[Any]) -> pa.DataType:
    """Type of a column of results; null, which any other may replace, where a batch has none."""
    for python, arrow in ((bool, pa.bool_()), ((int, float), pa.float64()), (str, pa.string())):
        if all(isinstance(value, python) for value in values):
            return arrow if values else pa.null()
    raise ValueError(f"the measure's results {name!r} must be all numbers, all Booleans, or all texts")


def _fingerprint(measure: Measure, scenes: Mapping[str, Floats], fmu: Path) -> bytes:
    """Tells sweeps apart: the FMU, the code and settings of the measure, the scenes."""
    function, settings = _unwrapped(measure)
    digest = hashlib.sha256(fmu.read_bytes())
    for part in (*_code(function, set()), tokenize(settings)):
        digest.update(part.encode())
    for name, column in scenes.items():
        digest.update(name.encode() + column.tobytes())
    return digest.hexdigest().encode()


def _code(function: Any, seen: set[Any]) -> Iterator[str]:
    """The source of a function and what it refers to: constants by value, functions of its module by their source."""
    if function in seen:
        return
    seen.add(function)
    yield inspect.getsource(function)
    variables = inspect.getclosurevars(function)
    for name, value in sorted({**variables.globals, **variables.nonlocals}.items()):
        yield name
        if inspect.isfunction(value) and value.__module__ == function.__module__:
            yield from _code(value, seen)
        elif not (callable(value) or inspect.ismodule(value)):
            yield tokenize(value)


def _unwrapped(measure: Measure) -> tuple[Any, tuple[Any, ...]]:
    """The function of a measure, and the settings that `functools.partial` gave it."""
    return (measure.func, (measure.args, measure.keywords)) if isinstance(measure, partial) else (measure, ())


@contextmanager
def _client(cluster: str | Cluster | None, workers: int | None, patience: float) -> Iterator[Client]:
    if cluster is None:
        with local_cluster(workers) as own, _client(own, None, patience) as client:
            yield client
        return
    try:
        client = Client(cluster, timeout=patience)
    except (OSError, TimeoutError) as reason:
        raise Unfinished(f"no scheduler answers at {cluster}: {reason}") from None
    try:
        yield client
    finally:
        # A lost scheduler says no farewell, and Dask's client may stumble over that (RuntimeError of asyncio).
        with suppress(TimeoutError, OSError, RuntimeError):
            client.close(timeout=min(5.0, patience))


def local_cluster(workers: int | None) -> LocalCluster:
    """Worker processes on this machine, of one thread each: Python outside the FMU is most of a short scene."""
    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0")


def _must_be_sent(module: ModuleType) -> bool:
    """Whether a worker does not have it: not one of this package, nor the script, of which Dask sends functions as
    code."""
    return module.__name__ != "__main__" and module.__name__.partition(".")[0] != __package__


async def _equip(client: Client, measure: Measure, fmu: Path) -> None:
    """Give each worker, of now and later, the module of the measure and the FMU."""
    module = inspect.getmodule(_unwrapped(measure)[0])
    if module is not None and _must_be_sent(module):
        # a name of its own each time, as Client.upload_file does: what was sent last counts
        name = f"{module.__name__}-{uuid.uuid4()}"
        # a scheduler in this process has the module already, and must not load it a second time
        in_this_process = client.cluster is not None
        await client.register_plugin(SchedulerUploadFile(module.__file__, load=not in_this_process), name=name)
        await client.register_plugin(UploadFile(module.__file__), name=name)
    await client.register_plugin(measures.CarryFmu(fmu.name, fmu.read_bytes()))
