"""Controller, supply and two actuators as a system of FMUs: error of the coupling against the communication step.

    python examples/system/positioning.py

Packs positioning.ssp, runs it in FMPy's `simulate_ssp` and in `coupling.py` with derivatives up to order 3,
prints the errors, and writes response.png and coupling_error.png. The reference is the whole loop as one
differential equation, solved by SciPy's DOP853; it asks the actuator for λ'' at a given state and no more.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from dielectric_actuator import packed_fmu

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
from coupling import Coupling
from pack import DEFAULT_OUTPUT, pack_system

DEFAULT_STOP_TIME = 200.0
STEPS = (2.0, 1.0, 0.5, 0.25, 0.125, 0.0625)
FINE_STEP = 0.015625
"""For holds alone, which need it."""
TOLERANCE = 1e-12
OUTPUTS = ["leader.lambda", "follower.lambda", "supply.voltage"]
FMPY = "FMPy simulate_ssp"
ORDERS = {"held": 0, "first derivative": 1, "up to the second": 2, "up to the third": 3}


def reference(coupling: Coupling, times: np.ndarray) -> np.ndarray:
    """`OUTPUTS` at the given times, one row each, from the loop as a whole."""
    controller, supply = coupling.parameters("controller"), coupling.parameters("supply")
    names = ("leader", "follower")

    def acceleration(name: str, stretch: float, rate: float, voltage: float) -> float:
        unit = coupling.units[name]
        start = {"lambda_start": stretch, "lambda_dot_start": rate, "phi": voltage}
        unit.start({**coupling.parameters(name), **start})
        return unit.get("lambda_ddot")

    def rates(_time: float, state: np.ndarray) -> list[float]:
        integral, filtered, voltage, leader, leader_rate, follower, follower_rate = state
        deviation = controller["target"] - leader
        filtered_rate = (leader - filtered) / controller["F"]
        command = integral + controller["P"] * deviation - controller["D"] * filtered_rate
        motions = zip(names, (leader, follower), (leader_rate, follower_rate))
        bends = [acceleration(name, stretch, rate, voltage) for name, stretch, rate in motions]
        charge = (command - voltage) / supply["time_constant"]
        return [controller["I"] * deviation, filtered_rate, charge, leader_rate, bends[0], follower_rate, bends[1]]

    start = [controller["command_start"], 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]
    found = solve_ivp(rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-12)
    return found.y[[3, 5, 2]].T


def by_fmpy(ssp: Path, stop_time: float, step: float) -> np.ndarray:
    """`OUTPUTS` at the communication points after the first, as `simulate_ssp` returns them.

    Its rows carry the time at which their step began, the values those at its end.
    """
    result = simulate_ssp(
        str(ssp), stop_time=stop_time - step / 2, step_size=step, parameter_set=read_ssv(str(ssp), "parameters.ssv")
    )
    return np.array([result[name] for name in OUTPUTS]).T


def by_derivatives(coupling: Coupling, stop_time: float, step: float, order: int) -> np.ndarray:
    """`OUTPUTS` at the communication points after the first, with derivatives up to `order`."""
    rows = coupling.run(OUTPUTS, stop_time=stop_time, step=step, order=order, tolerance=TOLERANCE)
    return np.array([rows[name] for name in OUTPUTS]).T[1:]


def errors(ssp: Path, coupling: Coupling, exact: np.ndarray) -> dict[str, dict[float, float]]:
    """Largest error of the leader's λ at the communication points, by way and step; inf where it diverges."""
    stop_time = FINE_STEP * (len(exact) - 1)
    ways: dict[str, Callable[[float], np.ndarray]] = {FMPY: partial(by_fmpy, ssp, stop_time)}
    for name, order in ORDERS.items():
        ways[name] = partial(by_derivatives, coupling, stop_time, order=order)
    found: dict[str, dict[float, float]] = {}
    for name, way in ways.items():
        held = name == FMPY or ORDERS[name] == 0
        for step in STEPS + (FINE_STEP,) * held:
            try:
                stretch = way(step)[:, 0]
            except FMICallException:  # the voltage leaves its limits, and the actuator refuses it
                stretch = np.array([np.inf])
            every = round(step / FINE_STEP)
            error = float(np.max(np.abs(stretch - exact[every::every, 0][: len(stretch)])))
            found.setdefault(name, {})[step] = error
    return found


def draw_response(ssp: Path, coupling: Coupling, exact: np.ndarray) -> Figure:
    """Both stretches and the voltage: exact, and as two hosts have them at a coarse step."""
    step = STEPS[1]
    fine = FINE_STEP * np.arange(len(exact))
    times = step * np.arange(1, round(fine[-1] / step) + 1)
    best = list(ORDERS)[-1]
    hosts = {FMPY: by_fmpy(ssp, fine[-1], step), best: by_derivatives(coupling, fine[-1], step, ORDERS[best])}
    figure, panels = plt.subplots(3, 1, figsize=(9, 7.5), sharex=True)
    for column, (panel, title) in enumerate(zip(panels, ("(a)  leader", "(b)  follower", "(c)  supply"))):
        panel.plot(fine, exact[:, column], color=style.BLACK, linewidth=1.2, label="exact")
        for (name, rows), marker, colour in zip(hosts.items(), "xo", (style.COLOURS[1], style.COLOURS[0])):
            look = {"linestyle": "", "marker": marker, "markersize": 3.5, "color": colour}
            panel.plot(times, rows[:, column], label=f"{name}, steps of {step:g}", **look)
        panel.set_title(title, loc="left")
        panel.set_ylabel(style.SYMBOLS["phi" if column == 2 else "lambda"])
        low, high = exact[:, column].min(), exact[:, column].max()
        panel.set_ylim(low - 0.4 * (high - low), high + 0.4 * (high - low))
    panels[0].axhline(coupling.parameters("controller")["target"], color=style.GREY, linestyle="--", label="target")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    panels[-1].set_xlabel(f"{style.NAMES['time']}  {style.SYMBOLS['time']}")
    panels[-1].set_xlim(0, fine[-1])
    return figure


def draw_errors(found: dict[str, dict[float, float]]) -> Figure:
    """Error against communication step; what diverges is not drawn."""
    figure, axes = plt.subplots(figsize=(7.5, 4.6))
    for index, (name, values) in enumerate(found.items()):
        bounded = {step: error for step, error in values.items() if error < 0.1}
        axes.loglog(bounded.keys(), bounded.values(), marker="o", markersize=4, label=name, **style.curve(index))
    axes.set(xlabel="communication step", ylabel=f"largest error of the leader's {style.SYMBOLS['lambda']}")
    axes.legend(loc="lower right")
    axes.set_title("Coupling by values alone, and with derivatives", loc="left")
    return figure


def steps_saved(found: dict[str, dict[float, float]], name: str) -> tuple[float, float]:
    """The error of way `name` at a step of 1, and how many times more steps holds need for the same.

    Holds are interpolated or continued along their last slope, which is 1.
    """
    error = found[name][1.0]
    steps, held = (np.log(np.array(column[::-1])) for column in zip(*found["held"].items()))
    slope = (held[1] - held[0]) / (steps[1] - steps[0])
    wanted = np.log(error)
    step = np.interp(wanted, held, steps) if wanted > held[0] else steps[0] + (wanted - held[0]) / slope
    return error, float(np.exp(-step))


def main() -> None:
    """Pack, run, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed actuator (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder (%(default)s)")
    parser.add_argument("--stop-time", type=float, default=DEFAULT_STOP_TIME, help="a multiple of 2 (%(default)s)")
    arguments = parser.parse_args()
    style.apply()
    ssp = pack_system(arguments.fmu, arguments.output)
    print(ssp)
    with Coupling(ssp) as coupling:
        exact = reference(coupling, FINE_STEP * np.arange(round(arguments.stop_time / FINE_STEP) + 1))
        found = errors(ssp, coupling, exact)
        print("largest error of the leader's lambda by communication step")
        print(f"{'':<20}" + "".join(f"{step:>12g}" for step in (*STEPS, FINE_STEP)))
        for name, values in found.items():
            print(f"{name:<20}" + "".join(f"{values[step]:>12.1e}" for step in values))
        for name in list(ORDERS)[1:]:
            error, times = steps_saved(found, name)
            print(f"{name}, steps of 1: error {error:.1e}; holds need {times:.0f} times as many steps for the same")
        print(style.save(draw_response(ssp, coupling, exact), arguments.output / "response.png"))
    print(style.save(draw_errors(found), arguments.output / "coupling_error.png"))


if __name__ == "__main__":
    main()
