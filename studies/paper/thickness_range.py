"""Smallest and largest thickness stretch of a run: the one place that knows how extremes are found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import turning_points
from actuator_fmu import ActuatorFmu, Scene

SAMPLING = 0.5
"""Distance of the samples between which extremes are located."""


def ranges(actuator: ActuatorFmu, scene: Scene, windows: Sequence[float], tolerance: float) -> list[tuple[float, float]]:
    """λ₃ lowest and highest over [0, t] for each t of the growing `windows`, in one run."""
    response = actuator.run(
        scene,
        stop_time=windows[-1],
        communication_step=SAMPLING,
        outputs=turning_points.OUTPUTS,
        tolerance=tolerance,
    )
    found = []
    for window in windows:
        within = response[response["time"] <= window * (1 + 1e-12)]
        smallest, largest = turning_points.stretch_range(within)
        found.append((largest**-2, smallest**-2))
    return found


def amplitudes(actuator: ActuatorFmu, scene: Scene, windows: Sequence[float], tolerance: float) -> np.ndarray:
    """The paper's λ₃ᵃ, half the range of λ₃, over each window."""
    return np.array([(highest - lowest) / 2 for lowest, highest in ranges(actuator, scene, windows, tolerance)])
