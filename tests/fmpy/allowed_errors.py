"""Every error that the FMPy tests allow, with its reason. Absolute and nondimensional unless it says relative."""

TOLERANCE = 1e-12
"""Relative tolerance asked of the integrator wherever a reference has more digits than the default serves."""

TRAJECTORY = {"case_a": 2e-14, "case_b": 2e-14, "case_d": 2e-12}
"""λ and dλ/dt against the multiprecision trajectories, at every communication step. Measured: 1.6e-15 and, under the
alternating voltage, 1.2e-13."""

TRAJECTORY_DEFAULT = 5e-13
"""As TRAJECTORY under constant inputs, at the default tolerance 1e-10. Measured: 3.3e-14."""

PERIOD_RELATIVE = 1e-13
TURN_RELATIVE = 1e-14
"""Period and turning thickness stretch, relative. Measured: 5.0e-15 and 6.7e-16."""

RETURN = 1e-11
"""Distance from λ = 1 and from zero rate after one exact period: ten times the tolerance asked for."""

TURNING_RATE = 1e-11
"""Stretch rate left at half the exact period, likewise."""

ENERGY = 1e-11
"""Drift of the Hamiltonian at constant inputs, whose terms are of order 0.1: the delivery's bound."""

PULL_IN_RESOLUTION = 1e-10
PULL_IN_BY_MOTION = 1e-10
"""Voltage at which the motion changes sides: the bisection's resolution. The delivery asks for 1e-6."""

THRESHOLD_RELATIVE = 5e-15
"""Thresholds that the FMU computes itself, relative, against the 16 digits of Table 1. Measured: 2.8e-16."""

THRESHOLD_RELATIVE_TO_14_DIGITS = 1e-13
"""As THRESHOLD_RELATIVE, against the other references: half a unit of their last digit is up to 2.8e-14."""

CUSP_OFFSET = 1e-9
"""Relative distance from E* at which a fold must exist below and must not above. E* is known to 12 digits."""

CUSP_STRETCH = 1e-4
"""Thickness stretch of a fold that close to its cusp: it leaves the cusp's like the root of the offset, 3e-5."""

CUSP_VOLTAGE = 1e-9
"""φ² there: it leaves the cusp's in proportion to the offset."""

EQUILIBRIUM = 1e-14
"""d²λ/dt² at the fold's stretch: forces of order 1, rounded, over the inertia c = 100."""

AMPLITUDE = 1e-11
"""Amplitude over thousands of time units: every extreme is a root of the interpolated rate (turning_points.py,
3e-12 at the step used), the rest is integration error."""

ESCAPE = 1e-11
"""Instant of escape, up to 68: time at the limit plus the quadrature from there to infinity."""

SAME_MOTION = 1e-11
"""Two runs over at most 100 time units that solve the same problem through different calls."""

CHIRP = 1e-9
"""λ and dλ/dt over 300 changes of the frequency against DOP853 at a relative tolerance of 1e-12 in each step."""

CVODE = 1e-6
"""λ and dλ/dt by CVODE (BDF of order 1 to 5) at its tolerance of 1e-10 over 100 time units, some 30 periods where
c = 2: its local errors add up to 5e-7 there, 2e-8 in the slow scenes, and fall with its tolerance."""

CVODE_EVENT = 1e-6
"""The instant of collapse by CVODE at the same tolerance: 4e-7 off, 1e-5 at 1e-8."""
