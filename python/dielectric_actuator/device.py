"""From a device in SI units to the nondimensional model, with the exact derivatives of the conversion.

Each nondimensional quantity is a product of powers of those of the device (Eq. 15 of the paper; two surfaces, one
layer, no losses). The chain rule turns the sensitivities of the one into those of the other.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import fmu, native
from .fmu import UnknownName

Floats = NDArray[np.float64]

VACUUM = 8.8541878188e-12
"""Permittivity of vacuum in F/m (CODATA 2022)."""

PRODUCTS: Mapping[str, tuple[float, Mapping[str, float]]] = {
    "c": (1.0, {"L": 2.0, "H": -2.0}),
    "gamma_s": (1.0, {"gamma_s": 1.0, "mu": -1.0, "H": -1.0}),
    "tau_s": (1.0, {"tau_s": 1.0, "mu": -1.0, "H": -1.0}),
    "E_s": (1.0, {"E_s": 1.0, "mu": -1.0, "H": -1.0}),
    "S": (1.0, {"force": 1.0, "mu": -1.0, "H": -1.0, "L": -1.0}),
    "phi_scale": (math.sqrt(VACUUM), {"eps_r": 0.5, "mu": -0.5, "H": -1.0}),
    "time_scale": (math.sqrt(12.0), {"mu": 0.5, "rho": -0.5, "H": -1.0}),
    "lambda_start": (1.0, {"lambda_start": 1.0}),
    "lambda_dot_start": (1 / math.sqrt(12.0), {"lambda_dot_start": 1.0, "rho": 0.5, "mu": -0.5, "H": 1.0}),
}
"""Each nondimensional quantity as a factor and the powers of the device's, which the SI FMU calls by these names."""

NAMES = ("mu", "rho", "eps_r", "H", "L", "gamma_s", "tau_s", "E_s", "force", "lambda_start", "lambda_dot_start")
"""The parameters of a device, for `sensitivities` too; names, units and start values are those of the SI FMU."""

TYPICAL: Mapping[str, float] = {"gamma_s": 0.02, "tau_s": 0.02, "E_s": 0.1, "force": 1e-3, "lambda_dot_start": 1e4}
"""The size of what may be 0, in SI units, so that a fit may begin there."""


@functools.cache
def limits() -> dict[str, tuple[float, float, float]]:
    """Start value, smallest and largest value of each of `NAMES`, in SI units."""
    return fmu.limits("si", NAMES)


def nondimensional(device: Mapping[str, float]) -> tuple[dict[str, float], Floats]:
    """The nondimensional quantities of a device, in the order of `PRODUCTS`, and their derivatives by `NAMES`.

    Raises `UnknownName` for a name that is none of `NAMES`, ValueError for a value out of range.
    """
    for name in device:
        if name not in NAMES:
            raise UnknownName("parameter of a device", name, NAMES)
    given = {name: float(device.get(name, limits()[name][0])) for name in NAMES}
    for name, value in given.items():
        _, lowest, highest = limits()[name]
        if not lowest <= value <= highest:
            raise ValueError(f"{name} is {value:g}; it must be a number from {lowest:g} to {highest:g}")
    found, slopes = {}, np.zeros((len(PRODUCTS), len(NAMES)))
    for row, (quantity, (factor, powers)) in enumerate(PRODUCTS.items()):
        found[quantity] = factor * math.prod(given[name] ** power for name, power in powers.items())
        for name, power in powers.items():
            others = math.prod(given[other] ** exponent for other, exponent in powers.items() if other != name)
            slopes[row, NAMES.index(name)] = factor * power * given[name] ** (power - 1) * others
    return found, slopes


def sensitivities(
    device: Mapping[str, float],
    time: ArrayLike,
    voltage: ArrayLike,
    *,
    interpolation: str = "linear",
    tolerance: float = native.DEFAULT_TOLERANCE,
) -> tuple[Floats, Floats]:
    """The stretch of a device under a voltage in volts at times in seconds, and its derivatives by `NAMES`.

    Otherwise as `dielectric_actuator.sensitivities`, which see.
    """
    values, chain = nondimensional(device)
    stretch, slopes = native.sensitivities(values, time, voltage, interpolation=interpolation, tolerance=tolerance)
    places = [native.known_names().index(name) for name in PRODUCTS]
    return stretch, slopes[:, places] @ chain


def observe(quantity: str, device: Mapping[str, float], stretch: Floats, slopes: Floats) -> tuple[Floats, Floats]:
    """A quantity by its name in the SI FMU, and its derivatives with respect to `NAMES`, from those of the stretch."""
    side, thickness = (float(device.get(name, limits()[name][0])) for name in ("L", "H"))
    slopes = slopes.copy()
    if quantity == "thickness":
        slopes *= (-2 * thickness * stretch**-3.0)[:, None]
        slopes[:, NAMES.index("H")] += stretch**-2.0
        return thickness * stretch**-2.0, slopes
    if quantity in ("edge_distance", "edge_displacement"):
        rest = 1.0 if quantity == "edge_displacement" else 0.0
        slopes *= side
        slopes[:, NAMES.index("L")] += stretch - rest
        return side * (stretch - rest), slopes
    return stretch, slopes
