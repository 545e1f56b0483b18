"""The page as a browser shows it."""

import numpy as np
import pytest
import xarray as xr
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from shipcosim.errors import ShipcosimError
from shipcosim.report import write_report
from shipcosim.report.run.page import render
from shipcosim.scenario import Scenario, judge


@pytest.fixture(scope="module")
def file(four_corner, scenario, verdicts, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    table = four_corner()
    table.attrs |= {
        "engine": "fmpy",
        "start_values": '{"vessel.length": 33.9, "vessel.breadth": 9.6, "seed": 7}',
    }
    write_report(table, path, scenario=scenario, verdicts=verdicts)
    return path


@pytest.fixture(scope="module")
def opened():
    return []


@pytest.fixture
def page(browse, file, opened):
    """The page, newly opened."""
    opened.clear()
    return browse(file)


@pytest.fixture
def untouched(browse, chromium, file, opened):
    """The page for tests that only look at it: the same for one after another, since it takes seconds to open."""
    if not opened or chromium.current_url.partition("#")[0] != file.as_uri():
        opened[:] = [browse(file)]
    return opened[0]


def test_page_opens_without_error_and_without_network(page):
    assert page.errors() == []
    assert page.requests() == []
    assert "http" not in (
        page.ask("return [...document.querySelectorAll('[src],link')].map(e => e.outerHTML).join()")
    )


def test_header_says_what_it_is_and_how_it_went(untouched):
    assert untouched.text("h1") == "Four corners & more"
    assert "FAIL" in untouched.text("#verdict") and "1 of 11" in untouched.text("#verdict")


def test_expectations_are_listed_in_degrees_with_pass_or_fail(untouched):
    rows = untouched.text("#expectations tbody").splitlines()
    assert sum("✓ pass" in row for row in rows) == 10 and sum("✗ FAIL" in row for row in rows) == 1
    assert any("heading of vessel" in row and "315" in row and "deg" in row for row in rows)
    assert any("position of vessel: (" in row for row in rows)
    assert any("(20,\u00a0-20)" in row for row in rows)


def test_every_section_draws_its_curves(untouched):
    panels = untouched.panels()
    assert {"measured", "set point", "reference", "ship"} <= set(panels["North [m]"])
    assert {"measured", "set point", "reference", "ship"} <= set(panels["Heading [deg]"])
    assert "ship − reference" in panels["East error [m]"]
    assert panels["Yaw moment [kN·m]"] == ["wind", "drift", "hull", "thrusters", "commanded"]
    assert panels["Thrust, tunnel [kN]"] == ["commanded", "delivered"]
    assert panels["Azimuth, port [deg]"] == ["commanded", "delivered"]
    assert panels["Shaft speed, port, starboard [rpm]"] == ["port", "starboard"]
    assert panels["Shaft speed, tunnel [rpm]"] == ["tunnel"]
    assert panels["Power [kW]"] == ["port", "starboard", "tunnel"]
    assert panels["Wind speed [m/s]"] == ["with gusts", "mean"]
    assert {"Waves [m]", "At a limit, failed"} <= set(panels)


def test_what_stays_the_same_is_said_in_words(untouched):
    assert "Current speed [m/s]" not in untouched.panels()
    said = untouched.ask(
        "return [...document.querySelectorAll('.constant')].map(p => p.textContent)"
    )
    assert any("Current speed 0.3 m/s; Current to 180 deg" in text for text in said), said


def test_limits_are_drawn_in_their_windows_and_tell_pass_from_fail(untouched):
    panels = untouched.panels()
    assert panels["North [m]"].count("limit, held") == 5
    assert panels["Position error [m]"].count("limit, held") == 5
    assert "limit, missed" in panels["port.power [kW]"]
    colours = untouched.ask(
        "return [...document.querySelectorAll('.panel')].flatMap(p => p.data)"
        ".filter(t => t.name?.startsWith('limit')).map(t => t.name + t.line.color)"
    )
    assert len(set(colours)) == 2


def test_short_run_is_drawn_row_by_row(untouched):
    assert untouched.text("#thinning") is None
    assert untouched.ask("return document.getElementById('panel-0').data.at(-1).x.length") == 2201


def test_expectations_with_long_names_are_not_cut_off(browse, chromium, four_corner, tmp_path):
    table = four_corner()
    table["controller.dead_reckoning_time_since_then"] = table["vessel.psi"]
    expected = {
        "signal": "controller.dead_reckoning_time_since_then",
        "at_least": -59.0,
        "statistic": "max",
    }
    told = Scenario(system="gunnerus_dp", stop_time=1100.0, step_size=0.05, expect=[expected])
    write_report(table, tmp_path / "long.html", scenario=told, verdicts=judge(table, told))
    size = {"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    page = browse(tmp_path / "long.html")
    right = "return document.querySelector('#expectations {}').getBoundingClientRect().right"
    beyond = page.ask(right.format("table")) - page.ask(right.format("h2"))
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert beyond < 1.0


def test_the_page_opens_where_the_run_failed_and_leads_to_each_moment(page, verdicts):
    missed = [verdict for verdict in verdicts if not verdict.passed]
    buttons = page.ask(
        "return [...document.querySelectorAll('#moments button')].map(b => b.textContent)"
    )
    assert [text.startswith("✗") for text in buttons] == [True] * len(missed) + [False] * 5
    assert page.ask("return scene.time") == pytest.approx(missed[0].time)
    page.ask("document.querySelector('#moments button:not(.failed)').click()")
    assert page.ask("return scene.time") == 0.0


def test_zoom_in_one_panel_shows_the_same_time_in_all(page):
    page.ask(
        "Plotly.relayout(document.getElementById('panel-0'), {'xaxis.range[0]': 200, 'xaxis.range[1]': 300})"
    )
    page.wait("return document.body.dataset.drawn === 'all'")
    ranges = page.ask(
        "return [...document.querySelectorAll('.panel')].map(p => p._fullLayout.xaxis.range)"
    )
    assert ranges == [[200, 300]] * len(ranges) and len(ranges) > 15
    page.driver.find_element(By.ID, "reset").click()
    page.wait("return document.body.dataset.drawn === 'all'")
    ranges = page.ask(
        "return [...document.querySelectorAll('.panel')].map(p => p._fullLayout.xaxis.range)"
    )
    assert ranges == [[0, 1100]] * len(ranges)


def test_pointer_over_a_panel_names_all_its_values_and_shows_where_she_was(page):
    panel = page.driver.find_element(By.ID, "panel-0")
    page.ask("arguments[0].scrollIntoView({block: 'center'})", panel)
    ActionChains(page.driver).move_to_element(panel).perform()
    page.wait("return document.querySelector('#panel-0 .hoverlayer text') !== null")
    hover = page.text("#panel-0 .hoverlayer") or page.ask(
        "return document.querySelector('#panel-0 .hoverlayer').textContent"
    )
    assert all(label in hover for label in ("ship", "reference", "set point", " m"))
    page.wait("return scene.drawn.some(item => item.what === 'ghost')")


def test_any_signal_can_be_chosen_and_found_by_its_name(page):
    page.driver.find_element(By.ID, "filter").send_keys("tau_wind")
    visible = [
        label.text
        for label in page.driver.find_elements(By.CSS_SELECTOR, "#choices label")
        if label.text
    ]
    assert len(visible) == 3 and all("tau_wind" in label for label in visible)
    for name in ("vessel.tau_wind_X", "vessel.tau_wind_Y", "vessel.tau_wind_N"):
        page.driver.find_element(By.CSS_SELECTOR, f"#choices input[value='{name}']").click()
    drawn = page.ask(
        "return [...document.querySelectorAll('#chosen .panel')].map(p => p.data.map(t => t.name))"
    )
    assert drawn == [["vessel.tau_wind_X", "vessel.tau_wind_Y"], ["vessel.tau_wind_N"]]


def test_interrupted_run_is_marked_as_partial(browse, four_corner, tmp_path):
    table = four_corner().isel(time=slice(0, 400))
    table.attrs["complete"] = 0
    write_report(table, tmp_path / "partial.html")
    page = browse(tmp_path / "partial.html")
    assert "PARTIAL" in page.text("#verdict") and "199.5 s" in page.text("#verdict")
    assert page.errors() == []


def test_system_without_a_ship_shows_its_first_signals(browse, tmp_path):
    time = np.linspace(0.0, 10.0, 101)
    table = xr.Dataset(
        {
            "mass.position": ("time", np.cos(time), {"units": "m"}),
            "on": ("time", time > 5.0, {"units": ""}),
        },
        coords={"time": time},
    )
    write_report(table, tmp_path / "spring.html")
    page = browse(tmp_path / "spring.html")
    assert page.text("#scene") is None
    assert page.panels() == {"mass.position [m]": ["mass.position"], "on": ["on"]}
    assert page.errors() == []


def test_page_of_a_single_row_opens(browse, four_corner, tmp_path):
    write_report(four_corner().isel(time=[0]), tmp_path / "start.html")
    page = browse(tmp_path / "start.html")
    assert page.errors() == []


def test_texts_from_files_stay_texts(browse, four_corner, tmp_path):
    evil = "</script><script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\">"
    table = four_corner().isel(time=slice(None, None, 20)).rename({"vessel.u": f"vessel.{evil}"})
    table.attrs["remark"] = evil
    table[f"vessel.{evil}"].attrs |= {"units": evil, "long_name": evil}
    write_report(
        table,
        tmp_path / "evil.html",
        scenario=Scenario(description=evil, stop_time=1.0, step_size=0.5),
    )
    page = browse(tmp_path / "evil.html")
    assert page.text("h1") == evil
    page.driver.find_element(By.CSS_SELECTOR, "#choices input[value*='script']").click()
    assert page.ask("return document.title") != "owned"
    assert page.requests() == []


def test_page_stays_small_and_says_what_it_does_not_draw(four_corner, browse, tmp_path):
    write_report(four_corner(0.1), tmp_path / "long.html")
    assert (tmp_path / "long.html").stat().st_size < 1.5e6
    page = browse(tmp_path / "long.html")
    assert "of 11001 rows" in page.text("#thinning")


def test_page_that_cannot_be_written_leaves_nothing(four_corner, tmp_path):
    with pytest.raises(ShipcosimError, match="page.html"):
        write_report(
            four_corner().isel(time=slice(None, None, 20)), tmp_path / "missing" / "page.html"
        )
    assert list(tmp_path.iterdir()) == []


def test_same_run_makes_the_same_page(four_corner):
    assert render(four_corner().isel(time=slice(None, None, 20))) == render(
        four_corner().isel(time=slice(None, None, 20))
    )


def test_names_are_drawn_as_they_are_written(browse, tmp_path):
    """Plotly reads some HTML in texts: a name with angle brackets must not become formatting."""
    time = np.linspace(0.0, 10.0, 101)
    name = "mass.<b>x</b> & y"
    write_report(
        xr.Dataset({name: ("time", np.cos(time), {"units": "<m>"})}, coords={"time": time}),
        tmp_path / "page.html",
    )
    page = browse(tmp_path / "page.html")
    title = page.ask("return document.querySelector('#chosen .panel .gtitle').textContent")
    assert title == f"{name} [<m>]"
    assert page.errors() == []


def test_dark_page_is_dark_and_its_figures_too(browse, chromium, file):
    seen = {}
    for scheme in ("light", "dark"):
        media = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
        page = browse(file)
        seen[scheme] = page.ask(
            "const panel = document.getElementById('panel-0')._fullLayout;"
            "return [getComputedStyle(document.body).backgroundColor, panel.paper_bgcolor, panel.font.color]"
        )
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert all(light != dark for light, dark in zip(*seen.values(), strict=True))
    assert seen["light"][1] == "#ffffff" and seen["dark"][1] == "#182028"


def test_open_page_follows_when_the_browser_turns_dark(browse, chromium, file):
    set_scheme = lambda scheme: chromium.execute_cdp_cmd(  # noqa: E731
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
    )
    set_scheme("light")
    page = browse(file)
    page.ask(
        "Plotly.relayout(document.getElementById('panel-0'), {'xaxis.range[0]': 200, 'xaxis.range[1]': 300})"
    )
    set_scheme("dark")
    page.wait("return document.getElementById('panel-0')._fullLayout.paper_bgcolor === '#182028'")
    page.wait("return document.body.dataset.drawn === 'all'")
    assert page.ask("return document.getElementById('panel-0')._fullLayout.xaxis.range") == [
        200,
        300,
    ]
    set_scheme("light")


@pytest.mark.parametrize("width", [1280, 500])
def test_no_text_of_a_panel_lies_over_another_and_nothing_sticks_out(shown_at, file, width):
    page = shown_at(file, width)
    assert page.errors() == [] and page.collisions() == []
    assert page.ask("return document.documentElement.scrollWidth") <= width


def test_page_is_small(file):
    assert file.stat().st_size < 1.5e6
