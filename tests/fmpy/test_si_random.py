"""The FMU in SI units against an independent integration of random devices, and against its own energy balance."""

import math
import random

import pytest

from dielectric_actuator import Actuator
from real_device import RealDevice, random_scene

STORED = [f"energy_{kind}" for kind in ("kinetic", "elastic", "surface", "spring", "branches", "electric")]
LOST = [f"lost_{kind}" for kind in ("damping", "branches", "resistance", "leakage")]
SUPPLIED = ["supplied_electrical", "supplied_mechanical"]


@pytest.fixture(scope="module")
def actuator(si_path):
    with Actuator(si_path) as actuator:
        yield actuator


@pytest.mark.parametrize("seed", range(16))
def test_random_devices(actuator, seed):
    """At communication points that are no ends of steps: steps from a hundredth of a period to several."""
    scene = random_scene(seed)
    device = RealDevice(scene)
    draw = random.Random(1000 + seed)
    period = device.period * device.time
    times = sorted(draw.uniform(0.01, 3.0) * period for _ in range(draw.choice([3, 40])))
    exact = device.solve(times)
    actuator.start({"lambda_max": 20.0, "record_energy": True} | scene, tolerance=1e-12)

    def balance() -> tuple[float, float]:
        stored, lost, supplied = (actuator.get(*names) for names in (STORED, LOST, SUPPLIED))
        return sum(stored) + sum(lost) - sum(supplied), max(map(abs, [*stored, *lost, *supplied]))

    at_start, largest = balance()
    for column, time in enumerate(times):
        actuator.advance(time - actuator.time)
        stretch, rate = actuator.get("lambda", "lambda_dot")
        assert stretch == pytest.approx(exact[0, column], abs=1e-9)
        assert rate * device.time * math.sqrt(device.inertia) == pytest.approx(
            exact[1, column] * math.sqrt(device.inertia), abs=1e-8
        )
        places = iter(exact[2:, column])
        if device.holds_charge:
            assert actuator.get("charge") == pytest.approx(next(places) * device.coulombs, abs=1e-9 * device.coulombs)
        for k, dashpot in enumerate(places, start=1):
            assert actuator.get(f"xi{k}") == pytest.approx(dashpot, abs=1e-9)
        residual, size = balance()
        largest = max(largest, size)
        assert abs(residual - at_start) < 1e-10 * largest
    assert actuator.get("pulled_in") == 0
