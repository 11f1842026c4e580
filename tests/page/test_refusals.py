"""What the live page refuses, and that nothing else changes by it."""

import re

import pytest

from conftest import SILICONE, fragment

REFUSING = """
    const instantiate = WebAssembly.instantiate;
    WebAssembly.instantiate = async (binary) => {
        const { exports } = (await instantiate(binary)).instance;
        const refuses = (value) => Math.abs(value - window.refused) < 1e-9 * value;
        const actuator_set = (reference, value) => (refuses(value) ? 0 : exports.actuator_set(reference, value));
        const actuator_step = (length) => (window.refused === "step" ? 0 : exports.actuator_step(length));
        return { instance: { exports: { ...exports, actuator_set, actuator_step } } };
    };
"""
"""A model that refuses a number which the page lets through, or a step."""

VOLTAGE = "Voltage of 1.000·10⁹ V is above 11050 V, the most for this device; set that or less"
THICKNESS = "Thickness of 0.1 µm is below 0.588 µm, the least while the voltage is 650 V"
AT_LIMIT = "Thickness of 0.1 µm is below 0.1001 µm, the least while the side is 100 mm"


@pytest.mark.parametrize("bad, said", [
    ("voltage=1e9", VOLTAGE),
    ("thickness=0.1&voltage=650", f"{THICKNESS}; set that or more, or change the voltage first"),
    ("thickness=0.1&side=100&voltage=0&surfaceElasticity=0", AT_LIMIT),
], ids=["voltage", "thickness", "limit"])  # fmt: skip
def test_an_address_that_the_model_refuses_starts_the_page_all_the_same(visit, bad, said):
    seen = visit(f"{bad}&density=1200")
    assert said in seen.page.inner_text("#status")
    assert seen.page.input_value("#density") == "1200"
    seen.page.click("#advance")
    assert seen.reading("time") > 0


def test_a_bad_address_is_said_and_the_rest_of_it_taken(visit):
    seen = visit()
    for side, (bad, *all_said) in enumerate((
        ("voltage=loud", "Voltage is not a number."),
        ("thickness=-3", "Thickness of -3 µm is below 0.1 µm; set that or more."),
        ("colour=red", "nothing is called colour; there is voltage, prestress,"),
        ("density=", "Density is not a number."),
        ("driveFrequency=1e9", "Frequency of the alternating voltage of 1.000·10⁹ kHz is above"),
        ("voltage=1e9&density=1&colour=red", VOLTAGE, "Density of 1 kg/m³ is below 500", "nothing is called colour"),
    ), 1):  # fmt: skip
        seen.page.evaluate("(to) => { location.hash = to; }", f"side={side}&{bad}")
        seen.page.wait_for_function("(side) => document.getElementById('side').value === side", arg=str(side))
        told = seen.page.inner_text("#status")
        assert all(said in told for said in all_said), told


def test_a_bad_number_is_refused_at_its_box_and_the_motion_goes_on(visit):
    seen = visit(fragment())
    seen.advance(20)
    before = {name: seen.reading(name) for name in ("time", "stretch", "voltage")}
    for key, text, reason in (
        ("thickness", "0", "below 0.588 µm, the least while the voltage is 650 V"), ("modulus", "", "not a number"),
        ("surfaceEnergy", "-1", "below 0 mN/m"), ("voltage", "1e9", "above 11050 V, the most for this device"),
        ("voltage", "-1", "below 0 V"), ("modulus", "4", "below 5 kPa"),
    ):  # fmt: skip
        seen.type(key, text)
        assert reason in seen.page.inner_text(f"#{key}-fault")
        assert seen.page.get_attribute(f"#{key}", "aria-invalid") == "true"
    assert {name: seen.reading(name) for name in before} == before
    seen.page.wait_for_timeout(400)
    assert "voltage=650&" in seen.page.url and "thickness=10&" in seen.page.url
    # What is accepted clears it, and the rest is taken back.
    seen.type("voltage", "640")
    assert seen.page.inner_text("#status") == ""
    assert not any(seen.page.locator(".fault").all_inner_texts())
    assert seen.page.input_value("#thickness") == "10" and seen.reading("time") == before["time"]


EACH_PLACE = """(form, keys) => keys.flatMap((key) => {
    const wrong = [];
    const named = (id) => document.getElementById(id);
    const [slider, box, before] = [named(`${key}-slider`), named(key), named(key).value];
    slider.focus();
    for (const place of [0, 1, 500, 999, 1000]) {
        slider.value = place;
        slider.dispatchEvent(new Event("input"));
        const said = named(`${key}-fault`).textContent + named("status").textContent;
        if (said || Number(slider.value) !== place) wrong.push([key, place, slider.value, said]);
    }
    box.value = before;
    box.dispatchEvent(new Event("change"));
    return wrong;
})"""
"""Moves each slider, in focus, to places on it; what was refused, or where the slider then stood elsewhere."""


@pytest.mark.parametrize("changes", [
    {"surfaceElasticity": 1000, "prestress": 300}, {"voltage": 3000, "thickness": 30, "side": 0.001},
], ids=["paper", "tall"])  # fmt: skip
def test_no_place_of_a_slider_is_refused_and_each_leads_back_to_itself(visit, changes):
    seen = visit(fragment(**changes))
    assert seen.page.inner_text("#status") == ""
    assert not seen.page.locator("#quantities").evaluate(EACH_PLACE, list(SILICONE))


def test_a_slider_in_focus_follows_the_address(visit):
    seen = visit(fragment())
    slider = seen.page.locator("#voltage-slider")
    slider.focus()
    seen.page.evaluate("(to) => { location.hash = to; }", fragment(voltage=0))
    seen.page.wait_for_function("document.getElementById('voltage').value === '0'")
    assert slider.input_value() == "0"


def test_the_least_and_the_most_that_are_said_are_taken_and_no_more(visit):
    seen = visit(fragment(voltage=9000))
    for key, beyond in (
        ("thickness", "0.1"), ("relativePermittivity", "20"), ("prestress", "1e6"), ("driveFrequency", "1e7"),
        ("voltage", "1e6"),
    ):  # fmt: skip
        before = seen.page.input_value(f"#{key}")

        def said(key=key) -> str:
            return seen.page.inner_text(f"#{key}-fault") + seen.page.inner_text("#status")

        seen.type(key, beyond)
        limit = re.search(r"(?:below|above) ([0-9.]+)", said())[1]
        seen.type(key, limit)
        assert said() == "" and seen.page.input_value(f"#{key}") == limit
        seen.type(key, str(float(limit) * (0.999 if key == "thickness" else 1.001)))
        assert limit in said()
        seen.type(key, before)


def test_what_only_the_model_refuses_is_said_and_the_motion_goes_on(browser, address):
    with browser.new_context(offline=True, reduced_motion="reduce") as context:
        page = context.new_page()
        page.add_init_script(REFUSING)
        page.goto(f"{address}#{fragment()}")
        page.wait_for_selector("html[data-ready=true]")
        page.locator("#advance").evaluate("(button) => { for (let k = 0; k < 20; k += 1) button.click(); }")
        readings = "[...document.querySelectorAll('[data-reading]')].map((one) => one.dataset.value)"
        before = page.evaluate(readings)
        for key, number in (("side", 400), ("prestress", 30 / 303)):
            page.evaluate("(number) => { window.refused = number; }", number)
            page.evaluate("document.getElementById('status').textContent = ''")
            page.fill(f"#{key}", {"side": "0.2", "prestress": "30"}[key])
            page.press(f"#{key}", "Tab")
            assert page.evaluate(readings) == before
            assert page.input_value(f"#{key}") == {"side": "0.1", "prestress": "0"}[key]
        page.evaluate("window.refused = 'step'")
        page.evaluate("document.getElementById('status').textContent = ''")
        page.click("#advance")
        assert page.evaluate(readings) == before and "Stretch" not in page.inner_text("#status")
        # A start that is refused leads to the state before.
        again = context.new_page()
        again.add_init_script(REFUSING + "window.refused = 400;")
        again.goto(f"{address}#{fragment(side=0.2)}")
        again.wait_for_selector("html[data-ready=true]")
        assert again.input_value("#voltage") == "690"
        assert "could not be followed" in again.inner_text("#status")
