"""Why an input seems to come late, what input derivatives cure, and how to read `pulled_in`.

    python examples/lag/lag.py

Prints the error of each way against the communication step and writes inputs.png and pull_in.png. The
reference is the same voltage from the built-in drive, which is exact at any communication step.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from fmpy import simulate_fmu
from matplotlib.figure import Figure

from dielectric_actuator import Actuator, packed_fmu

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style

DEFAULT_OUTPUT = Path(__file__).resolve().parents[2] / "target" / "examples" / "lag"
SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
AMPLITUDE, FREQUENCY = 0.3, 0.1
PERIOD = 2 * math.pi / FREQUENCY
PERIODS = 4
STEPS_IN_A_PERIOD = (8, 16, 32, 64, 128, 256, 512, 1024)
TOLERANCE = 1e-13
ORDERS = {"held (FMPy's input)": 0, "first derivative": 1, "up to the second": 2, "up to the third": 3}
"""How many derivatives each way gives the FMU."""

PULL_IN = {"phi": 0.7, "gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0}
COARSE_STEP = 6.0
TERMINATE = 2


def voltage(time: float) -> float:
    """The voltage that a user wants to apply."""
    return AMPLITUDE * math.sin(FREQUENCY * time)


def derivatives(time: float, order: int) -> list[float]:
    """Its derivatives by time, from the first to the given order."""
    return [AMPLITUDE * FREQUENCY**k * math.sin(FREQUENCY * time + k * math.pi / 2) for k in range(1, order + 1)]


def held(fmu: Path, step: float) -> np.ndarray:
    """λ as a user of `simulate_fmu` gets it with the voltage as input signal."""
    stop_time = PERIODS * PERIOD
    time = np.linspace(0, stop_time, round(stop_time / step) + 1)
    # FMPy prints a warning for an input without a column
    signal = np.array([(t, voltage(t), 0.0) for t in time], dtype=[(name, float) for name in ("time", "phi", "S")])
    result = simulate_fmu(
        str(fmu),
        start_values=SURFACE_EFFECTS,
        input=signal,
        stop_time=stop_time,
        output_interval=step,
        relative_tolerance=TOLERANCE,
        output=["lambda"],
    )
    return result["lambda"]


def with_derivatives(actuator: Actuator, step: float, order: int) -> np.ndarray:
    """λ with the voltage and its derivatives up to `order` set at each communication point."""
    actuator.start(SURFACE_EFFECTS, tolerance=TOLERANCE)
    stretch = [actuator.get("lambda")]
    for _ in range(round(PERIODS * PERIOD / step)):
        actuator.set({"phi": voltage(actuator.time)})
        actuator.set_input_derivatives({"phi": derivatives(actuator.time, order)})
        actuator.advance(step)
        stretch.append(actuator.get("lambda"))
    return np.array(stretch)


def exact(actuator: Actuator, step: float) -> np.ndarray:
    """λ under the built-in drive of the same voltage."""
    scene = {**SURFACE_EFFECTS, "phi_ac": AMPLITUDE, "omega_ac": FREQUENCY}
    run = actuator.run(scene, stop_time=PERIODS * PERIOD, communication_step=step, tolerance=TOLERANCE)
    return run["lambda"]


def errors(actuator: Actuator, fmu: Path) -> dict[str, list[float]]:
    """Largest error of λ at the communication points, for each way and each number of steps in a period."""
    found: dict[str, list[float]] = {name: [] for name in ORDERS}
    for count in STEPS_IN_A_PERIOD:
        step = PERIOD / count
        reference = exact(actuator, step)
        for name, order in ORDERS.items():
            stretch = with_derivatives(actuator, step, order) if order else held(fmu, step)
            found[name].append(float(np.max(np.abs(stretch - reference))))
    return found


def draw_inputs(actuator: Actuator, fmu: Path, found: dict[str, list[float]]) -> Figure:
    """The held voltage and its response beside the true ones; error against steps in a period."""
    count = 16
    step = PERIOD / count
    fine, fine_step = exact(actuator, PERIOD / 400), PERIOD / 400
    figure, panels = plt.subplot_mosaic([["input", "error"], ["response", "error"]], figsize=(11, 5.6))

    points = step * np.arange(PERIODS * count + 1)
    smooth = fine_step * np.arange(len(fine))
    panels["input"].plot(smooth, [voltage(t) for t in smooth], color=style.BLACK, label="wanted")
    panels["input"].step(
        points, [voltage(t) for t in points], where="post", color=style.COLOURS[1], label="held: half a step late"
    )
    panels["response"].plot(smooth, fine, color=style.BLACK, label="exact")
    look: dict[str, Any] = {"linestyle": "", "markersize": 4}
    panels["response"].plot(points, held(fmu, step), "o", color=style.COLOURS[1], label="held", **look)
    panels["response"].plot(
        points, with_derivatives(actuator, step, 1), "s", color=style.COLOURS[0], label="first derivative", **look
    )
    for name, variable in (("input", "phi"), ("response", "lambda")):
        style.label(panels[name], "time", variable)
        panels[name].legend(loc="lower left", ncols=3)
        panels[name].margins(x=0)
        panels[name].set_xlim(0, 2 * PERIOD)
    panels["input"].set_ylim(-0.5, 0.4)
    panels["response"].set_ylim(0.915, 1.03)
    panels["input"].set_title(f"(a)  {count} communication steps in a period", loc="left")
    panels["response"].set_title("(b)  response", loc="left")

    for index, (name, values) in enumerate(found.items()):
        panels["error"].loglog(STEPS_IN_A_PERIOD, values, marker="o", markersize=4, label=name, **style.curve(index))
    panels["error"].set(
        xlabel="communication steps in a period of the voltage", ylabel=f"largest error of {style.SYMBOLS['lambda']}"
    )
    panels["error"].set_title("(c)  each derivative gains an order", loc="left")
    panels["error"].legend(loc="lower left")
    return figure


def pull_in(actuator: Actuator) -> dict[str, np.ndarray]:
    """One collapse, sampled coarsely with both settings of `on_pull_in`, and finely."""
    outputs = ("lambda", "pulled_in", "pull_in_time")

    def run(step: float, **setting: float) -> np.ndarray:
        return actuator.run({**PULL_IN, **setting}, stop_time=60.0, communication_step=step, outputs=outputs)

    return {"fine": run(0.05), "hold": run(COARSE_STEP), "terminate": run(COARSE_STEP, on_pull_in=TERMINATE)}


def draw_pull_in(runs: dict[str, np.ndarray]) -> Figure:
    """When the collapse is seen, and when it was."""
    instant = runs["hold"]["pull_in_time"][-1]
    figure, (stretch, flag) = plt.subplots(2, 1, figsize=(9, 5.4), sharex=True, height_ratios=(2, 1))
    stretch.plot(runs["fine"]["time"], runs["fine"]["lambda"], color=style.GREY, label="the motion")
    looks = {"hold": ("o", 7, style.COLOURS[0]), "terminate": ("x", 8, style.COLOURS[1])}
    for name, (marker, size, colour) in looks.items():
        run = runs[name]
        look = {"linestyle": "", "marker": marker, "markersize": size, "color": colour, "markerfacecolor": "none"}
        stretch.plot(run["time"], run["lambda"], label=f"on_pull_in = {name}, steps of {COARSE_STEP:g}", **look)
        flag.plot(run["time"], run["pulled_in"], **look)
    flag.step(runs["fine"]["time"], runs["fine"]["pulled_in"], where="post", color=style.GREY)
    for axes in (stretch, flag):
        axes.axvline(instant, color=style.BLACK, linestyle="--", linewidth=1)
    stretch.text(instant + 0.5, 3, f"pull_in_time = {instant:.6f}")
    stretch.legend(loc="upper left")
    stretch.set_ylabel(f"{style.NAMES['lambda']}  {style.SYMBOLS['lambda']}")
    flag.set(yticks=(0, 1), yticklabels=("false", "true"), ylabel="pulled_in")
    flag.set_xlabel(f"{style.NAMES['time']}  {style.SYMBOLS['time']}")
    setting = style.setting(phi=PULL_IN["phi"])
    stretch.set_title(f"Collapse after a voltage step, {setting}, no surface effects", loc="left")
    return figure


def main() -> None:
    """Measure, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the plots (%(default)s)")
    arguments = parser.parse_args()
    style.apply()
    with Actuator(arguments.fmu) as actuator:
        found = errors(actuator, arguments.fmu)
        print(f"largest error of lambda, phi = {AMPLITUDE:g} sin({FREQUENCY:g} t), {PERIODS} periods")
        print("steps in a period  " + "".join(f"{name:>22}" for name in found))
        for k, count in enumerate(STEPS_IN_A_PERIOD):
            print(f"{count:<19}" + "".join(f"{values[k]:>22.1e}" for values in found.values()))
        print(style.save(draw_inputs(actuator, arguments.fmu, found), arguments.output / "inputs.png"))
        runs = pull_in(actuator)
        seen = runs["hold"]["time"][runs["hold"]["pulled_in"]][0]
        print(f"pulled_in first true at {seen:g}, pull_in_time {runs['hold']['pull_in_time'][-1]:.9f}, ", end="")
        print(f"last row with on_pull_in = terminate at {runs['terminate']['time'][-1]:.9f}")
        print(style.save(draw_pull_in(runs), arguments.output / "pull_in.png"))


if __name__ == "__main__":
    main()
