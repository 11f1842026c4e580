"""Dynamic pull-in: Table 1 and Figs. 4 and 5, with the fold and the surface elasticity where it ends."""

from __future__ import annotations

import math

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import figure_style as style
import references
from comparison import Row
from dielectric_actuator import Actuator
from paper import equation
from paper.entries import Claim, Entry, draw_table, long_format
from paper.thickness_range import ranges
from references import SurfaceEffects

IDEAL = {"gamma_s": 0.0, "tau_s": 0.0, "E_s": 0.0}
VALUES = {
    "gamma_s": (0.0, 0.025, 0.05, 0.075, 0.1),
    "tau_s": (0.0, 0.025, 0.05, 0.075, 0.1),
    "E_s": (0.0, 0.007, 0.015, 0.021, 0.029, 0.04),
}
"""Table 1 varies one parameter from zero; the last E_s, beyond E*, is ours."""
TOLERANCE = 1e-12


def alone(parameter: str, value: float) -> SurfaceEffects:
    """One surface parameter, no prestress."""
    return SurfaceEffects(**{**IDEAL, parameter: value}, S=0.0)


def own_threshold(actuator: Actuator, case: SurfaceEffects) -> references.PullIn:
    """What the FMU says of a case, in its variables phi_pull_in and lambda3_pull_in."""
    actuator.start(case.scene())
    return references.PullIn(*actuator.get("phi_pull_in", "lambda3_pull_in"))


def table_1(actuator: Actuator) -> Entry:
    """Table 1 with the exact values and the FMU's beside the printed ones."""
    stretch, voltage = style.SYMBOLS["lambda3_pull_in"], style.SYMBOLS["phi_pull_in"]
    header = ["", f"{stretch} paper", "exact", "FMU", "paper $-$ exact", f"{voltage} paper", "exact", "FMU"]
    header.append("paper $-$ exact")
    cells: list[list[str]] = []
    rows: list[Row] = []
    marked: set[tuple[int, int]] = set()
    columns: dict[str, list] = {name: [] for name in ("gamma_s", "tau_s", "E_s")}
    for threshold in references.table_1():
        exact, found = threshold.dynamic, own_threshold(actuator, threshold.case)
        varied = next((p for p in VALUES if getattr(threshold.case, p)), None)
        name = f"{varied} = {getattr(threshold.case, varied):g}" if varied else "ideal"
        pair = (
            Row(f"{name}: lambda3^C", threshold.printed_lambda3, exact.lambda3, found.lambda3),
            Row(f"{name}: phi^C", threshold.printed_phi, exact.phi, found.phi),
        )
        line = [style.setting(**{varied: getattr(threshold.case, varied)}) if varied else name]
        for row in pair:
            if row.misprinted:
                marked.add((len(cells), len(line)))
            printed = row.printed or ""
            line += [printed, f"{row.exact:.10f}", f"{row.measured:.10f}"]
            line.append(f"{float(printed) - row.exact:+.1e}")
        cells.append(line)
        rows += pair
        for parameter in IDEAL:
            columns[parameter].append(getattr(threshold.case, parameter))
        for label, row in zip(("lambda3", "phi"), pair):
            for kind, value in (("paper", row.printed), ("exact", row.exact), ("fmu", row.measured)):
                columns.setdefault(f"{label}_{kind}", []).append(value)
    wrong = [row for row in rows if row.misprinted]
    spurious, _ = equation.extrema(alone("E_s", 0.007))[1]
    # the ideal row stands three times in the paper's table
    entries = len(rows) + 4
    return Entry(
        "table_1",
        "Table 1: dynamic pull-in without prestress",
        draw_table(
            header,
            cells,
            title="Table 1: thickness stretch and voltage at dynamic pull-in",
            marked=marked,
            meaning="not the exact value rounded",
        ),
        columns,
        rows=rows,
        claims=[
            Claim(
                "Table 1: pull-in stretches and voltages, to four digits.",
                None if wrong else True,
                f"{entries - len(wrong)} of {entries} entries are the exact values rounded. Not so: "
                + "; ".join(
                    f"{style.in_symbols(row.quantity)} is printed {row.printed}, exact {row.exact:.7f}" for row in wrong
                )
                + ".",
            )
        ],
        remarks=[
            "The exact values are multiprecision roots of Eqs. 19 and 20. These equations have further roots that "
            "are no thresholds: λ = 1 always, and for 0 < Ēₛ < E* the local minimum of the stagnation curve (Ēₛ = "
            f"0.007: φ̄ = {spurious.phi:.5f}, λ₃ = {spurious.lambda3:.5f}). A root finder started there would report "
            "them.",
        ],
    )


def figure_4(actuator: Actuator) -> Entry:
    """Stagnation curves: exact line, the FMU's overshoot at single voltages, the fold."""
    figure, panels = plt.subplots(1, 3, figsize=(14, 5), sharey=True)
    pieces, rows = [], []
    for letter, axes, (parameter, values) in zip("abc", panels, VALUES.items()):
        overshoots: list[Row] = []
        for index, value in enumerate(values):
            case, look = alone(parameter, value), {"color": style.COLOURS[index]}
            curve = _branches(case)
            pieces.append(({"varied": parameter, "value": value}, curve))
            for branch, line in (("stable", "-"), ("unstable", (0, (4, 2))), ("beyond", "-")):
                part = np.where(curve["branch"] == branch, curve["phi"], np.nan)
                axes.plot(curve["lambda3"], part, linestyle=line, **look)
            axes.plot([], [], label=style.setting(**{parameter: value}), **look)
            fold = own_threshold(actuator, case)
            if fold.exists:
                axes.plot(fold.lambda3, fold.phi, "x", color=style.BLACK, markersize=8, zorder=5)
            for phi, row in _overshoots(actuator, case, fold, f"{parameter} = {value:g}"):
                axes.plot(row.measured, phi, ".", markersize=6, **look)
                overshoots.append(row)
        rows.append(max(overshoots, key=lambda row: abs(row.difference)))
        axes.set_title(f"({letter})  {style.NAMES[parameter]}", loc="left")
        axes.set_xlabel(r"thickness stretch at the overshoot  $\lambda_{3m}$")
        # without 0, which would stand against the 1 of the panel before
        axes.set(xlim=(0, 1.02), ylim=(0, 0.95), xticks=(0.2, 0.4, 0.6, 0.8, 1.0))
        axes.plot([], [], "x", color=style.BLACK, label="fold, dynamic pull-in")
        axes.plot([], [], ".", color=style.GREY, label="motion of the FMU")
        axes.plot([], [], "--", color=style.GREY, label="unstable")
        axes.legend(loc="lower center", fontsize=9)
    panels[0].set_ylabel(f"voltage  {style.SYMBOLS['phi']}")
    figure.suptitle(r"Stagnation curves (Eq. 19), $\bar{S}$ = 0, the other two surface parameters 0")
    return Entry(
        "figure_04",
        "Fig. 4: voltage over thickness stretch at the overshoot",
        figure,
        long_format(pieces, ("lambda3", "phi", "branch")),
        rows=rows,
        remarks=[
            "Lines are Eq. 19, dots the smallest λ₃ that the FMU reached in runs at single voltages; the table gives "
            "the worst of each panel.",
            "The text does not give the values of the curves; those of Table 1 are drawn, and Ēₛ = 0.04 beyond E*.",
            "With 0 < Ēₛ < E* the curve rises a second time (solid, left): the larger orbit on which the motion "
            "continues past pull-in. Above E* it rises throughout.",
        ],
    )


def _branches(case: SurfaceEffects) -> np.ndarray:
    """The stagnation curve by growing stretch: stable to the fold, unstable to the minimum, stable beyond."""
    stretches = np.sort(np.concatenate([np.linspace(1.0005, 4.5, 700), np.geomspace(1.00002, 1.05, 60)]))
    voltages = np.sqrt(np.maximum(equation.Cases.of([case]).stagnation(stretches), 0))
    turns = [pull_in.stretch for pull_in, _ in equation.extrema(case)][:2]
    curve = np.empty(len(stretches), dtype=[("lambda3", float), ("phi", float), ("branch", "U8")])
    curve["lambda3"], curve["phi"] = stretches**-2, voltages
    curve["branch"] = np.array(["stable", "unstable", "beyond"])[np.searchsorted(turns, stretches)]
    return curve


def _overshoots(
    actuator: Actuator, case: SurfaceEffects, fold: references.PullIn, name: str
) -> list[tuple[float, Row]]:
    """Voltage and smallest λ₃ of runs from rest, against the root of Eq. 19 that the motion meets first."""
    one = equation.Cases.of([case])
    lowest_voltage = math.sqrt(2 * (case.gamma_s + case.tau_s))  # below it the actuator contracts
    highest_voltage, farthest = (fold.phi, fold.stretch) if fold.exists else (0.85, 4.0)
    found = []
    for share in (0.3, 0.6, 0.85, 0.97):
        phi = round(lowest_voltage + share * (highest_voltage - lowest_voltage), 4)
        ((lowest, _),) = ranges(actuator, case.scene(phi=phi), (150.0,), TOLERANCE)
        stretch = brentq(_excess, 1 + 1e-9, farthest, args=(one, phi), xtol=1e-15)
        found.append((phi, Row(f"{name}: lambda3m at phi = {phi:g}", None, stretch**-2, lowest)))
    return found


def _excess(stretch: float, case: equation.Cases, phi: float) -> float:
    """φ² of the stagnation curve over that of the run."""
    return float(case.stagnation(stretch)[0]) - phi**2


def figure_5(actuator: Actuator, points: int) -> Entry:
    """Thresholds over each surface parameter, up to E*."""
    vanishing = next(c for c in references.cusps() if c.kind == "dynamic" and c.S == 0 and c.gamma_s_minus_tau_s == 0)
    figure, (voltage, stretch) = plt.subplots(1, 2, figsize=(12, 4.6))
    pieces, rows = [], []
    for index, parameter in enumerate(VALUES):
        end = vanishing.E_s if parameter == "E_s" else 0.1
        # the fold's stretch runs into E* like a root: points crowd towards the end
        values = end * (1 - np.linspace(1, 0, points, endpoint=False) ** 2)
        found = [own_threshold(actuator, alone(parameter, value)) for value in values]
        some = range(0, points, max(1, points // 20))
        for quantity in ("phi", "lambda3"):
            checked = [
                Row(
                    f"{quantity}^C, worst over {parameter}: at {values[k]:.5g}",
                    None,
                    getattr(equation.threshold(alone(parameter, values[k])), quantity),
                    getattr(found[k], quantity),
                )
                for k in some
            ]
            rows.append(max(checked, key=lambda row: abs(row.difference)))
        curve = np.array(
            [(v, pull_in.phi, pull_in.lambda3) for v, pull_in in zip(values, found)],
            dtype=[("value", float), ("phi_pull_in", float), ("lambda3_pull_in", float)],
        )
        pieces.append(({"varied": parameter}, curve))
        for axes, field, printed in (
            (voltage, "phi_pull_in", "printed_phi"),
            (stretch, "lambda3_pull_in", "printed_lambda3"),
        ):
            axes.plot(values, curve[field], label=style.SYMBOLS[parameter], **style.curve(index))
            for threshold in references.table_1():
                if threshold.case == alone(parameter, getattr(threshold.case, parameter)):
                    axes.plot(getattr(threshold.case, parameter), float(getattr(threshold, printed)), **style.EXACT)
    last = pieces[-1][1][-1]
    star = vanishing_elasticity(actuator)
    rows.append(Row("E* from the FMU, by bisection", "0.029", vanishing.E_s, star))
    rows.append(Row("lambda3 there", None, vanishing.lambda3, own_threshold(actuator, alone("E_s", star)).lambda3))
    for axes, field, what in (
        (voltage, "phi_pull_in", "voltage"),
        (stretch, "lambda3_pull_in", "thickness stretch"),
    ):
        axes.plot(star, last[field], "*", color=style.COLOURS[2], markersize=13, label=f"$E^*$ = {star:.8f}")
        axes.set_xlabel("surface parameter")
        axes.set_ylabel(f"critical {what}  {style.SYMBOLS[field]}")
        axes.plot([], [], label="Table 1, as printed", **style.EXACT)
        axes.legend()
    voltage.set_title("(a)", loc="left")
    stretch.set_title("(b)", loc="left")
    figure.suptitle("Dynamic pull-in over each surface parameter, the others 0, no prestress")
    return Entry(
        "figure_05",
        "Fig. 5: thresholds over each surface parameter",
        figure,
        long_format(pieces, ("value", "phi_pull_in", "lambda3_pull_in")),
        rows=rows,
        claims=[
            Claim(
                "Pull-in is eliminated for Ēₛ > 0.029.",
                None,
                f"It vanishes at E* = {vanishing.E_s:.10f}, which the paper rounds down; Table 1 itself has a "
                "threshold at 0.029. E* depends on γ̄ₛ − τ̄ₛ and on S̄.",
            )
        ],
        remarks=[
            "FMU: its variables phi_pull_in and lambda3_pull_in. Exact: roots of Eqs. 19 and 20 found from the "
            "equations as printed, without the FMU; E* in multiprecision. The stretch at E* hangs on E* like a root, "
            "so that the last digit of E* shows in its seventh.",
        ],
    )


def vanishing_elasticity(actuator: Actuator) -> float:
    """E*, to 1e-13: the largest E_s for which the FMU reports a dynamic threshold (no other surface effect)."""
    below, above = 0.02, 0.04
    while above - below > 1e-13:
        middle = (below + above) / 2
        if own_threshold(actuator, alone("E_s", middle)).exists:
            below = middle
        else:
            above = middle
    return below
