"""Scenes that show a motion: JSON files, in the package and wherever a fit or a user writes one.

Their start values are the FMU's variables by name. For hosts that read them from a file, `Preset.save_ssv` writes them
as the SSP standard 1.0 has it (section 6).
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as xml
from dataclasses import asdict, dataclass, fields
from importlib.resources import files
from pathlib import Path

from .fmu import UnknownName

_SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"


@dataclass(frozen=True)
class Preset:
    """A scene with the experiment that shows it."""

    title: str
    description: str
    start_values: dict[str, float]
    """Inputs and parameters of the FMU that differ from their start values."""
    stop_time: float
    communication_step: float

    def save(self, path: str | Path) -> Path:
        """Write the preset as JSON, for `load`."""
        path = Path(path)
        path.write_text(json.dumps(asdict(self), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        return path

    def save_ssv(self, path: str | Path) -> Path:
        """Write the start values as a parameter set, for hosts that read ``.ssv`` files."""
        path = Path(path)
        root = xml.Element(f"{{{_SSV}}}ParameterSet", {"version": "1.0", "name": self.title})
        parameters = xml.SubElement(root, f"{{{_SSV}}}Parameters")
        for name, value in self.start_values.items():
            parameter = xml.SubElement(parameters, f"{{{_SSV}}}Parameter", {"name": name})
            xml.SubElement(parameter, f"{{{_SSV}}}Real", {"value": repr(float(value))})
        xml.register_namespace("ssv", _SSV)
        xml.indent(root)
        xml.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
        return path


def names() -> list[str]:
    """Names of the presets of the package."""
    folder = files(__package__) / "presets"
    return sorted(entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json"))


def load(name: str | Path) -> Preset:
    """A preset of the package by its name, or one of a file by a path that ends in ``.json``.

    Raises `UnknownName` for a name that there is not, ValueError for a file that holds no preset.
    """
    if str(name).endswith(".json"):
        text = Path(name).read_text(encoding="utf-8")
    elif str(name) in names():
        text = (files(__package__) / "presets" / f"{name}.json").read_text(encoding="utf-8")
    else:
        raise UnknownName("preset", str(name), names())
    wanted = {field.name for field in fields(Preset)}
    try:
        found = json.loads(text)
    except ValueError as reason:
        raise ValueError(f"{name} is no JSON: {reason}") from None
    if not isinstance(found, dict) or set(found) != wanted:
        raise ValueError(f"{name} holds no preset, which has {', '.join(sorted(wanted))}")
    return Preset(**found)
