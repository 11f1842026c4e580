"""The binary of each platform, in a small C host, against the one for 64-bit Linux."""

import struct

import numpy as np
import pytest

SURFACE = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
SCENES = {
    "voltage step": ({"phi": 0.6}, 0.37, 1000),
    "voltage step, surface effects, prestress": ({**SURFACE, "phi": 0.6, "S": 0.5}, 0.1, 2000),
    "built-in drive near resonance": ({**SURFACE, "phi_ac": 0.3, "omega_ac": 0.1438}, 0.5, 2000),
}
OUTPUTS = ("lambda", "lambda_dot", "lambda3", "hamiltonian", "phi_pull_in")
TOLERANCE = 1e-12

LIMIT = {"win64": 1e-12, "aarch64-linux": 1e-12}
"""Largest difference from 64-bit Linux, in units of the larger of 1 and the value. The solver's order of
operations is the same; sine and power come from the platform's C library, and the fused
multiply-adds are those of the processor."""


def numbers(rows) -> np.ndarray:
    """Numbers from their bits."""
    return np.array([[struct.unpack(">d", bytes.fromhex(bits))[0] for bits in row] for row in rows])


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", LIMIT)
def test_every_platform_gives_the_same_trajectory(simulate, name, scene, record_property):
    values, step, steps = SCENES[scene]
    run = {"step": step, "steps": steps, "tolerance": TOLERANCE}
    other = numbers(simulate(name, values, OUTPUTS, **run))
    linux = numbers(simulate("linux64", values, OUTPUTS, **run))
    assert linux.shape == other.shape == (steps, len(OUTPUTS))
    assert np.ptp(linux[:, 0]) > 0.01, "the actuator moves"
    difference = np.abs(other - linux) / np.maximum(1, np.abs(linux))
    equal = np.mean(other == linux)
    print(f"\n{name}, {scene}: largest difference {difference.max():.1e}, {equal:.1%} equal bit for bit", end=" ")
    assert difference.max() <= LIMIT[name]


@pytest.mark.parametrize("name", LIMIT)
def test_every_platform_speaks_through_the_logger(simulate, name):
    """A refused value ends the host with the call's name and the unit's message."""
    with pytest.raises(AssertionError, match="(?s)below its minimum.*fmi2SetReal returned 3"):
        simulate(name, {"c": -1.0}, OUTPUTS, step=0.1, steps=1, tolerance=TOLERANCE)
