"""What is amiss in the paper's text itself, with the numbers that show it."""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.integrate import quad

from paper.entries import Claim
from paper.equation import Cases
from references import SurfaceEffects, dc_orbits

SHEAR_MODULUS = 303e3
SURFACE = {"γ̄ₛ": 0.02, "τ̄ₛ": 0.02, "Ēₛ": 0.126}
"""Section 3: µ in Pa, and γ_s, τ_s, E_s in N/m."""


def slips() -> list[Claim]:
    """Statements of the text that its own equations and numbers contradict."""
    ranges = {
        name: [f"{value / (SHEAR_MODULUS * thickness):.3g}" for thickness in (10e-6, 1e-6)]
        for name, value in SURFACE.items()
    }
    return [
        Claim(
            "Section 3: for H = 1 to 10 µm γ̄ₛ and τ̄ₛ span 0.007 to 0.1, Ēₛ 0.04 to 0.4.",
            None,
            "From the paper's µ and surface parameters: "
            + "; ".join(f"{name} {low} to {high}" for name, (low, high) in ranges.items())
            + ". The value 0.1 of γ̄ₛ and τ̄ₛ belongs to a thinner film.",
        ),
        Claim(
            "Below Eq. 7: the through-thickness inertia is negligible.",
            None,
            "Eqs. 14 and 16 keep it all the same (2λ⁻⁶ beside c), and so does the FMU. It makes the period of the "
            f"reference motion of Fig. 2 {100 * thickness_inertia():.2f} % longer at c = 100.",
        ),
        Claim(
            "Eq. 12: the work of the in-plane forces is −2P(λ − 1).",
            False,
            "It lacks a length: Eq. 13 has −2PL(λ − 1).",
        ),
        Claim(
            "Eq. 4: γₛ is the energy per undeformed area.",
            False,
            "The sentence before says per deformed area, and Eq. 9 multiplies by the deformed one, L²λ².",
        ),
        Claim("Section 3.1: λᶜ is the critical stretch.", None, "It is a thickness stretch, 1/λₘ², as below Eq. 20."),
        Claim("Fig. 7 belongs to the time histories of Fig. 7.", False, "To those of Fig. 6."),
        Claim("Appendix A: the formulation (Eq. 15).", False, "Eq. 16 is meant; Eq. 15 holds the scales."),
    ]


def thickness_inertia() -> float:
    """By how much the term 2λ⁻⁶ lengthens the period of Fig. 2's reference motion, relative. By quadrature."""
    orbit = next(orbit for orbit in dc_orbits() if orbit.case == SurfaceEffects(0.05, 0.05, 0.2, 0.0))
    one = Cases.of([orbit.case], orbit.c)
    half = (orbit.turning_lambda - 1) / 2

    def half_period(inertia: Callable) -> float:
        def integrand(angle: float) -> float:  # λ = 1 + half (1 − cos angle) takes the roots out of both ends
            stretch = 1 + half * (1 - math.cos(angle))
            excess = orbit.phi**2 * (stretch + 1) * (stretch * stretch + 1) - float(one.resistance(stretch)[0])
            return half * math.sin(angle) * math.sqrt(2 * inertia(stretch) / ((stretch - 1) * excess))

        # at the ends themselves the integrand reads 0/0
        return quad(integrand, 1e-6, math.pi - 1e-6)[0]

    return half_period(one.inertia) / half_period(lambda _stretch: orbit.c) - 1
