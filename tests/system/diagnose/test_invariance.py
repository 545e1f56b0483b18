"""The same log told otherwise gets the same answer, turned accordingly; no truth is asked."""

import numpy as np
import pytest

from shipcosim.diagnose.log.reader import read_log
from trial import variants
from trial.runs import TOOL, outcome_of
from truth import draw

TURN = 50.0  # [deg]
LOGS = {"tow": 11, "azimuth_offset": 13}  # cause to draw: seed
MINUTES = 20


@pytest.fixture(scope="module")
def drawn():
    return {
        cause: draw("trial", seed, among=[cause], minutes=MINUTES).log
        for cause, seed in LOGS.items()
    }


@pytest.fixture(scope="module")
def answer(drawn, tmp_path_factory):
    """Function that has a variant of a log diagnosed, each once: verdict, findings by cause and component."""
    folder, known = tmp_path_factory.mktemp("logs"), {}

    def ask(cause, name="as it is", change=lambda log: log):
        if (cause, name) not in known:
            path = folder / f"{cause} {name}.csv"
            change(drawn[cause]).to_csv(path, index=False)
            outcome = outcome_of(str(path), TOOL)
            assert outcome["error"] is None, outcome["error"]
            known[cause, name] = outcome["diagnosis"]
        return known[cause, name]

    return ask


def agree(base, variant, turn, within):
    """The verdicts are the same, and every finding turned is found; values within so many standard deviations."""
    assert variant["verdict"] == base["verdict"] == "named"
    found = {(f["cause"], f["component"]): f["parameters"] for f in variant["findings"]}
    expected = [
        turn(
            f["cause"],
            f["component"],
            {name: value["estimate"] for name, value in f["parameters"].items()},
        )
        for f in base["findings"]
    ]
    assert set(found) == {(cause, component) for cause, component, _ in expected}
    for cause, component, values in expected:
        for name, value in values.items():
            entry = found[cause, component][name]
            assert entry["estimate"] == pytest.approx(value, abs=within * entry["std"]), (
                cause,
                component,
                name,
            )


def test_turning_the_earth_turns_a_force_over_ground(answer):
    turned = answer("tow", "turned", lambda log: variants.turned(log, TURN))
    agree(answer("tow"), turned, lambda *f: variants.turned_finding(*f, TURN), 0.5)


def tables_agree(one, other):
    assert set(one) == set(other)
    for name in one:
        difference = np.abs(one[name].to_numpy() - other[name].to_numpy())
        around = 360.0 if one[name].attrs.get("units") == "deg" else np.inf
        assert np.nanmax(np.minimum(difference, np.abs(around - difference))) < 1e-6, name
        assert (np.isnan(one[name].to_numpy()) == np.isnan(other[name].to_numpy())).all(), name


@pytest.fixture
def saved(drawn, tmp_path):
    """Log as it is read, and function that saves a table for reading."""

    def save(table, name="log.csv"):
        table.to_csv(tmp_path / name, index=False)
        return tmp_path / name

    log = drawn["tow"]
    return log, read_log(save(log, "as_it_is.csv")), save


def test_other_units_are_read_as_the_same_log(saved):
    log, expected, save = saved
    tables_agree(read_log(save(variants.with_other_units(log))), expected)


def test_a_loggers_own_names_and_signs_are_read_as_the_same_log(saved, tmp_path):
    log, expected, save = saved
    table, channels = variants.with_channel_file(log, tmp_path)
    tables_agree(read_log(save(table), channels), expected)


def test_positions_on_earth_are_read_as_the_same_track(saved):
    log, expected, save = saved
    found = read_log(save(variants.at_positions_on_earth(log)))
    for name in ("north", "east"):
        moved = found[name] - expected[name]
        assert float(moved.max() - moved.min()) < 0.01
