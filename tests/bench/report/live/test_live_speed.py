"""How fast the live page of the four corners is: the figures of docs/live.md."""

import time

import numpy as np
from report.live.test_live import desk, page_file

from speed.measure import reported

ROUNDS = 3
FASTEST, SHOWN = 1000.0, 16  # times real time: to reach, and at which frames are counted


def test_the_page_is_small_and_soon_ready(page_file, browse):
    size = page_file.stat().st_size / 1e6
    assert reported("size", [size], "MB", "3") < 3.0
    seconds = []
    for _ in range(ROUNDS):
        page = browse(page_file)
        page.wait("return Boolean(window.desk && window.scene)")
        # Since the browser began to open the file.
        seconds.append(
            1e-3 * page.ask("return performance.getEntriesByName('in view')[0].startTime")
        )
    assert reported("ready after", seconds, "s", "1") < 3.0


def test_it_runs_a_thousand_times_real_time_with_everything_drawn(desk):
    desk.ask("scene.setSpeed(Infinity); scene.play()")
    desk.wait("return desk.live.time.last > 500")  # the browser has compiled it by then
    speeds = []
    for _ in range(ROUNDS):
        begin, first = time.perf_counter(), desk.ask("return desk.live.time.last")
        time.sleep(3.0)
        last = desk.ask("return desk.live.time.last")
        speeds.append((last - first) / (time.perf_counter() - begin))
    desk.ask("scene.pause()")
    assert reported("simulated over real time", speeds, "", f"{FASTEST:g}") > 0.5 * FASTEST


def test_frames_come_sixty_a_second(desk):
    desk.ask(
        "window.frames_ms = []; let last = performance.now(); const frame = (now) => {"
        "frames_ms.push(now - last); last = now; requestAnimationFrame(frame); }; requestAnimationFrame(frame);"
        f"scene.setSpeed({SHOWN}); scene.play()"
    )
    time.sleep(10.0)
    frames = np.array(desk.ask("scene.pause(); return frames_ms.slice(5)"))
    print(f"\nlongest of {len(frames)} frames: {frames.max():.0f} ms; to reach 50")
    assert reported("time of a frame", frames.tolist(), "ms", "16.7") < 20.0


def test_the_forecast_of_all_losses_takes_half_a_second(desk):
    milliseconds = []
    for end in (60, 120, 180):
        desk.ask(f"desk.live.reach({end})")
        desk.wait(f"return desk.losses.time >= {end}")
        milliseconds.append(desk.ask("return desk.losses.milliseconds"))
    assert reported("forecast of five losses", milliseconds, "ms", "500") < 1000.0
