"""The compiled programs: the Rust side, which make builds, and CVODE, built here where SUNDIALS is found."""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy

from cases import HERE, Case

FIELDS = ("method", "tolerance", "step", "inputs", "nanoseconds", "error", "hold_error", "note")
"""Columns that each program prints."""

C_FLAGS = ("-O3", "-march=native")
CVODE = ("-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunnonlinsolfixedpoint")
BDF = ("-DWITH_BDF", "-lsundials_sunlinsoldense", "-lsundials_sunmatrixdense")
CORE = ("-lsundials_core",)


class Missing(Exception):
    """A rival is not there; the text says why."""


class Program:
    """A program that times its methods once on one case and prints rows."""

    def __init__(self, path: Path, version: str, *always: str):
        self._path = path
        self._always = always
        self.version = version

    def rows(self, pattern: str, case: Case, milliseconds: int, *more: str) -> Iterator[dict]:
        about = (*case.arguments(), *self._always, *more)
        command = [str(self._path), pattern, f"milliseconds={milliseconds}", *about]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{self._path.name} {pattern}, case {case.name}: {done.stderr.strip()[-2000:]}")
        yield from csv.DictReader(done.stdout.splitlines(), fieldnames=FIELDS)


def rust(path: Path, fmu: Path, folder: Path) -> Program:
    """The Rust side with the versions of the rivals in its lock file.

    It calls the binary of the packed `fmu`, which is unpacked into the `folder`.
    """
    for needed in (path, fmu):
        if not needed.is_file():
            raise SystemExit(f"{needed} is missing; run make bench, which builds it")
    binary = f"binaries/{fmpy.platform}/{fmu.stem}{fmpy.sharedLibraryExtension}"
    with zipfile.ZipFile(fmu) as archive:
        library = archive.extract(binary, folder)
    versions = ", ".join(_locked("ode_solvers", "differential-equations", "diffsol"))
    return Program(path, versions, f"fmu={library}")


def _locked(*names: str) -> Iterator[str]:
    lines = (HERE / "Cargo.lock").read_text().splitlines()
    for name in names:
        index = lines.index(f'name = "{name}"')
        version = lines[index + 1].split('"')[1]
        yield f"{name} {version}"


def cvode(folder: Path) -> Program:
    """CVODE, if the C compiler finds SUNDIALS (version 6 or later)."""
    compiler = os.environ.get("CC", "cc")
    if not shutil.which(compiler):
        raise Missing("no C compiler")
    target = folder / "cvode"
    complaint = ""
    # BDF and the library that version 7 added are taken where they are there.
    for extra in ((*BDF, *CORE), BDF, CORE, ()):
        command = [compiler, *C_FLAGS, str(HERE / "cvode.c"), "-o", str(target), *CVODE, *extra, "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 0:
            started = subprocess.run([target, "version"], capture_output=True, text=True)
            if started.returncode == 0:
                return Program(target, started.stdout.strip())
            complaint = started.stderr
        complaint = complaint or done.stderr
    lines = [line for line in complaint.splitlines() if "error" in line.lower()] or ["no reason given"]
    # without the place in the file, which would name a folder of this machine
    raise Missing(f"the C compiler finds no SUNDIALS 6 or later ({lines[0].rpartition('error:')[2].strip()})")
