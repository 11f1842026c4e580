"""Builds the linear FMUs of a system with the C compiler, and packs the system as an SSP.

    python examples/system/pack.py [--output FOLDER]

A system is a folder: SystemStructure.ssd, parameters.ssv, and for each linear FMU its model in C with its
description. The headers are the FMI 2.0 headers that FMPy brings along.
"""

from __future__ import annotations

import argparse
import os
import shlex
import subprocess
import tempfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy

from dielectric_actuator import packed_fmu

HERE = Path(__file__).resolve().parent
DEFAULT_OUTPUT = HERE.parents[1] / "target" / "examples" / "system"


def pack_linear(source: Path, folder: Path) -> Path:
    """Compile the linear model `source` for this machine and pack it, with the description beside it, as an FMU."""
    fmu = folder / f"{source.stem}.fmu"
    headers = Path(fmpy.__file__).parent / "c-code"
    with tempfile.TemporaryDirectory() as build:
        library = Path(build) / (source.stem + fmpy.sharedLibraryExtension)
        # unused parameters are the price of a C interface that a model fills only in part
        flags = ["-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Wno-unused-parameter", f"-I{headers}", f"-I{HERE}"]
        compiler = shlex.split(os.environ.get("CC", "cc"))
        subprocess.run([*compiler, *flags, "-o", str(library), str(source), "-lm"], check=True)
        with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.write(source.with_suffix(".xml"), "modelDescription.xml")
            archive.write(library, f"binaries/{fmpy.platform}/{library.name}")
            for text in (source, HERE / "linear.h"):
                archive.write(text, f"sources/{text.name}")
    return fmu


def pack_system(actuator: Path, folder: Path, source: Path = HERE) -> Path:
    """Pack the system in the folder `source`: linear models, the actuator, how they are connected, their parameters.

    The SSP is called like the system.
    """
    folder.mkdir(parents=True, exist_ok=True)
    structure = source / "SystemStructure.ssd"
    ssp = folder / f"{ElementTree.parse(structure).getroot().attrib['name']}.ssp"
    fmus = [pack_linear(model, folder) for model in sorted(source.glob("*.c"))]
    identifier = fmpy.read_model_description(str(actuator)).coSimulation.modelIdentifier
    with zipfile.ZipFile(ssp, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(structure, structure.name)
        archive.write(source / "parameters.ssv", "parameters.ssv")
        for fmu in fmus:
            archive.write(fmu, f"resources/{fmu.name}")
        archive.write(actuator, f"resources/{identifier}.fmu")
    return ssp


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--fmu", type=Path, default=packed_fmu(), help="the packed actuator (%(default)s)")
    parser.add_argument("--output", type=Path, default=DEFAULT_OUTPUT, help="folder (%(default)s)")
    arguments = parser.parse_args()
    print(pack_system(arguments.fmu, arguments.output))
