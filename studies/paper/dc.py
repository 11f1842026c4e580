"""Motion under a constant voltage: Figs. 2, 3, 6, 7 and A.1."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np

import dc_motion
import figure_style as style
import figures
import references
import turning_points
from comparison import Comparison, Row
from dielectric_actuator import Actuator
from paper.entries import Claim, Entry, long_format
from paper.equation import time_to


def step_responses(actuator: Actuator) -> list[Entry]:
    """Figs. 2 and 3: the response to φ = 0.6 without and with prestress."""
    entries = []
    for number, prestress in ((2, 0.0), (3, 0.5)):
        table = Comparison()
        families = dc_motion.oscillations(actuator, prestress, table)
        title = f"Response to a DC voltage step, {style.setting(phi=0.6, S=prestress)};\n{dc_motion.held(prestress)}"
        pieces = [
            ({"varied": parameter, "value": oscillation.value}, oscillation.response)
            for parameter, oscillations in families.items()
            for oscillation in oscillations
        ]
        entries.append(
            Entry(
                f"figure_{number:02}",
                f"Fig. {number}: response to a DC voltage step, {'with' if prestress else 'without'} prestress",
                figures.dc_responses(families, title=title),
                long_format(pieces, ("time", "lambda3", "lambda3_dot")),
                rows=table.rows,
                claims=[_deformation(families, prestress), _frequency(families, prestress)],
            )
        )
    return entries


def _deformation(families: dict[str, list[figures.Oscillation]], prestress: float) -> Claim:
    reached = {p: [1 - oscillation.exact_lambda3 for oscillation in family] for p, family in families.items()}
    return Claim(
        f"Deformation under a voltage step falls with each surface parameter ({style.TEXT_SYMBOLS['S']} = "
        f"{prestress:g}).",
        all(np.all(np.diff(depths) < 0) for depths in reached.values()),
        f"1 − λ₃ at the turn: {_list(reached)}.",
    )


def _frequency(families: dict[str, list[figures.Oscillation]], prestress: float) -> Claim:
    periods = {p: [oscillation.exact_period for oscillation in family] for p, family in families.items()}
    return Claim(
        f"Frequency under a voltage step rises with surface tension and elasticity ({style.TEXT_SYMBOLS['S']} = "
        f"{prestress:g}).",
        all(np.all(np.diff(periods[parameter]) < 0) for parameter in ("tau_s", "E_s")),
        f"Periods: {_list(periods)}.",
    )


def _list(families: dict[str, list[float]]) -> str:
    return "; ".join(f"{style.TEXT_SYMBOLS[p]} {', '.join(f'{v:.4g}' for v in vs)}" for p, vs in families.items())


def pull_in(actuator: Actuator) -> list[Entry]:
    """Figs. 6 and 7: the motion just below and just above each threshold of Table 1."""
    table = Comparison()
    families = dc_motion.pull_in(actuator, table)
    distance = dc_motion.PULL_IN_DISTANCE
    pieces = [
        ({"varied": parameter, "value": transition.value, "side": side}, response)
        for parameter, transitions in families.items()
        for transition in transitions
        for side, response in (("below", transition.below), ("above", transition.above))
    ]
    columns = long_format(pieces, ("time", "lambda3", "lambda3_dot"))
    drawings = (
        (
            "figure_06",
            "Fig. 6: time histories at both sides of dynamic pull-in",
            figures.transition_histories,
            figures.COLLAPSE,
        ),
        (
            "figure_07",
            "Fig. 7: phase portraits at both sides of dynamic pull-in",
            figures.transition_portraits,
            figures.SADDLE,
        ),
    )
    entries = []
    for key, title, draw, mark in drawings:
        figure, panels = plt.subplots(3, 1, figsize=(8.6, 10.5))
        for letter, axes, (parameter, transitions) in zip("abc", panels, families.items()):
            draw(axes, transitions)
            axes.set_title(f"({letter})  {style.NAMES[parameter]}", loc="left")
            handles = [*figures.transition_handles(parameter, transitions, distance), mark]
            axes.legend(handles=handles, **style.BESIDE)
        figure.suptitle(
            f"Just below and just above the dynamic pull-in voltage,\n{style.setting(S=0)}; the others held at 0"
        )
        entries.append(Entry(key, title, figure, columns))
    entries[0].rows = table.rows
    entries[0].remarks = [
        f"The paper does not print the two voltages of each run; here they are φ̄ᶜ ∓ {distance:g}, one unit of the "
        "last digit of Table 1.",
        "The thresholds in the table are found from the motion alone, by bisection on whether the first rise passes "
        "the saddle, and agree with Eqs. 19 and 20: the energy method is exact for this conservative actuator.",
    ]
    slow = next(t for t in families["E_s"] if t.value == 0.007).above
    entries[0].claims = [
        Claim(
            "The energy method gives the pull-in voltage that direct integration shows.",
            max(abs(row.difference) for row in table.rows) < 1e-9,
            "Bisection on the motion agrees with Eqs. 19 and 20 to "
            f"{max(abs(row.difference) for row in table.rows):.0e}.",
        ),
        Claim(
            "Past the threshold the motion is aperiodic and its phase trajectory open.",
            None if slow["lambda3"][-1] > 0.2 else True,
            "Holds without surface elasticity: the motion escapes in finite time. With it the motion goes on along a "
            f"larger closed orbit and is periodic again (Ēₛ = 0.007: λ₃ falls to {slow['lambda3'].min():.4f} and "
            "comes back).",
        ),
    ]
    entries[1].claims = [
        Claim(
            "Dynamic pull-in is a saddle-node bifurcation.",
            False,
            "At the threshold the orbit from rest is homoclinic to a saddle point (crosses), which exists on both "
            "sides of the threshold. The saddle-node, where two equilibria merge, is the static pull-in at a higher "
            "voltage. The growth of the period tells the two apart (see the period over voltage).",
        )
    ]
    return entries


def verification(actuator: Actuator) -> Entry:
    """Fig. A.1: the ideal actuator of Joglekar (2014), against quadrature of the energy equation."""
    orbit = references.appendix_a_orbit()
    response = actuator.run(
        orbit.scene(),
        stop_time=3 * orbit.period,
        communication_step=0.05,
        outputs=dc_motion.MOTION,
        tolerance=dc_motion.TOLERANCE,
    )
    period, stretch = turning_points.period_and_overshoot(response)
    stretches = 1 + (orbit.turning_lambda - 1) * np.array([0.05, 0.2, 0.4, 0.6, 0.8, 0.95])
    times = [time_to(orbit.case, orbit.phi, value, orbit.c) for value in stretches]
    rows = [
        Row("period T", None, orbit.period, period),
        Row("lambda3 at the turn", None, orbit.turning_lambda3, stretch**-2),
    ]
    for value, instant in zip(stretches, times):
        actuator.start(orbit.scene(), tolerance=dc_motion.TOLERANCE)
        actuator.advance(instant)
        rows.append(Row(f"lambda3 at t = {instant:.9f}", None, value**-2, actuator.get("lambda3")))

    figure, axes = plt.subplots(figsize=(9, 4.2))
    axes.plot(response["time"], response["lambda3"], label="FMU", **style.curve(0))
    exact_times = np.concatenate([k * orbit.period + sign * np.array(times) for k in range(4) for sign in (-1, 1)])
    inside = (exact_times >= 0) & (exact_times <= response["time"][-1])
    exact_stretches = np.tile(stretches**-2, 8)
    axes.plot(exact_times[inside], exact_stretches[inside], label="exact (quadrature)", **style.EXACT)
    style.label(axes, "time", "lambda3")
    axes.set_xlim(0, response["time"][-1])
    axes.legend(**style.BESIDE)
    axes.set_title(f"Ideal actuator, c = {orbit.c:g}, {style.setting(phi=orbit.phi, S=0)}", loc="left")
    return Entry(
        "figure_A_1",
        "Fig. A.1: verification, the ideal actuator",
        figure,
        long_format([({}, response)], ("time", "lambda3", "lambda3_dot")),
        rows=rows,
        remarks=[
            "L = 10 mm and H = 2 mm give c = 25. µ, ρ and ε only scale time and voltage.",
            "The paper compares with a curve of Joglekar (2014), whose numbers it does not print; here the "
            "comparison is with the exact motion, t(λ) by quadrature of the energy equation (Eq. 19 with the kinetic "
            "energy). The appendix refers to Eq. 15 where Eq. 16 is meant.",
        ],
    )
