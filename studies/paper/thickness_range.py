"""Smallest and largest thickness stretch of a run, from the extremes that the FMU records."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dielectric_actuator import Actuator, Scene


def ranges(actuator: Actuator, scene: Scene, windows: Sequence[float], tolerance: float) -> list[tuple[float, float]]:
    """λ₃ lowest and highest over [0, t] for each t of the growing `windows`; one communication step each."""
    actuator.start({**scene, "record_extremes": True}, tolerance=tolerance)
    found = []
    for window in windows:
        actuator.advance(window - actuator.time)
        found.append(tuple(actuator.get("lambda3_lowest", "lambda3_highest")))
    return found


def amplitudes(actuator: Actuator, scene: Scene, windows: Sequence[float], tolerance: float) -> np.ndarray:
    """The paper's λ₃ᵃ, half the range of λ₃, over each window."""
    return np.array([(highest - lowest) / 2 for lowest, highest in ranges(actuator, scene, windows, tolerance)])
