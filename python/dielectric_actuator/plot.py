"""Plots of a response: history, phase portrait, pull-in margin (extra ``plot``).

Each function draws into the axes it is given; `overview` makes a figure of all three. Nothing is shown and no
backend is chosen: ``overview(response).savefig("out.png")``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Those of Okabe and Ito (2008), which survive colour blindness, without the yellow that vanishes on white paper."""

LABELS: Mapping[str, str] = {
    "time": r"time  $\bar{t}$",
    "lambda": r"stretch  $\lambda$",
    "lambda_dot": r"stretch rate  $\mathrm{d}\lambda/\mathrm{d}\bar{t}$",
    "lambda3": r"thickness stretch  $\lambda_3$",
    "lambda3_dot": r"thickness rate  $\mathrm{d}\lambda_3/\mathrm{d}\bar{t}$",
    "phi": r"voltage  $\bar{\phi}$",
    "pull_in_margin": "pull-in margin",
}
"""Axis labels of the nondimensional actuator; other names stand for themselves."""

OVERVIEW = ("lambda", "lambda_dot", "pull_in_margin", "pulled_in")
"""The outputs that `overview` needs."""


def history(axes: Any, response: np.ndarray, *names: str) -> None:
    """Variables over time, the stretch if none is named."""
    names = names or ("lambda",)
    for colour, name in zip(COLOURS, names):
        axes.plot(response["time"], response[name], color=colour, label=LABELS.get(name, name))
    _decorate(axes, "time", names[0])
    if len(names) > 1:
        axes.set_ylabel("")
        axes.legend(frameon=False)
    axes.set_xlim(response["time"][0], response["time"][-1])


def phase_portrait(axes: Any, response: np.ndarray, position: str = "lambda", rate: str = "lambda_dot") -> None:
    """Rate over position, a dot at the start; up to the pull-in, where the actuator is stopped."""
    if "pulled_in" in (response.dtype.names or ()):
        response = response[~response["pulled_in"].astype(bool)]
    axes.plot(response[position], response[rate], color=COLOURS[0])
    axes.plot(response[position][0], response[rate][0], "o", color=COLOURS[1], markersize=5, label="start")
    _decorate(axes, position, rate)
    axes.legend(frameon=False)


def pull_in_margin(axes: Any, response: np.ndarray) -> None:
    """By how much the voltage may grow until dynamic pull-in from rest, over time; below 0 it is lost."""
    margin = response["pull_in_margin"]
    _decorate(axes, "time", "pull_in_margin")
    axes.set_xlim(response["time"][0], response["time"][-1])
    if not np.isfinite(margin).any():
        axes.text(0.5, 0.5, "no pull-in at any voltage", ha="center", va="center", transform=axes.transAxes)
        axes.set_yticks([])
        return
    axes.plot(response["time"], margin, color=COLOURS[2])
    axes.axhline(0, color=COLOURS[1], linestyle="--", linewidth=1.2)
    lowest, highest = axes.get_ylim()
    axes.axhspan(-10 * abs(lowest), 0, color=COLOURS[1], alpha=0.08, linewidth=0)
    reach = max(abs(lowest), abs(highest))
    axes.set_ylim(min(lowest, -0.1 * reach), max(highest, 0.1 * reach))


def overview(response: np.ndarray, title: str = "") -> Any:
    """A figure of history, pull-in margin and phase portrait; `response` has the fields `OVERVIEW`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 4.6), layout="constrained", dpi=150)
    panels: dict[str, Any] = figure.subplot_mosaic(
        [["history", "portrait"], ["margin", "portrait"]], height_ratios=(2, 1)
    )
    above, below = panels["history"], panels["margin"]
    history(above, response)
    above.set_xlabel("")
    above.tick_params(labelbottom=False)
    pull_in_margin(below, response)
    phase_portrait(panels["portrait"], response)
    if response["pulled_in"][-1]:
        first = int(np.argmax(response["pulled_in"]))
        above.axvline(response["time"][first], color=COLOURS[1], linestyle="--", linewidth=1.2)
        above.annotate(
            "pull-in ",
            (response["time"][first], above.get_ylim()[1]),
            ha="right",
            va="top",
            color=COLOURS[1],
        )
    if title:
        figure.suptitle(title)
    return figure


def _decorate(axes: Any, horizontal: str, vertical: str) -> None:
    axes.set_xlabel(LABELS.get(horizontal, horizontal))
    axes.set_ylabel(LABELS.get(vertical, vertical))
    axes.grid(color="#e3e3e3", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
