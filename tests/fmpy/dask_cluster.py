"""A Dask cluster of processes that know the package and nothing else of this checkout."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from distributed import Client


@contextmanager
def started(folder: Path, count: int) -> Iterator[tuple[str, subprocess.Popen, list[subprocess.Popen]]]:
    """The address of a scheduler, its process, and those of its workers, which nothing starts again."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    found, log = folder / "scheduler.json", folder / "log"
    where = ["--scheduler-file", found, "--no-dashboard"]
    worker = ["dask_worker", "--no-nanny", "--nthreads", "1", "--local-directory", folder]
    commands = [["dask_scheduler", "--port", "0", "--host", "127.0.0.1"], *[worker] * count]
    with log.open("w") as errors:
        processes = [
            subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{name}", *options, *where],
                cwd=folder,
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=errors,
            )
            for name, *options in commands
        ]
    try:
        scheduler, *workers = processes
        while not (found.exists() and found.stat().st_size):
            assert all(process.poll() is None for process in processes), log.read_text()
            time.sleep(0.05)
        address = json.loads(found.read_text())["address"]
        if count:
            with Client(address, timeout=300) as client:
                client.wait_for_workers(count, timeout=300)
        yield address, scheduler, workers
    finally:
        for process in processes:
            process.kill()
            process.wait()
