"""Position control of the stretch: PID with feed-forward, and a predictive controller, safe near pull-in.

    python examples/control/control.py

Prints deviations and the cost of a control step, and writes tracking.png, near_pull_in.png and sampling.png.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from pathlib import Path

# the matrices are small: threads of the linear algebra would cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from dielectric_actuator import Actuator, packed_fmu

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from controllers import FeedForwardPID, Predictive
from loop import RESERVE, SCENE, Run, Scenario, close_loop

DEFAULT_OUTPUT = Path(__file__).resolve().parents[2] / "target" / "examples" / "control"
CONTROLLERS = {"PID with feed-forward": FeedForwardPID, "predictive": Predictive}
PERIOD = 1.0
PERIODS = (0.5, 1.0, 2.0, 3.0, 4.0, 6.0)
STEP_AT, SINE_AT, REST_AT, PUSH_AT, STOP_AT = 20.0, 120.0, 300.0, 340.0, 440.0


def tracking_target(time: float) -> float:
    """A step, three periods of a sine, rest."""
    if time < STEP_AT:
        return 1.0
    if SINE_AT <= time < REST_AT:
        return 1.06 + 0.03 * math.sin(2 * math.pi * (time - SINE_AT) / 60)
    return 1.06


def pushed_prestress(time: float) -> float:
    """The prestress, 0.04 more from `PUSH_AT` on."""
    return SCENE["S"] + 0.04 * (time >= PUSH_AT)


TRACKING = Scenario(tracking_target, pushed_prestress, STOP_AT)
SILENCE = (160.0, 240.0)
HIGHEST, COLLAPSED = 1.6, 10.0
"""Of the stretch: the end of the axis, and `lambda_max`."""
BEYOND = Scenario(
    lambda time: 1.0 + 0.35 * min(max(time - 20.0, 0.0) / 100.0, 1.0),
    lambda time: SCENE["S"] + 0.01 * (time >= SILENCE[0]),
    300.0,
    SILENCE,
)
"""A target where the actuator is unstable without its controller, which then fails to act for a while."""


def draw_tracking(runs: dict[str, Run]) -> Figure:
    """Stretch, deviation and voltage of each controller."""
    figure, (stretch, deviation, voltage) = plt.subplots(3, 1, figsize=(10, 8), sharex=True, height_ratios=(2, 1, 1.3))
    first = next(iter(runs.values())).rows
    stretch.plot(first["time"], first["target"], color=style.BLACK, linewidth=1.2, label="target")
    for index, (name, run) in enumerate(runs.items()):
        rows, look = run.rows, style.curve(index)
        stretch.plot(rows["time"], rows["stretch"], label=name, **look)
        deviation.plot(rows["time"], rows["stretch"] - rows["target"], **look)
        voltage.step(rows["time"], rows["voltage"], where="post", **look)
    voltage.plot(first["time"], first["safe_voltage"], color=style.GREY, linewidth=1.2, label="bound")
    for axes in (stretch, deviation, voltage):
        axes.axvline(PUSH_AT, color=style.GREY, linestyle=":", linewidth=1.2)
    stretch.text(PUSH_AT + 2, 1.005, f"{style.SYMBOLS['S']} rises by 0.04", fontsize=9.5)
    stretch.set_ylabel(f"{style.NAMES['lambda']}  {style.SYMBOLS['lambda']}")
    deviation.set(ylabel=f"{style.SYMBOLS['lambda']} $-$ target", ylim=(-0.03, 0.03))
    voltage.set_ylabel(f"{style.NAMES['phi']}  {style.SYMBOLS['phi']}")
    voltage.set_xlabel(f"{style.NAMES['time']}  {style.SYMBOLS['time']}")
    handles = [*stretch.get_legend_handles_labels()[0], *voltage.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside upper center", ncols=4)
    stretch.set_xlim(0, STOP_AT)
    stretch.set_title(f"Step, sine, and an unmeasured change of the prestress; sampled every {PERIOD:g}", loc="left")
    return figure


def draw_near_pull_in(runs: dict[str, Run]) -> Figure:
    """A target beyond the fold, with and without the bound of the margin."""
    figure, (stretch, voltage) = plt.subplots(2, 1, figsize=(10, 6), sharex=True)
    longest = max(runs.values(), key=lambda run: len(run.rows)).rows
    stretch.plot(longest["time"], longest["target"], color=style.BLACK, linewidth=1.2, label="target")
    for index, (name, run) in enumerate(runs.items()):
        stretch.plot(run.rows["time"], run.rows["stretch"], label=name, **style.curve(index))
        voltage.step(run.rows["time"], run.rows["voltage"], where="post", **style.curve(index))
        if run.pulled_in:
            left = run.rows["time"][run.rows["stretch"] > HIGHEST][0]
            stretch.annotate(
                f"collapse: {style.SYMBOLS['lambda']} = {COLLAPSED:g} by {style.SYMBOLS['time']} = {run.ended_by}",
                (left, HIGHEST),
                (SILENCE[0] - 65, HIGHEST - 0.06),
                arrowprops={"arrowstyle": "->", "color": style.BLACK},
                fontsize=9.5,
                va="center",
            )
    threshold = longest["safe_voltage"][0] + RESERVE
    voltage.axhline(threshold, color=style.GREY, linestyle="--", linewidth=1.2)
    voltage.text(5, threshold + 0.01, f"dynamic threshold {style.SYMBOLS['phi_pull_in']}", fontsize=9.5)
    stretch.set(ylim=(0.95, HIGHEST), ylabel=f"{style.NAMES['lambda']}  {style.SYMBOLS['lambda']}")
    voltage.set_ylabel(f"{style.NAMES['phi']}  {style.SYMBOLS['phi']}")
    voltage.set_xlabel(f"{style.NAMES['time']}  {style.SYMBOLS['time']}")
    figure.legend(*stretch.get_legend_handles_labels(), loc="outside upper center", ncols=4)
    stretch.set_xlim(0, BEYOND.stop_time)
    for axes in (stretch, voltage):
        axes.axvspan(*SILENCE, color=style.GREY, alpha=0.2, linewidth=0)
        axes.text(
            np.mean(SILENCE), 0.04, "controller silent", transform=axes.get_xaxis_transform(), ha="center", fontsize=9.5
        )
    stretch.set_title(
        "(a)  a target beyond the fold: bounded controllers do not reach it, and lose nothing", loc="left"
    )
    voltage.set_title("(b)  at the bound no voltage is left to damp with: the stretch rings, and survives", loc="left")
    return figure


def draw_sampling(sampled: dict[str, dict[float, Run]]) -> Figure:
    """Deviation, and cost of a control step, over the sampling period."""
    figure, (deviation, cost) = plt.subplots(1, 2, figsize=(10.5, 4.2))
    for index, (name, runs) in enumerate(sampled.items()):
        kept = {period: run for period, run in runs.items() if not run.pulled_in}
        look = {"marker": "o", "markersize": 4, **style.curve(index)}
        deviation.semilogy(kept.keys(), [run.deviation(SINE_AT) for run in kept.values()], label=name, **look)
        cost.semilogy(runs.keys(), [1e6 * np.median(run.seconds) for run in runs.values()], label=name, **look)
    deviation.set(xlabel="sampling period", ylabel="root mean square deviation")
    deviation.set_title("(a)  sine and disturbance", loc="left")
    cost.set(xlabel="sampling period", ylabel="processor time a step, µs")
    cost.set_title("(b)  cost, from Python", loc="left")
    figure.legend(*deviation.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def main() -> None:
    """Close the loops, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the plots (%(default)s)")
    parser.add_argument("--periods", type=float, nargs="+", default=PERIODS, help="sampling periods (%(default)s)")
    arguments = parser.parse_args()
    style.apply()
    with Actuator(arguments.fmu) as plant, Actuator(arguments.fmu) as model:
        sampled: dict[str, dict[float, Run]] = {}
        print(f"{'sampling period':<24}{'controller':<24}{'deviation':>12}{'us a control step':>20}")
        for period in sorted({*arguments.periods, PERIOD}):
            for name, kind in CONTROLLERS.items():
                run = sampled.setdefault(name, {})[period] = close_loop(plant, model, kind, TRACKING, period=period)
                note = "   pulled in" if run.pulled_in else ""
                cost = 1e6 * np.median(run.seconds)
                print(f"{period:<24g}{name:<24}{run.deviation(SINE_AT):>12.2e}{cost:>20.0f}{note}", flush=True)
        beyond = {}
        guarded = {name: (kind, True) for name, kind in CONTROLLERS.items()}
        for name, (kind, bounded) in {**guarded, "PID without the bound": (FeedForwardPID, False)}.items():
            run = beyond[name] = close_loop(plant, model, kind, BEYOND, period=PERIOD, guarded=bounded)
            late = run.rows["stretch"][run.rows["time"] >= SILENCE[1]]
            end = f"largest stretch {run.rows['stretch'].max():.4f}"
            if run.pulled_in:
                end = f"pulled in by {run.ended_by}"
            else:
                end += f", rings at the end by {np.ptp(late) / 2:.4f}"
            print(f"target beyond the fold, {name}: {end}", flush=True)
    figures = {
        "tracking": draw_tracking({name: runs[PERIOD] for name, runs in sampled.items()}),
        "near_pull_in": draw_near_pull_in(beyond),
        "sampling": draw_sampling(sampled),
    }
    for name, figure in figures.items():
        print(style.save(figure, arguments.output / f"{name}.png"))


if __name__ == "__main__":
    main()
