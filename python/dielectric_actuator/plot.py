"""Plots of a response: history, phase portrait, pull-in margin (extra ``plot``).

Each function draws into the axes it is given; `overview` makes a figure of all three. Nothing is shown and no
backend is chosen: ``overview(response).savefig("out.png")``. With `Actuator.units` as `units`, the axes of a device in
SI units have them, with the prefix that fits.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""The colours of Okabe and Ito (2008) for colour-blind readers, without yellow, which is faint on white."""

NONDIMENSIONAL: Mapping[str, str] = {
    "time": r"time  $\bar{t}$",
    "lambda": r"stretch  $\lambda$",
    "lambda_dot": r"stretch rate  $\mathrm{d}\lambda/\mathrm{d}\bar{t}$",
    "lambda3": r"thickness stretch  $\lambda_3$",
    "lambda3_dot": r"thickness rate  $\mathrm{d}\lambda_3/\mathrm{d}\bar{t}$",
    "phi": r"voltage  $\bar{\phi}$",
    "pull_in_margin": "pull-in margin",
}
"""Axis labels of the nondimensional actuator; other names stand for themselves."""

IN_SI: Mapping[str, str] = {
    **NONDIMENSIONAL,
    "time": r"time  $t$",
    "lambda_dot": r"stretch rate  $\mathrm{d}\lambda/\mathrm{d}t$",
    **{
        name: name.replace("_", " ")
        for name in (
            "thickness", "edge_distance", "edge_displacement", "charge", "supply_current", "supply_voltage",
            "membrane_voltage", "electric_field", "breakdown_margin",
        )
    },
}  # fmt: skip
"""Axis labels of the device in SI units."""

PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}

OVERVIEW = ("lambda", "lambda_dot", "pull_in_margin", "pulled_in")
"""The outputs that `overview` needs."""

Units = Mapping[str, str]


class _Scale:
    """The numbers of one variable in the power of ten that suits a plot, and the label that says so."""

    def __init__(self, name: str, response: np.ndarray, units: Units, shared: Iterable[str] = ()):
        """`shared` names further variables; those with the same unit get the same power of ten."""
        values, unit = response[name], units.get(name, "")
        label = (IN_SI if units.get("time") else NONDIMENSIONAL).get(name, name)
        alike = [values, *(response[other] for other in shared if units.get(other, "") == unit)]
        finite = np.abs(np.concatenate([column[np.isfinite(column)] for column in alike]))
        largest = float(finite.max(initial=0.0))
        power = 3 * math.floor(math.log10(largest) / 3 + 1e-9) if unit and largest > 0 else 0
        power = min(max(power, min(PREFIXES)), max(PREFIXES))
        self.factor = 10.0**-power
        if unit.startswith("1/"):
            unit = (rf"$10^{{{power}}}$" if power else "1") + unit.removeprefix("1")
        else:
            unit = PREFIXES[power] + unit
        self.label = f"{label}  ({unit})" if unit else label
        self.values = values * self.factor


def history(axes: Any, response: np.ndarray, *names: str, units: Units | None = None) -> None:
    """Variables over time, the stretch if none is named; several share an axis, and should share a unit.

    After six the colours come again, dashed, then dotted.
    """
    names = names or ("lambda",)
    time = _Scale("time", response, units or {})
    for (style, colour), name in zip(itertools.cycle(itertools.product(("-", "--", ":"), COLOURS)), names):
        scale = _Scale(name, response, units or {}, names)
        axes.plot(time.values, scale.values, style, color=colour, label=scale.label)
    _decorate(axes, time.label, scale.label)
    if len(names) > 1:
        axes.set_ylabel("")
        axes.legend(frameon=False)
    axes.set_xlim(time.values[0], time.values[-1])


def phase_portrait(
    axes: Any,
    response: np.ndarray,
    position: str = "lambda",
    rate: str = "lambda_dot",
    *,
    units: Units | None = None,
) -> None:
    """Rate over position, a dot at the start; up to the pull-in, where the actuator is stopped."""
    if "pulled_in" in (response.dtype.names or ()):
        response = response[~response["pulled_in"].astype(bool)]
    across, along = (_Scale(name, response, units or {}) for name in (position, rate))
    _decorate(axes, across.label, along.label)
    if not len(response):  # pulled in at the start
        return
    axes.plot(across.values, along.values, color=COLOURS[0])
    axes.plot(across.values[0], along.values[0], "o", color=COLOURS[1], markersize=5)
    axes.annotate("start", (across.values[0], along.values[0]), (6, 5), textcoords="offset points", color=COLOURS[1])


def pull_in_margin(axes: Any, response: np.ndarray, *, units: Units | None = None) -> None:
    """By how much the voltage may grow until dynamic pull-in from rest, over time; below 0 it is lost."""
    time, margin = (_Scale(name, response, units or {}) for name in ("time", "pull_in_margin"))
    _decorate(axes, time.label, margin.label)
    axes.set_xlim(time.values[0], time.values[-1])
    if not np.isfinite(margin.values).any():
        axes.text(0.5, 0.5, "no pull-in at any voltage", ha="center", va="center", transform=axes.transAxes)
        axes.set_yticks([])
        return
    axes.plot(time.values, margin.values, color=COLOURS[2])
    axes.axhline(0, color=COLOURS[1], linestyle="--", linewidth=1.2)
    lowest, highest = axes.get_ylim()
    reach = max(abs(lowest), abs(highest))
    axes.set_ylim(min(lowest, -0.1 * reach), max(highest, 0.1 * reach))
    axes.axhspan(axes.get_ylim()[0], 0, color=COLOURS[1], alpha=0.08, linewidth=0)


def overview(response: np.ndarray, title: str = "", *, units: Units | None = None) -> Any:
    """A figure of history, pull-in margin and phase portrait; `response` has the fields `OVERVIEW`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 4.6), layout="constrained", dpi=150)
    panels: dict[str, Any] = figure.subplot_mosaic(
        [["history", "portrait"], ["margin", "portrait"]], height_ratios=(2, 1)
    )
    above, below = panels["history"], panels["margin"]
    history(above, response, units=units)
    above.set_xlabel("")
    above.tick_params(labelbottom=False)
    pull_in_margin(below, response, units=units)
    phase_portrait(panels["portrait"], response, units=units)
    if response["pulled_in"][-1]:
        first = int(np.argmax(response["pulled_in"]))
        when = _Scale("time", response, units or {}).values[first]
        above.axvline(when, color=COLOURS[1], linestyle="--", linewidth=1.2)
        above.annotate("pull-in ", (when, above.get_ylim()[1]), ha="right", va="top", color=COLOURS[1])
    if title:
        figure.suptitle(title)
    return figure


def _decorate(axes: Any, horizontal: str, vertical: str) -> None:
    axes.set_xlabel(horizontal)
    axes.set_ylabel(vertical)
    axes.grid(color="#e3e3e3", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
