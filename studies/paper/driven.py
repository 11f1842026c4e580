"""Time histories, phase portraits and Poincaré sections under the harmonic drive: Figs. 9 to 12 and B.1 to B.4."""

from __future__ import annotations

import math
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import cKDTree

import figure_style as style
from comparison import Row
from dielectric_actuator import Actuator
from paper.entries import Claim, Entry, Grid, long_format
from paper.scenes import DETUNING, EXTREME, NEAR_RESONANT, PHI_AC, DrivenRun, shown_run
from paper.workers import Workers

TOLERANCE = 1e-12
SPANS = {"harmonic": 1500.0, "subharmonic": 3000.0, "superharmonic": 4000.0, NEAR_RESONANT: 1500.0}
"""Shown times: long enough for the slow modulation."""
SAMPLING = 0.25
OUTPUTS = ("lambda3", "lambda3_dot")
CURVE = 1.15
"""Correlation dimension up to which a section counts as a curve."""

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
    """`history` from rest, and `section`, the state once a forcing period."""

    run: DrivenRun
    history: np.ndarray
    section: np.ndarray


def follow(actuator: Actuator, item: tuple[DrivenRun, float, int]) -> Motion:
    """A run over a time, and its Poincaré section of so many points at kπ/ω, one communication step each."""
    run, span, points = item
    history = actuator.run(
        run.scene(), stop_time=span, communication_step=SAMPLING, outputs=OUTPUTS, tolerance=TOLERANCE
    )
    section = actuator.run(
        run.scene(),
        stop_time=points * run.forcing_period,
        communication_step=run.forcing_period,
        outputs=OUTPUTS,
        tolerance=TOLERANCE,
    )
    return Motion(run, history, section)


def dimension(section: np.ndarray) -> float:
    """Correlation dimension of a section: 1 on a closed curve, more where the points scatter.

    Slope of the number of pairs over their distance in (ln λ₃, d ln λ₃/dt), between 0.02 and 0.2 standard deviations.
    The 24 sections of 3000 points give 0.90 to 1.04, the motions of `chaos.CHAOTIC` 1.2 to 2.
    """
    points = np.column_stack([np.log(section["lambda3"]), section["lambda3_dot"] / section["lambda3"]])
    points = (points - points.mean(axis=0)) / points.std(axis=0)
    distances = np.geomspace(0.02, 0.2, 8)
    pairs = cKDTree(points).count_neighbors(cKDTree(points), distances) - len(points)
    return float(np.polyfit(np.log(distances), np.log(pairs), 1)[0])


def figures(
    workers: Workers, points: int, checked: dict[DrivenRun, list[Row]], longest: float = math.inf
) -> list[Entry]:
    """The eight figures. `checked` holds λ of these runs by the independent integrator beside the FMU's; no time
    history is longer than `longest`."""
    keys = [(regime, S, parameter) for regime, S in FIGURES for parameter in EXTREME]
    motions = workers.map(
        follow, [(shown_run(p, regime, S), min(SPANS[regime], longest), points) for regime, S, p in keys]
    )
    by_key = dict(zip(keys, motions))
    return [
        _draw(number, regime, S, {p: by_key[regime, S, p] for p in EXTREME}, checked)
        for (regime, S), number in FIGURES.items()
    ]


def _draw(number: str, regime: str, prestress: float, motions: dict[str, Motion], checked: dict) -> Entry:
    span = next(iter(motions.values())).history["time"][-1]
    figure, rows = plt.subplots(3, 2, figsize=(11.5, 10.5), width_ratios=(1.55, 1))
    pieces = []
    for letter, (parameter, motion), (history, portrait) in zip("abc", motions.items(), rows):
        history.plot(motion.history["time"], motion.history["lambda3"], color=style.COLOURS[0], linewidth=0.5)
        style.label(history, "time", "lambda3")
        history.set_xlim(0, span)
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
        f"Time histories over [0, {span:g}] with the phase portraits of that time behind the sections; the paper's "
        "windows and numbers of points are not in its text.",
        "Sections are taken once a forcing period, which is π/ω̄ since the voltage enters as φ̄².",
    ]
    if regime == NEAR_RESONANT:
        remarks.append(
            f"The paper does not give the frequencies; here they are {DETUNING:g} of the harmonic resonances printed "
            "in Tables 2 to 4."
        )
    dimensions = [dimension(motion.section[1:]) for motion in motions.values()]
    cells = [
        [style.TEXT_SYMBOLS[parameter] + f" = {EXTREME[parameter]:g}", f"{motion.run.omega:g}", f"{found:.3f}"]
        for (parameter, motion), found in zip(motions.items(), dimensions)
    ]
    return Entry(
        "figure_" + number.replace(".", "_").zfill(2),
        f"Fig. {number}: {regime} drive, {'with' if prestress else 'without'} prestress",
        figure,
        long_format(pieces, ("time", *OUTPUTS)),
        rows=[row for run in runs for row in checked[run]],
        grids=[Grid("Correlation dimension of the sections (1: a curve)", ["", "ω", "dimension"], cells)],
        claims=[_claim(regime, prestress, max(dimensions))],
        remarks=remarks,
    )


def _claim(regime: str, prestress: float, dimension: float) -> Claim:
    """What the paper says of a regime (Sections 3.2 and 4), decided by whether the sections are curves."""
    curves = dimension < CURVE
    where = f"({style.TEXT_SYMBOLS['S']} = {prestress:g})"
    found = (
        f"All three sections are closed curves (correlation dimension at most {dimension:.2f}): quasi-periodic."
        if curves
        else f"The points fill more than a curve (correlation dimension up to {dimension:.2f})."
    )
    if regime in ("subharmonic", NEAR_RESONANT):
        beating = "beating, " if regime == NEAR_RESONANT else ""
        return Claim(f"{regime.capitalize()} drive: {beating}quasi-periodic on closed curves {where}.", curves, found)
    shape = "scattered points" if regime == "harmonic" else "points on no closed curve"
    loosely = (
        " At the tolerance of a default solver these runs leave their curves (see there)." if prestress == 0 else ""
    )
    return Claim(
        f"{regime.capitalize()} drive: bounded but aperiodic, {shape} {where}.",
        None if curves else True,
        f"Bounded, but not aperiodic. {found}{loosely}",
    )
