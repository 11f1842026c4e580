"""Two position controllers of the stretch. The actuator has no damping: it is theirs to supply.

A controller sees at each sampling instant what a sensor would tell, `Measured`, and answers with the voltage
that is held until the next. Neither is told a disturbance of the prestress.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm
from scipy.optimize import lsq_linear

from dielectric_actuator import Actuator
from quasi_static import squared_voltages

Target = Callable[[float], float]
"""The wanted stretch over time."""


@dataclass(frozen=True)
class Measured:
    """What a controller sees: the stretch, its rate, and the largest voltage that is safe now."""

    time: float
    stretch: float
    rate: float
    safe_voltage: float


class FeedForwardPID:
    """PID on φ², around the voltage that holds the target.

    φ² = φ²(target) + P e + I ∫e dt + D e',  e = target − λ. The square root afterwards makes the force
    linear in what the controller sets. The integral stands still while the voltage is at a bound.
    """

    P, I, D = 4.0, 0.3, 25.0  # noqa: E741  (the field's names)
    STRETCHES = np.linspace(0.95, 1.6, 66)

    def __init__(self, model: Actuator, scene: Mapping[str, float], target: Target, period: float):
        self._target, self._period = target, period
        self._curve = squared_voltages(model, scene, self.STRETCHES)
        self._integral = 0.0

    def voltage(self, measured: Measured) -> float:
        """The voltage to hold over the coming period."""
        wanted = self._target(measured.time)
        deviation = wanted - measured.stretch
        feed_forward = float(np.interp(wanted, self.STRETCHES, self._curve))
        integral = self._integral + self.I * self._period * deviation
        wanted_rate = (self._target(measured.time + self._period) - wanted) / self._period
        squared = feed_forward + self.P * deviation + integral + self.D * (wanted_rate - measured.rate)
        bounded = min(max(squared, 0.0), measured.safe_voltage**2)
        if bounded == squared:
            self._integral = integral
        return math.sqrt(bounded)


class Predictive:
    """Model-predictive control with the FMU as its model, a step of Gauss and Newton at each sample.

    From the measured state the model runs ahead under the last plan; the FMU's directional derivatives of λ''
    along that run say how the prediction changes with the plan, which is one φ² for each sample. A bounded
    least-squares problem gives the new plan: least deviation from the target over the horizon, with voltages
    that change little. Then the model is put back (fmi2SetFMUstate) and runs the new plan, and a plan that
    ends in pull-in is not used.

    The prestress is estimated: what the rate gained over the last sample beyond the prediction, divided by
    ∂λ''/∂S, is put to a change of S.
    """

    HORIZON = 30.0
    SMOOTHNESS = 0.02
    """Weight of a change of φ² from one sample to the next, beside that of the deviation."""
    GAIN = 0.5
    """Share of a deviation of the rate that the estimate takes over at once."""
    LEAST = 1e-6
    """Of φ² in a plan: at 0 the derivative by φ vanishes, and with it that by φ² could not be told."""

    def __init__(self, model: Actuator, scene: Mapping[str, float], target: Target, period: float):
        self._model, self._scene, self._target, self._period = model, dict(scene), target, period
        self._plan = np.full(max(2, math.ceil(self.HORIZON / period)), self.LEAST)
        self._prestress = scene["S"]
        self._predicted_rate: float | None = None

    def voltage(self, measured: Measured) -> float:
        """The voltage to hold over the coming period."""
        model = self._model
        # a bound below the least would leave nothing to choose
        most = max(measured.safe_voltage**2, 2 * self.LEAST)
        plan = np.clip(np.append(self._plan[1:], self._plan[-1]), self.LEAST, most)
        self._start(measured)
        with model.looking_ahead():
            stretches, influences = self._linearized(plan)
        improved = self._improved(measured.time, plan, most, stretches, influences)
        with model.looking_ahead():
            safe = self._survives(improved)
        # the last plan, bounded, is what was safe one sample before
        self._plan = improved if safe else plan
        voltage = math.sqrt(self._plan[0])
        model.set({"phi": voltage})
        model.advance(self._period)
        self._predicted_rate = model.get("lambda_dot")
        return voltage

    def _start(self, measured: Measured) -> None:
        """Put the model into the measured state, with what is now thought of the prestress."""
        start = {"lambda_start": measured.stretch, "lambda_dot_start": measured.rate, "S": self._prestress}
        self._model.start({**self._scene, **start}, start_time=measured.time)
        if self._predicted_rate is not None:
            (influence,) = self._model.directional_derivatives(["lambda_ddot"], "S")
            self._prestress += self.GAIN * (measured.rate - self._predicted_rate) / (influence * self._period)
            self._model.set({"S": self._prestress})

    def _linearized(self, plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Predicted stretches at the ends of the samples, and how each depends on each φ² of the plan."""
        model, count = self._model, len(plan)
        stretches = np.empty(count)
        rates = np.zeros((count, 3, 3))  # of stretch, stretch rate and φ², by each of them
        rates[:, 0, 1] = 1.0
        for k, squared in enumerate(plan):
            voltage = math.sqrt(squared)
            model.set({"phi": voltage})
            for column, known in enumerate(("lambda", "lambda_dot", "phi")):
                rates[k, 1, column] = model.directional_derivatives(["lambda_ddot"], known)[0]
            rates[k, 1, 2] /= 2 * voltage
            model.advance(self._period)
            stretches[k] = model.get("lambda")
        over_period = expm(rates * self._period)
        influences, effect = np.zeros((count, count)), np.zeros((2, count))  # of every φ² so far
        for k, transition in enumerate(over_period):
            effect = transition[:2, :2] @ effect
            effect[:, k] += transition[:2, 2]
            influences[k] = effect[0]
        return stretches, influences

    def _improved(
        self, time: float, plan: np.ndarray, most: float, stretches: np.ndarray, influences: np.ndarray
    ) -> np.ndarray:
        """The plan of φ² from `LEAST` to `most` with the least squares of deviations and changes."""
        times = time + self._period * np.arange(1, len(plan) + 1)
        deviations = np.array([self._target(end) for end in times]) - stretches
        # a change over a longer period is the same slope
        changes = self.SMOOTHNESS / self._period * np.diff(np.eye(len(plan)), axis=0)
        system = np.vstack([influences, changes])
        right = np.concatenate([deviations, -changes @ plan])
        step = lsq_linear(system, right, (self.LEAST - plan - 1e-12, most - plan + 1e-12), method="bvls").x
        return np.clip(plan + step, self.LEAST, most)

    def _survives(self, plan: np.ndarray) -> bool:
        for squared in plan:
            self._model.set({"phi": math.sqrt(squared)})
            self._model.advance(self._period)
        return not self._model.get("pulled_in")
