"""The sweep, on a Dask cluster whose processes know the package and nothing else, and on its own workers."""

import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

import dask
import numpy as np
import pyarrow.parquet as parquet
import pytest

import command
import dask_cluster
import references
import sweep_measures
from dielectric_actuator import UnknownName, grid, measures
from dielectric_actuator import sweep as engine
from sweep_measures import fatal, whose

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "sweep"

WORKERS = 2


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """The address of a scheduler with two workers."""
    with dask_cluster.started(tmp_path_factory.mktemp("cluster"), WORKERS) as (address, _, _):
        yield address


def test_amplitudes_are_those_of_the_reference(cluster, fmu_path, tmp_path):
    for k, reference in enumerate(references.driven_amplitudes()):
        table = engine.sweep(
            partial(measures.frequency_response, stop_time=reference.stop_time),
            {name: [value] for name, value in reference.scene().items()},
            tmp_path / f"{k}.parquet",
            cluster=cluster,
            fmu=fmu_path,
        )
        assert table["lambda3_amplitude"].to_pylist() == pytest.approx([reference.amplitude], abs=1e-8)
    assert k


def test_each_worker_keeps_one_actuator(cluster, fmu_path, tmp_path):
    table = engine.sweep(
        whose,
        grid(phi=np.linspace(0, 0.6, 200)),
        tmp_path / "whose.parquet",
        cluster=cluster,
        batch=5,
        fmu=fmu_path,
    )
    pairs = set(zip(table["process"].to_pylist(), table["actuator"].to_pylist()))
    assert len(table) == 200 and len(pairs) == len({process for process, _ in pairs}) == WORKERS


def test_a_failing_scene_is_reported_and_the_rest_kept(cluster, fmu_path, tmp_path, capsys):
    voltages = [0.1, 5000.0, 0.2, 0.9, float("nan")]
    table = engine.sweep(
        partial(measures.pull_in, stop_time=200.0),
        grid(phi=voltages),
        tmp_path / "some.parquet",
        cluster=cluster,
        batch=3,
        fmu=fmu_path,
    )
    assert table["pulled_in"].to_pylist() == [False, None, False, True, None]
    failures = table["failure"].to_pylist()
    assert [failure is None for failure in failures] == [True, False, True, True, False]
    assert "phi" in failures[1] and "5000" in failures[1]
    printed = capsys.readouterr().out
    assert "scene 1 failed" in printed and "5 of 5 scenes done, 2 failed now" in printed


def test_a_stopped_sweep_goes_on_from_what_is_done(cluster, fmu_path, tmp_path, capsys, monkeypatch):
    output = tmp_path / "stopped.parquet"
    columns = grid(phi=np.linspace(0.1, 0.6, 60), S=[0.1])
    measure = partial(measures.pull_in, stop_time=50.0)
    write, written = engine._Results.add, []

    def stop_after_three(results, numbers, rows, found):
        if len(written) == 3:
            raise KeyboardInterrupt
        write(results, numbers, rows, found)
        written.extend([numbers])

    with monkeypatch.context() as patched:
        patched.setattr(engine._Results, "add", stop_after_three)
        with pytest.raises(KeyboardInterrupt):
            engine.sweep(measure, columns, output, cluster=cluster, batch=7, fmu=fmu_path)
    done = sum(map(len, written))
    assert not output.exists() and len(written) == 3

    capsys.readouterr()
    table = engine.sweep(measure, columns, output, cluster=cluster, batch=11, fmu=fmu_path)
    assert f"going on from {done}: {60 - done} scenes" in capsys.readouterr().out
    at_once = engine.sweep(measure, columns, tmp_path / "at_once.parquet", cluster=cluster, fmu=fmu_path)
    assert table.equals(at_once) and table.equals(parquet.read_table(output))
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["at_once.parquet", "stopped.parquet"]
    np.testing.assert_array_equal(command.column(table, "phi"), columns["phi"])

    capsys.readouterr()
    assert engine.sweep(measure, columns, output, cluster="tcp://nowhere:1", fmu=fmu_path).equals(table)
    assert "nothing left to run" in capsys.readouterr().out


def test_another_sweep_is_not_mixed_in(cluster, fmu_path, tmp_path):
    output = tmp_path / "first.parquet"
    short, long = (partial(measures.pull_in, stop_time=time) for time in (10.0, 20.0))
    engine.sweep(short, grid(phi=[0.1, 0.2]), output, cluster=cluster, fmu=fmu_path)
    for measure, axes in ((long, {"phi": [0.1, 0.2]}), (short, {"phi": [0.1, 0.3]})):
        with pytest.raises(engine.AnotherSweep, match="remove it or write elsewhere"):
            engine.sweep(measure, grid(**axes), output, cluster=cluster, fmu=fmu_path)


def test_results_of_every_kind_and_numbers_beside_columns(cluster, fmu_path, tmp_path):
    output = str(tmp_path / "doubled.parquet")
    scenes = {"phi": [0.125, 0.5], "S": 0.25}
    table = engine.sweep(sweep_measures.doubled, scenes, output, cluster=cluster, fmu=fmu_path)
    assert table.drop_columns(["scene", "failure"]).to_pylist() == [
        {"phi": 0.125, "S": 0.25, "twice": 0.25, "large": False, "kind": None, "more": None},
        {"phi": 0.5, "S": 0.25, "twice": 1.0, "large": True, "kind": "large", "more": 3.0},
    ]


@pytest.mark.parametrize("changed", ["FACTOR", "twice"])
def test_a_measure_that_uses_something_else_is_another(cluster, fmu_path, tmp_path, monkeypatch, changed):
    def sweep():
        return engine.sweep(
            sweep_measures.doubled, {"phi": [0.5]}, tmp_path / "a.parquet", cluster=cluster, fmu=fmu_path
        )

    sweep()
    replaced = {"FACTOR": 3.0, "twice": lambda number: 3.0 * number}[changed]
    if callable(replaced):
        replaced.__module__ = sweep_measures.__name__
    with monkeypatch.context() as patched:
        patched.setattr(sweep_measures, changed, replaced)
        with pytest.raises(engine.AnotherSweep):
            sweep()
    # what the measure does not use may change
    monkeypatch.setattr(sweep_measures, "whose", None)
    assert sweep()["twice"].to_pylist() == [1.0]


@pytest.mark.parametrize("scenes", [{}, {"phi": []}, {"phi": [0.1, 0.2], "S": [0.1, 0.2, 0.3]}, {"phi": [[0.1]]}])
def test_columns_that_do_not_fit_together_are_refused(fmu_path, tmp_path, scenes):
    with pytest.raises(ValueError, match="the columns have the shapes"):
        engine.sweep(measures.pull_in, scenes, tmp_path / "none.parquet", cluster="tcp://nowhere:1", fmu=fmu_path)


def test_an_unknown_name_is_said_before_anything_is_started(fmu_path, tmp_path):
    measure = partial(measures.pull_in, stop_time=10.0)
    with pytest.raises(UnknownName, match="no variable 'fi'; did you mean phi"):
        engine.sweep(measure, grid(fi=[0.1]), tmp_path / "none.parquet", cluster="tcp://nowhere:1", fmu=fmu_path)


def test_a_device_in_si_units_is_swept_too(cluster, tmp_path):
    table = engine.sweep(whose, grid(voltage=[300.0, 600.0]), tmp_path / "si.parquet", cluster=cluster, fmu="si")
    assert table["failure"].to_pylist() == [None, None] and table["voltage"].to_pylist() == [300.0, 600.0]


def test_a_lost_batch_is_named_and_the_rest_kept(fmu_path, tmp_path):
    """A batch that was on a dying worker too often counts as lost with it; all others must be there. The only worker
    dies, and on a busy machine the next one takes more than a minute to start."""
    output, columns = tmp_path / "lost.parquet", grid(phi=np.arange(0.1, 0.85, 0.1).round(1))
    once = dask.config.set({"distributed.scheduler.allowed-failures": 1})
    with once, pytest.raises(engine.Unfinished) as unfinished:
        engine.sweep(fatal, columns, output, workers=1, batch=2, fmu=fmu_path, patience=600.0)
    lost = {int(first) for first in re.findall(r"scenes (\d+) to", str(unfinished.value))}
    kept = [parquet.read_table(path)["scene"].to_pylist() for path in (tmp_path / "lost.parquet.parts").iterdir()]
    assert 4 in lost and sorted(kept) == [[k, k + 1] for k in (0, 2, 4, 6) if k not in lost] != []


def test_the_pull_in_map_agrees_with_the_thresholds(cluster, fmu_path, tmp_path):
    options = ["--voltages", "40", "--prestresses", "12"]
    printed = run_script("pull_in_map.py", fmu_path, tmp_path, "--scheduler", cluster, *options)
    assert "all but 0 of 480" in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pull_in_map.parquet", "pull_in_map.png"]
    pulled_in = parquet.read_table(tmp_path / "pull_in_map.parquet")["pulled_in"].to_pylist()
    assert 100 < sum(pulled_in) < 380


def test_the_frequency_response_is_drawn(cluster, fmu_path, tmp_path):
    options = ["--amplitudes", "4", "--frequencies", "25"]
    run_script("frequency_response.py", fmu_path, tmp_path, "--scheduler", cluster, *options)
    assert (tmp_path / "frequency_response.png").stat().st_size > 10_000
    table = parquet.read_table(tmp_path / "frequency_response.parquet")
    assert len(table) == 100 and min(table["lambda3_amplitude"].to_pylist()) > 0


def test_the_sweep_of_the_page_runs(tmp_path):
    page = (EXAMPLE / "README.md").read_text()
    (code,) = re.findall(r"^```python\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    (tmp_path / "own.py").write_text(code)
    done = subprocess.run(
        [sys.executable, "own.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(EXAMPLE)},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    table = parquet.read_table(tmp_path / "turning_stretch.parquet")
    assert len(table) == 60 and table["failure"].null_count == 60


def test_the_rates_are_measured(fmu_path, tmp_path):
    printed = run_script("rates.py", fmu_path, tmp_path, "--scenes", "20", "--lengths", "1", "--workers", "1")
    assert printed.count("scenes a second\n") == 3
    assert (tmp_path / "rates.csv").read_text().count("\n") == 4 and (tmp_path / "rates.png").exists()


def run_script(name, fmu, output, *options) -> str:
    done = subprocess.run(
        [sys.executable, EXAMPLE / name, "--fmu", fmu, "--output", output, *options],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
