"""The built-in harmonic drive; the page is docs/accuracy.md."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import allowed_errors as allowed
import references
import turning_points


@pytest.mark.parametrize("reference", references.driven_amplitudes(), ids=lambda r: f"omega={r.omega_ac:g}")
def test_amplitude_at_a_given_frequency(actuator, reference):
    response = actuator.run(
        reference.scene(),
        stop_time=reference.stop_time,
        communication_step=0.125,
        outputs=turning_points.OUTPUTS,
        tolerance=allowed.TOLERANCE,
    )
    assert abs(turning_points.thickness_amplitude(response) - reference.amplitude) <= allowed.AMPLITUDE


def test_total_voltage_is_input_plus_drive(actuator):
    response = actuator.run(
        {"phi": 0.1, "phi_ac": 0.3, "omega_ac": 0.7, "phase_ac": 0.4},
        stop_time=20.0,
        communication_step=0.37,
        outputs=["phi_total"],
    )
    expected = 0.1 + 0.3 * np.sin(0.7 * response["time"] + 0.4)
    assert np.abs(response["phi_total"] - expected).max() <= 1e-14


def test_a_drive_of_frequency_zero_is_a_constant_voltage(actuator):
    surface = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
    run = dict(stop_time=100.0, communication_step=1.3, tolerance=allowed.TOLERANCE)
    driven = actuator.run({**surface, "phi": 0.2, "phi_ac": 0.8, "phase_ac": math.asin(0.5)}, **run)
    constant = actuator.run({**surface, "phi": 0.6}, **run)
    assert np.abs(driven["lambda"] - constant["lambda"]).max() <= allowed.SAME_MOTION


def test_the_sign_of_the_voltage_does_not_matter(actuator):
    """The voltage enters as φ²: half a period of phase changes nothing."""
    run = dict(stop_time=100.0, communication_step=1.3, tolerance=allowed.TOLERANCE)
    one = actuator.run({"phi_ac": 0.3, "omega_ac": 0.1471}, **run)
    other = actuator.run({"phi_ac": 0.3, "omega_ac": 0.1471, "phase_ac": math.pi}, **run)
    assert np.ptp(one["lambda"]) > 0.01
    assert np.abs(one["lambda"] - other["lambda"]).max() <= allowed.SAME_MOTION


def test_an_input_that_is_a_function_of_time_approaches_the_drive(actuator):
    """Held inputs lag: the error of a held sine falls in proportion to the communication step."""
    run = dict(stop_time=40.0, tolerance=allowed.TOLERANCE)
    exact = actuator.run({"phi_ac": 0.3, "omega_ac": 0.1471}, communication_step=40.0, **run)["lambda"][-1]

    def held_sine(time):
        return 0.3 * math.sin(0.1471 * time)

    errors = [
        actuator.run({"phi": held_sine}, communication_step=step, **run)["lambda"][-1] - exact for step in (0.02, 0.01)
    ]
    assert abs(errors[1]) < 1e-4
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)


def test_a_chirp_keeps_its_phase(actuator):
    """The frequency rises at each of 300 steps from t = 1000 on; DOP853 integrates Eq. 16 (γ_s = τ_s = E_s = 0) with
    the voltage φ_a sin θ, whose phase θ is one more state, θ' = ω."""
    begin, step, amplitude = 1000.0, 0.7, 0.25
    frequencies = 0.05 + 0.001 * np.arange(300)

    def slope(_, state, frequency):
        stretch, rate, angle = state
        force = amplitude**2 * math.sin(angle) ** 2 * stretch**3 - stretch + stretch**-5 + 6 * rate**2 * stretch**-7
        return [rate, force / (100.0 + 2.0 * stretch**-6), frequency]

    def follow(state, span, frequency):
        end = solve_ivp(slope, (0.0, span), state, "DOP853", args=(frequency,), rtol=1e-12, atol=1e-14)
        return end.y[:, -1]

    actuator.start({"phi_ac": amplitude, "omega_ac": 0.05, "phase_ac": 0.4}, tolerance=allowed.TOLERANCE)
    actuator.advance(begin)
    state = np.array([actuator.get("lambda"), actuator.get("lambda_dot"), 0.05 * begin + 0.4])
    worst = 0.0
    for frequency in frequencies:
        actuator.set({"omega_ac": frequency})
        assert actuator.get("phi_total") == pytest.approx(amplitude * math.sin(state[2]), abs=1e-11)
        actuator.advance(step)
        state = follow(state, step, frequency)
        worst = np.max([worst, *np.abs(np.subtract(actuator.get("lambda", "lambda_dot"), state[:2]))])
    assert actuator.get("phase_ac") == 0.4
    assert worst <= allowed.CHIRP, worst


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_the_error_near_the_resonance_is_what_the_page_says(actuator, tolerance):
    """Local errors as the motion amplifies them: 177, 110, 18, 1 and 2 times these tolerances, as -rP prints."""
    scene = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2, "phi_ac": 0.3, "omega_ac": 0.1438}
    exact = 1.2282643168243128

    def missed(start, tolerance):
        actuator.start({**scene, "lambda_start": start}, tolerance=tolerance)
        actuator.advance(5000.0)
        return abs(actuator.get("lambda") / exact - 1.0)

    multiple = missed(1.0, tolerance) / tolerance
    amplification = missed(1.0 + 1e-8, 1e-14) / 1e-8
    print(f"{multiple:.1f} times {tolerance:g}; a deviation at the start grows {amplification:.0f} times")
    assert multiple < amplification


@pytest.mark.parametrize(("periods", "said"), [(36_704, 1.6e-11), (36_704_325, 1.4e-8)])
def test_a_continued_motion_is_off_by_what_the_page_says(actuator, periods, said):
    """t = 1e6 and 1e9: the time by which it is early or late, times the largest rate of the motion."""
    period = 27.2447459677505316
    actuator.start({"phi": 0.6, "tau_s": 0.05, "E_s": 0.2})
    actuator.advance(periods * period)
    shift = actuator.get("lambda_dot") / actuator.get("lambda_ddot")
    off = abs(shift) * 0.0107
    print(f"{off:.2g}")
    assert said / 10 < off < 10 * said
