"""What these tests share: the live page in a browser of the machine, without a network."""

import os
import shutil
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "target" / "page" / "index.html"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "microsoft-edge")
ARGUMENTS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
)  # fmt: skip
PATIENCE = 120_000
"""Milliseconds that anything on the page may take, on a machine with a load of 20 too."""
SILICONE = {
    "voltage": 650.0, "prestress": 0.0, "driveVoltage": 0.0, "driveFrequency": 100.0, "thickness": 10.0, "side": 0.1,
    "surfaceEnergy": 20.0, "surfaceTension": 20.0, "surfaceElasticity": 126.0, "modulus": 303.0, "density": 1100.0,
    "relativePermittivity": 2.8,
}  # fmt: skip
"""The paper's material in the units of the page."""


def fragment(**changes) -> str:
    return "&".join(f"{key}={value}" for key, value in {**SILICONE, **changes}.items())


@pytest.fixture(scope="session")
def address() -> str:
    """Of the built page; a test that needs it fails where there is none."""
    if not PAGE.is_file():
        pytest.fail(f"no page at {PAGE}: build it first (make page)", pytrace=False)
    return PAGE.as_uri()


@pytest.fixture(scope="session")
def browser():
    """A headless browser, that of the environment variable BROWSER or the first that is found."""
    names = [os.environ["BROWSER"]] if "BROWSER" in os.environ else BROWSERS
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        pytest.skip(f"no browser: none of {', '.join(names)} is installed (Debian: apt install chromium)")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=ARGUMENTS, timeout=300_000)
        yield browser
        browser.close()


class Visit:
    """The page as someone sees it, with what it complained about and asked the network for."""

    def __init__(self, context, address):
        self.page = context.new_page()
        self.page.set_default_timeout(PATIENCE)
        self.complaints, self.requests = [], []
        self.page.on("console", lambda message: self.complaints.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(address)
        self.page.wait_for_selector("html[data-ready=true]")

    def advance(self, count: int) -> None:
        """Press the button for a single step so many times."""
        self.page.locator("#advance").evaluate("(button, count) => { while (count--) button.click(); }", count)

    def type(self, key: str, text: str) -> None:
        """Type into the box of a quantity and leave it."""
        self.page.fill(f"#{key}", text)
        self.page.press(f"#{key}", "Tab")

    def slide(self, key: str, place: int) -> None:
        """Move the slider of a quantity to one of its places, 0 to 1000."""
        self.page.locator(f"#{key}-slider").evaluate(
            "(slider, place) => { slider.value = place; slider.dispatchEvent(new Event('input')); }", place
        )

    def reading(self, name: str) -> float:
        """A reading in SI units, all digits of it."""
        return float(self.page.get_attribute(f"[data-reading={name}]", "data-value"))


@pytest.fixture
def visit(browser, address):
    """A function that opens the page: `fragment` is the address behind the #, options are those of a context."""
    contexts, visits = [], []

    def open_page(fragment: str = "", width: int = 1280, **options) -> Visit:
        options = {"reduced_motion": "reduce", **options}
        context = browser.new_context(viewport={"width": width, "height": 900}, offline=True, **options)
        contexts.append(context)
        visits.append(Visit(context, address + (f"#{fragment}" if fragment else "")))
        return visits[-1]

    yield open_page
    for context in contexts:
        context.close()
    for seen in visits:
        assert not seen.complaints
        assert all(url.startswith(("file:", "data:")) for url in seen.requests), seen.requests
