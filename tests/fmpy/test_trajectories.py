"""Trajectories against multiprecision at very different communication steps."""

import pytest

import allowed_errors as allowed
import references
import trajectories


@pytest.mark.parametrize("communication_step", [0.01, 0.37, 1.0, 25.0])
@pytest.mark.parametrize("name", references.TRAJECTORY_SCENES)
def test_trajectory(actuator, name, communication_step):
    worst = trajectories.follow(actuator, name, communication_step, allowed.TOLERANCE)
    assert worst.error <= allowed.TRAJECTORY[name], worst
    assert actuator.time == pytest.approx(references.trajectory(name)["t"][-1], rel=1e-12)


@pytest.mark.parametrize("name", ["case_a", "case_b"])
def test_trajectory_at_the_default_tolerance(actuator, name):
    worst = trajectories.follow(actuator, name, 0.37, None)
    assert worst.error <= allowed.TRAJECTORY_DEFAULT, worst


def test_one_step_over_the_whole_span(actuator):
    for name in references.TRAJECTORY_SCENES:
        last = references.trajectory(name)[-1]
        actuator.start(references.TRAJECTORY_SCENES[name], tolerance=allowed.TOLERANCE)
        actuator.advance(last["t"])
        assert abs(actuator.get("lambda") - last["lam"]) <= allowed.TRAJECTORY[name]
