"""From the command line: the page of a study, a run of it again by its number, and by a click."""

import base64
import gzip
import http.client
import json
import re
import threading

import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli import app
from shipcosim.report.study import server as served

SWEEP = ["sweep", "levels", "--engine", "fmpy", "--workers", "1"]


def data_of(page):
    """What a page draws."""
    (packed,) = re.findall(r'<script type="text/plain" id="data">([^<]*)</script>', page)
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def called(*arguments):
    return CliRunner().invoke(app, [*SWEEP, *arguments])


def test_command_leaves_the_page_which_names_the_command_for_a_row(project):
    assert called().exit_code == 0
    page = (project / "results/levels/report.html").read_text(encoding="utf-8")
    data = data_of(page)
    assert data["command"] == "shipcosim sweep levels --engine fmpy"
    assert {column["name"] for column in data["columns"]} == {"level", "seed", "highest", "held"}
    assert "12 runs" in page and data["pages"] == []


def test_python_shows_the_same_page_and_a_card(project):
    found = shipcosim.sweep("levels", out="out", engine="fmpy", workers=1)
    page = (project / "out/report.html").read_text(encoding="utf-8")
    assert found.page().html == page
    assert "12 runs" in repr(found)


def test_run_is_simulated_again_by_its_number_and_the_page_leads_to_it(project):
    whole = called("--out", "out")
    assert whole.exit_code == 0
    again = called("--out", "out", "--run", "7")
    assert again.exit_code == 0 and "run-7" in again.stdout
    page = (project / "out/run-7/report.html").read_text(encoding="utf-8")
    assert "run 7 of the study levels; level 2.0; seed 4" in page
    assert data_of((project / "out/report.html").read_text(encoding="utf-8"))["pages"] == [7]
    assert (
        called("--out", "out", "--run", "7").exit_code == 0
        and not (project / "out/run-7-1").exists()
    )


def test_run_that_misses_what_is_expected_ends_with_1_and_needs_no_study_before(project):
    missed = called("--out", "new", "--run", "11")
    assert missed.exit_code == 1 and (project / "new/run-11/report.html").is_file()
    assert not (project / "new/report.html").exists()


@pytest.mark.parametrize("number", ["12", "-1"])
def test_run_that_there_is_not_is_refused(project, number):
    refused = called("--out", "out", "--run", number)
    assert refused.exit_code == 2 and re.search(r"numbered from 0 to 11", refused.stderr)
    assert not (project / "out").exists()


def test_pages_of_runs_of_an_earlier_plan_are_kept_with_its_results(project):
    called("--out", "out")
    called("--out", "out", "--run", "0")
    study = project / "studies/levels.toml"
    study.write_text("stop_time = 1.0\n" + study.read_text())
    called("--out", "out")
    assert (project / "out-1/run-0/report.html").is_file() and not (project / "out/run-0").exists()


def test_a_click_simulates_a_row(project, monkeypatch):
    made, asked = [], []

    def one_click(server):
        made.append(server)
        thread = threading.Thread(target=click, args=(server,))
        thread.start()
        while thread.is_alive():
            server.handle_request()
        raise KeyboardInterrupt

    def click(server):
        for run in (3, 11):
            connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=600.0)
            connection.request("POST", f"/run/{run}", headers={"X-Shipcosim": "run"})
            answer = connection.getresponse()
            asked.append((answer.status, json.loads(answer.read())))

    monkeypatch.setattr(served.StudyServer, "serve_forever", one_click)
    monkeypatch.setattr(served.StudyServer, "timeout", 0.2)
    done = called("--out", "out", "--serve")
    assert done.exit_code == 0 and made[0].url in done.stdout
    assert asked == [(200, {"page": "run-3/report.html"}), (200, {"page": "run-11/report.html"})]
    assert (project / "out/run-11/report.html").is_file()


def test_port_that_is_taken_is_said(project):
    taken = served.ThreadingHTTPServer(("127.0.0.1", 0), served.BaseHTTPRequestHandler)
    refused = called("--out", "out", "--serve", "--port", str(taken.server_port))
    taken.server_close()
    assert refused.exit_code == 2 and "cannot be used" in refused.stderr
