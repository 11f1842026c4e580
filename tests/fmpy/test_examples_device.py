"""The examples on the real device: their FMUs, the orders of the coupling, steady states and hysteresis."""

import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu

import pack
import resonance
from dielectric_actuator import Actuator

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "device"


@pytest.fixture(scope="module")
def units(tmp_path_factory):
    """The packed amplifier, controller and load by name."""
    folder = tmp_path_factory.mktemp("units")
    sources = ("driver/amplifier.c", "driver/controller.c", "load/load.c")
    return {Path(source).stem: pack.pack_linear(EXAMPLE / source, folder) for source in sources}


def program(name: str, si_path: Path, folder: Path, *options: str) -> tuple[str, list[dict[str, np.ndarray]]]:
    """What an example prints, and each of its tables of errors: by way, the numbers of a row."""
    command = [sys.executable, EXAMPLE / f"{name}.py", "--fmu", si_path, "--output", folder, *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    tables: list[dict[str, np.ndarray]] = []
    for line in done.stdout.splitlines():
        if line.startswith("largest error in um"):
            tables.append({})
        elif tables and re.match(r".{20} +(inf|\d\.\de)", line):
            tables[-1][line[:20].strip()] = np.array(line[20:].split(), dtype=float)
    return done.stdout, tables


def order(errors: np.ndarray) -> float:
    """By which power of the step the error falls, over the last two halvings."""
    return float(np.log2(errors[-3] / errors[-1]) / 2)


def test_the_fmus_are_valid(units):
    assert {name: validate_fmu(str(path)) for name, path in units.items()} == {name: [] for name in units}


def test_the_amplifier_stays_within_its_limits(units):
    """Under a ramp beyond the limit, v' = (min(K u, limit) − v)/T in closed form after the limit is reached."""
    constant, limit = 2e-4, 3000.0
    with Actuator(units["amplifier"]) as amplifier:
        amplifier.start({"time_constant": constant, "highest": limit})
        amplifier.set({"command": 0.0})
        amplifier.set_input_derivatives({"command": [3e3]})
        amplifier.advance(1e-3)
        # at t = 1 ms the ramp of 3 V/ms has just come to the limit
        at_limit = 3e6 * (1e-3 - constant * (1 - math.exp(-1e-3 / constant)))
        assert amplifier.get("voltage") == pytest.approx(at_limit, abs=1e-9)
        amplifier.advance(5e-4)
        rest = (at_limit - limit) * math.exp(-5e-4 / constant)
        assert amplifier.get("voltage") == pytest.approx(limit + rest, rel=1e-4)
        amplifier.set({"command": -1.0})
        amplifier.advance(1e-2)
        assert amplifier.get("voltage") == pytest.approx(0.0, abs=1e-9)


def test_the_controller_sees_the_displacement_and_its_derivatives(units):
    """Charge and voltage of a film whose stretch is 1.01 + 0.3 t and whose voltage grows."""
    side, capacitance, time = 20e-3, 1e-10, 1e-3
    charge = np.polynomial.Polynomial([1.01, 0.3]) ** 4 * capacitance * np.polynomial.Polynomial([2e3, 5e5])
    voltage = np.polynomial.Polynomial([2e3, 5e5])
    with Actuator(units["controller"]) as controller:
        controller.start({"side": side, "capacitance": capacitance})
        controller.set({"charge": charge(time), "measured_voltage": voltage(time)})
        derivatives = [float(charge.deriv(k)(time)) for k in range(1, 5)]
        controller.set_input_derivatives({"charge": derivatives, "measured_voltage": [5e5]})
        assert controller.get("estimate") == pytest.approx(side * (0.01 + 0.3 * time), abs=1e-16)
        first, second, third = controller.output_derivatives("estimate", 3)
        assert first == pytest.approx(side * 0.3, rel=1e-12)
        assert abs(second) < 1e-9 and abs(third) < 1e-6
        controller.set({"measured_voltage": 50.0})
        assert controller.get("estimate") == 0.0


def test_the_self_sensing_loop_converges(si_path, tmp_path):
    text, (errors,) = program("driver", si_path, tmp_path, "--stop-time", "10e-3")
    # the amplifier enters its limit inside a step, which bounds the order of the last row
    for name, expected in (("held", 1), ("first derivative", 2)):
        assert order(errors[name]) == pytest.approx(expected, abs=0.25), name
    assert errors["up to the second"][-1] < 0.1 * errors["first derivative"][-1] < 0.1
    assert float(re.search(r"estimate against position: (\S+)", text)[1]) < 1e-10
    assert float(re.search(r"amplifier at a limit: (\S+) ms", text)[1]) > 0.05
    assert (tmp_path / "self_sensing.png").is_file()


def test_a_load_outside_converges_to_the_load_inside(si_path, tmp_path):
    text, (light, heavy) = program("load", si_path, tmp_path, "--stop-time", "2.56e-3")
    differences = [float(found) for found in re.findall(r"inside against SciPy (\S+) um", text)]
    assert len(differences) == 2 and max(differences) < 1e-8
    names = ["held", "first derivative", "up to the second", "up to the third"]
    for errors in (light, heavy):
        assert [order(errors[name]) for name in names] == pytest.approx([1, 2, 3, 4], abs=0.3)
        assert errors["up to the third"][-1] < 1e-5
    # a force that is a step late holds a spring, and never a mass beyond the film's inertia
    assert order(light["FMPy simulate_ssp"]) == pytest.approx(1, abs=0.3)
    assert np.isinf(heavy["FMPy simulate_ssp"]).all()
    assert (tmp_path / "edge_load.png").is_file()


def test_steady_states_are_exact(si_path):
    with Actuator(si_path) as actuator:
        for frequency, exact in resonance.exact_states():
            found = resonance.steady(actuator, frequency)
            assert found[:2] == pytest.approx(exact[:2], abs=1e-12), frequency
            assert found[2] == pytest.approx(exact[2], abs=1e-10), frequency


def test_hysteresis_between_raised_and_lowered_frequency(si_path):
    frequencies = np.arange(582.0, 600.1, 1.0)
    with Actuator(si_path) as actuator:
        up = resonance.sweep(actuator, frequencies)
        down = resonance.sweep(actuator, frequencies[::-1])[::-1]
    apart = frequencies[np.abs(up - down) > 0.01]
    assert len(apart) >= 4 and apart.min() > 582 and apart.max() < 600
    # contiguous, with the larger amplitude where the frequency has fallen
    assert len(apart) == apart.max() - apart.min() + 1
    assert (down[np.isin(frequencies, apart)] > 2 * up[np.isin(frequencies, apart)]).all()
    # next to the jumps the motion settles slowly
    assert np.abs(up - down)[~np.isin(frequencies, apart)].max() < 1e-3
