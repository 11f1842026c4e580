"""Derive amplitudes.json in multiprecision.

    python tests/reference/derive_amplitudes.py > tests/reference/amplitudes.json

Needs mpmath, which the project itself does not. Takes a few minutes.

* Constant voltage (Appendix A, escape times): quadrature of dt = dλ sqrt(−2M / D) with M = c + 2λ⁻⁶ and D
  of Eq. 19, 40 digits.
* Harmonic drive: Taylor series of Eq. 16 at 30 digits, twice with different order and step; the digits in
  which the two runs agree are written. Extremes are roots of the rate's Taylor polynomial.
"""

import json
import sys
from functools import partial
from typing import Any

from mpmath import cos, findroot, inf, mp, mpf, nstr, pi, polyval, quad, sin, sqrt

EXTREMES_PER_STEP = 8


def inertia(stretch, c):
    return c + 2 * stretch**-6


def drive(stretch, phi):
    """−D/(λ − 1) of Eq. 19 for the ideal actuator, factored so that nothing cancels at λ = 1."""
    elastic = (stretch - 1) * (stretch + 1) ** 2 * (2 * stretch**2 + 1) / stretch**4
    return phi**2 * (stretch + 1) * (stretch**2 + 1) - elastic


def periodic_orbit(c, phi, guess):
    """Period and turning stretch of the ideal actuator from rest."""
    turn = findroot(lambda stretch: drive(stretch, phi), guess)
    half = (turn - 1) / 2

    def integrand(angle):  # λ = 1 + half (1 + sin angle) takes the square roots out of both ends
        stretch = 1 + half * (1 + sin(angle))
        return half * cos(angle) * sqrt(2 * inertia(stretch, c) / ((stretch - 1) * drive(stretch, phi)))

    return 2 * quad(integrand, [-pi / 2, 0, pi / 2], method="gauss-legendre"), turn


def escape_time(c, phi):
    """Time from rest at λ = 1 to λ = ∞; λ = 1 + x² takes the square root out of the start."""

    def integrand(x):
        stretch = 1 + x**2
        return 2 * sqrt(2 * inertia(stretch, c) / drive(stretch, phi))

    return quad(integrand, [0, mpf(1) / 2, 1, 2, 5, 20, inf])


def driven_amplitude(g, tau, E, phi_a, omega, T, order, step):
    """(max − min)/2 of λ⁻² over [0, T] from rest under phi_a sin(omega t), c = 100, S = 0."""
    g, tau, E, phi_a, omega, T, step = (mpf(x) for x in (g, tau, E, phi_a, omega, T, step))
    c, a1, a3, a5 = mpf(100), 1 + 2 * g - 2 * tau + E, 4 * tau - 4 * E, 3 * E
    stretch, rate, time = mpf(1), mpf(0), mpf(0)
    reached = [stretch]
    while time < T:
        span = min(step, T - time)
        stretches, rates = taylor(stretch, rate, time, c, a1, a3, a5, phi_a, omega, order)
        falling_rates, falling_stretches = rates[::-1], stretches[::-1]
        left, rate_left = mpf(0), rate
        for part in range(1, EXTREMES_PER_STEP + 1):
            right = span * part / EXTREMES_PER_STEP
            rate_right = polyval(falling_rates, right)
            if rate_left * rate_right < 0:
                turn = findroot(partial(polyval, falling_rates), (left, right), solver="anderson", tol=1e-40)
                reached.append(polyval(falling_stretches, turn))
            left, rate_left = right, rate_right
        stretch, rate, time = polyval(falling_stretches, span), rate_left, time + span
    reached.append(stretch)
    return (min(reached) ** -2 - max(reached) ** -2) / 2


def taylor(stretch, rate, time, c, a1, a3, a5, phi_a, omega, order, prestress=0, offset=0):
    """Taylor coefficients of λ and dλ/dt.

    Eq. 16 reads M λ'' = 6 λ⁻⁷ λ'² + S + λ⁻⁵ − a1 λ − (a3 − φ²) λ³ − a5 λ⁵, φ = offset + phi_a sin(omega t).
    """

    def product(p, q, k):
        return mp.fdot(p[: k + 1], q[k::-1])

    # φ² = phi_a² (1 − cos 2 omega t)/2
    voltage = [-(phi_a**2) / 2 * cos(2 * omega * time), phi_a**2 * omega * sin(2 * omega * time)]
    for k in range(2, order):
        voltage.append(-((2 * omega) ** 2) * voltage[k - 2] / (k * (k - 1)))
    voltage[0] += phi_a**2 / 2
    if offset:  # φ² has offset² + 2 offset phi_a sin(omega t) too
        terms = [2 * offset * phi_a * sin(omega * time), 2 * offset * phi_a * omega * cos(omega * time)]
        for k in range(2, order):
            terms.append(-(omega**2) * terms[k - 2] / (k * (k - 1)))
        terms[0] += offset**2
        voltage = [one + other for one, other in zip(voltage, terms, strict=True)]

    L, V = [stretch], [rate]
    rows: list[list[Any]] = [[] for _ in range(12)]
    A, V2, L2, L3, L5, U, U2, U3, U5, U6, U7, M = rows
    for k in range(order):
        U.append(1 / L[0] if k == 0 else -mp.fdot(L[1 : k + 1], U[k - 1 :: -1]) / L[0])
        for series, (p, q) in ((U2, (U, U)), (U3, (U, U2)), (U5, (U2, U3)), (U6, (U3, U3)), (U7, (U6, U))):
            series.append(product(p, q, k))
        for series, (p, q) in ((V2, (V, V)), (L2, (L, L)), (L3, (L, L2)), (L5, (L2, L3))):
            series.append(product(p, q, k))
        M.append(2 * U6[k] + (c if k == 0 else 0))
        force = 6 * product(U7, V2, k) + U5[k] - a1 * L[k] - a3 * L3[k] + product(voltage, L3, k) - a5 * L5[k]
        if k == 0:
            force += prestress
        A.append((force - (mp.fdot(M[1 : k + 1], A[k - 1 :: -1]) if k else 0)) / M[0])
        V.append(A[k] / (k + 1))
        L.append(V[k] / (k + 1))
    return L, V


def agreed(one, other, most=20):
    """The decimal digits that two results share."""
    digits = most
    while nstr(one, digits) != nstr(other, digits):
        digits -= 1
    return nstr(one, digits)


def main():
    mp.dps = 40
    period, turn = periodic_orbit(mpf(25), mpf("0.5"), mpf("1.118"))
    appendix_a = {
        **dict(g="0", tau="0", E="0", S="0", c=25, phi=0.5),
        **dict(T=nstr(period, 18), lam_other=nstr(turn, 18), lam3_other=nstr(turn**-2, 18)),
    }
    escape = [
        {"c": 100, "phi": float(phi), "t": nstr(escape_time(mpf(100), mpf(phi)), 18)} for phi in ("0.65", "0.7", "1")
    ]
    mp.dps = 30
    driven = []
    for omega, T in (("0.1438", 2000), ("0.2764", 5000)):
        results = [
            driven_amplitude("0.05", "0.05", "0.2", "0.3", omega, T, order, step)
            for order, step in ((44, "1"), (36, "0.6180339887"))
        ]
        driven.append(
            {
                **dict(g="0.05", tau="0.05", E="0.2", S="0", phi_a=0.3, omega=float(omega), T=T),
                **dict(amplitude=agreed(*results)),
            }
        )
    note = (
        "Derived by derive_amplitudes.py; see README.md. g,tau,E,S are gamma_s,tau_s,E_s,S; "
        "strings keep all trusted digits."
    )
    json.dump(dict(note=note, appendix_a=appendix_a, escape=escape, driven=driven), sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
