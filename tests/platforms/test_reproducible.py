"""Two builds of the same sources, in different folders, give the same FMU byte for byte."""

import os
import shutil
import subprocess
import zipfile

from conftest import FMU, REPOSITORY


def test_a_build_elsewhere_gives_the_same_bytes(fmu, tmp_path):
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=REPOSITORY, capture_output=True, check=True,
    )  # fmt: skip
    elsewhere = tmp_path / "another folder"
    for name in filter(None, os.fsdecode(listed.stdout).split("\0")):
        source, copy = REPOSITORY / name, elsewhere / name
        if source.is_file():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    platforms = {name.split("/")[1] for name in fmu.namelist() if name.startswith("binaries/")}
    arguments = ["--all"] if platforms != {"linux64"} else []
    subprocess.run(["cargo", "fmu", *arguments], cwd=elsewhere, check=True)
    packed = elsewhere / FMU.relative_to(REPOSITORY)
    with zipfile.ZipFile(packed) as other:
        assert other.namelist() == fmu.namelist()
        different = [name for name in fmu.namelist() if other.read(name) != fmu.read(name)]
    assert not different
    assert packed.read_bytes() == FMU.read_bytes()
