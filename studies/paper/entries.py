"""What a topic hands to the report: a drawing, the numbers behind it, and what there is to say about it."""

from __future__ import annotations

import csv
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

import figure_style as style
from comparison import Row

Columns = Mapping[str, Sequence[Any] | np.ndarray]


@dataclass(frozen=True)
class Grid:
    """A table for people: heading of each column, and cells already formatted."""

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and what became of it. `holds` is None where it holds in part."""

    statement: str
    holds: bool | None
    finding: str


@dataclass
class Entry:
    """One figure or table of the paper, or one of ours.

    `columns` are the numbers behind the drawing, all of one length, as they go into the CSV. `rows` set paper,
    exact value and FMU side by side. `claims` are statements of the paper that this entry decides, `remarks` what
    else there is to say: what was chosen where the paper is silent, how a number was obtained.
    """

    key: str
    title: str
    figure: Figure
    columns: Columns
    rows: list[Row] = field(default_factory=list)
    grids: list[Grid] = field(default_factory=list)
    claims: list[Claim] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    def write(self, folder: Path) -> None:
        """Write ``<key>.png`` and ``<key>.csv``; the figure is closed."""
        style.save(self.figure, folder / f"{self.key}.png")
        with (folder / f"{self.key}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.columns)
            writer.writerows(zip(*(map(_exactly, column) for column in self.columns.values()), strict=True))


def _exactly(value) -> str:
    """Every digit of a number; the shortest text that reads back the same."""
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


def long_format(pieces: Iterable[tuple[Mapping[str, object], np.ndarray]], names: Sequence[str]) -> dict[str, list]:
    """Responses of several runs as one set of columns: what tells the runs apart, then the fields `names`."""
    columns: dict[str, list] = {}
    for labels, response in pieces:
        for name, value in labels.items():
            columns.setdefault(name, []).extend([value] * len(response))
        for name in names:
            columns.setdefault(name, []).extend(response[name].tolist())
    return columns


def stack(columns: Columns, further: Columns) -> dict[str, list]:
    """The rows of `further` under those of `columns`, which has the same names."""
    return (
        {name: [*columns[name], *further[name]] for name in columns}
        if columns
        else {name: list(column) for name, column in further.items()}
    )


def draw_table(
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    title: str,
    marked: Collection[tuple[int, int]] = (),
    meaning: str,
) -> Figure:
    """A table as a figure. `marked` cells, (row, column) counted from 0, are drawn in bold on a tint; `meaning`
    says below the table what that is."""
    widths = [max(len(_plain(cell)) for cell in column) + 2 for column in zip(header, *rows)]
    figure, axes = plt.subplots(figsize=(0.098 * sum(widths) + 0.4, 0.3 * (len(rows) + 1) + 0.6))
    axes.axis("off")
    axes.set_title(title, loc="left", fontsize=12)
    table = axes.table(
        cellText=[[str(cell).replace("-", "\u2212") if cell[:1] in "+-" else cell for cell in row] for row in rows],
        colLabels=header,
        colWidths=[width / sum(widths) for width in widths],
        cellLoc="right",
        bbox=Bbox.unit(),
    )
    table.auto_set_font_size(False)
    table.set_fontsize(10)
    for (row, column), cell in table.get_celld().items():
        cell.set_edgecolor("#c8c8c8")
        cell.set_linewidth(0.5)
        if row == 0:
            cell.set_facecolor("#eef2f6")
            cell.set_text_props(weight="bold")
        elif (row - 1, column) in marked:
            cell.set_facecolor("#fde9d9")
            cell.set_text_props(weight="bold")
    if marked:
        axes.text(0, -0.02, f"bold on orange: {meaning}", transform=axes.transAxes, va="top", fontsize=9)
    return figure


def _plain(text: str) -> str:
    """About what a text with mathematics takes on paper: each command one letter."""
    return re.sub(r"\\bar|[${}_^ ]", "", re.sub(r"\\(?!bar)[a-z]+", "x", text)) if "$" in text else text
