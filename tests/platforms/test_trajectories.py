"""The binary of each platform, in a small C host, against the one for 64-bit Linux."""

import struct
from pathlib import Path

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

OTHERS = ("win64", "aarch64-linux")
FUSED = " fma " in Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").is_file() else False
LIMIT = 1e-12 if FUSED else 1e-10
"""Largest difference from 64-bit Linux, in units of the larger of 1 and the value. The order of operations is
the same everywhere; sine and power come from the C library of the platform, and a processor for 64-bit Linux
without fused multiply-add rounds more often."""


def numbers(rows) -> np.ndarray:
    """Numbers from their bits."""
    return np.array([[struct.unpack(">d", bytes.fromhex(bits))[0] for bits in row] for row in rows])


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", OTHERS)
def test_every_platform_gives_the_same_trajectory(simulate, name, scene):
    values, step, steps = SCENES[scene]
    run = {"step": step, "steps": steps, "tolerance": TOLERANCE}
    other = numbers(simulate(name, values, OUTPUTS, **run))
    linux = numbers(simulate("linux64", values, OUTPUTS, **run))
    assert linux.shape == other.shape == (steps, len(OUTPUTS))
    assert np.ptp(linux[:, 0]) > 0.01, "the actuator moves"
    same = other == linux  # among them infinities: no threshold
    difference = np.abs(other[~same] - linux[~same]) / np.maximum(1, np.abs(linux[~same]))
    worst, equal = difference.max(initial=0.0), same.mean()
    print(f"\n{name}, {scene}: largest difference {worst:.1e}, {equal:.1%} equal bit for bit", end=" ")
    assert worst <= LIMIT


@pytest.mark.parametrize("name", OTHERS)
def test_every_platform_speaks_through_the_logger(simulate, name):
    """A refused value ends the host with the call's name and the unit's message."""
    with pytest.raises(AssertionError, match=r"(?s)below its minimum.*fmi2SetReal returned 3"):
        simulate(name, {"c": -1.0}, OUTPUTS, step=0.1, steps=1, tolerance=TOLERANCE)
