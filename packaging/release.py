"""Gathers what a release consists of in a folder named by the version: FMUs, wheel, page, bill of materials, sums.

    python packaging/release.py [--output FOLDER]

Everything must have been built: `make release` does so first. The bytes depend on what was built alone.
"""

from __future__ import annotations

import argparse
import base64
import functools
import hashlib
import json
import re
import shutil
import sys
import tomllib
import uuid
import zipfile
from collections.abc import Iterator
from pathlib import Path

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import HashAlgorithm, HashType
from cyclonedx.model.bom import Bom, BomMetaData
from cyclonedx.model.component import Component, ComponentScope, ComponentType
from cyclonedx.model.license import License
from cyclonedx.output import make_outputter
from cyclonedx.schema import OutputFormat, SchemaVersion
from packageurl import PackageURL

PROJECT = Path(__file__).resolve().parents[1]
TARGET = PROJECT / "target"
PAGE = "dielectric_elastomer_actuator.html"
NATIVE = "dielectric_actuator_native"
"""The native library, which is in the wheel."""
FMUS = [f"{path.stem}.fmu" for path in sorted((PROJECT / "modelDescription").glob("*.xml"))]
LIST = "license.txt"
"""What is linked into a part, as the packager writes it among the part's licences."""
BILL = "bill_of_materials.cdx.json"
SUMS = "SHA256SUMS"


def main() -> int:
    """Fill the folder; 0 on success, 1 if something was not built."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--output", type=Path, default=TARGET / "releases", help="folder of releases (%(default)s)")
    output = parser.parse_args().output
    version = workspace_version()
    page = TARGET / "page" / "index.html"
    wheel = TARGET / "wheel" / f"dielectric_actuator-{version}-py3-none-any.whl"
    fmus = [TARGET / "fmu" / name for name in FMUS]
    missing = [str(path) for path in (*fmus, wheel) if not path.is_file()]
    if missing:
        print(f"error: not built: {', '.join(missing)}; run make release", file=sys.stderr)
        return 1
    parts = {fmu.name: inside(fmu, "documentation/licenses/") for fmu in fmus}
    parts[NATIVE] = inside(wheel, "dielectric_actuator/data/native/licenses/")
    folder = output / version
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for path in (*fmus, wheel):
        shutil.copyfile(path, folder / path.name)
    if page.is_file():
        shutil.copyfile(page, folder / PAGE)
        listed = page.with_name("licences.txt").read_text(encoding="utf-8")
        parts[PAGE] = [*crates(listed), rust_standard_library(), uplot()]
    else:
        print("without the live page: there is no target/page/index.html")
    (folder / BILL).write_text(bill_of_materials(version, parts), encoding="utf-8")
    (folder / SUMS).write_text(sums(folder), encoding="ascii")
    for path in sorted(folder.iterdir()):
        print(f"{path.stat().st_size:>9} bytes  {path}")
    return 0


def workspace_version() -> str:
    """The version of the release, that of the workspace."""
    manifest = tomllib.loads((PROJECT / "Cargo.toml").read_text(encoding="utf-8"))
    return manifest["workspace"]["package"]["version"]


def inside(archive: Path, folder: str) -> list[Component]:
    """What is linked into an FMU or the native library of a wheel, as its folder of licences has it; and what draws
    the plots of the live page, where that is in the FMU."""
    with zipfile.ZipFile(archive) as opened:
        names = opened.namelist()
        if folder + LIST not in names:
            raise ValueError(f"{archive} has no {folder}{LIST}, which lists what is linked into it; run make release")
        found = crates(opened.read(folder + LIST).decode())
    found += [component() for name, component in BESIDE_THE_CRATES.items() if folder + name in names]
    return [*found, uplot()] if "documentation/actuator.html" in names else found


def crates(listed: str) -> list[Component]:
    """The crates in a list of the packager: a line for each, such as ``serde 1.0.229: MIT OR Apache-2.0``, then the
    texts of the licences below lines of ``=``."""
    found = re.findall(r"^(\S+) (\d\S*): (.+)$", listed.partition("=" * 80)[0], re.MULTILINE)
    if not found:
        raise ValueError(f"a list of what is linked in names no crate: {listed[:200]!r}; run make release")
    return [crate(*words) for words in found]


def bill_of_materials(version: str, contents: dict[str, list[Component]]) -> str:
    """CycloneDX 1.6 as JSON: what is shipped and what is in each part of it, with versions, licences and the checksums
    of the lock files, and what the wheel asks for."""
    own = "MIT OR Apache-2.0"
    release = Component(
        name="dielectric-elastomer-actuator",
        version=version,
        type=ComponentType.APPLICATION,
        bom_ref=f"dielectric-elastomer-actuator@{version}",
        licenses=licensed(own),
    )
    wheel = Component(name="dielectric-actuator", version=version, bom_ref="wheel", licenses=licensed(own))
    parts = {name: Component(name=name, version=version, bom_ref=name, licenses=licensed(own)) for name in contents}
    linked = {str(component.bom_ref): component for part in contents.values() for component in part}
    asked = list(asked_for())
    components = [*parts.values(), wheel, *linked.values(), *asked]
    listed = "\n".join(f"{component.bom_ref}" for component in components)
    bom = Bom(
        components=components,
        metadata=BomMetaData(component=release),
        # the same contents, the same number
        serial_number=uuid.uuid5(uuid.NAMESPACE_URL, f"{release.bom_ref}\n{listed}"),
    )
    bom.register_dependency(release, [wheel, *parts.values()])
    bom.register_dependency(wheel, [*(part for name, part in parts.items() if name != PAGE), *asked])
    for name, part in parts.items():
        bom.register_dependency(part, contents[name])
    text = make_outputter(bom, OutputFormat.JSON, SchemaVersion.V1_6).output_as_string(indent=2)
    bill = json.loads(text)
    # the library writes the present time, which is not of the contents
    bill["metadata"].pop("timestamp", None)
    return json.dumps(bill, indent=2, sort_keys=True) + "\n"


def licensed(expression: str) -> list[License]:
    """A licence expression of SPDX as a bill has it."""
    return [LicenseFactory().make_from_string(expression.replace("/", " OR "))]


@functools.cache
def locked_checksums() -> dict[tuple[str, str], str]:
    """SHA-256 of each crate, by name and version."""
    lock = tomllib.loads((PROJECT / "Cargo.lock").read_text(encoding="utf-8"))["package"]
    return {(package["name"], package["version"]): package["checksum"] for package in lock if "checksum" in package}


def crate(name: str, version: str, terms: str) -> Component:
    """A crate that is linked in."""
    return Component(
        name=name,
        version=version,
        bom_ref=f"cargo:{name}@{version}",
        scope=ComponentScope.REQUIRED,
        licenses=licensed(terms),
        purl=PackageURL("cargo", None, name, version),
        hashes=[HashType(alg=HashAlgorithm.SHA_256, content=locked_checksums()[name, version])],
    )


def rust_standard_library() -> Component:
    """Of the pinned Rust."""
    rust = tomllib.loads((PROJECT / "rust-toolchain.toml").read_text(encoding="utf-8"))["toolchain"]["channel"]
    return Component(
        name="rust-std",
        version=rust,
        bom_ref=f"rust-std@{rust}",
        scope=ComponentScope.REQUIRED,
        licenses=licensed("MIT OR Apache-2.0"),
        description="Rust's standard library, linked in",
    )


def of_zig(name: str, terms: str, description: str) -> Component:
    """What the pinned zig brings."""
    lines = (PROJECT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    pins = dict(line.split(";")[0].strip().split("==") for line in lines if "==" in line)
    return Component(
        name=name,
        version=pins["ziglang"],
        bom_ref=name,
        scope=ComponentScope.REQUIRED,
        licenses=licensed(terms),
        description=f"{description} that zig of this version brings, linked in",
    )


BESIDE_THE_CRATES = {
    "rust-standard-library.html": rust_standard_library,
    "llvm-libunwind.txt": lambda: of_zig("llvm-libunwind", "Apache-2.0 WITH LLVM-exception", "the unwinder"),
    "mingw-w64.txt": lambda: of_zig("mingw-w64", "ZPL-2.1", "the start-up code and import libraries of Windows"),
}
"""What else is linked in, by the licence that is there then."""


def uplot() -> Component:
    """What draws the plots of the page; it is inlined."""
    lock = json.loads((PROJECT / "page" / "package-lock.json").read_text(encoding="utf-8"))
    package = lock["packages"]["node_modules/uplot"]
    algorithm, _, digest = package["integrity"].partition("-")
    if algorithm != "sha512":
        raise ValueError(f"page/package-lock.json has a checksum of uplot by {algorithm}; sha512 is known here")
    return Component(
        name="uplot",
        version=package["version"],
        bom_ref=f"npm:uplot@{package['version']}",
        scope=ComponentScope.REQUIRED,
        licenses=licensed(package["license"]),
        purl=PackageURL("npm", None, "uplot", package["version"]),
        hashes=[HashType(alg=HashAlgorithm.SHA_512, content=base64.b64decode(digest).hex())],
    )


def asked_for() -> Iterator[Component]:
    """What the wheel asks for, extras included."""
    project = tomllib.loads((PROJECT / "python" / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    asked = [(text, ComponentScope.REQUIRED) for text in project["dependencies"]]
    asked += [(text, ComponentScope.OPTIONAL) for name, texts in extras.items() if name != "all" for text in texts]
    for text, scope in asked:
        name = text.split(">")[0]
        yield Component(
            name=name,
            bom_ref=f"pypi:{name}",
            scope=scope,
            purl=PackageURL("pypi", None, name.lower()),
            description=f"asked for by the wheel, not part of it: {text}",
        )


def sums(folder: Path) -> str:
    """SHA-256 of each file, as ``sha256sum --check`` reads them."""
    return "".join(
        f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(folder.iterdir())
    )


if __name__ == "__main__":
    sys.exit(main())
