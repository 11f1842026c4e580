"""A host for the FMUs of an SSP that passes derivatives along with the values.

FMPy's `simulate_ssp` and most other hosts hand over values alone, which the receiver then holds over the step.
Here every connection carries the derivatives by time of its source as well (``fmi2GetRealOutputDerivatives``,
``fmi2SetRealInputDerivatives``), so that the receiver follows the Taylor polynomial of its input inside the step.
All units then step on their own, at once if one likes (a Jacobi scheme).
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import fmpy
import numpy as np
from fmpy.ssp.ssd import find_components, read_ssd, read_ssv

from dielectric_actuator import Actuator

Connection = tuple[tuple[str, str], tuple[str, str]]
"""Unit and variable that a value comes from, and those that it goes to."""


class Coupling:
    """The loaded units of an SSP without subsystems or system inputs; a context manager that frees them."""

    def __init__(self, ssp: Path):
        self._folder = fmpy.extract(str(ssp))
        system = read_ssd(str(ssp)).system
        # the runner of the actuator serves any co-simulation FMU
        self.units = {
            component.name: Actuator(Path(self._folder, component.source)) for component in find_components(system)
        }
        self._connections: list[Connection] = [
            ((link.startElement, link.startConnector), (link.endElement, link.endConnector))
            for link in system.connections
        ]
        self._parameters: dict[str, dict[str, float]] = {name: {} for name in self.units}
        for parameter in read_ssv(str(ssp), "parameters.ssv").parameters:
            unit, _, variable = parameter.name.partition(".")
            self._parameters[unit][variable] = float(parameter.value)

    def __enter__(self) -> Coupling:
        return self

    def __exit__(self, *_exception) -> None:
        for unit in self.units.values():
            unit.close()
        shutil.rmtree(self._folder)

    def run(
        self,
        outputs: list[str],
        *,
        stop_time: float,
        step: float,
        order: int,
        tolerance: float,
        loop: bool = False,
        inputs: Mapping[str, Callable[[float], float]] = MappingProxyType({}),
    ) -> np.ndarray:
        """Run from 0 to `stop_time` (a multiple of `step`) and return one row a communication point.

        `outputs` are names like ``leader.lambda``; connections carry derivatives up to `order` (0: values
        alone, held). `loop` says that the last connection closes an algebraic loop, which is then solved.
        `inputs` are set at each communication point and held.
        """
        for name, unit in self.units.items():
            unit.start(self._parameters[name], tolerance=tolerance)
        steps = round(stop_time / step)
        rows = np.empty(steps + 1, dtype=[("time", float)] + [(name, float) for name in outputs])
        for row in range(steps + 1):
            for name, value in inputs.items():
                receiver, _, variable = name.partition(".")
                self.units[receiver].set({variable: value(row * step)})
            if loop:
                self._solve_loop(order)
            else:
                self._exchange(order)
            rows[row] = (row * step, *(self._value(name) for name in outputs))
            if row < steps:
                for unit in self.units.values():
                    unit.time = row * step
                    unit.advance(step)
        return rows

    def set_parameters(self, unit: str, values: Mapping[str, float]) -> None:
        """Set other parameters in a unit than the SSP does, from the next run on."""
        self._parameters[unit].update(values)

    def parameters(self, unit: str) -> dict[str, float]:
        """What the SSP sets in a unit."""
        return dict(self._parameters[unit])

    def _exchange(self, order: int) -> None:
        """Carry every source to its receivers.

        A source may depend at once on what its own unit receives, its k-th derivative on the others' lower
        ones: with the connections listed along the signal, a round settles one order.
        """
        for _ in range(order + 1):
            for connection in self._connections:
                self._carry(connection, order)

    def _solve_loop(self, order: int) -> None:
        """Carry every source to its receivers where the last connection closes a loop.

        What comes round depends on what went in like a straight line, in each order of derivatives once the
        lower ones are right: two rounds give the line, and the value that reproduces itself.
        """
        (_, (receiver, variable)) = self._connections[-1]

        def round_trip(carried: list[float]) -> float:
            """The highest order that comes round, after these orders went in."""
            self.units[receiver].set({variable: carried[0]})
            self.units[receiver].set_input_derivatives({variable: carried[1:]})
            for connection in self._connections[:-1]:
                self._carry(connection, len(carried) - 1)
            ((source, output), _) = self._connections[-1]
            if len(carried) == 1:
                return self.units[source].get(output)
            return self.units[source].output_derivatives(output, len(carried) - 1)[-1]

        right: list[float] = []
        for _ in range(order + 1):
            first = round_trip([*right, 0.0])
            second = round_trip([*right, first])
            # first + slope x = x, with slope = (second − first)/first
            right.append(first * first / (2 * first - second) if second != first else first)
        round_trip(right)

    def _carry(self, connection: Connection, order: int) -> None:
        (source, output), (receiver, variable) = connection
        self.units[receiver].set({variable: self.units[source].get(output)})
        derivatives = self.units[source].output_derivatives(output, order)
        self.units[receiver].set_input_derivatives({variable: derivatives})

    def _value(self, name: str) -> float:
        unit, _, variable = name.partition(".")
        return self.units[unit].get(variable)
