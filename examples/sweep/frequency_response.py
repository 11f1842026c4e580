"""Frequency response over the amplitude of an alternating voltage: where the actuator resonates, and how far it goes.

    python examples/sweep/frequency_response.py [--workers N | --scheduler tcp://HOST:8786]

Writes frequency_response.parquet and frequency_response.png. The voltage is phi_ac·sin(omega_ac·t) from rest.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyarrow as pa
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from command import Axis, column, parse, run
from dielectric_actuator.measures import frequency_response

SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
STOP_TIME = 2000.0
AMPLITUDE = rf"amplitude of {style.SYMBOLS['lambda3']}"
CURVES = (0.4, 0.3, 0.2, 0.1)
"""Amplitudes of the voltage that are drawn as curves too."""


def main() -> None:
    """Run the sweep, then draw it."""
    arguments = parse(__doc__, amplitudes=39, frequencies=900)
    axes: dict[str, Axis] = {
        "phi_ac": np.linspace(0.02, 0.4, arguments.amplitudes),
        "omega_ac": np.linspace(0.03, 0.33, arguments.frequencies),
        **{name: [value] for name, value in SURFACE_EFFECTS.items()},
    }
    table = run(arguments, partial(frequency_response, stop_time=STOP_TIME), axes, "frequency_response")
    print(style.save(draw(table), arguments.output / "frequency_response.png"))


def draw(table: pa.Table) -> Figure:
    """The map over frequency and amplitude of the voltage, and some of its rows as curves."""
    amplitudes, frequencies = (np.unique(column(table, name)) for name in ("phi_ac", "omega_ac"))
    found = column(table, "lambda3_amplitude").reshape(len(amplitudes), len(frequencies))
    figure, (map_axes, curve_axes) = plt.subplots(2, 1, figsize=(9.5, 8), sharex=True)
    extent = (frequencies[0], frequencies[-1], amplitudes[0], amplitudes[-1])
    image = map_axes.imshow(
        found, origin="lower", extent=extent, aspect="auto", interpolation="nearest", cmap="viridis", norm="log"
    )
    bar = figure.colorbar(image, ax=map_axes, label=AMPLITUDE, pad=0.01)
    bar.ax.yaxis.set_ticks([level for level in (0.03, 0.05, 0.1, 0.2, 0.5) if found.min() <= level <= found.max()])
    bar.ax.yaxis.set_ticks((), minor=True)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    map_axes.set_ylabel(f"voltage amplitude  {style.SYMBOLS['phi_ac']}")
    map_axes.grid(False)
    window = f"{style.SYMBOLS['time']} $\\leq$ {STOP_TIME:g}"
    map_axes.set_title(f"(a)  {style.setting(**SURFACE_EFFECTS)}, {window}: {len(table)} scenes", loc="left")
    for index, amplitude in enumerate(CURVES):
        row = int(np.argmin(np.abs(amplitudes - amplitude)))
        label = style.setting(phi_ac=amplitudes[row])
        curve_axes.plot(frequencies, found[row], label=label, linewidth=1.1, color=style.COLOURS[index])
    curve_axes.set(yscale="log", xlabel=f"angular frequency  {style.SYMBOLS['omega_ac']}", ylabel=AMPLITUDE)
    curve_axes.set_title("(b)  some rows of (a)", loc="left")
    curve_axes.legend(loc="upper right")
    return figure


if __name__ == "__main__":
    main()
