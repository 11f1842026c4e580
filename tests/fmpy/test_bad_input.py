"""Bad input: fmi2Error, a message that names value and limit, and nothing changed."""

import math
import re

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Error

STEPS = 5


def initializing(instance):
    """In initialization mode, the first phase in which variables can be read."""
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    return instance


def started(instance, reference_of, **scene):
    """Out of initialization mode, with a moving scene."""
    scene = {"phi": 0.6, "gamma_s": 0.05} | scene
    instance.setupExperiment(startTime=0.0, stopTime=100.0)
    instance.setReal([reference_of[name] for name in scene], list(scene.values()))
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    return instance


def everything(instance, description):
    """All variables of the instance; NaN cannot hide here, every value compares equal to itself."""
    values = {}
    for variable in description.modelVariables:
        kind = "Integer" if variable.type == "Enumeration" else variable.type
        (values[variable.name],) = getattr(instance, f"get{kind}")([variable.valueReference])
    return values


def refused(instance, description, call, *arguments) -> str:
    """Make a call that must be refused; return what was logged, after checking that nothing changed."""
    before = everything(instance, description)
    told = len(instance.log)
    with pytest.raises(FMICallException) as refusal:
        call(*arguments)
    assert refusal.value.status == fmi2Error
    assert everything(instance, description) == before
    messages = instance.log[told:]
    assert messages and all(message.status == fmi2Error for message in messages)
    return "\n".join(message.text for message in messages)


def numbers_in(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?", text)]


def settable(description, kind="Real"):
    """Inputs and parameters of one type."""
    return [v for v in description.modelVariables if v.causality in ("input", "parameter") and v.type == kind]


def outside(variable):
    """Values beyond the declared limits, each with the limit that it breaks."""
    if variable.min is not None:
        limit = float(variable.min)
        yield limit - max(1.0, abs(limit)), limit
    if variable.max is not None:
        limit = float(variable.max)
        yield limit + max(1.0, abs(limit)), limit


def test_every_input_and_parameter_declares_both_limits(description):
    assert len(settable(description)) == 15
    for variable in settable(description):
        assert variable.min is not None and variable.max is not None, variable.name


def test_value_out_of_range(instantiate, description):
    instance = initializing(instantiate())
    for variable in settable(description):
        for value, limit in outside(variable):
            text = refused(instance, description, instance.setReal, [variable.valueReference], [value])
            assert variable.name in text
            assert value in numbers_in(text), f"{value} is not named in: {text}"
            assert limit in numbers_in(text), f"{limit} is not named in: {text}"


def test_tunable_value_out_of_range_between_steps(instantiate, description, reference_of):
    instance = started(instantiate(), reference_of)
    instance.doStep(0.0, 1.0)
    for variable in settable(description):
        if variable.variability == "fixed":
            continue
        for value, limit in outside(variable):
            text = refused(instance, description, instance.setReal, [variable.valueReference], [value])
            assert variable.name in text and {value, limit} <= set(numbers_in(text))


@pytest.mark.parametrize(
    ("name", "value", "conversion"),
    [
        ("phi", 1000.0, "volts*sqrt(eps/mu)/H"),
        ("phi_ac", 230.0, "volts*sqrt(eps/mu)/H"),
        ("S", 1e5, "force/(mu*H*L)"),
        ("phase_ac", 90.0, "degrees*pi/180"),
        ("omega_ac", 6283.0, "radians per second*H*sqrt(rho/(12*mu))"),
    ],
)
def test_a_value_in_a_unit_names_the_conversion(instantiate, description, reference_of, name, value, conversion):
    instance = initializing(instantiate())
    assert conversion in refused(instance, description, instance.setReal, [reference_of[name]], [value])


def test_numbers_in_messages_are_short(instantiate, description, reference_of):
    instance = initializing(instantiate())
    text = refused(instance, description, instance.setReal, [reference_of["phi"]], [1e200])
    assert "phi = 1e200" in text and len(text) < 200


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_value_that_is_no_number(instantiate, description, value):
    instance = initializing(instantiate())
    for variable in settable(description):
        text = refused(instance, description, instance.setReal, [variable.valueReference], [value])
        assert variable.name in text
        assert ("nan" if math.isnan(value) else "inf") in text.lower()


@pytest.mark.parametrize("value", [0, 3, -1])
def test_enumeration_out_of_range(instantiate, description, reference_of, value):
    instance = initializing(instantiate())
    text = refused(instance, description, instance.setInteger, [reference_of["on_pull_in"]], [value])
    assert "on_pull_in" in text and value in numbers_in(text)


def test_one_bad_value_among_good_ones_sets_none(instantiate, description, reference_of):
    instance = initializing(instantiate())
    references = [reference_of[name] for name in ("phi", "gamma_s", "S")]
    text = refused(instance, description, instance.setReal, references, [0.5, math.nan, 0.2])
    assert "gamma_s" in text


def test_bad_values_before_initialization_leave_the_start_values(instantiate, description, reference_of):
    instance = instantiate()
    for value in (-1.0, math.nan):
        with pytest.raises(FMICallException):
            instance.setReal([reference_of["phi"], reference_of["c"]], [0.5, value])
    assert len(instance.log) == 2
    assert everything(initializing(instance), description) == everything(initializing(instantiate()), description)


def test_start_beyond_the_limits(instantiate, description, reference_of):
    instance = initializing(instantiate())
    instance.setReal([reference_of["lambda_start"]], [12.0])
    text = refused(instance, description, instance.exitInitializationMode)
    assert {"lambda_start", "lambda_max"} <= set(re.findall(r"\w+", text)) and {12.0, 10.0} <= set(numbers_in(text))
    instance.setReal([reference_of["lambda_start"]], [1.2])
    instance.exitInitializationMode()


@pytest.mark.parametrize("reference", [1000, 2**32 - 1])
def test_unknown_value_reference(instantiate, description, reference):
    instance = initializing(instantiate())
    for call, arguments in (
        (instance.setReal, ([reference], [1.0])),
        (instance.getReal, ([reference],)),
        (instance.setInteger, ([reference], [1])),
        (instance.getInteger, ([reference],)),
        (instance.getBoolean, ([reference],)),
    ):
        text = refused(instance, description, call, *arguments)
        assert reference in numbers_in(text)


def test_reference_of_another_type(instantiate, description, reference_of):
    instance = initializing(instantiate())
    assert "pulled_in" in refused(instance, description, instance.getReal, [reference_of["pulled_in"]])
    assert "on_pull_in" in refused(instance, description, instance.setReal, [reference_of["on_pull_in"]], [1.0])
    assert "lambda" in refused(instance, description, instance.getInteger, [reference_of["lambda"]])


def test_setting_what_is_only_calculated(instantiate, description, reference_of):
    instance = initializing(instantiate())
    for name in ("lambda3", "lambda_dot", "hamiltonian", "phi_pull_in"):
        assert name in refused(instance, description, instance.setReal, [reference_of[name]], [1.0])


def test_fixed_parameter_after_initialization(instantiate, description, reference_of):
    instance = started(instantiate(), reference_of)
    for variable in settable(description):
        if variable.variability == "fixed":
            value = [float(variable.start)]
            assert variable.name in refused(instance, description, instance.setReal, [variable.valueReference], value)


def test_calls_in_the_wrong_phase(instantiate, description, reference_of):
    instance = instantiate()
    for name, call, arguments in (
        ("fmi2DoStep", instance.doStep, (0.0, 1.0)),
        ("fmi2ExitInitializationMode", instance.exitInitializationMode, ()),
        ("fmi2GetReal", instance.getReal, ([reference_of["lambda"]],)),
    ):
        with pytest.raises(FMICallException) as refusal:
            call(*arguments)
        assert refusal.value.status == fmi2Error
        assert name in instance.log[-1].text
    initializing(instance)
    assert "fmi2DoStep" in refused(instance, description, instance.doStep, 0.0, 1.0)
    instance.reset()
    started(instance, reference_of)
    assert "fmi2EnterInitializationMode" in refused(instance, description, instance.enterInitializationMode)
    assert "fmi2ExitInitializationMode" in refused(instance, description, instance.exitInitializationMode)
    assert "fmi2SetupExperiment" in refused(instance, description, instance.setupExperiment)


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf])
def test_step_that_cannot_be_done(instantiate, description, reference_of, step):
    instance = started(instantiate(), reference_of)
    instance.doStep(0.0, 1.0)
    text = refused(instance, description, instance.doStep, 1.0, step)
    if math.isfinite(step):
        assert step in numbers_in(text)
    else:
        assert str(step) in text.lower()


@pytest.mark.parametrize("point", [0.0, 2.0, 1.02, math.nan])
def test_wrong_communication_point(instantiate, description, reference_of, point):
    instance = started(instantiate(), reference_of)
    instance.doStep(0.0, 1.0)
    text = refused(instance, description, instance.doStep, point, 1.0)
    assert 1.0 in numbers_in(text), "the expected communication point is named"


def test_step_past_the_stop_time(instantiate, description, reference_of):
    instance = started(instantiate(), reference_of)
    instance.doStep(0.0, 99.0)
    assert 100.0 in numbers_in(refused(instance, description, instance.doStep, 99.0, 2.0))


def test_a_refused_call_leaves_no_trace_in_the_motion(instantiate, description, reference_of):
    """The run goes on bit for bit as if the bad calls had not been made."""

    def motion(disturb):
        instance = started(instantiate(), reference_of)
        rows = []
        for k in range(STEPS):
            if disturb:
                refused(
                    instance, description, instance.setReal, [reference_of["phi"], reference_of["S"]], [0.1, math.nan]
                )
                refused(instance, description, instance.doStep, k * 1.7, -1.0)
                refused(instance, description, instance.doStep, k * 1.7 + 0.5, 1.7)
            instance.doStep(k * 1.7, 1.7)
            rows.append(everything(instance, description))
        return rows

    assert motion(disturb=True) == motion(disturb=False)


def test_wrong_guid_is_refused(unpacked, description):
    from fmpy.fmi2 import FMU2Slave

    instance = FMU2Slave(
        guid="{another}",
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=unpacked,
        instanceName="wrong guid",
    )
    with pytest.raises(Exception, match="Failed to instantiate"):
        instance.instantiate()
    instance.freeLibrary()
