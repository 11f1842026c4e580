"""The model description as FMPy reads it."""

import math
import zipfile
from xml.etree import ElementTree

import fmpy
from fmpy.validation import validate_fmu


def test_fmpy_finds_no_problem(fmu_path):
    assert validate_fmu(str(fmu_path)) == []


def test_fmpy_can_simulate_it_here(fmu_path):
    assert fmpy.platform in fmpy.supported_platforms(str(fmu_path))


def test_start_values_are_those_of_the_instance(actuator, description):
    actuator.start({})
    booleans = {"false": 0.0, "true": 1.0}
    declared = {
        v.name: booleans[v.start] if v.type == "Boolean" else float(v.start)
        for v in description.modelVariables
        if v.start is not None
    }
    assert len(declared) >= 14, "two inputs and at least twelve parameters declare start values"
    assert {name: float(actuator.get(name)) for name in declared} == declared


def test_every_variable_can_be_read(actuator, description):
    actuator.start({"phi": 0.6})
    actuator.advance(1.0)
    for variable in description.modelVariables:
        assert not math.isnan(actuator.get(variable.name)), variable.name


def test_capabilities_are_declared(description):
    for interface in (description.coSimulation, description.modelExchange):
        assert interface.modelIdentifier == description.modelName
        assert interface.canGetAndSetFMUstate and interface.canSerializeFMUstate
        assert interface.providesDirectionalDerivative
        assert not interface.canBeInstantiatedOnlyOncePerProcess
    slave = description.coSimulation
    assert slave.canHandleVariableCommunicationStepSize and slave.canInterpolateInputs
    assert slave.maxOutputDerivativeOrder == 1
    assert not slave.canRunAsynchronuously


def test_states_may_jump_at_a_collapse(fmu_path):
    """FMPy 0.3.32 does not read this attribute of FMI 2."""
    with zipfile.ZipFile(fmu_path) as archive:
        variables = ElementTree.fromstring(archive.read("modelDescription.xml")).iter("ScalarVariable")
    jumping = [variable.get("name") for variable in variables if variable.find("Real[@reinit='true']") is not None]
    assert jumping == ["lambda", "lambda_dot"]


def test_model_structure_lists_states_and_dependencies(description):
    assert (description.numberOfContinuousStates, description.numberOfEventIndicators) == (2, 2)
    derivatives = {d.variable.name: d.variable.derivative.name for d in description.derivatives}
    assert derivatives == {"lambda_dot": "lambda", "lambda_ddot": "lambda_dot"}

    def dependencies(unknowns):
        return {u.variable.name: {known.name for known in u.dependencies} for u in unknowns}

    assert dependencies(description.outputs) == {"lambda": {"lambda"}, "lambda3": {"lambda"}, "pulled_in": set()}
    assert dependencies(description.derivatives)["lambda_ddot"] == {"phi", "S", "lambda", "lambda_dot"}
    initial = dependencies(description.initialUnknowns)
    assert set(initial) == {"lambda", "lambda3", "pulled_in", "lambda_dot", "lambda_ddot"}
    assert initial["lambda3"] == {"lambda_start"}
