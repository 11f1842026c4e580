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


def tree(*selection: str) -> str:
    """What cargo says of the tree of crates, a line each."""
    words = ["cargo", "tree", "--locked", "--prefix", "none", *selection]
    return subprocess.run(words, cwd=REPOSITORY, capture_output=True, text=True, check=True).stdout


def crates(package: str, triples: Iterable[str]) -> set[tuple[str, str]]:
    """Names and versions of the crates of others that are linked into a package for these targets."""
    targets = [word for triple in triples for word in ("--target", triple)]
    linked = tree("--edges", "normal,no-proc-macro", "--format", "{p}", *targets, "--package", package)
    return set(re.findall(r"^(\S+) v(\S+)(?: \(\*\))?$", linked, flags=re.MULTILINE))
