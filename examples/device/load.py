"""A load at the edge in an FMU of its own: error of the coupling against the communication step.

    python examples/device/load.py

Packs edge_load.ssp: the actuator in SI units, and a mass, a spring and a dashpot that answer to displacement,
velocity and acceleration of its edges with a force. The references are the same load inside the actuator's FMU
(`m_load`, `k_load`, `b`), and SciPy's DOP853 on the equation of motion written anew (film.py). Prints the errors
and writes edge_load.png.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssv
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from dielectric_actuator import Actuator

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "system"))

import figure_style as style
import options
from coupling import Coupling
from film import FILM, Equation
from pack import pack_system

HERE = Path(__file__).resolve().parent
STOP_TIME = 10.24e-3
STEPS = (80e-6, 40e-6, 20e-6, 10e-6, 5e-6)
"""Communication steps in s; the film alone swings in 810 µs."""

TOLERANCE = 1e-12
POSITION = "actuator.edge_displacement"
ACTUATOR = {**FILM, "eta": 5.0, "voltage": 4000.0}
FMPY = "FMPy simulate_ssp"
ORDERS = {"held": 0, "first derivative": 1, "up to the second": 2, "up to the third": 3}


class Load(NamedTuple):
    """What sits between the edges."""

    title: str
    mass: float
    spring: float
    dashpot: float

    def outside(self) -> dict[str, float]:
        """As the FMU of the load calls it."""
        return {"mass": self.mass, "spring": self.spring, "dashpot": self.dashpot}

    def inside(self) -> dict[str, float]:
        """As the actuator calls it."""
        return {"m_load": self.mass, "k_load": self.spring, "b": self.dashpot}


LOADS = (Load("spring and dashpot", 0.0, 200.0, 0.02), Load("mass, spring and dashpot", 1e-4, 200.0, 0.02))


def inside(fmu: Path, load: Load, times: np.ndarray) -> np.ndarray:
    """Displacement in m with the load inside the actuator's FMU, in steps from time to time."""
    with Actuator(fmu) as actuator:
        actuator.start({**ACTUATOR, **load.inside()}, tolerance=TOLERANCE)
        found = [actuator.get("edge_displacement")]
        for before, time in itertools.pairwise(times):
            actuator.time = before
            actuator.advance(time - before)
            found.append(actuator.get("edge_displacement"))
    return np.array(found)


def written_anew(load: Load, times: np.ndarray) -> np.ndarray:
    """Displacement in m by SciPy, without the FMU."""
    equation = Equation({**ACTUATOR, **load.inside()})

    def rates(_time: float, state: np.ndarray) -> list[float]:
        stretch, rate = state
        return [rate, equation.acceleration(stretch, rate, equation.charge(stretch, ACTUATOR["voltage"]))]

    found = solve_ivp(rates, (0, times[-1]), [1.0, 0.0], method="DOP853", t_eval=times, rtol=1e-13, atol=1e-13)
    return equation.side * (found.y[0] - 1)


def by_fmpy(ssp: Path, load: Load, stop_time: float, step: float) -> np.ndarray:
    """Displacement at the communication points after the first, as `simulate_ssp` returns it."""
    parameters = read_ssv(str(ssp), "parameters.ssv")
    values = load.outside()
    for parameter in parameters.parameters:
        unit, _, variable = parameter.name.partition(".")
        if unit == "load":
            parameter.value = str(values[variable])
    result = simulate_ssp(str(ssp), stop_time=stop_time - step / 2, step_size=step, parameter_set=parameters)
    return result[POSITION]


def errors(ssp: Path, coupling: Coupling, load: Load, exact: np.ndarray) -> dict[str, dict[float, float]]:
    """Largest error of the displacement in m at the communication points, by way and step; inf where it diverges."""
    coupling.set_parameters("load", load.outside())
    stop_time = STEPS[-1] * (len(exact) - 1)

    def by_derivatives(step: float, order: int) -> np.ndarray:
        rows = coupling.run(
            [POSITION], stop_time=stop_time, step=step, order=order, tolerance=TOLERANCE, loop=load.mass > 0
        )
        return rows[POSITION][1:]

    ways: dict[str, Callable[[float], np.ndarray]] = {FMPY: partial(by_fmpy, ssp, load, stop_time)}
    for name, order in ORDERS.items():
        ways[name] = partial(by_derivatives, order=order)
    found: dict[str, dict[float, float]] = {}
    for name, way in ways.items():
        found[name] = {}
        for step in STEPS:
            try:
                position = way(step)
            except Exception:  # the host hands over what is no number, and the actuator refuses it
                position = np.array([np.inf])
            every = round(step / STEPS[-1])
            error = float(np.max(np.abs(position - exact[every::every][: len(position)])))
            found[name][step] = error if error < np.ptp(exact) else np.inf
    return found


def draw(times: np.ndarray, exact: dict[str, np.ndarray], found: dict[str, dict[str, dict[float, float]]]) -> Figure:
    """The motions, and the error against the communication step for each load."""
    figure, panels = plt.subplots(1, 3, figsize=(13, 4.6), width_ratios=(1.2, 1, 1))
    for index, (title, position) in enumerate(exact.items()):
        panels[0].plot(1e3 * times, 1e6 * position, label=title, **style.curve(index))
    panels[0].set(xlabel="time in ms", ylabel="displacement of the edges in µm")
    panels[0].set_title("(a)  motion", loc="left")
    panels[0].legend(loc="lower right")
    for panel, letter, (title, ways) in zip(panels[1:], "bc", found.items()):
        for index, (name, values) in enumerate(ways.items()):
            bounded = {1e6 * step: 1e6 * error for step, error in values.items() if np.isfinite(error)}
            if bounded:
                panel.loglog(bounded.keys(), bounded.values(), marker="o", label=name, **style.curve(index))
        panel.set(xlabel="communication step in µs", ylabel="largest error in µm", ylim=(1e-7, 1e3))
        panel.set_xticks([1e6 * step for step in STEPS], [f"{1e6 * step:g}" for step in STEPS])
        panel.minorticks_off()
        panel.set_title(f"({letter})  {title}", loc="left")
    panels[1].legend(loc="lower right")
    return figure


def main() -> None:
    """Pack, run, print, draw."""
    arguments = options.parse(__doc__, STOP_TIME)
    style.apply()
    ssp = pack_system(arguments.fmu, arguments.output, HERE / "load")
    print(ssp)
    times = STEPS[-1] * np.arange(round(arguments.stop_time / STEPS[-1]) + 1)
    exact: dict[str, np.ndarray] = {}
    found: dict[str, dict[str, dict[float, float]]] = {}
    with Coupling(ssp) as coupling:
        for load in LOADS:
            exact[load.title] = inside(arguments.fmu, load, times)
            difference = np.abs(exact[load.title] - written_anew(load, times)).max()
            print(f"{load.title}: load inside against SciPy {1e6 * difference:.1e} um")
            found[load.title] = errors(ssp, coupling, load, exact[load.title])
            print(f"{'largest error in um':<20}" + "".join(f"{1e6 * step:>9g} us" for step in STEPS))
            for name, values in found[load.title].items():
                print(f"{name:<20}" + "".join(f"{1e6 * error:>12.1e}" for error in values.values()))
    print(style.save(draw(times, exact, found), arguments.output / "edge_load.png"))


if __name__ == "__main__":
    main()
