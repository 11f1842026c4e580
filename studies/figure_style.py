"""One look for all figures: the paper's symbols, and colours that survive printing and colour blindness.

Curves differ in colour, in brightness and in line style at once, so that a grey print and a reader who
does not see red from green lose nothing. Colours are those of Okabe and Ito (2008), without the yellow
that vanishes on white paper.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")  # figures are files; no display is needed or opened

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

SYMBOLS = {
    "time": r"$\bar{t}$",
    "lambda": r"$\lambda$",
    "lambda_dot": r"$\mathrm{d}\lambda/\mathrm{d}\bar{t}$",
    "lambda3": r"$\lambda_3$",
    "lambda3_dot": r"$\mathrm{d}\lambda_3/\mathrm{d}\bar{t}$",
    "lambda3_pull_in": r"$\lambda_3^{C}$",
    "phi": r"$\bar{\phi}$",
    "phi_pull_in": r"$\bar{\phi}^{C}$",
    "phi_ac": r"$\bar{\phi}_a$",
    "omega_ac": r"$\bar{\omega}$",
    "S": r"$\bar{S}$",
    "gamma_s": r"$\bar{\gamma}_s$",
    "tau_s": r"$\bar{\tau}_s$",
    "E_s": r"$\bar{E}_s$",
}
"""Symbol of the paper for each variable of the FMU."""

TEXT_SYMBOLS = {
    "time": "t̄",
    "lambda": "λ",
    "lambda3": "λ₃",
    "lambda3_pull_in": "λ₃ᶜ",
    "phi": "φ̄",
    "phi_pull_in": "φ̄ᶜ",
    "phi_ac": "φ̄ₐ",
    "omega_ac": "ω̄",
    "S": "S̄",
    "gamma_s": "γ̄ₛ",
    "tau_s": "τ̄ₛ",
    "E_s": "Ēₛ",
}
"""The same as plain text, for reports."""

SHORT_NAMES = {
    "phi^C": "phi_pull_in",
    "lambda3^C": "lambda3_pull_in",
    "phi_a": "phi_ac",
    "omega": "omega_ac",
    "t": "time",
}
"""Names as the terminal shortens them, for those of the FMU."""


def in_symbols(quantity: str) -> str:
    """What a number is, as the terminal names it, in the symbols of the text."""
    quantity = quantity.replace("lambda3^a", "λ₃ᵃ").replace("lambda3m", "λ₃ₘ")

    def symbol(found: re.Match) -> str:
        name = found.group()
        return TEXT_SYMBOLS.get(SHORT_NAMES.get(name, name), name)

    return re.sub(r"[A-Za-z_]+\d?(?:\^C)?", symbol, quantity)


NAMES = {
    "time": "time",
    "lambda": "stretch",
    "lambda_dot": "stretch rate",
    "lambda3": "thickness stretch",
    "lambda3_dot": "thickness rate",
    "phi": "voltage",
    "gamma_s": "surface energy density",
    "tau_s": "surface tension",
    "E_s": "surface elasticity",
    "S": "prestress",
}
"""What a symbol stands for, in words."""

BLACK = "#000000"
GREY = "#8c8c8c"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
EXACT: dict[str, Any] = {"color": BLACK, "marker": "o", "markersize": 4, "linestyle": "", "zorder": 5}
"""Look of exact values beside computed ones."""
BESIDE = {"loc": "center left", "bbox_to_anchor": (1.01, 0.5)}
"""Where a legend goes that must cover no curve."""
LINE_STYLES = ("-", (0, (5, 1.6)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)), (0, (3, 1, 1, 1, 1, 1)), (0, (8, 3)))


def apply() -> None:
    """Set matplotlib's defaults; call once before the first figure."""
    plt.rcParams.update(
        {
            "figure.dpi": 100,
            "savefig.dpi": 150,
            "figure.constrained_layout.use": True,
            "font.size": 11,
            "axes.titlesize": 11,
            "axes.labelsize": 12,
            "legend.fontsize": 9.5,
            "figure.titlesize": 13,
            "mathtext.fontset": "dejavusans",
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "grid.color": "#e3e3e3",
            "grid.linewidth": 0.6,
            "axes.axisbelow": True,
            "lines.linewidth": 1.6,
            "legend.frameon": True,
            "legend.framealpha": 0.9,
            "legend.edgecolor": "none",
        }
    )


def curve(index: int) -> dict:
    """Colour and line style of the curve at `index` among those compared in one panel."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": LINE_STYLES[index % len(LINE_STYLES)]}


def label(axes: Axes, horizontal: str, vertical: str) -> None:
    """Label both axes with name and symbol of the given variables."""
    axes.set_xlabel(f"{NAMES[horizontal]}  {SYMBOLS[horizontal]}")
    axes.set_ylabel(f"{NAMES[vertical]}  {SYMBOLS[vertical]}")


def setting(**values: float) -> str:
    """Values with the paper's symbols, for titles and legends: ``setting(S=0.5)`` is "S̄ = 0.5"."""
    return ", ".join(f"{SYMBOLS[name]} = {value:g}" for name, value in values.items())


def save(figure: Figure, path: Path) -> Path:
    """Write the figure as PNG, close it, and return the path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path)
    plt.close(figure)
    return path
