"""Programs from Debian's packages, unpacked below target: nothing is installed and no rights are needed."""

import re
import shutil
import subprocess
from pathlib import Path

SHELF = Path(__file__).resolve().parents[2] / "target" / "debian"


def unpacked(*packages: str) -> Path:
    """A folder, laid out like `/`, with the packages and what they need beyond what is installed.

    It is named after the first package and made once. Raises RuntimeError where there is no apt, or it does
    not know or get the packages.
    """
    root = SHELF / packages[0]
    if root.is_dir():
        return root
    parcels, unfinished = SHELF / "parcels", SHELF / "unfinished"
    for folder in (parcels, unfinished):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    for folder in ("lists/partial", "cache/archives/partial"):
        (SHELF / "apt" / folder).mkdir(parents=True, exist_ok=True)
    apt("update")
    # Also those that are installed: of several programs only some may be.
    listing = apt("install", "--reinstall", "--print-uris", "--yes", "--no-install-recommends", *packages)
    # 'ADDRESS' NAME_VERSION_ARCHITECTURE.deb SIZE HASH
    files = re.findall(r"^'[^']*' (\S+?)_(\S+?)_\S+\.deb ", listing, flags=re.MULTILINE)
    apt("download", *(f"{name}={version.replace('%3a', ':')}" for name, version in files), folder=parcels)
    for parcel in parcels.iterdir():
        run("dpkg", "-x", parcel, unfinished)
    shutil.rmtree(parcels)
    return unfinished.rename(root)


def apt(verb: str, *arguments: str, folder: Path | None = None) -> str:
    """What Debian's package manager answers, with package lists of its own, as new as the mirror has them."""
    own = [f"-oDir::State::lists={SHELF}/apt/lists", f"-oDir::Cache={SHELF}/apt/cache"]
    rootless = ["-oDebug::NoLocking=1", "-oAPT::Sandbox::User=root"]
    return run("apt-get", *own, *rootless, "-qq", verb, *arguments, folder=folder)


def run(*command, folder: Path | None = None) -> str:
    """What a command says on standard output."""
    try:
        return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    except FileNotFoundError:
        raise RuntimeError(f"this system has no {command[0]}") from None
    except subprocess.CalledProcessError as error:
        raise RuntimeError(f"{command[0]} failed: {error.stderr.strip()}") from None
