"""Writes the pictures of README and docs: pages as a browser shows them, the DP loop's margins, its sensors' failures.

Run `python docs/generators/write_images.py [NAME...]` after one looks different; it takes two minutes for all. Needs
Chromium, its driver, and the packages selenium, Pillow and matplotlib. `tests/bench/test_images.py` makes the pictures
again and compares them; docs/dataflow.md lists them all.
"""

import base64
import io
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import matplotlib
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"
PAGES = {
    "four_corner": ["run", "scenarios/four_corner.toml"],
    "diagnosis": ["diagnose", "docs/examples/gunnerus_log.csv.gz"],
    "capability": ["capability"],
    "study": ["sweep", "studies/drift_off_small.toml"],
    "live": ["export", "page", "scenarios/four_corner.toml"],
}
FILES = {"live": "four_corner.html"}
ACTS = {  # what is done before the picture, and what must be there then
    "live": (
        "desk.live.reach(300); desk.act('override', 'port.failed', true); desk.live.reach(420);"
        "scene.grown(desk.live.time.last); scene.go(desk.live.time.last)",
        "return desk.losses.time === 420",
    )
}
TIMES = {"four_corner": "#t=330"}  # s: under way, with set point and reference apart
HEIGHTS = {"four_corner": 1140, "diagnosis": 1020, "capability": 1030, "study": 850, "live": 1004}
SHIPCOSIM = Path(sys.executable).with_name("shipcosim")
WIDTH = 1280
SQUARE, CLEARLY = 20, 12  # px; of 255 shades of grey: a letter more or less is not
SWITCHES = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
)


def browser(profile: Path) -> webdriver.Chrome:
    """Headless Chromium, light."""
    options = webdriver.ChromeOptions()
    found = [shutil.which(name) for name in ("chromium", "chromium-browser", "google-chrome")]
    options.binary_location = next(path for path in found if path)
    for switch in (*SWITCHES, f"--user-data-dir={profile}"):
        options.add_argument(switch)
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    media = {"features": [{"name": "prefers-color-scheme", "value": "light"}]}
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", media)
    return driver


def picture(
    driver: webdriver.Chrome, page: str, height: int, act: tuple[str, str] | None = None
) -> bytes:
    """The top of a page as a small PNG, when every figure is drawn; `act` is a script, and one to wait for."""
    size = {"width": WIDTH, "height": height, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    driver.get(page)
    while driver.execute_script("return document.body.dataset.drawn") != "all":
        time.sleep(0.1)
    if act is not None:
        driver.execute_script(act[0])
        while not driver.execute_script(act[1]):
            time.sleep(0.1)
    shot = base64.b64decode(
        driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "png"})["data"]
    )
    written = io.BytesIO()
    Image.open(io.BytesIO(shot)).convert("RGB").save(written, "PNG", optimize=True)
    return written.getvalue()


def fresh(name: str, folder: Path) -> bytes:
    """A picture that is made now, in a folder that the caller deletes. PNG."""
    if name in PAGES:
        return of_page(name, folder)
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # whatever another generator has set
        DRAWN[name](folder / f"{name}.png")
    return (folder / f"{name}.png").read_bytes()


def dp_loop(path: Path) -> None:
    """Loop gains and sensitivities of the DP loop."""
    import write_dp_loop

    write_dp_loop.draw(write_dp_loop.loops()[0], path)


def dp_sensors(path: Path) -> None:
    """Two of the scenarios in which sensors fail, run now."""
    import write_dp_sensors as sensors

    sensors.draw(
        *(sensors.run(sensors.SCENARIOS / f"{name}.toml")[1] for name in sensors.SHOWN), path
    )


def sea_trials(path: Path) -> None:
    """The trials of 2022; needs the measured log beside the project."""
    import write_sea_trials

    write_sea_trials.draw(write_sea_trials.studied(), path)


DRAWN: dict[str, Callable[[Path], None]] = {
    "dp-loop": dp_loop,
    "dp-sensors": dp_sensors,
    "sea_trials_2022": sea_trials,
}


def path_of(name: str) -> Path:
    """Where a picture is kept."""
    return (
        ROOT / "docs" / "generated" / "pictures" if name == "sea_trials_2022" else IMAGES
    ) / f"{name}.png"


def of_page(name: str, folder: Path) -> bytes:
    """The picture of a page that is made now. PNG."""
    done = subprocess.run(
        [SHIPCOSIM, *PAGES[name], "--out", str(folder / name)], cwd=ROOT, stdout=subprocess.DEVNULL
    )
    if done.returncode not in (0, 1):  # 1: it ran and found something, as the diagnosis shall
        raise SystemExit(f"{' '.join(PAGES[name])} failed")
    driver = browser(folder / f"{name}-profile")
    try:
        return picture(
            driver,
            f"{(folder / name / FILES.get(name, 'report.html')).as_uri()}{TIMES.get(name, '')}",
            HEIGHTS[name],
            ACTS.get(name),
        )
    finally:
        driver.quit()


def difference(one: bytes, other: bytes) -> float:
    """Share of a picture, in squares of 20 px, that looks clearly different; 1 for pictures of other sizes."""
    images = [Image.open(io.BytesIO(png)).convert("L") for png in (one, other)]
    if images[0].size != images[1].size:
        return 1.0
    few = [image.reduce(SQUARE).tobytes() for image in images]
    return sum(abs(a - b) > CLEARLY for a, b in zip(*few, strict=True)) / len(few[0])


def write_images(names: list[str]) -> None:
    """Makes pictures in a folder that is deleted again, and keeps them; all that need no measured log without names."""
    with tempfile.TemporaryDirectory() as folder:
        for name in names or [*PAGES, "dp-loop", "dp-sensors"]:
            path_of(name).write_bytes(fresh(name, Path(folder)))


if __name__ == "__main__":
    write_images(sys.argv[1:])
