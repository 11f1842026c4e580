"""Scenes that show a motion, and materials: JSON files, in the package and wherever a fit or a user writes one.

Their start values are the FMU's variables by name. For hosts that read them from a file, `Preset.save_ssv` writes them
as the SSP standard 1.0 has it (section 6); each FMU carries those of its own. The live page shows the ones in SI units.
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as xml
from dataclasses import MISSING, asdict, dataclass, fields
from importlib.resources import files
from pathlib import Path

from .fmu import MODELS, UnknownName

_KINDS = {
    "start_values": "numbers by the names of variables",
    "stop_time": "a number",
    "communication_step": "a number",
}
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
    model: str = "nondimensional"
    """Which actuator it is for, as `Actuator` takes it: "nondimensional", or "si" for volts, metres and seconds."""
    source: str = ""
    """Of a material: where its numbers come from."""
    not_verified: str = ""
    """Of a material: which of its numbers were not seen in the source, or not at first hand."""

    def about(self) -> str:
        """The description, with the source and what is not verified of a material."""
        said = [self.description]
        if self.source:
            said += [f"Source: {self.source}", f"Not verified: {self.not_verified}"]
        return " ".join(said)

    def save(self, path: str | Path) -> Path:
        """Write the preset as JSON, for `load`."""
        path = Path(path)
        content = {name: value for name, value in asdict(self).items() if value != ""}
        content["start_values"] = {name: float(value) for name, value in self.start_values.items()}
        path.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        return path

    def save_ssv(self, path: str | Path) -> Path:
        """Write the start values as a parameter set, for hosts that read ``.ssv`` files."""
        path = Path(path)
        root = xml.Element(
            f"{{{_SSV}}}ParameterSet", {"version": "1.0", "name": self.title, "description": self.about()}
        )
        parameters = xml.SubElement(root, f"{{{_SSV}}}Parameters")
        for name, value in self.start_values.items():
            parameter = xml.SubElement(parameters, f"{{{_SSV}}}Parameter", {"name": name})
            xml.SubElement(parameter, f"{{{_SSV}}}Real", {"value": repr(float(value))})
        xml.register_namespace("ssv", _SSV)
        xml.indent(root)
        xml.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
        return path


def names(model: str | None = None) -> list[str]:
    """Names of the presets of the package, of all or of one model."""
    folder = files(__package__) / "presets"
    found = sorted(entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json"))
    return [name for name in found if model is None or load(name).model == model]


def load(name: str | Path) -> Preset:
    """A preset of the package by its name, or one of a file by a path that ends in ``.json``.

    Raises `UnknownName` for an unknown name, ValueError for a file that holds no preset.
    """
    if str(name).endswith(".json"):
        text = Path(name).read_text(encoding="utf-8")
    elif str(name) in names():
        text = (files(__package__) / "presets" / f"{name}.json").read_text(encoding="utf-8")
    else:
        raise UnknownName("preset", str(name), names())
    try:
        found = json.loads(text)
    except ValueError as reason:
        raise ValueError(f"{name} is no JSON: {reason}") from None
    wanted = {field.name for field in fields(Preset) if field.default is MISSING}
    offered = {field.name for field in fields(Preset)}
    if not isinstance(found, dict) or not wanted <= set(found) <= offered:
        raise ValueError(f"{name} holds no preset, which has {', '.join(sorted(wanted))}")
    for place, value in found.items():
        if place == "start_values":
            right = isinstance(value, dict) and all(_is_number(number) for number in value.values())
        else:
            right = _is_number(value) if place in ("stop_time", "communication_step") else isinstance(value, str)
        if not right:
            raise ValueError(f"{place} of {name} is {value!r}; it must be {_KINDS.get(place, 'a text')}")
    preset = Preset(**found)
    if preset.model not in MODELS:
        raise UnknownName("actuator", preset.model, MODELS)
    return preset


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float))


def save_all(folder: str | Path) -> list[Path]:
    """Write each preset of the package with `Preset.save_ssv`, in a folder below `folder` named as its FMU."""
    written = []
    for name in names():
        preset = load(name)
        place = Path(folder) / MODELS[preset.model]
        place.mkdir(parents=True, exist_ok=True)
        written.append(preset.save_ssv(place / f"{name}.ssv"))
    return written
