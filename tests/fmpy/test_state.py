"""Saving, restoring and serializing the state of an instance, as controllers and optimizers do."""

import json
import subprocess
import sys

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import allowed_errors as allowed

SCENES = {
    "voltage step": {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2, "phi": 0.6, "S": 0.5},
    "alternating voltage": {"E_s": 0.2, "phi_ac": 0.3, "omega_ac": 0.1438},
    "after a collapse": {"phi": 1.0},
}
READ = ("lambda", "lambda_dot", "lambda_ddot", "hamiltonian", "phi_total", "pull_in_time")


def started(instantiate, reference_of, scene, time):
    """An instance that has been stepped to `time` (a multiple of 0.37)."""
    instance = instantiate()
    instance.setupExperiment(startTime=0.0, tolerance=allowed.TOLERANCE)
    instance.setReal([reference_of[name] for name in scene], list(scene.values()))
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    for k in range(round(time / 0.37)):
        instance.doStep(k * 0.37, 0.37)
    return instance


def follow(instance, reference_of, time, steps=60):
    """What `steps` more steps bring, an input set at each seventh."""
    rows = []
    for k in range(steps):
        if k % 7 == 0:
            instance.setReal([reference_of["S"]], [0.01 * k])
        instance.doStep(time + k * 0.37, 0.37)
        rows.append([value.hex() for value in instance.getReal([reference_of[name] for name in READ])])
    return rows


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_a_fresh_instance_goes_on_bit_for_bit(instantiate, reference_of, scene):
    """Without setupExperiment and initialization, as FMPy's `simulate_fmu(fmu_state=...)` does it."""
    time = 100 * 0.37
    instance = started(instantiate, reference_of, scene, time)
    state = instance.getFMUState()
    saved = instance.serializeFMUState(state)
    uninterrupted = follow(instance, reference_of, time)

    fresh = instantiate()
    fresh_state = fresh.deSerializeFMUstate(saved)
    fresh.setFMUState(fresh_state)
    fresh.freeFMUState(fresh_state)
    assert follow(fresh, reference_of, time) == uninterrupted

    instance.setFMUState(state)
    instance.freeFMUState(state)
    assert follow(instance, reference_of, time) == uninterrupted


OTHER_PROCESS = """
import json, sys
from pathlib import Path
import fmpy
from dielectric_actuator.fmu import instantiate
sys.path[:0] = {path!r}
import test_state
folder, saved, time = sys.argv[1], bytes.fromhex(sys.argv[2]), float(sys.argv[3])
description = fmpy.read_model_description(folder)
instance = instantiate(folder, description, [])
instance.setFMUState(instance.deSerializeFMUstate(saved))
reference_of = {{v.name: v.valueReference for v in description.modelVariables}}
print(json.dumps(test_state.follow(instance, reference_of, time)))
instance.freeInstance()
"""


def test_a_fresh_process_goes_on_bit_for_bit(instantiate, reference_of, unpacked):
    time = 40 * 0.37
    instance = started(instantiate, reference_of, SCENES["alternating voltage"], time)
    saved = instance.serializeFMUState(instance.getFMUState())
    uninterrupted = follow(instance, reference_of, time)
    program = OTHER_PROCESS.format(path=[entry for entry in sys.path if "tests" in entry or "studies" in entry])
    command = [sys.executable, "-c", program, unpacked, saved.hex(), str(time)]
    other = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(other.stdout) == uninterrupted


def test_states_are_small_and_damaged_ones_refused(instantiate, reference_of):
    instance = started(instantiate, reference_of, SCENES["alternating voltage"], 37.0)
    saved = instance.serializeFMUState(instance.getFMUState())
    assert len(saved) < 1024
    before = instance.getReal([reference_of[name] for name in READ])
    generator = np.random.default_rng(1)
    for _ in range(200):
        damaged = bytearray(saved)
        damaged[generator.integers(len(saved))] ^= 1 << generator.integers(8)
        with pytest.raises(FMICallException):
            instance.deSerializeFMUstate(bytes(damaged))
        with pytest.raises(FMICallException):
            instance.deSerializeFMUstate(saved[: generator.integers(len(saved))])
    assert instance.getReal([reference_of[name] for name in READ]) == before
    assert instance.log[-1].status == 3 and "no state of this FMU" in instance.log[-1].text


def test_a_controller_may_look_ahead(instantiate, reference_of):
    """Trial steps with other voltages, all taken back, leave no trace."""
    plain = started(instantiate, reference_of, SCENES["voltage step"], 0.0)
    trying = started(instantiate, reference_of, SCENES["voltage step"], 0.0)
    for k in range(30):
        state = trying.getFMUState()
        for phi in (0.0, 0.3, 1.2):
            trying.setReal([reference_of["phi"]], [phi])
            trying.doStep(k * 0.37, 5.0, noSetFMUStatePriorToCurrentPoint=0)
            trying.setFMUState(state)
        trying.freeFMUState(state)
        for instance in (plain, trying):
            instance.doStep(k * 0.37, 0.37)
        references = [reference_of[name] for name in READ]
        assert plain.getReal(references) == trying.getReal(references)
