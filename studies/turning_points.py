"""Turning points, period and range of a sampled motion, far more exactly than its samples.

Between two communication points the stretch is the quintic polynomial through λ, dλ/dt and d²λ/dt² at
both ends. Its rate is wrong by about h⁵ λ⁽⁶⁾/20000, so that with a step of a 200th of the period turning
times come out to 1e-12 of the period and turning stretches to rounding.
"""

from __future__ import annotations

import numpy as np

OUTPUTS = ("lambda", "lambda_dot", "lambda_ddot")
"""What a response must hold for the functions below."""


def turning_points(response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and stretches at which the stretch rate changes sign, in order; the start is not one of them."""
    rate = response["lambda_dot"]
    before, after = rate[:-1], rate[1:]
    left = np.flatnonzero((before != 0) & ((before * after < 0) | (after == 0)))
    right = left + 1
    step = response["time"][right] - response["time"][left]

    stretch_0, stretch_1 = response["lambda"][left], response["lambda"][right]
    rise = stretch_1 - stretch_0
    rate_0, rate_1 = step * rate[left], step * rate[right]
    bend_0 = step**2 * response["lambda_ddot"][left]
    bend_1 = step**2 * response["lambda_ddot"][right]
    quintic = [
        stretch_0,
        rate_0,
        bend_0 / 2,
        10 * rise - 6 * rate_0 - 4 * rate_1 - 1.5 * bend_0 + 0.5 * bend_1,
        -15 * rise + 8 * rate_0 + 7 * rate_1 + 1.5 * bend_0 - bend_1,
        6 * rise - 3 * rate_0 - 3 * rate_1 - 0.5 * bend_0 + 0.5 * bend_1,
    ]
    slope = [k * quintic[k] for k in range(1, 6)]
    curvature = [k * slope[k] for k in range(1, 5)]

    position = rate_0 / (rate_0 - rate_1)
    # Newton from the secant's root; the rate is nearly linear over a step, so three rounds reach rounding
    for _ in range(4):
        position = position - _polynomial(slope, position) / _polynomial(curvature, position)
    return response["time"][left] + position * step, _polynomial(quintic, position)


def period_and_overshoot(response: np.ndarray) -> tuple[float, float]:
    """Period of a periodic motion that starts from rest, and the stretch where it first turns.

    Raises ValueError if the response does not reach the end of the first period.
    """
    times, stretches = turning_points(response)
    if len(times) < 2:
        raise ValueError(f"no full period up to t = {response['time'][-1]:g}: {len(times)} turning point(s)")
    return float(times[1] - response["time"][0]), float(stretches[0])


def stretch_range(response: np.ndarray) -> tuple[float, float]:
    """Smallest and largest stretch over the whole window, its ends included."""
    _, stretches = turning_points(response)
    ends = response["lambda"][[0, -1]]
    reached = np.concatenate([ends, stretches])
    return float(reached.min()), float(reached.max())


def thickness_amplitude(response: np.ndarray) -> float:
    """Half the range of the thickness stretch λ₃ = 1/λ² over the window (the paper's λ₃ᵃ, Section 3.2)."""
    smallest, largest = stretch_range(response)
    return (smallest**-2 - largest**-2) / 2


def _polynomial(coefficients: list[np.ndarray], position: np.ndarray) -> np.ndarray:
    value = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * position + coefficient
    return value
