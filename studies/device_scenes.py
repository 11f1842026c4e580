"""The scenes of tests/reference/device as the FMU in SI units takes them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

REFERENCE = Path(__file__).resolve().parents[1] / "tests" / "reference" / "device"

SCENES = (
    *("A_si_dc_step", "B_rc_step", "D_kv_step", "F_sls_creep_vhb", "G2_gent_sylgard", "G_gent_snap", "H_ac_damped"),
    *("I_charge_step", "K_force_step_stack", "L_permittivity_step", "N_yeoh_step"),
    *("own_current", "own_everything", "own_linear_damping", "own_overdamped", "own_ramp", "own_stiff_rc"),
    "own_yeoh_gravity",
)

_NAMES = {
    **{"epsr": "eps_r", "n": "n_layers", "n_s": "n_surfaces", "J": "J_m", "k": "k_load", "m": "m_load"},
    **{"l_k": "l_load", "E_c": "E_conduction", "V": "voltage", "f": "f_ac", "P": "force"},
    **{"I": "current", "Q": "charge_imposed"},
}
"""Names of the reference that the FMU does not use."""

_SOURCES = {"I": 2.0, "Q": 3.0}
_INPUTS = {"V_polynomial": "voltage", "P_polynomial": "force"}

PLAIN = {"gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0, "voltage": 0.0, "lambda_max": 100.0}
"""What the default device has and a scene may not; and no collapse."""


@dataclass(frozen=True)
class DeviceScene:
    """A scene from rest at λ = 1."""

    title: str
    start: dict[str, float]
    """Start values by variable of the FMU."""

    derivatives: dict[str, list[float]]
    """Derivatives by time of inputs, from the first on."""

    rows: list[dict[str, float]]
    """Exact values in SI units, a row for each time `t_s`."""


def device_scene(name: str) -> DeviceScene:
    """The scene of tests/reference/device/NAME.json."""
    content = json.loads((REFERENCE / f"{name}.json").read_text())
    start = dict(PLAIN)
    derivatives = {}
    for key, value in content["parameters_SI"].items():
        if key == "branches":
            for number, (modulus, time, limit) in enumerate(value, start=1):
                branch = {"mu": float(modulus), "tau": float(time), "J": float(limit or 0)}
                start.update({f"{quantity}_{number}": found for quantity, found in branch.items()})
        elif key in _INPUTS:
            start[_INPUTS[key]] = float(value[0])
            # coefficients of t and t²
            factors = [1.0, 2.0]
            derivatives[_INPUTS[key]] = [factor * float(term) for factor, term in zip(factors, value[1:])]
        elif key != "mode":
            start[_NAMES.get(key, key)] = float(value)
            start |= {"source_number": _SOURCES[key]} if key in _SOURCES else {}
    for key, source in _INPUTS.items():
        if key in content["parameters_SI"]:
            start[source] = float(content["parameters_SI"][key][0])
    if "k1" in start:
        start["lambda_max"] = 5.0  # the permittivity of the others vanishes further out
    start["charge_start"] = float(content["start"]["charge_C"])
    rows = [{key: float(value) for key, value in row.items()} for row in content["rows"]]
    return DeviceScene(content["title"], start, derivatives, rows)
