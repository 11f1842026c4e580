"""The packed FMU: where it is, how FMPy loads it, and its variables by name."""

from __future__ import annotations

import difflib
import math
import platform
from collections.abc import Container, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import fmpy
import numpy as np
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2Boolean,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2Integer,
    fmi2Real,
    fmi2ValueReference,
)
from fmpy.model_description import ModelDescription, ScalarVariable

MODELS = {"nondimensional": "DielectricElastomerActuator", "si": "DielectricElastomerActuatorSI"}
"""The actuators of the package, each with the name of its FMU: that of the paper, and a real one in SI units."""

_DATA = Path(__file__).resolve().parent / "data"
_CHECKOUT = Path(__file__).resolve().parents[2] / "target" / "fmu"


def packed_fmu(model: str = "nondimensional") -> Path:
    """Path of the packed FMU of one of `MODELS`: that of the installed package, or in a checkout ``target/fmu``.

    Raises `UnknownName` for an unknown model.
    """
    if model not in MODELS:
        raise UnknownName("actuator", model, MODELS)
    name = f"{MODELS[model]}.fmu"
    return _DATA / name if (_DATA / name).is_file() else _CHECKOUT / name


def located(fmu: str | Path) -> Path:
    """The path of an FMU that is given as one, or by the name of one of `MODELS`.

    Raises FileNotFoundError where there is none, `UnknownName` for an unknown name.
    """
    named = isinstance(fmu, str) and not Path(fmu).suffix
    path = packed_fmu(str(fmu)) if named else Path(fmu)
    if not path.is_file():
        raise FileNotFoundError(f"no FMU at {path}; in a checkout, make fmu builds and packs it")
    return path


def described(path: Path) -> ModelDescription:
    """The model description of a packed FMU; ValueError where the file is no FMI 2.0 unit for co-simulation."""
    try:
        found = fmpy.read_model_description(str(path))
    except OSError:
        raise
    except Exception as reason:  # FMPy raises what its readers of archives and of XML raise, and Exception itself
        raise ValueError(f"{path} cannot be read as an FMU: {reason}") from None
    if found.fmiVersion != "2.0" or found.coSimulation is None:
        kind = "co-simulation" if found.coSimulation else "model exchange"
        raise ValueError(
            f"{path} is an FMU for {kind} in FMI {found.fmiVersion}; it must be one for co-simulation in FMI 2.0"
        )
    return found


def limits(model: str, names: Container[str]) -> dict[str, tuple[float, float, float]]:
    """Start value, smallest and largest value of these variables of one of `MODELS`."""
    return {
        variable.name: (
            float(variable.start),
            -math.inf if variable.min is None else float(variable.min),
            math.inf if variable.max is None else float(variable.max),
        )
        for variable in described(located(model)).modelVariables
        if variable.name in names
    }


class UnknownName(KeyError):
    """An unknown name; the message suggests names with a similar spelling."""

    def __init__(self, kind: str, name: str, known: Iterable[str]):
        known = list(known)
        alike = difflib.get_close_matches(name, known, n=3, cutoff=0.4)
        ending = f"did you mean {' or '.join(alike)}?" if alike else f"there is {', '.join(known)}"
        self._message = f"no {kind} {name!r}; {ending}"
        super().__init__(self._message)

    def __str__(self) -> str:
        return self._message


class LogMessage(NamedTuple):
    """One call of the logger: FMI status (0 OK, 1 warning, 2 discard, 3 error, 4 fatal), category, text."""

    status: int
    category: str
    text: str


def instantiate(folder: str | Path, description: ModelDescription, log: list[LogMessage]) -> FMU2Slave:
    """Instantiate the FMU unpacked in `folder` as an ``fmpy.fmi2.FMU2Slave`` whose messages are appended to `log`.

    FMPy's own way to pass a logger goes through one process-wide pointer: the logger passed last gets the
    messages of every instance, and once its instance is freed the next message of another one crashes the
    process (seen with FMPy 0.3.32). FMPy needs that detour for printf-style messages; the actuator's are
    finished texts, so that each instance can call its own logger directly.
    """

    def logger(_component: Any, _instance: bytes, status: int, category: bytes, text: bytes) -> None:
        log.append(LogMessage(status, (category or b"").decode(), text.decode()))

    callbacks = fmi2CallbackFunctions(
        logger=fmi2CallbackLoggerTYPE(logger),
        allocateMemory=fmi2CallbackAllocateMemoryTYPE(fmpy.calloc),
        freeMemory=fmi2CallbackFreeMemoryTYPE(fmpy.free),
    )
    identifier = description.coSimulation.modelIdentifier
    try:
        instance = FMU2Slave(
            guid=description.guid,
            modelIdentifier=identifier,
            unzipDirectory=str(folder),
            instanceName="actuator",
            libraryPath=_library(Path(folder), identifier),
        )
        instance.instantiate(callbacks=callbacks, loggingOn=True)
    except Exception as reason:  # FMPy has no narrower one
        raise OSError(f"{description.modelName} cannot be loaded on this machine: {reason}") from reason
    return instance


def _library(folder: Path, identifier: str) -> str | None:
    """The shared library where FMPy would take another's: it looks in ``linux64`` on every 64-bit Linux."""
    if platform.system() == "Linux" and platform.machine() == "aarch64":
        return str(folder / "binaries" / "aarch64-linux" / f"{identifier}.so")
    return None


class Access(NamedTuple):
    """How FMI 2 reads and writes a variable of one type, and how NumPy stores it."""

    function: str
    c_type: Any
    dtype: Any
    whole: tuple[int, int] | None = None
    """The smallest and the largest value of a type that has whole numbers only."""


_INTEGER = Access("Integer", fmi2Integer, np.int32, (-(2**31), 2**31 - 1))
_ACCESS = {
    "Real": Access("Real", fmi2Real, np.float64),
    "Integer": _INTEGER,
    "Enumeration": _INTEGER,
    "Boolean": Access("Boolean", fmi2Boolean, np.bool_, (0, 1)),
}


class Group:
    """Variables of one FMI type with their buffers laid out once, so that a step reads without allocating."""

    def __init__(self, instance: FMU2Slave, access: Access, names: list[str], references: list[int]):
        self.names = names
        self._whole = access.whole
        self._component = instance.component
        self._getter = getattr(instance, "fmi2Get" + access.function)
        self._setter = getattr(instance, "fmi2Set" + access.function)
        self._references = (fmi2ValueReference * len(references))(*references)
        self.values = (access.c_type * len(references))()

    def take(self, values: Mapping[str, Any]) -> None:
        """Fill `values` for `write`. A whole number may be given in any type; ValueError where it is none."""
        numbers = [values[name] for name in self.names]
        if self._whole is not None:
            lowest, highest = self._whole
            for name, value in zip(self.names, numbers):
                if not (lowest <= value <= highest and value == int(value)):
                    raise ValueError(f"{name} is {value}; it must be a whole number from {lowest} to {highest}")
            numbers = list(map(int, numbers))
        self.values[:] = numbers

    def read(self) -> None:
        """Fill `values` from the instance."""
        self._getter(self._component, self._references, len(self.values), self.values)

    def write(self) -> None:
        """Hand `values` to the instance."""
        self._setter(self._component, self._references, len(self.values), self.values)


class Variables:
    """The variables of a model by name, as its description lists them."""

    def __init__(self, description: ModelDescription):
        self.by_name: Mapping[str, ScalarVariable] = {
            variable.name: variable for variable in description.modelVariables
        }
        self._groups: dict[tuple[str, ...], list[Group]] = {}

    def __getitem__(self, name: str) -> ScalarVariable:
        if name not in self.by_name:
            raise UnknownName("variable", name, self.by_name)
        return self.by_name[name]

    def reference(self, name: str) -> int:
        """Value reference of a variable."""
        return int(self[name].valueReference)

    def access(self, name: str) -> Access:
        """How a variable is read and written."""
        return _ACCESS[self[name].type]

    def table(self, names: Iterable[str] = ()) -> str:
        """Name, kind, unit, start value, limits and meaning of the named variables, or of all, a line each."""
        rows = [("name", "kind", "unit", "start", "limits", "meaning")]
        for variable in [self[name] for name in names] or self.by_name.values():
            bounded = variable.min is not None or variable.max is not None
            limits = f"{variable.min or '-inf'} to {variable.max or 'inf'}" if bounded else ""
            rows.append((
                variable.name, variable.causality, variable.unit or "", variable.start or "", limits,
                variable.description or "",
            ))  # fmt: skip
        widths = [max(map(len, column)) for column in zip(*rows)]
        return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows)

    def grouped(self, instance: FMU2Slave, names: Iterable[str]) -> list[Group]:
        """The names by FMI type, each group with its buffers; laid out once for each list of names."""
        names = tuple(names)
        if names not in self._groups:
            by_access: dict[Access, list[str]] = {}
            for name in names:
                by_access.setdefault(self.access(name), []).append(name)
            self._groups[names] = [
                Group(instance, access, group, [self.reference(name) for name in group])
                for access, group in by_access.items()
            ]
        return self._groups[names]
