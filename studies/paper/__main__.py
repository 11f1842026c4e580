"""Every figure and table of the paper through the packed FMU, with one report.

    make paper [WORKERS=2] [PAPER="--frequencies 1200"]

Writes a PNG and a CSV for each, and report.html, which needs no other file.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import figure_style as style
from dielectric_actuator import Actuator, packed_fmu
from paper import chaos, dc, driven, escape, maps, report, resonance, resonance_entries, slips, thresholds
from paper.entries import Entry
from paper.scenes import BRANCHES, printed_resonances
from paper.workers import Workers
from progress import Progress

DEFAULT_OUTPUT = Path(__file__).resolve().parents[2] / "target" / "paper"
GALLERY = ["figure_04", "figure_08", "default_tolerance", "map_escape"]


@dataclass(frozen=True)
class Size:
    """How much is computed."""

    frequencies: int = 600
    windows: tuple[float, ...] = resonance.WINDOWS
    window: float = 5000.0
    """Of the indicators of chaos and of the runs at a default tolerance."""
    chaotic_window: float = 2000.0
    section_points: int = 3000
    longest_history: float = math.inf
    threshold_points: int = 200
    period_points: int = 60
    pull_in_cells: int = 300
    threshold_cells: int = 240
    escape_cells: int = 320
    escape_pairs: int = 4000
    growth: tuple[int, ...] = (50, 100, 200, 400)
    dpi: int = 150
    laid_out: bool = True
    """Whether labels and panels make room for each other, which takes half of the drawing."""


SMALL = Size(
    frequencies=150,
    windows=(300.0, 600.0),
    window=300.0,
    chaotic_window=100.0,
    section_points=300,
    longest_history=200.0,
    threshold_points=20,
    period_points=8,
    pull_in_cells=20,
    threshold_cells=16,
    escape_cells=20,
    escape_pairs=100,
    growth=(10, 20),
    dpi=50,
    laid_out=False,
)
"""Seconds instead of minutes, to see that everything works. Its verdicts rest on too little."""


@dataclass(frozen=True)
class Independent:
    """What is computed without the FMU, and held against it."""

    paper: chaos.Indicators
    chaotic: chaos.Indicators
    peaks: dict
    loose: list[chaos.Loose]


def _apply(actuator: Actuator, item):
    task, argument = item
    return task(actuator, argument)


def independent(workers: Workers, responses: resonance_entries.Responses, size: Size) -> Independent:
    """All of it in one go, the longest first, so that every worker is busy to the end."""
    keys = [(case, branch) for branch in BRANCHES for case in responses]
    window = min(size.windows, key=lambda w: abs(w - resonance_entries.CHECK_WINDOW))
    places = [(case, responses[case].peaks[branch, window].omega) for case, branch in keys]
    third = len(places) // 3
    loose = [(run, rtol, size.window) for run, rtol in chaos.loose_runs()]
    jobs: list[tuple[Callable[[Actuator, Any], Any], object]] = [
        (chaos.of_the_paper, size.window),
        (chaos.of_the_chaotic, size.chaotic_window),
    ]
    jobs += [(resonance_entries.check_peaks, (places[k : k + third], window)) for k in range(0, len(places), third)]
    jobs += [(chaos.follow_loosely, item) for item in loose]
    found = workers.map(_apply, jobs)
    peaks = dict(zip(keys, (rows for part in found[2:5] for rows in part)))
    return Independent(found[0], found[1], peaks, found[5:])


def _write(_actuator: Actuator, item: tuple[Entry, Path, int]) -> None:
    entry, folder, dpi = item
    style.apply()
    style.plt.rcParams["savefig.dpi"] = dpi
    entry.write(folder)


def study(workers: Workers, progress: Progress, size: Size) -> list[Entry]:
    """All entries in the order of the report."""
    actuator = workers.actuator
    assert set(printed_resonances()) >= {(case, branch) for case in resonance.cases() for branch in BRANCHES}
    with progress.stage("response to a voltage step (Figs. 2, 3)"):
        entries = dc.step_responses(actuator)
    with progress.stage("pull-in thresholds (Table 1, Figs. 4, 5)"):
        figures_4_5 = [thresholds.figure_4(actuator), thresholds.figure_5(actuator, size.threshold_points)]
        entries += [*figures_4_5, thresholds.table_1(actuator)]
    with progress.stage("motion at pull-in, verification (Figs. 6, 7, A.1)"):
        entries += dc.pull_in(actuator)
        verification = dc.verification(actuator)
    with progress.stage(f"frequency responses, 14 cases, {size.frequencies} frequencies (Fig. 8)"):
        responses = resonance.responses(workers, size.frequencies, size.windows)
    with progress.stage("how the time grows with the number of frequencies"):
        growth = resonance.growth(workers, size.growth)
    with progress.stage("the same motions without the FMU (SciPy), chaos indicators"):
        alone = independent(workers, responses, size)
        checked = chaos.checks(actuator, alone.paper)
    with progress.stage("driven motions (Figs. 9 to 12, B.1 to B.4)"):
        driven_figures = driven.figures(workers, size.section_points, checked, size.longest_history)
    entries.append(resonance_entries.figure_8(actuator, responses, growth, workers.count))
    entries += resonance_entries.tables(responses, alone.peaks)
    entries.append(resonance_entries.window_comparison(responses))
    entries += driven_figures[:4]
    with progress.stage("the same runs at the tolerance of a default solver"):
        entries.append(chaos.tolerance_entry(actuator, alone.loose, size.window))
        entries.append(chaos.indicator_entry(alone.paper, alone.chaotic, checked))
    entries += [verification, *driven_figures[4:]]
    with progress.stage("beyond the paper: pull-in over voltage and prestress"):
        entries.append(maps.pull_in_map(workers, size.pull_in_cells))
    with progress.stage("beyond the paper: thresholds over the surface parameters"):
        entries.append(maps.threshold_map(workers, size.threshold_cells))
    with progress.stage("beyond the paper: period at pull-in"):
        entries.append(maps.period_curve(workers, size.period_points))
    with progress.stage("beyond the paper: escape under the harmonic drive"):
        entries.append(escape.escape_map(workers, size.escape_cells, size.escape_pairs))
    return entries


def main() -> int:
    """Run it all; 0 on success, 2 if there is no packed FMU."""
    parser = argparse.ArgumentParser(prog="paper", description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the results (%(default)s)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="worker processes (%(default)s)")
    parser.add_argument("--frequencies", type=int, help=f"frequencies of each response ({Size.frequencies})")
    parser.add_argument("--gallery", type=Path, help="folder for small copies of some figures, for the README")
    parser.add_argument("--small", action="store_true", help="little of everything, in seconds")
    arguments = parser.parse_args()
    if not arguments.fmu.is_file():
        print(f"no FMU at {arguments.fmu}; build and pack it first: make fmu", file=sys.stderr)
        return 2
    if arguments.workers < 1:
        parser.error("--workers must be at least 1")
    if arguments.frequencies is not None and arguments.frequencies < 100:
        parser.error("--frequencies must be at least 100, or peaks fall between them")
    size = SMALL if arguments.small else Size()
    if arguments.frequencies is not None:
        size = Size(**{**vars(size), "frequencies": arguments.frequencies})

    style.apply()
    # all figures are drawn at the end, by all workers
    style.plt.rcParams.update({"figure.max_open_warning": 0, "figure.constrained_layout.use": size.laid_out})
    arguments.output.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    progress = Progress(stages=14)
    with Workers(arguments.fmu, arguments.workers, progress) as workers:
        entries = study(workers, progress, size)
        description = workers.actuator.description
        with progress.stage("drawing"):
            workers.map(_write, [(entry, arguments.output, size.dpi) for entry in entries])
    with progress.stage("writing the report"):
        facts = report.Facts(
            [
                (
                    "Command",
                    "make paper" + ("" if not arguments.small else " (small version: verdicts rest on too little)"),
                ),
                (
                    "FMU",
                    f"{description.modelName} {description.version or ''}, guid {description.guid}, run through FMPy",
                ),
                ("Workers", f"{arguments.workers} process(es), {os.cpu_count()} processors, {platform.machine()}"),
                ("Time", f"{time.perf_counter() - start:.0f} s, of processor time {_processor_time():.0f} s"),
                ("Versions", f"Python {platform.python_version()}, numpy {np.__version__}"),
            ]
        )
        page = arguments.output / "report.html"
        report.write(page, entries, slips.slips(), facts)
        if arguments.gallery:
            report.gallery(arguments.output, GALLERY, arguments.gallery)
    print(
        f"\n{len(entries)} figures and tables in {time.perf_counter() - start:.0f} s ({_processor_time():.0f} s of "
        "processor time)"
    )
    print(page)
    return 0


def _processor_time() -> float:
    """Of this process and of the workers that have ended, in seconds."""
    return sum(resource.getrusage(who).ru_utime for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


if __name__ == "__main__":
    sys.exit(main())
