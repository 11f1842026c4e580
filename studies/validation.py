"""What docs/validation.md says of the FMU in SI units, measured anew.

    python studies/validation.py

Runs the packed FMU on every scene of tests/reference/device, on the exact periods and steady states, and on the
published numbers, and prints how far it agrees.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from device_scenes import PLAIN, REFERENCE, SCENES, device_scene
from dielectric_actuator import Actuator, packed_fmu

FMU = packed_fmu("si")
TOLERANCES = (1e-10, 1e-12)
"""That of a host which asks for none, and a tight one."""

STORED = {
    **{"energy_kinetic": "E_kinetic_J", "energy_elastic": "E_elastic_J", "energy_surface": "E_surface_J"},
    **{"energy_spring": "E_spring_J", "energy_branches": "E_branches_J", "energy_electric": "E_electric_J"},
}
LOST = {
    **{"lost_damping": "lost_damping_J", "lost_branches": "lost_branches_J"},
    **{"lost_resistance": "lost_series_resistance_J", "lost_leakage": "lost_leakage_J"},
}
SUPPLIED = {"supplied_electrical": "supplied_electric_J", "supplied_mechanical": "supplied_mechanical_J"}
ENERGIES = STORED | LOST | SUPPLIED
"""Column of the reference for each energy of the FMU."""

RELATIVE = {"lambda_dot": "lambda_dot_per_s", "charge": "charge_C", "supply_current": "supply_current_A"}


class Errors(NamedTuple):
    """Largest errors over a scene: of the stretch; of rate, charge and current over their largest values; of each
    energy, and of the balance of energy, over the largest energy."""

    stretch: float
    rate: float
    charge: float
    current: float
    energy: float
    balance: float


def largest_of(*errors: float) -> float:
    """The largest size; NaN if one is NaN, which `max` may leave out."""
    return float(np.abs(errors).max())


def errors(actuator: Actuator, name: str, tolerance: float) -> Errors:
    """A scene of the reference, in one communication step from each of its times to the next."""
    scene = device_scene(name)
    actuator.start({**scene.start, "record_energy": True}, tolerance=tolerance)
    if scene.derivatives:
        actuator.set_input_derivatives(scene.derivatives)

    def largest(columns: list[str]) -> float:
        return max(abs(row[column]) for row in scene.rows for column in columns if column in row)

    # nothing flows where the charge is held
    sizes = {variable: largest([column]) or 1.0 for variable, column in RELATIVE.items()}
    at_start = sum(actuator.get(*STORED))
    # a step of an ideal source is booked before the first row, which does not count it
    booked = dict(zip(ENERGIES, actuator.get(*ENERGIES)))
    booked.update(dict.fromkeys(STORED, 0.0))
    energy, off_energy, off_balance, off_stretch = 1e-300, 0.0, 0.0, 0.0
    off = dict.fromkeys(RELATIVE, 0.0)
    for row in scene.rows:
        if row["t_s"] > actuator.time:
            actuator.advance(row["t_s"] - actuator.time)
            actuator.time = row["t_s"]
        off_stretch = largest_of(off_stretch, actuator.get("lambda") - row["lambda"])
        for variable, column in RELATIVE.items():
            off[variable] = largest_of(off[variable], (actuator.get(variable) - row[column]) / sizes[variable])
        found = {variable: value - booked[variable] for variable, value in zip(ENERGIES, actuator.get(*ENERGIES))}
        energy = largest_of(energy, *found.values())
        known = [(variable, column) for variable, column in ENERGIES.items() if column in row]
        off_energy = largest_of(off_energy, *(found[variable] - row[column] for variable, column in known))
        gain = sum(found[variable] for variable in SUPPLIED) - sum(found[variable] for variable in LOST)
        balance = sum(found[variable] for variable in STORED) - at_start - gain
        off_balance = largest_of(off_balance, balance)
    rate, charge, current = off.values()
    return Errors(off_stretch, rate, charge, current, off_energy / energy, off_balance / energy)


class Published(NamedTuple):
    """A published number, what the model gives exactly, and the FMU."""

    source: str
    what: str
    published: str
    exact: float
    found: float

    def difference(self) -> float:
        """Of the FMU from the exact value, relative."""
        return abs(self.found / self.exact - 1)


SHEET = {**PLAIN, "mu": 1e6, "rho": 1000.0, "eps_r": 3.0, "H": 1e-4, "L": 1e-3}
"""Any sheet with L = 10 H: nondimensional numbers do not depend on it."""

VACUUM = 8.8541878188e-12


def voltage_scale(values: dict[str, float]) -> float:
    """H √(µ/ε) in V."""
    return values["H"] * math.sqrt(values["mu"] / (VACUUM * values["eps_r"]))


def time_scale(values: dict[str, float]) -> float:
    """H √(ρ/(12µ)) in s."""
    return values["H"] * math.sqrt(values["rho"] / (12 * values["mu"]))


def at_rest(actuator: Actuator, values: dict[str, float]) -> float:
    """The stretch at which a strongly damped actuator comes to rest."""
    actuator.start(values, tolerance=1e-12)
    period = 1 / actuator.get("frequency")
    actuator.start({**values, "eta": values["mu"] * period / 5}, tolerance=1e-12)
    actuator.advance(200 * period)
    return actuator.get("lambda")


def published(actuator: Actuator) -> Iterator[Published]:
    """Each published number by the FMU."""
    scale = voltage_scale(SHEET)
    actuator.start(SHEET)
    static, dynamic = (actuator.get(name) / scale for name in ("V_pull_in_static", "V_pull_in_dynamic"))
    yield Published(
        *("Zhao, Suo 2007", "static pull-in of the ideal actuator, field over √(µ/ε)", "0.69"),
        *(math.sqrt(3) * 2 ** (-4 / 3), static),
    )
    yield Published("Joglekar 2014", "dynamic pull-in of the ideal actuator", "0.6470", 0.6469836322448274, dynamic)

    # of scene I, whose charge scale makes 1.2 µC a nondimensional charge q with λ⁶ = 1 + q²
    held = {**device_scene("I_charge_step").start, "charge_imposed": 1.2e-6}
    found = at_rest(actuator, held)
    yield Published("Keplinger et al. 2010", "stretch at rest under a held charge", "stable", 1.122882071893131, found)

    gent = {**SHEET, "J_m": 100.0, "voltage": math.sqrt(0.1) * scale}
    gent["force"] = 0.5 * gent["mu"] * gent["H"] * gent["L"]
    found = at_rest(actuator, gent)
    yield Published("Sheng et al. 2014, Eq. 20", "equilibrium, J = 100", "1.149", 1.149228951976537, found)
    wide = {**gent, "H": 1e-7, "L": 1.0, "force": 0.5 * gent["mu"] * 1e-7, "lambda_start": found}
    wide["voltage"] = math.sqrt(0.1) * voltage_scale(wide)
    actuator.start(wide)
    frequency = 2 * math.pi * actuator.get("frequency") * time_scale(wide) * wide["L"] / wide["H"]
    # ω² = d/dλ[(λ − λ⁻⁵)/(1 − I/J)] − 3φ²λ²
    bound = 1 / (1 - (2 * found**2 + found**-4 - 3) / 100)
    slope = (1 + 5 * found**-6) * bound + 4 * (found - found**-5) ** 2 * bound**2 / 100
    exact = math.sqrt(slope - 0.3 * found**2)
    yield Published("Sheng et al. 2014", "frequency there, c → ∞", "–", exact, frequency)

    acrylic = {**SHEET, "mu": 15.36e3, "mu_1": 26.06e3, "mu_2": 26.53e3, "mu_3": 10.83e3}
    actuator.start(acrylic)
    slow, fast = (actuator.get(name) for name in ("V_pull_in_static", "V_pull_in_glassy_static"))
    scale = voltage_scale(acrylic)
    exact = math.sqrt(3) * 2 ** (-4 / 3)
    yield Published("Wang et al. 2016", "pull-in of a slow ramp", "below 1.6", exact, slow / scale)
    exact *= math.sqrt((15.36 + 26.06 + 26.53 + 10.83) / 15.36)
    yield Published("Wang et al. 2016", "pull-in of a fast ramp", "below 1.6", exact, fast / scale)

    joglekar = {**PLAIN, "mu": 67.1e3, "rho": 1200.0, "eps_r": 6.198e-11 / VACUUM, "H": 2e-3, "L": 10e-3}
    joglekar["voltage"] = 0.5 * voltage_scale(joglekar)
    period = 16.7211477513329 * time_scale(joglekar)
    actuator.start({**joglekar, "record_extremes": True}, tolerance=1e-12)
    actuator.advance(period)
    highest = actuator.get("lambda_highest")
    yield Published("paper, App. A", "least thickness stretch", "–", 0.798867594059, highest**-2)
    yield Published("paper, App. A", "stretch after the period of 1.291025 ms", "–", 1.0, actuator.get("lambda"))

    yeoh = {**PLAIN, "mu": 361.4e3, "rho": 1080.0, "eps_r": 2.8, "H": 100e-6, "L": 20e-3}
    yeoh |= {"kappa2": -16.7 / 180.7, "kappa3": 6.6 / 180.7}
    for stretch, exact in ((1.15, 261846.480913707), (1.38, 546469.550958688)):
        accelerations = []
        for force in (0.0, 1.0):
            actuator.start({**yeoh, "lambda_start": stretch, "force": force})
            accelerations.append(actuator.get("lambda_ddot"))
        # the acceleration is a straight line over the force
        force = accelerations[0] / (accelerations[0] - accelerations[1])
        stress = force * stretch / (yeoh["L"] * yeoh["H"])
        yield Published("Elastosil 2030, Yeoh law", f"prestress at λ = {stretch}, Pa", "formula", exact, stress)

    blocked = {**SHEET, "m_load": 100.0, "R_s": 1e6, "voltage": 1000.0}
    actuator.start(blocked, tolerance=1e-12)
    capacitance = actuator.get("capacitance")
    constant = 1e6 * capacitance
    actuator.advance(constant)
    exact = capacitance * 1000 * -math.expm1(-1)
    yield Published("closed form", "charge of a blocked film after RC, C", "–", exact, actuator.get("charge"))

    small = {**SHEET, "voltage": 1e-3 * voltage_scale(SHEET), "eta": 5 * SHEET["mu"] * time_scale(SHEET)}
    small |= {"mu_1": 1.5 * SHEET["mu"], "tau_1": 1e5 * time_scale(SHEET)}
    actuator.start(small, tolerance=1e-13)
    actuator.advance(small["tau_1"])
    exact = 1e-6 / 6 * (1 - 0.6 * math.exp(-1 / 2.5))
    yield Published("closed form", "creep of a small step after τ, to φ²", "–", exact, actuator.get("lambda") - 1)


def periods(actuator: Actuator) -> Iterator[tuple[str, float, float]]:
    """Scene, and how far the FMU is from λ = 1 after a thousand exact periods, and from the turning stretch."""
    for row in json.loads((REFERENCE / "periods.json").read_text())["rows"]:
        period = float(row["period_s"])
        actuator.start(device_scene(row["scene"]).start, tolerance=1e-12)
        actuator.advance(period / 2)
        turn = abs(actuator.get("lambda") - float(row["lambda_turn"]))
        actuator.advance(1e3 * period - period / 2)
        yield row["scene"], abs(actuator.get("lambda") - 1), turn


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=FMU, help="the packed FMU (%(default)s)")
    with Actuator(parser.parse_args().fmu) as actuator:
        for tolerance in TOLERANCES:
            print(f"tolerance {tolerance:g}")
            print(f"{'':<20}" + "".join(f"{name:>10}" for name in Errors._fields))
            for name in SCENES:
                print(f"{name:<20}" + "".join(f"{error:>10.1e}" for error in errors(actuator, name, tolerance)))
        print("\nundamped scenes: error of the stretch after 1000 periods, and at the turn")
        for name, end, turn in periods(actuator):
            print(f"{name:<20}{end:>10.1e}{turn:>10.1e}")
        print("\npublished numbers")
        for row in published(actuator):
            found = f"{row.found:.13g}"
            print(f"{row.source:<28}{row.what:<58}{row.published:>10}{found:>20}{row.difference():>10.1e}")


if __name__ == "__main__":
    main()
