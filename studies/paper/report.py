"""The report: one HTML page that needs no other file."""

from __future__ import annotations

import base64
import re
import unicodedata
from dataclasses import dataclass, field
from html import escape
from io import BytesIO
from pathlib import Path

from PIL import Image

import figure_style as style
from comparison import Row
from paper.entries import Claim, Entry, Grid

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1c1c1c; }
body { max-width: 72rem; margin: 0 auto; padding: 1rem 1.5rem 4rem; }
h1 { line-height: 1.2; } h2 { margin-top: 3rem; border-top: 1px solid #d5d5d5; padding-top: 1.2rem; }
img { max-width: 100%; height: auto; }
nav { columns: 18rem; font-size: .92rem; } nav ul { margin: 0; padding-left: 1.1rem; }
table { border-collapse: collapse; font-size: .86rem; margin: .6rem 0 1.2rem; }
th, td { border: 1px solid #d5d5d5; padding: .2rem .55rem; text-align: right; font-variant-numeric: tabular-nums; }
th { background: #eef2f6; } td:first-child, th:first-child { text-align: left; }
table.claims th, table.claims td { text-align: left; vertical-align: top; }
.bar { text-decoration: overline; } .wide { overflow-x: auto; }
td.yes { background: #e3f1ea; } td.no { background: #fde9d9; } td.part { background: #fbf4d6; }
td.yes::before { content: "✓ "; } td.no::before { content: "✗ "; } td.part::before { content: "≈ "; }
.note { color: #555; font-size: .9rem; } summary { cursor: pointer; color: #0b5394; } .off { background: #fde9d9; }
"""

_FOLDED_FROM = 14
"""Longer tables are folded."""


@dataclass
class Facts:
    """How the report came about: each a label and its text."""

    lines: list[tuple[str, str]] = field(default_factory=list)


def write(path: Path, entries: list[Entry], slips: list[Claim], facts: Facts) -> None:
    """Write the page; the PNGs of `entries` must already stand beside it."""
    body = [
        "<h1>Nonlinear dynamics of miniaturized dielectric elastomer actuators with surface effects, through the "
        "FMU</h1>",
        "<p>Every figure and table of A. P. Singh, G. Shmuel and A. K. Sharma's paper of that title, computed with "
        "the packed FMU and set beside exact values. <em>Exact</em> means: found another way than by the FMU – "
        "multiprecision roots and quadrature (tests/reference), or SciPy's DOP853 on Eq. 16 as printed. Fig. 1 is a "
        "drawing and has no numbers.</p>",
        _facts(facts),
        "<h2 id='claims'>What holds and what does not</h2>",
        _tally([claim for entry in entries for claim in entry.claims]),
        _claims([(claim, entry.key) for entry in entries for claim in entry.claims]),
        "<h2 id='slips'>Slips in the text</h2>",
        _claims([(claim, None) for claim in slips]),
        "<h2>Contents</h2>",
        "<nav><ul>" + "".join(f"<li><a href='#{e.key}'>{escape(e.title)}</a></li>" for e in entries) + "</ul></nav>",
        *(_section(entry, path.parent) for entry in entries),
    ]
    head = f"<meta charset='utf-8'><title>The paper through the FMU</title><style>{_STYLE}</style>"
    page = f"<!doctype html><html lang='en'><head>{head}</head><body>{''.join(body)}</body></html>\n"
    path.write_text(page, encoding="utf-8")


def _facts(facts: Facts) -> str:
    rows = "".join(f"<tr><th>{escape(label)}</th><td>{escape(text)}</td></tr>" for label, text in facts.lines)
    return f"<table class='claims'>{rows}</table>"


def _text(text: str) -> str:
    """A text for the page; a bar over a letter is drawn by the browser, since many a font sets it beside."""
    decomposed = unicodedata.normalize("NFD", escape(text))
    barred = re.sub("(.)\u0304", r"<span class='bar'>\1</span>", decomposed)
    return unicodedata.normalize("NFC", barred)


def _tally(claims: list[Claim]) -> str:
    counts = {verdict: sum(claim.holds is verdict for claim in claims) for verdict in (True, None, False)}
    return (
        f"<p><strong>Of {len(claims)} statements of the paper {counts[True]} hold, {counts[None]} hold in part, and "
        f"{counts[False]} do not.</strong></p>"
    )


def _claims(claims: list[tuple[Claim, str | None]]) -> str:
    looks = {True: ("yes", "holds"), False: ("no", "does not hold"), None: ("part", "in part")}
    rows = []
    for claim, key in claims:
        look, word = looks[claim.holds]
        where = f" <a href='#{key}'>evidence</a>" if key else ""
        rows.append(
            f"<tr><td>{_text(claim.statement)}</td><td "
            f"class='{look}'>{word}</td><td>{_text(claim.finding)}{where}</td></tr>"
        )
    header = "<tr><th>The paper</th><th>Verdict</th><th>Found</th></tr>"
    return f"<div class='wide'><table class='claims'>{header}{''.join(rows)}</table></div>"


def _section(entry: Entry, folder: Path) -> str:
    picture = base64.b64encode(_small(folder / f"{entry.key}.png")).decode()
    parts = [
        f"<h2 id='{entry.key}'>{_text(entry.title)}</h2>",
        f"<img alt='{escape(entry.title, quote=True)}' src='data:image/png;base64,{picture}'>",
        f"<p class='note'>Numbers: <a href='{entry.key}.csv'>{entry.key}.csv</a></p>",
    ]
    if entry.claims:
        parts.append(_claims([(claim, None) for claim in entry.claims]))
    if entry.remarks:
        parts.append("<ul>" + "".join(f"<li>{_text(remark)}</li>" for remark in entry.remarks) + "</ul>")
    if entry.rows:
        parts.append(_comparison(entry.rows))
    parts += [_grid(grid) for grid in entry.grids]
    return "".join(parts)


def _small(path: Path) -> bytes:
    """The PNG; a big one, which is one of many lines and few colours, in 256 colours and a third of its size."""
    if path.stat().st_size < 500_000:
        return path.read_bytes()
    with Image.open(path) as picture:
        return _reduced(picture)


def gallery(folder: Path, keys: list[str], target: Path) -> None:
    """Copies of figures for a page: 1000 pixels wide, 256 colours."""
    target.mkdir(parents=True, exist_ok=True)
    for key in keys:
        with Image.open(folder / f"{key}.png") as picture:
            scaled = picture.convert("RGB").resize((1000, round(1000 * picture.height / picture.width)))
        (target / f"paper_{key}.png").write_bytes(_reduced(scaled))


def _reduced(picture: Image.Image) -> bytes:
    reduced = BytesIO()
    # this method keeps the few pixels of a saturated colour that a thin line has
    few = picture.convert("RGB").quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(reduced, "PNG", optimize=True)
    return reduced.getvalue()


def _comparison(rows: list[Row]) -> str:
    cells = [
        "<tr><td>{}</td><td{}>{}</td><td>{:.12g}</td><td>{:.12g}</td><td>{:+.1e}</td></tr>".format(
            _text(style.in_symbols(row.quantity)),
            " class='off'" if row.misprinted else "",
            row.printed or "–",
            row.exact,
            row.measured,
            row.difference,
        )
        for row in rows
    ]
    worst = max(abs(row.difference) for row in rows)
    header = "<tr><th></th><th>paper</th><th>exact</th><th>FMU</th><th>FMU − exact</th></tr>"
    table = f"<div class='wide'><table>{header}{''.join(cells)}</table></div>"
    return _folded(f"Paper, exact value and FMU: {len(rows)} numbers, worst difference {worst:.1e}", table, len(rows))


def _grid(grid: Grid) -> str:
    header = "".join(f"<th>{_text(_plain(cell))}</th>" for cell in grid.header)
    rows = ["".join(f"<td>{_text(_plain(cell))}</td>" for cell in row) for row in grid.rows]
    table = f"<div class='wide'><table><tr>{header}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table></div>"
    return _folded(grid.caption, table, len(rows))


def _folded(caption: str, table: str, length: int) -> str:
    opened = " open" if length < _FOLDED_FROM else ""
    return f"<details{opened}><summary>{_text(caption)}</summary>{table}</details>"


def _plain(cell: str) -> str:
    """The symbols of figures as text."""
    for name, symbol in style.SYMBOLS.items():
        if name in style.TEXT_SYMBOLS:
            cell = cell.replace(symbol, style.TEXT_SYMBOLS[name])
    cell = cell.replace(r"$\lambda_3^a$", "λ₃ᵃ").replace("$-$", "−")
    assert not re.search(r"\$.*\\", cell), f"no plain text for {cell}"
    return cell
