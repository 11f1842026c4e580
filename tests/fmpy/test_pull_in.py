"""Pull-in: the thresholds that the motion shows, and those that the FMU reports."""

import math

import numpy as np
import pytest

import allowed_errors as allowed
import references
import turning_points
from pull_in_search import pull_in_bracket

TABLE_1 = references.table_1()


def of_case(threshold):
    return str(threshold.case)


def voltage_by_motion(actuator, threshold) -> float:
    below, above = pull_in_bracket(
        actuator,
        threshold.case.scene(),
        threshold.dynamic.stretch,
        below=0.5,
        above=1.0,
        resolution=allowed.PULL_IN_RESOLUTION,
    )
    return (below + above) / 2


def test_table_1_has_13_different_rows():
    assert len({threshold.case for threshold in TABLE_1}) == 13


@pytest.mark.parametrize("threshold", TABLE_1, ids=of_case)
def test_pull_in_voltage_of_the_motion(actuator, threshold):
    assert abs(voltage_by_motion(actuator, threshold) - threshold.dynamic.phi) <= allowed.PULL_IN_BY_MOTION


def test_the_one_entry_of_table_1_that_is_rounded_wrongly(actuator):
    (threshold,) = [threshold for threshold in TABLE_1 if threshold.case.E_s == 0.029]
    voltage = voltage_by_motion(actuator, threshold)
    assert threshold.printed_phi == "0.6899"
    assert f"{voltage:.5f}" == "0.68985"
    assert f"{voltage:.4f}" == "0.6898"


@pytest.mark.parametrize("threshold", TABLE_1 + references.combined_thresholds(), ids=of_case)
def test_reported_thresholds(actuator, threshold):
    actuator.start(threshold.case.scene())
    relative = allowed.THRESHOLD_RELATIVE if threshold in TABLE_1 else allowed.THRESHOLD_RELATIVE_TO_14_DIGITS
    for kind, exact in (("", threshold.dynamic), ("_static", threshold.static)):
        voltage, lambda3 = actuator.get(f"phi_pull_in{kind}", f"lambda3_pull_in{kind}")
        if exact.exists:
            assert voltage == pytest.approx(exact.phi, rel=relative, abs=0)
            assert lambda3 == pytest.approx(exact.lambda3, rel=relative, abs=0)
        else:
            assert (voltage, lambda3) == (math.inf, 0.0)


@pytest.mark.parametrize("threshold", TABLE_1, ids=of_case)
def test_reported_static_fold_is_an_equilibrium(actuator, threshold):
    actuator.start(threshold.case.scene())
    voltage, lambda3 = actuator.get("phi_pull_in_static", "lambda3_pull_in_static")
    actuator.start(threshold.case.scene(phi=voltage, lambda_start=lambda3**-0.5))
    assert abs(actuator.get("lambda_ddot")) <= allowed.EQUILIBRIUM


@pytest.mark.parametrize("common_part", [0.0, 0.03], ids=["", "both raised"])
@pytest.mark.parametrize("cusp", references.cusps(), ids=lambda c: f"{c.kind} g-t={c.gamma_s_minus_tau_s:g} S={c.S:g}")
def test_fold_just_below_its_cusp_and_none_just_above(actuator, cusp, common_part):
    """The cusp depends on γ_s − τ_s only, so raising both moves nothing but φ² by 4τ_s."""
    case = {
        "gamma_s": max(cusp.gamma_s_minus_tau_s, 0) + common_part,
        "tau_s": max(-cusp.gamma_s_minus_tau_s, 0) + common_part,
        "S": cusp.S,
    }
    suffix = "_static" if cusp.kind == "static" else ""
    names = (f"phi_pull_in{suffix}", f"lambda3_pull_in{suffix}")

    actuator.start({**case, "E_s": cusp.E_s * (1 - allowed.CUSP_OFFSET)})
    voltage, lambda3 = actuator.get(*names)
    assert abs(lambda3 - cusp.lambda3) <= allowed.CUSP_STRETCH
    if cusp.shifted_phi_squared is not None:
        assert abs(voltage**2 - 4 * case["tau_s"] - cusp.shifted_phi_squared) <= allowed.CUSP_VOLTAGE

    actuator.start({**case, "E_s": cusp.E_s * (1 + allowed.CUSP_OFFSET)})
    assert actuator.get(*names) == [math.inf, 0.0]


def overshoots_at_the_crossing(actuator, E_s: float, saddle_stretch: float) -> tuple[float, float]:
    """Thickness stretches where the motion first turns, at two voltages 1e-9 apart between which the
    overshoot passes `saddle_stretch`."""
    turned = []
    for voltage in pull_in_bracket(actuator, {"E_s": E_s}, saddle_stretch, below=0.5, above=1.0, resolution=1e-9):
        response = actuator.run(
            {"E_s": E_s, "phi": voltage},
            stop_time=1000.0,
            communication_step=0.5,
            outputs=turning_points.OUTPUTS,
            tolerance=allowed.TOLERANCE,
        )
        _, stretches = turning_points.turning_points(response)
        turned.append(stretches[0] ** -2)
    return tuple(turned)


def test_the_overshoot_jumps_below_the_cusp_and_grows_smoothly_above(actuator):
    """E* = 0.02952. 2 % below it, the overshoot leaps over the stretches between the saddle and the far side
    of the larger orbit; 2 % above, it passes the cusp's stretch without a leap."""
    (cusp,) = [c for c in references.cusps() if (c.kind, c.gamma_s_minus_tau_s, c.S) == ("dynamic", 0, 0)]
    (fold,) = [threshold.dynamic for threshold in TABLE_1 if threshold.case.E_s == 0.029]

    thick, thin = overshoots_at_the_crossing(actuator, 0.029, fold.stretch)
    assert thick > fold.lambda3 > 0.29 > thin
    thick, thin = overshoots_at_the_crossing(actuator, 1.02 * cusp.E_s, cusp.lambda3**-0.5)
    assert 0 < thick - thin < 1e-5


@pytest.mark.parametrize("E_s", [0.007, 0.015, 0.021, 0.029])
def test_with_surface_elasticity_the_motion_past_pull_in_is_a_larger_periodic_orbit(actuator, E_s):
    (threshold,) = [threshold for threshold in TABLE_1 if threshold.case.E_s == E_s]
    scene = threshold.case.scene(phi=threshold.dynamic.phi + 1e-4)
    response = actuator.run(
        scene,
        stop_time=400.0,
        communication_step=0.1,
        outputs=(*turning_points.OUTPUTS, "pulled_in", "hamiltonian"),
        tolerance=allowed.TOLERANCE,
    )
    assert not response["pulled_in"].any()
    largest_term = scene["phi"] ** 2 * response["lambda"].max() ** 4
    assert np.abs(response["hamiltonian"]).max() <= allowed.ENERGY * largest_term
    _, stretches = turning_points.turning_points(response)
    assert stretches[0] ** -2 < threshold.dynamic.lambda3 - 0.05
    # Eq. 19 at the overshoot
    x, phi = stretches[0], scene["phi"]
    overshoot = 2 * x**2 + x**-4 - 3 - phi**2 * (x**4 - 1) + 2 * E_s * x**2 * (x**2 - 1) ** 2
    assert abs(overshoot) <= allowed.ENERGY * largest_term
    assert abs(stretches[1] - 1) <= allowed.RETURN


def test_margin_is_the_distance_of_the_total_voltage(actuator):
    actuator.start({"phi": 0.2, "phi_ac": 0.3, "phase_ac": -math.pi / 2})
    total, threshold, margin = actuator.get("phi_total", "phi_pull_in", "pull_in_margin")
    assert total == pytest.approx(-0.1, abs=1e-16)
    assert margin == pytest.approx(threshold - 0.1, abs=1e-15)


def test_thresholds_follow_parameters_between_steps(actuator):
    ideal, stiffer = TABLE_1[0], TABLE_1[1]
    actuator.start({"phi": 0.3})
    actuator.advance(5.0)
    assert actuator.get("phi_pull_in") == pytest.approx(ideal.dynamic.phi, rel=allowed.THRESHOLD_RELATIVE, abs=0)
    actuator.set({"gamma_s": stiffer.case.gamma_s})
    assert actuator.get("phi_pull_in") == pytest.approx(stiffer.dynamic.phi, rel=allowed.THRESHOLD_RELATIVE, abs=0)
