"""The binary of each platform, in a small C host, against the one for 64-bit Linux."""

import struct
from pathlib import Path

import numpy as np
import pytest

from conftest import MODELS

PAPER, DEVICE = MODELS
SURFACE = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
LOSSES = {"R_s": 1e9, "eta": 1.0, "mu_1": 1e5, "tau_1": 2e-6, "mu_2": 5e4, "tau_2": 1e-3}
SCENES = {
    "voltage step": (PAPER, {"phi": 0.6}, 0.37, 1000),
    "voltage step, surface effects, prestress": (PAPER, {**SURFACE, "phi": 0.6, "S": 0.5}, 0.1, 2000),
    "built-in drive near resonance": (PAPER, {**SURFACE, "phi_ac": 0.3, "omega_ac": 0.1438}, 0.5, 2000),
    "device without losses": (DEVICE, {}, 1.7e-7, 1000),
    "device that stiffens, under a force": (DEVICE, {"J_m": 40.0, "k1": -0.05, "force": 2e-5}, 1.7e-7, 1000),
    "device with losses and a drive": (DEVICE, {**LOSSES, "V_ac": 150.0, "f_ac": 2e4}, 1.7e-7, 1000),
    "device with a stiff circuit": (DEVICE, {"R_s": 1e2, "sigma": 1e-11, "b": 1e-6}, 1.7e-7, 1000),
}
OUTPUTS = {
    PAPER: ("lambda", "lambda_dot", "lambda3", "hamiltonian", "phi_pull_in"),
    DEVICE: ("lambda", "lambda_dot", "xi1", "charge", "supply_current", "edge_acceleration", "V_pull_in_static"),
}
TOLERANCE = 1e-12
SMALLEST_SCALE = {PAPER: 1.0, DEVICE: 1e-12}
"""What differences are at least measured by: the paper's variables are of order 1 (its Hamiltonian starts at 0), the
smallest of the device is its charge of some picocoulombs."""

OTHERS = ("win64", "aarch64-linux")
FUSED = " fma " in Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").is_file() else False
LIMITS = {"win64": 1e-15, "aarch64-linux": 1e-11} if FUSED else dict.fromkeys(OTHERS, 1e-10)
"""Largest difference from 64-bit Linux, in units of the variable's largest value in the run. On Windows only sine and
power, which come from the C library, round otherwise. On Arm registers hold two numbers, and x'' has fewer operations.
A drive near resonance makes 3e-12 of that in the energy. A processor for 64-bit Linux without fused multiply-add rounds
more often."""


def numbers(rows) -> np.ndarray:
    """Numbers from their bits."""
    return np.array([[struct.unpack(">d", bytes.fromhex(bits))[0] for bits in row] for row in rows])


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", OTHERS)
def test_every_platform_gives_the_same_trajectory(simulate, name, scene):
    model, values, step, steps = SCENES[scene]
    run = {"step": step, "steps": steps, "tolerance": TOLERANCE}
    other = numbers(simulate(model, name, values, OUTPUTS[model], **run))
    linux = numbers(simulate(model, "linux64", values, OUTPUTS[model], **run))
    assert linux.shape == other.shape == (steps, len(OUTPUTS[model]))
    assert np.ptp(linux[:, 0]) > 0.01, "the actuator moves"
    same = other == linux  # among them infinities: no threshold
    largest = np.max(np.abs(linux), axis=0, where=np.isfinite(linux), initial=SMALLEST_SCALE[model])
    difference = np.abs(np.subtract(other, linux, where=~same, out=np.zeros_like(linux)) / largest).max(axis=0)
    print(f"\n{name}, {scene}: {same.mean():.1%} equal bit for bit, largest differences", end=" ")
    print(", ".join(f"{output} {value:.1e}" for output, value in zip(OUTPUTS[model], difference, strict=True)), end=" ")
    assert difference.max() <= LIMITS[name]


@pytest.mark.parametrize(("model", "variable"), [(PAPER, "c"), (DEVICE, "H")])
@pytest.mark.parametrize("name", OTHERS)
def test_every_platform_speaks_through_the_logger(simulate, name, model, variable):
    """A refused value ends the host with the call's name and the unit's message."""
    with pytest.raises(AssertionError, match=r"(?s)below its minimum.*fmi2SetReal returned 3"):
        simulate(model, name, {variable: -1.0}, OUTPUTS[model], step=0.1, steps=1, tolerance=TOLERANCE)
