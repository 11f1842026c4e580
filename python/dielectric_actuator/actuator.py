"""One actuator: start it, step it or run it, read and set it by name, look ahead, differentiate."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2Discard, fmi2LastSuccessfulTime, fmi2Terminated
from fmpy.model_description import ScalarVariable

from . import equilibrium
from .fmu import LogMessage, Variables, described, instantiate, located

Scene = Mapping[str, float | Callable[[float], float]]
"""Start values of one run by variable name; an input may be a function of time."""


MOST_STEPS = 1e9
"""Communication steps of one response, whose rows would fill some ten gigabytes."""


class SavedState(NamedTuple):
    """All of an instance at one time, in bytes that any later process restores."""

    time: float
    state: bytes
    rounded: float = 0.0
    """What the last addition to `time` rounded off."""


class _Reasons:
    """A block in which a refused call gets the FMU's reason as a note. As a generator it takes a third of a call."""

    def __init__(self, messages: list[LogMessage]):
        self._messages = messages

    def explain(self, refusal: FMICallException) -> None:
        """Add the last message, if it is of this call."""
        if self._messages and self._messages[-1].status == refusal.status:
            refusal.add_note(self._messages[-1].text)

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if isinstance(value, FMICallException):
            self.explain(value)


class Actuator:
    """One instance of a packed actuator; a context manager, so that library and folder are given back.

    `fmu` names one of the package, or is the path of any other FMI 2.0 co-simulation FMU, in the units that it
    declares (`units`):

    * "nondimensional" is the actuator of the paper: voltage φ̄ = φ √(ε/µ)/H, prestress S̄ = P/(µHL), time
      t̄ = t √(12µ/(ρH²)) (Eq. 15);
    * "si" is a real one in volts, metres, seconds and newtons, with losses, stiffening and breakdown.

    ``messages`` holds what the FMU logged since the last `start`. A call that the FMU refuses raises
    ``fmpy.fmi1.FMICallException`` with the FMU's reason as a note; a name that it does not have, `UnknownName`.

        with Actuator() as actuator:
            response = actuator.run({"phi": 0.6}, stop_time=80.0, communication_step=0.1)
            print(response["time"], response["lambda"])

        with Actuator("si") as film:
            response = film.run({"voltage": 650.0}, stop_time=30e-6, communication_step=0.1e-6)

    ``fmpy.simulate_fmu`` unpacks, loads and frees the FMU at every call; an `Actuator` does so once, and is reset
    between runs.
    """

    def __init__(self, fmu: str | Path = "nondimensional"):
        path = located(fmu)
        self.messages: list[LogMessage] = []
        self.time = 0.0
        self.description = described(path)
        self._variables = Variables(self.description)
        self._reasons = _Reasons(self.messages)
        self._folder = tempfile.TemporaryDirectory(prefix="actuator-fmu-")
        fmpy.extract(str(path), unzipdir=self._folder.name)
        self._instance: FMU2Slave | None = instantiate(self._folder.name, self.description, self.messages)
        self._fresh = True

    def __repr__(self) -> str:
        name, clock = self.description.modelName, self.units["time"]
        if self._instance is None:
            return f"<Actuator {name}, closed>"
        return f"<Actuator {name} at time {self.time:g}{f' {clock}' if clock else ''}>"

    def __enter__(self) -> Actuator:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the instance, unload the library, remove the unpacked folder. A second call does nothing.

        Every other call but to look at the description raises ValueError from then on.
        """
        if self._instance is not None:
            self._instance.freeInstance()
            self._instance = None
            self._folder.cleanup()

    @property
    def _fmu(self) -> FMU2Slave:
        if self._instance is None:
            raise ValueError("the actuator is closed; make another one")
        return self._instance

    @property
    def time(self) -> float:
        """The present communication point. Set it to follow another clock."""
        return self._time

    @time.setter
    def time(self, time: float) -> None:
        self._time, self._rounded = time, 0.0

    @property
    def variables(self) -> Mapping[str, ScalarVariable]:
        """What the model description says of each variable: ``unit``, ``description``, ``start``, ``min``, ``max``."""
        return self._variables.by_name

    @property
    def units(self) -> dict[str, str]:
        """The unit of each variable that has one, and of ``time``; "" for a nondimensional one."""
        found = {name: variable.unit or "" for name, variable in self.variables.items()}
        found = {name: "" if unit == "1" else unit for name, unit in found.items()}
        # FMI counts time in seconds; a model without a dimension has none in its time
        return {**found, "time": "s" if any(unit not in ("", "rad") for unit in found.values()) else ""}

    def describe(self, *names: str) -> str:
        """A table of all variables, or of the named ones: unit, start value, limits, meaning."""
        return self._variables.table(names)

    def start(
        self,
        scene: Scene,
        *,
        tolerance: float | None = None,
        start_time: float = 0.0,
        stop_time: float | None = None,
        at_equilibrium: bool = False,
    ) -> None:
        """Reset, set the scene and leave initialization mode, so that the next call can be `advance`.

        What was set before is dropped. After a scene that is refused the actuator is at no time: start it again.
        `tolerance` is the integrator's relative tolerance (the FMU's default without one). A function in `scene` is
        evaluated at `start_time`. `at_equilibrium` starts at rest where the scene's voltage and prestress hold the
        actuator (`equilibrium`): with surface effects λ = 1 is no such place.
        """
        values = {name: value(start_time) if callable(value) else value for name, value in scene.items()}
        if at_equilibrium:
            values |= equilibrium.at_rest(self, values, self.equilibrium(values, start_time=start_time), start_time)
        if not self._fresh:
            self._fmu.reset()
        self.messages.clear()
        self.time = start_time
        with self._reasons:
            self._fmu.setupExperiment(tolerance=tolerance, startTime=start_time, stopTime=stop_time)
        self.set(values)
        with self._reasons:
            self._fmu.enterInitializationMode()
            self._fmu.exitInitializationMode()

    def equilibrium(self, values: Mapping[str, float], *, start_time: float = 0.0) -> float:
        """The smallest stretch at which the actuator rests in equilibrium under `values`, to the last bit.

        It is stable, and it is where a voltage that is raised slowly from 0 leads; the branches of a lossy material
        are relaxed. Raises ValueError where there is none between `lambda_min` and `lambda_max`, that is beyond the
        static pull-in, and where a source gives a current, or loses voltage to a leak behind a resistance. A motion
        that runs is not disturbed.
        """
        logged = self.messages.copy()
        with self.looking_ahead():
            found = equilibrium.find(self, values, start_time)
        self.messages[:] = logged
        return found

    def set(self, values: Mapping[str, float]) -> None:
        """Set inputs or parameters by name; each FMI type in one call, refused as a whole.

        A Boolean or an enumeration may be given as a whole number of any type; ValueError where it is none.
        """
        groups = self._variables.grouped(self._fmu, values)
        for group in groups:
            group.take(values)
        self._fresh = False
        for group in groups:
            with self._reasons:
                group.write()

    def set_input_derivatives(self, derivatives: Mapping[str, Sequence[float]]) -> None:
        """Let inputs vary inside the next steps: for each its first, second, … derivative in time, at `time`.

        They hold until the input is set again, so that they are set after its value.
        """
        triples = [
            (self._variables.reference(name), order, value)
            for name, values in derivatives.items()
            for order, value in enumerate(values, start=1)
        ]
        if triples:
            with self._reasons:
                self._fmu.setRealInputDerivatives(*(list(column) for column in zip(*triples)))

    def output_derivatives(self, name: str, order: int) -> list[float]:
        """Time derivatives of an output at the last communication point, from order 1 to the given one."""
        if order == 0:
            return []
        references = [self._variables.reference(name)] * order
        with self._reasons:
            return list(self._fmu.getRealOutputDerivatives(references, list(range(1, order + 1))))

    def get(self, *names: str) -> Any:
        """Present value of one variable, or of several as a list in the given order."""
        found: dict[str, Any] = {}
        for group in self._variables.grouped(self._fmu, names):
            with self._reasons:
                group.read()
            found.update(zip(group.names, group.values))
        return found[names[0]] if len(names) == 1 else [found[name] for name in names]

    def directional_derivatives(self, unknowns: Iterable[str], known: str) -> list[float]:
        """∂unknown/∂known of each unknown at the present state, exact but for rounding."""
        references = [self._variables.reference(name) for name in unknowns]
        with self._reasons:
            return list(self._fmu.getDirectionalDerivative(references, [self._variables.reference(known)], [1.0]))

    @contextmanager
    def looking_ahead(self) -> Iterator[None]:
        """A block in which the instance may run on; after it, it is again where it was before."""
        state = self._fmu.getFMUstate()
        before = self._time, self._rounded, self._fresh
        try:
            yield
        finally:
            self._fmu.setFMUstate(state)
            self._fmu.freeFMUstate(state)
            self._time, self._rounded, self._fresh = before

    def save(self) -> SavedState:
        """The whole state, for `restore` of any instance of the same FMU in this or a later process."""
        with self._reasons:
            state = self._fmu.getFMUstate()
            try:
                return SavedState(self._time, self._fmu.serializeFMUstate(state), self._rounded)
            finally:
                self._fmu.freeFMUstate(state)

    def restore(self, saved: SavedState) -> None:
        """Go on from a saved state, bit for bit. Damaged bytes, or those of another version, are refused."""
        with self._reasons:
            state = self._fmu.deSerializeFMUstate(saved.state)
            try:
                self._fmu.setFMUstate(state)
            finally:
                self._fmu.freeFMUstate(state)
        self._time, self._rounded, self._fresh = saved.time, saved.rounded, False

    def advance(self, communication_step: float) -> bool:
        """One communication step. False if the FMU ended the run inside it (``on_pull_in`` = terminate);
        `time` is then the instant that it reached."""
        try:
            self._fmu.doStep(self.time, communication_step)
        except FMICallException as refusal:
            if refusal.status == fmi2Discard and self._fmu.getBooleanStatus(fmi2Terminated):
                self.time = self._fmu.getRealStatus(fmi2LastSuccessfulTime)
                return False
            self._reasons.explain(refusal)
            raise
        # A sum of many steps would drift: what one addition rounds off is added with the next.
        step = communication_step + self._rounded
        before, self._time = self._time, self._time + step
        self._rounded = step - (self._time - before)
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
        at_equilibrium: bool = False,
        progress: Callable[[int, int], None] | None = None,
    ) -> np.ndarray:
        """Run one scene and return its response, one row per communication point.

        The result is a structured array with the field ``time`` and one field per output, as
        ``fmpy.simulate_fmu`` returns it; `frame` makes a pandas table of it. If `communication_step` does not
        divide the span, the last step is shorter and ends at `stop_time`. An input given as a function of time
        is evaluated at the start of each step and held over it. A run that the FMU ends has its last row at that
        instant. `progress` is called now and then with the number of steps done and that of all.
        """
        outputs = list(outputs)
        if not (math.isfinite(stop_time) and stop_time >= start_time):
            raise ValueError(f"stop_time is {stop_time:g}; it must be a number from start_time = {start_time:g} on")
        if not (math.isfinite(communication_step) and communication_step > 0):
            raise ValueError(f"communication_step is {communication_step:g}; it must be a number above 0")
        if (stop_time - start_time) / communication_step > MOST_STEPS:
            raise ValueError(
                f"communication_step is {communication_step:g}; for more than {MOST_STEPS:g} steps up to stop_time = "
                f"{stop_time:g}, use start and advance"
            )
        # 1e-9 of a step is rounding of the quotient, not a last step worth taking
        steps = max(0, math.ceil((stop_time - start_time) / communication_step - 1e-9))
        times = start_time + communication_step * np.arange(steps + 1)
        times[-1] = stop_time if steps else start_time
        fields = [("time", np.float64)] + [(name, self._variables.access(name).dtype) for name in outputs]
        response = np.empty(steps + 1, dtype=fields)
        response["time"] = times
        groups = self._variables.grouped(self._fmu, outputs)
        columns = [([response[name] for name in group.names], group) for group in groups]

        def record(row: int) -> None:
            for fields, group in columns:
                group.read()
                for field, value in zip(fields, group.values):
                    field[row] = value

        self.start(scene, tolerance=tolerance, start_time=start_time, at_equilibrium=at_equilibrium)
        record(0)
        varying = {name: value for name, value in scene.items() if callable(value)}
        for step in range(1, steps + 1):
            # communication points are start + k h, not a running sum, and each full step is exactly h
            self.time = float(times[step - 1])
            if varying:
                self.set({name: value(self.time) for name, value in varying.items()})
            completed = self.advance(communication_step if step < steps else stop_time - self.time)
            record(step)
            if progress and step % 1000 == 0 and step < steps:
                progress(step, steps)
            if not completed:
                response["time"][step] = self.time
                return response[: step + 1]
        return response


def frame(response: np.ndarray, units: Mapping[str, str] | None = None) -> Any:
    """A response as a pandas DataFrame with the time as its index (extra ``pandas``).

    With `Actuator.units` its ``attrs["units"]`` holds the unit of each column and of the time.
    """
    import pandas

    table = pandas.DataFrame(response).set_index("time")
    if units is not None:
        table.attrs["units"] = {name: units[name] for name in response.dtype.names or ()}
    return table
