"""The regenerated paper: its numbers in a small version, and `make paper` from end to end."""

import csv
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import allowed_errors as allowed
import figure_style as style
import references
from paper import chaos, driven, equation, escape, maps, resonance, resonance_entries, scenes, slips, thresholds
from paper.independent import DrivenRuns, embedded_pair
from paper.resonance import Peak
from paper.thickness_range import amplitudes, ranges
from paper.workers import Workers
from progress import Progress
from references import SurfaceEffects

REPOSITORY = Path(__file__).resolve().parents[2]
REFERENCE = scenes.varied("E_s", 0.2, 0.0)


@pytest.fixture(scope="module")
def workers(fmu_path):
    style.apply()
    with Workers(fmu_path, 1, Progress(1)) as one:
        yield one
    style.plt.close("all")


def test_the_equation_as_printed_has_the_known_thresholds():
    for known in references.table_1() + references.combined_thresholds():
        if 2 * (known.case.gamma_s + known.case.tau_s) >= known.case.S or known.case.S == 0:
            found = equation.threshold(known.case)
            assert found.phi == pytest.approx(known.dynamic.phi, rel=1e-12), known.case
            assert found.lambda3 == pytest.approx(known.dynamic.lambda3, rel=1e-9), known.case


def test_the_jacobian_is_the_slope_of_the_acceleration():
    case, stretch, rate, voltage_squared, step = equation.Cases(0.05, 0.03, 0.2, 0.5), 1.3, 0.02, 0.1, 1e-6
    acceleration, by_stretch, by_rate = case.linearised(stretch, rate, voltage_squared)
    assert acceleration == pytest.approx(case.acceleration(stretch, rate, voltage_squared), abs=1e-15)
    for found, d_stretch, d_rate in ((by_stretch, step, 0.0), (by_rate, 0.0, step)):
        ends = [case.acceleration(stretch + s * d_stretch, rate + s * d_rate, voltage_squared) for s in (1, -1)]
        assert found == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-9)


def test_time_by_quadrature_is_that_of_the_motion(actuator):
    orbit = references.appendix_a_orbit()
    for share in (0.1, 0.5, 0.99):
        stretch = 1 + share * (orbit.turning_lambda - 1)
        actuator.start(orbit.scene(), tolerance=allowed.TOLERANCE)
        actuator.advance(equation.time_to(orbit.case, orbit.phi, stretch, orbit.c))
        assert actuator.get("lambda") == pytest.approx(stretch, abs=1e-12)


def test_thickness_range_of_orbits(actuator):
    for orbit in references.dc_orbits():
        ((lowest, highest),) = ranges(actuator, orbit.scene(), (3 * orbit.period,), allowed.TOLERANCE)
        assert (lowest, highest) == pytest.approx(sorted((1.0, orbit.turning_lambda3)), abs=1e-12), orbit.case


@pytest.mark.parametrize("reference", references.driven_amplitudes(), ids=lambda r: f"omega={r.omega_ac:g}")
def test_amplitude_in_one_communication_step(actuator, reference):
    windows = (reference.stop_time / 2, reference.stop_time)
    half, whole = amplitudes(actuator, reference.scene(), windows, allowed.TOLERANCE)
    assert abs(whole - reference.amplitude) <= allowed.AMPLITUDE
    assert half < whole


def test_amplitude_without_the_fmu():
    reference = references.driven_amplitudes()[0]
    (found,) = DrivenRuns([reference.case], np.array([reference.omega_ac]), reference.phi_ac).amplitudes(
        reference.stop_time
    )
    assert abs(found - reference.amplitude) <= 1e-9  # DOP853 at 1e-12 over 2000 time units


def test_vanishing_elasticity(actuator):
    exact = next(c for c in references.cusps() if c.kind == "dynamic" and c.S == 0 and c.gamma_s_minus_tau_s == 0)
    assert thresholds.vanishing_elasticity(actuator) == pytest.approx(exact.E_s, abs=1e-12)


def test_table_1_marks_its_one_wrong_entry(actuator):
    entry = thresholds.table_1(actuator)
    assert [row.quantity for row in entry.rows if row.misprinted] == ["E_s = 0.029: phi^C"]
    assert "29 of 30" in entry.claims[0].finding
    assert max(abs(row.difference) for row in entry.rows) < 1e-14


def test_figures_4_and_5_lie_on_the_exact_curves(actuator):
    assert max(abs(row.difference) for row in thresholds.figure_4(actuator).rows) < 1e-11
    rows = thresholds.figure_5(actuator, 20).rows
    # the stretch at E* hangs on E* like a root
    assert all(abs(row.difference) < (1e-6 if row.quantity == "lambda3 there" else 1e-12) for row in rows)
    style.plt.close("all")


@pytest.mark.parametrize(
    "branch, window, at, height",
    [
        ("harmonic", 2000.0, 0.14384, 0.79),
        ("subharmonic", 2000.0, 0.06921, 0.118),
        ("superharmonic", 5000.0, 0.27643, 0.236),
    ],
)
def test_peaks_are_refined_to_the_highest_amplitude(actuator, branch, window, at, height):
    low, high = resonance.SPANS[branch]
    omega = np.arange(low, high, 4e-4)
    coarse = resonance.scan(actuator, (REFERENCE, omega, (window,)))[:, 0]
    starts = resonance.starts(omega, coarse, (low, high))
    peak = resonance.refine(actuator, (REFERENCE, window, starts, 4e-4))
    assert peak.omega == pytest.approx(at, abs=2e-5)
    assert peak.amplitude == pytest.approx(height, abs=2e-3)
    around = np.linspace(peak.omega - 4e-4, peak.omega + 4e-4, 40)
    assert resonance.scan(actuator, (REFERENCE, around, (window,))).max() <= peak.amplitude + 1e-4


def test_the_jump_separates_the_two_motions(actuator):
    peak = Peak(0.14384, float(amplitudes(actuator, REFERENCE.scene(phi_ac=0.3, omega_ac=0.14384), (5000.0,), 1e-9)[0]))
    omega, below, above = resonance.find_jump(actuator, (REFERENCE, 5000.0, peak))
    low, high = resonance.scan(actuator, (REFERENCE, np.array([omega + 1e-8, omega - 1e-8]), (5000.0,)))[:, 0]
    assert (low, high) == (pytest.approx(above, abs=0.02), pytest.approx(below, abs=0.02))
    assert high > 2 * low


def test_peaks_are_checked_against_the_independent_integrator(actuator):
    ((*rows,),) = resonance_entries.check_peaks(actuator, ([(REFERENCE, 0.0692)], 500.0))
    assert len(rows) == 3
    assert max(abs(row.difference) for row in rows) < 1e-10


def test_printed_resonances_have_42_entries_for_14_cases():
    printed = scenes.printed_resonances()
    assert len(printed) == 42 and len(scenes.cases()) == 14
    assert printed[scenes.varied("gamma_s", 0.1, 0.0), "harmonic"] == "0.1471"
    assert printed[scenes.varied("E_s", 0.0, 0.5), "superharmonic"] == "0.2239"
    for parameter, rows in scenes.PRINTED.items():  # the reference row stands in all three tables
        assert rows[1] == scenes.PRINTED["gamma_s"][1], parameter


def test_indicators_tell_order_from_chaos(actuator):
    cases = [scenes.varied("gamma_s", 0.1, 0.0), chaos.CHAOTIC[1][0]]
    omega, phi_ac = np.array([0.1471, chaos.CHAOTIC[1][1]]), np.array([0.3, chaos.CHAOTIC[1][2]])
    found = DrivenRuns(cases, omega, phi_ac).indicators(np.array([200.0, 600.0]))
    regular, chaotic = found.megno[:, -1]
    assert regular < 2.5 < 4 < chaotic
    assert found.exponent[0, -1] < math.log(600) / 600 < found.exponent[1, -1]
    actuator.start(cases[0].scene(phi_ac=0.3, omega_ac=0.1471), tolerance=allowed.TOLERANCE)
    actuator.advance(600.0)
    assert actuator.get("lambda") == pytest.approx(found.stretch[0, -1], abs=1e-9)


def test_the_loose_pair_is_far_off_and_converges(actuator):
    run = scenes.shown_run("gamma_s", "harmonic", 0.0)
    times = np.array([500.0, 2500.0])
    actuator.start(run.scene(), tolerance=allowed.TOLERANCE)
    exact = []
    for time in times:
        actuator.advance(time - actuator.time)
        exact.append(actuator.get("lambda"))
    errors = [
        np.abs(embedded_pair(run.case, scenes.PHI_AC, run.omega, times, rtol, rtol / 1000)[0] - exact).max()
        for rtol in (1e-3, 1e-7)
    ]
    assert errors[0] > 0.05
    assert errors[1] < 1e-4


def test_sections_of_regular_motion_are_curves(actuator):
    regular = driven.follow(actuator, (scenes.shown_run("E_s", "near-resonant", 0.0), 10.0, 1500))
    assert driven.dimension(regular.section[1:]) == pytest.approx(1, abs=0.1)
    case, omega, phi_ac = chaos.CHAOTIC[0]
    period = math.pi / omega
    chaotic = actuator.run(
        case.scene(phi_ac=phi_ac, omega_ac=omega),
        stop_time=1500 * period,
        communication_step=period,
        outputs=driven.OUTPUTS,
    )
    assert driven.dimension(chaotic[1:]) > 1.3 > driven.CURVE


def test_period_grows_with_the_rate_of_the_saddle(workers):
    for row in maps.period_curve(workers, 8).rows:
        assert row.measured == pytest.approx(row.exact, rel=2e-4), row.quantity


def test_pull_in_map_agrees_with_the_threshold_variable(actuator):
    voltages = np.linspace(0.05, 1.0, 20)
    for S in (0.0, 0.35, 0.8):
        found = maps.pull_in_row(actuator, (SurfaceEffects(0.0, 0.0, 0.0, 0.0), S, voltages))
        threshold = actuator.get("phi_pull_in")
        assert np.array_equal(np.isfinite(found[:, 1]), voltages > threshold)


def test_escape_under_the_drive_is_that_of_a_single_run(actuator):
    early, never = escape.escape_row(actuator, (0.7, np.array([0.06, 0.3])))
    response = actuator.run(
        {"phi_ac": 0.7, "omega_ac": 0.06, **escape.LIMITS},
        stop_time=early + 1,
        communication_step=0.5,
        outputs=["lambda", "pulled_in"],
    )
    assert response["time"][response["pulled_in"]][0] == pytest.approx(early, abs=0.5)
    assert never == math.inf


def test_a_motion_that_comes_back_from_ten_is_no_escape_yet(actuator):
    passed = {name: value for name, value in escape.SLOW_ESCAPE.items() if name not in escape.LIMITS}
    for scene, instant in ((passed, 927.44966491), (escape.SLOW_ESCAPE, 1251.031)):  # DOP853 at 1e-13
        actuator.start(scene, tolerance=allowed.TOLERANCE)
        actuator.advance(1500.0)
        assert actuator.get("pull_in_time") == pytest.approx(instant, abs=1e-3)


def test_thickness_inertia_is_a_percent_or_so():
    assert slips.thickness_inertia() == pytest.approx(0.0082, abs=0.002)


def test_the_small_version_from_end_to_end(fmu_path, tmp_path):
    done = subprocess.run(
        [
            *(sys.executable, "-W", "error", "-m", "paper", "--small", "--workers", "2"),
            *("--fmu", fmu_path, "--output", tmp_path),
        ],
        cwd=REPOSITORY / "studies",
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    assert done.stderr == ""
    wanted = {f"figure_{n:02}" for n in range(2, 13)} | {f"figure_B_{n}" for n in range(1, 5)}
    wanted |= {f"table_{n}" for n in range(1, 5)} | {
        "figure_A_1",
        "map_pull_in",
        "map_thresholds",
        "period",
        "map_escape",
    }
    for key in wanted:
        assert (tmp_path / f"{key}.png").read_bytes().startswith(b"\x89PNG"), key
        with (tmp_path / f"{key}.csv").open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        assert rows and all(len(row) == len(header) for row in rows), key
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for key in wanted:
        assert f"id='{key}'" in page, key
    assert not re.search(r"(src|href)='(?!data:|#|\w+\.csv')", page), "the report needs no other file"
    assert all((tmp_path / name).is_file() for name in re.findall(r"href='(\w+\.csv)'", page))
    assert "0.68984" in page and "0.0295185" in page
    with (tmp_path / "table_1.csv").open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            assert float(row["phi_fmu"]) == pytest.approx(float(row["phi_exact"]), rel=allowed.THRESHOLD_RELATIVE)


def test_without_an_fmu_it_says_what_to_do(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "paper", "--fmu", str(tmp_path / "none.fmu"), "--output", str(tmp_path / "out")],
        cwd=REPOSITORY / "studies",
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "make fmu" in done.stderr
    assert not (tmp_path / "out").exists()
