"""The figures drawn from responses of the actuator. Nothing here runs the FMU.

A response is the structured array that `Actuator.run` returns, with λ₃, its rate and what
`turning_points` needs.
"""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import figure_style as style
from turning_points import turning_points


@dataclass(frozen=True)
class Oscillation:
    """A periodic response to one value of the varied parameter, with the exact period and turning point."""

    value: float
    response: np.ndarray
    exact_period: float
    exact_lambda3: float


@dataclass(frozen=True)
class Transition:
    """Responses just below and just above one pull-in voltage, and the thickness stretch of the saddle.

    The responses hold `pulled_in` too.
    """

    value: float
    below: np.ndarray
    above: np.ndarray
    lambda3_pull_in: float


def dc_responses(families: dict[str, list[Oscillation]], *, title: str) -> Figure:
    """Time histories (left) and phase portraits (right), one row a surface parameter, as in the paper's
    Figs. 2 and 3. Dots mark the exact turning points."""
    figure, rows = plt.subplots(len(families), 2, figsize=(10, 3.1 * len(families)), squeeze=False)
    for letter, (parameter, oscillations), (history, portrait) in zip("abc", families.items(), rows):
        for index, oscillation in enumerate(oscillations):
            response, look = oscillation.response, style.curve(index)
            name = style.setting(**{parameter: oscillation.value})
            history.plot(response["time"], response["lambda3"], label=name, **look)
            loop = _first_loop(response)
            portrait.plot(loop["lambda3"], loop["lambda3_dot"], **look)
            history.plot(oscillation.exact_period / 2, oscillation.exact_lambda3, **style.EXACT)
            portrait.plot(oscillation.exact_lambda3, 0, **style.EXACT)
        history.plot([], [], label="exact", **style.EXACT)
        style.label(history, "time", "lambda3")
        style.label(portrait, "lambda3", "lambda3_dot")
        history.set_xlim(0, oscillations[0].response["time"][-1])
        history.set_title(f"({letter})  {style.NAMES[parameter]}", loc="left")
        portrait.legend(*history.get_legend_handles_labels(), **style.BESIDE)
    figure.suptitle(title)
    return figure


BELOW = (0.0, ())
ABOVE = (0.0, (3, 1.5))
"""Line styles of the two sides of a pull-in voltage."""


def pull_in_transitions(families: dict[str, list[Transition]], *, distance: float, title: str) -> Figure:
    """Response just below (solid) and just above (dashed) each pull-in voltage, one row a surface parameter.

    Crosses in the phase portraits mark the saddle that the two motions pass on different sides, dots the
    collapse where the response above has ended.
    """
    figure, rows = plt.subplots(len(families), 2, figsize=(10.5, 3.4 * len(families)), squeeze=False)
    for letter, (parameter, transitions), (history, portrait) in zip("abc", families.items(), rows):
        transition_histories(history, transitions)
        transition_portraits(portrait, transitions)
        history.set_title(f"({letter})  {style.NAMES[parameter]}", loc="left")
        handles = [*transition_handles(parameter, transitions, distance), COLLAPSE, SADDLE]
        portrait.legend(handles=handles, **style.BESIDE)
    figure.suptitle(title)
    return figure


def transition_histories(axes: Axes, transitions: list[Transition]) -> None:
    """Time histories at both sides of each pull-in voltage (the paper's Fig. 6)."""
    span = transitions[0].below["time"][-1]
    for colour, transition in zip(style.COLOURS, transitions):
        for response, line in ((transition.below, BELOW), (transition.above, ABOVE)):
            axes.plot(response["time"], response["lambda3"], color=colour, linestyle=line)
        end = transition.above[-1]
        if end["time"] < span:
            axes.plot(end["time"], end["lambda3"], "o", color=colour, markersize=4, clip_on=False)
    style.label(axes, "time", "lambda3")
    axes.set(xlim=(0, span), ylim=(0, 1.03))


def transition_portraits(axes: Axes, transitions: list[Transition]) -> None:
    """Phase portraits at both sides of each pull-in voltage (the paper's Fig. 7), with the saddles."""
    for colour, transition in zip(style.COLOURS, transitions):
        for response, line in ((transition.below, BELOW), (transition.above, ABOVE)):
            # at the collapse the actuator is stopped, which would draw a jump of the rate to 0
            loop = _first_loop(response[~response["pulled_in"]])
            axes.plot(loop["lambda3"], loop["lambda3_dot"], color=colour, linestyle=line)
        axes.plot(transition.lambda3_pull_in, 0, "x", color=style.BLACK, markersize=7, zorder=5)
    style.label(axes, "lambda3", "lambda3_dot")
    axes.set_xlim(0, 1.03)


def transition_handles(parameter: str, transitions: list[Transition], distance: float) -> list[Line2D]:
    """What the colours and lines of the two functions above mean, for a legend."""
    voltage = style.SYMBOLS["phi_pull_in"]
    colours = [
        Line2D([], [], color=colour, label=style.setting(**{parameter: transition.value}))
        for colour, transition in zip(style.COLOURS, transitions)
    ]
    return [
        *colours,
        Line2D([], [], color=style.GREY, linestyle=BELOW, label=f"{voltage} $-$ {distance:g}"),
        Line2D([], [], color=style.GREY, linestyle=ABOVE, label=f"{voltage} + {distance:g}"),
    ]


COLLAPSE = Line2D([], [], color=style.GREY, marker="o", markersize=4, linestyle="", label="collapse")
SADDLE = Line2D([], [], color=style.BLACK, marker="x", linestyle="", label=f"saddle {style.SYMBOLS['lambda3_pull_in']}")
"""What the marks in the histories and in the phase portraits mean."""


def driven_response(response: np.ndarray, section: np.ndarray, *, amplitude: float, title: str) -> Figure:
    """Time history, phase portrait and Poincaré section of one harmonically driven run.

    `section` holds the states once a forcing period; `amplitude` is half the range of λ₃ over `response`.
    """
    figure, panels = plt.subplot_mosaic([["history", "history"], ["portrait", "section"]], figsize=(10, 8))
    history, portrait, points = panels["history"], panels["portrait"], panels["section"]

    history.plot(response["time"], response["lambda3"], color=style.COLOURS[0], linewidth=0.9)
    highest = response["lambda3"].max()
    for level in (highest, highest - 2 * amplitude):
        history.axhline(level, color=style.COLOURS[1], linestyle="--", linewidth=1.2)
    history.text(
        1.005,
        highest - amplitude,
        rf"$2\lambda_3^a$ = {2 * amplitude:.4f}",
        transform=history.get_yaxis_transform(),
        rotation=90,
        va="center",
        color=style.COLOURS[1],
    )
    style.label(history, "time", "lambda3")
    history.set_xlim(0, response["time"][-1])
    history.set_title("(a)  time history", loc="left")

    portrait.plot(response["lambda3"], response["lambda3_dot"], color=style.COLOURS[0], linewidth=0.4)
    style.label(portrait, "lambda3", "lambda3_dot")
    portrait.set_title("(b)  phase portrait", loc="left")

    points.plot(section["lambda3"], section["lambda3_dot"], ".", color=style.COLOURS[1], markersize=1.5)
    style.label(points, "lambda3", "lambda3_dot")
    points.set_title(r"(c)  Poincaré section at $k\,\pi/\bar{\omega}$", loc="left")
    reach = rf"{len(section)} points, {style.SYMBOLS['time']} $\leq$ {section['time'][-1]:.0f}"
    points.text(0.6, 0.5, reach, transform=points.transAxes, ha="center", va="center", fontsize=9)
    figure.suptitle(title)
    return figure


def _first_loop(response: np.ndarray) -> np.ndarray:
    """The response up to its second turning point: drawn over itself, a dashed loop looks solid."""
    turns, _ = turning_points(response)
    return response if len(turns) < 2 else response[response["time"] <= turns[1]]
