"""The closed loop: the FMU as the plant, stepped from one sampling instant to the next."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from controllers import Measured, Target
from dielectric_actuator import Actuator

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
    silence: tuple[float, float] = (math.inf, math.inf)
    """From when to when the controller does not act and its last voltage stays."""


@dataclass(frozen=True)
class Run:
    """Rows of one closed loop: time, stretch, voltage, safe voltage, target; and seconds of processor time
    for each control step."""

    rows: np.ndarray
    seconds: np.ndarray
    pulled_in: bool

    @property
    def ended_by(self) -> int:
        """A whole time by which the run had ended: the last row is a sampling period before a collapse."""
        times = self.rows["time"]
        return math.ceil(times[-1] + (times[1] - times[0] if self.pulled_in else 0.0))

    def deviation(self, start_time: float) -> float:
        """Root mean square of target − λ from `start_time` on."""
        rows = self.rows[self.rows["time"] >= start_time]
        return float(np.sqrt(np.mean((rows["target"] - rows["stretch"]) ** 2)))


def close_loop(
    plant: Actuator, model: Actuator, kind: type, scenario: Scenario, *, period: float, guarded: bool = True
) -> Run:
    """Run a controller of the given kind with the given sampling period.

    `model` is the instance that it may look ahead with. A guarded controller is told the largest safe voltage,
    `RESERVE` below the threshold that ``pull_in_margin`` speaks of; an unguarded one may use 1.
    """
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
        if not scenario.silence[0] <= now < scenario.silence[1]:
            begin = time.process_time()
            voltage = controller.voltage(Measured(now, stretch, rate, safe))
            seconds.append(time.process_time() - begin)
            plant.set({"phi": voltage})
        for row in range(rows_a_sample):
            plant.time = now + row * period / rows_a_sample
            rows.append((plant.time, plant.get("lambda"), voltage, safe, scenario.target(plant.time)))
            if not plant.advance(period / rows_a_sample):
                raise RuntimeError(plant.messages[-1].text)
        if plant.get("pulled_in"):
            break
    names = ("time", "stretch", "voltage", "safe_voltage", "target")
    return Run(np.array(rows, dtype=[(name, float) for name in names]), np.array(seconds), bool(plant.get("pulled_in")))
