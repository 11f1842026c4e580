"""A film in a circuit with a load: its parameters for the FMU, and its equation of motion written anew.

The equation is that of the FMU in SI units without surfaces, stiffening and leakage, in quantities of its own:
nondimensional stretch and rate, charge in units of the charge at rest under the voltage V0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

PERMITTIVITY_OF_VACUUM = 8.8541878188e-12

FILM = {"mu": 361.4e3, "rho": 1080.0, "eps_r": 2.8, "H": 100e-6, "L": 20e-3, "gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0}
"""A silicone film, 100 µm thick and 20 mm wide: 1235 Hz, 99 pF."""


class Equation:
    """The motion of a film with the FMU's parameters `values` in SI units, as a function of seconds and volts."""

    def __init__(self, values: Mapping[str, float]):
        modulus, density, thickness, side = (values[name] for name in ("mu", "rho", "H", "L"))
        permittivity = PERMITTIVITY_OF_VACUUM * values["eps_r"]
        force = modulus * thickness * side
        self.side = side
        self.time = thickness * math.sqrt(density / (12 * modulus))
        self.voltage = thickness * math.sqrt(modulus / permittivity)
        self.capacitance = permittivity * side**2 / thickness
        self.inertia = (side / thickness) ** 2 + 12 * values.get("m_load", 0.0) / (density * thickness**3)
        self.spring = values.get("k_load", 0.0) * side / force
        self.dashpot = values.get("b", 0.0) * side / (force * self.time)
        self.viscosity = values.get("eta", 0.0) / (modulus * self.time)
        self.resistance = values.get("R_s", 0.0) * self.capacitance / self.time

    def acceleration(self, stretch: float, rate: float, charge: float) -> float:
        """Second derivative of the stretch, 1/s², from its rate in 1/s and the charge in C."""
        v, q = rate * self.time, charge / (self.capacitance * self.voltage)
        elastic = stretch - stretch**-5 + self.spring * (stretch - 1)
        damping = (self.dashpot + 6 * self.viscosity / stretch**2) * v
        # q²/λ⁵ is φ²λ³ with φ = q/λ⁴
        upper = 6 * v**2 / stretch**7 - elastic + q**2 / stretch**5 - damping
        return upper / (self.inertia + 2 / stretch**6) / self.time**2

    def charge(self, stretch: float, voltage: float) -> float:
        """Charge in C under a voltage at the membrane."""
        return self.capacitance * stretch**4 * voltage

    def current(self, stretch: float, charge: float, voltage: float) -> float:
        """Current in A through the series resistance."""
        behind = charge / (self.capacitance * stretch**4)
        return (voltage - behind) / (self.resistance * self.time / self.capacitance)
