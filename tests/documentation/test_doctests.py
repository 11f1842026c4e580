"""The code in the doc comments of the Rust sources runs. cargo-nextest leaves it out; here it has a time limit."""

import re
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]


def test_the_code_in_doc_comments_runs():
    done = subprocess.run(
        ["cargo", "test", "--workspace", "--doc"],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=800,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    passed = re.findall(r"^test result: ok\. (\d+) passed", done.stdout, flags=re.MULTILINE)
    assert sum(map(int, passed)) > 0, done.stdout
