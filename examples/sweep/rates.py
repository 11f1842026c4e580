"""Scenes a second: `fmpy.simulate_fmu`, one loaded actuator, and Dask with a growing number of workers.

    python examples/sweep/rates.py [--workers N]

Prints the rates and writes rates.csv and rates.png. Each way runs frequency responses of two lengths, and its
amplitudes are compared with those of `simulate_fmu` before its time counts. The start of the workers and the
first load of the FMU are not counted. What counts is processor time, that of the busiest process: the rate that a
machine with nothing else to do would show, whatever this one does besides.
"""

from __future__ import annotations

import csv
import os
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from distributed import Client
from fmpy import simulate_fmu
from matplotlib.figure import Figure

from command import column, parse

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from dielectric_actuator import Actuator, grid
from dielectric_actuator.measures import frequency_response
from dielectric_actuator.sweep import local_cluster, sweep

SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
STOP_TIMES = (2000.0, 50000.0)
PLAIN = 20
"""Scenes for `simulate_fmu`: enough for its rate, and what the other ways are compared on."""


def main() -> None:
    """Time every way, print, draw."""
    arguments = parse(__doc__, scenes=8000, lengths=len(STOP_TIMES))
    most = arguments.workers or os.cpu_count() or 1
    rows = []
    for stop_time in STOP_TIMES[: arguments.lengths]:
        # long scenes need no more of them to be timed
        count = max(PLAIN, int(arguments.scenes * min(1.0, 4000.0 / stop_time)))
        surface_effects = {name: [value] for name, value in SURFACE_EFFECTS.items()}
        scenes = grid(phi_ac=[0.3], omega_ac=np.linspace(0.03, 0.33, count), **surface_effects)
        for way, rate in rates(arguments.fmu, scenes, stop_time, most):
            print(f"t <= {stop_time:<6g} {way:<24} {rate:>10.1f} scenes a second", flush=True)
            rows.append({"stop_time": stop_time, "way": way, "scenes_per_second": rate})
    arguments.output.mkdir(parents=True, exist_ok=True)
    with (arguments.output / "rates.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print(style.save(draw(rows), arguments.output / "rates.png"))


def rates(fmu: Path, scenes: dict[str, np.ndarray], stop_time: float, most: int):
    """Yield each way with its scenes a second; AssertionError if a way's amplitudes are not the same."""
    measure = partial(frequency_response, stop_time=stop_time)
    rows = [dict(zip(scenes, values)) for values in zip(*scenes.values())]
    every = len(rows) // PLAIN
    sample = rows[: every * PLAIN : every]

    start = processor_seconds()
    plain = [plain_amplitude(fmu, row, stop_time) for row in sample]
    yield "simulate_fmu", len(sample) / busiest(start)

    with Actuator(fmu) as actuator:
        measure(actuator, rows[0])
        start = processor_seconds()
        found = [measure(actuator, row)["lambda3_amplitude"] for row in rows]
        taken = busiest(start)
        assert found[: every * PLAIN : every] == plain
        yield "one loaded actuator", len(rows) / taken

    for workers in range(1, most + 1):
        with (
            tempfile.TemporaryDirectory() as folder,
            local_cluster(workers) as cluster,
            Client(cluster) as client,
        ):
            first = {name: values[: 8 * workers] for name, values in scenes.items()}
            # in batches of one, so that every worker loads its actuator
            sweep(measure, first, Path(folder) / "first.parquet", cluster=cluster, batch=1, fmu=fmu)
            start = processor_seconds(client)
            table = sweep(measure, scenes, Path(folder) / "timed.parquet", cluster=cluster, fmu=fmu)
            taken = busiest(start, client)
            assert column(table, "lambda3_amplitude")[: every * PLAIN : every].tolist() == plain
        yield f"Dask, {workers} worker{'s' if workers > 1 else ''}", len(rows) / taken


def processor_seconds(client: Client | None = None) -> dict[str, float]:
    """Processor time that this process and the workers of a cluster have taken so far, by the name of the process."""
    workers = {} if client is None else client.run(time.process_time)
    return {"this process": time.process_time(), **workers}


def busiest(start: dict[str, float], client: Client | None = None) -> float:
    """The most that any of these processes has taken since."""
    return max(now - start[process] for process, now in processor_seconds(client).items())


def plain_amplitude(fmu: Path, scene: dict[str, float], stop_time: float) -> float:
    """The same scene by FMPy's one-call way, which unpacks, loads and unloads the FMU."""
    result = simulate_fmu(
        str(fmu),
        start_values={**scene, "record_extremes": True},
        stop_time=stop_time,
        output_interval=stop_time,
        output=["lambda3_lowest", "lambda3_highest"],
    )
    return (result["lambda3_highest"][-1] - result["lambda3_lowest"][-1]) / 2


def draw(rows: list[dict]) -> Figure:
    """A bar for each way, a panel for each length of the scenes."""
    stop_times = list(dict.fromkeys(row["stop_time"] for row in rows))
    figure, (panels,) = plt.subplots(1, len(stop_times), figsize=(10, 3.4), sharey=True, squeeze=False)
    for panel, stop_time in zip(panels, stop_times):
        chosen = [row for row in rows if row["stop_time"] == stop_time]
        bars = panel.barh(
            [row["way"] for row in chosen], [row["scenes_per_second"] for row in chosen], color=style.COLOURS[0]
        )
        panel.bar_label(bars, fmt="{:.0f}", padding=3)
        panel.set(xlabel="scenes a second of processor time", title=f"{style.SYMBOLS['time']} $\\leq$ {stop_time:g}")
        panel.margins(x=0.15)
        panel.grid(axis="y", visible=False)
    panels[0].invert_yaxis()
    return figure


if __name__ == "__main__":
    main()
