"""The rivals that are called from Python: heyoka, and SciPy's `solve_ivp`.

heyoka runs compiled code; only its call goes through Python, and that is taken off. SciPy calls a
right-hand side in Python, as its users do.
"""

from __future__ import annotations

import csv
import importlib.metadata
import math
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from cases import Case

LOST = 0.1
"""A run further off than this does not follow the motion at all."""

BATCHES = 7
"""A measurement is the median over this many batches."""

HEYOKA_TOLERANCES = tuple(10.0**-k for k in range(3, 16))
SCIPY_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13)
SCIPY_METHODS = ("RK45", "DOP853", "LSODA")
SCIPY_LONGEST = 2.0
"""Seconds of one SciPy run that end the sweep of its method."""

SCIPY_MOST = 2_000_000
"""Evaluations after which a run is given up: near pull-in a loose tolerance may escape and never end."""

STEPS = (0.001, 0.01, 0.1, 1.0, 10.0)

ENSEMBLE_SCENES = 64
ENSEMBLE_TIME = 2000.0
ENSEMBLE_ALLOWED = 100.0
"""Tolerances that the error may have, of ours too (src/ensemble.rs). Each compares with itself at its smallest
tolerance; there the two agree to 2e-13."""


def reference(case: Case) -> np.ndarray:
    """Rows t, λ, dλ/dt without the start."""
    with case.reference.open() as file:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    return np.array([row for row in rows if row[0] > 0])


def row(method: str, tolerance: float, **values) -> dict:
    """A row of output; what is not given stays empty."""
    empty = {"step": "", "inputs": "unchanged", "nanoseconds": "", "error": "", "hold_error": "", "note": ""}
    return {"method": method, "tolerance": tolerance, **empty, **values}


def acceleration(case: Case, x, v, phi):
    """Eq. 16 with folded surface terms, multiplied by λ⁷: products and one division."""
    linear, cubic, quintic = case.folded()
    square = x * x
    sixth = square * square * square
    elastic = square * (linear + square * (cubic - phi * phi + quintic * square))
    force = (case.number("S") * x - elastic) if case.number("S") else -elastic
    return (6.0 * v * v + square + sixth * force) / (x * (case.number("c") * sixth + 2.0))


def seconds_of(least: float, run: Callable[[], object]) -> float:
    """Seconds one call takes: the median of batches that take `least` seconds together, after one to warm up."""

    def batch(calls: int) -> float:
        begin = time.thread_time()
        for _ in range(calls):
            run()
        return time.thread_time() - begin

    batch(1)
    calls = max(1, math.ceil(least / BATCHES / batch(1)))
    return statistics.median(batch(calls) for _ in range(BATCHES)) / calls


class Heyoka:
    """heyoka's adaptive Taylor integrators, one compiled for each case and tolerance and kept."""

    def __init__(self):
        import heyoka

        self._heyoka = heyoka
        self._compiled: dict[tuple[str, float], object] = {}
        self.compile_seconds: list[float] = []
        self.version = importlib.metadata.version("heyoka")

    def _integrator(self, case: Case, tolerance: float):
        key = (case.name, tolerance)
        if key not in self._compiled:
            hy = self._heyoka
            x, v = hy.make_vars("x", "v")
            phi = hy.par[0]
            if case.number("phi_ac"):
                phi = case.number("phi_ac") * hy.sin(case.number("omega_ac") * hy.time)
                if case.number("phi"):
                    phi = case.number("phi") + phi
            system = [(x, v), (v, acceleration(case, x, v, phi))]
            begin = time.perf_counter()
            pars = [] if case.number("phi_ac") else [case.number("phi")]
            self._compiled[key] = hy.taylor_adaptive(system, [1.0, 0.0], tol=tolerance, pars=pars)
            self.compile_seconds.append(time.perf_counter() - begin)
        return self._compiled[key]

    def free(self, case: Case, least: float) -> Iterator[dict]:
        """One call of `propagate_until` to the last time. What a call that goes nowhere takes is taken off,
        and so is, in heyoka's favour, the reading at the times of the reference."""
        for tolerance in HEYOKA_TOLERANCES:
            yield self._measure("heyoka", case, tolerance, least, {})

    def steps(self, case: Case, least: float) -> Iterator[dict]:
        """Steps no longer than the communication step, all in one call, which leaves out what a call of
        each step would add."""
        exact = reference(case)
        for step in STEPS:
            few = exact[exact[:, 0] <= max(exact[0, 0], 1e5 * step)]
            result = self._measure("heyoka", case, 1e-12, least, {"max_delta_t": step}, few)
            if result["nanoseconds"] != "":
                result["nanoseconds"] *= step
            yield {**result, "step": step}

    def ensemble(self, case: Case, least: float) -> Iterator[dict]:
        """heyoka's batch mode: as many frequencies of the drive at once as a register has numbers, one
        batch after the other on one core, to the same last time. Its extremes are not looked for, in
        heyoka's favour; nanoseconds for each scene."""
        hy = self._heyoka
        lanes = hy.recommended_simd_size()
        frequencies = np.linspace(0.05, 0.3, ENSEMBLE_SCENES).reshape(-1, lanes)
        x, v = hy.make_vars("x", "v")
        phi = case.number("phi_ac") * hy.sin(hy.par[0] * hy.time)
        system = [(x, v), (v, acceleration(case, x, v, phi))]

        def follow(integrator) -> np.ndarray:
            ends = []
            for batch in frequencies:
                integrator.set_time(0.0)
                integrator.state[:] = [[1.0] * lanes, [0.0] * lanes]
                integrator.pars[0] = batch
                integrator.propagate_until(ENSEMBLE_TIME)
                ends.append(integrator.state.copy())
            return np.array(ends)

        def compiled(tolerance: float):
            start, pars = np.array([[1.0] * lanes, [0.0] * lanes]), np.zeros((1, lanes))
            return hy.taylor_adaptive_batch(system, start, tol=tolerance, pars=pars)

        exact = follow(compiled(1e-16))
        for tolerance in (1e-6, 1e-9, 1e-12):
            integrator = compiled(tolerance)
            error = float(np.abs(follow(integrator) - exact).max())
            if not error <= ENSEMBLE_ALLOWED * tolerance:
                note = f"not timed: error above {ENSEMBLE_ALLOWED:g} tolerances"
                yield row(f"heyoka batch of {lanes}", tolerance, error=error, note=note)
                continue
            seconds = seconds_of(least, partial(follow, integrator))
            nanoseconds = 1e9 * seconds / ENSEMBLE_SCENES
            about = {"inputs": "extremes not looked for", "nanoseconds": nanoseconds, "error": error}
            yield row(f"heyoka batch of {lanes}", tolerance, **about)

    def _measure(self, name, case, tolerance, least, options, exact=None) -> dict:
        exact = reference(case) if exact is None else exact
        integrator = self._integrator(case, tolerance)

        def rewind():
            integrator.time = 0.0
            integrator.state[0], integrator.state[1] = 1.0, 0.0

        def whole():
            rewind()
            integrator.propagate_until(end, **options)

        def nothing():
            rewind()
            integrator.propagate_until(0.0, **options)

        end = exact[-1, 0]
        rewind()
        states = integrator.propagate_grid(np.concatenate([[0.0], exact[:, 0]]), **options)[-1][1:]
        error = float(np.abs(states - exact[:, 1:]).max())
        if not error <= LOST:
            return row(name, tolerance, error=error, note=f"not timed: error above {LOST:g}")
        seconds = seconds_of(least, whole) - seconds_of(least, nothing)
        return row(name, tolerance, nanoseconds=1e9 * seconds / end, error=error)


class Escaped(Exception):
    """The computed motion has left every bound, or does not end."""


def scipy_free(case: Case) -> Iterator[dict]:
    """SciPy with a right-hand side in Python, one run for each tolerance."""
    from scipy.integrate import solve_ivp

    exact = reference(case)
    evaluations = 0
    amplitude, frequency, constant = (case.number(name) for name in ("phi_ac", "omega_ac", "phi"))

    def slope(t, y):
        phi = constant + amplitude * math.sin(frequency * t)
        x, v = y.tolist()
        nonlocal evaluations
        evaluations += 1
        if evaluations > SCIPY_MOST or not 0 < x < 1e3:
            raise Escaped(f"{evaluations} evaluations, stretch {x:.3g} at time {t:.4g}")
        return v, acceleration(case, x, v, phi)

    for method in SCIPY_METHODS:
        for tolerance in SCIPY_TOLERANCES:
            name, evaluations = f"SciPy {method}", 0
            begin = time.thread_time()
            try:
                span, start, times = (0, exact[-1, 0]), (1.0, 0.0), exact[:, 0]
                solution = solve_ivp(slope, span, start, method=method, t_eval=times, rtol=tolerance, atol=tolerance)
            except Escaped as reason:
                yield row(name, tolerance, note=f"failed: {reason}".replace(",", ";"))
                continue
            seconds = time.thread_time() - begin
            if not solution.success:
                yield row(name, tolerance, note="failed: " + solution.message.replace(",", ";"))
                continue
            error = float(np.abs(solution.y.T - exact[:, 1:]).max())
            if error <= LOST:
                yield row(name, tolerance, nanoseconds=1e9 * seconds / exact[-1, 0], error=error)
            else:
                yield row(name, tolerance, error=error, note=f"not timed: error above {LOST:g}")
            if seconds > SCIPY_LONGEST:
                break
