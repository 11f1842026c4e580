"""Eq. 16 written out in numpy, with its Jacobian, and the stagnation curve of Eq. 19.

It shares no line with the FMU: Eq. 16 is taken as printed, with nothing folded. Every function takes arrays,
so that one call serves many cases; ``Cases`` holds their parameters in columns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from references import PullIn, SurfaceEffects


@dataclass(frozen=True)
class Cases:
    """Parameters of Eq. 16 as floats or as arrays of one length."""

    gamma_s: np.ndarray | float
    tau_s: np.ndarray | float
    E_s: np.ndarray | float
    S: np.ndarray | float
    c: np.ndarray | float = 100.0

    @classmethod
    def of(cls, cases: list[SurfaceEffects], c: float = 100.0) -> Cases:
        gamma_s, tau_s, E_s, S = (
            np.array([getattr(case, name) for case in cases]) for name in ("gamma_s", "tau_s", "E_s", "S")
        )
        return cls(gamma_s, tau_s, E_s, S, c)

    def inertia(self, stretch):
        """c + 2λ⁻⁶."""
        return self.c + 2 * stretch**-6.0

    def force(self, stretch, voltage_squared):
        """All terms of Eq. 16 that hold no rate, on its right-hand side."""
        square = stretch * stretch
        surface = self.gamma_s + self.tau_s * (2 * square - 1) + self.E_s / 2 * (square - 1) * (3 * square - 1)
        return self.S + voltage_squared * stretch * square - stretch + stretch**-5.0 - 2 * stretch * surface

    def stiffness(self, stretch, voltage_squared):
        """−∂force/∂λ."""
        square = stretch * stretch
        surface = self.gamma_s + self.tau_s * (6 * square - 1)
        elastic = self.E_s / 2 * (15 * square * square - 12 * square + 1)
        return -3 * voltage_squared * square + 1 + 5 * stretch**-6.0 + 2 * (surface + elastic)

    def acceleration(self, stretch, rate, voltage_squared):
        """d²λ/dt²."""
        sixth = stretch**-6.0
        return (6 * sixth / stretch * rate * rate + self.force(stretch, voltage_squared)) / (self.c + 2 * sixth)

    def linearised(self, stretch, rate, voltage_squared):
        """d²λ/dt² and its derivatives with respect to λ and dλ/dt, with the powers shared."""
        square, inverse = stretch * stretch, 1 / stretch
        sixth = (inverse * inverse) ** 3
        seventh = sixth * inverse
        inertia = self.c + 2 * sixth
        twice_rate = 6 * seventh * rate
        surface = self.gamma_s + self.tau_s * (2 * square - 1) + self.E_s / 2 * (square - 1) * (3 * square - 1)
        force = self.S + stretch * (voltage_squared * square - 1 + sixth - 2 * surface)
        acceleration = (twice_rate * rate + force) / inertia
        bend = self.gamma_s + self.tau_s * (6 * square - 1) + self.E_s / 2 * ((15 * square - 12) * square + 1)
        stiffness = 1 + 5 * sixth + 2 * bend - 3 * voltage_squared * square
        by_stretch = (12 * seventh * acceleration - 7 * inverse * twice_rate * rate - stiffness) / inertia
        return acceleration, by_stretch, 2 * twice_rate / inertia

    def resistance(self, stretch):
        """What the springs and the prestress hold in Eq. 19, all terms without φ, divided by λ − 1.

        Factored, since the terms as printed cancel near λ = 1: 2λ² + λ⁻⁴ − 3 = (λ² − 1)² (2λ² + 1) λ⁻⁴.
        """
        square = stretch * stretch
        bulk = (stretch - 1) * (stretch + 1) ** 2 * (2 * square + 1) / (square * square)
        surface = self.gamma_s + self.tau_s * square + self.E_s / 2 * square * (square - 1)
        return bulk - 4 * self.S + 4 * (stretch + 1) * surface

    def stagnation(self, stretch):
        """φ² at which a motion from rest at λ = 1 turns at this stretch (Eq. 19)."""
        return self.resistance(stretch) / ((stretch + 1) * (stretch * stretch + 1))


def extrema(case: SurfaceEffects, highest: float = 8.0) -> list[tuple[PullIn, bool]]:
    """Extrema of the stagnation curve on 1 < λ < `highest` in order of stretch, each with whether it is a maximum.

    They are the common roots of Eqs. 19 and 20 but for the one at λ = 1. Pairs closer than 1e-4 are missed.
    """
    one = Cases.of([case])

    def slope(stretch: float) -> float:  # of the stagnation curve, up to a positive factor
        return -float(one.force(stretch, one.stagnation(stretch))[0])

    grid = np.geomspace(1 + 1e-4, highest, 20_000)
    rising = one.force(grid, one.stagnation(grid)) < 0
    turns = np.flatnonzero(rising[:-1] != rising[1:])
    roots = [brentq(slope, grid[k], grid[k + 1], xtol=1e-15) for k in turns]
    return [(PullIn(float(one.stagnation(root)[0]) ** 0.5, root**-2), bool(rising[k])) for k, root in zip(turns, roots)]


def threshold(case: SurfaceEffects) -> PullIn:
    """Dynamic pull-in: the first extremum if that is a maximum; +inf and 0 where there is none."""
    return next((pull_in for pull_in, is_maximum in extrema(case)[:1] if is_maximum), PullIn(float("inf"), 0.0))


def escape_rate(case: SurfaceEffects, pull_in: PullIn, c: float = 100.0) -> float:
    """Eigenvalue of the saddle at pull-in: near it the motion leaves like exp(rate t)."""
    one = Cases.of([case], c)
    return float(np.sqrt(-one.stiffness(pull_in.stretch, pull_in.phi**2) / one.inertia(pull_in.stretch))[0])


def time_to(case: SurfaceEffects, phi: float, stretch: float, c: float) -> float:
    """Time from rest at λ = 1 to `stretch` before the first turn, by quadrature of Eq. 19."""
    one = Cases.of([case], c)

    def integrand(x: float) -> float:  # λ = 1 + x² takes the square root out of the start
        here = 1 + x * x
        excess = phi**2 * (here + 1) * (here * here + 1) - float(one.resistance(here)[0])
        return 2 * (2 * one.inertia(here) / excess) ** 0.5

    return quad(integrand, 0, (stretch - 1) ** 0.5, epsabs=1e-13, epsrel=1e-12, limit=200)[0]
