"""At night: a segment that is spliced is as likely as one that is linearised."""

from dataclasses import replace

import pytest
from diagnose import twin
from diagnose.log_faults.test_input_labels import KNOTS, changed

from shipcosim.diagnose.log_faults.input_labels import _Relabelled, likelihood, with_label
from shipcosim.diagnose.ship.inputs import record_of


@pytest.mark.parametrize("step", [1.0, 0.31], ids=["each row", "rows averaged"])
@pytest.mark.parametrize("ends", [(0, 100), (37, 111), (60, 119)])
def test_a_segment_that_is_spliced_is_as_likely_as_one_that_is_linearised(step, ends):
    """Of two linearised logs and the rows about its ends, with late channels and with rows that are averaged."""
    log = changed({"wind_speed": 3600.0 / 1852.0 * twin.logs()["healthy"]["wind_speed"].values})
    log = log.assign_coords(time=step * log["time"])
    problem = twin.ready(with_label(log, KNOTS))
    model = problem.model.with_values({"instruments.thruster_lag": 2.0})
    problem = replace(problem, model=model, record=record_of(log, model))
    time = problem.record.time
    segment = ((float(time[ends[0]]), float(time[ends[1]])),)
    whole = likelihood(problem, record_of(with_label(log, KNOTS, segment), model))
    assert _Relabelled(log, KNOTS, problem).likelihood(ends, segment) == pytest.approx(
        whole, rel=1e-12
    )
