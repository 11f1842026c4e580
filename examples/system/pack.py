"""Builds the FMUs of supply and controller with the C compiler, and packs the system as an SSP.

    python examples/system/pack.py [--output FOLDER]

The headers are the FMI 2.0 headers that FMPy brings along.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import tempfile
import zipfile
from pathlib import Path

import fmpy

from dielectric_actuator import packed_fmu

HERE = Path(__file__).resolve().parent
DEFAULT_OUTPUT = HERE.parents[1] / "target" / "examples" / "system"
LINEAR_MODELS = ("supply", "controller")


def pack_linear(model: str, folder: Path) -> Path:
    """Compile one linear model for this machine and pack it as an FMU."""
    fmu = folder / f"{model}.fmu"
    headers = Path(fmpy.__file__).parent / "c-code"
    with tempfile.TemporaryDirectory() as build:
        library = Path(build) / (model + fmpy.sharedLibraryExtension)
        # unused parameters are the price of a C interface that a model fills only in part
        flags = ["-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Wno-unused-parameter", f"-I{headers}"]
        compiler = shlex.split(os.environ.get("CC", "cc"))
        subprocess.run([*compiler, *flags, "-o", str(library), str(HERE / f"{model}.c"), "-lm"], check=True)
        with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.write(HERE / f"{model}.xml", "modelDescription.xml")
            archive.write(library, f"binaries/{fmpy.platform}/{library.name}")
            for source in (f"{model}.c", "linear.h"):
                archive.write(HERE / source, f"sources/{source}")
    return fmu


def pack_system(actuator: Path, folder: Path) -> Path:
    """Pack ``positioning.ssp``: two linear models, the actuator, how they are connected, their parameters."""
    folder.mkdir(parents=True, exist_ok=True)
    ssp = folder / "positioning.ssp"
    fmus = [pack_linear(model, folder) for model in LINEAR_MODELS]
    with zipfile.ZipFile(ssp, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("SystemStructure.ssd", "parameters.ssv"):
            archive.write(HERE / name, name)
        for fmu in fmus:
            archive.write(fmu, f"resources/{fmu.name}")
        # under the name that SystemStructure.ssd knows it by
        archive.write(actuator, f"resources/{packed_fmu().name}")
    return ssp


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed actuator (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder (%(default)s)")
    arguments = parser.parse_args()
    print(pack_system(arguments.fmu, arguments.output))
