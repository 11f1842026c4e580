"""What is in the packed FMU beside the description: binaries, documentation, icon, licences."""

import html.parser
import re
import zipfile
from pathlib import Path

import fmpy
import pytest

import linked

REPOSITORY = Path(__file__).resolve().parents[2]
LARGEST_BINARY = {"fmu_path": 400_000, "si_path": 1_420_000}
# The binary for Windows has some 90 kB more. 40 kB of it are zig's run-time library: the linker cannot leave out its
# functions one by one. Optimised for size it has 17 kB less. It copies memory, and its speed then was not measured.
MORE = {"win64": 90_000}


@pytest.fixture(scope="module", params=LARGEST_BINARY)
def model(request):
    """The fixture of one FMU, then that of the other."""
    return request.param


@pytest.fixture(scope="module")
def archive(request, model):
    with zipfile.ZipFile(request.getfixturevalue(model)) as opened:
        yield opened


@pytest.fixture(scope="module")
def binaries(archive):
    """Each binary by its folder."""
    names = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert any(name.startswith("binaries/linux64/") for name in names)
    return {name.split("/")[1]: archive.read(name) for name in names}


def test_binaries_are_small(binaries, model):
    sizes = {folder: len(data) for folder, data in binaries.items()}
    largest = LARGEST_BINARY[model]
    assert {folder: size for folder, size in sizes.items() if size > largest + MORE.get(folder, 0)} == {}


def test_binaries_hold_no_path_of_the_build_machine(binaries):
    """Such a path would make the bytes depend on where they were built."""
    for name, data in binaries.items():
        for folder in (REPOSITORY, Path.home() / ".cargo", Path.home() / ".rustup"):
            assert str(folder).encode() not in data, name


def test_the_writer_of_backtraces_is_not_linked(binaries):
    """Neither its heading nor its reader of debug information: both come with Rust's report of a panic."""
    data = binaries["linux64"]
    assert b"stack backtrace" not in data
    assert b".debug_info" not in data


class References(html.parser.HTMLParser):
    """Collects the places of a page, where its links lead, and what it would load."""

    def __init__(self):
        super().__init__()
        self.places, self.links, self.loaded, self.formulas = set(), set(), [], 0

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places.add(attributes.get("id"))
        self.formulas += tag == "math"
        if tag == "a":
            self.links.add(attributes["href"])
        elif "src" in attributes or "href" in attributes:
            self.loaded.append(attributes.get("src") or attributes.get("href"))


def test_documentation_stands_alone(archive):
    text = archive.read("documentation/index.html").decode()
    page = References()
    page.feed(text)
    assert page.formulas > 10
    assert page.loaded and all(source.startswith("data:image/") for source in page.loaded)
    inside = {link[1:] for link in page.links if link.startswith("#")}
    assert inside <= page.places
    assert all(link.startswith(("#", "https://")) or link == "actuator.html" for link in page.links)


def test_the_documentation_begins_with_the_variables_of_its_fmu(fmu_path, si_path):
    first = {}
    for path in (fmu_path, si_path):
        with zipfile.ZipFile(path) as opened:
            first[path] = opened.read("documentation/index.html").decode().split("</section>")[0]
        for variable in fmpy.read_model_description(str(path)).modelVariables:
            assert f"<td><code>{variable.name}</code></td>" in first[path], variable.name
    assert "<td><code>phi</code></td>" not in first[si_path]
    assert "<td><code>voltage</code></td>" not in first[fmu_path]


def test_the_live_page_opens_the_documentation(archive):
    text = archive.read("documentation/index.html").decode()
    assert text.index('href="actuator.html"') < text.index("<nav>")
    page = archive.read("documentation/actuator.html").decode()
    assert not re.search(r'(src|href)="(?!data:|#)', page)
    assert "uPlot" in page and len(page) < 500_000


def test_every_page_of_the_guide_is_in_the_documentation(archive):
    text = archive.read("documentation/index.html").decode()
    pages = sorted((REPOSITORY / "docs" / "guide").glob("*.md"))
    assert pages
    places = [text.index(f'<h1 id="{page.stem}">') for page in pages]
    # That with the variables of the FMU comes first.
    places.remove(min(places))
    assert places == sorted(places)


def test_icon_is_a_square_png(archive):
    icon = archive.read("model.png")
    assert icon.startswith(b"\x89PNG\r\n\x1a\n")
    assert icon[16:20] == icon[20:24]


def test_licence_of_every_linked_crate_is_there(archive, binaries):
    """Cargo's own list of what is linked on these platforms, and no other crate."""
    crates = linked.crates("dielectric-elastomer-actuator", [linked.TRIPLES[folder] for folder in binaries])
    assert ("fmi", "0.8.0") in crates
    # FMI 2.0 has a reader begin with this file.
    text = archive.read("documentation/licenses/license.txt").decode()
    list_of_crates = text.partition("=" * 80)[0]
    assert set(re.findall(r"^(\S+) (\d\S*): ", list_of_crates, flags=re.MULTILINE)) == crates
    for name in ("LICENSE-APACHE.txt", "LICENSE-MIT.txt", "llvm-libunwind.txt", "rust-standard-library.html"):
        assert archive.read(f"documentation/licenses/{name}") and name in list_of_crates
    assert "Rust Standard Library" in archive.read("documentation/licenses/rust-standard-library.html").decode()
