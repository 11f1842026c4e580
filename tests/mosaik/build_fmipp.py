"""Compiles fmipp, over which mosaik-fmi runs FMUs, without SUNDIALS: ``build_fmipp.py PYTHON FOLDER`` installs it in
FOLDER, by the pip of the Python that runs this, for PYTHON, which has what compiles it.

fmipp has no binary package. Its sources ask for SUNDIALS before version 4, for two of its integrators; mosaik-fmi takes
another one. Needs a C++ compiler and Boost (Debian: libboost-filesystem-dev).
"""

import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

VERSION = "2.1.0"
SUNDIALS = ("( 'USE_SUNDIALS', None ),", ", '-DUSE_SUNDIALS'", "'-lsundials_cvode',", "'-lsundials_nvecserial'")
"""What asks for it in setup.py."""


def main(python: Path, target: Path) -> None:
    """Download, change, compile, install."""
    pip = [sys.executable, "-m", "pip", "--python", python]
    with tempfile.TemporaryDirectory() as folder:
        download = ["download", "--no-deps", "--no-build-isolation", "--no-binary", ":all:", "--dest", folder]
        subprocess.run([*pip, *download, f"fmipp=={VERSION}"], check=True)
        with tarfile.open(Path(folder) / f"fmipp-{VERSION}.tar.gz") as archive:
            archive.extractall(folder, filter="data")
        sources = Path(folder) / f"fmipp-{VERSION}"
        script = sources / "setup.py"
        text = script.read_text()
        for words in SUNDIALS:
            assert words in text, f"setup.py of fmipp {VERSION} does not say {words}"
            text = text.replace(words, "")
        script.write_text(text)
        tools = os.pathsep.join([str(python.absolute().parent), os.environ["PATH"]])
        install = ["install", "--no-deps", "--no-build-isolation", "--upgrade", "--target", target, sources]
        subprocess.run([*pip, *install], check=True, env={**os.environ, "PATH": tools, "CFLAGS": "-O1"})


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
