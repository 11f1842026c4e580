"""Is the driven motion aperiodic? Exact variational equations, and the same runs at a default solver's tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import figure_style as style
import turning_points
from comparison import Row
from dielectric_actuator import Actuator
from paper.entries import Claim, Entry, Grid
from paper.equation import Cases
from paper.independent import ODE45_ATOL, ODE45_RTOL, DrivenRuns, Indicators, embedded_pair
from paper.scenes import BRANCHES, EXTREME, NEAR_RESONANT, PHI_AC, DrivenRun, driven_runs, shown_run
from paper.thickness_range import amplitudes
from references import SurfaceEffects

TOLERANCE = 1e-12
CHECKED_AT = (0.2, 1.0)
"""Shares of the window at which λ of the independent integrator is held against the FMU's."""

CHAOTIC = (
    (SurfaceEffects(0.0, 0.0, 0.015, 0.0), 0.106, 0.64),
    (SurfaceEffects(0.0, 0.0, 0.029, 0.0), 0.078, 0.83),
    (SurfaceEffects(0.0, 0.0, 0.077, 0.0), 0.131, 0.86),
)
"""Case, ω and φ_a of motions that are chaotic: what the indicators must tell from the paper's."""
LADDER = (ODE45_RTOL, 1e-4, 1e-5, 1e-6, 1e-8)


def indicator_times(window: float) -> np.ndarray:
    """Where the indicators are recorded: even in ln t, and at the times of `CHECKED_AT`."""
    return np.unique(np.concatenate([np.geomspace(20, window, 150)[:-1], np.array(CHECKED_AT) * window]))


def of_the_paper(_actuator: Actuator, window: float) -> Indicators:
    """Indicators of `scenes.driven_runs`, in their order."""
    runs = driven_runs()
    omega = np.array([run.omega for run in runs])
    return DrivenRuns([run.case for run in runs], omega, PHI_AC).indicators(indicator_times(window))


def of_the_chaotic(_actuator: Actuator, window: float) -> Indicators:
    """Indicators of `CHAOTIC`."""
    omega, phi_ac = (np.array([run[k] for run in CHAOTIC]) for k in (1, 2))
    return DrivenRuns([run[0] for run in CHAOTIC], omega, phi_ac).indicators(indicator_times(window))


def checks(actuator: Actuator, indicators: Indicators) -> dict[DrivenRun, list[Row]]:
    """λ of each run at `CHECKED_AT`: the independent integrator (as exact) beside the FMU."""
    found: dict[DrivenRun, list[Row]] = {}
    for index, run in enumerate(driven_runs()):
        actuator.start(run.scene(), tolerance=TOLERANCE)
        found[run] = []
        for instant in np.array(CHECKED_AT) * indicators.times[-1]:
            actuator.advance(instant - actuator.time)
            column = int(np.flatnonzero(indicators.times == instant)[0])
            name = f"lambda(t = {instant:g}), omega = {run.omega:g}, {run.case}"
            found[run].append(Row(name, None, float(indicators.stretch[index, column]), actuator.get("lambda")))
    return found


def indicator_entry(indicators: Indicators, chaotic: Indicators, checked: dict[DrivenRun, list[Row]]) -> Entry:
    """MEGNO and largest Lyapunov exponent of all runs of the paper, beside chaotic motions."""
    runs = driven_runs()
    figure, (left, right) = plt.subplots(1, 2, figsize=(12.5, 5))
    looks = {regime: style.curve(index) for index, regime in enumerate((*BRANCHES, NEAR_RESONANT))}
    for axes, name in ((left, "megno"), (right, "exponent")):
        for index, run in enumerate(runs):
            values = np.abs(getattr(indicators, name)[index])
            axes.plot(indicators.times, values, linewidth=0.7, alpha=0.8, **looks[run.regime])
        for index in range(len(CHAOTIC)):
            axes.plot(chaotic.times, np.abs(getattr(chaotic, name)[index]), color=style.BLACK, linewidth=1.6)
        axes.set_xscale("log")
        axes.set_xlabel(f"time  {style.SYMBOLS['time']}")
    for regime, look in looks.items():
        count = sum(run.regime == regime for run in runs)
        left.plot([], [], label=f"{regime} ({count} runs)", **look)
    left.plot([], [], color=style.BLACK, label="chaotic, for comparison")
    left.axhline(2, color=style.GREY, linestyle=":")
    left.set(ylabel="MEGNO", ylim=(0, 12))
    times = indicators.times
    right.plot(
        times, np.log(times) / times, color=style.GREY, linewidth=2.5, linestyle=":", label=r"$\ln\bar{t}\,/\,\bar{t}$"
    )
    right.set_yscale("log")
    right.set(ylabel="|largest Lyapunov exponent|", ylim=(1e-5, 1))
    handles = [*left.get_legend_handles_labels()[0], *right.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    left.set_title("(a)", loc="left")
    right.set_title("(b)", loc="left")
    figure.suptitle(rf"Order and chaos, all runs of Tables 2 to 4 and near resonance, {style.setting(phi_ac=PHI_AC)}")

    last, last_chaotic = indicators.megno[:, -1], chaotic.megno[:, -1]
    window, law = times[-1], np.log(times[-1]) / times[-1]
    cells = [
        [run.regime, str(run.case), f"{run.omega:g}", f"{megno:.3f}", f"{exponent:.2e}"]
        for run, megno, exponent in zip(runs, last, indicators.exponent[:, -1])
    ] + [
        [f"chaotic, φ_a = {phi_ac:g}", str(case), f"{omega:g}", f"{megno:.3f}", f"{exponent:.2e}"]
        for (case, omega, phi_ac), megno, exponent in zip(CHAOTIC, last_chaotic, chaotic.exponent[:, -1])
    ]
    verdict = (
        f"No run of the paper is chaotic or aperiodic: at t̄ = {window:g} MEGNO lies between {last.min():.2f} and "
        f"{last.max():.2f} for all {len(runs)} of them and the exponents are at most "
        f"{np.abs(indicators.exponent[:, -1]).max() / law:.1f} ln t / t and fall like it. For three chaotic motions "
        f"of the same equation MEGNO has grown to {last_chaotic.min():.1f} and more by t̄ = {chaotic.times[-1]:g}."
    )
    names = [run.regime for run in runs] + ["chaotic"] * len(CHAOTIC)
    return Entry(
        "chaos_indicators",
        "Is the driven motion aperiodic? MEGNO and Lyapunov exponents",
        figure,
        {
            "regime": names,
            "case": [str(run.case) for run in runs] + [str(case) for case, _, _ in CHAOTIC],
            "omega": [run.omega for run in runs] + [omega for _, omega, _ in CHAOTIC],
            "phi_ac": [PHI_AC] * len(runs) + [phi_ac for _, _, phi_ac in CHAOTIC],
            "time": [window] * len(runs) + [chaotic.times[-1]] * len(CHAOTIC),
            "megno": [*last, *last_chaotic],
            "lyapunov_exponent": [*indicators.exponent[:, -1], *chaotic.exponent[:, -1]],
        },
        rows=[max((rows[-1] for rows in checked.values()), key=lambda row: abs(row.difference))],
        grids=[
            Grid(
                f"Indicators at t̄ = {window:g} (chaotic: {chaotic.times[-1]:g})",
                ["", "case", "ω", "MEGNO", "exponent"],
                cells,
            )
        ],
        claims=[
            Claim(
                "At harmonic and superharmonic drive the motion departs from quasi-periodicity.",
                not bool(last.max() < 3 < last_chaotic.min()),
                verdict,
            )
        ],
        remarks=[
            "Computed without the FMU: Eq. 16 as printed with its exact variational equations, DOP853. Its λ is held "
            "against the FMU's at the same times (the worst of all runs is in the table).",
            "MEGNO tends to 2 on a torus, from below where the frequency hardly depends on the amplitude, and grows "
            "in proportion to t in chaos.",
        ],
    )


@dataclass(frozen=True)
class Loose:
    """One run by RK45 at tolerance `rtol`: `amplitude` of λ₃, samples of it, and the section at kπ/ω."""

    run: DrivenRun
    rtol: float
    amplitude: float
    history: np.ndarray
    section: np.ndarray


def loose_runs() -> list[tuple[DrivenRun, float]]:
    """The six runs of Figs. 9 and 11 at ode45's default tolerance, the first of them at closer ones too."""
    runs = [shown_run(parameter, regime, 0.0) for regime in ("harmonic", "superharmonic") for parameter in EXTREME]
    return [(run, ODE45_RTOL) for run in runs] + [(runs[0], rtol) for rtol in LADDER[1:]]


def follow_loosely(_actuator: Actuator, item: tuple[DrivenRun, float, float]) -> Loose:
    run, rtol, window = item
    atol = ODE45_ATOL * rtol / ODE45_RTOL
    sections = np.arange(1, int(window / run.forcing_period) + 1) * run.forcing_period
    samples = np.linspace(0, window, round(window / 0.25) + 1)
    times = np.union1d(sections, samples)
    stretch, rate = embedded_pair(run.case, PHI_AC, run.omega, times, rtol, atol)
    names = ("time", *turning_points.OUTPUTS)
    response = np.empty(len(times), dtype=[(name, float) for name in names])
    bend = Cases.of([run.case]).acceleration(stretch, rate, (PHI_AC * np.sin(run.omega * times)) ** 2)
    for name, values in zip(names, (times, stretch, rate, bend)):
        response[name] = values
    at = np.searchsorted(times, sections)
    section = np.column_stack([stretch[at] ** -2, -2 * rate[at] * stretch[at] ** -3])
    amplitude = turning_points.thickness_amplitude(response)
    return Loose(run, rtol, amplitude, np.column_stack([times, stretch**-2]), section)


def tolerance_entry(actuator: Actuator, found: list[Loose], window: float) -> Entry:
    """The same runs at a default solver's tolerance and at 1e-12: time history, sections, convergence."""
    ladder = [loose for loose in found if loose.run == found[0].run]
    shown = [loose for loose in found if loose.rtol == ODE45_RTOL]
    figure = plt.figure(figsize=(12.5, 11.5))
    grid = figure.add_gridspec(3, 3, height_ratios=(1, 1.15, 1.15))
    exact_amplitude = {}
    columns: dict[str, list] = {
        name: [] for name in ("regime", "varied", "omega", "rtol", "amplitude", "amplitude_fmu")
    }
    cells = []
    for index, loose in enumerate(shown):
        (exact_amplitude[loose.run],) = amplitudes(actuator, loose.run.scene(), (window,), TOLERANCE)
        axes = figure.add_subplot(grid[1 + index // 3, index % 3])
        _overlay(axes, actuator, loose)
        setting = style.setting(**_extreme(loose.run), omega_ac=loose.run.omega)
        axes.set_title(f"({'cdefgh'[index]})  {loose.run.regime}, {setting}", loc="left", fontsize=10)
    history = figure.add_subplot(grid[0, :2])
    history.plot(*ladder[0].history.T, color=style.COLOURS[1], linewidth=0.5)
    ours = actuator.run(
        found[0].run.scene(), stop_time=window, communication_step=0.25, outputs=("lambda3",), tolerance=TOLERANCE
    )
    history.plot(ours["time"], ours["lambda3"], color=style.COLOURS[0], linewidth=0.5)
    history.plot([], [], color=style.COLOURS[1], label=f"RK45, tolerance {ODE45_RTOL:g}")
    history.plot([], [], color=style.COLOURS[0], label=f"FMU, tolerance {TOLERANCE:g}")
    history.set_xlim(0, window)
    style.label(history, "time", "lambda3")
    history.set_title(f"(a)  harmonic, {style.setting(gamma_s=0.1, omega_ac=found[0].run.omega)}", loc="left")
    history.legend(loc="lower left", bbox_to_anchor=(0.45, 1.0), ncols=2)
    converging = figure.add_subplot(grid[0, 2])
    exact = exact_amplitude[found[0].run]
    converging.loglog(
        [one.rtol for one in ladder], [abs(one.amplitude - exact) for one in ladder], "o-", color=style.COLOURS[1]
    )
    converging.invert_xaxis()
    converging.set(xlabel="relative tolerance of RK45", ylabel=r"difference of $\lambda_3^a$ from the FMU")
    converging.set_title("(b)  convergence of (a)", loc="left")
    figure.suptitle(
        "The same motion at the tolerance of a default 4(5) solver and at 1e-12, "
        rf"{style.SYMBOLS['time']} $\leq$ {window:g}; sections at $k\,\pi/\bar{{\omega}}$"
    )
    for loose in found:
        (parameter,) = _extreme(loose.run)
        line = (loose.run.regime, parameter, loose.run.omega, loose.rtol, loose.amplitude, exact_amplitude[loose.run])
        for name, value in zip(columns, line):
            columns[name].append(value)
        cells.append([line[0], parameter, f"{line[2]:g}", f"{line[3]:g}", f"{line[4]:.6f}", f"{line[5]:.6f}"])
    return Entry(
        "default_tolerance",
        "The same runs at a default solver's tolerance",
        figure,
        columns,
        grids=[
            Grid("Amplitude of λ₃", ["regime", "varied", "ω", "tolerance of RK45", "RK45", "FMU at 1e-12"], cells),
        ],
        remarks=[
            "RK45 is SciPy's; its pair of formulas (Dormand and Prince) is that of MATLAB's ode45, which the paper "
            f"used, with ode45's default tolerances {ODE45_RTOL:g} and {ODE45_ATOL:g}. The paper prints no "
            "tolerances, so that this shows a likely cause, not a proven one; step control differs in detail between "
            "the two.",
            f"At that tolerance the harmonic run for γ̄ₛ = 0.1 reaches an amplitude of {ladder[0].amplitude:.3f} by t "
            f"= {window:g}, where the exact one is {exact:.4f}; its section is scattered, as in the paper's Fig. 9. "
            "With closer tolerances RK45 converges to the FMU (panel b). Scatter that goes away with the tolerance "
            "is an error of integration.",
            "At the superharmonic two things keep a section from closing: the slow modulation has not come round by "
            f"t̄ = {window:g} even in the exact motion (blue; over a longer time it closes, Fig. 11), and at the "
            "default tolerance the motion drifts off its curve.",
        ],
    )


def _overlay(axes: Axes, actuator: Actuator, loose: Loose) -> None:
    """The section of a loose run, and over it that of the FMU at the same times."""
    period = loose.run.forcing_period
    section = actuator.run(
        loose.run.scene(),
        stop_time=len(loose.section) * period,
        communication_step=period,
        outputs=("lambda3", "lambda3_dot"),
        tolerance=TOLERANCE,
    )
    axes.plot(loose.section[:, 0], loose.section[:, 1], ".", color=style.COLOURS[1], markersize=3)
    axes.plot(section["lambda3"], section["lambda3_dot"], ".", color=style.COLOURS[0], markersize=3)
    style.label(axes, "lambda3", "lambda3_dot")


def _extreme(run: DrivenRun) -> dict[str, float]:
    """The surface parameter that has its largest value in a run of Figs. 9 to 12."""
    return {name: value for name, value in EXTREME.items() if getattr(run.case, name) == value}
