"""Run time against error of the actuator and its rivals: the command behind `make bench`.

    python benchmark/bench.py PROGRAM [--rounds 5] [--milliseconds 10] [--cases a,d,r1] [--records FOLDER]

PROGRAM is the Rust side as make builds it. Each round goes through cases and methods in turn, so that a
change of the machine's speed meets all of them; the fastest round counts. Each answer is held
against the reference before it is timed.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import page
import plots
import ratios
import records
from cases import ALL_CASES, CASES, ROOT
from programs import C_FLAGS, Missing, cvode, rust

SKIPS_CASE = "d"
"""The actuator on which it is shown what skipping gains."""

FIGURES = ROOT / "docs" / "figures"
FMU = ROOT / "target" / "fmu" / "DielectricElastomerActuator.fmu"


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--fmu", type=Path, default=FMU, help="the packed FMU")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--milliseconds", type=int, default=10, help="least time of a measurement")
    parser.add_argument("--scipy-rounds", type=int, default=1)
    parser.add_argument("--van-der-pol", type=Path, help="shared library of the Reference FMU VanDerPol")
    parser.add_argument("--cases", default=",".join(case.name for case in ALL_CASES))
    parser.add_argument("--records", type=Path, help="folder instead of benchmark/records; docs/performance.md stays")
    parser.add_argument("--figures", type=Path, default=FIGURES)
    return parser.parse_args()


class Rivals:
    """What is there, and what is missing and why."""

    def __init__(self, program: Path, fmu: Path, folder: Path, van_der_pol: Path | None):
        self.programs = [rust(program, fmu, folder)]
        self.versions = {"Rust rivals": self.programs[0].version}
        self.missing: dict[str, str] = {}
        self.heyoka = self.scipy = None
        try:
            found = cvode(folder)
            self.programs.append(found)
            self.versions["SUNDIALS"] = found.version
        except Missing as reason:
            self.missing["SUNDIALS CVODE"] = str(reason)
        self.van_der_pol = van_der_pol
        if van_der_pol is None:
            self.missing["Reference FMU VanDerPol"] = "name its shared library with --van-der-pol"
        try:
            from python_rivals import Heyoka

            self.heyoka = Heyoka()
            self.versions["heyoka"] = self.heyoka.version
        except ImportError as reason:
            self.missing["heyoka"] = str(reason)
        try:
            import scipy

            from python_rivals import scipy_free

            self.scipy = scipy_free
            self.versions["SciPy"] = scipy.__version__
        except ImportError as reason:
            self.missing["SciPy"] = str(reason)

    def free(self, case, options, number: int):
        """All methods once, free-running."""
        for program in self.programs:
            yield from program.rows("free", case, options.milliseconds)
        if self.heyoka:
            yield from self.heyoka.free(case, 1e-3 * options.milliseconds)
        if self.scipy and number <= options.scipy_rounds and case in CASES:
            yield from self.scipy(case)

    def steps(self, case, options):
        """All methods once, in communication steps."""
        for program in self.programs:
            yield from program.rows("steps", case, options.milliseconds)
        if self.van_der_pol:
            library = f"library={self.van_der_pol}"
            yield from self.programs[0].rows("van_der_pol", case, options.milliseconds, library)
        if self.heyoka:
            yield from self.heyoka.steps(case, 1e-3 * options.milliseconds)

    def ensembles(self, case, options):
        """Many scenes at once, and one by one."""
        yield from self.programs[0].rows("ensemble", case, options.milliseconds)
        if self.heyoka:
            yield from self.heyoka.ensemble(case, 1e-3 * options.milliseconds)


def settings(options, rivals: Rivals) -> dict[str, str]:
    compiled = rivals.heyoka.compile_seconds if rivals.heyoka else []
    return {
        "rounds": f"{options.rounds}, SciPy {options.scipy_rounds}; methods in turn in each, the fastest counts",
        "least time of a measurement": f"{options.milliseconds} ms",
        "error": "largest of stretch and rate at the times of the reference",
        "Rust side": "opt-level 3, lto fat, codegen-units 1; no target-cpu beyond the environment's RUSTFLAGS",
        "communication steps": "the binary of the packed FMU",
        "C side": " ".join(C_FLAGS),
        "heyoka compiles": (
            f"{min(compiled):.2f} to {max(compiled):.2f} s each, not counted; time of an idle call taken off"
            if compiled
            else "-"
        ),
        **rivals.versions,
        "missing": "; ".join(f"{name}: {reason}" for name, reason in rivals.missing.items()) or "none",
    }


def measure(options, rivals: Rivals) -> tuple[list[dict], list[dict], list[dict], list[dict]]:
    """Raw rows: free-running, in communication steps, with something skipped or not, many scenes."""
    free, steps, skips, ensembles = [], [], [], []
    names = options.cases.split(",")
    cases = [case for case in ALL_CASES if case.name in names]
    for number in range(1, options.rounds + 1):
        for case in cases:
            print(f"round {number} of {options.rounds}, case {case.name}", flush=True)
            about = {"round": number, "case": case.name}
            free += [{**about, **row} for row in rivals.free(case, options, number)]
            if case.stepped:
                steps += [{**about, **row} for row in rivals.steps(case, options)]
            if case.name == SKIPS_CASE:
                rows = rivals.programs[0].rows("skips", case, options.milliseconds)
                skips += [{**about, **row} for row in rows]
                ensembles += [{**about, **row} for row in rivals.ensembles(case, options)]
    return free, steps, skips, ensembles


def main() -> None:
    options = arguments()
    if unknown := {*options.cases.split(",")} - {case.name for case in ALL_CASES}:
        raise SystemExit(f"there is no case {', '.join(sorted(unknown))}")
    whole = options.cases == ",".join(case.name for case in ALL_CASES)
    if not whole and (options.records is None or options.figures == FIGURES):
        raise SystemExit("a part of the cases does not make the record: name other places with --records and --figures")
    with tempfile.TemporaryDirectory() as folder:
        rivals = Rivals(options.program, options.fmu, Path(folder), options.van_der_pol)
        for name, reason in rivals.missing.items():
            print(f"missing: {name}: {reason}")
        if whole and rivals.heyoka is None and options.records is None:
            raise SystemExit("without heyoka there is no record: name another folder with --records")
        facts = records.machine()
        free, steps, skips, ensembles = measure(options, rivals)
    facts |= settings(options, rivals)
    for row in free + steps:
        if row["method"].startswith("ours") and row["note"].startswith("not timed"):
            raise SystemExit(f"case {row['case']}, {row['method']}, tolerance {row['tolerance']}: {row['note']}")

    target = records.folder(facts, options.records)
    best_free, best_steps = records.fastest(free), records.fastest(steps)
    written = [
        records.write(target / "work_precision_raw.csv", facts, free),
        records.write(target / "work_precision.csv", facts, best_free),
    ]
    text = ratios.table(best_free) + "\n" + ratios.random_table(best_free)
    written.append(plots.work_precision(best_free, options.figures / "benchmark_work_precision.png"))
    if steps:
        written.append(records.write(target / "co_simulation_raw.csv", facts, steps))
        written.append(records.write(target / "co_simulation.csv", facts, best_steps))
        written.append(plots.co_simulation(best_steps, options.figures / "benchmark_co_simulation.png"))
        text += "\n" + ratios.step_table(best_steps)
    if skips:
        best_skips = records.fastest(skips)
        written.append(records.write(target / "skips_raw.csv", facts, skips))
        written.append(records.write(target / "skips.csv", facts, best_skips))
        text += f"\nFor each unit of time, call or scene.\n\n{ratios.skip_table(best_skips)}\n"
    if ensembles:
        best_ensembles = records.fastest(ensembles)
        written.append(records.write(target / "ensemble_raw.csv", facts, ensembles))
        written.append(records.write(target / "ensemble.csv", facts, best_ensembles))
        text += f"\nOne core.\n\n{ratios.ensemble_table(best_ensembles)}\n"
    about = "\n".join(f"* {name}: {value}" for name, value in facts.items())
    tables = target / "tables.md"
    tables.write_text(f"# Benchmark\n\n{about}\n\n{text}")
    if whole and options.records is None:
        page.PAGE.write_text(page.renewed(page.PAGE.read_text(), target))
        written.append(page.PAGE)
    print("\n" + text)
    for row in best_free + best_steps:
        if row["note"].startswith(("failed", "not timed")):
            step = f", step {row['step']}" if row["step"] not in ("", None) else ""
            print(f"case {row['case']}, {row['method']}, tolerance {row['tolerance']}{step}: {row['note']}")
    print("\nwritten:", *(str(path) for path in [*written, tables]), sep="\n  ")


if __name__ == "__main__":
    main()
