"""The end of ``make test``: what was passed over, what failed, and how many tests ran.

    python tests/summary.py REPORTS

Reads the JUnit reports below the folder REPORTS, and two files there with a line for each check: `notes` for one that
was passed over, `failed` for one that failed. Ends with status 1 if a check or a test failed or no test ran.
"""

import sys
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree


def main() -> int:
    """Print the summary and return the status."""
    reports = Path(sys.argv[1])
    counts: Counter[str] = Counter(passed=0, failed=0, skipped=0)
    passed_over = lines_of(reports / "notes")
    failures = [f"the check {name}" for name in lines_of(reports / "failed")]
    for path in sorted(reports.rglob("*.xml")):
        for case in ElementTree.parse(path).iter("testcase"):
            name = f"{case.get('classname')} {case.get('name')}"
            outcome, reason = outcome_of(case)
            counts[outcome] += 1
            if outcome == "failed":
                failures.append(name)
            elif outcome == "skipped":
                passed_over.append(f"{name}: {reason}")
    print("\n==> Summary")
    for heading, lines in (("passed over", passed_over), ("failed", failures)):
        for line in lines:
            print(f"{heading}: {line}")
    print(f"{counts['passed']} passed, {counts['failed']} failed, {counts['skipped']} skipped")
    return int(bool(failures) or not counts["passed"])


def lines_of(path: Path) -> list[str]:
    """The lines of a file, none where there is no file."""
    return path.read_text().splitlines() if path.exists() else []


def outcome_of(case: ElementTree.Element) -> tuple[str, str]:
    """Whether a test case passed, failed or was skipped, and why it was skipped."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed", ""
    skipped = case.find("skipped")
    return ("passed", "") if skipped is None else ("skipped", skipped.get("message") or "no reason given")


if __name__ == "__main__":
    sys.exit(main())
