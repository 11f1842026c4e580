"""The picture on top of the README: a membrane, a voltage, a snap; from the FMU, in SI units of one film."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import figure_style as style
from dielectric_actuator import Actuator

MODULUS, DENSITY, PERMITTIVITY = 303e3, 1100.0, 2.8 * 8.8541878188e-12
"""The silicone of the paper in Pa, kg/m³ and F/m; its surface effects are left out here."""
THICKNESS, ASPECT = 10e-6, 100.0
"""Of the film in m, and side² over thickness²."""

VOLT = math.sqrt(PERMITTIVITY / MODULUS) / THICKNESS
"""Nondimensional voltage of one volt."""
MICROSECOND = 1e-6 * math.sqrt(12 * MODULUS / DENSITY) / THICKNESS
"""Nondimensional time of one microsecond."""

SWINGS, SNAPS = style.COLOURS[0], style.COLOURS[1]
MEMBRANE = style.COLOURS[5]
SHOWN = 3.2
"""The stretch at which the escaping membrane is drawn, and its curve ends."""


@dataclass(frozen=True)
class Step:
    """The response to one voltage, switched on at rest: volts, microseconds and stretches."""

    voltage: int
    time: np.ndarray
    stretch: np.ndarray


def steps(actuator: Actuator) -> tuple[Step, Step]:
    """The responses to the whole volts next below and next above dynamic pull-in."""
    actuator.start({"c": ASPECT})
    below = math.floor(actuator.get("phi_pull_in") / VOLT)
    return respond(actuator, below), respond(actuator, below + 1)


def respond(actuator: Actuator, voltage: int) -> Step:
    """The response to a voltage over 30 microseconds."""
    response = actuator.run(
        {"c": ASPECT, "phi": voltage * VOLT},
        stop_time=30 * MICROSECOND,
        communication_step=0.05 * MICROSECOND,
        outputs=["lambda"],
    )
    return Step(voltage, response["time"] / MICROSECOND, response["lambda"])


def figure(below: Step, above: Step) -> Figure:
    """Membranes from the side at the left, stretch over time at the right."""
    drawn, (membranes, history) = plt.subplots(1, 2, figsize=(10, 3.9), width_ratios=(1, 1.15))
    membranes.set(xlim=(-1.75, 1.75), ylim=(-0.62, 2.75), aspect="equal")
    membranes.axis("off")
    draw_membrane(membranes, 2.25, 1.0, style.GREY, "0 V")
    draw_membrane(membranes, 1.2, below.stretch.max(), SWINGS, f"{below.voltage} V: swings", charges=7)
    draw_membrane(membranes, 0.2, SHOWN, SNAPS, f"{above.voltage} V: snaps", charges=13)

    history.plot(below.time, below.stretch, color=SWINGS, linewidth=2.5)
    inside = above.stretch <= SHOWN
    history.plot(above.time[inside], above.stretch[inside], color=SNAPS, linewidth=2.5)
    end = above.time[inside][-1], above.stretch[inside][-1]
    history.annotate(
        "", (end[0] + 0.25, end[1] + 0.35), end, arrowprops={"arrowstyle": "->", "color": SNAPS, "lw": 2.5}
    )
    history.text(end[0] + 0.8, 2.6, f"{above.voltage} V\nnothing holds it", color=SNAPS, weight="bold", va="center")
    history.text(22, 1.62, f"{below.voltage} V", color=SWINGS, weight="bold", ha="center")
    history.set(xlim=(0, 30), ylim=(0.9, 3.6), xlabel="time after the voltage is switched on, µs")
    history.set_ylabel("width over width at rest")
    return drawn


def draw_membrane(axes: Axes, height: float, stretch: float, colour: str, text: str, charges: int = 0) -> None:
    """A membrane from the side, incompressible, its thickness three times too large; the dashes are its rest."""
    thick = 0.3
    thin = thick / stretch**2
    electrode = 0.035
    axes.add_patch(Rectangle((-stretch / 2, height - thin / 2), stretch, thin, color=MEMBRANE, linewidth=0))
    for edge in (height - thin / 2 - electrode, height + thin / 2):
        axes.add_patch(Rectangle((-stretch / 2, edge), stretch, electrode, color=colour, linewidth=0))
    outline: dict[str, Any] = {"fill": False, "linestyle": (0, (4, 3)), "edgecolor": "#555555", "linewidth": 0.9}
    rest = (-0.5, height - thick / 2 - electrode)
    axes.add_patch(Rectangle(rest, 1.0, thick + 2 * electrode, **outline))
    for place in (np.arange(charges) + 0.5) / max(charges, 1) - 0.5:
        for sign, side in (("+", 1), ("−", -1)):
            offset = max(thin, thick) / 2 + electrode + 0.07
            axes.text(stretch * place, height + side * offset, sign, ha="center", va="center", fontsize=9)
    axes.text(-1.72, height + 0.42, text, color=colour if charges else "#555555", weight="bold", va="center")
