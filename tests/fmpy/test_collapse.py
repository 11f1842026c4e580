"""Reaching lambda_max or lambda_min: located, reported, and held or ended as the user asked."""

import numpy as np
import pytest

import allowed_errors as allowed
import references

HOLD, TERMINATE = 1, 2


def time_from_limit_to_infinity(escape, limit: float) -> float:
    """∫ dλ/(dλ/dt) from `limit` to ∞ on the ideal actuator's orbit from rest (Eq. 19), in u = 1/λ.

    In u the integrand is smooth down to 0, so that 40 Gauss-Legendre nodes reach rounding.
    """
    nodes, weights = np.polynomial.legendre.leggauss(40)
    u = (nodes + 1) / 2 / limit
    minus_energy = escape.phi**2 * (1 - u**4) - (2 * u**2 + u**8 - 3 * u**4)
    return float(np.sum(weights * np.sqrt(2 * (escape.c + 2 * u**6) / minus_energy)) / 2 / limit)


@pytest.mark.parametrize("limit", [10.0, 3.0])
@pytest.mark.parametrize("communication_step", [0.3, 7.0, 1000.0])
@pytest.mark.parametrize("escape", references.ideal_escapes(), ids=lambda escape: f"phi={escape.phi:g}")
def test_escape_is_located(actuator, escape, communication_step, limit):
    actuator.start(
        {"c": escape.c, "phi": escape.phi, "lambda_max": limit, "on_pull_in": TERMINATE}, tolerance=allowed.TOLERANCE
    )
    while actuator.advance(communication_step):
        assert actuator.time < 100
    assert actuator.get("pulled_in", "lambda") == [True, pytest.approx(limit, rel=1e-12)]
    assert actuator.get("pull_in_time") == actuator.time
    infinite = actuator.time + time_from_limit_to_infinity(escape, limit)
    assert abs(infinite - escape.time) <= allowed.ESCAPE


def test_hold_keeps_the_limit_and_the_time_goes_on(actuator):
    response = actuator.run(
        {"phi": 0.7, "on_pull_in": HOLD},
        stop_time=60.0,
        communication_step=0.5,
        outputs=["lambda", "lambda3", "lambda_dot", "pulled_in", "pull_in_time"],
        tolerance=allowed.TOLERANCE,
    )
    assert response["time"][-1] == 60.0
    instant = response["pull_in_time"][-1]
    before, after = response[response["time"] < instant], response[response["time"] >= instant]
    assert 30 < instant < 45
    assert not before["pulled_in"].any() and after["pulled_in"].all()
    assert np.isposinf(before["pull_in_time"]).all() and (after["pull_in_time"] == instant).all()
    assert (after["lambda"] == 10.0).all()
    assert after["lambda3"] == pytest.approx(0.01, rel=1e-14)
    assert len(set(after["lambda_dot"])) == 1
    assert (np.diff(before["lambda"]) > 0).all()


def test_collapse_is_logged_once(actuator):
    actuator.run({"phi": 0.7}, stop_time=100.0, communication_step=1.0)
    told = [message.text for message in actuator.messages if "lambda_max" in message.text]
    assert len(told) == 1
    assert "10" in told[0]


def test_contraction_to_lambda_min(actuator):
    """γ_s > 0 without voltage contracts (F₁ = −2γ_s); its own limit, its own message."""
    scene = {"gamma_s": 0.3, "lambda_min": 0.9}
    response = actuator.run(
        scene, stop_time=20.0, communication_step=0.1, outputs=["lambda", "pulled_in"], tolerance=allowed.TOLERANCE
    )
    assert response["pulled_in"][-1]
    assert response["lambda"][-1] == 0.9
    assert len([message for message in actuator.messages if "lambda_min" in message.text]) == 1
    # a free run passes the limit at the instant that was reported
    instant = actuator.get("pull_in_time")
    actuator.start({"gamma_s": 0.3}, tolerance=allowed.TOLERANCE)
    actuator.advance(instant)
    assert actuator.get("lambda") == pytest.approx(0.9, abs=1e-11)
