"""docs/faults.md names tests that there are."""

import re
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]


def test_each_test_that_is_named_exists():
    text = (REPOSITORY / "docs" / "faults.md").read_text()
    named = re.findall(r"`(tests/[\w/.]+)::(\w+)`", text)
    rows = [line for line in text.splitlines() if line.startswith("|") and "`tests/" in line]
    assert len(named) >= len(rows) > 20
    missing = [
        f"{file}::{test}"
        for file, test in named
        if not re.search(rf"\b(fn|def) {test}\(", (REPOSITORY / file).read_text())
    ]
    assert not missing
