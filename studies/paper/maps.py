"""Beyond the paper: pull-in over voltage and prestress, thresholds over the surface parameters, period at pull-in."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import figure_style as style
import references
import turning_points
from comparison import Row
from dielectric_actuator import Actuator
from paper import equation
from paper.entries import Claim, Entry, stack
from paper.workers import Workers
from references import SurfaceEffects

TOLERANCE = 1e-9
CMAP = "cividis"
"""The same to readers with and without colour blindness, and even in grey."""
NO_MAP = "#e9e4dc"
"""Where a map has no value."""

PULL_IN_SPAN = 400.0
"""A dozen natural periods; only within about 1e-6 of a threshold is the first turn later."""
IDEAL = SurfaceEffects(0.0, 0.0, 0.0, 0.0)
PULL_IN_CASES = (IDEAL, SurfaceEffects(0.0, 0.0, 0.007, 0.0))


def pull_in_row(actuator: Actuator, item: tuple[SurfaceEffects, float, np.ndarray]) -> np.ndarray:
    """For one prestress and each voltage: smallest λ₃ reached, instant of collapse (+inf: none)."""
    case, prestress, voltages = item
    found = np.empty((len(voltages), 2))
    for row, phi in zip(found, voltages):
        actuator.start({**case.scene(phi=phi), "S": prestress, "record_extremes": True}, tolerance=TOLERANCE)
        actuator.advance(PULL_IN_SPAN)
        row[:] = actuator.get("lambda3_lowest", "pull_in_time")
    return found


def pull_in_map(workers: Workers, cells: int) -> Entry:
    """Smallest λ₃ from rest over voltage and prestress, with the thresholds that the FMU reports."""
    voltages, prestresses = np.linspace(0.0, 1.0, cells), np.linspace(0.0, 1.0, cells * 3 // 4)
    figure, panels = plt.subplots(1, 2, figsize=(13, 5.2), sharey=True)
    columns: dict[str, list] = {}
    wrong = total = 0
    maps = [np.array(workers.map(pull_in_row, [(case, S, voltages) for S in prestresses])) for case in PULL_IN_CASES]
    reached = np.concatenate([found[~np.isfinite(found[..., 1]), 0] for found in maps])
    norm = LogNorm(reached.min(), reached.max())
    for letter, axes, case, found in zip("ab", panels, PULL_IN_CASES, maps):
        lowest, collapse = found[..., 0], found[..., 1]
        collapsed = np.isfinite(collapse)
        shown = axes.pcolormesh(
            voltages,
            prestresses,
            np.where(collapsed, np.nan, lowest),
            norm=norm,
            cmap=CMAP,
            rasterized=True,
        )
        axes.set_facecolor(NO_MAP)
        curves: dict[str, list[float]] = {name: [] for name in ("phi_pull_in", "phi_pull_in_static")}
        for S in prestresses:
            workers.actuator.start({**case.scene(), "S": S})
            for name, value in zip(curves, workers.actuator.get(*curves)):
                curves[name].append(value)
        dynamic = np.array(curves["phi_pull_in"])[:, np.newaxis]
        passed = voltages > dynamic
        if case.E_s == 0:
            wrong, total = wrong + int((passed != collapsed).sum()), total + passed.size
        axes.plot(
            curves["phi_pull_in"], prestresses, color=style.COLOURS[1], linewidth=2, label=style.SYMBOLS["phi_pull_in"]
        )
        axes.plot(
            curves["phi_pull_in_static"], prestresses, "--", color=style.BLACK, linewidth=1.3, label="static pull-in"
        )
        axes.grid(False)
        axes.set_title(f"({letter})  {style.setting(E_s=case.E_s, gamma_s=0, tau_s=0)}", loc="left")
        axes.set(xlabel=f"voltage  {style.SYMBOLS['phi']}", xlim=(0, 1))
        axes.plot([], [], "s", color=NO_MAP, markeredgecolor=style.GREY, markersize=9, label="collapse")
        mesh_S, mesh_phi = np.meshgrid(prestresses, voltages, indexing="ij")
        columns = stack(
            columns,
            {
                "E_s": [case.E_s] * lowest.size,
                "S": mesh_S.ravel(),
                "phi": mesh_phi.ravel(),
                "lambda3_lowest": lowest.ravel(),
                "pull_in_time": collapse.ravel(),
            },
        )
    panels[0].set_ylabel(f"prestress  {style.SYMBOLS['S']}")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    bar = figure.colorbar(shown, ax=panels, label=r"smallest $\lambda_3$ reached")
    bar.ax.yaxis.set_major_formatter("{x:g}")
    figure.suptitle(rf"From rest under a constant voltage, {style.SYMBOLS['time']} $\leq$ {PULL_IN_SPAN:g}")
    return Entry(
        "map_pull_in",
        "Pull-in over voltage and prestress",
        figure,
        columns,
        remarks=[
            f"{2 * voltages.size * prestresses.size} runs, each of one communication step with recorded extremes. "
            "Without surface elasticity (a) the motion collapses in the very cells beyond the FMU's phi_pull_in: "
            f"{total - wrong} of {total} agree"
            + (
                "."
                if wrong == 0
                else f"; the other {wrong} lie next to the threshold, where the escape takes longer than the run."
            ),
            "With surface elasticity (b) nothing collapses where the larger orbit stays within lambda_max = 10: "
            "past the threshold λ₃ jumps to a few hundredths and the motion stays periodic.",
        ],
    )


def threshold_row(actuator: Actuator, item: tuple[dict[str, float], str, np.ndarray]) -> np.ndarray:
    """phi_pull_in for each value of one surface parameter, the others held."""
    held, parameter, values = item
    found = np.empty(len(values))
    for index, value in enumerate(values):
        actuator.start({**held, parameter: value})
        found[index] = actuator.get("phi_pull_in")
    return found


def threshold_map(workers: Workers, cells: int) -> Entry:
    """φᶜ over each pair of surface parameters, with the exact limits E*."""
    figure, panels = plt.subplots(1, 3, figsize=(15.5, 4.8))
    columns: dict[str, list] = {}
    meshes = []
    reach = {"gamma_s": 0.1, "tau_s": 0.1, "E_s": 0.06}
    for letter, axes, (across, up) in zip("abc", panels, (("gamma_s", "tau_s"), ("gamma_s", "E_s"), ("tau_s", "E_s"))):
        values, heights = np.linspace(0, reach[across], cells), np.linspace(0, reach[up], cells)
        found = np.array(workers.map(threshold_row, [({up: height}, across, values) for height in heights]))
        shown = axes.pcolormesh(
            values,
            heights,
            np.where(np.isfinite(found), found, np.nan),
            cmap=CMAP,
            rasterized=True,
        )
        meshes.append(shown)
        lines = axes.contour(
            values,
            heights,
            np.where(np.isfinite(found), found, np.nan),
            np.arange(0.64, 0.92, 0.02),
            colors="white",
            linewidths=0.7,
        )
        axes.clabel(lines, fontsize=8, fmt="%.2f")
        axes.set_facecolor(NO_MAP)
        axes.grid(False)
        if up == "E_s":
            sign = 1 if across == "gamma_s" else -1
            for cusp in references.cusps():
                place = sign * cusp.gamma_s_minus_tau_s
                if cusp.kind == "dynamic" and cusp.S == 0 and 0 <= place <= reach[across]:
                    axes.plot(place, cusp.E_s, clip_on=False, **style.EXACT)
            axes.text(0.5, 0.93, "no pull-in", transform=axes.transAxes, ha="center", va="top", fontsize=10)
        other = next(name for name in reach if name not in (across, up))
        axes.set_title(f"({letter})  {style.setting(**{other: 0})}", loc="left")
        axes.set(
            xlabel=f"{style.NAMES[across]}  {style.SYMBOLS[across]}", ylabel=f"{style.NAMES[up]}  {style.SYMBOLS[up]}"
        )
        mesh_up, mesh_across = np.meshgrid(heights, values, indexing="ij")
        fields = {across: mesh_across.ravel(), up: mesh_up.ravel(), other: np.zeros(found.size)}
        columns = stack(columns, {**{name: fields[name] for name in reach}, "phi_pull_in": found.ravel()})
    limits = [mesh.get_clim() for mesh in meshes]
    for mesh in meshes:
        mesh.set_clim(min(low for low, _ in limits), max(high for _, high in limits))
    figure.colorbar(shown, ax=panels, label=style.SYMBOLS["phi_pull_in"])
    figure.suptitle(r"Dynamic pull-in voltage over the surface parameters, $\bar{S}$ = 0 (dots: exact $E^*$)")
    return Entry(
        "map_thresholds",
        "Pull-in voltage over surface energy, surface tension and surface elasticity",
        figure,
        columns,
        rows=_redundancy(workers.actuator),
        remarks=[
            f"{3 * cells * cells} thresholds, from the variable phi_pull_in.",
            "γ̄ₛ and τ̄ₛ act through their difference but for a shift of the voltage: (γ̄ₛ, τ̄ₛ, φ̄²) moves exactly "
            "like (γ̄ₛ − τ̄ₛ, 0, φ̄² − 4τ̄ₛ). Hence one map over γ̄ₛ − τ̄ₛ and Ēₛ holds them all, and E* depends on "
            "γ̄ₛ − τ̄ₛ alone. The table checks it.",
        ],
    )


def _redundancy(actuator: Actuator) -> list[Row]:
    rows = []
    for gamma_s, tau_s, E_s in ((0.1, 0.04, 0.0), (0.09, 0.02, 0.02), (0.08, 0.08, 0.025)):
        found = []
        for scene in ({"gamma_s": gamma_s, "tau_s": tau_s, "E_s": E_s}, {"gamma_s": gamma_s - tau_s, "E_s": E_s}):
            actuator.start(scene)
            found.append(actuator.get("phi_pull_in"))
        name = f"phi^C, gamma_s = {gamma_s:g}, tau_s = {tau_s:g}, E_s = {E_s:g}"
        rows.append(Row(name, None, (found[1] ** 2 + 4 * tau_s) ** 0.5, found[0]))
    return rows


PERIOD_CASES = (
    IDEAL,
    SurfaceEffects(0.1, 0.0, 0.0, 0.0),
    SurfaceEffects(0.0, 0.1, 0.0, 0.0),
    SurfaceEffects(0.0, 0.0, 0.015, 0.0),
)


def period(actuator: Actuator, item: tuple[SurfaceEffects, float]) -> float:
    """Period of the motion from rest at one voltage, from its first half: the motion is symmetric in time."""
    case, phi = item
    response = actuator.run(
        case.scene(phi=phi), stop_time=400.0, communication_step=0.4, outputs=turning_points.OUTPUTS, tolerance=1e-13
    )
    times, _ = turning_points.turning_points(response)
    return 2 * float(times[0])


def period_curve(workers: Workers, points: int) -> Entry:
    """Period over voltage, and its growth like −ln|φᶜ − φ| at pull-in with the rate of the saddle."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(12.5, 4.8))
    rows = []
    columns: dict[str, list[float]] = {name: [] for name in ("gamma_s", "tau_s", "E_s", "phi", "distance", "period")}
    for index, case in enumerate(PERIOD_CASES):
        exact = equation.threshold(case)
        rest = (2 * (case.gamma_s + case.tau_s)) ** 0.5
        shares = np.concatenate([np.linspace(0.15, 0.9, points), 1 - np.geomspace(0.1, 1e-3, points)])
        distances = np.concatenate(
            [exact.phi - (rest + shares * (exact.phi - rest)), np.geomspace(1e-3, 1e-11, points)]
        )
        voltages = exact.phi - distances
        distances = exact.phi - voltages  # as a double holds them
        periods = np.array(workers.map(period, [(case, phi) for phi in voltages]))
        varied = next((p for p in ("gamma_s", "tau_s", "E_s") if getattr(case, p)), None)
        name = style.setting(**{varied: getattr(case, varied)}) if varied else "ideal"
        look = style.curve(index)
        order = np.argsort(voltages)
        left.plot(voltages[order], periods[order], label=name, **look)
        left.axvline(exact.phi, color=look["color"], linewidth=0.8, linestyle=":")
        right.semilogx(distances, periods, label=name, **look)
        near = (distances < 1e-5) & (distances > 1e-10)
        slope = np.polyfit(-np.log(distances[near]), periods[near], 1)[0]
        expected = 1 / equation.escape_rate(case, exact)
        rows.append(Row(f"dT/d(-ln(phi^C - phi)), {varied or 'ideal'}", None, expected, float(slope)))
        for field in ("gamma_s", "tau_s", "E_s"):
            columns[field] += [getattr(case, field)] * len(periods)
        columns["phi"] += voltages.tolist()
        columns["distance"] += distances.tolist()
        columns["period"] += periods.tolist()
    left.set(xlabel=f"voltage  {style.SYMBOLS['phi']}", ylabel="period  $T$", ylim=(20, 160))
    right.set(xlabel=r"distance to pull-in  $\bar{\phi}^C - \bar{\phi}$", ylabel="period  $T$")
    right.invert_xaxis()
    left.set_title("(a)  dotted: the pull-in voltages", loc="left")
    right.set_title("(b)", loc="left")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=len(PERIOD_CASES))
    figure.suptitle(r"Period of the motion from rest, $\bar{S}$ = 0")
    return Entry(
        "period",
        "Period over voltage",
        figure,
        columns,
        rows=rows,
        claims=[
            Claim(
                "The oscillation period grows without bound towards pull-in.",
                bool(max(abs(row.difference) / row.exact for row in rows) < 1e-3),
                "It grows like −ln(φ̄ᶜ − φ̄)/σ with σ the rate of the saddle, to "
                f"{max(abs(row.difference) / row.exact for row in rows):.0e}.",
            )
        ],
        remarks=[
            "The period grows like −ln(φ̄ᶜ − φ̄)/σ with σ the rate of the saddle: the mark of a homoclinic orbit. At "
            "a saddle-node it would grow like a power of the distance. Exact: 1/σ from Eq. 16 linearised at the "
            "threshold; FMU: slope fitted for distances of 1e-10 to 1e-5.",
        ],
    )
