"""Where an actuator rests in equilibrium, found from its FMU's acceleration at rest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .actuator import Actuator

BRANCHES = ("xi1", "xi2", "xi3")
"""Stretches of the dashpots of a lossy material; relaxed, each is the stretch of the actuator."""
CURRENT = 2
"""Value of ``source`` of a device whose source gives a current."""


def find(actuator: Actuator, values: Mapping[str, float], start_time: float) -> float:
    """`Actuator.equilibrium`."""
    _refuse(values)
    # what flows through a series resistance is 0 at rest
    held = {**values, "R_s": 0.0} if "R_s" in actuator.variables else dict(values)
    relaxing = [name for name in BRANCHES if name in actuator.variables]

    def start(stretch: float) -> None:
        actuator.start({**held, **_rest(actuator, stretch)}, start_time=start_time)

    def acceleration(stretch: float) -> float:
        start(stretch)
        return float(actuator.get("lambda_ddot"))

    def slope(stretch: float) -> float:
        start(stretch)
        return sum(actuator.directional_derivatives(["lambda_ddot"], name)[0] for name in ("lambda", *relaxing))

    start(1.0)
    lowest, highest = _reachable(actuator)
    below = math.nextafter(lowest, highest)
    if acceleration(below) <= 0:
        raise ValueError(
            f"there is no equilibrium above the stretch {lowest:g}: the actuator is pressed together there; let "
            "lambda_min be smaller, or the prestress larger"
        )
    falling = slope(below) <= 0
    for above in map(float, np.geomspace(lowest, highest, 200)[1:-1]):
        if acceleration(above) > 0:
            was_falling, falling = falling, slope(above) <= 0
            if was_falling and not falling:
                # close to pull-in, two equilibria may lie between: the acceleration is least there
                least = _bisected(lambda stretch: slope(stretch) > 0, below, above)
                if acceleration(least) <= 0:
                    above = least
        if acceleration(above) <= 0:
            return _bisected(lambda stretch: acceleration(stretch) <= 0, below, above)
        below = above
    threshold = next(name for name in ("phi_pull_in_static", "V_pull_in_static") if name in actuator.variables)
    unit = actuator.units[threshold]
    raise ValueError(
        f"there is no equilibrium between the stretches {lowest:g} and {highest:g}: the static pull-in voltage is "
        f"{actuator.get(threshold):.6g}{f' {unit}' if unit else ''}"
    )


def at_rest(actuator: Actuator, values: Mapping[str, float], stretch: float, start_time: float) -> dict[str, float]:
    """The start values of an actuator that rests at a stretch under `values`: dashpots and charge with it."""
    found = _rest(actuator, stretch)
    if values.get("R_s", 0.0) > 0:
        actuator.start({**values, **found, "R_s": 0.0}, start_time=start_time)
        found["charge_start"] = actuator.get("charge")
    return found


def _rest(actuator: Actuator, stretch: float) -> dict[str, float]:
    relaxed = {f"{name}_start": stretch for name in BRANCHES if name in actuator.variables}
    return {"lambda_start": stretch, "lambda_dot_start": 0.0, **relaxed}


def _reachable(actuator: Actuator) -> tuple[float, float]:
    """The stretches between which it may be: its limits, or where a Gent material locks."""
    lowest, highest = actuator.get("lambda_min", "lambda_max")
    gent = actuator.get("J_m") if "J_m" in actuator.variables else 0.0
    if gent == 0:
        return lowest, highest

    def locked(stretch: float) -> bool:
        return 2 * stretch**2 + stretch**-4 - 3 >= gent

    if locked(lowest):
        lowest = _bisected(lambda stretch: not locked(stretch), lowest, 1.0) * (1 + 1e-9)
    if locked(highest):
        highest = _bisected(locked, 1.0, highest) * (1 - 1e-9)
    return lowest, highest


def _refuse(values: Mapping[str, float]) -> None:
    if CURRENT in (values.get("source"), values.get("source_number")):
        raise ValueError("a source of current holds no actuator at rest: its charge grows")
    if values.get("R_s", 0.0) > 0 and (values.get("G_p", 0.0) > 0 or values.get("sigma", 0.0) > 0):
        raise ValueError("a leak behind R_s takes voltage from the actuator: no start at equilibrium is offered")


def _bisected(beyond: Callable[[float], bool], below: float, above: float) -> float:
    """The smallest number, to the last bit, from which on `beyond` is true; it is at `above`, not at `below`."""
    while below < (middle := (below + above) / 2) < above:
        below, above = (below, middle) if beyond(middle) else (middle, above)
    return above
