"""The class `Actuator` of the installed package."""

import math

import numpy as np
import pytest

from dielectric_actuator import Actuator, FMICallException, UnknownName, frame, packed_fmu

SURFACE_EFFECTS = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}


def test_a_run_has_a_row_for_each_communication_point(actuator):
    response = actuator.run({"phi": 0.3}, stop_time=1.0, communication_step=0.3, outputs=["lambda", "pulled_in"])
    assert response["time"].tolist() == pytest.approx([0, 0.3, 0.6, 0.9, 1.0])
    assert response.dtype["pulled_in"] == np.bool_ and response["lambda"][0] == 1.0


def test_a_response_becomes_a_table(actuator):
    table = frame(actuator.run({"phi": 0.3}, stop_time=1.0, communication_step=0.5))
    assert list(table.columns) == ["lambda", "lambda3"] and table.index.tolist() == [0.0, 0.5, 1.0]


def test_variables_have_units_and_descriptions(actuator):
    assert actuator.variables["phi"].unit == "1" and "voltage" in actuator.variables["phi"].description


@pytest.mark.parametrize(
    "call",
    [
        lambda actuator: actuator.start({"lamda_start": 1.1}),
        lambda actuator: actuator.get("lamda_start"),
        lambda actuator: actuator.run({}, stop_time=1.0, communication_step=1.0, outputs=["lamda_start"]),
        lambda actuator: actuator.directional_derivatives(["lambda_ddot"], "lamda_start"),
    ],
)
def test_an_unknown_name_gets_a_suggestion(actuator, call):
    actuator.start({})
    with pytest.raises(UnknownName, match="no variable 'lamda_start'; did you mean lambda_start"):
        call(actuator)


def test_a_refused_value_is_explained(actuator):
    with pytest.raises(FMICallException) as refusal:
        actuator.start({"c": -1.0})
    assert any("c" in note and "-1" in note for note in refusal.value.__notes__)


def test_a_missing_fmu_says_what_to_do(tmp_path):
    with pytest.raises(FileNotFoundError, match="make fmu"):
        Actuator(tmp_path / "none.fmu")


def test_a_saved_state_goes_on_in_another_instance_bit_for_bit(actuator):
    actuator.start({**SURFACE_EFFECTS, "phi_ac": 0.3, "omega_ac": 0.1438}, start_time=2.0)
    actuator.advance(13.7)
    saved = actuator.save()
    with Actuator() as other:
        other.restore(saved)
        assert other.time == actuator.time == pytest.approx(15.7)
        for running in (actuator, other):
            running.advance(20.3)
        assert other.get("lambda", "lambda_dot") == actuator.get("lambda", "lambda_dot")
        other.start({"phi": 0.2})
        assert other.get("phi", "lambda") == [0.2, 1.0]


def test_the_clock_of_many_steps_does_not_drift(actuator):
    actuator.start({"phi": 0.3}, start_time=5.0)
    for _ in range(120_000):
        actuator.advance(0.01)
    assert actuator.time == pytest.approx(1205.0, rel=4e-16)
    # a clock that is set leaves nothing of the former one behind
    actuator.start({"phi": 0.3})
    actuator.time = -1e-9
    actuator.advance(0.5)
    assert actuator.time == 0.5 - 1e-9


def test_looking_ahead_leaves_no_trace(actuator):
    actuator.start({"phi": 0.4})
    actuator.advance(5.0)
    before = actuator.get("lambda", "lambda_dot")
    with actuator.looking_ahead():
        actuator.set({"phi": 0.6})
        actuator.advance(7.0)
        assert actuator.get("lambda") != before[0]
    assert actuator.get("lambda", "lambda_dot") == before and actuator.time == 5.0


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"phi": 0.3, "S": 0.2},
        SURFACE_EFFECTS,
        {**SURFACE_EFFECTS, "phi": 0.5},
        {"gamma_s": 0.3, "tau_s": 0.05},
    ],
)
def test_a_start_at_equilibrium_does_not_move(actuator, values):
    stretch = actuator.equilibrium(values)
    actuator.start(values, at_equilibrium=True)
    assert actuator.get("lambda") == stretch
    actuator.advance(200.0)
    assert actuator.get("lambda") == pytest.approx(stretch, abs=1e-14)
    assert abs(actuator.get("lambda_dot")) < 1e-15
    # stable, and the smallest: below it the actuator is pushed up to it, whatever the stretch
    assert actuator.directional_derivatives(["lambda_ddot"], "lambda")[0] < 0


def test_with_surface_effects_a_stretch_of_1_is_no_equilibrium(actuator):
    assert actuator.equilibrium({}) == 1.0
    # Eq. 16 at rest, times λ⁵, in x = λ²: 4τ x⁴ + (1 + 2γ − 2τ) x³ = 1
    gamma, tau = 0.05, 0.03
    roots = np.roots([4 * tau, 1 + 2 * gamma - 2 * tau, 0, 0, -1])
    (square,) = roots[np.isreal(roots) & (roots.real > 0)].real
    assert actuator.equilibrium({"gamma_s": gamma, "tau_s": tau}) == pytest.approx(math.sqrt(square), rel=1e-14)


def test_equilibria_are_told_apart_up_to_the_static_threshold(actuator):
    actuator.start({})
    threshold, thickness = actuator.get("phi_pull_in_static", "lambda3_pull_in_static")
    below = threshold * (1 - 1e-12)
    # at the fold φ² falls off with the square of the distance
    assert actuator.equilibrium({"phi": below}) == pytest.approx(1 / math.sqrt(thickness), abs=1e-5)
    with pytest.raises(ValueError, match=r"the static pull-in voltage is 0.687365"):
        actuator.equilibrium({"phi": threshold * (1 + 1e-12)})


def test_any_path_is_taken():
    with Actuator(str(packed_fmu())) as actuator:
        actuator.start({})
        assert actuator.get("lambda") == 1.0
