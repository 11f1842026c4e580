"""Run time against error of the real device: the command behind `make bench-device`.

    python benchmark/device.py [--rounds 5] [--milliseconds 10] [--scenes plain,viscous] [--records FOLDER]

The packed FMU in SI units against general integrators, on scenes of tests/reference/device: plain and viscous,
with a resistance whose RC is comparable to the period or a millionth of it, and with Maxwell branches. CVODE and
ARKODE in C (device.c), heyoka, and SciPy's Radau with a right-hand side in Python. A measurement is the time of a
whole fresh run; each round goes through all of them in turn, and the fastest counts.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import fmpy
import numpy as np

import page
import plots
import ratios
import records
from cases import DEVICE_SCENES, HERE, ROOT
from programs import C_FLAGS
from python_rivals import HEYOKA_TOLERANCES, LOST, seconds_of

sys.path.insert(0, str(ROOT / "studies"))

from device_scenes import DeviceScene, device_scene

FMU = ROOT / "target" / "fmu" / "DielectricElastomerActuatorSI.fmu"
FIGURE = ROOT / "docs" / "figures" / "benchmark_device.png"
FIELDS = ("method", "tolerance", "nanoseconds", "error", "note")
LIBRARIES = ("cvode", "arkode", "nvecserial", "sunnonlinsolfixedpoint", "sunlinsoldense", "sunmatrixdense")
RADAU_TOLERANCES = tuple(10.0**-k for k in range(3, 13))
LONGEST = 3.0
"""Seconds of one run that end the sweep of its method."""

VACUUM = 8.8541878188e-12


@dataclass(frozen=True)
class Device:
    """A scene in the nondimensional quantities of the rivals."""

    name: str
    scene: DeviceScene
    time: float
    charge: float
    groups: dict[str, float]
    """`c`, the coefficients of λ, λ³ and λ⁵ without the voltage, `phi`, `eta`, `r`, `m1`, `tau1`, …"""

    @classmethod
    def of(cls, name: str) -> Device:
        scene = device_scene(DEVICE_SCENES[name][0])
        values = scene.start
        modulus, density, thickness, side = (values[key] for key in ("mu", "rho", "H", "L"))
        permittivity = VACUUM * values["eps_r"]
        unit = thickness * math.sqrt(density / (12 * modulus))
        capacitance = permittivity * side**2 / thickness
        gamma, tau, elasticity = (values[key] / (modulus * thickness) for key in ("gamma_s", "tau_s", "E_s"))
        groups = {
            "c": (side / thickness) ** 2,
            "linear": 1 + 2 * gamma - 2 * tau + elasticity,
            "cubic": 4 * tau - 4 * elasticity,
            "quintic": 3 * elasticity,
            "phi": values["voltage"] * math.sqrt(permittivity / modulus) / thickness,
            "eta": values.get("eta", 0.0) / (modulus * unit),
            "r": values.get("R_s", 0.0) * capacitance / unit,
        }
        for branch in (1, 2, 3):
            if f"mu_{branch}" in values:
                groups[f"m{branch}"] = values[f"mu_{branch}"] / modulus
                groups[f"tau{branch}"] = values[f"tau_{branch}"] / unit
        return cls(name, scene, unit, side**2 * math.sqrt(permittivity * modulus), groups)

    @property
    def exact(self) -> np.ndarray:
        """Rows of time, stretch, rate and charge."""
        keys = ("t_s", "lambda", "lambda_dot_per_s", "charge_C")
        rows = np.array([[row[key] for key in keys] for row in self.scene.rows])
        return rows[rows[:, 0] > 0] * [1 / self.time, 1, self.time, 1 / self.charge]

    @property
    def branches(self) -> list[tuple[float, float]]:
        """Modulus and relaxation time of each Maxwell branch."""
        numbers = [branch for branch in (1, 2, 3) if f"m{branch}" in self.groups]
        return [(self.groups[f"m{branch}"], self.groups[f"tau{branch}"]) for branch in numbers]

    @property
    def start(self) -> list[float]:
        """Stretch, rate, charge if it is a state, and the square of each dashpot's stretch."""
        return [1.0, 0.0, *([0.0] if self.groups["r"] else []), *(1.0 for _ in self.branches)]

    def slopes(self, states: list) -> list:
        """Their rates, as numbers or as formulas: the equation of motion times λ⁷, with one division."""
        groups = self.groups
        x, v, *rest = states
        square = x * x
        fourth = square * square
        sixth = fourth * square
        constant, cubic, more = square, groups["cubic"], []
        if groups["r"]:
            q, *rest = rest
            constant = square + square * q * q
            more.append((groups["phi"] - q / fourth) / groups["r"])
        else:
            cubic = cubic - groups["phi"] ** 2
        inner = cubic + groups["quintic"] * square if groups["quintic"] else cubic
        upper = 6.0 * v * v + constant - sixth * (square * (groups["linear"] + square * inner))
        if groups["eta"]:
            upper = upper - 6.0 * groups["eta"] * v * fourth * x
        for (modulus, relaxation), g in zip(self.branches, rest):
            upper = upper - modulus * (sixth * square / g - g * g * square)
            more.append((square - g * g * g / fourth) / (3.0 * relaxation))
        return [v, upper / (x * (groups["c"] * sixth + 2.0)), *more]

    def error(self, states: np.ndarray) -> float:
        """Largest error of stretch, rate and charge, the last two over their largest value; inf for NaN."""
        exact = self.exact
        charge = states[:, 2] if self.groups["r"] else self.groups["phi"] * states[:, 0] ** 4
        found = np.column_stack([states[:, :2], charge])
        error = float(np.max(np.abs(found - exact[:, 1:]) / [1, *np.abs(exact[:, 2:]).max(axis=0)]))
        return error if math.isfinite(error) else math.inf


def build(fmu: Path, folder: Path) -> tuple[Path, Path]:
    """The program in C, and the library of the unpacked FMU."""
    program = folder / "device"
    headers = Path(fmpy.__file__).parent / "c-code"
    libraries = [f"-lsundials_{name}" for name in LIBRARIES]
    compiler = os.environ.get("CC", "cc")
    source = [str(HERE / "device.c"), f"-I{headers}", "-o", str(program)]
    for extra in (["-lsundials_core"], []):
        done = subprocess.run([compiler, *C_FLAGS, *source, *libraries, *extra, "-ldl", "-lm"], capture_output=True)
        if done.returncode == 0:
            break
    else:
        raise SystemExit(f"device.c needs SUNDIALS 6 or later with ARKODE: {done.stderr.decode()[-2000:]}")
    binary = f"binaries/{fmpy.platform}/{fmu.stem}{fmpy.sharedLibraryExtension}"
    with zipfile.ZipFile(fmu) as archive:
        return program, Path(archive.extract(binary, folder))


def compiled(program: Path, library: Path, description, device: Device, folder: Path, milliseconds: int) -> list[dict]:
    """The FMU and SUNDIALS."""
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    rows = folder / f"{device.name}.csv"
    np.savetxt(rows, device.exact, delimiter=",", fmt="%.17g")
    outputs = ",".join(str(references[name]) for name in ("lambda", "lambda_dot", "charge"))
    arguments = {
        **{"milliseconds": milliseconds, "reference": rows, "library": library, "guid": description.guid},
        **{"time": device.time, "rate": 1 / device.time, "charge": device.charge, "get": outputs},
        **{f"set:{references[name]}": value for name, value in device.scene.start.items()},
        **device.groups,
    }
    command = [str(program), *(f"{name}={value}" for name, value in arguments.items())]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"device.c, scene {device.name}: {done.stderr[-2000:]}")
    found = list(csv.DictReader(done.stdout.splitlines(), fieldnames=FIELDS))
    for row in found:
        # microseconds of a run in the column of the other records
        row["nanoseconds"] = float(row["nanoseconds"]) * 1e3 if row["nanoseconds"] else ""
    return found


class Heyoka:
    """heyoka's adaptive Taylor integrators, compiled once for each scene and tolerance; that is not counted.

    What a call that goes nowhere takes is taken off.
    """

    def __init__(self):
        self._compiled: dict[tuple[str, float], object] = {}

    def rows(self, device: Device, milliseconds: int) -> Iterator[dict]:
        import heyoka

        times, start = np.concatenate([[0.0], device.exact[:, 0]]), np.array(device.start)
        least = 1e-3 * milliseconds
        for tolerance in HEYOKA_TOLERANCES:
            key = (device.name, tolerance)
            if key not in self._compiled:
                names = ["x", "v", "q", "g1", "g2", "g3"]
                count = len(device.start)
                taken = names[:2] + (["q"] if device.groups["r"] else []) + names[3 : 3 + len(device.branches)]
                variables = list(heyoka.make_vars(*taken))
                assert len(variables) == count
                system = list(zip(variables, device.slopes(variables)))
                self._compiled[key] = heyoka.taylor_adaptive(system, device.start, tol=tolerance)

            def run(times, integrator=self._compiled[key]):
                integrator.time = 0.0
                integrator.state[:] = start
                return integrator.propagate_grid(times)[-1]

            begin = time.thread_time()
            error = device.error(run(times)[1:])
            seconds = single = time.thread_time() - begin
            if error <= LOST and single <= LONGEST:
                seconds = seconds_of(least, lambda: run(times)) - seconds_of(least, lambda: run(times[:1]))
            yield row_of("heyoka", tolerance, error, seconds)
            if single > LONGEST:
                return


def radau(device: Device) -> Iterator[dict]:
    """SciPy's implicit Runge-Kutta method of order 5, which is L-stable, with a right-hand side in Python."""
    from scipy.integrate import solve_ivp

    exact = device.exact
    scale = np.ones(len(device.start))
    scale[1] = np.abs(exact[:, 2]).max()
    if device.groups["r"]:
        scale[2] = np.abs(exact[:, 3]).max()
    for tolerance in RADAU_TOLERANCES:
        begin = time.thread_time()
        solution = solve_ivp(
            lambda _time, states: device.slopes(list(states)),
            *((0, exact[-1, 0]), device.start),
            **dict(method="Radau", t_eval=exact[:, 0], rtol=tolerance, atol=tolerance * scale),
        )
        seconds = time.thread_time() - begin
        error = device.error(solution.y.T) if solution.success else math.inf
        yield row_of("SciPy Radau", tolerance, error, seconds)
        if seconds > LONGEST:
            return


def row_of(method: str, tolerance: float, error: float, seconds: float) -> dict:
    """A row of output."""
    empty = {"method": method, "tolerance": f"{tolerance:.0e}".replace("e-0", "e-"), "nanoseconds": "", "error": ""}
    if error <= LOST:
        return {**empty, "nanoseconds": 1e9 * seconds, "error": error, "note": ""}
    return {**empty, "note": "not timed: another motion"}


def main() -> None:
    """Measure, record, draw, print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=FMU, help="the packed FMU in SI units")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--milliseconds", type=int, default=10, help="least time of a measurement")
    parser.add_argument("--scenes", default=",".join(DEVICE_SCENES))
    parser.add_argument("--records", type=Path, help="folder instead of benchmark/records")
    parser.add_argument("--figure", type=Path, default=FIGURE)
    options = parser.parse_args()
    whole = options.scenes == ",".join(DEVICE_SCENES)
    if not whole and (options.records is None or options.figure == FIGURE):
        parser.error("a part of the scenes does not make the record: name another place with --records and --figure")
    if unknown := {*options.scenes.split(",")} - {*DEVICE_SCENES}:
        parser.error(f"there is no scene {', '.join(sorted(unknown))}")
    facts = records.machine()
    heyoka = Heyoka()
    raw: list[dict] = []
    devices = [Device.of(name) for name in options.scenes.split(",")]
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        program, library = build(options.fmu, folder)
        description = fmpy.read_model_description(str(options.fmu))
        version = subprocess.run([program, "version"], capture_output=True, text=True).stdout.strip()
        for number in range(1, options.rounds + 1):
            for device in devices:
                print(f"round {number} of {options.rounds}, {device.name}", flush=True)
                found = compiled(program, library, description, device, folder, options.milliseconds)
                found += heyoka.rows(device, options.milliseconds)
                if number == 1:
                    found += radau(device)
                about = {"round": number, "case": device.name, "step": "", "inputs": "", "hold_error": ""}
                raw += [{**about, **row} for row in found]
    facts |= {
        "rounds": f"{options.rounds}, SciPy 1; methods in turn in each, the fastest counts",
        "nanoseconds": "of a whole run over the times of the reference, setting up included; heyoka less an idle call",
        "error": "largest of stretch, rate and charge, the last two over their largest value",
        "SUNDIALS": version,
        "C side": " ".join(C_FLAGS),
    }
    best = records.fastest(raw)
    target = records.folder(facts, options.records)
    written = [
        records.write(target / "device_raw.csv", facts, raw),
        records.write(target / "device.csv", facts, best),
        plots.device(best, {name: title for name, (_, title) in DEVICE_SCENES.items()}, options.figure),
    ]
    text = ratios.device_table(best) + "\n"
    tables = target / "device.md"
    tables.write_text("# Real device, milliseconds of a run\n\n" + text)
    if whole and options.records is None:
        page.PAGE.write_text(page.renewed(page.PAGE.read_text(), target))
        written.append(page.PAGE)
    print("\n" + text + "\nwritten:", *map(str, [*written, tables]), sep="\n  ")


if __name__ == "__main__":
    main()
