"""The plots: run time against error, and time of a call against the communication step."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from cases import CASES, ROOT
from ratios import FLOOR

sys.path.insert(0, str(ROOT / "studies"))
import matplotlib.pyplot as plt

import figure_style as style

OURS: dict[str, Any] = {"color": style.COLOURS[1], "linewidth": 2.4, "zorder": 4}
LOOKS: dict[str, dict[str, Any]] = {
    "ours, packed FMU": {**OURS, "marker": "o"},
    "ours without orbit reuse": {**OURS, "marker": "o", "markerfacecolor": "white", "linestyle": (0, (4, 1.5))},
    "ours baseline SIMD without orbit reuse": {**OURS, "marker": ".", "linewidth": 1.2, "linestyle": ":"},
    "heyoka": {"color": style.COLOURS[0], "marker": "s", "linewidth": 2},
    "differential-equations rkv988e": {"color": style.COLOURS[2], "marker": "^"},
    "ode_solvers Dop853": {"color": style.COLOURS[3], "marker": "v", "linestyle": (0, (5, 1.6))},
    "diffsol tsit45": {"color": style.COLOURS[5], "marker": "D", "linestyle": (0, (1.2, 1.2))},
    "CVODE Adams": {"color": style.BLACK, "marker": "x"},
    "SciPy DOP853": {"color": style.GREY, "marker": "^"},
    "SciPy RK45": {"color": style.GREY, "marker": "v", "linestyle": (0, (5, 1.6))},
    "SciPy LSODA": {"color": style.GREY, "marker": "x", "linestyle": (0, (1.2, 1.2))},
}
STEP_LOOKS: dict[tuple[str, str], tuple[str, dict[str, Any]]] = {
    ("ours", "unchanged"): ("ours, inputs unchanged", {**OURS, "marker": "o"}),
    ("ours", "held"): ("ours, voltage set at each call", {**OURS, "marker": "v", "linestyle": (0, (4, 1.5))}),
    ("ours", "linear"): ("… and its 1st derivative", {**OURS, "marker": ".", "linewidth": 1.2, "linestyle": "--"}),
    ("ours", "cubic"): ("… and its 1st to 3rd derivative", {**OURS, "marker": ".", "linewidth": 1.2, "linestyle": ":"}),
    ("heyoka", "unchanged"): ("heyoka, call not counted", LOOKS["heyoka"]),
    ("Reference FMU VanDerPol", "unchanged"): (
        "Reference FMU VanDerPol\n(forward Euler, inexact)",
        {"color": style.COLOURS[2], "marker": "^"},
    ),
    ("CVODE Adams continued", "unchanged"): ("CVODE, continued", {"color": style.BLACK, "marker": "x"}),
    ("CVODE Adams re-initialised", "unchanged"): (
        "CVODE, re-initialised",
        {"color": style.GREY, "marker": "x", "linestyle": (0, (5, 1.6))},
    ),
}


def work_precision(rows: list[dict], path: Path) -> Path:
    """One panel a case: nanoseconds for each unit of time against the largest error."""
    style.apply()
    figure, panels = plt.subplots(2, 3, figsize=(13, 8), sharex=True, sharey=True)
    panels = panels.ravel()
    for case, axes in zip(CASES, panels):
        for method, look in LOOKS.items():
            points = [
                (max(float(row["error"]), FLOOR), float(row["nanoseconds"]))
                for row in rows
                if row["case"] == case.name and row["method"] == method and row["nanoseconds"] not in ("", None)
            ]
            if points:
                axes.loglog(*zip(*points), label=method, markersize=5, **look)
        axes.set_title(f"({case.name})  {case.title}", loc="left")
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(f"largest error of {style.SYMBOLS['lambda']} and {style.SYMBOLS['lambda_dot']}")
    for axes in panels[::3]:
        axes.set_ylabel(f"nanoseconds for each unit of {style.SYMBOLS['time']}")
    panels[0].set_xlim(1e-1, 1e-15)
    rest = panels[len(CASES)]
    rest.axis("off")
    handles = {}
    for axes in panels[: len(CASES)]:
        handles.update({name: handle for handle, name in zip(*axes.get_legend_handles_labels())})
    shown = [name for name in LOOKS if name in handles]
    rest.legend([handles[name] for name in shown], shown, loc="center left")
    figure.suptitle("Run time against error: further down is faster, further right more accurate")
    return _save_small(figure, path)


def co_simulation(rows: list[dict], path: Path) -> Path:
    """One panel a case: nanoseconds for each call against the communication step, tolerance 1e-12."""
    style.apply()
    cases = [case for case in CASES if case.stepped]
    figure, panels = plt.subplots(1, len(cases), figsize=(13, 5), sharex=True, sharey=True)
    for case, axes in zip(cases, panels):
        for (method, inputs), (label, look) in STEP_LOOKS.items():
            points = [
                (float(row["step"]), float(row["nanoseconds"]))
                for row in rows
                if (row["case"], row["method"], row["inputs"]) == (case.name, method, inputs)
                and row["nanoseconds"] not in ("", None)
                and float(row["tolerance"]) in (1e-12, 1e-2)
            ]
            if points:
                axes.loglog(*zip(*sorted(points)), label=label, markersize=5, **look)
        axes.set_title(f"({case.name})  {case.title}", loc="left")
        axes.set_xlabel("communication step")
    panels[0].set_ylabel("nanoseconds for each call")
    panels[-1].legend(**style.BESIDE)
    figure.suptitle("Time of a communication step, read included, at the tolerance 1e-12")
    return _save_small(figure, path)


DEVICE_LOOKS = {
    "packed FMU": LOOKS["ours, packed FMU"],
    "heyoka": LOOKS["heyoka"],
    "CVODE Adams": LOOKS["CVODE Adams"],
    "CVODE BDF": {"color": style.COLOURS[2], "marker": "^"},
    "ARKODE Kvaerno 5": {"color": style.COLOURS[3], "marker": "v", "linestyle": (0, (5, 1.6))},
    "SciPy Radau": {"color": style.GREY, "marker": "D", "linestyle": (0, (1.2, 1.2))},
}


def device(rows: list[dict], titles: dict[str, str], path: Path) -> Path:
    """One panel a scene of the real device: milliseconds of a run against the largest error."""
    style.apply()
    figure, panels = plt.subplots(2, 3, figsize=(13, 8), sharex=True, sharey=True)
    panels = panels.ravel()
    for letter, (name, title), axes in zip("abcde", titles.items(), panels):
        for method, look in DEVICE_LOOKS.items():
            points = sorted(
                (max(float(row["error"]), FLOOR), 1e-6 * float(row["nanoseconds"]))
                for row in rows
                if row["case"] == name and row["method"] == method and row["nanoseconds"] not in ("", None)
            )
            if points:
                axes.loglog(*zip(*points), label=method, markersize=5, **look)
        axes.set_title(f"({letter})  {title}", loc="left")
        axes.tick_params(labelbottom=True)
        axes.set_xlabel("largest error of stretch, rate and charge")
    for axes in panels[::3]:
        axes.set_ylabel("milliseconds of a run")
    panels[0].set_xlim(1e-1, 1e-15)
    rest = panels[len(titles)]
    rest.axis("off")
    handles = {}
    for axes in panels[: len(titles)]:
        handles.update({name: handle for handle, name in zip(*axes.get_legend_handles_labels())})
    rest.legend(list(handles.values()), list(handles), loc="center left")
    figure.suptitle("Real device, run time against error: further down is faster, further right more accurate")
    return _save_small(figure, path)


def _save_small(figure, path: Path) -> Path:
    """As a picture of few colours, which a plot has anyhow."""
    from PIL import Image

    style.save(figure, path)
    Image.open(path).convert("RGB").quantize(64, dither=Image.Dither.NONE).save(path, optimize=True)
    return path
