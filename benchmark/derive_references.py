"""Derive references/case_c.csv and references/case_e.csv in multiprecision.

    python benchmark/derive_references.py

Needs mpmath, which the benchmark itself does not. Taylor series of Eq. 16 at 40 digits, twice with
different order and step; the digits in which the two runs agree are written. Takes a few minutes.
"""

from __future__ import annotations

import sys

from mpmath import mp, mpf, nstr, polyval

from cases import CASES, ROOT, Case

sys.path.insert(0, str(ROOT / "tests" / "reference"))
from derive_amplitudes import taylor

SPACING = {"c": 25, "e": 100}
OUTPUTS = 20
WAYS = ((40, mpf("0.5")), (32, mpf("0.3")))
MOST_DIGITS = 31


def states(case: Case, order: int, step: mpf) -> list[tuple[mpf, mpf]]:
    """λ and dλ/dt at the output times."""
    q = {name: mpf(getattr(case, name)) for name in case.QUANTITIES}
    a1 = 1 + 2 * q["gamma_s"] - 2 * q["tau_s"] + q["E_s"]
    a3 = 4 * q["tau_s"] - 4 * q["E_s"] - q["phi"] ** 2  # a constant voltage acts like a cubic spring
    a5 = 3 * q["E_s"]
    stretch, rate, time, reached = mpf(1), mpf(0), mpf(0), []
    for output in range(1, OUTPUTS + 1):
        end = mpf(output * SPACING[case.name])
        while time < end:
            span = min(step, end - time)
            series = taylor(stretch, rate, time, q["c"], a1, a3, a5, q["phi_ac"], q["omega_ac"], order)
            stretch, rate = (polyval(terms[::-1], span) for terms in series)
            time += span
        reached.append((stretch, rate))
    return reached


def agreed(one: mpf, other: mpf) -> str:
    """The decimal digits that two results share."""
    digits = MOST_DIGITS
    while nstr(one, digits) != nstr(other, digits):
        digits -= 1
    return nstr(one, digits)


def main() -> None:
    mp.dps = 40
    for case in CASES:
        if case.name not in SPACING:
            continue
        one, other = (states(case, order, step) for order, step in WAYS)
        lines = ["t,lam,v", "0,1,0"]
        for output, pairs in enumerate(zip(one, other), start=1):
            cells = [agreed(a, b) for a, b in zip(*pairs)]
            lines.append(",".join([str(output * SPACING[case.name]), *cells]))
        case.reference.parent.mkdir(exist_ok=True)
        case.reference.write_text("\n".join(lines) + "\n")
        print(case.reference.name, lines[-1])


if __name__ == "__main__":
    main()
