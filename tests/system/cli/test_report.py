"""`shipcosim report A B`."""

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli.app import app
from shipcosim.series import write_table


@pytest.fixture
def results(tmp_path):
    """Folders of two runs that differ by 2 m."""
    time = np.linspace(0.0, 10.0, 21)
    for name, east in (("calm", 0.0), ("windy", 2.0)):
        signals = {
            "boat.x": (time, "m"),
            "boat.y": (0.0 * time + east, "m"),
            "boat.psi": (0.0 * time, "rad"),
        }
        columns = {k: ("time", v, {"units": u}) for k, (v, u) in signals.items()}
        table = xr.Dataset(columns, {"time": ("time", time, {"units": "s"})})
        (tmp_path / name).mkdir()
        write_table(table, tmp_path / name / "result.nc")
        write_table(table, tmp_path / name / "result.csv")
    return tmp_path


@pytest.mark.parametrize("file", ["", "result.nc", "result.csv"])
def test_folders_and_tables_make_a_page_that_says_how_they_differ(results, file):
    given = [str(results / name / file) for name in ("calm", "windy")]
    told = CliRunner().invoke(app, ["report", *given, "--out", str(results / "both")])
    assert told.exit_code == 0, told.output
    assert "2.00 m apart" in told.output and "boat.y: 2 m rms" in told.output
    page = (results / "both" / "report.html").read_text()
    assert "<h1>calm and windy</h1>" in page


def test_folder_without_results_is_said(results):
    (results / "empty").mkdir()
    told = CliRunner().invoke(
        app, ["report", str(results / "calm"), str(results / "empty"), "--out", str(results / "o")]
    )
    assert told.exit_code == 2 and "no result.nc in this folder" in told.output
    assert not (results / "o").exists()


def test_two_runs_in_a_notebook_are_what_the_command_says(results, monkeypatch):
    pytest.importorskip("matplotlib")
    both = shipcosim.report(results / "calm", results / "windy", out=results / "called")
    assert both.outcome.sentence.startswith("The ships lie up to 2.00 m apart")
    told = CliRunner().invoke(
        app, ["report", *(str(results / n) for n in ("calm", "windy")), "--out", str(results / "o")]
    )
    assert told.exit_code == 0 and both.outcome.sentence in told.output
    assert (results / "called/report.html").read_bytes() == (results / "o/report.html").read_bytes()
    assert both.to_pandas().loc["boat.y", "largest"] == pytest.approx(2.0)
    # Both runs are in one plot.
    svg = both.plot("boat.y").svg
    assert "calm: boat.y" in svg and "windy: boat.y" in svg
    assert "2.00" in both._repr_html_()
