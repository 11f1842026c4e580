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


def test_after_a_refused_scene_another_is_started():
    with Actuator() as actuator, Actuator() as other:
        with pytest.raises(FMICallException):
            actuator.start({"phi": 0.3, "c": -1.0}, start_time=3.0)
        for one in (actuator, other):
            one.start({"S": 0.1})
            one.advance(2.0)
        assert actuator.get("phi", "lambda") == other.get("phi", "lambda") and actuator.time == 2.0


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


def looked_ahead(actuator):
    with actuator.looking_ahead():
        actuator.set({"phi": 0.6})
        actuator.advance(7.0)


@pytest.mark.parametrize("disturb", [
    looked_ahead,
    lambda actuator: actuator.equilibrium({"phi": 0.2, "S": 0.1}),
    lambda actuator: actuator.restore(actuator.save()),
])  # fmt: skip
def test_what_leaves_no_trace(disturb):
    with Actuator() as actuator, Actuator() as undisturbed:
        for one in (actuator, undisturbed):
            one.start({"phi": 0.4})
            for _ in range(8):
                one.advance(0.7)
        disturb(actuator)
        for one in (actuator, undisturbed):
            for _ in range(8):
                one.advance(0.7)
        assert actuator.get("lambda", "lambda_dot") == undisturbed.get("lambda", "lambda_dot")
        # the clock too, to the last bit: its rounding is carried on
        assert actuator.time == undisturbed.time


def test_what_is_set_before_a_start_is_dropped_each_time():
    with Actuator() as actuator:
        for _ in range(2):
            actuator.set({"phi": 0.4})
            actuator.start({})
            assert actuator.get("phi") == 0.0


@pytest.mark.parametrize("call", [
    lambda actuator: actuator.get("lambda"),
    lambda actuator: actuator.set({"phi": 0.4}),
    lambda actuator: actuator.start({}),
    lambda actuator: actuator.advance(1.0),
    lambda actuator: actuator.save(),
    lambda actuator: actuator.equilibrium({}),
    lambda actuator: actuator.run({}, stop_time=1.0, communication_step=1.0),
])  # fmt: skip
def test_a_closed_actuator_says_so(call):
    with Actuator() as actuator:
        actuator.start({"phi": 0.1})
        actuator.set({"phi": 0.2})
        actuator.get("lambda")
    with pytest.raises(ValueError, match="the actuator is closed"):
        call(actuator)
    assert actuator.variables["phi"].unit == "1" and "closed" in repr(actuator)


def test_a_whole_number_may_be_of_any_type(actuator):
    for number in (1, 1.0, np.int64(1), np.bool_(True)):
        actuator.start({"record_extremes": number, "on_pull_in": 1 + number})
        assert actuator.get("record_extremes", "on_pull_in") == [1, 2]
    for name, number in (("record_extremes", 2), ("on_pull_in", 1.5), ("on_pull_in", math.nan), ("on_pull_in", 1e300)):
        with pytest.raises(ValueError, match=f"{name} is .*; it must be a whole number from"):
            actuator.start({name: number})


@pytest.mark.parametrize("content", [b"", b"PK\x05\x06" + bytes(18)])
def test_a_file_that_is_no_fmu_is_refused(tmp_path, content):
    (tmp_path / "bad.fmu").write_bytes(content)
    with pytest.raises(ValueError, match=r"bad\.fmu cannot be read as an FMU"):
        Actuator(tmp_path / "bad.fmu")


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


def test_there_is_no_equilibrium_where_the_actuator_is_pressed_together(actuator):
    assert 0.05 < actuator.equilibrium({"S": -5.0}) < 0.9
    with pytest.raises(ValueError, match=r"no equilibrium above the stretch 0\.9"):
        actuator.equilibrium({"S": -5.0, "lambda_min": 0.9})


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
