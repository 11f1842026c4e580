"""The motions that are timed. All start from rest at λ = 1; the quantities are those of the FMU."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

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


_REFERENCE_SET = {"gamma_s": "0.05", "tau_s": "0.05", "E_s": "0.2"}
_SHARED = ROOT / "tests" / "reference"
_OWN = HERE / "references"

CASES = (
    Case("a", "DC", _SHARED / "case_a.csv", phi="0.6", stepped=True, **_REFERENCE_SET),
    Case("b", "DC with prestress", _SHARED / "case_b.csv", phi="0.6", S="0.5", **_REFERENCE_SET),
    Case("c", "DC near pull-in", _OWN / "case_c.csv", phi="0.646"),
    Case(
        *("d", "AC near resonance", _SHARED / "case_d.csv"),
        **dict(gamma_s="0.1", tau_s="0.05", E_s="0.2", phi_ac="0.3", omega_ac="0.1471", stepped=True),
    ),
    Case("e", "AC, superharmonic", _OWN / "case_e.csv", phi_ac="0.3", omega_ac="0.2764", **_REFERENCE_SET),
)
