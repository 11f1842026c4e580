"""The model description as FMPy reads it."""

import math

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
