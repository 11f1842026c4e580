"""CasADi: a host of model exchange that optimizes. It sets the states by their value references, and takes its
Jacobians from the directional derivatives."""

import fmpy
import numpy as np
import pytest

casadi = pytest.importorskip("casadi", reason="casadi is missing (tests/hosts/requirements.txt)")

POINTS = [([1.0, 0.0], [0.3, 0.0]), ([1.25, 0.04], [0.5, 0.125]), ([0.8, -0.1], [0.0, -0.2])]
C = 100.0
"""The start value of `c`; the surface parameters are 0."""


@pytest.fixture(scope="module")
def builder(fmu, tmp_path_factory):
    folder = fmpy.extract(str(fmu), unzipdir=str(tmp_path_factory.mktemp("casadi")))
    return casadi.DaeBuilder("actuator", str(folder))


def acceleration(state, inputs):
    """Eq. 16, solved for the second derivative, in CasADi's symbols or numbers."""
    stretch, rate, phi, prestress = state[0], state[1], inputs[0], inputs[1]
    force = 6 * rate**2 / stretch**7 - stretch + 1 / stretch**5 + prestress + phi**2 * stretch**3
    return force / (C + 2 / stretch**6)


def test_it_finds_states_inputs_and_outputs(builder):
    assert builder.x() == ["lambda", "lambda_dot"]
    assert builder.u() == ["phi", "S"]
    assert builder.y() == ["lambda", "lambda3", "collapsed"]


@pytest.mark.parametrize(("state", "inputs"), POINTS)
def test_derivatives_and_jacobians_are_those_of_the_equation(builder, state, inputs):
    x, u = casadi.SX.sym("x", 2), casadi.SX.sym("u", 2)
    ode = casadi.vertcat(x[1], acceleration(x, u))
    output = casadi.vertcat(x[0], x[0] ** -2, 0)
    exact = casadi.Function("exact", [x, u], [ode, output], ["x", "u"], ["ode", "y"])
    ours = builder.create("ours", ["x", "u"], ["ode", "y"])
    for name, wanted in (("ode", 0), ("y", 1)):
        assert np.abs(np.array(ours(state, inputs)[wanted] - exact(state, inputs)[wanted])).max() < 1e-14, name
    wanted = ["jac:ode:x", "jac:ode:u", "jac:y:x", "jac:y:u"]
    for found, expected in zip(
        ours.factory("jacobians", ["x", "u"], wanted)(state, inputs),
        exact.factory("jacobians", ["x", "u"], wanted)(state, inputs),
        strict=True,
    ):
        assert np.abs(np.array(casadi.densify(found - expected))).max() < 1e-13


def test_it_integrates_the_motion(builder):
    """CVODES over the FMU, with its Jacobians, against the equation in symbols."""
    state, inputs = POINTS[1]
    ours = builder.create("ours", ["x", "u"], ["ode"])
    x, u = casadi.MX.sym("x", 2), casadi.MX.sym("u", 2)
    options = {"abstol": 1e-12, "reltol": 1e-10, "max_num_steps": 100_000}
    ends = []
    for ode in (ours(x, u), casadi.vertcat(x[1], acceleration(x, u))):
        problem = {"x": x, "u": u, "ode": ode}
        integrator = casadi.integrator("motion", "cvodes", problem, 0.0, 20.0, options)
        ends.append(np.array(integrator(x0=state, u=inputs)["xf"]))
    assert np.abs(ends[0] - ends[1]).max() < 1e-7
    assert np.abs(ends[0] - np.reshape(state, (2, 1))).max() > 1e-3
