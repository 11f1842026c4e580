"""The command line that the sweeps of this folder share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))


import figure_style as style
from dielectric_actuator import grid, packed_fmu
from dielectric_actuator.measures import Measure
from dielectric_actuator.sweep import PATIENCE, AnotherSweep, Unfinished, sweep

Axis = Sequence[float] | np.ndarray

DEFAULT_OUTPUT = Path(__file__).resolve().parents[2] / "target" / "examples" / "sweep"


def parse(description: str, **counts: int) -> argparse.Namespace:
    """Options of a sweep; each of `counts` becomes one, how many values an axis of the grid has."""
    parser = argparse.ArgumentParser(description=description.partition("\n")[0])
    parser.add_argument("--scheduler", help="address of a Dask scheduler (default: processes on this machine)")
    parser.add_argument("--workers", type=int, help="processes on this machine (default: one a core)")
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the results (%(default)s)")
    parser.add_argument(
        "--patience", type=float, default=PATIENCE, help="seconds to wait for a silent cluster (%(default)s)"
    )
    for name, count in counts.items():
        parser.add_argument(f"--{name}", type=int, default=count, help="values of this axis (%(default)s)")
    style.apply()
    return parser.parse_args()


def run(arguments: argparse.Namespace, measure: Measure, axes: Mapping[str, Axis], name: str) -> pa.Table:
    """Run the sweep of the grid over `axes` into the Parquet file `name` of the output folder."""
    try:
        return sweep(
            measure,
            grid(**axes),
            arguments.output / f"{name}.parquet",
            cluster=arguments.scheduler,
            workers=arguments.workers,
            fmu=arguments.fmu,
            patience=arguments.patience,
        )
    except (AnotherSweep, Unfinished) as reason:
        sys.exit(f"error: {reason}")


def column(table: pa.Table, name: str) -> np.ndarray:
    """A column as numbers; nan where a scene has none."""
    return np.array([np.nan if value is None else value for value in table[name].to_pylist()], dtype=float)
