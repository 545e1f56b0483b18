"""A craft that no file describes is learned from her log and her length: `diagnose --learn`."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import shipcosim as sc
from shipcosim.cli import app

LEARNED_UNTIL = 750.0  # s, of the example log; the rest is to be predicted


@pytest.fixture(scope="module")
def table():
    return sc.read_log("gunnerus_log").table


@pytest.fixture(scope="module")
def ran(table, tmp_path_factory):
    """The command on the first part of a log, with a length that is a third too long; its folder."""
    folder = tmp_path_factory.mktemp("learned")
    part = table.sel(time=slice(0.0, LEARNED_UNTIL))
    part.to_dataframe().to_csv(folder / "log.csv")
    given = [str(folder / "log.csv"), "--learn", "--length", "45 m", "--out", str(folder / "out")]
    return CliRunner().invoke(app, ["diagnose", *given]), folder / "out"


def test_a_craft_is_learned_and_her_numbers_are_shown(ran):
    result, folder = ran
    assert result.exit_code == 1, result.output
    assert "LEARNED" in result.stdout and "By the file" in result.stdout
    left = {file.name for file in folder.iterdir()}
    assert left >= {"craft.toml", "craft_open.ssp", "extended.ssp", "report.html"}
    found = json.loads((folder / "diagnosis.json").read_text())
    errors = found["craft"]["held_out"]
    assert found["verdict"] == "form" and not found["findings"]
    assert errors["after"] < 0.5 * errors["steady"] and errors["steady_ci95"][1] < 1.0


def test_what_was_learned_predicts_the_rest_of_the_log(ran, table):
    rest = table.sel(time=slice(LEARNED_UNTIL, None))
    found = sc.replay(rest, ran[1] / "extended.ssp", horizon=20.0)
    last = found.to_pandas()["position"].groupby("simulation").last()
    assert last["after"] < 0.5 * last["before"]


@pytest.fixture(scope="module")
def taught(table, tmp_path_factory):
    """The command on two parts of a log, with a length that is a third too long; its folder."""
    folder = tmp_path_factory.mktemp("taught")
    parts = {"a.csv": slice(0.0, 500.0), "b.csv": slice(500.0, 1000.0)}
    for name, part in parts.items():
        table.sel(time=part).to_dataframe().to_csv(folder / name)
    given = [*(str(folder / name) for name in parts), "--learn", "--length", "45 m"]
    return CliRunner().invoke(app, ["calibrate", *given, "--out", str(folder / "out")]), folder


def test_several_logs_teach_a_craft_that_no_file_describes(taught, table):
    result, folder = taught
    assert result.exit_code == 0, result.output
    assert "All numbers of the craft were assumed from her length or learned" in result.stdout
    left = {file.name for file in (folder / "out").iterdir()}
    assert left == {"craft.toml", "craft_open.ssp", "calibrated.ssv", "report.html"}
    rest = table.sel(time=slice(1000.0, None))
    found = sc.replay(
        rest,
        folder / "out/craft_open.ssp",
        parameters=[folder / "out/calibrated.ssv"],
        horizon=20.0,
    )
    last = found.to_pandas()["position"].groupby("simulation").last()
    assert last["after"] < last["before"]


def test_a_craft_at_rest_teaches_nothing(table):
    still = table.sel(time=slice(0.0, 400.0)).copy(deep=True)
    random = np.random.default_rng(3)
    for name in ("port_rpm", "starboard_rpm", "tunnel_rpm"):
        still[name].values[:] = 0.0
    for name in ("north", "east", "surge", "sway", "yaw_rate", "heading"):
        still[name].values[:] = 0.02 * random.standard_normal(still["time"].size)
    found = sc.diagnose(still, learn=True, length=34.0)
    assert found.verdict != "form" and found.craft is None and found.extension is None


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"learn": True}, "does not tell how long"),
        ({"length": 5.0}, "nothing is learned"),
        ({"learn": True, "length": 0.0}, "greater than 0"),
        ({"learn": True, "length": float("nan")}, "length"),
        ({"learn": True, "length": "5 kg"}, "length"),
        ({"learn": True, "length": 5.0, "system": "gunnerus_open"}, "known already"),
        ({"learn": True, "length": 5.0, "reference": "x"}, "known already"),
        ({"learn": True, "length": 5.0, "causes": "."}, "--effects.*known already"),
    ],
)
def test_what_does_not_go_together_is_refused(table, given, said):
    with pytest.raises(sc.ShipcosimError, match=said):
        sc.diagnose(table, **given)


def test_several_logs_are_refused(table):
    with pytest.raises(sc.ShipcosimError, match="several logs.*calibrate"):
        sc.diagnose([table, table], learn=True, length=34.0)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"learn": True}, "does not tell how long"),
        ({"length": 5.0}, "nothing is learned"),
        ({"learn": True, "length": 5.0, "system": "gunnerus_open"}, "known already"),
        ({"learn": True, "length": 5.0, "causes": "."}, "--effects.*known already"),
    ],
)
def test_what_does_not_go_together_is_refused_of_several_logs_too(table, given, said):
    with pytest.raises(sc.ShipcosimError, match=said):
        sc.calibrate([table, table], **given)


def test_several_logs_at_rest_teach_nothing(table):
    still = [table.sel(time=slice(0.0, end)).copy(deep=True) for end in (400.0, 500.0)]
    random = np.random.default_rng(3)
    for one in still:
        for name in ("port_rpm", "starboard_rpm", "tunnel_rpm"):
            one[name].values[:] = 0.0
        for name in ("north", "east", "surge", "sway", "yaw_rate", "heading"):
            one[name].values[:] = 0.02 * random.standard_normal(one["time"].size)
    with pytest.raises(sc.ShipcosimError, match="does not show what her thrusters did"):
        sc.calibrate(still, learn=True, length=34.0)


def test_a_log_without_thrusters_is_refused(table):
    bare = table[["north", "east", "heading", "surge", "sway", "yaw_rate"]]
    with pytest.raises(sc.ShipcosimError, match="no channel of a thruster"):
        sc.diagnose(bare, learn=True, length=34.0)
