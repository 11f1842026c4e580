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
import os
import shutil
import subprocess
import sys
import tomllib
import uuid
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
SHIPPED = {
    "DielectricElastomerActuator.fmu": "nondimensional-fmu",
    "DielectricElastomerActuatorSI.fmu": "si-fmu",
    "dielectric_actuator_native": "dielectric-actuator-native",
    PAGE: "page-core",
}
"""What is shipped, the wheel's native library too, each with the member of the workspace that it is made of."""
BILL = "bill_of_materials.cdx.json"
SUMS = "SHA256SUMS"


def main() -> int:
    """Fill the folder; 0 on success, 1 if something was not built."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--output", type=Path, default=TARGET / "releases", help="folder of releases (%(default)s)")
    output = parser.parse_args().output
    metadata = cargo_metadata()
    version = workspace_version()
    page = TARGET / "page" / "index.html"
    wheel = TARGET / "wheel" / f"dielectric_actuator-{version}-py3-none-any.whl"
    built = [*sorted((TARGET / "fmu").glob("*.fmu")), wheel]
    missing = [str(path) for path in built if not path.is_file()]
    if missing or len(built) < 2:
        print(f"error: not built: {', '.join(missing) or 'FMU'}; run make release", file=sys.stderr)
        return 1
    folder = output / version
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for path in built:
        shutil.copyfile(path, folder / path.name)
    if page.is_file():
        shutil.copyfile(page, folder / PAGE)
    else:
        print("without the live page: there is no target/page/index.html")
    (folder / BILL).write_text(bill_of_materials(metadata, version), encoding="utf-8")
    (folder / SUMS).write_text(sums(folder), encoding="ascii")
    for path in sorted(folder.iterdir()):
        print(f"{path.stat().st_size:>9} bytes  {path}")
    return 0


def cargo_metadata() -> dict:
    """What cargo knows of the workspace and all that it depends on."""
    words = [os.environ.get("CARGO", "cargo"), "metadata", "--format-version", "1", "--locked"]
    return json.loads(subprocess.run(words, cwd=PROJECT, stdout=subprocess.PIPE, check=True).stdout)


def workspace_version() -> str:
    """The version of the release, that of the workspace."""
    manifest = tomllib.loads((PROJECT / "Cargo.toml").read_text(encoding="utf-8"))
    return manifest["workspace"]["package"]["version"]


def linked_crates(metadata: dict, member: str) -> Iterator[dict]:
    """The crates of others that are linked into what a member of the workspace becomes, for any platform: normal
    dependencies, no compile-time ones."""
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    ahead = [identity for identity in metadata["workspace_members"] if packages[identity]["name"] == member]
    if not ahead:
        raise ValueError(f"the workspace has no member {member}")
    seen = set()
    while ahead:
        identity = ahead.pop()
        compile_time = any("proc-macro" in target["kind"] for target in packages[identity]["targets"])
        if identity in seen or compile_time:
            continue
        seen.add(identity)
        for dependency in nodes[identity]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                ahead.append(dependency["pkg"])
    found = (packages[identity] for identity in seen)
    yield from sorted((package for package in found if package["source"]), key=lambda p: (p["name"], p["version"]))


def bill_of_materials(metadata: dict, version: str) -> str:
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
    standard, unwinder, plotting = rust_standard_library(), llvm_unwinder(), uplot()
    crates: dict[str, Component] = {}
    parts: dict[str, Component] = {}
    contents: dict[str, list[Component]] = {}
    for name, member in SHIPPED.items():
        parts[name] = Component(name=name, version=version, bom_ref=name, licenses=licensed(own))
        linked = [
            crates.setdefault(str(crate.bom_ref), crate) for crate in map(crate_of, linked_crates(metadata, member))
        ]
        contents[name] = [*linked, standard, plotting if name == PAGE else unwinder]
    asked = list(asked_for())
    components = [*parts.values(), wheel, *crates.values(), standard, unwinder, plotting, *asked]
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


def crate_of(package: dict) -> Component:
    """A crate that is linked in."""
    name, version = package["name"], package["version"]
    return Component(
        name=name,
        version=version,
        bom_ref=f"cargo:{name}@{version}",
        scope=ComponentScope.REQUIRED,
        licenses=licensed(package["license"]) if package["license"] else None,
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


def llvm_unwinder() -> Component:
    """Of the pinned zig."""
    lines = (PROJECT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    pins = dict(line.split(";")[0].strip().split("==") for line in lines if "==" in line)
    return Component(
        name="llvm-libunwind",
        version=pins["ziglang"],
        bom_ref="llvm-libunwind",
        scope=ComponentScope.REQUIRED,
        licenses=licensed("Apache-2.0 WITH LLVM-exception"),
        description="the unwinder that zig of this version brings, linked in",
    )


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
