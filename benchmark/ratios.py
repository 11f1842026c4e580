"""Times at equal error, read off the curves, and their ratios to heyoka."""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Iterable

from cases import CASES, DEVICE_SCENES, random_cases

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


def ratio(rows: list[dict], case: str, method: str, level: float) -> float:
    """How many times faster than heyoka a method is at an error; NaN where one of them is never that accurate."""
    own, rival = (time_at(curve(rows, case, name), level) for name in (method, RIVAL))
    return rival / own if own and rival else math.nan


def times(ratio: float) -> str:
    """A ratio as a cell."""
    return "–" if math.isnan(ratio) else f"{ratio:.2g}×"


def with_summary(ratios: list[float]) -> list[str]:
    """Ratios as cells, and the median and the least of those that are known."""
    known = [ratio for ratio in ratios if not math.isnan(ratio)] or [math.nan]
    return [times(ratio) for ratio in (*ratios, statistics.median(known), min(known))]


def markdown(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table of these cells."""
    head, *body = ("| " + " | ".join(line) + " |" for line in (list(heads), *rows))
    return "\n".join([head, "|---" * (head.count("|") - 1) + "|", *body])


def device_table(rows: list[dict]) -> str:
    """Markdown: milliseconds of a run of the real device at equal error, one row a scene and error."""
    names = methods(rows)
    lines = []
    for letter, (scene, (_, title)) in zip("abcde", DEVICE_SCENES.items()):
        for level in LEVELS:
            found = (time_at(curve(rows, scene, method), level) for method in names)
            cells = ("–" if nanoseconds is None else f"{1e-6 * nanoseconds:.3g}" for nanoseconds in found)
            lines.append([f"{title} ({letter})" if level == LEVELS[0] else "", f"{level:g}", *cells])
    return markdown(["Scene", "Error", *names], lines)


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
    lines = []
    for method in methods(rows):
        for level in LEVELS:
            ratios = [ratio(rows, name, method, level) for name in names]
            if method != RIVAL and not all(map(math.isnan, ratios)):
                lines.append([f"{method}, {level:g}", *with_summary(ratios)])
    table = markdown(["method, error", *names, "median", "least"], lines)
    return f"Random sets: how many times faster than heyoka at equal error.\n\n{table}\n"


def ensemble_table(rows: list[dict]) -> str:
    """Markdown: nanoseconds for each scene, scenes in a second on one core, and the error."""
    lines = []
    for row in rows:
        if row["nanoseconds"] in ("", None):
            continue
        nanoseconds, error = float(row["nanoseconds"]), float(row["error"])
        about = [f"{row['method']}, {row['inputs']}", f"{float(row['tolerance']):g}"]
        lines.append([*about, f"{nanoseconds:.3g}", f"{1e9 / nanoseconds:.3g}", f"{error:.0e}"])
    heads = ["64 scenes of 2000 units of time", "Tolerance", "ns a scene", "Scenes a second", "Error"]
    return markdown(heads, lines)


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
    lines = []
    for name in methods(rows):
        pair = {row["inputs"]: row for row in rows if row["method"] == name}
        fast, slow = (float(pair[kind]["nanoseconds"]) for kind in ("skipped", "not skipped"))
        difference = float(pair["skipped"]["error"])
        lines.append([name, f"{fast:.3g}", f"{slow:.3g}", f"{slow / fast:.2g}×", f"{difference:.0e}"])
    return markdown(["Skipped", "ns", "Not skipped, ns", "Gain", "Difference of the results"], lines)


def _cell(row: dict | None) -> str:
    if row is None or row["nanoseconds"] in ("", None):
        return "–"
    error = f" ({float(row['error']):.0e})" if row["error"] not in ("", None) else ""
    return f"{float(row['nanoseconds']):.3g}{error}"
