"""Derive the references of the cases that have a spacing in multiprecision.

    python benchmark/derive_references.py [CASE ...]

Needs mpmath, which the benchmark itself does not. Taylor series of Eq. 16 at 40 digits, twice with
different order and step; the digits in which the two runs agree are written. Takes a few minutes.
"""

from __future__ import annotations

import sys
from decimal import Decimal

from mpmath import mp, mpf, nstr, polyval, sqrt

from cases import ALL_CASES, ROOT, Case

sys.path.insert(0, str(ROOT / "tests" / "reference"))
from derive_amplitudes import taylor

OUTPUTS = 20
WAYS = ((40, mpf("0.12")), (32, mpf("0.07")))
"""Order, and step in units of the time scale √((c + 2)/6)."""

MOST_DIGITS = 31


def states(case: Case, order: int, step: mpf) -> list[tuple[mpf, mpf]]:
    """λ and dλ/dt at the output times."""
    q = {name: mpf(getattr(case, name)) for name in case.QUANTITIES}
    a1 = 1 + 2 * q["gamma_s"] - 2 * q["tau_s"] + q["E_s"]
    a3 = 4 * q["tau_s"] - 4 * q["E_s"]
    if not q["phi_ac"]:
        a3 -= q["phi"] ** 2  # a constant voltage acts like a cubic spring
    a5 = 3 * q["E_s"]
    offset = q["phi"] if q["phi_ac"] else mpf(0)
    step *= sqrt((q["c"] + 2) / 6)
    stretch, rate, time, reached = mpf(1), mpf(0), mpf(0), []
    for output in range(1, OUTPUTS + 1):
        end = output * mpf(case.spacing)
        while time < end:
            span = min(step, end - time)
            drive = (q["phi_ac"], q["omega_ac"], order, q["S"], offset)
            series = taylor(stretch, rate, time, q["c"], a1, a3, a5, *drive)
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
    wanted = sys.argv[1:] or [case.name for case in ALL_CASES if case.spacing]
    for case in ALL_CASES:
        if case.name not in wanted:
            continue
        one, other = (states(case, order, step) for order, step in WAYS)
        lines = ["t,lam,v", "0,1,0"]
        for output, pairs in enumerate(zip(one, other), start=1):
            cells = [agreed(a, b) for a, b in zip(*pairs)]
            time = output * Decimal(case.spacing)
            lines.append(",".join([format(time.normalize(), "f"), *cells]))
        case.reference.parent.mkdir(exist_ok=True)
        case.reference.write_text("\n".join(lines) + "\n")
        print(case.reference.name, lines[-1])


if __name__ == "__main__":
    main()
