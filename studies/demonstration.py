"""What the packed actuator does, in one minute: DC responses, pull-in, and one AC run, against exact values.

    python studies/demonstration.py [--fmu PATH] [--output FOLDER]

Prints the table "paper / exact / FMU / difference" and writes the figures as PNG. The exact values come
from tests/reference (multiprecision), none from the FMU. Numbers follow Singh, Shmuel and Sharma,
"Nonlinear dynamics of miniaturized dielectric elastomer actuators with surface effects".
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import figure_style as style
import figures
import references
import trajectories
import turning_points
from actuator_fmu import DEFAULT_FMU, ActuatorFmu
from comparison import Comparison
from pull_in_search import pull_in_bracket

TOLERANCE = 1e-12
DEFAULT_OUTPUT = DEFAULT_FMU.parents[1] / "demonstration"
SURFACE_PARAMETERS = ("gamma_s", "tau_s", "E_s")
MOTION = (*turning_points.OUTPUTS, "lambda3", "lambda3_dot")

PULL_IN_RESOLUTION = 1e-10
PULL_IN_DISTANCE = 1e-4
"""How far from the pull-in voltage the plotted responses are: the last digit that the paper prints."""

PULL_IN_SPANS = {"gamma_s": 140.0, "tau_s": 140.0, "E_s": 240.0}
"""Plotted times; with surface elasticity the motion above pull-in is periodic too, only much slower."""
TERMINATE = 2
"""Value of on_pull_in that ends the run at the collapse."""

SECTION_POINTS = 15_000

COMMUNICATION_STEPS = (0.01, 0.37, 1.0, 25.0)


class Progress:
    """One line a stage: what is being done, then how long it took."""

    def __init__(self, stages: int):
        self._stages = stages
        self._stage = 0

    @contextmanager
    def stage(self, text: str):
        self._stage += 1
        print(f"[{self._stage}/{self._stages}] {text:<72}", end="", flush=True)
        start = time.perf_counter()
        yield
        print(f"{time.perf_counter() - start:6.1f} s", flush=True)


def families_of(cases: list[references.SurfaceEffects]) -> dict[str, list[int]]:
    """For each surface parameter the positions, by growing value, of the cases that vary it alone.

    The reference case, which lies on all three lines, is the one that shares two parameters with every other.
    """

    def differing(one, other):
        return [name for name in SURFACE_PARAMETERS if getattr(one, name) != getattr(other, name)]

    centre = next(case for case in cases if all(len(differing(case, other)) <= 1 for other in cases))
    lines = {}
    for parameter in SURFACE_PARAMETERS:
        positions = [k for k, case in enumerate(cases) if differing(case, centre) in ([], [parameter])]
        lines[parameter] = sorted(positions, key=lambda k: getattr(cases[k], parameter))
    return lines


def dc_responses(actuator: ActuatorFmu, prestress: float, table: Comparison) -> figures.Figure:
    """The paper's Fig. 2 or 3: responses to a voltage step for varied surface parameters."""
    orbits = [orbit for orbit in references.dc_orbits() if orbit.case.S == prestress]
    span = 1.02 * 2 * max(orbit.period for orbit in orbits)
    oscillations = []
    table.heading(f"DC, phi = {orbits[0].phi:g}, S = {prestress:g}: period T, thickness stretch at the turn")
    for orbit in orbits:
        response = actuator.run(
            orbit.scene(), stop_time=span, communication_step=0.1, outputs=MOTION, tolerance=TOLERANCE
        )
        period, stretch = turning_points.period_and_overshoot(response)
        case = " ".join(f"{name}={getattr(orbit.case, name):g}" for name in SURFACE_PARAMETERS)
        table.add(f"{case:<31} T", exact=orbit.period, measured=period)
        table.add(f"{'':<31} lambda3", exact=orbit.turning_lambda3, measured=stretch**-2)
        oscillations.append((response, orbit.period, orbit.turning_lambda3))
    cases = [orbit.case for orbit in orbits]
    families = {
        parameter: [figures.Oscillation(getattr(cases[k], parameter), *oscillations[k]) for k in positions]
        for parameter, positions in families_of(cases).items()
    }
    title = f"Response to a DC voltage step, {style.setting(phi=orbits[0].phi, S=prestress)}"
    return figures.dc_responses(families, title=title)


def pull_in(actuator: ActuatorFmu, table: Comparison) -> figures.Figure:
    """Table 1 of the paper: thresholds found from the motion, the FMU's own, and the motion at both sides."""
    thresholds = references.table_1()
    found = []
    table.heading("Pull-in (Table 1): phi^C from the motion; phi_pull_in, lambda3_pull_in of the FMU")
    for threshold in thresholds:
        exact = threshold.dynamic
        below, above = pull_in_bracket(
            actuator, threshold.case.scene(), exact.stretch, below=0.5, above=1.0, resolution=PULL_IN_RESOLUTION
        )
        voltage = (below + above) / 2
        own_voltage, own_lambda3 = actuator.get("phi_pull_in", "lambda3_pull_in")
        case = " ".join(f"{n}={getattr(threshold.case, n):g}" for n in SURFACE_PARAMETERS if getattr(threshold.case, n))
        for quantity, printed, reference, measured in (
            (f"{case or 'ideal':<22} phi^C", threshold.printed_phi, exact.phi, voltage),
            (f"{'':<22} phi_pull_in", threshold.printed_phi, exact.phi, own_voltage),
            (f"{'':<22} lambda3_pull_in", threshold.printed_lambda3, exact.lambda3, own_lambda3),
        ):
            table.add(quantity, printed=printed, exact=reference, measured=measured)
        found.append((voltage, own_lambda3))

    def transition(k: int, parameter: str) -> figures.Transition:
        case, (voltage, lambda3) = thresholds[k].case, found[k]
        below, above = (
            actuator.run(
                case.scene(phi=voltage + offset, on_pull_in=TERMINATE),
                stop_time=PULL_IN_SPANS[parameter],
                communication_step=0.2,
                outputs=(*MOTION, "pulled_in"),
                tolerance=TOLERANCE,
            )
            for offset in (-PULL_IN_DISTANCE, PULL_IN_DISTANCE)
        )
        return figures.Transition(getattr(case, parameter), below, above, lambda3)

    families = {
        parameter: [transition(k, parameter) for k in positions]
        for parameter, positions in families_of([threshold.case for threshold in thresholds]).items()
    }
    title = "Just below and just above the dynamic pull-in voltage"
    return figures.pull_in_transitions(families, distance=PULL_IN_DISTANCE, title=title)


def driven(actuator: ActuatorFmu, table: Comparison) -> figures.Figure:
    """One run under the FMU's built-in harmonic drive, near the paper's harmonic resonance."""
    reference = references.driven_amplitudes()[0]
    response = actuator.run(
        reference.scene(),
        stop_time=reference.stop_time,
        communication_step=0.125,
        outputs=MOTION,
        tolerance=TOLERANCE,
    )
    amplitude = turning_points.thickness_amplitude(response)
    # The drive enters as φ², so that the forcing has period π/ω. The drive is exact inside a communication
    # step, hence one step a section point.
    forcing_period = math.pi / reference.omega_ac
    section = actuator.run(
        reference.scene(),
        stop_time=SECTION_POINTS * forcing_period,
        communication_step=forcing_period,
        outputs=("lambda3", "lambda3_dot"),
        tolerance=TOLERANCE,
    )
    drive = f"phi = {reference.phi_ac:g} sin({reference.omega_ac:g} t)"
    table.heading(f"AC, {drive}, {reference.case}, t <= {reference.stop_time:g}")
    table.add("amplitude (max - min)/2 of lambda3", exact=reference.amplitude, measured=amplitude)
    title = (
        rf"Harmonic drive $\bar{{\phi}}$ = {reference.phi_ac:g} sin({reference.omega_ac:g}$\,\bar{{t}}$),  "
        + style.setting(**reference.case.scene())
    )
    return figures.driven_response(response, section, amplitude=amplitude, title=title)


def reference_trajectories(actuator: ActuatorFmu, table: Comparison) -> None:
    """The multiprecision trajectories at very different communication steps, where they differ most."""
    for name, scene in references.TRAJECTORY_SCENES.items():
        values = " ".join(f"{variable}={value:g}" for variable, value in scene.items())
        table.heading(f"Trajectory {name}: {values}")
        for communication_step in COMMUNICATION_STEPS:
            worst = trajectories.follow(actuator, name, communication_step, TOLERANCE)
            table.add(
                f"steps of {communication_step:<6g} {worst.quantity} at t = {worst.time:g}",
                exact=worst.exact,
                measured=worst.measured,
            )


def main() -> int:
    """Run all stages; 0 on success, 2 if there is no packed FMU."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=DEFAULT_FMU, help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the PNGs (%(default)s)")
    arguments = parser.parse_args()
    if not arguments.fmu.is_file():
        print(f"no FMU at {arguments.fmu}; build and pack it first: make fmu", file=sys.stderr)
        return 2

    style.apply()
    table = Comparison()
    progress = Progress(stages=6)
    drawn = {}
    with ActuatorFmu(arguments.fmu) as actuator:
        with progress.stage("DC responses without prestress (Fig. 2)"):
            drawn["dc_without_prestress"] = dc_responses(actuator, 0.0, table)
        with progress.stage("DC responses with prestress (Fig. 3)"):
            drawn["dc_with_prestress"] = dc_responses(actuator, 0.5, table)
        with progress.stage("pull-in voltages by bisection on the motion (Table 1, Figs. 6, 7)"):
            drawn["pull_in"] = pull_in(actuator, table)
        with progress.stage("AC response and Poincaré section"):
            drawn["ac_response"] = driven(actuator, table)
        with progress.stage("trajectories at communication steps from 0.01 to 25"):
            reference_trajectories(actuator, table)
    with progress.stage("writing figures"):
        paths = [style.save(figure, arguments.output / f"{name}.png") for name, figure in drawn.items()]

    print(f"\n{table.text()}\n\nfigures:")
    for path in paths:
        print(f"  {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
