"""The live page in a real browser: it runs the actuator of the FMU, and everybody can use it."""

import base64
import itertools
import math
import os
import re
import subprocess
from pathlib import Path

import pytest

from conftest import PAGE, PATIENCE, REPOSITORY, SILICONE, fragment
from dielectric_actuator import Actuator, presets

VACUUM = 8.8541878188e-12  # F/m, CODATA 2022


def scene(device: dict) -> tuple[dict, float]:
    """The FMU's start values for a device, and the unit of its time in seconds; worked out apart from the page."""
    thickness, side = device["thickness"] * 1e-6, device["side"] * 1e-3
    modulus, density = device["modulus"] * 1e3, device["density"]
    volt = math.sqrt(VACUUM * device["relativePermittivity"] / modulus) / thickness
    second = math.sqrt(12 * modulus / (density * thickness**2))
    surface = 1e-3 / (modulus * thickness)
    return {
        "phi": device["voltage"] * volt,
        "S": device["prestress"] * 1e3 / modulus,
        "c": side**2 / thickness**2,
        "gamma_s": device["surfaceEnergy"] * surface,
        "tau_s": device["surfaceTension"] * surface,
        "E_s": device["surfaceElasticity"] * surface,
        "phi_ac": device["driveVoltage"] * volt,
        "omega_ac": 2 * math.pi * device["driveFrequency"] * 1e3 / second,
    }, 1 / second


@pytest.mark.parametrize("changes", [
    {},
    {"thickness": 1.0, "side": 0.01, "voltage": 75.0, "prestress": 30.0},
    {"driveVoltage": 250.0, "voltage": 100.0, "driveFrequency": 150.0},
    {"side": 20.0, "thickness": 50.0, "modulus": 590.0, "voltage": 4000.0, "surfaceElasticity": 0.0},
], ids=["paper", "thin", "driven", "wide"])  # fmt: skip
def test_the_motion_is_that_of_the_fmu(visit, changes):
    presses = 60
    seen = visit(fragment(**changes))
    seen.advance(presses)
    values, unit = scene({**SILICONE, **changes})
    # the page cuts what a press of the button asks for into steps that draw a smooth curve
    period = 2 * math.pi * math.sqrt((values["c"] + 2) / 6)
    drawn = 24 * values["omega_ac"] / (2 * math.pi)
    count = presses * math.ceil(period / 40 * max(96 / period, drawn))
    with Actuator() as fmu:
        fmu.start(values, tolerance=1e-10)
        time = seen.reading("time") / unit
        for _ in range(count):
            fmu.advance(time / count)
        assert seen.reading("stretch") == pytest.approx(fmu.get("lambda"), abs=1e-12)
        assert abs(seen.reading("stretch") - 1) > 1e-3
        volts = values["phi"] and {**SILICONE, **changes}["voltage"] / values["phi"]
        slow = fmu.get("phi_pull_in_static") * volts
        assert seen.reading("slowPullIn") == pytest.approx(slow, rel=1e-12)
        assert seen.reading("voltage") == pytest.approx(fmu.get("phi_total") * volts, rel=1e-10)


@pytest.mark.parametrize("changes", [
    {"thickness": 1.0, "surfaceElasticity": 1000.0}, {"voltage": 200.0, "prestress": 9.0, "surfaceElasticity": 0},
], ids=["surface", "loaded"])  # fmt: skip
def test_the_own_frequency_is_that_of_the_motion(visit, changes):
    device = {"voltage": 1.0, **changes}
    seen = visit(fragment(**device))
    states = seen.page.locator("#advance").evaluate("""(button) => Array.from({ length: 120 }, () => {
        button.click();
        const reading = (name) => Number(document.querySelector(`[data-reading=${name}]`).dataset.value);
        return [reading("time"), reading("stretch")];
    })""")
    middle = (min(stretch for _, stretch in states) + max(stretch for _, stretch in states)) / 2
    passed = [
        before + (middle - low) / (high - low) * (after - before)
        for (before, low), (after, high) in itertools.pairwise(states)
        if low < middle <= high
    ]
    measured = (len(passed) - 1) / (passed[-1] - passed[0])
    assert len(passed) > 2 and seen.reading("frequency") == pytest.approx(measured, rel=0.01)


def test_a_slider_is_moved_by_keys_and_acts_at_once(visit):
    seen = visit(fragment())
    slider = seen.page.get_by_role("slider", name="Voltage", exact=True)
    slider.focus()
    before = seen.reading("voltage")
    for _ in range(20):
        slider.press("ArrowRight")
    after = seen.reading("voltage")
    assert before == 650.0 and after > before + 10
    assert slider.get_attribute("aria-valuetext") == f"{after:.4g} V"
    seen.page.wait_for_url(lambda url: f"voltage={after:.12g}&" in url)
    seen.page.click("#advance")
    values, unit = scene({**SILICONE, "voltage": after})
    with Actuator() as fmu:
        fmu.start(values, tolerance=1e-10)
        fmu.advance(seen.reading("time") / unit)
        assert seen.reading("stretch") == pytest.approx(fmu.get("lambda"), abs=1e-12)


def test_the_snap_is_seen_and_said(visit):
    ideal = {"surfaceEnergy": 0, "surfaceTension": 0, "surfaceElasticity": 0}
    seen = visit(fragment(voltage=700, **ideal))
    sign = seen.page.locator("#sign")
    assert seen.reading("pullIn") == pytest.approx(0.6469836322448274 * 1105.523384746737, rel=1e-12)
    assert "15.3 V to go" in sign.inner_text() and sign.get_attribute("role") == "status"
    seen.page.fill("#voltage", "720")
    seen.page.press("#voltage", "Enter")
    assert "beyond pull-in" in sign.inner_text()
    seen.page.click("#restart")
    seen.page.click("#play")
    seen.page.wait_for_function("document.getElementById('sign').textContent.includes('Pulled in')")
    assert sign.get_attribute("class") == "snapped" and "10 times as wide" in sign.inner_text()
    # Only this interrupts who listens.
    assert sign.get_attribute("role") == "alert"
    seen.page.click("#restart")
    assert "Snap" not in sign.inner_text() and sign.get_attribute("role") == "status"


def test_where_nothing_bounds_the_stretch_pull_in_is_announced(visit):
    """Without surface elasticity there is no fold here, but a voltage above which the stretch grows without bound."""
    soft = {"thickness": 20, "side": 1, "modulus": 5, "surfaceEnergy": 0, "surfaceTension": 100}
    seen = visit(fragment(voltage=650, surfaceElasticity=0, **soft))
    assert "beyond pull-in from rest" in seen.page.inner_text("#sign")
    # √(4 τ_s) of the voltage scale: τ_s = 1.
    assert seen.reading("pullIn") == pytest.approx(2 * 20e-6 * math.sqrt(5e3 / (2.8 * VACUUM)), rel=1e-12)
    seen.advance(160)
    assert "Pulled in" in seen.page.inner_text("#sign")
    # With a little of it there is a fold when the voltage is raised slowly, but none from rest: τ_s = .2, E_s = .01.
    seen = visit(fragment(voltage=298, **{**soft, "surfaceTension": 20}, surfaceElasticity=1))
    assert seen.reading("slowPullIn") < seen.reading("voltage") and math.isinf(seen.reading("pullIn"))
    assert seen.page.inner_text("#sign") == "No pull-in from rest at any voltage."
    seen.advance(60)
    assert seen.reading("stretch") > 1.5 and seen.page.inner_text("#sign") == "No pull-in from rest at any voltage."


def test_below_pull_in_nothing_snaps_and_elasticity_brings_it_back(visit):
    for changes, snaps in (
        ({"surfaceElasticity": 0, "voltage": 714}, False),
        ({"surfaceElasticity": 30, "voltage": 735}, True),
    ):
        seen = visit(fragment(surfaceEnergy=0, surfaceTension=0, **changes))
        seen.advance(120)
        said = seen.page.inner_text("#sign")
        assert ("Snap!" in said) == snaps, said
        assert "Pulled in" not in said


def test_scenes_and_materials_are_the_presets_of_the_package(visit):
    seen = visit()
    offered = seen.page.locator("#preset option").all_inner_texts()
    assert sorted(offered) == sorted([*(presets.load(name).title for name in presets.names("si")), "Your own"])
    for name in ("vhb_4910_wang2016", "silicone_resonance"):
        preset = presets.load(name)
        seen.page.select_option("#preset", name)
        for key, variable, factor in (("modulus", "mu", 1e3), ("thickness", "H", 1e-6), ("driveVoltage", "V_ac", 1)):
            if variable in preset.start_values:
                shown = float(seen.page.input_value(f"#{key}")) * factor
                assert shown == pytest.approx(preset.start_values[variable], rel=1e-12)
        assert preset.description in seen.page.inner_text("#note")
    seen.page.select_option("#preset", "vhb_4910_wang2016")
    note = seen.page.inner_text("#note")
    assert "Not verified: rho" in note and "leaves out stiffening, viscosity and breakdown" in note
    seen.page.select_option("#preset", "elastosil_2030")
    assert "another end of the motion than at λ = 0.05 and 10" in seen.page.inner_text("#note")


def test_what_a_preset_asks_for_beyond_the_page_is_said(browser, tmp_path):
    asked = {"E_breakdown:3e7": "R_s:1e5,sigma:1e-12,m_load:.001,phase_ac:1", "Ecoflex 00-30": "Changed"}
    text = PAGE.read_text()
    for before, after in asked.items():
        assert text.count(before) == 1
        text = text.replace(before, after)
    changed = tmp_path / "changed.html"
    changed.write_text(text)
    with browser.new_context(offline=True, reduced_motion="reduce") as context:
        page = context.new_page()
        page.goto(changed.as_uri())
        page.select_option("#preset", label="Changed, 200 µm")
        said = "This page leaves out resistances and leaks, masses and springs on the edges and phase_ac."
        assert said in page.inner_text("#note")


def test_the_address_is_the_state(visit):
    seen = visit()
    seen.page.select_option("#preset", label="Sylgard 186, 50 µm")
    seen.page.wait_for_url(lambda url: "modulus=590&" in url)
    shared = seen.page.url.partition("#")[2]
    again = visit(shared)
    assert again.page.input_value("#modulus") == "590"
    assert again.page.locator("#preset option:checked").inner_text() == "Sylgard 186, 50 µm"
    again.page.fill("#modulus", "600")
    again.page.press("#modulus", "Enter")
    assert again.page.locator("#preset option:checked").inner_text() == "Your own"


def test_every_control_has_a_name_and_can_be_reached_by_keys(visit):
    seen = visit(fragment())
    unnamed = seen.page.evaluate("""() => [...document.querySelectorAll("input, select, button, canvas#membrane")]
        .filter((one) => !(one.labels?.length || one.getAttribute("aria-label") || one.textContent.trim()))
        .map((one) => one.id)""")
    assert not unnamed
    reached = set()
    for _ in range(60):
        seen.page.keyboard.press("Tab")
        reached.add(seen.page.evaluate("document.activeElement.id"))
    assert reached >= {"play", "restart", "advance", "pace", "share", "preset", *SILICONE}
    assert reached >= {f"{key}-slider" for key in SILICONE}
    seen.page.focus("#restart")
    seen.page.keyboard.press("Enter")
    assert seen.page.inner_text("#status") == "Restarted from rest."
    assert "%" in seen.page.get_attribute("#membrane", "aria-label")
    assert seen.page.get_attribute("#pace", "aria-valuetext") == "0.4 periods of the free motion a second"
    seen.page.press("#pace", "Home")
    assert seen.page.get_attribute("#pace", "aria-valuetext") == "0.013 periods of the free motion a second"


def test_it_stands_still_where_less_motion_is_wanted(visit):
    still, moving = visit(fragment()), visit(fragment(), reduced_motion="no-preference")
    moving.page.wait_for_function("document.querySelector('[data-reading=time]').dataset.value > 0")
    assert still.reading("time") == 0.0
    assert still.page.inner_text("#play") == "Play" and moving.page.inner_text("#play") == "Pause"


def test_the_address_is_written_seldom_and_the_page_goes_on_without(browser, address):
    with browser.new_context(offline=True, reduced_motion="reduce") as context:
        page, errors = context.new_page(), []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(f"{address}#{fragment()}")
        page.wait_for_selector("html[data-ready=true]")
        page.evaluate("""() => {
            window.written = 0;
            history.replaceState = () => { window.written += 1; throw new Error("too many"); };
            const slider = document.getElementById("voltage-slider");
            for (let place = 0; place < 50; place += 1) {
                slider.value = place;
                slider.dispatchEvent(new Event("input"));
            }
        }""")
        page.wait_for_function("window.written > 0")
        assert page.evaluate("window.written") < 3
        page.click("#advance")
        assert "Stretch" in page.inner_text("#status") and not errors


@pytest.mark.parametrize("changes", [
    {"thickness": 1000}, {"thickness": 30, "side": 0.03, "surfaceTension": 200, "surfaceElasticity": 0, "modulus": 5},
], ids=["thick", "contracting"])  # fmt: skip
def test_a_thick_film_is_drawn_inside_the_picture(visit, changes):
    seen = visit(fragment(**{"voltage": 0, **changes}))
    # Half a period; of each picture the uppermost line is added to a copy.
    painted = seen.page.locator("#advance").evaluate("""(button) => {
        const canvas = document.getElementById("membrane");
        const copy = new OffscreenCanvas(canvas.width, 1).getContext("2d", { willReadFrequently: true });
        for (let step = 0; step < 25; step += 1) {
            button.click();
            copy.drawImage(canvas, 0, 0);
        }
        return copy.getImageData(0, 0, canvas.width, 1).data.some((part) => part > 0);
    }""")
    assert not painted and seen.page.evaluate("document.getElementById('membrane').height") > 100


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 400])
def test_it_fits_and_is_drawn_in_both_schemes(visit, width, scheme):
    seen = visit(fragment(surfaceElasticity=0, voltage=715), width=width, color_scheme=scheme)
    seen.advance(100)
    assert seen.page.evaluate("document.documentElement.scrollWidth") <= width
    # Each canvas shows more than one colour.
    colours = seen.page.evaluate("""() => [...document.querySelectorAll("canvas")].map((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return new Set(new Uint32Array(data.buffer)).size;
    })""")
    assert len(colours) == 5 and min(colours) > 5
    paper = seen.page.evaluate("getComputedStyle(document.body).backgroundColor")
    bright = sum(map(int, re.findall(r"\d+", paper)[:3])) > 3 * 128
    assert bright == (scheme == "light")
    folder = PAGE.parent / "screenshots"
    folder.mkdir(exist_ok=True)
    seen.page.screenshot(path=folder / f"{scheme}_{width}.png", full_page=True)


def test_the_page_stands_alone_and_is_put_together_the_same_again(tmp_path):
    text = PAGE.read_text()
    assert "uPlot" in text and "Permission is hereby granted" in text
    assert not re.search(r'(src|href)="(?!data:|#)', text)
    core = REPOSITORY / "target" / "wasm32-unknown-unknown" / "page" / "page_core.wasm"
    code = core.read_bytes()
    assert base64.b64encode(code).decode() in text
    for place in map(str, (REPOSITORY, Path.home() / ".cargo")):
        assert place not in text and place.encode() not in code
    environment = dict(os.environ)
    assert "NODE" in environment, 'run by make test, or after eval "$(make -s env)"'
    again = tmp_path / "again.html"
    subprocess.run(
        [environment["NODE"], REPOSITORY / "page" / "build.mjs", core, PAGE.parent / "licences.txt", again],
        check=True, timeout=600,
    )  # fmt: skip
    assert again.read_bytes() == PAGE.read_bytes()


def test_a_browser_without_vectors_is_told_what_it_lacks(browser, address):
    refuse = "WebAssembly.instantiate = () => Promise.reject(new WebAssembly.CompileError('no vectors'))"
    with browser.new_context(offline=True) as context:
        page = context.new_page()
        page.add_init_script(refuse)
        page.goto(address)
        page.get_by_role("status").get_by_text("WebAssembly with vectors").wait_for(timeout=PATIENCE)
