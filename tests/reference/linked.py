"""Cargo's own list of what is linked, by another route than the packager's."""

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
TRIPLES = {
    "linux64": "x86_64-unknown-linux-gnu",
    "win64": "x86_64-pc-windows-gnullvm",
    "aarch64-linux": "aarch64-unknown-linux-gnu",
    "darwin64": "x86_64-apple-darwin",
}
"""Target triple by the folder of the binary."""


def crates(package: str, triples: Iterable[str]) -> set[tuple[str, str]]:
    """Names and versions of the crates of others that are linked into a package for these targets."""
    words = ["cargo", "tree", "--locked", "--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]
    words += [word for triple in triples for word in ("--target", triple)]
    done = subprocess.run([*words, "--package", package], cwd=REPOSITORY, capture_output=True, text=True, check=True)
    return set(re.findall(r"^(\S+) v(\S+)(?: \(\*\))?$", done.stdout, flags=re.MULTILINE))
