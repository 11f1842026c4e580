"""The command ``dielectric-actuator``: run, presets, thresholds, sweep, fit."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from . import __version__, presets
from .actuator import Actuator
from .fmu import UnknownName
from .kept import KeptTable

THRESHOLDS = {
    "phi_pull_in": "dynamic pull-in voltage, switched on at rest",
    "lambda3_pull_in": "thickness stretch there",
    "phi_pull_in_static": "static pull-in voltage, raised slowly",
    "lambda3_pull_in_static": "thickness stretch there",
}
EXTRAS = {"matplotlib": "plot", "scipy": "fit"}
"""The extra of the package that brings a module."""
VARIABLES = "Variables of the FMU are options too, by their names: --phi 0.6 --gamma_s 0.05."


def main(words: Sequence[str] | None = None) -> int:
    """Run the command; 0 on success, 2 if it was not understood, 1 if it could not be done, 130 if interrupted."""
    arguments, rest = _parser().parse_known_args(words)
    try:
        arguments.run(arguments, _variables(rest))
    except ImportError as missing:
        extra = EXTRAS.get(str(missing.name).partition(".")[0])
        advice = f"; it comes with pip install 'dielectric-actuator[{extra}]'" if extra else ""
        print(f"error: {missing}{advice}", file=sys.stderr)
        return 1
    except (FMICallException, UnknownName, ValueError, OSError, RuntimeError) as reason:
        notes = getattr(reason, "__notes__", [])
        print(f"error: {'; '.join([*notes, *([] if notes else [str(reason)])])}", file=sys.stderr)
        return 2 if isinstance(reason, (UnknownName, ValueError)) else 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="dielectric-actuator", description="The motion of a dielectric elastomer actuator.", allow_abbrev=False
    )
    parser.add_argument("--version", action="version", version=__version__)
    verbs = parser.add_subparsers(required=True, metavar="COMMAND")

    def verb(name: str, run: Callable[[Any, dict[str, float]], None], about: str) -> argparse.ArgumentParser:
        added = verbs.add_parser(name, help=about, description=f"{about}. {VARIABLES}", allow_abbrev=False)
        added.set_defaults(run=run)
        return added

    run = verb("run", _run, "Run one scene")
    run.add_argument("--preset", default="step", help="the scene to begin with (default: %(default)s)")
    run.add_argument("--stop-time", type=float, help="default: the preset's")
    run.add_argument("--step", type=float, help="communication step (default: the preset's)")
    run.add_argument("--at-equilibrium", action="store_true", help="start at rest where the inputs hold the actuator")
    run.add_argument("--fmu", type=Path, help="another packed FMU with these variables")
    run.add_argument("--plot", type=Path, metavar="PNG", help="write history, pull-in margin and phase portrait")
    run.add_argument("--csv", type=Path, metavar="CSV", help="write the response")

    show = verb("presets", _presets, "List the presets, or show one")
    show.add_argument("name", nargs="?")
    show.add_argument("--ssv", type=Path, metavar="SSV", help="write its start values for hosts that read such files")

    verb("thresholds", _thresholds, "Pull-in thresholds and equilibrium")

    sweep = verb("sweep", _sweep, "Follow every combination of values, on all cores")
    sweep.add_argument(
        "--vary",
        action="append",
        required=True,
        type=_axis,
        metavar="NAME=FIRST:LAST:COUNT",
        help="an axis of the grid; may be given several times",
    )
    sweep.add_argument("--stop-time", type=float, default=500.0, help="(default: %(default)s)")
    sweep.add_argument("--tolerance", type=float, default=1e-8, help="(default: %(default)s)")
    sweep.add_argument("--workers", type=int, default=0, help="threads (default: one a core)")
    sweep.add_argument("--output", type=Path, default=Path("sweep.csv"), help="(default: %(default)s)")

    fit = verb("fit", _fit, "Find parameters from measured voltage and stretch")
    fit.add_argument("data", type=Path, help="a CSV file with a column each for time, voltage and stretch")
    fit.add_argument("--free", required=True, help="parameters to find, with commas between them")
    fit.add_argument("--time", default="time", help="name of that column (default: %(default)s)")
    fit.add_argument("--voltage", default="voltage", help="name of that column (default: %(default)s)")
    fit.add_argument("--stretch", default="stretch", help="name of that column (default: %(default)s)")
    fit.add_argument("--hold", action="store_true", help="the voltage keeps its value until the next row")
    fit.add_argument("--preset", type=Path, metavar="JSON", help="write what was found as a preset")
    return parser


def _variables(words: Sequence[str]) -> dict[str, float]:
    """Values of variables from what the parser has left: ``--NAME VALUE`` or ``--NAME=VALUE``."""
    values: dict[str, float] = {}
    remaining = iter(words)
    for word in remaining:
        name, equals, text = word.partition("=")
        if not word.startswith("--"):
            raise ValueError(f"{word!r} is no option; variables are given as --NAME VALUE")
        if not equals:
            text = next(remaining, "")
        name = name.removeprefix("--")
        try:
            values[name] = float(text)
        except ValueError:
            # a name that there is not is told first
            with Actuator() as actuator:
                if name not in actuator.variables:
                    raise UnknownName("option or variable", name, actuator.variables) from None
            raise ValueError(f"{name} is {text!r}; it must be a number") from None
    return values


def _run(arguments: Any, values: dict[str, float]) -> None:
    preset = presets.load(arguments.preset)
    from .plot import OVERVIEW, overview

    with Actuator(arguments.fmu) as actuator:
        response = actuator.run(
            {**preset.start_values, **values},
            stop_time=arguments.stop_time or preset.stop_time,
            communication_step=arguments.step or preset.communication_step,
            outputs=(*OVERVIEW, "lambda3"),
            at_equilibrium=arguments.at_equilibrium,
        )
        pulled_in, when = actuator.get("pulled_in", "pull_in_time")
    stretch = response["lambda"]
    print(
        f"stretch from {stretch.min():.6g} to {stretch.max():.6g}, {stretch[-1]:.6g} at time {response['time'][-1]:g}"
    )
    print(f"pulled in at time {when:.6g}" if pulled_in else "not pulled in")
    if arguments.csv:
        _write_csv(arguments.csv, {name: response[name] for name in response.dtype.names or ()})
        print(arguments.csv)
    if arguments.plot:
        shown = ", ".join(f"{name} = {value:g}" for name, value in {**preset.start_values, **values}.items())
        overview(response, shown).savefig(arguments.plot)
        print(arguments.plot)


def _presets(arguments: Any, values: dict[str, float]) -> None:
    _refuse(values)
    if arguments.name is None:
        for name in presets.names():
            print(f"{name:<14} {presets.load(name).title}")
        return
    preset = presets.load(arguments.name)
    print(f"{preset.title}\n{preset.description}")
    for name, value in preset.start_values.items():
        print(f"  {name} = {value:g}")
    print(f"  until {preset.stop_time:g} in steps of {preset.communication_step:g}")
    if arguments.ssv:
        print(preset.save_ssv(arguments.ssv))


def _thresholds(_arguments: Any, values: dict[str, float]) -> None:
    with Actuator() as actuator:
        actuator.start(values)
        for name, meaning in THRESHOLDS.items():
            value = actuator.get(name)
            exists = 0 < value < float("inf")
            print(f"{name:<24}{value if exists else 'none':>20}  {meaning}")
        try:
            stretch: float | str = actuator.equilibrium(values)
        except ValueError:
            stretch = "none"
        print(f"{'equilibrium stretch':<24}{stretch:>20}  where these inputs hold the actuator")


def _sweep(arguments: Any, values: dict[str, float]) -> None:
    from .native import ensemble, grid

    columns = grid(**dict(arguments.vary))
    count = len(next(iter(columns.values())))
    scenes = {**columns, **{name: np.full(count, value) for name, value in values.items()}}
    work = repr([arguments.vary, sorted(values.items()), arguments.stop_time, arguments.tolerance, __version__])
    begin = time.perf_counter()
    with KeptTable(arguments.output, work) as table:
        before = table.done
        print(f"{count} scenes" + (f", going on from {before}" if before else ""), file=sys.stderr)
        start, part = before, 1024
        while start < count:
            part_begin = time.perf_counter()
            chosen = {name: column[start : start + part] for name, column in scenes.items()}
            found = ensemble(
                chosen, stop_time=arguments.stop_time, tolerance=arguments.tolerance, workers=arguments.workers
            )
            table.add({**chosen, **{name: found[name] for name in found.dtype.names or ()}})
            start = min(start + part, count)
            now = time.perf_counter()
            rate = (start - before) / (now - begin)
            print(f"{start} of {count}, {rate:.0f} a second, {(count - start) / rate:.0f} s left", file=sys.stderr)
            # a part takes about a second, so that little is lost and progress is seen
            part = min(max(int(part / (now - part_begin)), 128), 65536)
        print(table.complete())


def _fit(arguments: Any, values: dict[str, float]) -> None:
    from . import measured
    from .identification import fit

    names = (arguments.time, arguments.voltage, arguments.stretch)
    data = measured.read(arguments.data, names)
    found = fit(
        *(data[name] for name in names),
        free=[name.strip() for name in arguments.free.split(",")],
        start=values,
        interpolation="hold" if arguments.hold else "linear",
    )
    print(found.table())
    if arguments.preset:
        voltage = float(np.median(data[arguments.voltage]))
        print(found.preset(f"Fitted to {arguments.data.name}", voltage).save(arguments.preset))


def _axis(text: str) -> tuple[str, tuple[float, ...]]:
    """An axis of a grid; its values are those of ``numpy.linspace``."""
    name, equals, span = text.partition("=")
    try:
        first, last, count = span.split(":")
        if equals and int(count) > 0:
            return name, tuple(np.linspace(float(first), float(last), int(count)).tolist())
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"{text!r} is no axis; it must be NAME=FIRST:LAST:COUNT, as phi=0.1:0.6:50")


def _write_csv(path: Path, columns: dict[str, np.ndarray]) -> None:
    with KeptTable(path, str(path)) as table:
        table.add(columns)
        table.complete()


def _refuse(values: dict[str, float]) -> None:
    if values:
        raise ValueError(f"variables mean nothing here: {', '.join(values)}")


if __name__ == "__main__":
    sys.exit(main())
