"""What the tests of the platforms share: the packed FMUs, a host for each platform, and what runs it here."""

import functools
import os
import platform
import shlex
import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
import pytest

import debian

REPOSITORY = Path(__file__).resolve().parents[2]
FMUS = REPOSITORY / "target" / "fmu"
MODELS = ("DielectricElastomerActuator", "DielectricElastomerActuatorSI")
ZIG = shlex.split(os.environ.get("ZIG", f"{shlex.quote(sys.executable)} -m ziglang"))


@dataclass
class Runner:
    """How a program of another platform is started here."""

    command: list = field(default_factory=list)
    environment: dict = field(default_factory=dict)

    def run(self, program: Path, *arguments) -> str:
        """What the program prints; a failure with what it says if it does not end well."""
        command = [*self.command, str(program), *map(str, arguments)]
        done = subprocess.run(
            command, env={**os.environ, **self.environment}, capture_output=True, text=True, timeout=600
        )
        assert done.returncode == 0, f"{shlex.join(command)}\n{done.stderr}"
        return done.stdout


def unpacked(*packages: str) -> Path:
    """Debian's packages, unpacked below target; the test is skipped where that cannot be done."""
    try:
        return debian.unpacked(*packages)
    except RuntimeError as error:
        pytest.skip(f"{packages[0]} is not installed, and Debian's package cannot be unpacked: {error}")


def native() -> Runner:
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("needs 64-bit Linux on x86")
    return Runner()


def wine() -> Runner:
    native()
    prefix = {"WINEPREFIX": str(REPOSITORY / "target" / "wine"), "WINEDEBUG": "-all"}
    installed = shutil.which("wine64") or shutil.which("wine")
    if installed:
        return Runner([installed], prefix)
    root = unpacked("wine64")
    # In the package this is a script that looks for the server below /usr.
    server = root / "usr/lib/wine/wineserver"
    server.unlink(missing_ok=True)
    server.symlink_to("wineserver64")
    paths = {
        "LD_LIBRARY_PATH": f"{root}/usr/lib/x86_64-linux-gnu",
        "WINEDLLPATH": f"{root}/usr/lib/x86_64-linux-gnu/wine:{root}/usr/x86_64-w64-mingw32/lib",
    }
    return Runner([str(root / "usr/lib/wine/wine64")], prefix | paths)


def qemu() -> Runner:
    native()
    installed = shutil.which("qemu-aarch64") or shutil.which("qemu-aarch64-static")
    system = Path("/usr/aarch64-linux-gnu")
    if installed and system.is_dir():
        return Runner([installed, "-L", str(system)])
    root = unpacked("qemu-user", "libc6-arm64-cross")
    system = root / "usr/aarch64-linux-gnu"
    # For qemu itself; the program that it runs gets none.
    libraries = {"LD_LIBRARY_PATH": f"{root}/usr/lib/x86_64-linux-gnu"}
    command = [str(root / "usr/bin/qemu-aarch64"), "-U", "LD_LIBRARY_PATH", "-L", str(system)]
    return Runner(command, libraries)


PLATFORMS = {
    "linux64": ("x86_64-linux-gnu.2.17", "so", native),
    "win64": ("x86_64-windows-gnu", "dll", wine),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", "so", qemu),
}
"""Target of zig, file name extension of a library, and what finds the runner."""


def packed(model: str) -> Path:
    """The packed FMU; a test that needs it fails where there is none."""
    path = FMUS / f"{model}.fmu"
    if not path.is_file():
        pytest.fail(f"no FMU at {path}: build and pack it first (make fmu-all)", pytrace=False)
    return path


@pytest.fixture(scope="session")
def simulate(tmp_path_factory):
    """A function that runs a scene of a model on a platform and gives the bits of what it reads, a row a step."""

    @functools.cache
    def described(model: str):
        return fmpy.read_model_description(str(packed(model)))

    @functools.cache
    def prepared(model: str, name: str):
        target, extension, runner = PLATFORMS[name]
        path = f"binaries/{name}/{model}.{extension}"
        folder = tmp_path_factory.mktemp(name)
        with zipfile.ZipFile(packed(model)) as archive:
            if path not in archive.namelist():
                pytest.skip(f"the FMU has no binary for {name}; make fmu-all says why")
            library = Path(archive.extract(path, folder))
        host = folder / ("host.exe" if extension == "dll" else "host")
        source = Path(__file__).with_name("host.c")
        subprocess.run([*ZIG, "cc", "-target", target, "-O2", "-Wall", "-Werror", "-o", host, source], check=True)
        return runner(), host, library

    def run(model: str, name: str, scene: dict, outputs: tuple, *, step: float, steps: int, tolerance: float):
        runner, host, library = prepared(model, name)
        description = described(model)
        reference_of = {variable.name: variable.valueReference for variable in description.modelVariables}
        settings = [f"{reference_of[variable]}={value!r}" for variable, value in scene.items()]
        reads = [reference_of[variable] for variable in outputs]
        # A path that is relative to the drive is one for Windows too.
        printed = runner.run(host, library, description.guid, tolerance, step, steps, *settings, *reads)
        return [line.split() for line in printed.splitlines()]

    return run
