"""The motions that are timed. All start from rest at λ = 1; the quantities are those of the FMU."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


@dataclass(frozen=True)
class Case:
    """One motion, its reference, and how it is called in plots and tables."""

    name: str
    title: str
    reference: Path
    c: str = "100"
    gamma_s: str = "0"
    tau_s: str = "0"
    E_s: str = "0"
    S: str = "0"
    phi: str = "0"
    phi_ac: str = "0"
    omega_ac: str = "0"
    spacing: str = ""
    """The time between two rows of the reference, where derive_references.py derives it."""

    stepped: bool = False
    """Whether the co-simulation pattern is timed on it too."""

    QUANTITIES = ("c", "gamma_s", "tau_s", "E_s", "S", "phi", "phi_ac", "omega_ac")

    def number(self, quantity: str) -> float:
        return float(getattr(self, quantity))

    def arguments(self) -> list[str]:
        """The case as the Rust and C programs take it."""
        values = [f"{quantity}={getattr(self, quantity)}" for quantity in self.QUANTITIES]
        return [*values, f"reference={self.reference}"]

    def folded(self) -> tuple[float, float, float]:
        """Coefficients of λ, λ³ and λ⁵ with the surface effects folded in."""
        gamma, tau, elasticity = (self.number(name) for name in ("gamma_s", "tau_s", "E_s"))
        return 1 + 2 * gamma - 2 * tau + elasticity, 4 * tau - 4 * elasticity, 3 * elasticity


_REFERENCE_SET: dict[str, Any] = {"gamma_s": "0.05", "tau_s": "0.05", "E_s": "0.2"}
_SHARED = ROOT / "tests" / "reference"
_OWN = HERE / "references"

CASES = (
    Case("a", "DC", _SHARED / "case_a.csv", phi="0.6", stepped=True, **_REFERENCE_SET),
    Case("b", "DC with prestress", _SHARED / "case_b.csv", phi="0.6", S="0.5", **_REFERENCE_SET),
    Case("c", "DC near pull-in", _OWN / "case_c.csv", phi="0.646", spacing="25"),
    Case(
        *("d", "AC near resonance", _SHARED / "case_d.csv"),
        gamma_s="0.1",
        tau_s="0.05",
        E_s="0.2",
        phi_ac="0.3",
        omega_ac="0.1471",
        stepped=True,
    ),
    Case(
        *("e", "AC, superharmonic", _OWN / "case_e.csv"),
        phi_ac="0.3",
        omega_ac="0.2764",
        spacing="100",
        **_REFERENCE_SET,
    ),
)

RANDOM_SETS = 12
SEED = 5


def _rounded(value: float) -> str:
    return f"{value:.3g}"


def random_cases() -> tuple[Case, ...]:
    """Driven motions of random actuators, r1 to r12: each with surface effects, prestress, an offset
    voltage and a drive slower or faster than the actuator. Every fourth has no surface elasticity and a
    voltage that may bring it near escape: r8 swings from λ = 0.59 to 2.10. The span is 200 time scales
    √((c + 2)/6)."""
    draw = random.Random(SEED).uniform
    cases = []
    for number in range(1, RANDOM_SETS + 1):
        near_escape = number % 4 == 0
        c = 10 ** draw(0, 6)
        scale = math.sqrt((c + 2) / 6)
        most = 0.02 if near_escape else 0.1
        case = Case(
            f"r{number}",
            f"random set {number}" + (", no surface elasticity" if near_escape else ""),
            _OWN / f"case_r{number}.csv",
            c=_rounded(c),
            gamma_s=_rounded(draw(0, most)),
            tau_s=_rounded(draw(0, most)),
            E_s="0" if near_escape else _rounded(draw(0, 0.4)),
            S=_rounded(draw(0, most if near_escape else 0.3)),
            phi=_rounded(draw(0.24, 0.28) if near_escape else draw(0.1, 0.3)),
            phi_ac=_rounded(draw(0.34, 0.38) if near_escape else draw(0.1, 0.4)),
            omega_ac=_rounded(10 ** draw(-0.7, -0.3 if near_escape else 0.4) / scale),
            spacing=_rounded(10 * scale),
        )
        cases.append(case)
    return tuple(cases)


ALL_CASES = (*CASES, *random_cases())


DEVICE_SCENES = {
    "plain": ("A_si_dc_step", "plain, the paper's silicone"),
    "viscous": ("D_kv_step", "viscous, ζ = 0.054"),
    "comparable": ("B_rc_step", "RC an eighth of the period"),
    "stiff": ("own_stiff_rc", "RC a millionth of the period"),
    "branches": ("F_sls_creep_vhb", "three Maxwell branches, 245 periods"),
}
"""Of the real device: the scene in tests/reference/device and the title, by name."""
