"""A made-up four-corner run with the signals of gunnerus_dp: the page's tests need no FMU."""

import base64
import gzip
import json
import os
import re
import shutil
import time as clock
from functools import cache

import numpy as np
import pytest
import xarray as xr

from shipcosim.scenario import Event, Expectation, Scenario, judge

PACKED = r'<script type="text/plain" id="data">([^<]*)</script>'

SET_POINTS = [  # time [s], x [m], y [m], psi [rad]
    (0.0, 20.0, 0.0, 0.0),
    (250.0, 20.0, -20.0, 0.0),
    (450.0, 20.0, -20.0, -np.pi / 4),
    (650.0, 0.0, -20.0, -np.pi / 4),
    (850.0, 0.0, 0.0, 0.0),
]


def staircase(time, column):
    """Set point over time, (n,)."""
    steps = np.searchsorted([row[0] for row in SET_POINTS], time, side="right") - 1
    return np.array([row[column] for row in SET_POINTS])[steps]


def follow(values, start, period, spacing):
    """Critically damped second-order answer to a staircase, (n,); `period` is the natural period over 2 pi. [s]"""
    answer, position, rate = np.empty(len(values)), start, 0.0
    for k, target in enumerate(values):
        answer[k] = position
        acceleration = (target - position) / period**2 - 2.0 * rate / period
        rate += spacing * acceleration
        position += spacing * rate
    return answer


def smooth_noise(generator, n, memory):
    """First-order noise of unit standard deviation, (n,); `memory` in samples."""
    a = np.exp(-1.0 / memory)
    draws, values, value = generator.standard_normal(n), np.empty(n), 0.0
    for k in range(n):
        value = a * value + np.sqrt(1 - a * a) * draws[k]
        values[k] = value
    return values


def poses(time, generator):
    """Set point, reference, ship, measurement and estimate: signals of the pose."""
    noise = lambda size, memory=60: size * smooth_noise(generator, len(time), memory)  # noqa: E731
    signals = {}
    for column, (name, unit, error) in enumerate(
        [("x", "m", 0.12), ("y", "m", 0.1), ("psi", "rad", 0.004)], start=1
    ):
        signals[f"reference.{name}_set"] = (staircase(time, column), unit)
        desired = follow(signals[f"reference.{name}_set"][0], 0.0, 15.0, time[1])
        ship = follow(desired, 0.0, 3.0, time[1]) + noise(error) * np.minimum(time / 30, 1)
        signals[f"reference.{name}_d"] = (desired, unit)
        signals[f"vessel.{name}"] = (ship, unit)
        signals[f"sensors.{name}_meas"] = (ship + noise(error, 2), unit)
        signals[f"controller.{name}_hat"] = (ship + noise(error / 5, 20), unit)
    return signals


def loads(time, generator):
    """Forces by source and the thrusters' command and answer."""
    n = len(time)
    noise = lambda mean, size, memory=20: mean + size * smooth_noise(generator, n, memory)  # noqa: E731
    signals = {}
    for axis, unit, scale in [("X", "N", 1.0), ("Y", "N", 2.0), ("N", "N.m", 8.0)]:
        outside = np.zeros(n)
        for source, mean, size in [("wind", -2600, 700), ("drift", -300, 60), ("hull", -900, 500)]:
            values = scale * noise(mean, size)
            outside += values
            signals[f"vessel.tau_{source}_{axis}"] = (values, unit)
        signals[f"controller.tau_{axis}_cmd"] = (scale * noise(3700, 900), unit)
        signals[f"vessel.tau_thrusters_{axis}"] = (-outside, unit)
    for name, mean in [("port", 4000.0), ("starboard", 5200.0), ("tunnel", -2500.0)]:
        command = noise(mean, 1200)
        thrust = np.clip(follow(command, mean, 1.0, time[1]), -6500, 6500)
        signals[f"allocator.{name}_thrust_cmd"] = (command, "N")
        signals[f"{name}.thrust"] = (thrust, "N")
        signals[f"{name}.rpm"] = (np.sign(thrust) * np.sqrt(abs(thrust)) * 1.3, "rpm")
        signals[f"{name}.torque"] = (thrust * 0.2, "N.m")
        signals[f"{name}.power"] = (abs(thrust) ** 1.5 / 12, "W")
        signals[f"{name}.saturated"] = (abs(thrust) >= 6500, "1")
    for name, angle in [("port", -0.8), ("starboard", 0.8)]:
        signals[f"allocator.{name}_azimuth_cmd"] = (np.full(n, angle), "rad")
        signals[f"{name}.azimuth"] = (follow(np.full(n, angle), 0.0, 4.0, time[1]), "rad")
    return signals


def weather(time, generator):
    """Wind with gusts, current, waves."""
    n = len(time)
    speed, direction = (
        8 + 1.2 * smooth_noise(generator, n, 15),
        np.pi / 4 + 0.06 * smooth_noise(generator, n, 30),
    )
    return {
        "environment.wind_north": (-speed * np.cos(direction), "m/s"),
        "environment.wind_east": (-speed * np.sin(direction), "m/s"),
        "environment.wind_speed_mean": (np.full(n, 8.0), "m/s"),
        "environment.wind_from_mean": (np.full(n, np.pi / 4), "rad"),
        "environment.current_north": (np.full(n, -0.3), "m/s"),
        "environment.current_east": (np.zeros(n), "m/s"),
        "environment.wave_height": (np.full(n, 0.3), "m"),
        "environment.wave_period": (np.full(n, 5.0), "s"),
        "environment.wave_from": (np.full(n, np.pi / 4), "rad"),
        "environment.elevation": (0.075 * smooth_noise(generator, n, 3), "m"),
        "environment.wave_seed": (np.full(n, 7), "1"),
    }


@cache
def made_up_run(interval):
    """Table of 1100 s. [s]"""
    time = np.arange(int(round(1100 / interval)) + 1) * interval
    generator = np.random.default_rng(3)
    signals = {**poses(time, generator), **loads(time, generator), **weather(time, generator)}
    for name in "uvr":
        signals[f"vessel.{name}"] = (
            0.05 * smooth_noise(generator, len(time), 40),
            "rad/s" if name == "r" else "m/s",
        )
    return xr.Dataset(
        {
            k: ("time", v, {"units": unit, "long_name": f"made-up {k}"})
            for k, (v, unit) in signals.items()
        },
        coords={"time": ("time", time, {"units": "s"})},
    )


@pytest.fixture(scope="session")
def four_corner():
    """Function from the output interval to a table of 1100 s, which whoever asks may change. [s]"""
    return lambda interval=0.5: made_up_run(interval).copy(deep=True)


@pytest.fixture(scope="session")
def scenario():
    """What the made-up run was asked to do; the last expectation is missed."""
    expect = []
    for (_, x, y, psi), end in zip(SET_POINTS, [250.0, 450.0, 650.0, 850.0, 1100.0], strict=True):
        during = [end - 20.0, end]
        expect.append(
            Expectation(signal=["vessel.x", "vessel.y"], near=[x, y], within=0.5, during=during)
        )
        expect.append(Expectation(signal=["vessel.psi"], near=[psi], within=0.0175, during=during))
    expect.append(Expectation(signal=["port.power"], at_most=100.0))
    events = [Event(time=t, override={"reference.x_set": x}) for t, x, _, _ in SET_POINTS]
    return Scenario(
        description="Four corners & more",
        stop_time=1100.0,
        step_size=0.05,
        events=events,
        expect=expect,
    )


@pytest.fixture(scope="session")
def verdicts(four_corner, scenario):
    """On the made-up run."""
    return judge(four_corner(), scenario)


@pytest.fixture(scope="session")
def data_of():
    """Function from a page's text to the data that it draws, as strict JSON."""

    def data(page):
        (packed,) = re.findall(PACKED, page)
        text = gzip.decompress(base64.b64decode(packed)).decode()
        return json.loads(text, parse_constant=lambda name: pytest.fail(name))

    return data


@pytest.fixture(scope="session")
def chromium(tmp_path_factory):
    """Headless Chromium; the tests skip where it is absent, unless SHIPCOSIM_NO_SKIP says that it must be there."""
    programs = [next(filter(None, map(shutil.which, names)), None) for names in CHROMIUM]
    if None in programs and not os.environ.get("SHIPCOSIM_NO_SKIP"):
        pytest.skip("needs Chromium and its driver, which are not here")
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    for switch in (*SWITCHES, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(switch)
    driver = webdriver.Chrome(options=options, service=Service(programs[1]))
    yield driver
    driver.quit()


CHROMIUM = (("chromium", "chromium-browser", "google-chrome"), ("chromedriver",))
SWITCHES = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--window-size=1280,1000",
)


class Page:
    """A page in the browser, and what the tests ask it."""

    def __init__(self, driver, path):
        self.driver = driver
        driver.get_log("browser"), driver.get_log("performance")
        driver.get(path.as_uri())
        self.wait("return document.body.dataset.drawn === 'all'")

    def ask(self, script, *arguments):
        """What a script returns."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, script, seconds=120.0):
        """Until a script returns something true."""
        end = clock.monotonic() + seconds
        while not self.ask(script):
            assert clock.monotonic() < end, f"still not: {script}"
            clock.sleep(0.05)

    def panels(self):
        """Names of the curves in each panel, by the panel's title."""
        return self.ask(
            "return Object.fromEntries([...document.querySelectorAll('.panel')].map(p => "
            "[p._fullLayout.title.text.replace(/<.?b>/g, ''), p.data.map(t => t.name)]))"
        )

    def text(self, selector):
        """Visible text of the first element."""
        return self.ask("return document.querySelector(arguments[0])?.innerText", selector)

    def errors(self):
        """What the console complains of."""
        return [
            entry["message"]
            for entry in self.driver.get_log("browser")
            if entry["level"] in ("SEVERE", "WARNING")
        ]

    def requests(self):
        """Addresses that were asked for, other than the page itself and what is inside the browser."""
        messages = [
            json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")
        ]
        urls = [
            m["params"]["request"]["url"]
            for m in messages
            if m["method"] == "Network.requestWillBeSent"
        ]
        inside = ("file:", "data:", "blob:", "chrome:", "chrome-untrusted:")  # the last: a new tab
        return [url for url in urls if not url.startswith(inside)]

    def seconds(self):
        """When the page was loaded, and when all that is in view was drawn. [s]"""
        self.wait("return performance.getEntriesByName('in view').length > 0")
        script = "return [performance.getEntriesByType('navigation')[0].loadEventEnd, "
        return [
            1e-3 * ms
            for ms in self.ask(script + "performance.getEntriesByName('in view')[0].startTime]")
        ]

    def collisions(self):
        """Pairs of texts of one figure that lie over one another by more than 2 px."""
        return self.ask(COLLISIONS)


COLLISIONS = """
const parts = ".legendtext, .gtitle, .xtick text, .ytick text, .xtitle, .ytitle, .modebar-btn, .angularaxistick text";
const apart = (a, b) => a.right - 2 < b.left || b.right - 2 < a.left || a.bottom - 2 < b.top || b.bottom - 2 < a.top;
const found = [];
for (const plot of document.querySelectorAll(".js-plotly-plot")) {
  const boxes = [...plot.querySelectorAll(parts)].filter((e) => getComputedStyle(e).visibility !== "hidden")
    .map((e) => [e.textContent || "button", e.getBoundingClientRect()]).filter(([, box]) => box.width && box.height);
  boxes.forEach(([one, a], k) => boxes.slice(k + 1).forEach(([other, b]) => apart(a, b) || found.push([one, other])));
}
return found;
"""


@pytest.fixture
def shown_at(browse, chromium):
    """Function that shows a page at a width, light or dark."""

    def show(path, width, scheme="light"):
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 700}
        chromium.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        media = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
        chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
        return browse(path)

    yield show
    chromium.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


@pytest.fixture
def browse(chromium):
    """Function that opens a page."""
    return lambda path: Page(chromium, path)
