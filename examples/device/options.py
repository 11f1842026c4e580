"""The command line of the examples of this folder."""

from __future__ import annotations

import argparse
from pathlib import Path

from dielectric_actuator import packed_fmu

FMU = packed_fmu("si")
ROOT = Path(__file__).resolve().parents[2]
DEFAULT_OUTPUT = ROOT / "target" / "examples" / "device"


def parse(description: str, stop_time: float | None = None) -> argparse.Namespace:
    """Options of an example; one that runs for a time has it as an option too."""
    parser = argparse.ArgumentParser(description=description.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=FMU, help="the packed actuator (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder (%(default)s)")
    if stop_time is not None:
        parser.add_argument("--stop-time", type=float, default=stop_time, help="s, a multiple of the largest step")
    return parser.parse_args()
