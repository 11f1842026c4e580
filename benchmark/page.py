"""The tables of docs/performance.md, made from a record.

    python benchmark/page.py [FOLDER OF A RECORD]

Without a folder each table is made from the newest record that has its numbers. Each table of the page is known by its
first line. `make bench` and `make bench-device` call this.
"""

from __future__ import annotations

import sys
from pathlib import Path

from cases import CASES, HERE, ROOT, random_cases
from ratios import LEVELS, device_table, ensemble_table, markdown, ratio, skip_table, times, with_summary
from records import read

PAGE = ROOT / "docs" / "performance.md"

PLACES = {
    "packed FMU": "ours, packed FMU",
    "widest SIMD, called from Rust": "ours",
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


def newest(name: str, processor: str = "*") -> Path:
    """The file of this name in the newest record that has one, of one processor or of all."""
    return max((HERE / "records").glob(f"{processor}/*/{name}"), key=lambda file: file.parent.name)


def against_heyoka(rows: list[dict]) -> str:
    """How many times faster than heyoka in the cases, at equal error."""
    heads = [f"{case.title} ({case.name})" for case in CASES]
    return markdown(
        ["Error", "Actuator", *heads],
        (
            [f"{level:g}", place, *(times(ratio(rows, case.name, method, level)) for case in CASES)]
            for place, method in PLACES.items()
            for level in LEVELS
        ),
    )


def random_sets(rows: list[dict]) -> str:
    """The same on the random sets."""
    names = [case.name for case in random_cases()]
    lines = []
    for place in DRIVEN:
        for level in LEVELS:
            ratios = [ratio(rows, name, PLACES[place], level) for name in names]
            lines.append([f"{level:g}", place, *with_summary(ratios)])
    return markdown(["Error", "Actuator", *names, "median", "least"], lines)


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

    return markdown(
        ["Step", *(f"{length:g}" for length in lengths)],
        (
            [f"{kind}: {call}" if number == 0 else call, *cells(case, inputs, tolerance)]
            for kind, case in (("DC", "a"), ("AC", "d"))
            for number, (call, (inputs, tolerance)) in enumerate(CALLS.items())
        ),
    )


def processors() -> str:
    """The packed FMU against heyoka, and an ensemble against single scenes, in each processor's newest record."""
    lines = []
    names = ["d", "e", *(case.name for case in random_cases())]
    known = {file.parents[1].name for file in (HERE / "records").glob("*/*/ensemble.csv")}
    for processor in sorted(known, reverse=True):
        record = newest("ensemble.csv", processor).parent
        facts, rows = read(record / "work_precision.csv")
        _, scenes = read(record / "ensemble.csv")
        for level in LEVELS:
            ratios = [ratio(rows, name, PLACES["packed FMU"], level) for name in names]
            many, single = (
                next(
                    float(row["nanoseconds"])
                    for row in scenes
                    if row["method"] == method and float(row["tolerance"]) == level
                )
                for method in ("ours, ensemble", "ours, one by one")
            )
            about = f"{facts['processor']}, {facts['family and model']} ({facts['SIMD'].split()[0]}), {record.name}"
            lines.append(
                [
                    about if level == LEVELS[0] else "",
                    f"{level:g}",
                    *(times(one) for one in ratios[:2]),
                    *with_summary(ratios[2:])[-2:],
                    times(single / many),
                ]
            )
    heads = ["Processor and date", "Error", "d", "e", "random sets, median", "least", "ensemble, × one by one"]
    return markdown(heads, lines)


def tables(record: Path | None) -> list[str]:
    """All tables of the page that the record gives, or the newest ones, and the one of all processors."""
    made = {
        "work_precision.csv": (against_heyoka, random_sets),
        "ensemble.csv": (ensemble_table,),
        "co_simulation.csv": (communication_steps,),
        "skips.csv": (skip_table,),
        "device.csv": (device_table,),
    }
    texts = []
    for name, makers in made.items():
        file = record / name if record else newest(name)
        if file.is_file():
            _, rows = read(file)
            texts += [table(rows) for table in makers]
    return [*texts, processors()]


def renewed(text: str, record: Path | None = None) -> str:
    """The page's text with the tables of this record, or of the newest ones."""
    for table in tables(record):
        head = table.splitlines()[0]
        before, found, rest = text.partition(f"{head}\n")
        if not found:
            raise SystemExit(f"{PAGE.name} has no table that begins with {head}")
        _, blank, after = rest.partition("\n\n")
        text = before + table + blank + after
    return text


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text(), Path(sys.argv[1]) if len(sys.argv) > 1 else None))
