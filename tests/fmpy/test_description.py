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
    instance = description.coSimulation
    assert instance.canHandleVariableCommunicationStepSize and instance.canInterpolateInputs
    assert instance.maxOutputDerivativeOrder == 1
    assert not instance.canRunAsynchronuously


def test_what_connects_is_real(description):
    """Hosts that know neither Booleans nor enumerations can run it."""
    for variable in description.modelVariables:
        if variable.causality in ("input", "output"):
            assert variable.type == "Real", variable.name


def test_the_stretch_has_a_name_that_is_no_keyword(description, reference_of):
    assert reference_of["stretch"] == reference_of["lambda"]
    (alias,) = [variable for variable in description.modelVariables if variable.name == "stretch"]
    assert (alias.type, alias.causality, alias.start, alias.derivative) == ("Real", "local", None, None)
    references = [v.valueReference for v in description.modelVariables if v.name != "stretch"]
    assert len(set(references)) == len(references)


def test_a_variable_that_may_be_infinite_says_so_and_declares_no_maximum(actuator, description):
    actuator.start({"E_s": 0.2})
    infinite = {v.name for v in description.modelVariables if math.isinf(actuator.get(v.name))}
    assert infinite == {"phi_pull_in", "phi_pull_in_static", "pull_in_margin", "pull_in_time"}
    for variable in description.modelVariables:
        says_so = "+inf, which JSON cannot hold" in variable.description
        assert says_so == (variable.name in infinite), variable.name
        assert not says_so or variable.max is None, variable.name


def test_no_tolerance_is_meant_for_two_integrators(description):
    assert description.defaultExperiment.tolerance is None


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

    assert dependencies(description.outputs) == {"lambda": {"lambda"}, "lambda3": {"lambda"}, "collapsed": set()}
    assert dependencies(description.derivatives)["lambda_ddot"] == {"phi", "S", "lambda", "lambda_dot"}
    initial = dependencies(description.initialUnknowns)
    assert set(initial) == {"lambda", "lambda3", "collapsed", "lambda_dot", "lambda_ddot"}
    assert initial["lambda3"] == {"lambda_start"}
