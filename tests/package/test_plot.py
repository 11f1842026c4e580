"""Plots of a response, by what is drawn into the axes."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from dielectric_actuator import plot

UNITS = {"time": "s", "thickness": "m", "edge_distance": "m", "voltage": "V"}
RESPONSE = np.array(
    [(0.0, 1e-6, 1e-4, 600.0), (1e-5, 9e-7, 1.05e-4, 600.0)],
    dtype=[("time", "f8"), ("thickness", "f8"), ("edge_distance", "f8"), ("voltage", "f8")],
)


def test_lengths_on_one_axis_have_one_prefix():
    axes = Figure().subplots()
    plot.history(axes, RESPONSE, "thickness", "edge_distance", "voltage", units=UNITS)
    thickness, distance, voltage = (line.get_ydata()[0] for line in axes.lines)
    assert (thickness, distance, voltage) == pytest.approx((1.0, 100.0, 600.0))
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["thickness  (µm)", "edge distance  (µm)", "voltage  (V)"]


def test_every_variable_is_drawn_and_told_apart():
    names = [f"x{k}" for k in range(14)]
    response = np.zeros(2, dtype=[(name, "f8") for name in ["time", *names]])
    response["time"] = [0.0, 1.0]
    axes = Figure().subplots()
    plot.history(axes, response, *names)
    assert len({(line.get_linestyle(), line.get_color()) for line in axes.lines}) == 14


def test_an_actuator_that_is_pulled_in_at_the_start_is_drawn():
    response = np.zeros(2, dtype=[(name, "f8") for name in ("time", "lambda", "lambda_dot", "pull_in_margin")]
    + [("pulled_in", "?")])  # fmt: skip
    response["time"], response["pulled_in"] = [0.0, 1.0], True
    figure = plot.overview(response)
    (portrait,) = (axes for axes in figure.axes if axes.get_label() == "portrait")
    assert not portrait.lines and portrait.get_ylabel()
