"""A self-sensing controller, an amplifier with limits, a drive resistor and the actuator, as a system of FMUs.

    python examples/device/driver.py

Packs self_sensing.ssp. The controller has no sensor: it estimates the displacement from charge over voltage. Prints
how well it does, and the error of the coupling against SciPy's DOP853 on the loop as one differential equation
(film.py), and writes self_sensing.png.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "system"))

import figure_style as style
import options
from coupling import Coupling
from film import Equation
from pack import pack_system

HERE = Path(__file__).resolve().parent
TARGETS = ((0.0, 100e-6), (8e-3, 350e-6), (16e-3, 50e-6), (24e-3, 200e-6))
"""From when on, in s, the controller is to hold which displacement, in m."""

STOP_TIME = 32e-3
STEPS = (20e-6, 10e-6, 5e-6, 2.5e-6)
ORDERS = {"held": 0, "first derivative": 1, "up to the second": 2}
OUTPUTS = {
    "position": "actuator.edge_displacement",
    "estimate": "controller.estimate",
    "command": "controller.command",
    "amplifier": "amplifier.voltage",
    "membrane": "actuator.membrane_voltage",
    "current": "actuator.supply_current",
}


def target(time: float) -> float:
    """Wanted displacement in m."""
    return [wanted for begin, wanted in TARGETS if time >= begin - 1e-9][-1]


def coupled(coupling: Coupling, stop_time: float, step: float, order: int) -> np.ndarray:
    """One row a communication point, with the fields `time` and those of OUTPUTS."""
    rows = coupling.run(
        list(OUTPUTS.values()),
        stop_time=stop_time,
        step=step,
        order=order,
        tolerance=1e-12,
        inputs={"controller.target": target},
    )
    rows.dtype.names = ("time", *OUTPUTS)
    return rows


def as_a_whole(coupling: Coupling, stop_time: float, step: float) -> np.ndarray:
    """Displacement at the communication points, from the loop as one differential equation."""
    controller, amplifier, actuator = (coupling.parameters(name) for name in ("controller", "amplifier", "actuator"))
    equation = Equation(actuator)
    least = coupling.units["controller"].variables["least_voltage"].start
    lowest, gain = (float(coupling.units["amplifier"].variables[name].start) for name in ("lowest", "gain"))

    def rates(_time: float, state: np.ndarray, wanted: float) -> list[float]:
        integral, filtered, voltage, stretch, rate, charge = state
        membrane = charge / (equation.capacitance * stretch**4)
        seen = equation.side * (stretch - 1) if abs(membrane) >= float(least) else 0.0
        filtered_rate = (seen - filtered) / controller["F"]
        command = integral + controller["P"] * (wanted - seen) - controller["D"] * filtered_rate
        delivered = min(max(gain * command, lowest), amplifier["highest"])
        return [
            controller["I"] * (wanted - seen),
            filtered_rate,
            (delivered - voltage) / amplifier["time_constant"],
            rate,
            equation.acceleration(stretch, rate, charge),
            equation.current(stretch, charge, voltage),
        ]

    state = np.array([controller["command_start"], 0.0, 0.0, 1.0, 0.0, 0.0])
    stretches = [1.0]
    phases = [(begin, wanted) for begin, wanted in TARGETS if begin < stop_time]
    ends = [begin for begin, _ in phases[1:]] + [stop_time]
    for (begin, wanted), end in zip(phases, ends):
        times = step * np.arange(round(begin / step) + 1, round(end / step) + 1)
        times[-1] = end
        found = solve_ivp(
            *(rates, (begin, end), state),
            **dict(method="DOP853", t_eval=times, args=(wanted,), rtol=1e-9, atol=1e-12, max_step=1e-5),
        )
        stretches.extend(found.y[3])
        state = found.y[:, -1]
    return equation.side * (np.array(stretches) - 1)


def draw(rows: np.ndarray) -> Figure:
    """Displacement and its estimate; the voltages; the current."""
    figure, panels = plt.subplots(3, 1, figsize=(9, 8), sharex=True, height_ratios=(3, 2, 1.4))
    time = 1e3 * rows["time"]
    position, voltages, current = panels
    position.step(time, [1e6 * target(t) for t in rows["time"]], where="post", color=style.GREY, label="target")
    position.plot(time, 1e6 * rows["position"], label="position", **style.curve(0))
    position.plot(time, 1e6 * rows["estimate"], label="estimate from charge over voltage", **style.curve(1))
    position.set(ylabel="displacement in µm")
    position.set_title("(a)  position", loc="left")
    position.legend(loc="upper right")
    voltages.plot(time, rows["command"], label="command × 1000", **style.curve(2))
    voltages.plot(time, 1e-3 * rows["amplifier"], label="amplifier", **style.curve(0))
    voltages.plot(time, 1e-3 * rows["membrane"], label="membrane", **style.curve(1))
    voltages.set(ylabel="voltage in kV")
    voltages.set_title("(b)  the amplifier delivers 0 to 3.8 kV", loc="left")
    voltages.legend(loc="upper right", ncols=3)
    current.plot(time, 1e3 * rows["current"], **style.curve(0))
    current.set(ylabel="current in mA", xlabel="time in ms", xlim=(0, time[-1]))
    current.set_title("(c)  through the drive resistor", loc="left")
    return figure


def main() -> None:
    """Pack, run, print, draw."""
    arguments = options.parse(__doc__, STOP_TIME)
    style.apply()
    ssp = pack_system(arguments.fmu, arguments.output, HERE / "driver")
    print(ssp)
    with Coupling(ssp) as coupling:
        exact = as_a_whole(coupling, arguments.stop_time, STEPS[-1])
        print(f"{'largest error in um':<20}" + "".join(f"{1e6 * step:>9g} us" for step in STEPS))
        for name, order in ORDERS.items():
            found = {step: coupled(coupling, arguments.stop_time, step, order) for step in STEPS}
            differences = [
                np.abs(rows["position"] - exact[:: round(step / STEPS[-1])]).max() for step, rows in found.items()
            ]
            print(f"{name:<20}" + "".join(f"{1e6 * difference:>12.1e}" for difference in differences))
        rows = found[STEPS[-1]]
    measured = rows["membrane"] >= 100
    print(f"estimate against position: {1e6 * np.abs(rows['estimate'] - rows['position'])[measured].max():.1e} um")
    limited = (rows["command"] > 3.8) | (rows["command"] < 0)
    print(f"amplifier at a limit: {1e3 * STEPS[-1] * np.count_nonzero(limited):.2f} ms")
    print(f"largest current: {1e3 * np.abs(rows['current']).max():.2f} mA")
    print(style.save(draw(rows), arguments.output / "self_sensing.png"))


if __name__ == "__main__":
    main()
