"""Of a long log stretches are used, as if each were a log of its own; how much is used does not grow with the log."""

import numpy as np
import pytest
import xarray
from diagnose import twin

from shipcosim.diagnose.explanation.null_distribution import healthy_records
from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.ship import stretches
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.stretches import (
    MOST_ROWS,
    STRETCHES,
    in_stretches,
    rows_averaged,
    stretches_of,
)
from shipcosim.diagnose.validation.split import starts
from shipcosim.series import make_table

LENGTH = 33.9  # m


def table(rows, step=1.0, **channels):
    channels = channels or {"north": np.arange(rows, dtype=float)}
    return make_table(
        step * np.arange(rows), [(name, values, "m", "") for name, values in channels.items()]
    )


@pytest.mark.parametrize("step", [1.0, 0.1, 0.01])
def test_a_hundred_thousand_rows_or_more_give_no_more_than_a_diagnosis_takes(step):
    rows = round(100_000 / min(step, 0.1))
    used = in_stretches(table(rows, step), LENGTH)
    assert used.sizes["time"] <= MOST_ROWS * rows_averaged(LENGTH, step)
    parts = stretches_of(used["time"].values)
    assert len(parts) == STRETCHES or used.sizes["time"] == rows
    assert used["time"].values[[0, -1]] == pytest.approx([0.0, step * (rows - 1)])


def test_a_log_that_is_not_long_is_used_as_it_is():
    log = table(MOST_ROWS)
    assert in_stretches(log, LENGTH) is log


def test_rows_without_any_value_do_not_count():
    """Half the log is empty: stretches are spread over the other half, and long holes are left out."""
    values = np.where(np.arange(60_000) < 30_000, 1.0, np.nan)
    used = in_stretches(table(60_000, north=values), LENGTH)
    assert used["time"].values[-1] == 29_999.0 and np.isfinite(used["north"].values).all()
    values = np.where(np.arange(60_000) % 15_000 < 1_400, 1.0, np.nan)
    used = in_stretches(table(60_000, north=values), LENGTH)
    assert used.sizes["time"] == 5_600 and len(stretches_of(used["time"].values)) == 4


@pytest.fixture(scope="module")
def parted():
    """A log of 12 minutes of which two parts are used, and what it is without the hole."""
    log = twin.sailed({"loss": twin.PLANTED["thrust_loss"]}, minutes=12.0)["loss"]
    rows = np.r_[0:300, 420:721]
    return log, log.isel(time=rows)


def test_each_stretch_is_smoothed_on_its_own(parted):
    whole, log = parted
    record = record_of(log, twin.model(12.0))
    assert [(part.start, part.stop) for part in record.stretches] == [(0, 300), (300, 601)]
    alone = record_of(whole.isel(time=slice(420, 721)), twin.model(12.0))
    there, here = first_motion(alone), first_motion(record)
    np.testing.assert_allclose(
        np.stack(here)[[0, 1, 3, 4, 5], 300:], np.stack(there)[[0, 1, 3, 4, 5]], rtol=1e-9
    )
    assert any("2 stretches" in remark for remark in record.remarks)


def test_rows_are_averaged_within_a_stretch(parted):
    _, log = parted
    record = record_of(log.assign_coords(time=0.3 * log["time"]), twin.model())
    assert [part.stop for part in record.stretches] == [100, 200]
    assert record.measured[100, 0] == pytest.approx(log["north"].values[300:303].mean())


def test_nothing_is_predicted_or_sailed_across_a_hole(parted):
    whole, log = parted
    problem = identification_problem(log, twin.model(12.0), read_catalogue())
    ends = starts(problem.record) + 60
    assert ends.size and not np.any((ends - 60 < 300) & (ends >= 300))
    ships = healthy_records(problem, problem.motion, 5, np.random.default_rng(0))
    off = ships.measured[:, :, :2] - np.stack(problem.motion[:2], axis=-1)
    assert np.median(np.abs(off[:, 300:310])) < 2.0


def test_the_cause_is_found_in_stretches_as_in_the_whole(parted):
    whole, log = parted
    found = {}
    for name, one in (("whole", whole), ("parted", log)):
        problem = identification_problem(one, twin.model(12.0), read_catalogue())
        found[name] = explain(problem, most=1)[0]
        assert fitted(problem).score < found[name].score - 20.0
    loss = [fit.values["port.thrust_loss"] for fit in found.values()]
    assert loss == pytest.approx([0.25, 0.25], abs=0.04)


def test_what_is_computed_does_not_grow_with_a_log(parted, monkeypatch):
    """Of a log of twice the length as many rows are linearised and filtered."""
    monkeypatch.setattr(stretches, "MOST_ROWS", 480)
    log, _ = parted
    later = log.assign_coords(time=log["time"] + log.sizes["time"])
    records = [
        record_of(in_stretches(one, LENGTH), twin.model())
        for one in (log, xarray.concat([log, later], "time"))
    ]
    assert records[0].time.size == records[1].time.size <= 480
