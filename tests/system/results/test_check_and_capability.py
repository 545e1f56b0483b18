"""`shipcosim.check` and `shipcosim.capability` say what the commands say; `out=` overwrites nothing silently."""

import json

import pytest
from typer.testing import CliRunner

import shipcosim as sc
from shipcosim import ShipcosimError
from shipcosim.cli import app


@pytest.fixture
def bad(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(
        'system = "gunnerus_dp"\nstop_time = -1.0\nstep_size = 0.05\n', encoding="utf-8"
    )
    return path


def test_a_check_tells_errors_by_file(bad):
    found = sc.check([bad, "gunnerus_log"])
    assert not found.passed and list(found.files) == [str(bad), "gunnerus_log"]
    assert [one.severity for one in found.files[str(bad)]] == ["error"] and "stop_time" in str(
        found.problems[0]
    )
    assert not any(one.severity == "error" for one in found.files["gunnerus_log"])
    assert "FAIL. 1 error" in repr(found) and "stop_time" in found._repr_html_()
    assert set(found.to_pandas()["file"]) >= {str(bad)}


def test_a_check_lists_the_variables_of_an_fmu():
    found = sc.check("vessel")
    rows = [row for rows in found.variables.values() for row in rows]
    assert found.passed and ("parameter", "Real", "kg") in {row[1:4] for row in rows}
    assert "Variables of" in found._repr_html_()


def test_what_is_not_there_is_one_error():
    with pytest.raises(ShipcosimError, match="nowhere"):
        sc.check("nowhere.toml")
    with pytest.raises(ShipcosimError, match="no keyword 'hots'"):
        sc.check("four_corner", hots=["ecos"])


@pytest.fixture(scope="module")
def capability():
    return sc.capability(failures=[("port", "tunnel")])


def test_a_capability_is_that_of_the_command(capability, tmp_path):
    given = ["capability", "--failure", "port,tunnel", "--json", "--out", str(tmp_path / "cap")]
    done = CliRunner().invoke(app, given, prog_name="shipcosim")
    assert json.loads(done.stdout) == json.loads(json.dumps(capability.as_json()))


def test_a_capability_shows_itself(capability):
    assert (
        capability.notation in repr(capability) and capability.notation in capability._repr_html_()
    )
    assert capability.to_pandas().shape[0] == capability.table.sizes["weather_from"] == 36
    assert "DP capability-L1" in capability.page().html


def test_results_of_calls_are_kept_unless_forced(capability, tmp_path, capsys):
    folder = tmp_path / "cap"
    capability.save(folder)
    (folder / "notes.txt").write_text("mine")
    (folder / "capability.csv").write_text("first")
    capability.save(folder)
    assert (tmp_path / "cap-1" / "capability.csv").read_text() == "first" and (
        folder / "notes.txt"
    ).exists()
    assert "force=True replaces them" in capsys.readouterr().err
    capability.save(folder, force=True)
    assert not (tmp_path / "cap-2").exists() and not capsys.readouterr().err


def test_out_of_a_run_keeps_the_earlier_one(tmp_path):
    for _ in range(2):
        sc.run("gust", stop_time=0.1, out=tmp_path / "gust")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["gust", "gust-1"]
    assert {one.name for one in (tmp_path / "gust").iterdir()} == {
        "result.nc",
        "result.csv",
        "report.html",
        "predictions.csv",
        "verdict.json",
    }
    sc.run("gust", stop_time=0.1, out=tmp_path / "gust", force=True)
    assert not (tmp_path / "gust-2").exists()


def test_a_folder_that_cannot_be_made_is_one_error(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ShipcosimError, match="is a file, not a folder.*another folder"):
        sc.run("gust", stop_time=0.1, out=tmp_path / "file" / "deep")
