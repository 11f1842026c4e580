"""The values in tests/reference as Python objects: multiprecision results and the numbers printed in the paper.

The files keep more digits than a double holds; here each number is the nearest double.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parents[1] / "tests" / "reference"


@dataclass(frozen=True)
class SurfaceEffects:
    """Surface parameters and prestress of one case (nondimensional, Eq. 15)."""

    gamma_s: float
    tau_s: float
    E_s: float
    S: float

    def scene(self, **further: float) -> dict[str, float]:
        """As start values of the FMU, with further ones beside them."""
        return {"gamma_s": self.gamma_s, "tau_s": self.tau_s, "E_s": self.E_s, "S": self.S, **further}

    def __str__(self) -> str:
        return f"gamma_s={self.gamma_s:g} tau_s={self.tau_s:g} E_s={self.E_s:g} S={self.S:g}"


@dataclass(frozen=True)
class PullIn:
    """Voltage and thickness stretch at pull-in; +inf and 0 where the actuator has none, as the FMU says it."""

    phi: float
    lambda3: float

    @property
    def exists(self) -> bool:
        return math.isfinite(self.phi)

    @property
    def stretch(self) -> float:
        """The in-plane stretch there, λ = λ₃^(-1/2)."""
        return self.lambda3**-0.5


@dataclass(frozen=True)
class Threshold:
    """Dynamic (Eqs. 19, 20; from rest at λ = 1) and static pull-in of one case.

    `printed_phi` and `printed_lambda3` are the entries of the paper's Table 1 as printed, None elsewhere.
    """

    case: SurfaceEffects
    dynamic: PullIn
    static: PullIn
    printed_phi: str | None = None
    printed_lambda3: str | None = None


@dataclass(frozen=True)
class Cusp:
    """Surface elasticity above which the fold, `kind` "dynamic" or "static", has vanished.

    It depends on γ_s − τ_s and S only. `shifted_phi_squared` is φ² − 4τ_s there, None where not recorded.
    """

    kind: str
    gamma_s_minus_tau_s: float
    S: float
    E_s: float
    lambda3: float
    shifted_phi_squared: float | None


@dataclass(frozen=True)
class PeriodicOrbit:
    """Motion from rest at λ = 1 under a constant voltage: period, and the stretches where it turns back."""

    case: SurfaceEffects
    c: float
    phi: float
    period: float
    turning_lambda: float
    turning_lambda3: float

    def scene(self) -> dict[str, float]:
        return self.case.scene(c=self.c, phi=self.phi)


@dataclass(frozen=True)
class DrivenAmplitude:
    """Half the range of λ₃ over [0, `stop_time`] from rest under φ = `phi_ac` sin(`omega_ac` t)."""

    case: SurfaceEffects
    phi_ac: float
    omega_ac: float
    stop_time: float
    amplitude: float

    def scene(self) -> dict[str, float]:
        return self.case.scene(phi_ac=self.phi_ac, omega_ac=self.omega_ac)


@dataclass(frozen=True)
class Escape:
    """Instant at which the stretch from rest at λ = 1 becomes infinite under a constant voltage."""

    c: float
    phi: float
    time: float


@cache
def _json(name: str) -> dict:
    return json.loads((FOLDER / name).read_text(encoding="utf-8"))


def _case(row: dict) -> SurfaceEffects:
    tau_s = row["tau"] if "tau" in row else row["t"]
    return SurfaceEffects(float(row["g"]), float(tau_s), float(row["E"]), float(row["S"]))


def _pull_in(phi: str | None, lambda3: str | None) -> PullIn:
    return PullIn(math.inf, 0.0) if phi is None or lambda3 is None else PullIn(float(phi), float(lambda3))


def _thresholds(block: str) -> list[Threshold]:
    return [
        Threshold(
            _case(row),
            _pull_in(row["phiC"], row["lam3C"]),
            _pull_in(row["phi_static"], row["lam3_static"]),
            row.get("paper_phiC"),
            row.get("paper_lam3C"),
        )
        for row in _json("thresholds_periods.json")[block]
    ]


def table_1() -> list[Threshold]:
    """The 13 different rows of the paper's Table 1, with exact values beside the printed ones."""
    return _thresholds("table1")


def combined_thresholds() -> list[Threshold]:
    """Thresholds with surface effects and prestress together, among them cases without a fold."""
    return _thresholds("thresholds_combined")


def cusps() -> list[Cusp]:
    """Surface elasticities at which the folds vanish."""
    return [
        Cusp(
            row["kind"],
            float(row["g_minus_tau"]),
            float(row["S"]),
            float(row["E_star"]),
            float(row["lam3"]),
            None if row["phi2_minus_4tau"] is None else float(row["phi2_minus_4tau"]),
        )
        for row in _json("thresholds_periods.json")["cusp_E_star"]
    ]


def dc_orbits() -> list[PeriodicOrbit]:
    """The 14 parameter sets of the paper's Figs. 2 and 3 (φ = 0.6, c = 100)."""
    return [
        PeriodicOrbit(
            _case(row),
            float(row["c"]),
            float(row["phi"]),
            float(row["T"]),
            float(row["lam_other"]),
            float(row["lam3_other"]),
        )
        for row in _json("thresholds_periods.json")["periods_dc"]
    ]


def appendix_a_orbit() -> PeriodicOrbit:
    """The ideal actuator of the paper's Appendix A (L = 10 mm, H = 2 mm, so c = 25; φ = 0.5)."""
    row = _json("amplitudes.json")["appendix_a"]
    return PeriodicOrbit(
        _case(row), row["c"], row["phi"], float(row["T"]), float(row["lam_other"]), float(row["lam3_other"])
    )


def driven_amplitudes() -> list[DrivenAmplitude]:
    """Amplitudes under the harmonic drive at given frequency and window."""
    return [
        DrivenAmplitude(_case(row), row["phi_a"], row["omega"], row["T"], float(row["amplitude"]))
        for row in _json("amplitudes.json")["driven"]
    ]


def ideal_escapes() -> list[Escape]:
    """Escape of the ideal actuator (no surface effects, no prestress) above its pull-in voltage."""
    return [Escape(row["c"], row["phi"], float(row["t"])) for row in _json("amplitudes.json")["escape"]]


TRAJECTORY_SCENES = {
    "case_a": SurfaceEffects(0.05, 0.05, 0.2, 0.0).scene(phi=0.6),
    "case_b": SurfaceEffects(0.05, 0.05, 0.2, 0.5).scene(phi=0.6),
    "case_d": SurfaceEffects(0.1, 0.05, 0.2, 0.0).scene(phi_ac=0.3, omega_ac=0.1471),
}
"""Start values of the reference trajectories."""


def trajectory(name: str) -> np.ndarray:
    """A reference trajectory by its name in `TRAJECTORY_SCENES`: fields t, lam (λ) and v (dλ/dt)."""
    return np.genfromtxt(FOLDER / f"{name}.csv", delimiter=",", names=True)
