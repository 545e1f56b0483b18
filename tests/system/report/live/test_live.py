"""The page that runs a system: what it computes is what the engines compute, and nothing that is done gets lost."""

import json
import tomllib

import numpy as np
import pytest
from report.run.test_instruments import PALETTES, instruments, number
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

import shipcosim
from shipcosim.calls.arguments import Reading, system_and_scenario
from shipcosim.errors import ShipcosimError
from shipcosim.report.live.export import export_page

SAME = 1e-9  # of the range of a signal
OPTIMISED = 1e-6  # the same where an optimiser's equations enlarge rounding by some 1e6
AHEAD = 120.0  # s, of the forecast of losses


def exported(name, path):
    """A scenario as a page."""
    system, scenario, _ = system_and_scenario(name, Reading(), {})
    export_page(system, scenario, path)
    return path


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    """The four corners as a page, with a component swapped."""
    return exported(
        "allocation/four_corner_extended", tmp_path_factory.mktemp("live") / "four_corner.html"
    )


@pytest.fixture
def desk(page_file, browse):
    """The page in a browser, at its start."""
    page = browse(page_file)
    page.wait("return Boolean(window.desk && window.scene)")
    return page


def repeated(page, folder):
    """Table of the scenario that the page saves, run by the native engine."""
    file = folder / "saved.toml"
    file.write_text(page.ask("return desk.scenario()"), encoding="utf-8")
    return shipcosim.run(file, engine="native").table


def largest_difference(page, table):
    """Largest difference of any signal in the page from a table, over the signal's range; and how many were compared."""
    columns = page.ask(
        "return JSON.stringify(Object.fromEntries([...desk.live.raw].map(([name, c]) => [name, [...c.values]])))"
    )
    found = {}
    for name, values in json.loads(columns).items():
        if name in table:
            known = table[name].values.astype(float)[: len(values)]
            off = np.max(np.abs(np.array(values, float)[: len(known)] - known))
            found[name] = off / (np.ptp(known) or 1.0)
    return max(found.values()), len(found)


def test_the_saved_scenario_repeats_what_was_done(desk, tmp_path):
    # Failure, set point, weather and bias at odd times, one of them undone.
    desk.ask(
        "const { live, act } = desk; live.reach(31.3); act('override', 'port.failed', true); live.reach(47);"
        "act('override', 'reference.x_set', 5); act('override', 'environment.wind_from', 1.25); live.reach(70);"
        "act('reset', 'port.failed'); act('bias', 'sensors.position_1_north', 0.25); live.reach(300);"
    )
    worst, count = largest_difference(desk, repeated(desk, tmp_path))
    assert count > 250
    assert worst < SAME


def test_a_page_has_the_optimal_allocator_too(browse, tmp_path):
    page = browse(exported("allocation/four_corner_optimal", tmp_path / "optimal.html"))
    page.wait("return Boolean(window.desk && window.scene)")
    page.ask(
        "const { live, act } = desk; live.reach(90); act('override', 'port.failed', true);"
        "act('override', 'environment.wind_from', 1.25); live.reach(200);"
    )
    worst, _ = largest_difference(page, repeated(page, tmp_path))
    assert worst < OPTIMISED


def test_switches_of_units_that_a_ship_has_not_are_not_offered(browse, tmp_path):
    """An allocator is made for six units; this ship has four."""
    page = browse(exported("allocation/four_azimuths", tmp_path / "four.html"))
    page.wait("return Boolean(window.desk && window.scene)")
    offered = page.ask(
        "return [...document.querySelectorAll('#failures button')].map(one => one.title.split(':')[0])"
    )
    assert "sensors.position_1_lost" in offered
    assert not [name for name in offered if ".available_" in name]


def test_going_back_forgets_what_came_after(desk, tmp_path):
    desk.ask(
        "const { live, act } = desk; live.reach(40); act('override', 'tunnel.full_thrust', true); live.reach(80);"
        "live.back(30); live.reach(60); act('override', 'reference.y_set', 3); live.reach(100);"
    )
    assert "full_thrust" not in desk.ask("return desk.scenario()")
    worst, _ = largest_difference(desk, repeated(desk, tmp_path))
    assert worst < SAME


def test_other_start_values_start_another_run(desk, tmp_path):
    given = {"environment.seed": 17, "environment.wind_speed": 12}
    desk.ask(
        "const of = (name) => desk.live.about.starts.find(([, other]) => other === name)[0];"
        "desk.live.reset(Object.fromEntries(Object.entries(arguments[0]).map(([n, v]) => [of(n), v])));"
        "desk.live.reach(60)",
        given,
    )
    table = repeated(desk, tmp_path)
    started = json.loads(table.attrs["start_values"])
    assert {name: started[name] for name in given} == given
    worst, _ = largest_difference(desk, table)
    assert worst < SAME


def test_the_forecast_of_a_loss_equals_a_run_with_it(desk, tmp_path):
    """At 250 s the scenario moves the set point."""
    check_forecast(desk, tmp_path, "port", 200.0)  # of the tunnel: at night


def check_forecast(desk, tmp_path, lost, at):
    desk.ask(f"desk.live.reach({at})")
    desk.wait(f"return desk.losses.time > {at} - 10 && desk.losses.answers.length >= 5")
    answer = next(
        a for a in desk.ask("return JSON.parse(JSON.stringify(desk.losses.answers))") if a["name"] == lost
    )  # fmt: skip
    desk.ask(
        f"desk.live.back({at}); desk.act('override', '{lost}.failed', true); desk.live.reach({at} + {AHEAD})"
    )
    table = repeated(desk, tmp_path)
    rows = table.sel(time=slice(at + 0.5, at + AHEAD))
    off = np.hypot(
        rows["vessel.x"] - rows["reference.x_d"], rows["vessel.y"] - rows["reference.y_d"]
    )
    assert answer["distance"] == pytest.approx(float(off.max()), rel=1e-6)


def test_a_reader_runs_pauses_fails_and_undoes_by_the_pages_own_buttons(desk):
    desk.ask("document.getElementById('scene-speed').value = 16")
    desk.ask("document.getElementById('scene-speed').dispatchEvent(new Event('change'))")
    desk.ask("document.getElementById('scene-play').click()")
    desk.wait("return scene.time > 5")
    port = '[aria-label="port: failed"]'
    desk.ask(f"document.querySelector('{port}').click()")
    desk.wait("return desk.live.value('port.thrust') !== undefined && scene.time > 12")
    desk.ask("document.getElementById('scene-play').click()")
    assert desk.ask(f"return document.querySelector('{port}').ariaPressed") == "true"
    still = desk.ask("return desk.live.time.last")
    desk.ask(f"document.querySelector('{port}').click()")
    assert desk.ask(f"return document.querySelector('{port}').ariaPressed") == "false"
    assert desk.ask("return desk.live.time.last") == still
    assert desk.errors() == []
    assert desk.requests() == []


def test_a_bus_trips_by_a_click_as_in_its_forecast_and_comes_back_by_another(desk):
    desk.ask("desk.live.reach(20); scene.grown(20); scene.go(20)")
    bus = "document.querySelector('[aria-label=\"allocator: bus a lost\"]')"
    desk.ask(f"{bus}.click()")
    assert desk.ask("return desk.present('allocator.bus_a_power')") == 0
    assert desk.ask(f"return {bus}.className") == "changed"
    lost = "[...document.querySelectorAll('#losses tr')].find((row) => row.cells[0].textContent === 'bus a')"
    desk.wait(f"return {lost}?.cells[1].textContent === 'is lost already'")
    desk.ask("desk.live.reach(21)")
    desk.ask(f"{bus}.click()")
    assert desk.ask(f"return {bus}.ariaPressed") == "false"
    events = tomllib.loads(desk.ask("return desk.scenario()"))["events"][-2:]
    assert events[0]["override"] == {"allocator.bus_a_power": 0.0}
    assert events[1]["reset"] == ["allocator.bus_a_power"]


@pytest.mark.parametrize(("width", "is_beside"), [(500, False), (1280, False), (2560, True)])
def test_the_page_fits_screens_from_500_to_2560_pixels(page_file, shown_at, width, is_beside):
    desk = shown_at(page_file, width)
    desk.wait("return Boolean(window.desk && window.scene)")
    assert desk.ask("return document.documentElement.scrollWidth") <= width
    box = "const box = (id) => document.getElementById(id).getBoundingClientRect();"
    # One can run her, and see the time, without scrolling.
    assert (
        desk.ask(f"{box} return Math.max(box('scene-play').bottom, box('scene-time').bottom)") < 900
    )
    assert desk.ask(f"{box} return box('failures').top < box('scene').bottom") is is_beside


@pytest.mark.parametrize("palette", PALETTES)
def test_instruments_show_the_signals_of_the_running_system(desk, palette):
    desk.ask("desk.live.reach(90); scene.grown(90); scene.go(90)")
    desk.wait("return scene.frames > 1 && scene.drawn.length > 0 && scene.time === 90")
    desk.ask("scene.paint()")
    try:
        shown = instruments(desk, palette)
    finally:
        desk.ask("localStorage.removeItem('shipcosim-palette')")
    now = lambda name: desk.ask("return desk.live.value(arguments[0])", name)  # noqa: E731
    heading = np.degrees(now("vessel.psi")) % 360
    assert shown["compass"]["heading"] == pytest.approx(heading, abs=0.06)
    for name in ("port", "starboard", "tunnel"):
        unit, thrust = shown[name], now(f"{name}.thrust") / 1000.0
        assert set(unit["colours"]) == {PALETTES[palette]}
        assert number(unit["label"], "Thrust") == pytest.approx(thrust, abs=0.06)
        assert number(unit["label"], "Shaft") == pytest.approx(now(f"{name}.rpm"), abs=0.6)
        if name != "tunnel":
            azimuth = np.degrees(now(f"{name}.azimuth"))
            assert unit["angle"] == pytest.approx(azimuth, abs=0.06)
    assert shown["tunnel"]["kind"] == "obc-thruster"
    assert desk.errors() == []


def test_as_fast_as_it_goes_from_the_start_and_back_within_bounds(desk):
    desk.ask(
        "const { engine } = desk.live, { state } = engine; window.copies = 0; window.began = performance.now();"
        "engine.state = () => { copies += 1; return state(); }; scene.setSpeed(Infinity); scene.play()"
    )
    desk.wait("return desk.live.time.last > 650")
    # To copy 3 MB takes as long as 50 steps: what is computed again sooner needs no state.
    copies, seconds = desk.ask("scene.pause(); return [copies, (performance.now() - began) / 1000]")
    assert copies < 20 * seconds + 5
    desk.ask("desk.live.back(512.5)")
    assert desk.ask("return desk.live.time.last") == 512.5
    # A clock that is slow between two states: all are kept, and thinned twice.
    desk.ask(
        "let clock = 0; performance.now = () => (clock += 60); desk.live.reset(); desk.live.reach(650);"
        "delete performance.now; desk.live.back(512.5)"
    )
    assert desk.ask("return desk.live.time.last") == 512.5
    assert 30 < desk.ask("return desk.live.states()") <= 81


def test_the_set_point_is_dragged_in_the_chart(desk):
    desk.ask("scene.follow(true)")
    desk.wait("return scene.drawn.some((one) => one.what === 'set point')")
    chart = desk.driver.find_element(By.ID, "scene-chart")
    desk.ask("arguments[0].scrollIntoView()", chart)
    # Pixels from the middle of the chart, as the driver counts, and those of three metres.
    x, y, far = desk.ask(
        "const { clientWidth, clientHeight } = arguments[0];"
        "const { north, east } = scene.drawn.find((one) => one.what === 'set point');"
        "const [x, y] = scene.pixel(east, north), [further] = scene.pixel(east + 3, north);"
        "return [x - clientWidth / 2, y - clientHeight / 2, further - x]",
        chart,
    )
    drag = ActionChains(desk.driver).move_to_element_with_offset(chart, round(x), round(y))
    drag.click_and_hold().move_by_offset(round(far), 0).release().perform()
    events = tomllib.loads(desk.ask("return desk.scenario()"))["events"]
    assert events[-1]["override"]["reference.y_set"] == pytest.approx(3.0, abs=0.2)


def test_a_joystick_moves_the_set_point_and_turns_it(desk):
    moved = "return ['x_set', 'y_set', 'psi_set'].map((name) => desk.present(`reference.${name}`))"
    start = desk.ask(moved)
    # A stick half to starboard and turned; that it is hardly forward moves nothing.
    desk.ask(
        "navigator.getGamepads = () => [null, { axes: [0.5, -0.1, 1] }];"
        "window.dispatchEvent(new Event('gamepadconnected'))"
    )
    desk.wait("return desk.present('reference.psi_set') > 0.08")
    north, east, heading = np.subtract(desk.ask(moved), start)
    assert north == 0.0
    # At full stick 1 m/s and 5 deg/s.
    assert np.degrees(heading) / east == pytest.approx(10.0, rel=0.1)
    # Where it is pulled out nothing moves any more.
    desk.ask("navigator.getGamepads = () => [null]")
    pause = "return new Promise((done) => setTimeout(() => done(true), 600))"
    desk.wait(pause)
    rest = desk.ask(moved)
    desk.wait(pause)
    assert desk.ask(moved) == rest


def test_a_run_that_fails_says_why_and_can_be_saved_and_taken_back(desk):
    desk.ask(
        "desk.live.reach(10); desk.act('override', 'vessel.tau_X_4', 1e300); desk.live.reach(40)"
    )
    said = desk.text("#failure")
    assert "vessel" in said and "t =" in said
    assert "tau_X_4" in desk.ask("return desk.scenario()")
    desk.ask("desk.live.back(5); desk.live.reach(40)")
    assert desk.ask("return desk.live.time.last") >= 40.0


def test_the_page_is_small_and_soon_there(page_file, desk):
    assert page_file.stat().st_size < 3e6
    loaded, drawn = desk.seconds()
    assert drawn < loaded + 5.0  # wide: a busy machine


def test_a_component_without_native_code_is_named_and_nothing_is_written(tmp_path):
    path = tmp_path / "page.html"
    with pytest.raises(ShipcosimError, match="allocator: has no native code"):
        exported("allocation/paper_v_four_corner", path)
    assert not path.exists()
