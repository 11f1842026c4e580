"""Time histories, phase portraits and Poincaré sections under the harmonic drive: Figs. 9 to 12 and B.1 to B.4."""

from __future__ import annotations

from dataclasses import dataclass

import figure_style as style
import matplotlib.pyplot as plt
import numpy as np
from actuator_fmu import ActuatorFmu
from comparison import Row

from paper.entries import Entry, long_format
from paper.scenes import DETUNING, EXTREME, NEAR_RESONANT, PHI_AC, DrivenRun, shown_run
from paper.workers import Workers

TOLERANCE = 1e-12
SPANS = {"harmonic": 1500.0, "subharmonic": 3000.0, "superharmonic": 4000.0, NEAR_RESONANT: 1500.0}
"""Shown times: long enough for the slow modulation."""
SAMPLING = 0.25
OUTPUTS = ("lambda3", "lambda3_dot")

FIGURES = {
    ("harmonic", 0.0): "9",
    ("subharmonic", 0.0): "10",
    ("superharmonic", 0.0): "11",
    (NEAR_RESONANT, 0.0): "12",
    ("harmonic", 0.5): "B.1",
    ("subharmonic", 0.5): "B.2",
    ("superharmonic", 0.5): "B.3",
    (NEAR_RESONANT, 0.5): "B.4",
}


@dataclass(frozen=True)
class Motion:
    """`history` over the time in `SPANS` and `section`, the state once a forcing period."""

    run: DrivenRun
    history: np.ndarray
    section: np.ndarray


def follow(actuator: ActuatorFmu, item: tuple[DrivenRun, int]) -> Motion:
    """A run and its Poincaré section of that many points at multiples of π/ω, one communication step each."""
    run, points = item
    history = actuator.run(
        run.scene(), stop_time=SPANS[run.regime], communication_step=SAMPLING, outputs=OUTPUTS, tolerance=TOLERANCE
    )
    section = actuator.run(
        run.scene(),
        stop_time=points * run.forcing_period,
        communication_step=run.forcing_period,
        outputs=OUTPUTS,
        tolerance=TOLERANCE,
    )
    return Motion(run, history, section)


def figures(workers: Workers, points: int, checked: dict[DrivenRun, list[Row]]) -> list[Entry]:
    """The eight figures. `checked` holds λ of these runs by the independent integrator beside the FMU's."""
    keys = [(regime, S, parameter) for regime, S in FIGURES for parameter in EXTREME]
    motions = workers.map(follow, [(shown_run(parameter, regime, S), points) for regime, S, parameter in keys])
    by_key = dict(zip(keys, motions))
    return [
        _draw(number, regime, S, {p: by_key[regime, S, p] for p in EXTREME}, checked)
        for (regime, S), number in FIGURES.items()
    ]


def _draw(number: str, regime: str, prestress: float, motions: dict[str, Motion], checked: dict) -> Entry:
    figure, rows = plt.subplots(3, 2, figsize=(11.5, 10.5), width_ratios=(1.55, 1))
    pieces = []
    for letter, (parameter, motion), (history, portrait) in zip("abc", motions.items(), rows):
        history.plot(motion.history["time"], motion.history["lambda3"], color=style.COLOURS[0], linewidth=0.5)
        style.label(history, "time", "lambda3")
        history.set_xlim(0, SPANS[regime])
        setting = style.setting(**{parameter: EXTREME[parameter], "omega_ac": round(motion.run.omega, 6)})
        history.set_title(f"({letter})  {setting}", loc="left")
        portrait.plot(motion.history["lambda3"], motion.history["lambda3_dot"], color="#b7cfe2", linewidth=0.4)
        portrait.plot(
            motion.section["lambda3"], motion.section["lambda3_dot"], ".", color=style.COLOURS[1], markersize=2.2
        )
        style.label(portrait, "lambda3", "lambda3_dot")
        portrait.set_title(rf"section at $k\,\pi/\bar{{\omega}}$, {len(motion.section) - 1} points", loc="left")
        for kind, response in (("history", motion.history), ("section", motion.section)):
            labels = {"varied": parameter, "omega": motion.run.omega, "kind": kind}
            pieces.append((labels, response))
    title = f"{regime[0].upper()}{regime[1:]} drive, {style.setting(phi_ac=PHI_AC, S=prestress)}"
    figure.suptitle(title)
    runs = [motion.run for motion in motions.values()]
    remarks = [
        f"Time histories over [0, {SPANS[regime]:g}] with the phase portraits of that time behind the sections; the paper's "
        "windows and numbers of points are not in its text.",
        "Sections are taken once a forcing period, which is π/ω̄ since the voltage enters as φ̄².",
    ]
    if regime == NEAR_RESONANT:
        remarks.append(
            f"The paper does not give the frequencies; here they are {DETUNING:g} of the harmonic resonances printed in "
            "Tables 2 to 4."
        )
    return Entry(
        "figure_" + number.replace(".", "_").zfill(2),
        f"Fig. {number}: {regime} drive, {'with' if prestress else 'without'} prestress",
        figure,
        long_format(pieces, ("time", *OUTPUTS)),
        rows=[row for run in runs for row in checked[run]],
        remarks=remarks + [_VERDICTS[regime]],
    )


_VERDICTS = {
    "harmonic": "The paper sees scattered points, hence aperiodic motion. The points lie on a smooth closed curve: the motion "
    "is quasi-periodic (evidence: see chaos indicators and the run at the tolerance of a default solver).",
    "subharmonic": "Closed invariant curves, as the paper says: quasi-periodic.",
    "superharmonic": "The paper sees structured sets that do not close, hence bounded aperiodic motion. The points lie on "
    "smooth closed curves: quasi-periodic (evidence: see chaos indicators).",
    NEAR_RESONANT: "Beating on a closed invariant curve, as the paper says: quasi-periodic.",
}
