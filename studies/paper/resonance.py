"""Amplitude over frequency: scan, then refinement of the three resonance peaks and of the jump.

From rest and without damping the amplitude λ₃ᵃ = (max λ₃ − min λ₃)/2 depends on the window [0, T]: at the
subharmonic and the superharmonic the motion goes on growing for thousands of time units, and the peaks move with T.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from dielectric_actuator import Actuator
from paper.scenes import BRANCHES, PHI_AC, cases
from paper.thickness_range import amplitudes
from paper.workers import Workers
from references import SurfaceEffects

WINDOWS = (1000.0, 2000.0, 3000.0, 4000.0, 5000.0)
TOLERANCE = 1e-9
"""Leaves 1e-10 in an amplitude over 5000 time units."""
LOWEST, HIGHEST = 0.04, 0.32
SPANS = {"subharmonic": (0.045, 0.085), "harmonic": (0.1, 0.17), "superharmonic": (0.2, 0.31)}
"""Where each branch lies for every case."""
ZOOM = 21
RESOLUTION = 1e-6
CHUNK = 25


@dataclass(frozen=True)
class Peak:
    """The highest amplitude of a branch over one window, to `RESOLUTION` in ω."""

    omega: float
    amplitude: float


@dataclass(frozen=True)
class Response:
    """One case: `omega` in order with `amplitude` over each window (a column each), peaks, and the jump."""

    case: SurfaceEffects
    windows: tuple[float, ...]
    omega: np.ndarray
    amplitude: np.ndarray
    peaks: dict[tuple[str, float], Peak]
    jump: tuple[float, float, float]
    """Of the harmonic branch over the longest window: ω, amplitude just below, and amplitude just above it."""


def scan(actuator: Actuator, item: tuple[SurfaceEffects, np.ndarray, tuple[float, ...]]) -> np.ndarray:
    """Amplitude for each ω (rows) and window (columns)."""
    case, omegas, windows = item
    return np.array(
        [amplitudes(actuator, case.scene(phi_ac=PHI_AC, omega_ac=omega), windows, TOLERANCE) for omega in omegas]
    )


def refine(actuator: Actuator, item: tuple[SurfaceEffects, float, list[float], float]) -> Peak:
    """Zoom on each of the `starts`, ω at local maxima of a scan with the given spacing; the highest peak."""
    case, window, starts, spacing = item
    best = Peak(0.0, -1.0)
    for start in starts:
        centre, width = start, spacing
        while width > RESOLUTION:
            omegas = np.linspace(centre - width, centre + width, ZOOM)
            found = scan(actuator, (case, omegas, (window,)))[:, 0]
            centre, width = omegas[found.argmax()], 2 * width / (ZOOM - 1)
            if found.max() > best.amplitude:
                best = Peak(float(centre), float(found.max()))
    return best


def find_jump(actuator: Actuator, item: tuple[SurfaceEffects, float, Peak]) -> tuple[float, float, float]:
    """Bisection for the ω above the harmonic peak at which the amplitude falls, to 1e-9."""
    case, window, peak = item

    def amplitude(omega: float) -> float:
        return float(scan(actuator, (case, np.array([omega]), (window,)))[0, 0])

    below, above = peak.omega, peak.omega + 1e-3
    high, low = peak.amplitude, amplitude(above)
    middle_amplitude = (high + low) / 2
    while above - below > 1e-9:
        middle = (below + above) / 2
        found = amplitude(middle)
        if found > middle_amplitude:
            below, high = middle, found
        else:
            above, low = middle, found
    return above, high, low


def starts(omega: np.ndarray, amplitude: np.ndarray, span: tuple[float, float], most: int = 2) -> list[float]:
    """ω of the highest local maxima of a scan within `span`."""
    inside = np.flatnonzero((omega[1:-1] > span[0]) & (omega[1:-1] < span[1])) + 1
    tops = [k for k in inside if amplitude[k] >= amplitude[k - 1] and amplitude[k] >= amplitude[k + 1]]
    return [float(omega[k]) for k in sorted(tops, key=lambda k: -amplitude[k])[:most]]


def responses(
    workers: Workers, frequencies: int, windows: tuple[float, ...] = WINDOWS
) -> dict[SurfaceEffects, Response]:
    """All 14 cases of Fig. 8 with their peaks for every window, from scans of that many frequencies."""
    omega = np.linspace(LOWEST, HIGHEST, frequencies)
    chunks = np.array_split(omega, max(1, frequencies // CHUNK))
    scanned = workers.map(scan, [(case, chunk, windows) for case in cases() for chunk in chunks])
    tables = [np.concatenate(scanned[k : k + len(chunks)]) for k in range(0, len(scanned), len(chunks))]
    wanted = [
        (case, branch, column, starts(omega, table[:, column], SPANS[branch]))
        for case, table in zip(cases(), tables)
        for branch in BRANCHES
        for column in range(len(windows))
    ]
    spacing = omega[1] - omega[0]
    peaks = workers.map(refine, [(case, windows[column], at, spacing) for case, _, column, at in wanted])
    by_case: dict[SurfaceEffects, dict] = {case: {} for case in cases()}
    for (case, branch, column, _), peak in zip(wanted, peaks):
        by_case[case][branch, windows[column]] = peak
    jumps = workers.map(find_jump, [(case, windows[-1], by_case[case]["harmonic", windows[-1]]) for case in cases()])
    # the curve shows its peaks, which lie between the frequencies of the scan
    extra = [np.array(sorted({round(p.omega, 9) for p in by_case[case].values()})) for case in cases()]
    filled = workers.map(scan, [(case, at, windows) for case, at in zip(cases(), extra)])
    found = {}
    for case, table, at, more, jump in zip(cases(), tables, extra, filled, jumps):
        order = np.argsort(np.concatenate([omega, at]))
        together = np.concatenate([table, more])[order]
        found[case] = Response(case, windows, np.concatenate([omega, at])[order], together, by_case[case], jump)
    return found


def growth(workers: Workers, counts: tuple[int, ...]) -> list[tuple[int, float]]:
    """Seconds that a scan of the reference case takes over the number of its frequencies."""
    found = []
    for count in counts:
        omega = np.linspace(LOWEST, HIGHEST, count)
        start = time.perf_counter()
        workers.map(scan, [(cases()[1], chunk, WINDOWS) for chunk in np.array_split(omega, max(1, count // CHUNK))])
        found.append((count, time.perf_counter() - start))
    return found
