"""The quasi-static voltage curve: which voltage holds a stretch in equilibrium.

The force of the voltage goes with φ², and so does the acceleration λ'' at rest. Two readings of it, without
voltage and with φ = 1, give the φ² at which it vanishes: the FMU itself is the curve, at any parameters.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dielectric_actuator import Actuator


def squared_voltages(actuator: Actuator, scene: Mapping[str, float], stretches: np.ndarray) -> np.ndarray:
    """φ² that holds each stretch in equilibrium; negative where no voltage does."""
    accelerations = np.empty((2, len(stretches)))
    for row, voltage in enumerate((0.0, 1.0)):
        for column, stretch in enumerate(stretches):
            actuator.start({**scene, "lambda_start": stretch, "phi": voltage})
            accelerations[row, column] = actuator.get("lambda_ddot")
    return -accelerations[0] / (accelerations[1] - accelerations[0])
