"""The thruster diagram and what the page shows of an allocator, by what is drawn."""

import json

import numpy as np
import pytest
from report.run.test_comparison import write_comparison

from shipcosim.report import write_report

SECTORS = {"port": [[80.0, 280.0]], "starboard": []}
START = {
    **{"vessel.length": 33.9, "vessel.breadth": 9.6, "port.x": -14.0, "port.y": -2.0},
    **{
        "port.thrust_min": -8e3,
        "port.thrust_max": 8e3,
        "starboard.thrust_min": -30e3,
        "starboard.thrust_max": 60e3,
    },
    **{
        "allocator.port_azimuth_first": np.radians(-80.0),
        "allocator.port_azimuth_last": np.radians(80.0),
    },
}


@pytest.fixture(scope="module")
def table(four_corner):
    found = four_corner()
    time = found["time"].values
    for name, unit in (
        ("slack_X", "N"),
        ("slack_Y", "N"),
        ("slack_N", "N.m"),
        ("thruster_power", "W"),
    ):
        found[f"allocator.{name}"] = (
            "time",
            1e3 * np.cos(time / 50.0),
            {"units": unit, "long_name": name},
        )
    found["allocator.solve_time"] = (
        "time",
        np.zeros(len(time)),
        {"units": "s", "long_name": "solve time"},
    )
    found.attrs["start_values"] = json.dumps(START)
    return found


@pytest.fixture(scope="module")
def file(table, tmp_path_factory):
    path = tmp_path_factory.mktemp("diagram") / "report.html"
    write_report(table, path)
    return path


@pytest.fixture(scope="module")
def opened():
    return []


@pytest.fixture
def page(browse, chromium, file, opened):
    """The page as the test before left it: these look at it at times of their own."""
    if not opened or chromium.current_url.partition("#")[0] != file.as_uri():
        opened[:] = [browse(file)]
    return opened[0]


def drawn(page, t):
    """What the diagram draws at a time, by unit."""
    page.ask("document.getElementById('diagram').scrollIntoView()")
    page.wait("scene.paint(); return scene.drawn.some(({ what }) => what === 'diagram')")
    items = page.ask(
        "scene.pause(); scene.time = arguments[0]; scene.paint(); return scene.drawn", t
    )
    return {item["unit"]: item for item in items if item["what"] == "diagram"}


def test_arrow_is_the_force_of_the_unit_bow_up_on_one_scale(page, table):
    units = drawn(page, 700.0)
    assert set(units) == {"port", "starboard"}  # the tunnel of this table says no direction
    row = table.sel(time=700.0)
    for name, item in units.items():
        thrust, azimuth = float(row[f"{name}.thrust"]) / 1e3, float(row[f"{name}.azimuth"])
        scale = item["radius"] / item["range"]
        right, down = np.subtract(item["to"], item["middle"])
        assert (right, -down) == pytest.approx(
            scale * thrust * np.array([np.sin(azimuth), np.cos(azimuth)]), abs=0.3
        )
        assert item["sectors"] == SECTORS[name]


def test_limits_of_thrust_and_sectors_are_shaded_in_the_plots(page):
    page.ask("document.querySelectorAll('.panel').forEach(p => p.scrollIntoView())")
    zones = page.ask("return Object.fromEntries(report.data.panels.map(p => [p.title, p.zones]))")
    assert [zone["lower"] for zone in zones["Thrust, port"]] == [8.0]
    assert zones["Thrust, starboard"] == [] and zones["North"] == []
    (zone,) = zones["Azimuth, port"]
    assert zone["upper"] == pytest.approx(-80.0) and -100.0 < zone["lower"] < -80.0
    assert not zones["Azimuth, starboard"]
    script = (
        "return [...document.querySelectorAll('.panel')]"
        ".filter(p => p._fullLayout?.title.text.includes('Azimuth, port'))"
        ".flatMap(p => p._fullLayout.shapes.filter(s => s.type === 'rect').map(s => s.fillcolor))"
    )
    page.wait(f"return (() => {{ {script} }})().length === 1")
    (fill,) = page.ask(script)
    assert fill.startswith("rgb") or fill.startswith("#"), "a colour that the browser knows"


def test_losses_and_power_of_the_allocator_have_their_panels(page):
    titles = page.ask("return report.data.panels.map(p => p.title)")
    assert (
        "Force missed by the allocator" in titles and "Yaw moment missed by the allocator" in titles
    )
    assert "Power of the thrusters, estimated by the allocator" in titles
    assert "Time of an allocation" not in titles  # it was not measured


def test_units_without_a_shaft_are_drawn_by_the_force_that_they_give(browse, table, tmp_path):
    """As mapped_thruster puts it out: a thrust, its command in the unit of the map, forces on the ship, no rpm."""
    mapped = table.drop_vars([name for name in table.data_vars if str(name).startswith("tunnel.")])
    thrust = table["tunnel.thrust"]
    for name, values in (("thrust", thrust), ("tau_X", 0.0 * thrust), ("tau_Y", thrust)):
        mapped[f"tunnel.{name}"] = ("time", values.values, {"units": "N", "long_name": name})
    known = {"tunnel.x": 10.0, "tunnel.y": 0.0, "tunnel.thrust_table": "-10 -6000; 0 0; 10 7000"}
    mapped.attrs["start_values"] = json.dumps(START | known)
    path = tmp_path / "report.html"
    write_report(mapped, path)
    page = browse(path)
    item = drawn(page, 700.0)["tunnel"]
    right, down = np.subtract(item["to"], item["middle"])
    force = float(thrust.sel(time=700.0)) / 1e3 * item["radius"] / item["range"]
    assert (right, down) == pytest.approx((force, 0.0), abs=0.3) and abs(force) > 5.0
    assert item["limits"] == [-6.0, 7.0]


def painted(page, east, north):
    """Colour of the diagram of port at a place, in radii from its middle, beside that of clear ground."""
    script = (
        "const { middle, radius } = scene.drawn.find(({ what, unit }) => what === 'diagram' && unit === 'port');"
        "const c = document.getElementById('scene-diagram'), r = devicePixelRatio;"
        "return [...c.getContext('2d').getImageData(Math.round((middle[0] + arguments[0] * radius) * r),"
        "Math.round((middle[1] - arguments[1] * radius) * r), 1, 1).data]"
    )
    return np.array(page.ask(script, east, north), int)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_forbidden_sectors_are_shaded_and_the_rest_is_not(shown_at, file, scheme):
    page = shown_at(file, 1280, scheme)
    drawn(page, 700.0)
    ground = painted(page, 0.53, 0.53)
    shaded = [
        np.abs(painted(page, east, north) - ground).max()
        for east, north in ((0.7, 0.05), (-0.7, -0.05), (0.3, -0.6))
    ]
    assert min(shaded) > 15
    assert np.abs(painted(page, -0.53, 0.53) - ground).max() <= 3


def test_two_allocators_lie_over_each_other(browse, table, tmp_path):
    other = table.copy()
    other["port.thrust"] = -table["port.thrust"]
    other["port.thrust"].attrs = table["port.thrust"].attrs
    path = tmp_path / "report.html"
    write_comparison((table, other), ("inverse", "optimal"), path)
    page = browse(path)
    page.ask("document.getElementById('diagram').scrollIntoView()")
    page.wait("scene.paint(); return scene.drawn.some(({ what }) => what === 'diagram')")
    items = page.ask("scene.pause(); scene.time = 700; scene.paint(); return scene.drawn")
    ends = {
        item["run"]: np.subtract(item["to"], item["middle"])
        for item in items
        if item["what"] == "diagram" and item["unit"] == "port"
    }
    assert ends["inverse"] == pytest.approx(-ends["optimal"], abs=0.3)


@pytest.mark.parametrize("width", [500, 1280])
def test_states_of_two_runs_have_a_line_each(shown_at, table, tmp_path, width):
    units = ("port", "starboard", "tunnel")
    flags = [f"{unit}.failed" for unit in units] + ["allocator.saturated"]
    failing = table.assign({flag: table["port.saturated"] for flag in flags})
    path = tmp_path / "report.html"
    write_comparison(
        (failing, failing.isel(time=slice(0, -1))), ("generalised inverse", "optimal"), path
    )
    page = shown_at(path, width)
    page.ask("document.querySelectorAll('.panel').forEach(p => p.scrollIntoView())")
    labels = (
        "const plot = [...document.querySelectorAll('.panel')].find(p => p._fullLayout?.title.text.includes('failed'));"
        "return [...(plot?.querySelectorAll('.ytick text') ?? [])].map(e => e.getBoundingClientRect().toJSON())"
    )
    page.wait(f"return (() => {{ {labels} }})().length === 14")
    boxes = sorted(page.ask(labels), key=lambda box: box["top"])
    assert all(
        box["bottom"] <= below["top"] + 1.0 for box, below in zip(boxes, boxes[1:], strict=False)
    )


@pytest.mark.parametrize("width", [500, 1280])
def test_circles_stay_inside_and_apart(shown_at, file, width):
    page = shown_at(file, width)
    units = drawn(page, 700.0)
    wide = page.ask("return document.getElementById('scene-diagram').clientWidth")
    middles = [np.array(item["middle"]) for item in units.values()]
    radius = units["port"]["radius"]
    assert all(radius < x < wide - radius for x, _ in middles)
    assert np.hypot(*(middles[1] - middles[0])) > 2.0 * radius + 40.0
