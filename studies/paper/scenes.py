"""The parameter sets of the paper's Sections 3.1 and 3.2 and the numbers that it prints for them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from references import SurfaceEffects

REFERENCE = {"gamma_s": 0.05, "tau_s": 0.05, "E_s": 0.2}
"""What the two parameters that are not varied are held at, in Figs. 2, 3, 8 to 12 and Tables 2 to 4."""
VALUES = {"gamma_s": (0.0, 0.05, 0.1), "tau_s": (0.0, 0.05, 0.1), "E_s": (0.0, 0.2, 0.4)}
PRESTRESSES = (0.0, 0.5)
PHI_AC = 0.3
C = 100.0

BRANCHES = ("harmonic", "subharmonic", "superharmonic")
"""The paper's names. The voltage enters as φ², so that the forcing has frequency 2ω: harmonic is 2ω near the
natural frequency, subharmonic half of that, superharmonic twice (parametric resonance)."""

PRINTED = {
    "gamma_s": (
        ("0.1402", "0.1343", "0.0670", "0.0622", "0.2683", "0.2506"),
        ("0.1433", "0.1350", "0.0692", "0.0630", "0.2762", "0.2545"),
        ("0.1471", "0.1372", "0.0708", "0.0641", "0.2841", "0.2591"),
    ),
    "tau_s": (
        ("0.1362", "0.1302", "0.0661", "0.0593", "0.2612", "0.2404"),
        ("0.1433", "0.1350", "0.0692", "0.0630", "0.2762", "0.2545"),
        ("0.1499", "0.1423", "0.0731", "0.0651", "0.2895", "0.2675"),
    ),
    "E_s": (
        ("0.1331", "0.1172", "0.0669", "0.0552", "0.2651", "0.2239"),
        ("0.1433", "0.1350", "0.0692", "0.0630", "0.2762", "0.2545"),
        ("0.1495", "0.1468", "0.0717", "0.0685", "0.2873", "0.2769"),
    ),
}
"""Tables 2 to 4 as printed: a row for each of `VALUES`, and for each of `BRANCHES` the two `PRESTRESSES`."""

TABLES = {"gamma_s": 2, "tau_s": 3, "E_s": 4}


def varied(parameter: str, value: float, prestress: float) -> SurfaceEffects:
    """The reference set with one surface parameter changed."""
    return SurfaceEffects(**{**REFERENCE, parameter: value}, S=prestress)


def cases() -> list[SurfaceEffects]:
    """The 14 different sets of Tables 2 to 4 and Fig. 8: seven sets of surface parameters, two prestresses."""
    return list(dict.fromkeys(varied(p, value, S) for S in PRESTRESSES for p in VALUES for value in VALUES[p]))


def printed_resonances() -> dict[tuple[SurfaceEffects, str], str]:
    """The 42 different entries of Tables 2 to 4."""
    found = {}
    for parameter, rows in PRINTED.items():
        for value, row in zip(VALUES[parameter], rows):
            for position, entry in enumerate(row):
                case = varied(parameter, value, PRESTRESSES[position % 2])
                found[case, BRANCHES[position // 2]] = entry
    return found


EXTREME = {"gamma_s": 0.1, "tau_s": 0.1, "E_s": 0.4}
"""The three cases of Figs. 9 to 12 and B.1 to B.4: one surface parameter at its largest value."""
NEAR_RESONANT = "near-resonant"
DETUNING = 0.95
"""ω over the printed harmonic resonance in Figs. 12 and B.4. Our choice: the paper does not give the frequency."""


@dataclass(frozen=True)
class DrivenRun:
    """One run from rest under φ_a = `PHI_AC`; `regime` is a branch or near-resonant."""

    case: SurfaceEffects
    regime: str
    omega: float

    def scene(self) -> dict[str, float]:
        return self.case.scene(phi_ac=PHI_AC, omega_ac=self.omega)

    @property
    def forcing_period(self) -> float:
        """π/ω: the voltage enters as φ²."""
        return math.pi / self.omega


def shown_run(parameter: str, regime: str, prestress: float) -> DrivenRun:
    """The run of Figs. 9 to 12, B.1 to B.4 for one case, at the frequency printed in Tables 2 to 4."""
    case = varied(parameter, EXTREME[parameter], prestress)
    if regime == NEAR_RESONANT:
        return DrivenRun(case, regime, DETUNING * float(printed_resonances()[case, "harmonic"]))
    return DrivenRun(case, regime, float(printed_resonances()[case, regime]))


def driven_runs() -> list[DrivenRun]:
    """The 42 runs at the frequencies printed in Tables 2 to 4, and the six near resonance."""
    printed = [DrivenRun(case, branch, float(omega)) for (case, branch), omega in printed_resonances().items()]
    return printed + [shown_run(parameter, NEAR_RESONANT, S) for S in PRESTRESSES for parameter in EXTREME]
