"""Where the figures go: CSV files with a header that tells machine, versions and settings."""

from __future__ import annotations

import csv
import datetime
import os
import platform
import re
import statistics
import subprocess
from collections import defaultdict
from pathlib import Path

from cases import HERE, ROOT

KEYS = ("case", "method", "tolerance", "step", "inputs")


def _processor() -> dict[str, str]:
    fields: dict[str, str] = {}
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.is_file():
        for line in cpuinfo.read_text().splitlines():
            name, _, value = line.partition(":")
            fields.setdefault(name.strip(), value.strip())
    return fields


def _first_line(*command: str) -> str:
    try:
        return subprocess.run(command, capture_output=True, text=True, cwd=ROOT).stdout.splitlines()[0]
    except (OSError, IndexError):
        return "unknown"


def machine() -> dict[str, str]:
    """What tells this machine from another, and its state at the start."""
    processor = _processor()
    flags = processor.get("flags", "").split()
    simd = [name for name in ("avx512f", "avx2", "sse4_2") if name in flags]
    return {
        "processor": processor.get("model name", platform.processor() or platform.machine()),
        "family and model": f"{processor.get('cpu family', '?')}, {processor.get('model', '?')}",
        "SIMD": " ".join(simd) or "unknown",
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "load at the start": " ".join(f"{load:.2f}" for load in os.getloadavg()),
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "commit": _first_line("git", "describe", "--always", "--dirty"),
        "Rust": _first_line("rustc", "--version"),
        "C compiler": _first_line(os.environ.get("CC", "cc"), "--version"),
        "Python": platform.python_version(),
    }


def folder(facts: dict[str, str], base: Path | None = None) -> Path:
    """benchmark/records/<processor>/<date>."""
    name = f"{facts['processor']} family {facts['family and model']}"
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
    path = (base or HERE / "records") / slug / facts["date"][:10]
    path.mkdir(parents=True, exist_ok=True)
    return path


def fastest(rows: list[dict]) -> list[dict]:
    """One row a measurement: the least time over the rounds, their median and the largest.

    Others on a shared machine only ever add time, and by half for minutes."""
    groups: dict[tuple, list[dict]] = defaultdict(list)
    for row in rows:
        groups[tuple(str(row[key]) for key in KEYS)].append(row)
    result = []
    for group in groups.values():
        times = [float(row["nanoseconds"]) for row in group if row["nanoseconds"] not in ("", None)]
        row = {key: group[-1][key] for key in KEYS}
        row["nanoseconds"] = min(times) if times else ""
        row["median"], row["largest"] = (statistics.median(times), max(times)) if times else ("", "")
        row["rounds"] = len(times)
        row.update({key: group[-1][key] for key in ("error", "hold_error", "note")})
        result.append(row)
    return result


def write(path: Path, facts: dict[str, str], rows: list[dict]) -> Path:
    """The rows under lines `# name: value`."""
    with path.open("w", newline="") as file:
        for name, value in facts.items():
            file.write(f"# {name}: {value}\n")
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({name: _short(value) for name, value in row.items()})
    return path


def _short(value):
    return f"{value:.5g}" if isinstance(value, float) else value


def read(path: Path) -> tuple[dict[str, str], list[dict]]:
    """What `write` wrote."""
    lines = path.read_text().splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    return facts, list(csv.DictReader(line for line in lines if not line.startswith("# ")))
