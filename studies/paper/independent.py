"""Driven motion without the FMU: SciPy on Eq. 16 as printed, many runs at once, with exact variational equations.

Chaos is told from order by how a small deviation δ grows. With the rate of growth r = d ln|δ| / dt

* the largest Lyapunov exponent is the mean of r over [0, t] for t → ∞. On a torus δ grows like t, so that the
  mean falls like ln t / t; in chaos it tends to a positive number.
* MEGNO (Cincotta and Simó 2000) is the time average of (2/t) ∫ r s ds. It tends to 2 on a torus and grows like
  exponent · t / 2 in chaos, and decides much earlier.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

import turning_points
from paper.equation import Cases
from paper.scenes import C
from references import SurfaceEffects

RTOL, ATOL = 1e-12, 1e-13
ODE45_RTOL, ODE45_ATOL = 1e-3, 1e-6
"""Default tolerances of MATLAB's ode45, the solver that the paper used; it prints no tolerances."""


@dataclass(frozen=True)
class DrivenRuns:
    """Runs from rest under φ = `phi_ac` sin(`omega` t), all of the same length; one case and one ω each."""

    cases: list[SurfaceEffects]
    omega: np.ndarray
    phi_ac: np.ndarray | float

    def voltage_squared(self, time: float) -> np.ndarray:
        return (self.phi_ac * np.sin(self.omega * time)) ** 2

    def amplitudes(self, window: float) -> np.ndarray:
        """Half the range of λ₃ over [0, `window`], by DOP853 with every extreme located."""
        equation = Cases.of(self.cases, C)
        count = len(self.cases)

        def slope(time, state):
            stretch, rate = state[:count], state[count:]
            return np.concatenate([rate, equation.acceleration(stretch, rate, self.voltage_squared(time))])

        times = np.linspace(0, window, round(window / 0.25) + 1)
        start = np.repeat([1.0, 0.0], count)
        solution = solve_ivp(slope, (0, window), start, "DOP853", times, rtol=RTOL, atol=ATOL)
        found = np.empty(count)
        names = ("time", *turning_points.OUTPUTS)
        for k, case in enumerate(self.cases):
            response = np.empty(len(times), dtype=[(name, float) for name in names])
            stretch, rate = solution.y[k], solution.y[count + k]
            voltage_squared = (np.broadcast_to(self.phi_ac, count)[k] * np.sin(self.omega[k] * times)) ** 2
            bend = Cases.of([case], C).acceleration(stretch, rate, voltage_squared)
            for name, values in zip(names, (times, stretch, rate, bend)):
                response[name] = values
            found[k] = turning_points.thickness_amplitude(response)
        return found

    def indicators(self, times: np.ndarray) -> Indicators:
        """Growth of deviations up to each of the `times`, by DOP853 on the variational equations.

        The deviation is held as direction and logarithm of its length, which never overflow. Its two components
        are δλ and δλ' in units of the natural frequency, so that it turns evenly.
        """
        equation = Cases.of(self.cases, C)
        count = len(self.cases)
        unit = np.sqrt(6 / C)

        def slope(time, state):
            stretch, rate, angle, _, integral, _ = state.reshape(6, count)
            acceleration, by_stretch, by_rate = equation.linearised(stretch, rate, self.voltage_squared(time))
            cosine, sine = np.cos(angle), np.sin(angle)
            # with the Jacobian ((0, unit), (by_stretch/unit, by_rate))
            push = by_stretch / unit * cosine + by_rate * sine
            growth = unit * cosine * sine + push * sine
            turn = push * cosine - unit * sine * sine
            # the last row is the integral of 2 t' growth; its mean over t is Y, whose mean is MEGNO
            weighted = 2 * time * growth
            mean = integral / max(time, 1e-9)
            return np.concatenate([rate, acceleration, turn, growth, weighted, mean])

        start = np.repeat([1.0, 0.0, 0.3, 0.0, 0.0, 0.0], count)
        solution = solve_ivp(slope, (0, times[-1]), start, "DOP853", times, rtol=RTOL, atol=ATOL)
        stretch, rate, _, growth, _, means = solution.y.reshape(6, count, len(times))
        return Indicators(times, stretch, rate, growth / times, means / times)


@dataclass(frozen=True)
class Indicators:
    """One row a run, one column a time: state, largest Lyapunov exponent up to that time, MEGNO."""

    times: np.ndarray
    stretch: np.ndarray
    rate: np.ndarray
    exponent: np.ndarray
    megno: np.ndarray


def embedded_pair(case: SurfaceEffects, phi_ac: float, omega: float, times: np.ndarray, rtol: float, atol: float):
    """λ and dλ/dt at `times` by SciPy's RK45: Dormand and Prince's 5(4) pair, which is that of ode45."""
    one = Cases(case.gamma_s, case.tau_s, case.E_s, case.S, C)

    def slope(time, state):
        stretch, rate = float(state[0]), float(state[1])
        return rate, one.acceleration(stretch, rate, (phi_ac * np.sin(omega * time)) ** 2)

    return solve_ivp(slope, (0, times[-1]), (1.0, 0.0), "RK45", times, rtol=rtol, atol=atol).y
