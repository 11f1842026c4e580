"""The tables of docs/performance.md, made from a record.

    python benchmark/page.py [FOLDER OF A RECORD]

Without a folder the newest record is taken. Each table of the page is known by its first line. `make bench` calls this.
"""

from __future__ import annotations

import math
import statistics
import sys
from collections.abc import Iterable
from pathlib import Path

from cases import CASES, HERE, ROOT, random_cases
from ratios import LEVELS, RIVAL, curve, time_at
from records import read

PAGE = ROOT / "docs" / "performance.md"

PLACES = {
    "packed FMU": "ours, packed FMU",
    "AVX-512, called from Rust": "ours",
    "AVX2, called from Rust": "ours AVX2",
    "baseline SIMD": "ours baseline SIMD",
    "every period integrated": "ours without orbit reuse",
}
"""Rows of the page and the methods of the record."""

DRIVEN = ("packed FMU", "baseline SIMD")

CALLS = {
    "`fmi2DoStep`": ("unchanged; nothing read", 1e-12),
    "… and `fmi2GetReal`": ("unchanged", 1e-12),
    "… and `fmi2SetReal`, voltage unchanged": ("set to what they are", 1e-12),
    "… and `fmi2SetReal`, voltage changed": ("held", 1e-12),
    "`fmi2SetReal`, voltage changed, and `fmi2DoStep`": ("held; nothing read", 1e-12),
    "… and `fmi2GetReal`, at the tolerance 1e-6": ("held", 1e-6),
}
"""Rows of the page, and inputs and tolerance in the record."""


def newest_record() -> Path:
    """The folder of the newest record."""
    return max((HERE / "records").glob("*/*"), key=lambda folder: folder.name)


def _table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    head, *body = ("| " + " | ".join(line) + " |" for line in (list(heads), *rows))
    return "\n".join([head, "|---" * (head.count("|") - 1) + "|", *body])


def _ratio(rows: list[dict], case: str, method: str, level: float) -> float:
    own, rival = (time_at(curve(rows, case, name), level) for name in (method, RIVAL))
    return rival / own if own and rival else math.nan


def _times(ratio: float) -> str:
    return "–" if math.isnan(ratio) else f"{ratio:.2g}×"


def against_heyoka(rows: list[dict]) -> str:
    """How many times faster than heyoka in the cases, at equal error."""
    heads = [f"{case.title} ({case.name})" for case in CASES]
    return _table(
        ["Error", "Actuator", *heads],
        (
            [f"{level:g}", place, *(_times(_ratio(rows, case.name, method, level)) for case in CASES)]
            for place, method in PLACES.items()
            for level in LEVELS
        ),
    )


def random_sets(rows: list[dict]) -> str:
    """The same on the random sets."""
    names = [case.name for case in random_cases()]

    def cells(method: str, level: float) -> list[str]:
        ratios = [_ratio(rows, name, method, level) for name in names]
        return [*map(_times, ratios), _times(statistics.median(ratios)), _times(min(ratios))]

    return _table(
        ["Error", "Actuator", *names, "median", "least"],
        ([f"{level:g}", place, *cells(PLACES[place], level)] for place in DRIVEN for level in LEVELS),
    )


def many_scenes(rows: list[dict]) -> str:
    """Nanoseconds of a scene in an ensemble and one by one."""
    return _table(
        ["64 scenes of 2000 units of time", "Tolerance", "ns a scene", "Error"],
        (
            [
                f"{row['method']}, {row['inputs']}",
                f"{float(row['tolerance']):g}",
                f"{float(row['nanoseconds']):.3g}",
                f"{float(row['error']):.0e}",
            ]
            for row in rows
        ),
    )


def communication_steps(rows: list[dict]) -> str:
    """Nanoseconds of a communication step of the packed FMU, by its length."""
    lengths = sorted({float(row["step"]) for row in rows})

    def cells(case: str, inputs: str, tolerance: float) -> list[str]:
        found = {
            float(row["step"]): f"{float(row['nanoseconds']):.3g}"
            for row in rows
            if (row["case"], row["method"], row["inputs"]) == (case, "ours", inputs)
            and float(row["tolerance"]) == tolerance
        }
        return [found[length] for length in lengths]

    return _table(
        ["Step", *(f"{length:g}" for length in lengths)],
        (
            [f"{kind}: {call}" if number == 0 else call, *cells(case, inputs, tolerance)]
            for kind, case in (("DC", "a"), ("AC", "d"))
            for number, (call, (inputs, tolerance)) in enumerate(CALLS.items())
        ),
    )


def skipped(rows: list[dict]) -> str:
    """Nanoseconds with something skipped and without."""
    pairs: dict[str, dict[str, dict]] = {}
    for row in rows:
        pairs.setdefault(row["method"], {})[row["inputs"]] = row
    lines = []
    for name, pair in pairs.items():
        fast, slow = (float(pair[kind]["nanoseconds"]) for kind in ("skipped", "not skipped"))
        difference = float(pair["skipped"]["error"])
        lines.append([name, f"{fast:.3g}", f"{slow:.3g}", f"{slow / fast:.2g}×", f"{difference:.0e}"])
    return _table(["Skipped", "ns", "Not skipped, ns", "Gain", "Difference of the results"], lines)


def tables(record: Path) -> list[str]:
    """All tables of the page that the record gives."""
    made = {
        "work_precision.csv": (against_heyoka, random_sets),
        "ensemble.csv": (many_scenes,),
        "co_simulation.csv": (communication_steps,),
        "skips.csv": (skipped,),
    }
    return [table(read(record / name)[1]) for name, makers in made.items() for table in makers]


def renewed(text: str, record: Path) -> str:
    """The page's text with the tables of this record."""
    for table in tables(record):
        head = table.splitlines()[0]
        before, found, rest = text.partition(f"{head}\n")
        if not found:
            raise SystemExit(f"{PAGE.name} has no table that begins with {head}")
        _, blank, after = rest.partition("\n\n")
        text = before + table + blank + after
    return text


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else newest_record()
    PAGE.write_text(renewed(PAGE.read_text(), folder))
