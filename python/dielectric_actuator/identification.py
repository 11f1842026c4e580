"""Parameters from measured voltage and stretch: least squares with the sensitivities of the motion.

Gauss–Newton steps in a trust region (``scipy.optimize.least_squares``); the Jacobian is that of the variational
equations along the trajectory (`sensitivities`), nothing is differenced. Uncertainties are those of the linearized
problem, the square roots of the diagonal of σ² (JᵀJ)⁻¹ (G. A. F. Seber and C. J. Wild, "Nonlinear Regression",
1989, section 2.1). What the data cannot tell apart is found in the singular values of J.

The parameters are those of the nondimensional actuator, or with ``model="si"`` those of a device in SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import device, native
from .fmu import MODELS, UnknownName
from .measured import check
from .native import DEFAULT_TOLERANCE, Collapse
from .presets import Preset

Floats = NDArray[np.float64]

OBSERVED = ("lambda", "thickness", "edge_distance", "edge_displacement")
"""What may be measured of a device, as the SI FMU calls it: the stretch, or a length in metres."""

REDUNDANT = 1e-9
"""Singular values below this part of the largest, each column of J scaled to length 1, are rounding: the data do not
change at all along their directions."""


@dataclass(frozen=True)
class Fit:
    """What was found."""

    values: dict[str, float]
    """Every parameter, found or given."""
    uncertainties: dict[str, float]
    """Standard deviation of each one that was free; +inf for one that others can make up for exactly."""
    correlations: Floats
    """Of the free parameters, in the order of `uncertainties`; nan where the uncertainty is +inf."""
    redundancies: list[dict[str, float]]
    """Directions along which the parameters may move without any change of the motion: the change of each
    parameter that takes part, the largest scaled to 1."""
    residual: float
    """Root mean square of what is left of the measured quantity."""
    stretch: Floats
    """The fitted stretch, or the length that was measured in its place, at the measured times."""
    model: str = "nondimensional"
    """Which actuator the parameters are those of, as `Actuator` takes it."""

    def preset(self, title: str, voltage: float = 0.0, *, stop_time: float | None = None) -> Preset:
        """What was found as a preset for `Actuator`, under a voltage as measured.

        The nondimensional actuator has no place for a time scale. `stop_time` is by default some ten periods.
        """
        uncertain = ", ".join(f"{name} ± {value:.2g}" for name, value in self.uncertainties.items())
        about = f"Fitted to measured data: {uncertain}."
        if self.model == "si":
            found = {**self.values, "voltage": voltage}
            nondimensional, _ = device.nondimensional(self.values)
            end = stop_time or float(f"{300 / nondimensional['time_scale']:.1g}")
        else:
            found = {name: value for name, value in self.values.items() if name not in ("phi_scale", "time_scale")}
            found["phi"] = self.values["phi_scale"] * voltage
            end = stop_time or 100.0
        return Preset(title, about, found, end, end / 1000, self.model)

    def table(self) -> str:
        """Found values and uncertainties as text, with what cannot be told apart."""
        lines = [f"{'parameter':<18}{'found':>14}{'uncertainty':>14}"]
        lines += [f"{name:<18}{self.values[name]:>14.7g}{value:>14.2g}" for name, value in self.uncertainties.items()]
        for direction in self.redundancies:
            moved = ", ".join(f"{name} {change:+.4g}" for name, change in direction.items())
            lines.append(f"cannot be told apart: the motion is the same along {moved}")
        return "\n".join([*lines, f"residual (root mean square): {self.residual:.3g}"])


def fit(
    time: ArrayLike,
    voltage: ArrayLike,
    stretch: ArrayLike,
    *,
    free: Sequence[str],
    start: Mapping[str, float] | None = None,
    model: str = "nondimensional",
    observed: str = "lambda",
    interpolation: str = "linear",
    noise: float | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    progress: Callable[[int, float], None] | None = None,
) -> Fit:
    """Find the `free` parameters from the stretch measured at each time under a measured voltage.

    `start` holds first guesses of free parameters and the values of others (default: the FMU's start values, 1 for
    the scales). `interpolation` says what the voltage does between two samples, "linear" or "hold". `noise` is the
    standard deviation of what is measured; without it, it is taken from the residual. `progress` is called with the
    number of motions that were followed and the root mean square of what is left.

    * ``model="nondimensional"``: the parameters are `native.known_names`. With voltages in volts and times in
      seconds, ``phi_scale`` and ``time_scale`` lead to the nondimensional ones. The free start values
      ``lambda_start`` and ``lambda_dot_start`` (by t̄) are parameters like others.
    * ``model="si"``: times in seconds, volts, and the parameters `device.NAMES` in SI units. `observed` says what was
      measured and given as `stretch`: "lambda", or in metres "thickness", "edge_distance" or "edge_displacement",
      as the SI FMU calls them. The device is that of the paper, without losses, stiffening and leaks.

    Raises `UnknownName`, or ValueError for data that are no numbers, too few, or not in the order of time, with row
    and column; `Collapse` if the actuator is pulled in on the way under the first guess.
    """
    from scipy.optimize import least_squares

    if model not in MODELS:
        raise UnknownName("actuator", model, MODELS)
    if observed not in (OBSERVED if model == "si" else OBSERVED[:1]):
        raise UnknownName("measured quantity", observed, OBSERVED if model == "si" else OBSERVED[:1])
    in_si = model == "si"
    names, limits = (device.NAMES, device.limits()) if in_si else (native.known_names(), native.limits())
    for name in [*free, *(start or {})]:
        if name not in names:
            raise UnknownName("parameter", name, names)
        if list(free).count(name) > 1:
            raise ValueError(f"{name} is free twice; name it once")
    if not free:
        raise ValueError("no parameter is free; name one at least")
    time, columns = check(time, {"voltage": voltage, "stretch": stretch})
    voltage, measured = columns["voltage"], columns["stretch"]
    if len(time) <= len(free):
        raise ValueError(f"{len(time)} rows cannot determine {len(free)} parameters")
    given = {name: limits[name][0] for name in names} | dict(start or {})
    places = [names.index(name) for name in free]
    first = np.array([given[name] for name in free], dtype=float)
    # each parameter is counted in its first guess, a length in that of the device
    typical = [device.TYPICAL.get(name, 1.0) if in_si else 1.0 for name in free]
    units = np.where(first != 0, np.abs(first), typical)
    size = 1.0 if observed == "lambda" else given["H" if observed == "thickness" else "L"]
    bounds = np.array([limits[name][1:] for name in free]).T / units

    def followed(guess: Floats) -> tuple[Floats, Floats]:
        """What is left of the measured quantity, and its derivatives, both over `size`."""
        values = given | dict(zip(free, map(float, guess * units)))
        if in_si:
            found, slopes = device.observe(
                observed,
                values,
                *device.sensitivities(values, time, voltage, interpolation=interpolation, tolerance=tolerance),
            )
        else:
            found, slopes = native.sensitivities(
                values, time, voltage, interpolation=interpolation, tolerance=tolerance
            )
        return (found - measured) / size, slopes[:, places] * units / size

    last: dict[bytes, tuple[Floats, Floats]] = {}
    motions = 0

    def residuals(guess: Floats) -> Floats:
        try:
            last.clear()
            last[guess.tobytes()] = followed(guess)
        except (Collapse, RuntimeError):
            # the trust region shrinks where a residual is no number
            return np.full(len(time), np.nan)
        left = last[guess.tobytes()][0]
        nonlocal motions
        motions += 1
        if progress:
            progress(motions, size * math.sqrt(float(np.mean(left**2))))
        return left

    def jacobian(guess: Floats) -> Floats:
        return last[guess.tobytes()][1] if guess.tobytes() in last else followed(guess)[1]

    followed(first / units)  # a collapse under the first guess is told as such
    solution = least_squares(
        residuals, first / units, jacobian, bounds=bounds, x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    left, slopes = followed(solution.x)
    left, slopes = left * size, slopes * size / units
    rank_left = len(time) - len(free)
    deviation = noise if noise is not None else math.sqrt(float(left @ left) / rank_left)
    covariance, redundancies = _covariance(slopes, deviation, free)
    uncertain = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore"):
        correlations = covariance / np.outer(uncertain, uncertain)
    return Fit(
        values=given | dict(zip(free, map(float, solution.x * units))),
        uncertainties=dict(zip(free, map(float, uncertain))),
        correlations=correlations,
        redundancies=redundancies,
        residual=math.sqrt(float(np.mean(left**2))),
        stretch=measured + left,
        model=model,
    )


def _covariance(slopes: Floats, deviation: float, names: Sequence[str]) -> tuple[Floats, list[dict[str, float]]]:
    """The covariance of the parameters, and the directions that J does not see."""
    lengths = np.linalg.norm(slopes, axis=0)
    lengths[lengths == 0] = 1.0
    _, singular, directions = np.linalg.svd(slopes / lengths, full_matrices=False)
    seen = singular > REDUNDANT * singular[0]
    inverse = (directions[seen].T / singular[seen]) / lengths[:, None]
    covariance = deviation**2 * (inverse @ inverse.T)
    redundancies = []
    for direction in directions[~seen]:
        change = direction / lengths
        change = change / change[np.argmax(np.abs(change))]
        taking_part = np.abs(direction) > 1e-6
        redundancies.append({name: float(change[k]) for k, name in enumerate(names) if taking_part[k]})
        covariance[taking_part, :] = np.nan
        covariance[:, taking_part] = np.nan
        covariance[taking_part, taking_part] = np.inf
    return covariance, redundancies
