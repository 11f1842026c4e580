"""A sweep that loses its workers, its scheduler or the network ends in time, with what is done kept.

A process that is stopped (SIGSTOP) is to all others one that the network no longer reaches: its connections stay
open and nothing comes from them.
"""

import re
import signal
import threading
import time

import numpy as np
import pyarrow.parquet as parquet
import pytest

import dask_cluster
from dielectric_actuator import grid
from dielectric_actuator import sweep as engine
from sweep_measures import slow

PATIENCE = 15.0
"""Seconds: a busy machine is silent for some."""
SCENES = 60


@pytest.mark.parametrize(
    ("lost", "how", "reason"),
    [
        ("workers", signal.SIGKILL, "none of 0 workers has been heard of"),
        ("scheduler", signal.SIGKILL, "the scheduler does not answer"),
        ("scheduler", signal.SIGSTOP, "the scheduler does not answer"),
        ("workers", signal.SIGSTOP, "workers has been heard of"),
    ],
    ids=["workers-killed", "scheduler-killed", "scheduler-unreachable", "workers-unreachable"],
)
def test_a_loss_ends_the_sweep_in_time_with_what_is_done_kept(fmu_path, tmp_path, capsys, lost, how, reason):
    output = tmp_path / "lost.parquet"
    parts = tmp_path / "lost.parquet.parts"
    columns = grid(phi=np.linspace(0.1, 0.6, SCENES))
    moment = []

    def lose(processes):
        while len(list(parts.glob("*.parquet"))) < 3:
            time.sleep(0.02)
        for process in processes:
            process.send_signal(how)
        moment.append(time.monotonic())

    with dask_cluster.started(tmp_path, 2) as (address, scheduler, workers):
        processes = [scheduler] if lost == "scheduler" else workers
        threading.Thread(target=lose, args=[processes], daemon=True).start()
        with pytest.raises(engine.Unfinished, match=reason):
            engine.sweep(slow, columns, output, cluster=address, batch=2, fmu=fmu_path, patience=PATIENCE)
        assert time.monotonic() - moment[0] < 10 * PATIENCE
    kept = [scene for part in parts.glob("*.parquet") for scene in parquet.read_table(part)["scene"].to_pylist()]
    assert 6 <= len(kept) < SCENES

    capsys.readouterr()
    table = engine.sweep(slow, columns, output, workers=1, fmu=fmu_path)
    assert f"going on from {len(kept)}: " in capsys.readouterr().out
    assert table["twice"].to_pylist() == (2 * columns["phi"]).tolist()


class ScriptedFuture:
    """A future that was done and whose worker died twice before its result was fetched."""

    def __init__(self, *statuses):
        self._statuses = list(statuses)
        self.status = "finished"

    def result(self, timeout):
        self.status = self._statuses.pop(0)
        if self.status == "finished":
            return ["a row"]
        time.sleep(timeout)
        raise TimeoutError


class ScriptedClient:
    """A client whose scheduler tells of the given workers, one answer a look; the last answer stays."""

    def __init__(self, *answers):
        self._answers = list(answers)

    def sync(self, coroutine, *arguments, callback_timeout):
        return self._answers.pop(0) if len(self._answers) > 1 else self._answers[0]


def test_a_result_that_died_with_its_worker_is_waited_for():
    """No worker is there when one looks, and one looks late: the next has its time to start."""
    heartbeats = engine.Heartbeats(ScriptedClient({"first": 1.0}, {}, {}, {"second": 2.0}, {}), patience=0.4)
    time.sleep(0.5)
    assert heartbeats.result(ScriptedFuture("lost", "pending", "lost", "pending", "finished")) == ["a row"]
    with pytest.raises(engine.Unfinished, match="none of 0 workers"):
        heartbeats.result(ScriptedFuture(*["pending"] * 10))


def test_a_result_that_cannot_be_fetched_is_given_up():
    class Unreachable:
        status = "finished"

        def result(self, timeout):
            time.sleep(timeout)
            raise TimeoutError

    alive = ScriptedClient(*({"worker": float(second)} for second in range(100)))
    with pytest.raises(TimeoutError):
        engine.Heartbeats(alive, patience=0.4).result(Unreachable())


class StumblingClient:
    """A client whose scheduler is lost, and which fails to close for that."""

    def __init__(self, address, timeout):
        pass

    def sync(self, coroutine, *arguments, callback_timeout):
        raise TimeoutError

    def close(self, timeout):
        raise RuntimeError("Cannot change state of expiring Timeout")


def test_a_client_that_cannot_be_closed_does_not_hide_the_reason(monkeypatch, fmu_path, tmp_path):
    monkeypatch.setattr(engine, "Client", StumblingClient)
    silent = re.escape("the scheduler does not answer (TimeoutError)")
    with pytest.raises(engine.Unfinished, match=silent):
        engine.sweep(slow, grid(phi=[0.1]), tmp_path / "lost.parquet", cluster="tcp://lost", fmu=fmu_path)


def test_a_cluster_without_workers_or_scheduler_is_reported(fmu_path, tmp_path):
    def run(address, patience):
        columns, output = grid(phi=[0.1]), tmp_path / "none.parquet"
        engine.sweep(slow, columns, output, cluster=address, fmu=fmu_path, patience=patience)

    nobody = pytest.raises(engine.Unfinished, match="none of 0 workers")
    with dask_cluster.started(tmp_path, 0) as (address, _, _), nobody:
        run(address, PATIENCE)
    with pytest.raises(engine.Unfinished, match=re.escape("no scheduler answers at tcp://127.0.0.1:1")):
        run("tcp://127.0.0.1:1", 1.0)
