"""Beyond the paper: escape of the ideal actuator under the harmonic drive, and the edge of its basin."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import figure_style as style
from dielectric_actuator import Actuator
from paper.entries import Claim, Columns, Entry, Grid, stack
from paper.equation import threshold
from paper.maps import CMAP, IDEAL, NO_MAP, TOLERANCE
from paper.workers import Workers

SPAN = 1000.0
"""About 40 natural periods."""
WINDOWS = (((0.02, 0.35), (0.4, 1.0)), ((0.085, 0.115), (0.45, 0.75)), ((0.093, 0.0985), (0.485, 0.53)))
"""ω and φ_a of the map and of two zooms into its edge."""
LIMITS = {"lambda_max": 1e4, "lambda_min": 1e-3}
"""So wide that only an escape reaches them: under an alternating voltage a motion can come back from λ = 10."""
SLOW_ESCAPE = {"tau_s": 0.02, "phi_ac": 0.3, "omega_ac": 0.117, **LIMITS}
"""Escapes at the paper's amplitude, though at none of its parameter sets."""


def escape_row(actuator: Actuator, item: tuple[float, np.ndarray]) -> np.ndarray:
    """For one φ_a and each ω the instant of escape of the ideal actuator, +inf if not within `SPAN`."""
    phi_ac, omegas = item
    found = np.empty(len(omegas))
    for index, omega in enumerate(omegas):
        actuator.start({"phi_ac": phi_ac, "omega_ac": omega, **LIMITS}, tolerance=TOLERANCE)
        actuator.advance(SPAN)
        found[index] = actuator.get("pull_in_time")
    return found


def uncertain(actuator: Actuator, item: tuple[float, np.ndarray]) -> float:
    """Share of the places (ω, φ_a) whose fate differs from that of the place `distance` further in φ_a."""
    distance, places = item
    differing = 0
    for omega, phi_ac in places:
        fates = [np.isfinite(escape_row(actuator, (phi, np.array([omega])))[0]) for phi in (phi_ac, phi_ac + distance)]
        differing += fates[0] != fates[1]
    return differing / len(places)


def escape_map(workers: Workers, cells: int, pairs: int) -> Entry:
    """Escape of the ideal actuator under the harmonic drive, and how its edge scales."""
    figure, quarters = plt.subplots(2, 2, figsize=(12.5, 10))
    panels = quarters.ravel()
    columns: dict[str, list] = {}
    lowest = np.inf
    meshes = [(np.linspace(*across, cells), np.linspace(*up, cells)) for across, up in WINDOWS]
    maps = [np.array(workers.map(escape_row, [(phi, omegas) for phi in voltages])) for omegas, voltages in meshes]
    instants = np.concatenate([found[np.isfinite(found)] for found in maps])
    first, last = instants.min(), instants.max()
    norm = LogNorm(first, last)
    for letter, axes, (omegas, voltages), found in zip("abc", panels, meshes, maps):
        lowest = min(lowest, voltages[np.isfinite(found).any(axis=1)].min(initial=np.inf))
        shown = axes.pcolormesh(
            omegas,
            voltages,
            np.where(np.isfinite(found), found, np.nan),
            norm=norm,
            cmap=CMAP,
            rasterized=True,
        )
        axes.set_facecolor(NO_MAP)
        axes.grid(False)
        axes.set_title(f"({letter})", loc="left")
        axes.set(
            xlabel=f"angular frequency  {style.SYMBOLS['omega_ac']}", ylabel=f"amplitude  {style.SYMBOLS['phi_ac']}"
        )
        axes.locator_params(axis="x", nbins=5)
        mesh_phi, mesh_omega = np.meshgrid(voltages, omegas, indexing="ij")
        further: Columns = {"window": [letter] * found.size, "omega": mesh_omega.ravel(), "phi_ac": mesh_phi.ravel()}
        columns = stack(columns, {**further, "pull_in_time": found.ravel()})
    for axes, ((left, right), (bottom, top)) in zip(panels, WINDOWS[1:]):
        corners = ((left, right, right, left, left), (bottom, bottom, top, top, bottom))
        axes.plot(*corners, color=style.COLOURS[1], linewidth=1.6)
    bar = figure.colorbar(shown, ax=panels, label=r"instant of escape  $\bar{t}$", location="right", aspect=45)
    ticks = [instant for instant in (20, 50, 100, 200, 500) if first <= instant <= last]
    bar.ax.yaxis.set_ticks(ticks, labels=[str(instant) for instant in ticks])
    bar.ax.yaxis.set_ticks((), minor=True)

    (left, right), (bottom, top) = WINDOWS[1]
    places = np.random.default_rng(1).uniform((left, bottom), (right, top), (pairs, 2))
    distances = 10.0 ** -np.arange(2, 8)
    tasks = [(distance, chunk) for distance in distances for chunk in np.array_split(places, 20)]
    shares = np.array(workers.map(uncertain, tasks)).reshape(len(distances), -1).mean(axis=1)
    seen = shares > 0
    exponent = np.polyfit(np.log(distances[seen]), np.log(shares[seen]), 1)[0] if seen.sum() > 1 else np.nan
    axes = panels[3]
    axes.loglog(distances[seen], shares[seen], "o-", color=style.COLOURS[0], label=f"slope {exponent:.2f}")
    axes.loglog(distances, shares[0] * distances / distances[0], ":", color=style.GREY, label="slope 1: smooth edge")
    axes.set(xlabel=r"distance in  $\bar{\phi}_a$", ylabel="share of pairs with different fates")
    axes.set_title("(d)  in window (b)", loc="left")
    axes.legend()
    figure.suptitle(
        rf"Escape of the ideal actuator from rest under $\bar\phi_a\,\sin\,\bar\omega\bar t$, "
        rf"{style.SYMBOLS['time']} $\leq$ {SPAN:g} (pale: no escape)"
    )
    workers.actuator.start(SLOW_ESCAPE, tolerance=1e-12)
    workers.actuator.advance(1500.0)
    late = workers.actuator.get("pull_in_time")
    edge = (
        f"is fractal: the share of places whose fate changes within a distance ε falls like ε^{exponent:.2f}, slower "
        "than the ε of a smooth edge. There, whether the actuator survives cannot be told from amplitude and "
        "frequency to any practical precision."
        if exponent < 0.9
        else f"shows no fractal scaling here: the share of places whose fate changes falls like ε^{exponent:.2f}."
    )
    return Entry(
        "map_escape",
        "Escape under the harmonic drive",
        figure,
        columns,
        grids=[
            Grid(
                "Pairs of places with different fates, window (b)",
                ["distance in φ̄ₐ", "share"],
                [[f"{d:.0e}", f"{s:.2e}"] for d, s in zip(distances, shares)],
            )
        ],
        claims=[
            Claim(
                "Under AC voltage all responses remain bounded.",
                None,
                "Holds for the parameter sets of the paper. Without surface elasticity and at higher amplitudes the "
                f"actuator escapes, near the harmonic resonance from φ̄ₐ = {lowest:.2f} on (ideal actuator, t̄ ≤ "
                f"{SPAN:g}), below the DC threshold of {threshold(IDEAL).phi:.3f}. With a little surface tension the "
                "paper's own amplitude is enough: γ̄ₛ = Ēₛ = 0, τ̄ₛ = 0.02, φ̄ₐ = 0.3, ω̄ = 0.117 escapes at "
                f"t̄ = {late:.2f}.",
            )
        ],
        remarks=[
            f"{3 * cells * cells} runs of t̄ ≤ {SPAN:g}, one communication step each; λ = 1e4 counts as escape. Panels "
            "(b) and (c) are the frames drawn in (a) and (b).",
            f"The edge {edge}",
        ],
    )
