"""Times at equal error, read off the curves, and their ratios to heyoka."""

from __future__ import annotations

import itertools
import math
import statistics

from cases import CASES, random_cases

LEVELS = (1e-6, 1e-9, 1e-12)
RIVAL = "heyoka"
FLOOR = 1e-17
"""An error of 0 is drawn and interpolated as this."""


def curve(rows: list[dict], case: str, method: str) -> list[tuple[float, float]]:
    """(error, nanoseconds) of a method, sorted by error, without what is both slower and less accurate."""
    points = [
        (max(float(row["error"]), FLOOR), float(row["nanoseconds"]))
        for row in rows
        if row["case"] == case and row["method"] == method and row["nanoseconds"] not in ("", None)
    ]
    front: list[tuple[float, float]] = []
    for error, nanoseconds in sorted(points):
        if not front or nanoseconds < front[-1][1]:
            front.append((error, nanoseconds))
    return front


def time_at(front: list[tuple[float, float]], error: float) -> float | None:
    """Nanoseconds at an error, on straight lines in the logarithms; None where the method is never that
    accurate. A method that is always more accurate is taken at its fastest."""
    if not front or front[0][0] > error:
        return None
    for (e0, t0), (e1, t1) in itertools.pairwise(front):
        if e0 <= error < e1:
            part = math.log(error / e0) / math.log(e1 / e0)
            return t0 * (t1 / t0) ** part
    return front[-1][1]


def methods(rows: list[dict]) -> list[str]:
    return list(dict.fromkeys(row["method"] for row in rows))


def table(rows: list[dict]) -> str:
    """Markdown: for each error, ns per unit of time, and in brackets how often heyoka's time fits into it
    or, above 1, how many times faster than heyoka."""
    blocks = []
    names = [case.name for case in CASES]
    for level in LEVELS:
        lines = [f"| error {level:g} | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
        for method in methods(rows):
            cells = []
            for case in names:
                own = time_at(curve(rows, case, method), level)
                rival = time_at(curve(rows, case, RIVAL), level)
                if own is None:
                    cells.append("–")
                elif rival is None:
                    cells.append(f"{own:.3g}")
                else:
                    cells.append(f"{own:.3g} ({rival / own:.2g}×)")
            if any(cell != "–" for cell in cells):
                lines.append(f"| {method} | " + " | ".join(cells) + " |")
        blocks.append("\n".join(lines))
    note = (
        "Nanoseconds for each unit of time at equal error; in brackets how many times faster than heyoka. "
        "Interpolated on the log-log curves; – where a method is never that accurate or was lost."
    )
    return note + "\n\n" + "\n\n".join(blocks) + "\n"


def random_table(rows: list[dict]) -> str:
    """Markdown: on each random set, how many times faster than heyoka at equal error; with the median and
    the least over the sets."""
    timed = {row["case"] for row in rows}
    names = [case.name for case in random_cases() if case.name in timed]
    if not names:
        return ""
    heads = [*names, "median", "least"]
    lines = ["| method, error | " + " | ".join(heads) + " |", "|---" * (len(heads) + 1) + "|"]
    for method in methods(rows):
        for level in LEVELS:
            ratios = []
            for name in names:
                own = time_at(curve(rows, name, method), level)
                rival = time_at(curve(rows, name, RIVAL), level)
                ratios.append(rival / own if own and rival else math.nan)
            known = [ratio for ratio in ratios if not math.isnan(ratio)]
            if not known or method == RIVAL:
                continue
            shown = [*ratios, statistics.median(known), min(known)]
            cells = ["–" if math.isnan(ratio) else f"{ratio:.2g}×" for ratio in shown]
            lines.append(f"| {method}, {level:g} | " + " | ".join(cells) + " |")
    return "Random sets: how many times faster than heyoka at equal error.\n\n" + "\n".join(lines) + "\n"


def ensemble_table(rows: list[dict]) -> str:
    """Markdown: nanoseconds for each scene, scenes in a second on one core, and the error."""
    lines = ["| many scenes, 2000 units of time each | tolerance | ns a scene | scenes a second | error |"]
    lines.append("|---|---|---|---|---|")
    for row in rows:
        nanoseconds = float(row["nanoseconds"])
        about = f"{row['method']}, {row['inputs']} | {float(row['tolerance']):g}"
        lines.append(f"| {about} | {nanoseconds:.3g} | {1e9 / nanoseconds:.3g} | {float(row['error']):.0e} |")
    return "One core.\n\n" + "\n".join(lines) + "\n"


def step_table(rows: list[dict]) -> str:
    """Markdown: nanoseconds a call and error, one row a method and kind of input, one column a step."""
    blocks = []
    for case in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == case]
        steps = sorted({float(row["step"]) for row in own})
        lines = [f"| case {case}, step | " + " | ".join(f"{step:g}" for step in steps) + " |"]
        lines.append("|---" * (len(steps) + 1) + "|")
        kinds = dict.fromkeys((row["method"], row["inputs"], float(row["tolerance"])) for row in own)
        for method, inputs, tolerance in kinds:
            found = {
                float(row["step"]): row
                for row in own
                if (row["method"], row["inputs"], float(row["tolerance"])) == (method, inputs, tolerance)
            }
            cells = [_cell(found.get(step)) for step in steps]
            lines.append(f"| {method}, inputs {inputs}, tolerance {tolerance:g} | " + " | ".join(cells) + " |")
        blocks.append("\n".join(lines))
    return "Nanoseconds for each call, with the error in brackets.\n\n" + "\n\n".join(blocks) + "\n"


def skip_table(rows: list[dict]) -> str:
    """Markdown: what is skipped, nanoseconds with and without, and how much the result differs."""
    lines = ["| skipped | ns | not skipped, ns | gain | difference |", "|---|---|---|---|---|"]
    for name in methods(rows):
        pair = {row["inputs"]: row for row in rows if row["method"] == name}
        fast, slow = (float(pair[kind]["nanoseconds"]) for kind in ("skipped", "not skipped"))
        difference = float(pair["skipped"]["error"])
        lines.append(f"| {name} | {fast:.3g} | {slow:.3g} | {slow / fast:.2g}× | {difference:.0e} |")
    return "For each unit of time, call or scene.\n\n" + "\n".join(lines) + "\n"


def _cell(row: dict | None) -> str:
    if row is None or row["nanoseconds"] in ("", None):
        return "–"
    error = f" ({float(row['error']):.0e})" if row["error"] not in ("", None) else ""
    return f"{float(row['nanoseconds']):.3g}{error}"
