"""Constant voltage: the motion is periodic, with the period, the turning points and the energy of quadrature."""

import numpy as np
import pytest

import allowed_errors as allowed
import references
import turning_points

ORBITS = [*references.dc_orbits(), references.appendix_a_orbit()]


@pytest.fixture(params=ORBITS, ids=lambda orbit: f"{orbit.case} phi={orbit.phi:g} c={orbit.c:g}")
def orbit(request):
    return request.param


def test_there_are_the_fourteen_sets_of_figures_2_and_3():
    assert len({orbit.case for orbit in references.dc_orbits()}) == 14


def test_period_and_turning_stretch_of_the_motion(actuator, orbit):
    response = actuator.run(
        orbit.scene(),
        stop_time=1.05 * orbit.period,
        communication_step=orbit.period / 250,
        outputs=turning_points.OUTPUTS,
        tolerance=allowed.TOLERANCE,
    )
    period, stretch = turning_points.period_and_overshoot(response)
    assert period == pytest.approx(orbit.period, rel=allowed.PERIOD_RELATIVE, abs=0)
    assert stretch**-2 == pytest.approx(orbit.turning_lambda3, rel=allowed.TURN_RELATIVE, abs=0)


@pytest.mark.parametrize("steps", [1, 37])
def test_stepping_to_the_exact_turning_point_and_back(actuator, orbit, steps):
    """No interpolation here: the communication points themselves fall on half a period and on a period."""
    actuator.start(orbit.scene(), tolerance=allowed.TOLERANCE)
    for _ in range(steps):
        actuator.advance(orbit.period / 2 / steps)
    lambda3, rate = actuator.get("lambda3", "lambda_dot")
    assert lambda3 == pytest.approx(orbit.turning_lambda3, rel=allowed.TURN_RELATIVE, abs=0)
    assert abs(rate) <= allowed.TURNING_RATE

    for _ in range(steps):
        actuator.advance(orbit.period / 2 / steps)
    stretch, rate = actuator.get("lambda", "lambda_dot")
    assert abs(stretch - 1) <= allowed.RETURN
    assert abs(rate) <= allowed.RETURN


def test_hamiltonian_stays_constant(actuator, orbit):
    response = actuator.run(
        orbit.scene(),
        stop_time=10 * orbit.period,
        communication_step=orbit.period / 101,
        outputs=["hamiltonian", "lambda"],
        tolerance=allowed.TOLERANCE,
    )
    assert np.ptp(response["lambda"]) > 0.01, "it moves"
    assert np.abs(response["hamiltonian"]).max() <= allowed.ENERGY


def test_outputs_and_rates_agree_with_the_stretch(actuator):
    """λ₃ = 1/λ², its rate, the true field, the acceleration of Eq. 16 and the Hamiltonian, at a moving state."""
    g, tau, E, S, phi, c = 0.05, 0.03, 0.2, 0.4, 0.6, 40.0
    actuator.start({"gamma_s": g, "tau_s": tau, "E_s": E, "S": S, "phi": phi, "c": c, "lambda_dot_start": 0.02})
    actuator.advance(3.7)
    names = ("lambda", "lambda_dot", "lambda_ddot", "lambda3", "lambda3_dot", "electric_field", "phi_total")
    x, v, a, lambda3, lambda3_dot, field, phi_total = actuator.get(*names)
    assert phi_total == phi
    assert lambda3 == pytest.approx(x**-2, rel=1e-14)
    assert lambda3_dot == pytest.approx(-2 * v * x**-3, rel=1e-14)
    assert field == pytest.approx(phi * x**2, rel=1e-14)
    surface = 2 * (g * x + tau * (2 * x**3 - x) + E / 2 * x * (x**2 - 1) * (3 * x**2 - 1))
    residual = (c + 2 * x**-6) * a - 6 * x**-7 * v**2 + x - x**-5 - S - phi**2 * x**3 + surface
    assert abs(residual) <= 1e-14
    energy = 2 * (c + 2 * x**-6) * v**2 + 2 * x**2 + x**-4 - 3 - phi**2 * (x**4 - 1) - 4 * S * (x - 1)
    energy += 4 * (g * (x**2 - 1) + tau * x**2 * (x**2 - 1) + E / 2 * x**2 * (x**2 - 1) ** 2)
    assert actuator.get("hamiltonian") == pytest.approx(energy, abs=1e-14)
