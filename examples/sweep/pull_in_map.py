"""Pull-in over voltage and prestress: what the motion does, against the thresholds that the FMU computes.

    python examples/sweep/pull_in_map.py [--workers N | --scheduler tcp://HOST:8786]

Writes pull_in_map.parquet and pull_in_map.png. Every scene starts from rest at λ = 1 under a voltage step.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from command import Axis, column, parse, run
from dielectric_actuator.measures import pull_in

SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.0}
STOP_TIME = 500.0


def main() -> None:
    """Run the sweep, then draw it."""
    arguments = parse(__doc__, voltages=240, prestresses=160)
    axes: dict[str, Axis] = {
        "phi": np.linspace(0.3, 0.9, arguments.voltages),
        "S": np.linspace(0.0, 0.5, arguments.prestresses),
        **{name: [value] for name, value in SURFACE_EFFECTS.items()},
    }
    table = run(arguments, partial(pull_in, stop_time=STOP_TIME), axes, "pull_in_map")
    against_thresholds(table)
    print(style.save(draw(table), arguments.output / "pull_in_map.png"))


def against_thresholds(table: pa.Table) -> int:
    """Print how many scenes the dynamic threshold predicts rightly, and return the others' number."""
    predicted = column(table, "phi") > column(table, "phi_pull_in")
    wrong = int((predicted != column(table, "pulled_in")).sum())
    print(f"pulled in within {STOP_TIME:g} where phi > phi_pull_in, and only there: all but {wrong} of {len(table)}")
    return wrong


def draw(table: pa.Table) -> Figure:
    """Time until pull-in, or the smallest thickness where there is none, with both thresholds."""
    phi, prestress = column(table, "phi"), column(table, "S")
    shape = len(np.unique(phi)), len(np.unique(prestress))

    def on_grid(name: str) -> np.ndarray:
        return column(table, name).reshape(shape).T

    figure, axes = plt.subplots(figsize=(9.5, 5.2))
    extent = (phi.min(), phi.max(), prestress.min(), prestress.max())
    pulled_in = on_grid("pulled_in").astype(bool)
    look: dict[str, Any] = {"origin": "lower", "extent": extent, "aspect": "auto", "interpolation": "nearest"}
    times = np.ma.masked_where(~pulled_in, on_grid("pull_in_time"))
    safe = np.ma.masked_where(pulled_in, on_grid("lambda3_lowest"))
    time_image = axes.imshow(times, cmap="viridis", norm="log", **look)
    safe_image = axes.imshow(safe, cmap="Greys_r", **look)
    levels = np.unique(prestress)
    for name, kind, line in (("phi_pull_in", "dynamic", "-"), ("phi_pull_in_static", "static", "--")):
        look = {"linestyle": line, "color": style.COLOURS[1], "linewidth": 2}
        axes.plot(on_grid(name)[:, 0], levels, label=f"{kind} threshold", **look)
    style.label(axes, "phi", "S")
    axes.set(xlim=extent[:2], ylim=extent[2:])
    axes.grid(False)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    bar = figure.colorbar(time_image, ax=axes, label=f"time until pull-in  {style.SYMBOLS['time']}", pad=0.01)
    bar.ax.yaxis.set_ticks([instant for instant in (20, 30, 50, 100, 200) if times.min() <= instant <= times.max()])
    bar.ax.yaxis.set_ticks((), minor=True)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    figure.colorbar(safe_image, ax=axes, label=rf"smallest {style.SYMBOLS['lambda3']} where it oscillates", pad=0.02)
    axes.set_title(f"Voltage step from rest, {style.setting(**SURFACE_EFFECTS)}: {len(table)} scenes", loc="left")
    return figure


if __name__ == "__main__":
    main()
