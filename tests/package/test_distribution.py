"""What the wheel says of itself."""

import ast
import importlib.metadata
import re
import sys
from pathlib import Path

import dielectric_actuator

HERE = Path(dielectric_actuator.__file__).parent
OWN = "dielectric-actuator"


def imported() -> set[str]:
    """The distributions whose modules the package imports, at its start or later."""
    modules = set()
    for path in HERE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                modules.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                modules.add(node.module)
    names = {module.partition(".")[0] for module in modules} - sys.stdlib_module_names - {HERE.name}
    providers = importlib.metadata.packages_distributions()
    return {providers[name][0].lower() for name in names}


def test_the_wheel_asks_for_what_it_imports_and_for_nothing_else():
    """The environment of these tests has more than that."""
    asked = {re.match(r"[\w.-]+", entry)[0].lower() for entry in importlib.metadata.requires(OWN)}
    assert imported() == asked - {OWN}
