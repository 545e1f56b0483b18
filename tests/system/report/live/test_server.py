"""A system that no page can run: a server steps it, one page steers, and nobody else gets anything."""

import http.client
import json
import re
import shutil
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress
from types import SimpleNamespace

import c_fmus
import numpy as np
import pytest
from report.live.test_live import SAME, largest_difference, repeated
from report.run.test_instruments import instruments
from typer.testing import CliRunner
from websockets.sync.client import connect

from shipcosim.cli.app import app
from shipcosim.live import LiveRun, LiveServer
from shipcosim.live.server import TAKE_OVER
from shipcosim.report.live import prepared, server_page
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system

PILOT = """
#define NX 0
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) { m->r[2] = m->r[1] > 100.0 ? NAN : 0.05 * (m->r[1] - m->r[0]); }
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = (
    ("psi", 0, "input", "Real", 0.0),
    ("wanted", 1, "input", "Real", 0.0),
    ("turn", 2, "output", "Real", None),
)


@contextmanager
def serving(project):
    """A server of a project's craft, as an object with its address and what the terminal shows."""
    system = read_system(project / "ssp" / "craft")
    scenario = read_scenario(project / "scenarios" / "odd.toml")
    shown = []
    with LiveServer(server_page(system, scenario)) as server:
        run = LiveRun(*prepared(system, scenario), server, shown.append)

        def work():
            with suppress(KeyboardInterrupt):
                run.run()

        def stop():
            raise KeyboardInterrupt

        thread = threading.Thread(target=work)
        thread.start()
        try:
            yield SimpleNamespace(url=server.url, shown=shown, as_uri=lambda: server.url)
        finally:
            run._check_interrupt = stop
            thread.join()


@pytest.fixture
def served(craft_project, monkeypatch):
    """The craft, all of whose components give their states, at a server."""
    monkeypatch.chdir(craft_project)
    with serving(craft_project) as server:
        yield server


@pytest.fixture(scope="module")
def foreign_project(craft_project, tmp_path_factory):
    """The craft with a pilot in C, which gives no state, and fails where too much is wanted."""
    if c_fmus.compiler() is None:
        pytest.skip("needs a C compiler")
    folder = tmp_path_factory.mktemp("foreign")
    text = c_fmus.describe("pilot", "2.0", VARIABLES, forms=("CoSimulation",))
    fmu = c_fmus.build(folder, "pilot", "2.0", PILOT, text)
    project = folder / "project"
    shutil.copytree(craft_project, project)
    shutil.copy(fmu, project / "ssp" / "craft" / "resources" / "pilot.fmu")
    return project


def opened(browse, server):
    """The page of a server in the browser."""
    page = browse(server)
    page.wait("return Boolean(window.desk && window.scene)")
    return page


def reach(page, t):
    """Have the page ask for the rows until a time, and wait for them."""
    page.ask(f"desk.live.reach({t})")
    page.wait(f"return desk.live.end >= {t} || desk.live.stopped")


def test_what_is_done_at_a_server_is_repeated_by_the_saved_scenario(served, browse, craft_project):
    craft = opened(browse, served)
    reach(craft, 12)
    craft.ask("desk.act('override', 'gear', 3); desk.act('bias', 'wish', 0.1)")
    reach(craft, 13.3)
    craft.ask(
        "desk.act('override', 'craft.engaged', false); desk.act('override', 'craft.factor', 1.5)"
    )
    reach(craft, 15)
    craft.ask("desk.act('reset', 'gear'); desk.act('reset', 'craft.engaged')")
    reach(craft, 18)
    # What came after the time to which it goes back is forgotten, also by the server.
    # A click is not lost while the server goes back.
    craft.ask("desk.live.back(14); desk.act('override', 'craft.y_set', 2)")
    craft.wait("return desk.live.end === 14")
    assert craft.ask("return desk.live.held('craft.y_set')[3]") == 2
    craft.ask("desk.act('override', 'craft.push', 1e300); desk.act('override', 'craft.push', 0.25)")
    reach(craft, 20)
    table = repeated(craft, craft_project / "scenarios")
    worst, count = largest_difference(craft, table)
    assert count > 15
    assert worst < SAME
    # Its instruments are drawn under the server's content security policy, too.
    craft.ask("scene.go(desk.live.end); scene.paint()")
    heading = np.degrees(craft.ask("return desk.live.value('craft.psi')")) % 360
    assert instruments(craft)["compass"]["heading"] == pytest.approx(heading, abs=0.06)
    assert craft.errors() == []
    # Other start values start another run.
    seed = "desk.live.about.starts.find(([, name]) => name === 'craft.seed')[0]"
    craft.ask(f"desk.live.reset({{ [{seed}]: 4 }})")
    craft.wait("return desk.live.end === 0 && desk.live.done.every((one) => !one[4])")
    reach(craft, 10)
    table = repeated(craft, craft_project / "scenarios")
    assert json.loads(table.attrs["start_values"])["craft.seed"] == 4
    worst, _ = largest_difference(craft, table)
    assert worst < SAME
    craft.wait("return desk.losses.time === desk.live.end")


def test_a_page_runs_pauses_and_is_loaded_again_where_it_was(served, browse):
    craft = opened(browse, served)
    craft.ask("document.getElementById('scene-play').click()")
    craft.wait("return scene.time > 1")
    craft.ask("document.querySelector('[aria-label=\"craft: engaged\"]').click()")
    craft.wait("return scene.time > 2 && desk.live.value('craft.engaged') === 0")
    craft.ask("document.getElementById('scene-play').click()")
    reached = craft.ask("return desk.live.end")
    craft = opened(browse, served)
    assert craft.ask("return desk.live.end") >= reached
    assert craft.ask("return desk.live.held('craft.engaged')")[1] == "override"
    assert any("closed at t = " in text and "pauses" in text for text in served.shown)


def test_the_forecast_of_a_server_equals_a_run_with_that_loss(served, browse):
    craft = opened(browse, served)
    reach(craft, 5)
    craft.wait("return desk.losses.time === desk.live.end")
    step = craft.ask("return desk.live.now()")
    # Without a loss it is what the run does then, with what the scenario does at 7 and 9 s.
    craft.ask(
        "addEventListener('live-forecast', ({ detail }) => { window.healthy = detail.answers[0].rows; });"
        "desk.live.engine.forecast({ steps: 100, watched: ['craft.x'], losses: [[]] })"
    )
    craft.wait("return window.healthy?.length === 20")
    reach(craft, 17)
    after = np.arange(craft.ask("return desk.live.time.length")) * 5 >= step
    x = np.array(craft.ask("return [...desk.live.raw.get('craft.x').values]"))[after][:20]
    np.testing.assert_allclose(np.ravel(craft.ask("return healthy")), x)
    # With one, and with what is done in the pause before it.
    craft.ask("desk.act('override', 'craft.x_set', 30); desk.act('override', 'wish', 1.5)")
    craft.wait(
        "return desk.losses.time === desk.live.end && desk.losses.answers[0]?.track.at(-1) > 1"
    )
    answer = craft.ask("return JSON.parse(JSON.stringify(desk.losses.answers[0]))")
    assert answer["name"] == "craft"
    step = craft.ask("return desk.live.now()")
    craft.ask("desk.act('override', 'craft.failed', true)")
    reach(craft, 140)
    names = ("x", "y", "psi", "x_set", "y_set")
    after = np.arange(craft.ask("return desk.live.time.length")) * 5 >= step
    x, y, psi, x_set, y_set = (
        np.array(craft.ask("return [...desk.live.raw.get(arguments[0]).values]", f"craft.{name}"))[
            after
        ][:240]
        for name in names
    )
    assert answer["distance"] == pytest.approx(np.hypot(x - x_set, y - y_set).max(), rel=1e-9)
    assert np.ptp(psi) > 0.1
    np.testing.assert_allclose(np.reshape(answer["track"], (-1, 3)), np.transpose([x, y, psi]))
    # What was changed on the way belongs to the run alone.
    craft.wait(
        "return document.querySelector('#losses tbody').innerText.includes('is lost already')"
    )
    assert craft.errors() == []


def test_a_foreign_fmu_that_fails_is_named_and_its_run_is_saved(
    foreign_project, browse, monkeypatch
):
    monkeypatch.chdir(foreign_project)
    with serving(foreign_project) as server:
        craft = opened(browse, server)
        reach(craft, 12)
        back = "[...document.querySelectorAll('button')].find((b) => b.textContent === 'Continue from here')"
        assert craft.ask(f"return {back}.disabled")
        assert "pilot.fmu cannot store its state" in craft.ask(f"return {back}.title")
        assert "Not possible here" in craft.text("#losses-said")
        craft.ask("desk.act('override', 'wish', 200)")
        reach(craft, 15)
        craft.wait("return desk.live.stopped")
        assert "pilot.turn: is nan at t = 13.5 s. Every" in craft.text("#failure")
        rows = craft.ask("return desk.live.time.length")
        assert rows >= 25
        assert '"wish" = 200' in craft.ask("return desk.scenario()")
        # Where there is no way back there is a new start.
        craft.ask("desk.live.reset(); desk.changed()")
        craft.wait("return desk.live.end === 0 && !desk.live.stopped")
        reach(craft, 5)
        worst, _ = largest_difference(craft, repeated(craft, foreign_project / "scenarios"))
        assert worst < SAME


def test_a_run_at_a_server_ends_in_words(craft_project, monkeypatch):
    monkeypatch.chdir(craft_project)
    monkeypatch.setattr("shipcosim.cosim.interactive.MOST_STEPS", 150)
    with serving(craft_project) as server, socket(server) as first:
        told(first, "run")
        first.send(advance(200))
        assert "it has reached 15 s" in told(first, "failed")["failed"]


def test_a_page_whose_server_has_gone_keeps_what_was_done(craft_project, browse, monkeypatch):
    monkeypatch.chdir(craft_project)
    with serving(craft_project) as server:
        craft = opened(browse, server)
        reach(craft, 12)
    craft.wait("return desk.live.stopped")
    said = craft.text("#failure")
    assert said.endswith("refuses this page. Save what was done so far.")
    worst, _ = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
    assert worst < SAME


def test_a_second_page_shows_the_run_and_changes_nothing(served, browse):
    with socket(served) as first:
        assert told(first, "steers")["steers"] is True
        craft = opened(browse, served)
        assert craft.ask("return document.getElementById('scene-play').disabled")
        assert "Another page steers" in craft.text("#server")
        craft.ask("desk.act('override', 'gear', 3); desk.live.reach(30)")
        first.send(advance(101, [50, "override", "gear", 2]))
        craft.wait("return scene.time === 10 && desk.live.value('gear') === 2")
        assert craft.ask("return desk.live.held('gear')[3]") == 2
    craft.wait("return document.getElementById('server').textContent.includes('pauses')")


def test_a_second_page_takes_over_without_a_reload_once_nobody_steers(
    served, browse, craft_project
):
    with socket(served) as first:
        told(first, "run")
        craft = opened(browse, served)
        first.send(advance(101, [50, "override", "gear", 2]))
        craft.wait("return desk.live.end === 10")
        take_over = "document.querySelector('#server button')"
        assert not craft.ask(f"return {take_over}")
    craft.wait(f"return {take_over}")
    with socket(served) as third:
        # Another page was faster: this one reads on.
        assert told(third, "steers")["steers"] is True
        craft.wait("return document.getElementById('server').textContent.includes('Another page')")
        assert not craft.ask(f"return {take_over}")
        third.send(advance(121))
        craft.wait("return desk.live.end === 12")
    craft.wait(f"return {take_over}")
    craft.ask(f"window.stays = true; {take_over}.click()")
    craft.wait("return !document.getElementById('scene-play').disabled")
    assert craft.ask("return document.getElementById('server').hidden && stays")
    assert not craft.ask("return document.getElementById('inputs').inert")
    # It steers: what it does and what was done before it stand in its scenario.
    with socket(served) as reader:
        assert told(reader, "steers")["steers"] is False
        craft.ask("desk.act('override', 'gear', 3)")
        reach(craft, 15)
        assert told(reader, "acted")["acted"] == [[121, "override", "gear", 3]]
    worst, count = largest_difference(craft, repeated(craft, craft_project / "scenarios"))
    assert count > 15
    assert worst < SAME
    craft.ask("scene.go(10)")
    back = "[...document.querySelectorAll('button')].find((b) => b.textContent === 'Continue from here')"
    craft.wait(f"return !{back}.disabled")
    assert craft.errors() == []


# ---- who may do what, without a browser


def socket(server, **changed):
    """A connection as our page makes it, but for what is changed."""
    origin = server.url[: server.url.index("/", 8)]
    options = {"origin": origin, "max_size": None, "legacy": True, **changed}
    return connect(changed.pop("uri", server.url.replace("http", "ws")), **options)


def told(connection, key):
    """The next message with a key, whatever comes before it."""
    while True:
        message = connection.recv(timeout=30.0)
        if isinstance(message, str) and key in (found := json.loads(message)):
            return found


def step_of(connection):
    """Steps done, as the next rows tell."""
    while isinstance(message := connection.recv(timeout=30.0), str):
        pass
    return int(np.frombuffer(message[:8])[0])


def advance(to, *changes):
    return json.dumps({"do": "advance", "to": to, "changes": changes})


def forecast(losses=((("override", "craft.failed", True),),), steps=100, watched=("craft.x",)):
    return json.dumps({"do": "forecast", "losses": losses, "steps": steps, "watched": watched})


def test_a_forecast_leaves_the_run_alone_and_all_pages_get_it(served):
    with socket(served) as first, socket(served) as second:
        told(first, "run")
        told(second, "run")
        second.send(forecast())  # in vain
        first.send(advance(31))
        first.send(forecast(losses=[[], [["override", "speed", 4.0]]]))
        first.send(advance(41))
        one, other = (told(page, "forecast")["forecast"] for page in (first, second))
        assert one == other
        assert one["step"] == 31
        healthy, faster = (np.ravel(answer["rows"]) for answer in one["answers"])
        assert len(healthy) == 20
        assert not np.allclose(healthy, faster)
        first.send(advance(131))
        rows = greeting_rows(served, 131)
        page = np.frombuffer(rows)
        n, columns = int(page[1]), len(page[2:]) // int(page[1])
        assert n == 27 and columns > 10
        # A page that goes back meanwhile gets its answer, too.
        first.send(advance(200_000))
        first.send(forecast())
        first.send(json.dumps({"do": "back", "to": 51}))
        assert told(first, "forecast")["forecast"]["step"] < 200_000
    with socket(served) as third:
        assert told(third, "run")["run"]["done"] == []


def test_one_page_steers_and_the_others_read(served):
    first = socket(served)
    assert told(first, "steers")["steers"] is True
    second = socket(served)
    assert told(second, "steers")["steers"] is False
    assert step_of(second) == 1
    second.send(advance(100, [1, "override", "gear", 3]))
    first.send(advance(26, [11, "override", "gear", 2]))
    assert told(second, "acted")["acted"] == [[11, "override", "gear", 2]]
    while (step := step_of(second)) < 21:
        pass
    assert step <= 26
    # The run pauses once the first has left; the next one to come steers.
    first.close()
    assert told(second, "left")
    third = socket(served)
    assert told(third, "steers")["steers"] is True
    assert told(second, "taken")
    # Who asks for it now, asks in vain.
    second.send(TAKE_OVER)
    run = told(third, "run")["run"]
    assert run["done"] == [[11, "override", "gear", 2]]
    assert run["step"] == 26
    second.send(advance(50))
    third.send(advance(31))
    while (step := step_of(third)) < 31:
        pass
    assert step == 31
    third.close()
    assert told(second, "left")
    second.send(TAKE_OVER)
    assert told(second, "steers")["steers"] is True
    second.close()


def greeting_rows(server, step):
    """All rows once a step has been reached, as another page gets them."""
    while True:
        with socket(server) as page:
            told(page, "run")
            if np.frombuffer((rows := page.recv(timeout=30.0))[:8])[0] >= step:
                return rows


@pytest.mark.parametrize("has_compiler", [True, False])
def test_a_run_that_goes_back_repeats_itself_to_the_bit(craft_project, monkeypatch, has_compiler):
    monkeypatch.chdir(craft_project)
    monkeypatch.setattr("shipcosim.cosim.master.compiled.is_installed", lambda: has_compiler)
    with serving(craft_project) as server, socket(server) as first:
        told(first, "run")
        change = [151, "override", "gear", 3]
        first.send(advance(201, [21, "bias", "speed", 0.5], change))
        before = greeting_rows(server, 201)
        first.send(json.dumps({"do": "back", "to": 101}))
        assert told(first, "run")["run"]["done"] == [[21, "bias", "speed", 0.5]]
        first.send(advance(201, change))
        assert greeting_rows(server, 201) == before


def test_the_command_starts_a_server_where_no_page_can_run_the_system(foreign_project, monkeypatch):
    monkeypatch.chdir(foreign_project)

    def interrupted(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(LiveRun, "run", interrupted)
    found = CliRunner().invoke(app, ["live", "scenarios/odd.toml", "--no-open"])
    assert found.exit_code == 0
    assert "pilot" in found.output and "has no native code" in found.output
    assert re.search(r"http://127\.0\.0\.1:\d+/[\w-]{32}/", found.output)
    assert not (foreign_project / "results").exists()


def test_no_server_takes_the_place_of_a_page_with_swaps(
    craft_project, foreign_project, monkeypatch
):
    monkeypatch.chdir(craft_project)
    fmu = foreign_project / "ssp" / "craft" / "resources" / "pilot.fmu"
    given = ["live", "scenarios/odd.toml", "--no-open", "--swap", f"pilot={fmu}"]
    found = CliRunner().invoke(app, given)
    assert found.exit_code == 2
    assert "pilot" in found.output and "has no native code" in found.output


@pytest.mark.parametrize(
    "asked",
    [
        "{",
        "[]",
        '{"do": "back", "to": "x"}',
        forecast(watched=["nothing"]),
        forecast(steps=1_000_000),
        forecast(losses=[[["override", "nothing", True]]]),
        forecast(losses=[[]] * 1000),
        '{"do": "start", "values": {"craft.nothing": 1}}',
        '{"do": "start", "values": {"craft.seed": NaN}}',
        advance(50, [20, "override", "nothing", 1]),
        advance(50, [20, "explode", "gear", 1]),
        advance(50, [20, "override", "gear", 1e300]),
        advance(50, [0, "override", "gear", 1]),
        advance(50, [20, "override", "gear", None]),
        advance(50, [20, "override", "speed", "3"]),
        advance(50, [20, "override", "gear", 2.5]),
        advance(50, [20, "override", "craft.engaged", 5]),
        advance(50, [20, "override", "craft.engaged", 0.3]),
    ],
)
def test_what_our_page_never_asks_for_closes_the_connection_and_not_the_server(served, asked):
    with socket(served) as first:
        told(first, "run")
        first.send(asked)
        with pytest.raises(Exception, match="1008"):
            while True:
                first.recv(timeout=30.0)
    with socket(served) as second:
        assert told(second, "run")["run"]["step"] == 1


def answer(server, path=None, method="GET", **headers):
    """Status and body of a request; None drops a header."""
    host, _, rest = server.url.removeprefix("http://").partition("/")
    connection = http.client.HTTPConnection(host, timeout=30.0)
    connection.putrequest(method, f"/{rest}" if path is None else path, skip_host=True)
    for name, value in {"Host": host, **headers}.items():
        connection.putheader(name.replace("_", "-"), value)
    connection.endheaders()
    found = connection.getresponse()
    return found.status, found.read(), found.headers


def test_the_page_is_there_for_its_address_alone(served):
    status, body, headers = answer(served)
    assert status == 200 and b"<title>" in body
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert served.url.startswith("http://127.0.0.1:")
    port = served.url.split(":")[2].split("/")[0]
    refused = [
        answer(served, "/"),
        answer(served, "/wrong/"),
        answer(served, served.url.split("/", 3)[3][:-3]),
        answer(served, Host="evil.example"),
        answer(served, Host=f"evil.example:{port}"),
        answer(served, Origin="http://evil.example"),
        answer(served, Sec_Fetch_Site="cross-site"),
    ]
    assert {status for status, *_ in refused} == {403}
    assert {body for _, body, _ in refused} == {b"Forbidden\n"}


@pytest.mark.parametrize("origin", [None, "null", "http://evil.example", "http://localhost:1"])
def test_a_socket_from_another_origin_is_refused(served, origin):
    with pytest.raises(Exception, match="403"):
        socket(served, origin=origin)


def test_without_its_library_the_server_says_what_to_install():
    code = (
        "import sys; sys.modules['websockets'] = sys.modules['websockets.asyncio.server'] = None\n"
        "import shipcosim.live"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert "pip install 'shipcosim[live]'" in found.stderr
