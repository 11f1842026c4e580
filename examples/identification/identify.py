"""Parameters of an actuator from a noisy record of its voltage and stretch, and what such a record cannot tell.

    python examples/identification/identify.py [--output FOLDER]

Two records of the same actuator are made with the FMU: one under a voltage that is switched between two levels, one
under a constant voltage. White noise is added to the stretch, and both are written as CSV, as a measurement would be.
The fit knows neither the surface parameters nor the scale of the voltage. Writes the records, the preset
identified.json and identification.png.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from dielectric_actuator import Actuator, measured
from dielectric_actuator.identification import Fit, fit

DEFAULT_OUTPUT = Path(__file__).resolve().parents[2] / "target" / "examples" / "identification"
TRUE = {"gamma_s": 0.05, "tau_s": 0.03, "E_s": 0.1, "phi_scale": 1 / 900}
"""Of the actuator that is measured; its voltage is in volts."""
GUESS = {"gamma_s": 0.02, "tau_s": 0.02, "E_s": 0.05, "phi_scale": 1 / 850}
NOISE = 1e-3
"""Standard deviation of the measured stretch."""
STEP, COUNT = 0.5, 800
HIGH, LOW, HELD = 450.0, 225.0, 495.0
"""Volts of the two levels, and of the constant voltage."""


def main() -> None:
    """Measure, fit, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the results (%(default)s)")
    output = parser.parse_args().output
    output.mkdir(parents=True, exist_ok=True)
    style.apply()
    time = STEP * np.arange(COUNT)
    switched = record(time, np.where(time % 80 < 40, HIGH, LOW), output / "switched.csv", seed=1)
    constant = record(time, np.full(COUNT, HELD), output / "constant.csv", seed=2)

    print("switched voltage: all four parameters")
    found = identify(switched, list(TRUE))
    compare(found)
    print("\nconstant voltage: surface energy, surface tension and the scale of the voltage")
    compare(identify(constant, ["gamma_s", "tau_s", "phi_scale"], E_s=TRUE["E_s"]))
    print("\nconstant voltage, its scale known: surface energy and surface tension")
    compare(identify(constant, ["gamma_s", "tau_s"], E_s=TRUE["E_s"], phi_scale=TRUE["phi_scale"]))

    print()
    print(found.preset("Identified from the switched record", HIGH).save(output / "identified.json"))
    print(style.save(draw(switched, found), output / "identification.png"))


def record(time: np.ndarray, voltage: np.ndarray, path: Path, seed: int) -> Path:
    """Let the FMU move under the voltage, held from row to row, and write what a sensor with noise would see."""
    scene = {name: value for name, value in TRUE.items() if name != "phi_scale"}
    with Actuator() as actuator:
        response = actuator.run(
            {**scene, "phi": lambda now: TRUE["phi_scale"] * float(voltage[round(now / STEP)])},
            stop_time=float(time[-1]),
            communication_step=STEP,
            outputs=["lambda"],
        )
    stretch = response["lambda"] + np.random.default_rng(seed).normal(0, NOISE, len(time))
    table = np.column_stack([time, voltage, stretch])
    np.savetxt(path, table, delimiter=",", header="time,voltage,stretch", comments="")
    return path


def identify(path: Path, free: list[str], **known: float) -> Fit:
    """Fit the free parameters to a record; the others are known."""
    data = measured.read(path, ["time", "voltage", "stretch"])
    return fit(
        data["time"], data["voltage"], data["stretch"], free=free, start={**GUESS, **known}, interpolation="hold"
    )


def compare(found: Fit) -> None:
    """Print true and found values, the uncertainty, and the deviation in units of it."""
    print(f"| {'parameter':<10} | {'true':>9} | {'found':>9} | {'uncertainty':>11} | deviation/uncertainty |")
    print(f"|{'':-<12}|{'':->11}|{'':->11}|{'':->13}|{'':->23}|")
    for name, uncertainty in found.uncertainties.items():
        told = np.isfinite(uncertainty)
        shown = f"{uncertainty:>11.2g}" if told else "cannot tell"
        deviation = f"{(found.values[name] - TRUE[name]) / uncertainty:+.1f}" if told else ""
        print(f"| {name:<10} | {TRUE[name]:>9.6f} | {found.values[name]:>9.6f} | {shown} | {deviation:>21} |")
    for direction in found.redundancies:
        moved = ", ".join(f"{name} {change:+.4g}" for name, change in direction.items())
        print(f"the motion is exactly the same along {moved}")
    print(f"what is left of the stretch: {found.residual:.2e} (noise {NOISE:g})")


def draw(path: Path, found: Fit) -> Figure:
    """The record with the fitted motion, and what is left of it."""
    data = measured.read(path, ["time", "voltage", "stretch"])
    time = data["time"]
    figure, (voltage, motion, rest) = plt.subplots(
        3, 1, figsize=(9.5, 6.5), sharex=True, gridspec_kw={"height_ratios": (1, 2.4, 1)}
    )
    voltage.step(time, data["voltage"], where="post", color=style.COLOURS[1])
    voltage.set_ylabel("voltage, V")
    motion.plot(time, data["stretch"], ".", color=style.GREY, markersize=2.5, label="measured")
    motion.plot(time, found.stretch, color=style.COLOURS[0], linewidth=1.1, label="fitted")
    motion.set_ylabel(f"stretch  {style.SYMBOLS['lambda']}")
    motion.legend(loc="upper left", markerscale=3)
    rest.plot(time, 1e3 * (data["stretch"] - found.stretch), ".", color=style.GREY, markersize=2.5)
    rest.set(xlabel=f"time  {style.SYMBOLS['time']}", ylabel="left, 10⁻³", xlim=(time[0], time[-1]))
    voltage.set_title("A record under a switched voltage, and the motion that was fitted to it", loc="left")
    return figure


if __name__ == "__main__":
    main()
