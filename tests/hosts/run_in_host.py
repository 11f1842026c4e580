"""The motion of one scene as another host computes it: ``run_in_host.py HOST FMU`` prints a row for each
communication point: λ and λ3. ``run_in_host.py HOST FMU terminate`` runs a scene in which the actuator collapses, and
the FMU asks the host to end there. A process of its own for each host: one that crashes
takes nothing with it. The communication step is a power of two, so that every host means the same times."""

import contextlib
import ctypes
import importlib.util
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

START_VALUES = {"phi": 0.5625, "S": 0.125, "gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2, "phi_ac": 0.1, "omega_ac": 0.4}
STEP = 0.125
STEPS = 240
SWITCH = 120
"""Number of steps after which `phi` is set anew, by hosts that can."""
PHI_THEN = 0.25
COLLAPSE = {"phi": 0.7, "S": 0.0, "terminate_on_pull_in": 1.0}
"""Start values with which the actuator collapses at t = 38.6057618134."""
COLLAPSE_STEPS = 400
"""Number of steps that are asked for then: to t = 50."""
OUTPUTS = ("lambda", "lambda3")
MODEL = "DielectricElastomerActuator"
COFMUPY = Path(sys.prefix) / "cofmupy"
"""cofmupy with the FMPy that it needs."""

Rows = list[list[float]]


def description(fmu: str | Path):
    import fmpy

    read = fmpy.read_model_description(str(fmu))
    return read, {variable.name: variable.valueReference for variable in read.modelVariables}


def with_fmpy(fmu: str | Path, start_values=START_VALUES) -> Rows:
    """The instance API of FMPy, against which the others are held."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    read, reference = description(fmu)
    instance = FMU2Slave(
        guid=read.guid,
        modelIdentifier=read.coSimulation.modelIdentifier,
        unzipDirectory=fmpy.extract(str(fmu)),
        instanceName="actuator",
    )
    instance.instantiate()
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    instance.setReal([reference[name] for name in start_values], list(start_values.values()))
    instance.exitInitializationMode()
    outputs = [reference[name] for name in OUTPUTS]
    rows = [instance.getReal(outputs)]
    for step in range(STEPS):
        if step == SWITCH:
            instance.setReal([reference["phi"]], [PHI_THEN])
        instance.doStep(step * STEP, STEP)
        rows.append(instance.getReal(outputs))
    instance.terminate()
    instance.freeInstance()
    return rows


def with_fmuloader(fmu: str) -> Rows:
    from fmuloader.fmi2 import Fmi2Slave, Fmi2Type

    read, reference = description(fmu)
    instance = Fmi2Slave(fmu, model_identifier=MODEL)
    instance.instantiate("actuator", Fmi2Type.CO_SIMULATION, guid=read.guid)
    instance.setup_experiment(start_time=0.0)
    instance.enter_initialization_mode()
    instance.set_real([reference[name] for name in START_VALUES], list(START_VALUES.values()))
    instance.exit_initialization_mode()
    outputs = [reference[name] for name in OUTPUTS]
    rows = [instance.get_real(outputs)]
    for step in range(STEPS):
        if step == SWITCH:
            instance.set_real([reference["phi"]], [PHI_THEN])
        instance.do_step(step * STEP, STEP)
        rows.append(instance.get_real(outputs))
    instance.terminate()
    instance.free_instance()
    return rows


def with_ecospy(fmu: str) -> Rows:
    # It needs this library and does not bring it; the package `tbb` does.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), ctypes.RTLD_GLOBAL)
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        structure.add_model("actuator", Path(fmu))
        structure.add_parameter_set("scene", {f"actuator::{name}": value for name, value in START_VALUES.items()})
        with EcosSimulation(STEP, structure=structure) as simulation:
            simulation.init(0, "scene")
            names = [f"actuator::{name}" for name in OUTPUTS]
            rows = [[simulation.get_real(name) for name in names]]
            for step in range(STEPS):
                if step == SWITCH:
                    simulation.set_real("actuator::phi", PHI_THEN)
                simulation.step()
                rows.append([simulation.get_real(name) for name in names])
            simulation.terminate()
    return rows


def with_libcosimpy(fmu: str) -> Rows:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    _, reference = description(fmu)
    execution = CosimExecution.from_step_size(int(STEP * 1e9))
    instance = execution.add_local_slave(CosimLocalSlave(fmu, "actuator"))
    for name, value in START_VALUES.items():
        execution.real_initial_value(instance, reference[name], value)
    observer = CosimObserver.create_last_value()
    manipulator = CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    outputs = [reference[name] for name in OUTPUTS]
    rows = []
    for step in range(STEPS):
        if step == SWITCH:
            manipulator.slave_real_values(instance, [reference["phi"]], [PHI_THEN])
        if not execution.step():
            raise RuntimeError("CosimExecution.step() gave False")
        rows.append(observer.last_real_values(instance, outputs))
    # It reads for the first time after the first step.
    return [[math.nan] * len(outputs), *rows]


def with_fmu_manipulation_toolbox(fmu: str) -> Rows:
    """The actuator in a container, which is an FMU of its own, run by FMPy."""
    with tempfile.TemporaryDirectory() as folder:
        name = Path(fmu).name
        (Path(folder) / name).symlink_to(fmu)
        assembly = {
            "name": "container.fmu",
            "step_size": STEP,
            "auto_link": False,
            "fmu": [name],
            "input": [["phi", name, "phi"], ["S", name, "S"]],
            "output": [[name, output, output] for output in OUTPUTS],
            "start": [[name, variable, value] for variable, value in START_VALUES.items()],
        }
        (Path(folder) / "container.json").write_text(json.dumps(assembly))
        command = [sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmucontainer"]
        made = subprocess.run(
            [*command, "-container", "container.json", "-fmu-directory", folder],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        container = Path(folder) / "container.fmu"
        if not container.exists():
            raise RuntimeError(made.stdout + made.stderr)
        return with_fmpy(container, {name: START_VALUES[name] for name in ("phi", "S")})


def with_pathsim_fmi(fmu: str) -> Rows:
    """It reads every output as a Real, and sets every input at each step: what is not connected to 0."""
    from pathsim import Connection, Simulation
    from pathsim.blocks import Constant, Source
    from pathsim_fmi import CoSimulationFMU

    class Recorded(CoSimulationFMU):
        def _step_fmu(self, time):
            super()._step_fmu(time)
            rows.append(self.stretches())

        def stretches(self):
            return [float(self.outputs[name]) for name in OUTPUTS]

    block = Recorded(fmu, start_values=START_VALUES, dt=STEP)
    rows = [block.stretches()]
    phi = Source(lambda time: START_VALUES["phi"] if time < SWITCH * STEP else PHI_THEN)
    prestress = Constant(START_VALUES["S"])
    connections = [Connection(phi, block["phi"]), Connection(prestress, block["S"])]
    simulation = Simulation([phi, prestress, block], connections, dt=STEP, log=False)
    simulation.run((STEPS - 1) * STEP)
    return rows


def with_cofmupy(fmu: str) -> Rows:
    """It sets and reads everything as a Real, and needs an older FMPy: see the Makefile."""
    sys.path.insert(0, str(COFMUPY))
    from cofmupy.coordinator import Coordinator

    voltage = {"0": START_VALUES["phi"], str(SWITCH * STEP): PHI_THEN}
    configuration = {
        "fmus": [{"id": "actuator", "path": fmu, "initialization": START_VALUES}],
        "connections": [
            {
                "source": {"type": "literal", "values": voltage, "interpolation": "previous"},
                "target": [{"id": "actuator", "variable": "phi"}],
            }
        ],
        "cosim_method": "jacobi",
        "data_storages": [],
    }
    coordinator = Coordinator()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(sys.stderr):
        path = Path(folder) / "configuration.json"
        path.write_text(json.dumps(configuration))
        coordinator.start(str(path))

        def row():
            return [coordinator.get_variable(("actuator", name))[0] for name in OUTPUTS]

        rows = [row()]
        for _ in range(STEPS):
            coordinator.do_step(STEP)
            rows.append(row())
    return rows


def with_fmi(fmu: str) -> Rows:
    """The crate `fmi`, in the program that `cargo test` and ``cargo build --example run_with_fmi`` build."""
    program = Path(__file__).resolve().parents[2] / "target/debug/examples/run_with_fmi"
    scene = [f"{name}={value!r}" for name, value in START_VALUES.items()]
    settings = [STEP, STEPS, SWITCH, PHI_THEN, ",".join(OUTPUTS)]
    run = subprocess.run([program, fmu, *map(str, settings), *scene], capture_output=True, text=True, check=False)
    if run.returncode:
        raise RuntimeError(run.stderr.strip())
    return [[float(number) for number in line.split()[1:]] for line in run.stdout.splitlines()]


HOSTS = {
    "fmpy": with_fmpy,
    "fmi": with_fmi,
    "fmuloader": with_fmuloader,
    "ecospy": with_ecospy,
    "libcosimpy": with_libcosimpy,
    "fmu_manipulation_toolbox": with_fmu_manipulation_toolbox,
    "pathsim_fmi": with_pathsim_fmi,
    "cofmupy": with_cofmupy,
}


def is_there(host: str) -> bool:
    """Whether the packages of the host are installed."""
    if host == "cofmupy":
        return COFMUPY.is_dir()
    return host == "fmi" or importlib.util.find_spec(host) is not None


if __name__ == "__main__":
    host, fmu, *what = sys.argv[1:]
    if what == ["terminate"]:
        START_VALUES.clear()
        START_VALUES.update(COLLAPSE)
        STEPS = SWITCH = COLLAPSE_STEPS
    for row in HOSTS[host](fmu):
        print("row", *map(float, row))
