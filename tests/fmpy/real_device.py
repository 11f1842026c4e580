"""The real device written down a second time, from its energies and losses, and integrated by SciPy.

Nothing of the FMU is used. The state holds the stretches of the dashpots themselves, where the FMU holds their
squares, and the equations are the textbook's, without the FMU's care for cancellation.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping

import numpy as np
from scipy.integrate import solve_ivp

VACUUM_PERMITTIVITY = 8.8541878188e-12

DEFAULTS = {
    "mu": 303e3, "rho": 1100.0, "eps_r": 2.8, "H": 10e-6, "L": 100e-6, "n_layers": 1.0, "gamma_s": 0.02, "tau_s": 0.02,
    "E_s": 0.126, "n_surfaces": 2.0, "J_m": 0.0, "kappa2": 0.0, "kappa3": 0.0, "k1": 0.0, "k2": 0.0, "k3": 0.0,
    "m_load": 0.0, "k_load": 0.0, "l_load": 0.0, "b": 0.0, "eta": 0.0, "mu_1": 0.0, "tau_1": 1.0, "J_1": 0.0,
    "mu_2": 0.0, "tau_2": 1.0, "J_2": 0.0, "mu_3": 0.0, "tau_3": 1.0, "J_3": 0.0, "R_s": 0.0, "G_p": 0.0, "sigma": 0.0,
    "E_conduction": 0.0, "V_ac": 0.0, "f_ac": 0.0, "phase_ac": 0.0, "lambda_start": 1.0, "lambda_dot_start": 0.0,
    "charge_start": 0.0, "xi1_start": 1.0, "xi2_start": 1.0, "xi3_start": 1.0, "voltage": 600.0, "current": 0.0,
    "charge_imposed": 0.0, "force": 0.0, "source": 1,
}  # fmt: skip
"""The start values of the FMU, as far as the equations know them."""

STIFF = 300.0
"""Fastest relaxation over the period, from where on an implicit method is taken."""


class RealDevice:
    """One device by the names of the FMU's variables; `solve` gives its states in nondimensional numbers."""

    def __init__(self, given: Mapping[str, float]):
        p = self.values = {**DEFAULTS, **given}
        permittivity = p["eps_r"] * VACUUM_PERMITTIVITY
        stack = p["n_layers"] * p["H"]
        shear = p["mu"] * stack
        self.time = stack * math.sqrt(p["rho"] / (12 * p["mu"]))
        self.volts = p["H"] * math.sqrt(p["mu"] / permittivity)
        self.coulombs = p["n_layers"] * p["L"] ** 2 * math.sqrt(permittivity * p["mu"])
        self.newtons = shear * p["L"]
        farads = self.coulombs / self.volts
        self.inertia = (p["L"] / stack) ** 2 + 12 * p["m_load"] / (p["rho"] * stack**3)
        self.surface = [p["n_surfaces"] * p[name] / (2 * shear) for name in ("gamma_s", "tau_s", "E_s")]
        self.spring = (p["k_load"] / shear, (p["l_load"] or p["L"]) / p["L"])
        self.damping = (p["b"] / (shear * self.time), p["eta"] / (p["mu"] * self.time))
        self.resistance = p["R_s"] * farads / self.time
        self.conductance = p["G_p"] * self.time / farads
        self.conductivity = p["sigma"] * self.time / permittivity
        self.conduction_field = p["E_conduction"] / (self.volts / p["H"]) or math.inf
        self.branches = [
            (p[f"mu_{k}"] / p["mu"], p[f"tau_{k}"] / self.time, p[f"J_{k}"] or math.inf, p[f"xi{k}_start"])
            for k in (1, 2, 3)
            if p[f"mu_{k}"] > 0
        ]
        self.holds_charge = p["source"] == 2 or (p["source"] == 1 and p["R_s"] > 0)

    @property
    def period(self) -> float:
        """Of small oscillations of the neo-Hookean sheet at λ = 1, nondimensional."""
        return 2 * math.pi * math.sqrt((self.inertia + 2) / 6)

    @property
    def stiffness(self) -> float:
        """The fastest relaxation in units of the period."""
        rates = [max(self.damping[0], 6 * self.damping[1]) / self.inertia]
        rates += [1 / time for _, time, _, _ in self.branches]
        if self.holds_charge and self.resistance:
            rates.append(1 / self.resistance)
        return self.period * max(rates)

    def source(self, time: float) -> float:
        p = self.values
        if p["source"] == 1:
            angle = 2 * math.pi * p["f_ac"] * time * self.time + p["phase_ac"]
            return (p["voltage"] + p["V_ac"] * math.sin(angle)) / self.volts
        return p["current"] * self.time / self.coulombs if p["source"] == 2 else p["charge_imposed"] / self.coulombs

    def slopes(self, time: float, state: np.ndarray) -> np.ndarray:
        p = self.values
        stretch, rate = state[:2]
        x = stretch - 1
        relative = 1 + p["k1"] * x + p["k2"] * x**2 + p["k3"] * x**3
        relative_slope = p["k1"] + 2 * p["k2"] * x + 3 * p["k3"] * x**2
        source = self.source(time)
        charge = state[2] if self.holds_charge else source
        voltage = source if p["source"] == 1 and not self.holds_charge else charge / (stretch**4 * relative)
        invariant = 2 * stretch**2 + stretch**-4 - 3
        if p["J_m"]:
            factor = 1 / (1 - invariant / p["J_m"])
        else:
            factor = 1 + 2 * p["kappa2"] * invariant + 3 * p["kappa3"] * invariant**2
        gamma, tau, elasticity = self.surface
        stiffness, rest = self.spring
        force = 6 * stretch**-7 * rate**2 - (stretch - stretch**-5) * factor
        force -= 2 * (gamma * stretch + tau * (2 * stretch**3 - stretch))
        force -= elasticity * stretch * (stretch**2 - 1) * (3 * stretch**2 - 1)
        force += p["force"] / self.newtons - stiffness * (stretch - rest)
        force += voltage**2 * (stretch**3 * relative + stretch**4 * relative_slope / 4)
        force -= (self.damping[0] + 6 * self.damping[1] / stretch**2) * rate
        changes = [rate, 0.0]
        if self.holds_charge:
            growth = math.exp(abs(voltage) * stretch**2 / self.conduction_field)
            leak = voltage * (self.conductance + self.conductivity * stretch**4 * growth)
            current = source if p["source"] == 2 else (source - voltage) / self.resistance
            changes.append(current - leak)
        for (modulus, relaxation, limit, _), dashpot in zip(self.branches, state[len(changes) :], strict=True):
            elastic = (stretch / dashpot) ** 2
            steep = 1 / (1 - (2 * elastic + elastic**-2 - 3) / limit)
            force -= modulus * steep * (stretch / dashpot**2 - dashpot**4 / stretch**5)
            changes.append(dashpot * (elastic - elastic**-2) * steep / (6 * relaxation))
        changes[1] = force / (self.inertia + 2 * stretch**-6)
        return np.array(changes)

    def solve(self, times: list[float]) -> np.ndarray:
        """The states at times in s, a column each: stretch, rate, charge where it is a state, dashpots."""
        p = self.values
        start = [p["lambda_start"], p["lambda_dot_start"] * self.time]
        if self.holds_charge:
            start.append(p["charge_start"] / self.coulombs)
        start += [dashpot for *_, dashpot in self.branches]
        method, tolerance = ("Radau", 1e-11) if self.stiffness > STIFF else ("DOP853", 1e-13)
        at = np.array(times) / self.time
        solution = solve_ivp(
            self.slopes, (0, at[-1]), start, method, at, rtol=tolerance, atol=1e-2 * tolerance * np.maximum(start, 1e-3)
        )
        assert solution.success, solution.message
        return solution.y


def random_scene(seed: int) -> dict[str, float]:
    """A device in which each part beyond the paper is there or not, below pull-in."""
    draw = random.Random(seed)
    height, modulus = 10 ** draw.uniform(-5.3, -3.5), 10 ** draw.uniform(4, 6.2)
    side, layers = height * 10 ** draw.uniform(0.7, 2.5), draw.choice([1, 1, 3, 50])
    scene = {
        "H": height, "L": side, "mu": modulus, "n_layers": layers, "rho": draw.uniform(900, 1300),
        "eps_r": draw.uniform(2, 8), "gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0,
    }  # fmt: skip

    def perhaps(chance: float, **parts: float) -> None:
        if draw.random() < chance:
            scene.update(parts)

    bare = RealDevice(scene)
    period, shear = bare.period * bare.time, modulus * layers * height
    farads = bare.coulombs / bare.volts
    law = draw.choice(["none", "gent", "yeoh"])
    if law == "gent":
        scene["J_m"] = draw.uniform(8, 120)
    elif law == "yeoh":
        scene |= {"kappa2": draw.uniform(-0.1, 0.1), "kappa3": draw.uniform(0, 0.05)}
    perhaps(0.3, k1=draw.uniform(-0.12, 0.1), k2=draw.uniform(-0.02, 0.05), lambda_max=4.0)
    perhaps(0.3, m_load=draw.uniform(0, 3) * scene["rho"] * side**2 * layers * height / 12)
    perhaps(0.3, k_load=draw.uniform(0, 1) * shear, l_load=side * draw.uniform(0.8, 1.3))
    perhaps(0.3, eta=10 ** draw.uniform(-4, 1) * modulus * period)
    perhaps(0.2, b=10 ** draw.uniform(-4, 1) * shear * period)
    for k in range(1, draw.choice([0, 0, 1, 2, 3]) + 1):
        scene |= {f"mu_{k}": modulus * draw.uniform(0.1, 2), f"tau_{k}": period * 10 ** draw.uniform(-2, 2)}
        perhaps(0.3, **{f"J_{k}": draw.uniform(20, 100)})
    scene["source"] = draw.choice([1, 1, 1, 2, 3])
    part = draw.uniform(0.1, 0.6)
    scene["voltage"] = part * bare.volts if scene["source"] == 1 else 0.0
    if scene["source"] == 2:
        scene["current"] = part * bare.coulombs / (5 * period)
    elif scene["source"] == 3:
        scene["charge_imposed"] = 2 * part * bare.coulombs
    else:
        frequency = draw.uniform(0.2, 3) / period
        perhaps(0.3, V_ac=0.3 * part * bare.volts, f_ac=frequency, phase_ac=draw.uniform(-3, 3), voltage=0.0)
    perhaps(0.5, R_s=10 ** draw.uniform(-5, 0.3) * period / farads)
    perhaps(0.3, G_p=10 ** draw.uniform(-4, 0) * farads / period)
    perhaps(0.3, sigma=10 ** draw.uniform(-4, 0) * scene["eps_r"] * VACUUM_PERMITTIVITY / period)
    perhaps(0.3, E_conduction=draw.uniform(0.3, 3) * bare.volts / height)
    perhaps(0.3, force=draw.uniform(-0.2, 0.3) * bare.newtons)
    perhaps(0.2, lambda_start=draw.uniform(0.95, 1.1), lambda_dot_start=draw.uniform(-0.05, 0.05) / bare.time)
    return scene
