"""The packed actuator, run scene by scene through FMPy's instance API.

``fmpy.simulate_fmu`` unpacks, loads and frees the FMU at every call, which is what a user wants for one
run and what a study of a thousand scenes pays for. `ActuatorFmu` unpacks once, instantiates once and
resets between scenes; variables are addressed by name, through the value references of the model
description. All quantities are nondimensional (Eq. 15 of the paper).

    with ActuatorFmu() as actuator:
        scene = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2, "phi": 0.6}
        response = actuator.run(scene, stop_time=80.0, communication_step=0.1)
        print(response["time"], response["lambda3"])
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2Boolean,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2Discard,
    fmi2Integer,
    fmi2LastSuccessfulTime,
    fmi2Real,
    fmi2Terminated,
    fmi2ValueReference,
)

DEFAULT_FMU = Path(__file__).resolve().parents[1] / "target" / "fmu" / "DielectricElastomerActuator.fmu"

Scene = Mapping[str, float | Callable[[float], float]]
"""Start values of one run by variable name; an input may be a function of time."""


class LogMessage(NamedTuple):
    """One call of the logger: FMI status (0 OK, 1 warning, 2 discard, 3 error, 4 fatal), category, text."""

    status: int
    category: str
    text: str


def instantiate(folder: str | Path, description: fmpy.model_description.ModelDescription, log: list[LogMessage]):
    """Instantiate the FMU unpacked in `folder` as an ``fmpy.fmi2.FMU2Slave`` whose messages are appended to `log`.

    FMPy's own way to pass a logger goes through one process-wide pointer: the logger passed last gets the
    messages of every instance, and once its instance is freed the next message of another one crashes the
    process (seen with FMPy 0.3.32). FMPy needs that detour for printf-style messages; the actuator's are
    finished texts, so that each instance can call its own logger directly.
    """

    def logger(_component, _instance: bytes, status: int, category: bytes, text: bytes) -> None:
        log.append(LogMessage(status, (category or b"").decode(), text.decode()))

    callbacks = fmi2CallbackFunctions(
        logger=fmi2CallbackLoggerTYPE(logger),
        allocateMemory=fmi2CallbackAllocateMemoryTYPE(fmpy.calloc),
        freeMemory=fmi2CallbackFreeMemoryTYPE(fmpy.free),
    )
    slave = FMU2Slave(
        guid=description.guid,
        modelIdentifier=description.coSimulation.modelIdentifier,
        unzipDirectory=str(folder),
        instanceName="actuator",
    )
    slave.instantiate(callbacks=callbacks, loggingOn=True)
    return slave


class _Access(NamedTuple):
    """How FMI 2 reads and writes a variable of one type, and how numpy stores it."""

    function: str
    c_type: type
    dtype: type


_ACCESS = {
    "Real": _Access("Real", fmi2Real, np.float64),
    "Integer": _Access("Integer", fmi2Integer, np.int32),
    "Enumeration": _Access("Integer", fmi2Integer, np.int32),
    "Boolean": _Access("Boolean", fmi2Boolean, np.bool_),
}


class _Variables:
    """Variables of one FMI type with their buffers laid out once, so that a step reads without allocating."""

    def __init__(self, fmu, access: _Access, references: list[int]):
        self._component = fmu.component
        self._getter = getattr(fmu, "fmi2Get" + access.function)
        self._setter = getattr(fmu, "fmi2Set" + access.function)
        self._references = (fmi2ValueReference * len(references))(*references)
        self.values = (access.c_type * len(references))()

    def read(self) -> None:
        """Fill `values` from the instance."""
        self._getter(self._component, self._references, len(self.values), self.values)

    def write(self) -> None:
        """Hand `values` to the instance."""
        self._setter(self._component, self._references, len(self.values), self.values)


class ActuatorFmu:
    """One instance of the packed actuator; a context manager, so that library and folder are given back.

    ``messages`` holds what the FMU logged since the last `start`. A call that the FMU refuses raises
    ``fmpy.fmi1.FMICallException`` with the FMU's reason as a note.
    """

    def __init__(self, path: str | Path = DEFAULT_FMU):
        self.messages: list[LogMessage] = []
        self.time = 0.0
        self.description = fmpy.read_model_description(str(path))
        self._by_name = {variable.name: variable for variable in self.description.modelVariables}
        self._groups: dict[tuple[str, ...], list[tuple[list[str], _Variables]]] = {}
        self._folder = tempfile.TemporaryDirectory(prefix="actuator-fmu-")
        fmpy.extract(str(path), unzipdir=self._folder.name)
        self._fmu = instantiate(self._folder.name, self.description, self.messages)
        self._fresh = True

    def __enter__(self) -> ActuatorFmu:
        return self

    def __exit__(self, *_exception) -> None:
        self.close()

    def close(self) -> None:
        """Free the instance, unload the library, remove the unpacked folder. A second call does nothing."""
        if self._fmu is not None:
            self._fmu.freeInstance()
            self._fmu = None
            self._folder.cleanup()

    def start(
        self,
        scene: Scene,
        *,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
    ) -> None:
        """Reset, set the scene and leave initialization mode, so that the next call can be `advance`.

        `tolerance` is the integrator's relative tolerance (the FMU's default without one). A function
        in `scene` is evaluated at `start_time`.
        """
        if not self._fresh:
            self._fmu.reset()
        self._fresh = False
        self.messages.clear()
        self.time = start_time
        with self._reasons():
            self._fmu.setupExperiment(tolerance=tolerance, startTime=start_time, stopTime=stop_time)
        self.set({name: value(start_time) if callable(value) else value for name, value in scene.items()})
        with self._reasons():
            self._fmu.enterInitializationMode()
            self._fmu.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        """Set inputs or parameters by name; each FMI type in one call, refused as a whole."""
        for names, variables in self._grouped(values):
            variables.values[:] = [values[name] for name in names]
            with self._reasons():
                variables.write()

    def set_input_derivatives(self, derivatives: Mapping[str, Sequence[float]]) -> None:
        """Let inputs vary inside the steps to come: for each its first, second, … derivative by time at `time`.

        They hold until the input is set again, so that they are set after its value.
        """
        triples = [
            (self._variable(name).valueReference, order, value)
            for name, values in derivatives.items()
            for order, value in enumerate(values, start=1)
        ]
        if triples:
            with self._reasons():
                self._fmu.setRealInputDerivatives(*(list(column) for column in zip(*triples)))

    def output_derivatives(self, name: str, order: int) -> list[float]:
        """Derivatives of an output by time at the last communication point, from the first to the given order."""
        if order == 0:
            return []
        references = [self._variable(name).valueReference] * order
        with self._reasons():
            return self._fmu.getRealOutputDerivatives(references, list(range(1, order + 1)))

    def get(self, *names: str):
        """Present value of one variable, or of several as a list in the given order."""
        found = {}
        for group, variables in self._grouped(names):
            with self._reasons():
                variables.read()
            found.update(zip(group, variables.values))
        return found[names[0]] if len(names) == 1 else [found[name] for name in names]

    def directional_derivatives(self, unknowns: Iterable[str], known: str) -> list[float]:
        """∂unknown/∂known of each unknown at the present state, exact."""
        references = [self._variable(name).valueReference for name in unknowns]
        with self._reasons():
            return self._fmu.getDirectionalDerivative(references, [self._variable(known).valueReference], [1.0])

    @contextmanager
    def looking_ahead(self):
        """A block in which the instance may run on; after it, it is again where it was before."""
        state, time = self._fmu.getFMUstate(), self.time
        try:
            yield
        finally:
            self._fmu.setFMUstate(state)
            self._fmu.freeFMUstate(state)
            self.time = time

    def advance(self, communication_step: float) -> bool:
        """One communication step. False if the FMU ended the run inside it (``on_pull_in`` = terminate);
        `time` is then the instant that it reached."""
        try:
            self._fmu.doStep(self.time, communication_step)
        except FMICallException as refusal:
            if refusal.status == fmi2Discard and self._fmu.getBooleanStatus(fmi2Terminated):
                self.time = self._fmu.getRealStatus(fmi2LastSuccessfulTime)
                return False
            self._explain(refusal)
            raise
        self.time += communication_step
        return True

    def run(
        self,
        scene: Scene,
        *,
        stop_time: float,
        communication_step: float,
        outputs: Iterable[str] = ("lambda", "lambda3"),
        tolerance: float | None = None,
        start_time: float = 0.0,
    ) -> np.ndarray:
        """Run one scene and return its response, one row per communication point.

        The result is a structured array with the field ``time`` and one field per output, as
        ``fmpy.simulate_fmu`` returns it. If `communication_step` does not divide the span, the last step
        is shorter and ends at `stop_time`. An input given as a function of time is evaluated at the
        start of each step and held over it. A run that the FMU ends has its last row at that instant.
        """
        outputs = list(outputs)
        # 1e-9 of a step is rounding of the quotient, not a last step worth taking
        steps = max(0, math.ceil((stop_time - start_time) / communication_step - 1e-9))
        times = start_time + communication_step * np.arange(steps + 1)
        times[-1] = stop_time if steps else start_time
        response = np.empty(steps + 1, dtype=[("time", np.float64)] + [(n, self._access(n).dtype) for n in outputs])
        response["time"] = times
        columns = [([response[name] for name in names], variables) for names, variables in self._grouped(outputs)]

        def record(row: int) -> None:
            for fields, variables in columns:
                variables.read()
                for field, value in zip(fields, variables.values):
                    field[row] = value

        self.start(scene, tolerance=tolerance, start_time=start_time)
        record(0)
        varying = {name: value for name, value in scene.items() if callable(value)}
        for step in range(1, steps + 1):
            # communication points are start + k h, not a running sum, and each full step is exactly h
            self.time = float(times[step - 1])
            if varying:
                self.set({name: value(self.time) for name, value in varying.items()})
            completed = self.advance(communication_step if step < steps else stop_time - self.time)
            record(step)
            if not completed:
                response["time"][step] = self.time
                return response[: step + 1]
        return response

    def _access(self, name: str) -> _Access:
        return _ACCESS[self._variable(name).type]

    def _variable(self, name: str):
        if name not in self._by_name:
            raise KeyError(f"the actuator has no variable {name!r}; it has {', '.join(self._by_name)}")
        return self._by_name[name]

    def _grouped(self, names: Iterable[str]) -> list[tuple[list[str], _Variables]]:
        """The names by FMI type, each group with its buffers; laid out once for each list of names."""
        names = tuple(names)
        if names not in self._groups:
            by_access: dict[_Access, list[str]] = {}
            for name in names:
                by_access.setdefault(self._access(name), []).append(name)
            self._groups[names] = [
                (group, _Variables(self._fmu, access, [self._variable(name).valueReference for name in group]))
                for access, group in by_access.items()
            ]
        return self._groups[names]

    def _explain(self, refusal: FMICallException) -> None:
        if self.messages and self.messages[-1].status == refusal.status:
            refusal.add_note(self.messages[-1].text)

    @contextmanager
    def _reasons(self):
        try:
            yield
        except FMICallException as refusal:
            self._explain(refusal)
            raise
