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
from pathlib import Path

import figure_style as style
import figures
import references
import snap
import trajectories
import turning_points
from comparison import Comparison
from dc_motion import MOTION, PULL_IN_DISTANCE, TOLERANCE, held, oscillations, pull_in
from dielectric_actuator import Actuator, packed_fmu
from progress import Progress

DEFAULT_OUTPUT = Path(__file__).resolve().parents[1] / "target" / "demonstration"
SECTION_POINTS = 15_000

COMMUNICATION_STEPS = (0.01, 0.37, 1.0, 25.0)


def dc_responses(actuator: Actuator, prestress: float, table: Comparison) -> figures.Figure:
    """The paper's Fig. 2 or 3: responses to a voltage step for varied surface parameters."""
    title = f"Response to a DC voltage step, {style.setting(phi=0.6, S=prestress)};\n{held(prestress)}"
    return figures.dc_responses(oscillations(actuator, prestress, table), title=title)


def pull_in_transitions(actuator: Actuator, table: Comparison) -> figures.Figure:
    """Table 1 of the paper: thresholds found from the motion, the FMU's own, and the motion at both sides."""
    title = f"Just below and just above the dynamic pull-in voltage, {style.setting(S=0)}; the others held at 0"
    return figures.pull_in_transitions(pull_in(actuator, table), distance=PULL_IN_DISTANCE, title=title)


def driven(actuator: Actuator, table: Comparison) -> figures.Figure:
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


def reference_trajectories(actuator: Actuator, table: Comparison) -> None:
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
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed FMU (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder for the PNGs (%(default)s)")
    arguments = parser.parse_args()
    if not arguments.fmu.is_file():
        print(f"no FMU at {arguments.fmu}; build and pack it first: make fmu", file=sys.stderr)
        return 2

    style.apply()
    table = Comparison()
    progress = Progress(stages=6)
    drawn = {}
    with Actuator(arguments.fmu) as actuator:
        drawn["snap"] = snap.figure(*snap.steps(actuator))
        with progress.stage("DC responses without prestress (Fig. 2)"):
            drawn["dc_without_prestress"] = dc_responses(actuator, 0.0, table)
        with progress.stage("DC responses with prestress (Fig. 3)"):
            drawn["dc_with_prestress"] = dc_responses(actuator, 0.5, table)
        with progress.stage("pull-in voltages by bisection on the motion (Table 1, Figs. 6, 7)"):
            drawn["pull_in"] = pull_in_transitions(actuator, table)
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
