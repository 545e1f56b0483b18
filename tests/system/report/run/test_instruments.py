"""The instruments of a page: OpenBridge's components show what the table says, in every palette, and say it in words."""

import json
import re

import numpy as np
import pytest
from report.run.test_scene import LIMITS, PLACES, SIZE, two_ships

from shipcosim.report import write_report
from shipcosim.report.theme.pages import _asset

PALETTES = {"day": "rgb(45, 84, 139)", "night": "rgb(56, 167, 132)"}
"""Colour in which OpenBridge draws what is in use."""
BUNDLE = 'id="openbridge"'
LARGEST_BUNDLE = 700e3
BEAUFORT_4 = (5.5, 8.0)  # m/s

READ = """
return (async () => {
  const figures = [...document.querySelectorAll(".instrument")];
  const all = figures.map((figure) => [figure, figure.querySelector(".dial > *")]);
  await Promise.all(all.map(([, component]) => component.updateComplete));
  const names = "heading headingSetpoint windSpeed windFromDirection currentSpeed currentFromDirection angle " +
    "angleSetpoint thrust thrustSetpoint";
  return Object.fromEntries(all.map(([figure, component]) => [figure.querySelector("figcaption").textContent || "compass", {
    kind: component.localName, label: component.ariaLabel, role: component.role,
    ...Object.fromEntries(names.split(" ").map((name) => [name, component[name] ?? null])),
    turns: [...component.shadowRoot.querySelectorAll("svg > g")].map((part) => part.getAttribute("transform")),
    colours: [...component.shadowRoot.querySelectorAll("[fill*=enhanced-secondary]")]
      .map((part) => getComputedStyle(part).fill),
  }]));
})();
"""


def choose(page, palette):
    """Choose a palette as a reader does."""
    page.ask(
        "const list = document.getElementById('scheme'); list.value = arguments[0];"
        "list.dispatchEvent(new Event('change'))",
        palette,
    )


def instruments(page, palette="day"):
    """What each instrument shows, by its caption, in a palette."""
    choose(page, palette)
    return page.ask(READ)


def number(label, name):
    """The number after a name in the words of an instrument."""
    return float(re.search(rf"{name} (−?[\d.]+)", label)[1].replace("−", "-"))


@pytest.fixture(scope="module")
def table(four_corner):
    found = four_corner()
    found.attrs["start_values"] = json.dumps({**SIZE, **PLACES, **LIMITS})
    return found


@pytest.fixture(scope="module")
def file(table, tmp_path_factory):
    path = tmp_path_factory.mktemp("instruments") / "report.html"
    write_report(table, path)
    return path


@pytest.fixture
def page(browse, file):
    found = browse(file)
    yield found
    # All pages of a disk have one storage.
    found.ask("localStorage.removeItem('shipcosim-palette')")


@pytest.fixture(scope="module")
def opened():
    return []


@pytest.fixture
def seen(browse, chromium, file, opened):
    """The page as the test before left it, for those that choose time and palette themselves."""
    if not opened or chromium.current_url.partition("#")[0] != file.as_uri():
        opened[:] = [browse(file)]
    yield opened[0]
    opened[0].ask("localStorage.removeItem('shipcosim-palette')")


@pytest.mark.parametrize("palette", PALETTES)
@pytest.mark.parametrize("t", [120.0, 700.0])
def test_instruments_show_the_signals(seen, table, palette, t):
    page = seen
    page.ask("scene.time = arguments[0]; scene.paint()", t)
    shown, row = instruments(page, palette), table.sel(time=t)
    heading, wanted = (
        np.degrees(float(row[name])) % 360 for name in ("vessel.psi", "reference.psi_d")
    )
    compass = shown["compass"]
    assert compass["heading"] == pytest.approx(heading, abs=0.06)
    assert compass["headingSetpoint"] == pytest.approx(wanted, abs=0.06)
    assert compass["turns"][0].startswith(f"rotate({compass['heading']:g})")
    assert number(compass["label"], "Heading") == pytest.approx(heading, abs=0.06)
    for name in ("port", "starboard"):
        unit, thrust = shown[name], float(row[f"{name}.thrust"])
        azimuth = np.degrees(float(row[f"{name}.azimuth"]))
        assert unit["kind"] == "obc-azimuth-thruster"
        assert unit["angle"] == pytest.approx(azimuth, abs=0.06)
        assert unit["turns"][0] == f"rotate({unit['angle']:g})"
        assert set(unit["colours"]) == {PALETTES[palette]}
        assert number(unit["label"], "Azimuth") == pytest.approx(azimuth, abs=0.6)
        assert number(unit["label"], "Thrust") == pytest.approx(thrust / 1000.0, abs=0.06)
    for name in ("port", "starboard", "tunnel"):
        rpm = float(row[f"{name}.rpm"])
        assert number(shown[name]["label"], "Shaft") == pytest.approx(rpm, abs=0.6)
        assert shown[name]["role"] == "img"
    assert page.errors() == [] and page.requests() == []


def test_thrust_and_its_set_point_are_shares_of_the_largest(seen, table):
    page = seen
    page.ask("scene.time = 500; scene.paint()")
    port, row = instruments(page)["port"], table.sel(time=500.0)
    for shown, signal in {
        "thrust": "port.thrust",
        "thrustSetpoint": "allocator.port_thrust_cmd",
    }.items():
        newton = float(row[signal])
        assert port[shown] == pytest.approx(newton / (100.0 if newton > 0 else 80.0), abs=0.1)
    angle = np.degrees(float(row["allocator.port_azimuth_cmd"]))
    assert port["angleSetpoint"] == pytest.approx(angle, abs=0.06)


def test_wind_and_current_come_from_where_the_table_says(seen, table):
    page = seen
    page.ask("scene.time = 400; scene.paint()")
    compass = instruments(page)["compass"]
    north, east = (
        float(table[f"environment.wind_{way}"].sel(time=400.0)) for way in ("north", "east")
    )
    source = np.degrees(np.arctan2(-east, -north)) % 360
    assert compass["windFromDirection"] == pytest.approx(source, abs=0.2)
    low, high = BEAUFORT_4
    assert (compass["windSpeed"] == 4) == (low <= np.hypot(north, east) < high)
    # It flows to the south with 0.3 m/s: one arrow, from the north.
    assert compass["currentFromDirection"] % 360 == pytest.approx(0.0, abs=0.1)
    assert compass["currentSpeed"] == 1


@pytest.mark.parametrize(
    ("turn", "kind"),
    [((0, 1), "obc-thruster"), ((1, 0), "obc-thruster"), ((1, 1), "obc-azimuth-thruster")],
)
def test_a_unit_without_an_azimuth_is_drawn_as_its_force_acts(browse, tmp_path, turn, kind):
    table = two_ships().drop_vars("tug.bow.azimuth")
    for axis, share in zip("XY", turn, strict=True):
        table[f"tug.bow.tau_{axis}"] = 1000.0 * share * table["tug.bow.thrust"]
        table[f"tug.bow.tau_{axis}"].attrs["units"] = "N"
    write_report(table, tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    page.ask("document.getElementById('scene-vessel').value = 1")
    page.ask("document.getElementById('scene-vessel').dispatchEvent(new Event('change'))")
    page.wait("return document.querySelector('#scene-thrusters .dial > *')")
    bow = instruments(page)["bow"]
    assert bow["kind"] == kind
    sideways = page.ask("return document.querySelector('#scene-thrusters .dial > *').tunnel")
    assert bool(sideways) == (turn == (0, 1))
    if turn == (1, 1):
        assert bow["angle"] == pytest.approx(45.0)
    assert page.errors() == []


def test_newtons_of_a_model_ship_are_shown(browse, four_corner, tmp_path):
    table = four_corner()[["vessel.x", "vessel.y", "vessel.psi", "port.thrust", "port.rpm"]]
    newtons = 1e-3 * table["port.thrust"].values
    table["port.thrust"] = table["port.thrust"].copy(data=newtons)
    write_report(table, tmp_path / "report.html")
    shown = instruments(browse(tmp_path / "report.html"))["port"]
    last = 1e-3 * newtons[-1]
    assert number(shown["label"], "Thrust") == pytest.approx(last, rel=0.1) and 0.002 < last < 1.0


def test_a_page_without_a_ship_does_not_carry_them(table, tmp_path):
    write_report(table[["port.thrust", "port.rpm"]], tmp_path / "bare.html")
    write_report(table, tmp_path / "ship.html")
    bare, ship = ((tmp_path / f"{name}.html").read_text() for name in ("bare", "ship"))
    assert BUNDLE not in bare
    start = ship.index(BUNDLE)
    assert ship.index("</script>", start) - start < LARGEST_BUNDLE


def test_names_of_other_tools_stay_text(browse, four_corner, tmp_path):
    name = "<img src=x onerror=hacked=1> & 'aft'"
    table = four_corner()[["vessel.x", "vessel.y", "vessel.psi", "port.thrust", "port.rpm"]]
    table = table.rename({f"port.{signal}": f"{name}.{signal}" for signal in ("thrust", "rpm")})
    write_report(table, tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    assert instruments(page)[name]["label"].startswith(f"{name}: Thrust ")
    assert page.ask("return window.hacked ?? document.querySelector('.instrument img')") is None


@pytest.mark.parametrize("width", [500, 1280, 2560])
def test_every_number_fits_its_instrument(shown_at, file, width):
    page = shown_at(file, width)
    cut = page.ask(
        "return [...document.querySelectorAll('.instrument')].filter((figure) => {"
        "const { right } = figure.getBoundingClientRect();"
        "const texts = [...figure.querySelectorAll('td, figcaption')];"
        "return texts.some((text) => text.getBoundingClientRect().right > right + 1"
        "|| text.scrollWidth > text.clientWidth + 1); }).map((figure) => figure.innerText)"
    )
    assert cut == []
    assert page.ask("return document.documentElement.scrollWidth") <= width
    sizes = "return [...document.querySelectorAll('.dial')].map((dial) => dial.clientWidth)"
    assert min(page.ask(sizes)) >= 100


def test_the_palette_is_kept_for_the_next_page_and_paper_is_day(page, browse, file):
    shown = "return document.documentElement.dataset.obcTheme"
    assert page.ask(shown) == "day"
    choose(page, "dusk")
    again = browse(file)
    assert again.ask(shown) == again.ask("return document.getElementById('scheme').value") == "dusk"
    again.ask("dispatchEvent(new Event('beforeprint'))")
    assert again.ask(shown) == "day"
    again.ask("dispatchEvent(new Event('afterprint'))")
    assert again.ask(shown) == "dusk"


def test_the_default_palette_follows_the_browser(shown_at, file):
    page = shown_at(file, 1280, "dark")
    assert page.ask("return document.documentElement.dataset.obcTheme") == "dusk"


def test_nothing_moves_where_the_reader_wants_no_motion(browse, chromium, file):
    moving = (
        "return [...document.querySelectorAll('.dial > *')].flatMap((component) => [component.shadowRoot,"
        "...[...component.shadowRoot.querySelectorAll('*')].map((part) => part.shadowRoot).filter(Boolean)])"
        ".flatMap((root) => root.getAnimations()).length"
    )
    media = {"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]}
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
    try:
        page = browse(file)
        for t in (300, 0, 700):
            page.ask("scene.time = arguments[0]; scene.paint()", t)
            assert page.ask(READ) and page.ask(moving) == 0
    finally:
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def test_the_bundle_has_only_variables_that_its_instruments_read():
    script = str(_asset("theme/vendor/openbridge.min.js"))
    palettes = re.findall(r':root\[data-obc-theme=\\"(\w+)\\"\]\{([^}]*)\}', script)
    assert [name for name, _ in palettes] == ["day", "dusk", "night", "bright"]
    read = set(re.findall(r"var\((--[\w-]+)", script))
    for _, body in palettes:
        assert set(re.findall(r"(--[\w-]+):", body)) <= read
