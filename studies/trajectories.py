"""The motion at the times of a multiprecision reference, reached by communication steps of any size."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import references
from dielectric_actuator import Actuator


class Worst(NamedTuple):
    """The largest difference of λ or dλ/dt from the reference: what it is, at which time, and both values."""

    quantity: str
    time: float
    exact: float
    measured: float

    @property
    def error(self) -> float:
        return abs(self.measured - self.exact)


def follow(actuator: Actuator, name: str, communication_step: float, tolerance: float | None) -> Worst:
    """Run the scene of the reference `name` and compare at each of its times.

    A communication step that does not divide the time to the next row ends in one shorter step.
    """
    rows = references.trajectory(name)
    actuator.start(references.TRAJECTORY_SCENES[name], tolerance=tolerance)
    worst = Worst("lambda", 0.0, 1.0, 1.0)
    for previous, row in itertools.pairwise(rows):
        span = row["t"] - previous["t"]
        whole_steps = int(span / communication_step + 1e-9)
        for _ in range(whole_steps):
            actuator.advance(communication_step)
        remainder = span - whole_steps * communication_step
        if remainder > 1e-9:
            actuator.advance(remainder)
        for quantity, exact in (("lambda", row["lam"]), ("lambda_dot", row["v"])):
            found = Worst(quantity, row["t"], exact, actuator.get(quantity))
            worst = max(worst, found, key=lambda candidate: (math.isnan(candidate.error), candidate.error))
    return worst
