"""The closed loop: the FMU as the plant, stepped from one sampling instant to the next."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from actuator_fmu import ActuatorFmu
from controllers import Measured, Target

SCENE = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.0, "S": 0.2}
"""An actuator that rests at λ = 1 without voltage, and that pull-in destroys."""

RESERVE = 0.02
"""How far below the dynamic pull-in voltage a guarded controller must stay."""

ROW = 0.5
"""Largest time between recorded rows; more than one a sample where samples are far apart."""


@dataclass(frozen=True)
class Scenario:
    """What is asked for, and what disturbs: both over time."""

    target: Target
    prestress: Callable[[float], float]
    stop_time: float


@dataclass(frozen=True)
class Run:
    """Rows of one closed loop: time, stretch, voltage, safe voltage, target; and seconds for each control step."""

    rows: np.ndarray
    seconds: np.ndarray
    pulled_in: bool

    @property
    def deviation(self) -> float:
        """Root mean square of target − λ."""
        return float(np.sqrt(np.mean((self.rows["target"] - self.rows["stretch"]) ** 2)))


def close_loop(plant: ActuatorFmu, model: ActuatorFmu, kind: type, scenario: Scenario, *, period: float, guarded: bool = True) -> Run:
    """Run a controller of the given kind with the given sampling period; `model` is the one it may look ahead with."""
    controller = kind(model, SCENE, scenario.target, period)
    plant.start({**SCENE, "S": scenario.prestress(0.0)})
    rows_a_sample = max(1, math.ceil(period / ROW))
    rows, seconds = [], []
    for sample in range(round(scenario.stop_time / period)):
        now = sample * period
        # S is held over a sample, as the voltage is
        plant.set({"S": scenario.prestress(now)})
        stretch, rate, voltage, margin = plant.get("lambda", "lambda_dot", "phi", "pull_in_margin")
        safe = max(voltage + margin - RESERVE, 0.0) if guarded else 1.0
        begin = time.perf_counter()
        command = controller.voltage(Measured(now, stretch, rate, safe))
        seconds.append(time.perf_counter() - begin)
        plant.set({"phi": command})
        for row in range(rows_a_sample):
            plant.time = now + row * period / rows_a_sample
            rows.append((plant.time, plant.get("lambda"), command, safe, scenario.target(plant.time)))
            plant.advance(period / rows_a_sample)
        if plant.get("pulled_in"):
            break
    names = ("time", "stretch", "voltage", "safe_voltage", "target")
    return Run(np.array(rows, dtype=[(name, float) for name in names]), np.array(seconds), bool(plant.get("pulled_in")))
