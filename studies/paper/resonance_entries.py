"""Fig. 8 and Tables 2 to 4, drawn and compared; what the paper says about them, held against the numbers."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np

import figure_style as style
from comparison import Row
from dielectric_actuator import Actuator
from paper.entries import Claim, Columns, Entry, Grid, draw_table, stack
from paper.independent import DrivenRuns
from paper.resonance import RESOLUTION, Response
from paper.scenes import BRANCHES, PHI_AC, PRESTRESSES, TABLES, VALUES, printed_resonances, varied
from paper.thickness_range import amplitudes
from references import SurfaceEffects, driven_amplitudes

Responses = dict[SurfaceEffects, Response]

LAST_DIGIT = 1e-4
EXACTLY = 1e-12
"""Tolerance for the amplitudes that are held against exact ones."""
CHECK_WINDOW = 2000.0
BESIDE_PEAK = (-1e-5, 0.0, 1e-5)
"""Distances in ω from a peak at which the amplitude is held against the independent integrator's."""


def figure_8(actuator: Actuator, responses: Responses, growth: list[tuple[int, float]], workers: int) -> Entry:
    """Frequency responses with the refined peaks, over the longest window."""
    windows = next(iter(responses.values())).windows
    figure, rows = plt.subplots(3, 2, figsize=(12, 11), sharex=True, sharey=True)
    columns: dict[str, list] = {}
    printed = printed_resonances()
    letters = iter("abcdef")
    for (parameter, values), row in zip(VALUES.items(), rows):
        for axes, prestress in zip(row, PRESTRESSES):
            for index, value in enumerate(values):
                response = responses[varied(parameter, value, prestress)]
                look = style.curve(index)
                name = style.setting(**{parameter: value})
                axes.semilogy(response.omega, response.amplitude[:, -1], label=name, **{**look, "linewidth": 1.2})
                for branch in BRANCHES:
                    peak = response.peaks[branch, windows[-1]]
                    axes.plot(peak.omega, peak.amplitude, "o", markersize=4, color=look["color"])
                    place = float(printed[response.case, branch])
                    axes.plot(place, 0.0075, "|", markersize=11, markeredgewidth=1.8, color=look["color"])
                length = len(response.omega)
                labels: Columns = {"varied": [parameter] * length, "value": [value] * length, "S": [prestress] * length}
                fields = {f"amplitude_T{w:g}": response.amplitude[:, k] for k, w in enumerate(windows)}
                columns = stack(columns, {**labels, "omega": response.omega, **fields})
            axes.plot([], [], "o", color=style.GREY, markersize=4, label="peak")
            axes.plot([], [], "|", color=style.GREY, markersize=11, markeredgewidth=1.8, label="paper's peak")
            axes.set_title(f"({next(letters)})  {style.NAMES[parameter]}, {style.setting(S=prestress)}", loc="left")
            axes.set(xlim=(response.omega[0], response.omega[-1]), ylim=(0.006, 20))
            axes.legend(loc="upper right", fontsize=9)
            axes.tick_params(labelbottom=True)
        row[0].set_ylabel(r"amplitude  $\lambda_3^a$")
    for axes in rows[-1]:
        axes.set_xlabel(f"angular frequency  {style.SYMBOLS['omega_ac']}")
    figure.suptitle(
        rf"Amplitude over [0, {windows[-1]:g}] from rest, {style.setting(phi_ac=PHI_AC)}, others at "
        rf"{style.setting(gamma_s=0.05, tau_s=0.05, E_s=0.2)}"
    )
    jumps = [
        [_name(response.case), f"{response.jump[0]:.7f}", f"{response.jump[1]:.4f}", f"{response.jump[2]:.4f}"]
        for response in responses.values()
    ]
    caption = f"The jump above the harmonic peak, T = {windows[-1]:g}"
    seconds = "; ".join(f"{count} frequencies {second:.2f} s" for count, second in growth)
    return Entry(
        "figure_08",
        "Fig. 8: amplitude over frequency",
        figure,
        columns,
        rows=_reference_rows(actuator),
        grids=[Grid(caption, ["case", "ω", "λ₃ᵃ below", "λ₃ᵃ above"], jumps)],
        claims=[*_amplitude_claims(responses), *_shift_claims(responses), _strongest_shift(responses)],
        remarks=[
            f"Window: each run starts from rest and lasts T = {windows[-1]:g}; the CSV holds the amplitudes for T = "
            f"{', '.join(f'{w:g}' for w in windows)}. The paper states neither window nor frequency step.",
            f"Peaks are refined to {RESOLUTION:g} in ω. The harmonic branch ends in a jump, where the orbit from rest "
            "passes from one side of a separatrix to the other.",
            f"Time on {workers} worker process(es) in this run, one case, windows up to 5000: {seconds}. It grows in "
            "proportion to the number of frequencies.",
        ],
    )


def _reference_rows(actuator: Actuator) -> list[Row]:
    rows = []
    for reference in driven_amplitudes():
        (found,) = amplitudes(actuator, reference.scene(), (reference.stop_time,), EXACTLY)
        name = f"lambda3^a at omega = {reference.omega_ac:g}, T = {reference.stop_time:g}, {reference.case}"
        rows.append(Row(name, None, reference.amplitude, float(found)))
    return rows


def _amplitude_claims(responses: Responses) -> list[Claim]:
    """What Sections 3.2 and 4 say about the amplitude, decided at the harmonic peak of the longest window."""
    said = {
        "gamma_s": (("rises", 0.0), ("falls", 0.5)),
        "tau_s": (("rises", 0.0), ("rises", 0.5)),
        "E_s": (("falls", 0.0), ("falls", 0.5)),
    }
    claims = []
    for parameter, cases in said.items():
        for claimed, prestress in cases:
            family = [responses[varied(parameter, value, prestress)] for value in VALUES[parameter]]
            values = [response.peaks["harmonic", response.windows[-1]].amplitude for response in family]
            steps = np.diff(values)
            claims.append(
                Claim(
                    f"Amplitude {claimed} with {style.NAMES[parameter]} ({style.TEXT_SYMBOLS['S']} = {prestress:g}).",
                    bool(np.all(steps > 0) if claimed == "rises" else np.all(steps < 0)),
                    f"λ₃ᵃ at the harmonic peak: {', '.join(f'{value:.3f}' for value in values)}.",
                )
            )
    return claims


def _shift_claims(responses: Responses) -> list[Claim]:
    def place(parameter: str, value: float, prestress: float, branch: str) -> float:
        response = responses[varied(parameter, value, prestress)]
        return response.peaks[branch, response.windows[-1]].omega

    rising = [
        np.all(np.diff([place(parameter, value, prestress, branch) for value in values]) > 0)
        for parameter, values in VALUES.items()
        for prestress in PRESTRESSES
        for branch in BRANCHES
    ]
    lower = [
        place(parameter, value, 0.5, branch) < place(parameter, value, 0.0, branch)
        for parameter, values in VALUES.items()
        for value in values
        for branch in BRANCHES
    ]
    return [
        Claim(
            "All resonance frequencies rise with each surface effect.",
            bool(all(rising)),
            f"So in {sum(rising)} of {len(rising)} rows of three values (FMU, longest window).",
        ),
        Claim(
            "Prestress lowers the resonance frequencies.",
            bool(all(lower)),
            f"So in {sum(lower)} of {len(lower)} pairs (FMU, longest window).",
        ),
    ]


def _strongest_shift(responses: Responses) -> Claim:
    printed = printed_resonances()
    parts, holds = [], []
    for prestress in PRESTRESSES:
        for own in (True, False):
            strongest = []
            for branch in BRANCHES:
                shift = {}
                for parameter, values in VALUES.items():
                    low, high = (varied(parameter, values[k], prestress) for k in (0, -1))
                    shift[parameter] = (
                        float(printed[high, branch]) - float(printed[low, branch])
                        if own
                        else responses[high].peaks[branch, responses[high].windows[-1]].omega
                        - responses[low].peaks[branch, responses[low].windows[-1]].omega
                    )
                strongest.append(max(shift, key=lambda name: shift[name]))
            holds += [name == "E_s" for name in strongest]
            listed = ", ".join(f"{style.TEXT_SYMBOLS[name]} ({branch})" for name, branch in zip(strongest, BRANCHES))
            whose = "the paper's numbers" if own else "the FMU's"
            parts.append(f"{style.TEXT_SYMBOLS['S']} = {prestress:g}, {whose}: {listed}")
    return Claim(
        "Surface elasticity shifts the resonances most of the three surface effects.",
        True if all(holds) else None if any(holds) else False,
        f"Strongest over the ranges of the tables: {'; '.join(parts)}.",
    )


def _name(case: SurfaceEffects) -> str:
    names = ("gamma_s", "tau_s", "E_s", "S")
    return ", ".join(f"{style.TEXT_SYMBOLS[name]} = {getattr(case, name):g}" for name in names)


def check_peaks(actuator: Actuator, item: tuple[list[tuple[SurfaceEffects, float]], float]) -> list[list[Row]]:
    """λ₃ᵃ beside each of the given peaks (case, ω) over a window: the independent integrator and the FMU."""
    peaks, window = item
    places = [(case, omega + step) for case, omega in peaks for step in BESIDE_PEAK]
    exact = DrivenRuns([case for case, _ in places], np.array([omega for _, omega in places]), PHI_AC).amplitudes(
        window
    )
    rows = []
    for (case, omega), value in zip(places, exact):
        (found,) = amplitudes(actuator, case.scene(phi_ac=PHI_AC, omega_ac=omega), (window,), EXACTLY)
        rows.append(Row(f"lambda3^a(omega = {omega:.6f}, T = {window:g}), {case}", None, float(value), float(found)))
    return [rows[k : k + len(BESIDE_PEAK)] for k in range(0, len(rows), len(BESIDE_PEAK))]


def tables(responses: Responses, checked: dict[tuple[SurfaceEffects, str], list[Row]]) -> list[Entry]:
    """Tables 2 to 4. `checked` holds the rows of `check_peaks` for each entry."""
    printed = printed_resonances()
    windows = next(iter(responses.values())).windows
    entries = []
    for parameter, number in TABLES.items():
        header = ["", "branch", style.SYMBOLS["S"], "paper", *(f"T = {w:g}" for w in windows), "paper $-$ nearest"]
        header += [r"$\lambda_3^a$ FMU", r"$\lambda_3^a$ exact"]
        cells: list[list[str]] = []
        rows: list[Row] = []
        marked: set[tuple[int, int]] = set()
        columns: dict[str, list] = {}
        for value in VALUES[parameter]:
            for branch in BRANCHES:
                for prestress in PRESTRESSES:
                    case = varied(parameter, value, prestress)
                    place = float(printed[case, branch])
                    peaks = [responses[case].peaks[branch, window] for window in windows]
                    nearest = min((place - peak.omega for peak in peaks), key=abs)
                    beside = checked[case, branch]
                    rows += beside
                    at_peak = beside[len(beside) // 2]
                    if abs(nearest) > LAST_DIGIT / 2:
                        marked.add((len(cells), 3))
                    cells.append(
                        [style.setting(**{parameter: value}), branch, f"{prestress:g}", printed[case, branch]]
                        + [f"{peak.omega:.5f}" for peak in peaks]
                        + [f"{nearest:+.5f}", f"{at_peak.measured:.7f}", f"{at_peak.exact:.7f}"]
                    )
                    line = {"value": value, "branch": branch, "S": prestress, "paper": printed[case, branch]}
                    line |= {f"omega_T{window:g}": peak.omega for window, peak in zip(windows, peaks)}
                    line |= {f"amplitude_T{window:g}": peak.amplitude for window, peak in zip(windows, peaks)}
                    for name, cell in line.items():
                        columns.setdefault(name, []).append(cell)
        title = f"Table {number}: resonance frequencies over {style.NAMES[parameter]}"
        worst = max(abs(row.difference) for row in rows)
        entries.append(
            Entry(
                f"table_{number}",
                title,
                draw_table(header, cells, title=title, marked=marked, meaning="the peak of none of the windows"),
                columns,
                rows=rows,
                grids=[Grid(title, header, cells)],
                claims=[
                    Claim(
                        f"{title}, to four digits.",
                        not marked,
                        f"{len(marked)} of {len(cells)} entries (marked) are the peak of none of the windows T = "
                        f"{', '.join(f'{w:g}' for w in windows)}, to half a unit of their last digit.",
                    )
                ],
                remarks=[
                    "λ₃ᵃ FMU and exact: amplitude at the FMU's peak of the window nearest 2000, and the same by an "
                    "independent integrator (DOP853 on Eq. 16 as printed). The comparison holds it at the peak and "
                    f"{BESIDE_PEAK[-1]:g} in ω to both sides; they agree to {worst:.0e}, next to the jump too.",
                ],
            )
        )
    return entries


def window_comparison(responses: Responses) -> Entry:
    """How far the printed resonances of Tables 2 to 4 are from the peaks of each window."""
    printed = printed_resonances()
    windows = next(iter(responses.values())).windows
    distances = {
        window: {key: responses[key[0]].peaks[key[1], window].omega - float(value) for key, value in printed.items()}
        for window in windows
    }
    figure, axes = plt.subplots(figsize=(9, 4.4))
    columns: dict[str, list] = {"branch": [], "window": [], "rms": [], "worst": [], "to_four_digits": [], "entries": []}
    for index, branch in enumerate((*BRANCHES, "all")):
        for window in windows:
            away = np.abs([d for (_, b), d in distances[window].items() if branch in (b, "all")])
            hits = int((away <= LAST_DIGIT / 2).sum())
            line = (branch, window, float(np.sqrt((away**2).mean())), float(away.max()), hits, len(away))
            for name, value in zip(columns, line):
                columns[name].append(value)
        look = {"color": style.BLACK, "linestyle": "-"} if branch == "all" else style.curve(index)
        axes.plot(windows, columns["rms"][-len(windows) :], marker="o", label=branch, **look)
    axes.axhline(LAST_DIGIT / 2, color=style.GREY, linestyle=":")
    axes.text(windows[0], LAST_DIGIT / 2 * 1.3, "rounding to four digits", color="#5a5a5a", fontsize=9.5)
    axes.set(xlabel=r"window  $T$", ylabel=r"RMS difference in  $\bar{\omega}$", ylim=(0, None))
    axes.legend(**style.BESIDE)
    axes.set_title("Distance of Tables 2 to 4 from the peaks of each window", loc="left")

    lines = list(zip(*columns.values()))
    whole = lines[-len(windows) :]
    _, best, rms, worst, _, compared = min(whole, key=lambda line: line[2])
    agreeing = [line[4] for line in whole]
    mean = np.mean([float(value) for value in printed.values()])
    settled = windows[min(1, len(windows) - 1)]
    moved = max(
        abs(response.peaks["harmonic", windows[-1]].omega - response.peaks["harmonic", settled].omega)
        for response in responses.values()
    )
    off = max(abs(d) for (_, branch), d in distances[settled].items() if branch == "harmonic")
    cells = [[b, f"{w:g}", f"{r:.1e}", f"{x:.1e}", f"{h} of {n}"] for b, w, r, x, h, n in lines]
    return Entry(
        "tables_2_to_4",
        "Tables 2 to 4: distance from any one window",
        figure,
        columns,
        grids=[Grid("Paper against the peaks of each window", ["branch", "T", "RMS", "worst", "to 4 digits"], cells)],
        remarks=[
            f"No one window gives the printed numbers. T = {best:g} is nearest: RMS {rms:.1e}, worst {worst:.1e}, "
            f"that is {100 * rms / mean:.1f} % of the mean frequency; at most {max(agreeing)} of {compared} entries "
            "agree to their four digits at once. The paper states no window, frequency step or tolerance, so that its "
            "numbers cannot be obtained again; they hold to about 1 %.",
            "The sub- and superharmonic peaks drift with T, since nothing is damped. The harmonic peak is a jump, "
            f"settled by T = {settled:g} (it moves by at most {moved:.0e} until T = {windows[-1]:g}), and its printed "
            f"places are off all the same, by up to {off:.1e}.",
        ],
    )
