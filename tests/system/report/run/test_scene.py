"""The scene of a run, by what it draws: in metres as its draw list says, and in pixels of the chart."""

import json

import numpy as np
import pytest
import xarray as xr
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from shipcosim.report import write_report
from shipcosim.report.run.scene import make_run
from shipcosim.report.run.track import hull_outline

SIZE = {"vessel.length": 33.9, "vessel.breadth": 9.6}
PLACES = {
    "port.x": -14.0,
    "port.y": -2.0,
    "starboard.x": -14.0,
    "starboard.y": 2.0,
    "tunnel.x": 14.5,
}
LIMITS = {"port.thrust_max": 10000.0, "port.thrust_min": -8000.0}


@pytest.fixture(scope="module")
def table(four_corner):
    found = four_corner()
    found["monitor.position_alarm"] = ("time", np.zeros(found.sizes["time"], bool))
    # Reference 1 is lost from 500 s on and reference 2 is rejected; bus A has 20 kW.
    late = found["time"].values >= 500.0
    for name, flags in {
        "sensors.position_1_valid": ~late,
        "controller.position_1_rejected": np.zeros_like(late),
        "sensors.position_2_valid": np.ones_like(late),
        "controller.position_2_rejected": late,
        "sensors.wind_valid": np.ones_like(late),
    }.items():
        found[name] = ("time", flags)
    found["allocator.bus_a_load"] = ("time", np.where(late, 30e3, 10e3), {"units": "W"})
    found["allocator.bus_a_power"] = ("time", np.full(late.size, 20e3), {"units": "W"})
    found["allocator.bus_b_load"] = ("time", np.full(late.size, 5e3), {"units": "W"})
    found.attrs["start_values"] = json.dumps(
        {**SIZE, **PLACES, **LIMITS, "monitor.position_limit": 3.0}
    )
    return found


@pytest.fixture(scope="module")
def file(table, scenario, verdicts, tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "report.html"
    write_report(table, path, scenario=scenario, verdicts=verdicts)
    return path


@pytest.fixture(scope="module")
def opened():
    return []


@pytest.fixture
def page(browse, chromium, file, opened):
    """The page as the test before left it: each says which time it looks at."""
    if not opened or chromium.current_url.partition("#")[0] != file.as_uri():
        opened[:] = [browse(file)]
    opened[0].ask("window.scrollTo(0, 0)")
    return opened[0]


@pytest.mark.parametrize(
    ("t", "rows", "bad"),
    [
        (100.0, "used used valid 10 kW of 20 kW 5 kW", 0),
        (600.0, "lost rejected valid 30 kW of 20 kW 5 kW", 3),
    ],
)
def test_references_and_buses_show_their_state_at_the_time(page, t, rows, bad):
    page.ask("scene.pause(); scene.go(arguments[0])", t)
    cells = "[...document.querySelectorAll('#status td')].map((cell) => cell.textContent).join(' ')"
    page.wait(f"return {cells} === '{rows}'", 20.0)
    assert page.ask("return document.querySelectorAll('#status .bad').length") == bad


def drawn(page, t, **wanted):
    """What the scene draws at a time, of those items that have these values."""
    items = page.ask(
        "scene.pause(); scene.time = arguments[0]; scene.paint(); return scene.drawn", t
    )
    return [item for item in items if all(item.get(key) == value for key, value in wanted.items())]


def corners(length, breadth, north, east, heading):
    """Outline of a ship on the chart, north and east of each corner. [m, m]; heading in rad"""
    forward, starboard = hull_outline(length, breadth)
    c, s = np.cos(heading), np.sin(heading)
    return north + c * forward - s * starboard, east + s * forward + c * starboard


@pytest.mark.parametrize("t", [0.0, 300.25, 480.0, 1100.0])
def test_outline_stands_where_the_table_says(page, table, t):
    (hull,) = drawn(page, t, what="hull")
    pose = [
        float(np.interp(t, table["time"], table[f"vessel.{axis}"])) for axis in ("x", "y", "psi")
    ]
    north, east = corners(33.9, 9.6, *pose)
    assert hull["north"] == pytest.approx(north, abs=0.03) and hull["east"] == pytest.approx(
        east, abs=0.03
    )


def test_outline_is_painted_there_in_the_colour_of_the_ship(page):
    """A point of the hull clear of everything else has another colour than the water beside it."""
    (hull,) = drawn(page, 300.0, what="hull")
    north, east = hull["position"]
    read = (
        "const [x, y] = scene.pixel(arguments[0], arguments[1]), c = document.getElementById('scene-chart');"
        "const r = devicePixelRatio; return [...c.getContext('2d').getImageData(x * r, y * r, 1, 1).data]"
    )
    on_board, water = (
        page.ask(read, east + 3.6, north - 8.0),
        page.ask(read, east + 9.5, north - 8.0),
    )
    assert (
        on_board[3] == water[3] == 255
        and max(abs(a - b) for a, b in zip(on_board, water, strict=True)) > 20
    )


def test_metre_is_as_long_north_as_east_and_the_ship_to_scale(page):
    (hull,) = drawn(page, 0.0, what="hull")
    x0, y0 = page.ask("return scene.pixel(0, 0)")
    x1, y1 = page.ask("return scene.pixel(10, 10)")
    assert x1 - x0 == pytest.approx(y0 - y1) and x1 > x0


@pytest.mark.parametrize("t", [100.0, 700.0])
def test_force_vector_has_length_and_direction_of_the_thrust(page, table, t):
    (hull,) = drawn(page, t, what="hull")
    forces = {item["unit"]: item for item in drawn(page, t, what="force")}
    heading = np.radians(hull["heading"])
    row = table.sel(time=t)
    for unit, (forward, starboard) in {"port": (-14.0, -2.0), "starboard": (-14.0, 2.0)}.items():
        item = forces[unit]
        thrust, azimuth = float(row[f"{unit}.thrust"]) / 1000.0, float(row[f"{unit}.azimuth"])
        vector = np.subtract(item["to"], item["from"])
        assert np.hypot(*vector) == pytest.approx(
            abs(thrust) * item["metresPerKilonewton"], rel=1e-3
        )
        along = heading + azimuth + (np.pi if thrust < 0 else 0.0)
        assert vector / np.hypot(*vector) == pytest.approx([np.cos(along), np.sin(along)], abs=0.01)
        north = hull["position"][0] + np.cos(heading) * forward - np.sin(heading) * starboard
        east = hull["position"][1] + np.sin(heading) * forward + np.cos(heading) * starboard
        assert item["from"] == pytest.approx([north, east], abs=0.01)
    assert (
        "tunnel" not in forces
    )  # it has no azimuth and says no direction: an instrument, no vector


def test_limits_and_watch_circle_are_drawn_about_their_points(page, table):
    circles = drawn(page, 240.0, what="circle", of="expectation")
    assert [(c["north"], c["east"], c["now"]) for c in circles][:2] == [
        (20, 0, True),
        (20, -20, False),
    ]
    (watch,) = drawn(page, 240.0, what="circle", of="watch")
    assert watch["radius"] == 3.0 and watch["beyond"] is False
    assert watch["north"] == pytest.approx(float(table["reference.x_d"].sel(time=240.0)), abs=0.02)


def test_figures_say_position_reference_and_error(page, table):
    drawn(page, 700.0)
    north, wanted = (float(table[name].sel(time=700.0)) for name in ("vessel.x", "reference.x_d"))
    cells = page.ask(
        "return [...document.getElementById('scene-figures').rows[1].cells].map(c => c.textContent)"
    )
    shown = [float(text.replace("−", "-")) for text in cells[1:]]
    assert cells[0] == "North [m]" and shown == pytest.approx(
        [north, wanted, north - wanted], abs=0.012
    )


def test_play_advances_at_the_chosen_speed_and_pause_stops(page):
    page.ask("scene.go(10); scene.setSpeed(32)")
    page.driver.find_element(By.ID, "scene-play").click()
    page.wait("return scene.time > 30")
    before, clock = page.ask("return [scene.time, performance.now()]")
    page.wait("return scene.time > 70")
    after, later = page.ask("return [scene.time, performance.now()]")
    assert (after - before) / ((later - clock) / 1000.0) == pytest.approx(32.0, rel=0.15)
    page.driver.find_element(By.ID, "scene-play").click()
    assert page.ask("return scene.playing") is False


def test_keys_play_and_move(page):
    page.ask("scene.go(100); scene.setSpeed(4)")
    body = page.driver.find_element(By.TAG_NAME, "body")
    body.send_keys(Keys.ARROW_RIGHT)
    assert page.ask("return scene.time") == pytest.approx(104.0)
    ActionChains(page.driver).key_down(Keys.SHIFT).send_keys(Keys.ARROW_LEFT).key_up(
        Keys.SHIFT
    ).perform()
    assert page.ask("return scene.time") == pytest.approx(64.0)
    body.send_keys(Keys.SPACE)
    assert page.ask("return scene.playing") is True
    body.send_keys(Keys.SPACE)
    assert page.ask("return scene.playing") is False
    page.driver.find_element(By.ID, "filter").send_keys("a ", Keys.HOME)
    assert page.ask("return scene.playing") is False and page.ask("return scene.time") > 60.0


def test_address_opens_the_page_at_a_time_and_keeps_it(browse, chromium, file):
    page = browse(file)
    chromium.get(file.as_uri() + "#t=432.5")
    chromium.refresh()
    page.wait("return document.body.dataset.drawn === 'all'")
    assert page.ask("return scene.time") == 432.5
    page.ask("scene.go(500)")
    page.wait("return location.hash === '#t=500'")
    chromium.get("about:blank")


def test_plots_have_a_cursor_and_a_click_in_one_moves_the_scene(page):
    panel = page.driver.find_element(By.ID, "panel-0")
    page.ask("arguments[0].scrollIntoView({block: 'center'}); scene.go(550)", panel)
    page.wait("return document.querySelector('#panel-0 .now') && scene.time === 550")
    page.wait("return !document.querySelector('#panel-0 .now').hidden")
    page.wait(  # half of 1100 s
        "const p = document.getElementById('panel-0'), area = p.querySelector('.nsewdrag').getBoundingClientRect();"
        "const line = p.querySelector('.now').getBoundingClientRect();"
        "return Math.abs((line.left - area.left) / area.width - 0.5) < 0.01"
    )
    plot = page.driver.find_element(By.CSS_SELECTOR, "#panel-0 .nsewdrag")
    ActionChains(page.driver).move_to_element_with_offset(
        plot, int(plot.size["width"] * 0.25), 0
    ).click().perform()
    page.wait("return Math.abs(scene.time - 825) < 10")


def test_footprint_and_polar_count_every_row(page, table):
    page.ask("document.getElementById('errors').scrollIntoView({block: 'center'})")
    page.wait("scene.refresh(); return scene.drawn.some(item => item.what === 'sector')")
    (footprint,) = drawn(page, 0.0, what="footprint")
    north, east = (table[f"vessel.{a}"].values - table[f"reference.{a}_d"].values for a in "xy")
    off = np.hypot(north, east)
    assert footprint["rows"] == len(off)
    assert footprint["largest"] == pytest.approx(off.max(), abs=0.02)
    assert footprint["half"] == pytest.approx(np.median(off), abs=0.02)
    sectors = drawn(page, 0.0, what="sector")
    assert sum(sector["count"] for sector in sectors) == len(off)
    farthest = max(sectors, key=lambda sector: sector["most"])
    angle = np.degrees(np.arctan2(east, north)[np.argmax(off)])
    assert abs((farthest["degrees"] - angle + 180) % 360 - 180) <= 11.5


def two_ships():
    """A tug that circles a ship lying still; the tug says its position as others do."""
    time = np.linspace(0.0, 100.0, 201)
    angle = 2 * np.pi * time / 100
    signals = {
        "tanker.vessel.x": (0.0 * time + 0.01 * np.sin(time), "m"),
        "tanker.vessel.y": (0.0 * time, "m"),
        "tanker.vessel.psi": (0.0 * time, "rad"),
        "tanker.sensors.x": (0.0 * time + 0.1 * np.sin(3 * time), "m"),
        "tanker.sensors.y": (0.0 * time, "m"),
        "tanker.sensors.psi": (0.0 * time, "rad"),
        "tug.boat.north": (80.0 * np.cos(angle), "m"),
        "tug.boat.east": (80.0 * np.sin(angle), "m"),
        "tug.boat.heading": (np.degrees(angle) + 90.0, "deg"),
        "tug.bow.thrust": (5.0 + 0.0 * time, "kN"),
        "tug.bow.azimuth": (45.0 + 0.0 * time, "deg"),
        "tug.bow.rpm": (100.0 + 0.0 * time, "rpm"),
    }
    table = xr.Dataset(
        {k: ("time", v, {"units": u}) for k, (v, u) in signals.items()}, {"time": time}
    )
    sizes = {"tanker.vessel.length": 200.0, "tanker.vessel.breadth": 30.0}
    own = {"tug.boat.length": 30.0, "tug.boat.breadth": 10.0, "tug.bow.x": 8.0}
    table.attrs["start_values"] = json.dumps(sizes | own)
    return table


def test_several_vessels_are_drawn_each_with_what_is_hers_and_a_sensor_is_none(browse, tmp_path):
    write_report(two_ships(), tmp_path / "two.html")
    page = browse(tmp_path / "two.html")
    hulls = {item["vessel"]: item for item in drawn(page, 25.0, what="hull")}
    assert set(hulls) == {"tanker.vessel", "tug.boat"}
    assert hulls["tug.boat"]["position"] == pytest.approx([0.0, 80.0], abs=0.1)
    assert hulls["tug.boat"]["heading"] % 360 == pytest.approx(180.0, abs=0.5)
    (force,) = drawn(page, 25.0, what="force")
    assert force["vessel"] == "tug.boat"
    vector = np.subtract(force["to"], force["from"])
    assert vector / np.hypot(*vector) == pytest.approx([-np.sqrt(0.5), -np.sqrt(0.5)], abs=0.02)
    assert page.errors() == []


def test_input_that_nothing_is_connected_to_is_no_vessel():
    table = two_ships()[["tug.boat.north", "tug.boat.east", "tug.boat.heading"]]
    for axis, unit in (("x", "m"), ("y", "m"), ("psi", "rad")):
        table[f"controller.{axis}"] = ("time", np.zeros(table.sizes["time"]), {"units": unit})
    run = make_run(table)
    assert run is not None and [vessel["name"] for vessel in run.vessels] == ["tug.boat"]


def test_what_is_missing_is_left_out():
    """Only a pose: no size, thrusters, weather, set point; nothing is made up for them."""
    table = two_ships()[["tug.boat.north", "tug.boat.east", "tug.boat.heading"]]
    run = make_run(table.assign_attrs(start_values="{}"))
    assert run is not None and len(run.vessels) == 1
    assert (
        run.vessels[0]["units"] == []
        and run.vessels[0]["aims"] == {}
        and not run.vessels[0]["to_scale"]
    )
    assert run.flows == [] and run.circles == [] and run.watch == {}


def test_thrusters_have_no_place_on_a_ship_of_unknown_size():
    table = two_ships()
    table.attrs["start_values"] = json.dumps({"tug.bow.x": 8.0})
    run = make_run(table[[name for name in table.data_vars if str(name).startswith("tug.")]])
    assert run is not None and [unit["place"] for unit in run.vessels[0]["units"]] == [None]


def test_names_of_others_are_read_and_what_measures_something_else_is_not():
    table = two_ships()
    nested = {
        "tug.boat.north": "hull.ned.north",
        "tug.boat.east": "hull.ned.east",
        "tug.boat.heading": "hull.angles.yaw",
    }
    run = make_run(table[list(nested)].rename(nested))
    assert run is not None and run.vessels[0]["pose"] == list(nested.values())
    forces = table[list(nested)]
    for name in ("tug.boat.north", "tug.boat.east"):
        forces[name].attrs["units"] = "N"
    assert make_run(forces) is None


def test_positions_in_kilometres_are_drawn_in_metres():
    table = two_ships()[["tug.boat.north", "tug.boat.east", "tug.boat.heading"]]
    for name in ("tug.boat.north", "tug.boat.east"):
        table[name] = table[name] / 1000.0
        table[name].attrs["units"] = "km"
    run = make_run(table)
    assert run is not None and run.vessels[0]["way"][0][0] == pytest.approx(80.0)


def test_signals_without_a_unit_are_said():
    table = two_ships()[["tanker.vessel.x", "tanker.vessel.y", "tanker.vessel.psi"]]
    del table["tanker.vessel.psi"].attrs["units"]
    run = make_run(table)
    assert run is not None and any(
        "without a unit" in said and "tanker.vessel.psi" in said for said in run.read_as
    )


def test_frame_takes_less_than_half_of_a_thirtieth_of_a_second(page):
    """So that thirty a second are played beside what else a browser does; pixels are read so that they are painted."""
    times = page.ask(
        "window.scrollTo(0, 700); const canvases = [...document.querySelectorAll('canvas')];"
        "return [...Array(61).keys()].map(k => { const begin = performance.now(); scene.time = 18 * k; scene.paint();"
        "for (const c of canvases) c.getContext('2d').getImageData(0, 0, 1, 1); return performance.now() - begin; })"
    )
    assert np.median(times) < 1000.0 / 30.0 / 2.0


def test_playing_paints_frame_after_frame(page):
    page.ask("scene.go(0); scene.setSpeed(64); scene.play()")
    page.wait("return scene.time > 5")
    first = page.ask("return scene.frames")
    page.wait(f"return scene.frames > {first + 20}")
    page.ask("scene.pause()")
