"""The end of ``make test``: what was passed over, what failed, and how many tests ran.

    python tests/summary.py REPORTS [FAILED ...]

Reads the JUnit reports below the folder REPORTS, and the file `notes` there, a line for each check that was
passed over; FAILED names the checks that failed. Ends with status 1 if a check or a test failed or no test ran.
"""

import sys
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree


def main() -> int:
    """Print the summary and return the status."""
    reports, failed_checks = Path(sys.argv[1]), sys.argv[2:]
    counts: Counter[str] = Counter(passed=0, failed=0, skipped=0)
    passed_over = notes.read_text().splitlines() if (notes := reports / "notes").exists() else []
    failures = [f"the check {name}" for name in failed_checks]
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


def outcome_of(case: ElementTree.Element) -> tuple[str, str]:
    """Whether a test case passed, failed or was skipped, and why it was skipped."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed", ""
    skipped = case.find("skipped")
    return ("passed", "") if skipped is None else ("skipped", skipped.get("message") or "no reason given")


if __name__ == "__main__":
    sys.exit(main())
