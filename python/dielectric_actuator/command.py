"""The command ``dielectric-actuator``: run, presets, variables, thresholds, sweep, fit."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from . import __version__, device, native, presets
from .actuator import Actuator
from .fmu import UnknownName, described, located
from .kept import KeptTable, writable, write_table
from .native import grid, known_names, scene_names

THRESHOLDS = {
    "phi_pull_in": "dynamic pull-in voltage, switched on at rest",
    "lambda3_pull_in": "thickness stretch there",
    "phi_pull_in_static": "static pull-in voltage, raised slowly",
    "lambda3_pull_in_static": "thickness stretch there",
    "V_pull_in_dynamic": "pull-in voltage, switched on at rest, without losses",
    "V_pull_in_from_rest": "the same with damping and series resistance",
    "V_pull_in_static": "static pull-in voltage, raised slowly",
    "lambda_snap": "stretch to which it snaps there",
}
"""The variables that are printed, where the actuator has them."""
EXTRAS = {"matplotlib": "plot", "scipy": "fit"}
"""The extra of the package that brings a module."""
VARIABLES = "Variables of the FMU are options too, by their names: --phi 0.6 --gamma_s 0.05."
FIRST_PRESET = {"nondimensional": "step", "si": "silicone_swing"}
UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "voltage": {"V": 1.0, "kV": 1e3},
    "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9},
    "stretch": {"1": 1.0},
}
"""What measured data may be in, each as so many SI units."""

Values = dict[str, float]


def main(words: Sequence[str] | None = None) -> int:
    """Run the command; 0 on success, 2 if it was not understood, 1 if it could not be done, 130 if interrupted."""
    words = sys.argv[1:] if words is None else list(words)
    try:
        if words and not words[0].startswith("-") and words[0] not in VERBS:
            raise UnknownName("command", words[0], VERBS)
        parser, verbs = _parser()
        if words and words[0] in VERBS:
            words = _joined(words, verbs[words[0]])
        arguments, rest = parser.parse_known_args(words)
        arguments.run(arguments, _variables(rest, arguments))
    except BrokenPipeError:
        # the reader has seen enough; what is still buffered goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except ImportError as missing:
        extra = EXTRAS.get(str(missing.name).partition(".")[0])
        advice = f"; it comes with pip install 'dielectric-actuator[{extra}]'" if extra else ""
        print(f"error: {missing}{advice}", file=sys.stderr)
        return 1
    except (MemoryError, OverflowError) as reason:
        print(f"error: {str(reason) or 'the memory is full'}; ask for fewer steps or scenes", file=sys.stderr)
        return 1
    except (FMICallException, UnknownName, ValueError, OSError, RuntimeError) as reason:
        notes = getattr(reason, "__notes__", [])
        print(f"error: {'; '.join([*notes, *([] if notes else [str(reason)])])}", file=sys.stderr)
        return 2 if isinstance(reason, (UnknownName, ValueError)) else 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return 0


def _parser() -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    """The parser of the command, and that of each verb."""
    parser = argparse.ArgumentParser(
        prog="dielectric-actuator", description="The motion of a dielectric elastomer actuator.", allow_abbrev=False
    )
    parser.add_argument("--version", action="version", version=__version__)
    verbs = parser.add_subparsers(required=True, metavar="COMMAND")

    def verb(name: str) -> argparse.ArgumentParser:
        run, about, variables = VERBS[name]
        added = verbs.add_parser(
            name, help=about, description=f"{about}. {VARIABLES if variables else ''}", allow_abbrev=False
        )
        added.set_defaults(run=run, variables=variables, si=False, fmu=None, preset=None, parser=added)
        return added

    def in_si(of: argparse.ArgumentParser) -> None:
        of.add_argument("--si", action="store_true", help="the actuator in volts, metres and seconds")

    run = verb("run")
    in_si(run)
    run.add_argument("--preset", help="the scene or material to begin with (default: step, with --si silicone_swing)")
    run.add_argument("--stop-time", type=float, help="default: the preset's")
    run.add_argument("--step", type=float, help="communication step (default: the preset's)")
    run.add_argument("--at-equilibrium", action="store_true", help="start at rest where the inputs hold the actuator")
    run.add_argument("--fmu", type=Path, help="another packed FMU with these variables")
    run.add_argument("--plot", type=Path, metavar="PNG", help="write history, pull-in margin and phase portrait")
    run.add_argument("--csv", type=Path, metavar="CSV", help="write the response")

    show = verb("presets")
    show.add_argument("name", nargs="?")
    show.add_argument(
        "--ssv",
        type=Path,
        help="write its start values for hosts that read such files; without a name all, in a folder",
    )

    listed = verb("variables")
    in_si(listed)
    listed.add_argument("name", nargs="*", help="only these")

    thresholds = verb("thresholds")
    in_si(thresholds)
    thresholds.add_argument("--preset", help="the scene or material to begin with")

    sweep = verb("sweep")
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

    fit = verb("fit")
    in_si(fit)
    fit.add_argument("data", type=Path, help="a CSV file with a column each for time, voltage and stretch")
    fit.add_argument("--free", required=True, help="parameters to find, with commas between them")
    fit.add_argument("--time", default="time", help="name of that column (default: %(default)s)")
    fit.add_argument("--voltage", default="voltage", help="name of that column (default: %(default)s)")
    fit.add_argument("--stretch", default="stretch", help="name of that column (default: %(default)s)")
    fit.add_argument(
        "--observed", default="lambda", help="with --si: lambda, thickness, edge_distance or edge_displacement"
    )
    fit.add_argument(
        "--units",
        help="with --si, of the three columns: s, ms, us; V, kV; m, mm, um, nm, of a stretch 1 (default: s,V,m)",
    )
    fit.add_argument("--hold", action="store_true", help="the voltage keeps its value until the next row")
    fit.add_argument("--preset", type=Path, metavar="JSON", dest="write", help="write what was found as a preset")
    return parser, verbs.choices


def _joined(words: Sequence[str], verb: argparse.ArgumentParser) -> list[str]:
    """``--NAME VALUE`` as one word where the verb has no such option: its value is no argument of its own."""
    joined: list[str] = []
    for word in words:
        before = joined[-1] if joined else ""
        is_variable = before.startswith("--") and "=" not in before and before not in verb._option_string_actions
        if is_variable and before != "--" and not word.startswith("--"):
            joined[-1] = f"{before}={word}"
        else:
            joined.append(word)
    return joined


def _model(arguments: Any) -> str:
    """The actuator that is meant: that of the preset, or of --si."""
    chosen = "si" if arguments.si else "nondimensional"
    if arguments.preset is None:
        return chosen
    model = presets.load(arguments.preset).model
    if arguments.si and model != "si":
        raise ValueError(f"the preset {arguments.preset} is nondimensional; leave --si out")
    return model


def _variables(words: Sequence[str], arguments: Any) -> Values:
    """Values of variables from what the parser has left, ``--NAME=VALUE``."""
    if not words:
        return {}
    known = arguments.variables(arguments) if arguments.variables else ()
    options = [option.removeprefix("--") for option in arguments.parser._option_string_actions if len(option) > 2]
    values: Values = {}
    for word in words:
        name, _, text = word.partition("=")
        if not word.startswith("--"):
            raise ValueError(f"{word!r} is no option; variables are given as --NAME VALUE")
        name = name.removeprefix("--")
        if name not in known:
            raise UnknownName("option or variable" if known else "option", name, [*options, *known])
        try:
            values[name] = float(text)
        except ValueError:
            raise ValueError(f"{name} is {text!r}; it must be a number") from None
    return values


def _settable(arguments: Any) -> list[str]:
    """Inputs and parameters of the actuator that is meant."""
    variables = described(located(arguments.fmu or _model(arguments))).modelVariables
    return [variable.name for variable in variables if variable.causality in ("input", "parameter")]


def _run(arguments: Any, values: Values) -> None:
    model = _model(arguments)
    preset = presets.load(arguments.preset or FIRST_PRESET[model])
    scene = {**preset.start_values, **values}
    for path in filter(None, (arguments.csv, arguments.plot)):
        writable(path)
    from .plot import OVERVIEW, overview

    with Actuator(arguments.fmu or model) as actuator:
        response = actuator.run(
            scene,
            stop_time=preset.stop_time if arguments.stop_time is None else arguments.stop_time,
            communication_step=preset.communication_step if arguments.step is None else arguments.step,
            outputs=(*OVERVIEW, "lambda3"),
            at_equilibrium=arguments.at_equilibrium,
            progress=_each_second(
                lambda done, count, seconds: f"{done} of {count} steps, {(count - done) * seconds / done:.0f} s left"
            ),
        )
        pulled_in, when = actuator.get("pulled_in", "pull_in_time")
        units = actuator.units
    stretch, clock = response["lambda"], f" {units['time']}" if units["time"] else ""
    print(
        f"stretch from {stretch.min():.6g} to {stretch.max():.6g}, {stretch[-1]:.6g} at time "
        f"{response['time'][-1]:g}{clock}"
    )
    print(f"pulled in at time {when:.6g}{clock}" if pulled_in else "not pulled in")
    if arguments.csv:
        write_table(arguments.csv, {name: response[name] for name in response.dtype.names or ()})
        print(arguments.csv)
    if arguments.plot:
        shown = [f"{name} = {value:g} {units.get(name, '')}".rstrip() for name, value in scene.items()]
        title = preset.title if len(shown) > 6 else ", ".join(shown)
        overview(response, title, units=units).savefig(arguments.plot)
        print(arguments.plot)


def _each_second(said: Callable[[int, Any, float], str]) -> Callable[[int, Any], None]:
    """Progress on standard error, a line each second: `said` of two numbers and the seconds since the begin."""
    begin = shown = time.perf_counter()

    def report(done: int, other: Any) -> None:
        nonlocal shown
        now = time.perf_counter()
        if now - shown >= 1:
            shown = now
            print(said(done, other, now - begin), file=sys.stderr)

    return report


def _presets(arguments: Any, _values: Values) -> None:
    if arguments.name is None:
        for model, heading in (("nondimensional", "nondimensional"), ("si", "in volts, metres and seconds")):
            print(f"{heading}:")
            for name in presets.names(model):
                print(f"  {name:<22} {presets.load(name).title}")
        if arguments.ssv:
            print(*presets.save_all(arguments.ssv), sep="\n")
        return
    preset = presets.load(arguments.name)
    print(f"{preset.title}\n{preset.about()}")
    with Actuator(preset.model) as actuator:
        units = actuator.units
    for name, value in preset.start_values.items():
        print(f"  {name} = {value:g} {units[name]}".rstrip())
    print(f"  until {preset.stop_time:g} in steps of {preset.communication_step:g} {units['time']}".rstrip())
    if arguments.ssv:
        print(preset.save_ssv(arguments.ssv))


def _describe(arguments: Any, _values: Values) -> None:
    with Actuator(_model(arguments)) as actuator:
        print(actuator.describe(*arguments.name))


def _thresholds(arguments: Any, values: Values) -> None:
    with Actuator(_model(arguments)) as actuator:
        if arguments.preset:
            values = {**presets.load(arguments.preset).start_values, **values}
        actuator.start(values)
        for name, meaning in THRESHOLDS.items():
            if name in actuator.variables:
                value = actuator.get(name)
                shown = f"{value} {actuator.units[name]}".rstrip() if 0 < value < float("inf") else "none"
                print(f"{name:<24}{shown:>22}  {meaning}")
        try:
            stretch: float | str = actuator.equilibrium(values)
        except ValueError:
            stretch = "none"
        print(f"{'equilibrium stretch':<24}{stretch:>22}  where these inputs hold the actuator")


def _sweep(arguments: Any, values: Values) -> None:
    varied = [name for name, _ in arguments.vary]
    for name in varied:
        if name not in scene_names():
            raise UnknownName("variable", name, scene_names())
        if varied.count(name) > 1 or name in values:
            raise ValueError(f"{name} is given twice")
    columns = grid(**dict(arguments.vary))
    count = len(next(iter(columns.values())))
    scenes = {**columns, **{name: np.full(count, value) for name, value in values.items()}}
    rows = native.scene_rows(scenes)
    work = repr([arguments.vary, sorted(values.items()), arguments.stop_time, arguments.tolerance, __version__])
    with KeptTable(arguments.output, work) as table:
        before = done = table.done
        parts = native.parts(
            rows[before:], stop_time=arguments.stop_time, tolerance=arguments.tolerance, workers=arguments.workers
        )
        print(f"{count} scenes" + (f", going on from {before}" if before else ""), file=sys.stderr)

        def said(done: int, count: int, seconds: float) -> str:
            rate = (done - before) / seconds
            return f"{done} of {count}, {rate:.0f} a second, {(count - done) / rate:.0f} s left"

        progress = _each_second(said)
        try:
            for found in parts:
                chosen = {name: column[done : done + len(found)] for name, column in scenes.items()}
                table.add({**chosen, **{name: found[name] for name in found.dtype.names or ()}})
                done += len(found)
                progress(done, count)
        except KeyboardInterrupt:
            print(f"{done} of {count} are kept; the same command goes on from there", file=sys.stderr)
            raise
        path = table.complete()
    print(f"{done} of {count} done", file=sys.stderr)
    print(path)


def _fit(arguments: Any, values: Values) -> None:
    from . import measured
    from .identification import fit

    names = (arguments.time, arguments.voltage, arguments.stretch)
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"the column {name!r} is named twice; time, voltage and stretch are three columns")
    if arguments.units and not arguments.si:
        raise ValueError("--units needs --si: without it, all quantities are nondimensional")
    if arguments.write:
        writable(arguments.write)
    table = measured.read(arguments.data, names)
    clock, columns = measured.check(
        table[arguments.time], {name: table[name] for name in names[1:]}, clock=arguments.time
    )
    voltage, stretch = columns.values()
    scales = _scales(arguments.units, arguments.observed) if arguments.si else (1.0, 1.0, 1.0)
    found = fit(
        *(data * scale for data, scale in zip((clock, voltage, stretch), scales)),
        free=[name.strip() for name in arguments.free.split(",")],
        start=values,
        model="si" if arguments.si else "nondimensional",
        observed=arguments.observed,
        interpolation="hold" if arguments.hold else "linear",
        progress=_each_second(lambda count, left, _: f"{count} motions followed, {left:.3g} left of the measured"),
    )
    print(found.table())
    if arguments.write:
        middle = float(np.median(voltage)) * scales[1]
        print(found.preset(f"Fitted to {arguments.data.name}", middle).save(arguments.write))


def _scales(units: str | None, observed: str) -> tuple[float, float, float]:
    """SI units in a unit of each column; a stretch has none."""
    kinds = ("time", "voltage", "stretch" if observed == "lambda" else "length")
    if units is None:
        return 1.0, 1.0, 1.0
    given = [unit.strip() for unit in units.split(",")]
    if len(given) != 3:
        raise ValueError(
            f"{units!r} names {len(given)} units; it must be those of {', '.join(kinds)}, with commas between them"
        )
    for kind, unit in zip(kinds, given):
        if unit not in UNITS[kind]:
            raise UnknownName(f"unit of {kind}", unit, UNITS[kind])
    seconds, volts, metres = (UNITS[kind][unit] for kind, unit in zip(kinds, given))
    return seconds, volts, metres


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


VERBS: dict[str, tuple[Callable[[Any, Values], None], str, Callable[[Any], Sequence[str]] | None]] = {
    "run": (_run, "Run one scene", _settable),
    "presets": (_presets, "List the presets, or show one", None),
    "variables": (_describe, "List the variables with their units, limits and meaning", None),
    "thresholds": (_thresholds, "Pull-in thresholds and equilibrium", _settable),
    "sweep": (_sweep, "Follow every combination of values, on all cores", lambda _: scene_names()),
    "fit": (
        _fit,
        "Find parameters from measured voltage and stretch",
        lambda arguments: device.NAMES if arguments.si else known_names(),
    ),
}
"""Each command: what runs it, what it does, and the variables that are options of it."""
