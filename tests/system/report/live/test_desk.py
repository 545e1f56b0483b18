"""What a reader does at the desk, by keys and pointer, and what stands of it in the saved scenario."""

import base64
import tomllib

import numpy as np
import pytest
import xarray as xr
from report.live.conftest import PILOT
from report.live.test_live import SAME, largest_difference, repeated
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from typer.testing import CliRunner

from shipcosim.cli.app import app
from shipcosim.cosim.export.fmu import block_of
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.report.live.export import live_page
from shipcosim.scenario import Scenario
from shipcosim.series import read_table, write_table


def saved(page):
    """The saved scenario, parsed."""
    return tomllib.loads(page.ask("return desk.scenario()"))


def typed(page, field, text):
    """Type into a field and press Enter; the value that the last event gives, and what is said at the field."""
    place = page.driver.find_element(By.ID, field)
    page.ask("arguments[0].closest('details')?.setAttribute('open', '')", place)
    page.ask("arguments[0].scrollIntoView({ block: 'center' })", place)
    place.send_keys(Keys.CONTROL, "a")
    place.send_keys(text or Keys.DELETE, Keys.ENTER)
    said = page.ask(
        "return document.getElementById(arguments[0].getAttribute('aria-describedby')).textContent",
        place,
    )
    return page.ask("return desk.live.done.filter((one) => one[4]).pop()?.[3] ?? null"), said


def test_a_craft_of_all_kinds_of_inputs_repeats_what_was_done(craft, craft_project):
    craft.ask(
        "const { live, act } = desk; live.reach(12); act('override', 'gear', 3); act('bias', 'wish', 0.1);"
        "live.reach(13.3); act('override', 'craft.engaged', false); act('override', 'craft.factor', 1.5);"
        "live.reach(15); act('reset', 'gear'); act('reset', 'craft.engaged'); live.reach(16); live.back(14);"
        "act('override', 'craft.push', 1e300); act('override', 'craft.push', 0.25); live.reach(20)"
    )
    worst, count = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
    assert count > 15
    assert worst < SAME
    assert craft.ask("return window.hacked ?? null") is None
    assert craft.errors() == []


def test_the_saved_netcdf_holds_the_run_with_names_units_and_kinds(
    craft, craft_project, tmp_path, monkeypatch
):
    craft.ask(
        "const { live, act } = desk; live.reach(12); act('override', 'gear', -2); live.reach(20)"
    )
    content = craft.ask(
        "return desk.netcdf().arrayBuffer().then((all) => btoa(String.fromCharCode(...new Uint8Array(all))))"
    )
    file = tmp_path / "result.nc"
    file.write_bytes(base64.b64decode(content))
    # The saved scenario goes on to the end of its last step's row.
    known = repeated(craft, craft_project / "scenarios").sel(time=slice(0, 20))
    # Another program's reader, and ours.
    with xr.open_dataset(file, engine="scipy", decode_times=False) as found:
        assert set(known) <= set(found)
        assert found.attrs["system"] == "craft"
        assert found.attrs["saved_scenario"] == craft.ask("return desk.scenario()")
        assert found["gear"].dtype == "int32" and found["craft.engaged"].dtype == bool
        np.testing.assert_array_equal(found["time"], known["time"])
    found = read_table(file)
    for name, signal in known.items():
        assert found[name].attrs == signal.attrs
        assert found[name].dtype == signal.dtype
        np.testing.assert_allclose(found[name], signal, rtol=SAME, atol=SAME)
    write_table(known, tmp_path / "known.nc")
    monkeypatch.chdir(tmp_path)
    compared = CliRunner().invoke(app, ["report", "result.nc", "known.nc", "--out", "compared"])
    assert compared.exit_code == 0, compared.output
    assert "are the same" in compared.output


def test_a_name_that_netcdf_does_not_have_is_kept_in_its_file(craft, tmp_path):
    content = craft.ask(
        "const one = { kind: 'Real', unit: '°', text: '', values: [1, 2.5] };"
        "const columns = ['time', 'a/b ⚓', ' x'].map((name) => ({ ...one, name }));"
        "return netcdfOf({}, columns).arrayBuffer().then((all) => btoa(String.fromCharCode(...new Uint8Array(all))))"
    )
    file = tmp_path / "odd.nc"
    file.write_bytes(base64.b64decode(content))
    table = read_table(file)
    assert list(table) == ["a/b ⚓", " x"]
    assert table[" x"].attrs["units"] == "°"
    assert table[" x"].values.tolist() == [1.0, 2.5]


def test_a_switch_that_begins_on_is_switched_off_and_on_again(craft):
    button = craft.driver.find_element(By.CSS_SELECTOR, '[aria-label="craft: engaged"]')
    assert button.get_attribute("aria-pressed") == "true"
    craft.ask("arguments[0].click()", button)
    assert button.get_attribute("aria-pressed") == "false"
    assert saved(craft)["events"][0]["override"] == {"craft.engaged": False}
    craft.ask("arguments[0].click()", button)
    assert button.get_attribute("aria-pressed") == "true"


@pytest.mark.parametrize("text", ["", "strong", "NaN", "1e400", "0x10", "1.000,5", "12 kn", "2000"])
def test_a_number_that_is_none_is_refused_in_words(craft, text):
    value, said = typed(craft, "input-craft.y_set", text)
    assert value is None
    assert "number" in said
    craft.ask("desk.live.reach(1); scene.grown(1); scene.go(1); document.activeElement.blur()")
    craft.wait("return scene.time === 1")
    assert craft.ask("return document.querySelectorAll('[aria-invalid=true]').length") == 1


def test_numbers_as_people_type_them(craft):
    assert typed(craft, "input-speed", "0,75") == (0.75, "")
    assert typed(craft, "input-speed", "−2") == (-2, "")
    assert typed(craft, "input-gear", "2.5") == (-2, "A whole number")
    assert typed(craft, "input-speed", "1e300") == (1e300, "")
    assert saved(craft)["events"][0]["override"] == {"speed": 1e300}


def test_a_start_value_is_typed_with_a_comma_and_a_whole_one_stays_whole(craft, craft_project):
    def start(name, text):
        craft.ask(
            "const choice = document.getElementById('start-name'); const field = document.getElementById('start-value');"
            "choice.value = [...choice.options].find((o) => o.textContent.startsWith(arguments[0])).value;"
            "choice.dispatchEvent(new Event('change')); field.value = arguments[1];"
            "document.getElementById('start-again').click()",
            name,
            text,
        )
        return craft.text("#start-wrong")

    assert "whole" in start("craft.seed", "1,5")
    assert start("craft.seed", "4") == ""
    assert start("craft.x_start", "12,5") == ""
    # The system gives this one no value: that of its FMU was taken.
    assert start("craft.factor", "3") == ""
    assert saved(craft)["set"] == {"craft.seed": 4, "craft.x_start": 12.5, "craft.factor": 3.0}
    craft.ask("desk.live.reach(5)")
    worst, _ = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
    assert worst < SAME


def test_what_is_done_in_a_pause_acts_in_the_saved_scenario(craft, craft_project):
    # 14.4 s is no row: the next step is the one of the row at 14.5 s.
    craft.ask("desk.live.reach(20); desk.live.back(14.4); desk.act('override', 'gear', 3)")
    scenario = saved(craft)
    assert scenario["events"][-1]["time"] == 14.5
    assert scenario["stop_time"] == 15.0
    assert repeated(craft, craft_project / "scenarios")["gear"].values[-1] == 3


def test_a_scenario_that_was_saved_before_keeps_its_description(craft):
    description = saved(craft)["description"]
    assert description.endswith("as it was run in the page")
    craft.ask("desk.live.about.scenario.description = arguments[0]", description)
    assert saved(craft)["description"] == description


def test_a_run_ends_before_its_rows_fill_the_memory_and_can_be_saved_then(craft):
    assert craft.ask("return desk.live.about.last_step") == 864_000  # a day
    craft.ask("desk.live.about.last_step = 150; scene.setSpeed(Infinity); scene.play()")
    craft.wait("return !scene.playing")
    assert "reached 15 s, the longest run" in craft.text("#failure")
    assert craft.ask("return desk.live.time.last") == 14.5
    assert saved(craft)["stop_time"] == 15.0
    rows = craft.ask("return desk.csv().text()").splitlines()
    assert len(rows) == 1 + 30
    assert rows[0].startswith("time [s],")
    craft.ask("desk.live.back(5); desk.live.reach(8)")
    assert craft.ask("return desk.live.time.last") == 8.0


def test_what_is_done_while_the_past_is_shown_brings_the_view_to_the_end(craft):
    craft.ask("desk.live.reach(20); scene.grown(20); scene.go(5); desk.act('override', 'speed', 1)")
    assert craft.ask("return scene.time") == 20


def test_the_forecast_begins_with_what_was_done_in_a_pause(craft):
    craft.ask("desk.live.reach(20); scene.grown(20); scene.go(20)")
    craft.wait("return desk.losses.time === 20")
    before = craft.ask("return desk.losses.answers[0].distance")
    craft.ask("desk.act('override', 'craft.x_set', 500)")
    craft.wait(f"return Math.abs(desk.losses.answers[0].distance - {before}) > 100")
    craft.ask("desk.live.back(0)")
    craft.wait("return desk.losses.time === 0")


def test_a_future_is_played_in_the_chart_by_a_click(craft):
    craft.ask("desk.live.reach(20); scene.grown(20); scene.go(20)")
    craft.wait("return desk.losses.time === 20")
    button = craft.driver.find_element(By.CSS_SELECTOR, "#losses button")
    craft.ask("arguments[0].click()", button)
    future = "scene.drawn.find((one) => one.what === 'future')"
    craft.wait(f"return {future}?.at > 0")
    assert craft.ask(f"return {future}.at") < 239
    craft.wait(f"return {future}.at === 239")
    assert len(craft.ask(f"return {future}.places")) == 240
    craft.ask("arguments[0].click()", button)
    craft.wait("return !scene.drawn.some((one) => one.what === 'future')")


def test_alarms_come_at_their_time_and_are_acknowledged_once(craft):
    craft.ask(
        "desk.live.reach(12); desk.act('override', 'gear', 3); desk.live.reach(15); scene.grown(15); scene.go(15)"
    )
    craft.wait("return document.querySelectorAll('#alarm-list li').length === 1")
    assert "shaft faulty (the shaft <i>slips</i>)" in craft.text("#alarm-list")
    # The entry stays the same element while the run goes on: a slow press reaches it.
    craft.ask("window.entry = document.querySelector('#alarm-list button'); scene.play()")
    craft.wait("return scene.time > 15.5")
    assert craft.ask("return entry.isConnected")
    craft.ask("entry.click(); scene.pause(); desk.live.back(14); scene.grown(14); scene.go(14)")
    craft.wait(
        "return scene.time === 14 && document.querySelectorAll('#alarm-list li').length === 1"
    )
    assert craft.ask("return document.querySelectorAll('#alarm-list button').length") == 0


def test_panels_show_references_and_power(craft):
    assert "position 1\tused" in craft.text("#status")
    craft.ask(
        "desk.act('override', 'craft.y_set', 1000); desk.live.reach(2); scene.grown(2); scene.go(2)"
    )
    craft.wait("return document.getElementById('status').innerText.includes('lost')")
    assert "bus a\t1 kW" in craft.text("#status")


def test_arrow_keys_move_the_set_point_and_turn_it(craft, craft_project):
    craft.ask("document.getElementById('scene-chart').focus()")
    keys = ActionChains(craft.driver).send_keys(Keys.ARROW_UP * 3, Keys.ARROW_LEFT)
    keys.key_down(Keys.SHIFT).send_keys(Keys.ARROW_RIGHT * 2).key_up(Keys.SHIFT).perform()
    said = "3.0 m north, -1.0 m east, heading 10.0°."
    craft.wait(f"return document.querySelector('#aim output').textContent === '{said}'")
    events = saved(craft)["events"]
    assert [event["override"] for event in events[:2]] == [
        {"craft.x_set": 3.0},
        {"craft.y_set": -1.0},
    ]
    assert events[2]["override"]["craft.psi_set"] == pytest.approx(0.17453, rel=1e-4)
    craft.ask("desk.live.reach(20)")
    worst, _ = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
    assert worst < SAME


def test_out_is_a_folder_or_the_file_itself(craft_project, tmp_path, monkeypatch):
    monkeypatch.chdir(craft_project)
    for out in (tmp_path / "new" / "ship.html", tmp_path / "folder"):
        found = CliRunner().invoke(app, ["export", "page", "scenarios/odd.toml", "--out", str(out)])
        assert found.exit_code == 0, found.output
    assert (tmp_path / "new" / "ship.html").is_file()
    assert (tmp_path / "folder" / "odd.html").is_file()


def test_a_page_starts_again_with_another_component(craft_project, browse, monkeypatch):
    monkeypatch.chdir(craft_project)
    file = craft_project / "late_pilot.py"
    file.write_text(PILOT.replace("0.05", "0.02").replace("class Pilot", "class LatePilot"))
    fmu = str(build_fmu(file, craft_project))
    made = ["export", "page", "scenarios/odd.toml", "--swap", f"pilot={fmu}", "--out", "swap.html"]
    found = CliRunner().invoke(app, made)
    assert found.exit_code == 0, found.output
    craft = browse(craft_project / "swap.html")
    assert "pilot: late_pilot" in craft.text("#systems")
    for chosen, components in ((0, None), (1, {"pilot": fmu})):
        craft.ask(f"document.getElementById('systems').value = {chosen}; window.old = true")
        craft.ask("document.getElementById('systems-start').click()")
        craft.wait("return Boolean(!window.old && window.desk && window.scene)")
        craft.ask("desk.act('override', 'wish', 1); desk.live.reach(20)")
        assert saved(craft).get("components") == components
        worst, count = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
        assert count > 15
        assert worst < SAME
    assert craft.ask("return document.getElementById('systems').value") == "1"
    wrong = CliRunner().invoke(app, ["export", "page", "scenarios/odd.toml", "--swap", "pilot"])
    assert wrong.exit_code == 2
    assert "--swap" in wrong.output and "'pilot' swaps nothing" in wrong.output
    assert craft.errors() == []


RINGS = '''
import os
import signal

from shipcosim.fmi import Fmu, Output

if os.environ.get("RINGS"):
    signal.raise_signal(signal.SIGINT)


class Bell(Fmu):
    """Where it is loaded Ctrl-C comes."""

    sound = Output("1", "loudness")

    def step(self, t, h):
        self.sound += h
'''


def test_ctrl_c_while_a_page_loads_an_fmu_is_none_of_the_fmus_errors(tmp_path, monkeypatch):
    (tmp_path / "bell.py").write_text(RINGS)
    system = block_of(build_fmu(tmp_path / "bell.py", tmp_path))
    monkeypatch.setenv("RINGS", "1")
    with pytest.raises(KeyboardInterrupt):
        live_page(system, Scenario(description="bell", stop_time=1.0, step_size=0.1))


def test_tunable_parameters_are_knobs(craft):
    assert typed(craft, "input-craft.factor", "3") == (3, "")


def test_a_browser_without_webassembly_gets_a_sentence(craft, browse, craft_project):
    script = {"source": "delete window.WebAssembly"}
    found = craft.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", script)
    try:
        craft.driver.get((craft_project / "craft.html").as_uri())
        craft.wait("return document.body.innerText.includes('WebAssembly')")
    finally:
        craft.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", found)


def test_the_time_line_marks_what_was_done(craft):
    craft.ask("desk.live.reach(20); scene.grown(20); scene.go(20); desk.act('override', 'gear', 3)")
    marks = "return [...document.querySelectorAll('#scene-marks line')].map((line) => parseFloat(line.getAttribute('x1')))"
    craft.wait(f"{marks}.length >= 4")
    assert craft.ask(marks)[:4] == pytest.approx([10.0, 25.5, 35.0, 45.0])


def test_thousands_of_changes_by_a_joystick_hold_up_no_frame(craft):
    craft.ask(
        "for (let k = 0; k < 3000; k++) {"
        " desk.act('override', 'craft.x_set', Math.sin(k)); desk.live.reach(desk.live.end + 0.5); }"
        "scene.grown(desk.live.end); scene.go(desk.live.end)"
    )
    marks = "return document.querySelectorAll('#scene-marks line').length"
    craft.wait(f"{marks} > 500")
    assert craft.ask(marks) <= 1001
    # The last change of each signal is found once, and not by every field.
    craft.ask(
        "const before = Array.prototype.filter; window.looked = 0;"
        "Array.prototype.filter = function (...given) { looked += this.length; return before.apply(this, given); };"
        "scene.paint(); Array.prototype.filter = before"
    )
    assert craft.ask("return looked") < 5 * 3000


def test_a_finger_drags_the_set_point_and_not_the_page(craft):
    send = craft.driver.execute_cdp_cmd
    send("Emulation.setTouchEmulationEnabled", {"enabled": True})
    try:
        craft.ask(
            "desk.act('override', 'craft.x_set', 100); desk.live.reach(2); scene.grown(2); scene.go(2); scene.follow(true)"
        )
        craft.wait("return scene.drawn.find((one) => one.what === 'set point').north === 100")
        x, y, far = craft.ask(
            "const chart = document.getElementById('scene-chart'); chart.scrollIntoView({ block: 'center' });"
            "const { left, top } = chart.getBoundingClientRect();"
            "const { north, east } = scene.drawn.find((one) => one.what === 'set point');"
            "const [x, y] = scene.pixel(east, north), [, further] = scene.pixel(east, north - 1);"
            "return [left + x, top + y, further - y]"
        )
        for kind, share in [("Start", 0.0), *(("Move", k / 8) for k in range(1, 9)), ("End", None)]:
            points = [] if share is None else [{"x": x, "y": y + share * far}]
            send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points})
    finally:
        send("Emulation.setTouchEmulationEnabled", {"enabled": False})
    assert saved(craft)["events"][-2]["override"]["craft.x_set"] == pytest.approx(99.0, abs=0.1)


def test_keys_go_through_all_speeds_and_back(craft):
    ActionChains(craft.driver).send_keys("+" * 9).perform()
    assert craft.ask("return document.getElementById('scene-speed').value") == "Infinity"
    ActionChains(craft.driver).send_keys("-").perform()
    assert craft.ask("return scene.speed") == 64


def test_the_page_says_that_the_past_is_shown_and_goes_on_from_there(craft):
    craft.ask("desk.live.reach(90); scene.grown(90); scene.go(90)")
    craft.wait("return document.querySelector('#past').textContent === ''")
    craft.ask(
        "[...document.querySelectorAll('button')].find(b => b.textContent === '−60 s').click()"
    )
    craft.wait(
        "return document.querySelector('#past').textContent.includes('Shown is 30.0 s of 90.0 s')"
    )
    craft.ask(
        "[...document.querySelectorAll('button')].find(b => b.textContent === 'Continue from here').click()"
    )
    craft.wait(
        "return desk.live.time.last === 30 && document.querySelector('#past').textContent === ''"
    )


def test_alarms_are_told_in_words_for_the_time_that_is_shown(craft):
    craft.ask(
        "desk.live.reach(12); desk.act('override', 'gear', 3); desk.live.reach(15); scene.grown(15); scene.go(15)"
    )
    craft.wait("return document.querySelector('#alarms strong').textContent === '1 alarm'")
    assert "shaft faulty" in craft.text("#alarms p")
    height = "return document.querySelector('#alarms').getBoundingClientRect().height"
    loud = craft.ask(height)
    craft.ask("scene.go(5)")
    craft.wait("return document.querySelector('#alarms strong').textContent === 'No alarm'")
    assert craft.text("#alarms p") == "1 to acknowledge"
    # What stands below stays where it is, so that no click meets another field.
    assert craft.ask(height) == loud
    craft.ask("document.querySelector('#alarm-list button').click(); scene.refresh()")
    assert "acknowledged" in craft.text("#alarm-list")


def test_keys_go_through_time_after_a_button_and_a_list(craft):
    craft.ask("desk.live.reach(60); scene.grown(60); scene.go(60)")
    for place in ("#scene-speed", "#acknowledge-all", "#scene-play"):
        before = craft.ask(
            f"const at = document.querySelector('{place}'); at.hidden = false; at.focus(); return scene.time"
        )
        craft.ask(
            "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true}))"
        )
        assert craft.ask("return scene.time") < before
