"""At night: a prescribed manoeuvre separates causes that the log could not."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose.experiment.test_manoeuvres import NOISE, problem

from shipcosim.diagnose.experiment.design import design_experiment
from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre, library, planned
from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.explanation.verdict import judge
from shipcosim.diagnose.inference.fitting import IdentificationProblem, prepared
from shipcosim.diagnose.ship.inputs import first_motion
from shipcosim.diagnose.ship.track_keeping import DpController, kept_on_track


def logged(values, manoeuvre=None, seed=1, minutes=8.0):
    """A ship with some values keeps her place, and then sails a manoeuvre; her log and what she is taken for."""
    before, model = 60.0 * minutes, replace(problem().model, span=(0.0, 60.0 * minutes))
    after = manoeuvre or Manoeuvre("nothing", ())
    pushes = tuple(replace(p, start=p.start + before, end=p.end + before) for p in after.pushes)
    free = tuple((a + before, b + before) for a, b in after.free)
    one = Manoeuvre("both", ((before, 0.0, 0.0, 0.0), *after.legs), pushes, free)
    dp, random = DpController(model, 1.0), np.random.default_rng(seed)
    track, record, held = planned([one], dp, (0.0, 0.0, 0.0, 0.0), (6.0, 0.5))
    jolts = random.standard_normal((record.time.size, 3, 1)) * NOISE.jolt[:, None]
    motion, units = kept_on_track(
        model.with_values(values), 1, track, record, dp, jolts=jolts, held=held
    )
    measured = np.stack([v[0] for v in motion], -1) + NOISE.white * random.standard_normal(
        (record.time.size, 6)
    )
    units = {name: tuple(series[0] for series in pair) for name, pair in units.items()}
    record = replace(
        record, measured=measured, units=units, wind=tuple(series[0] for series in record.wind)
    )
    names = {"current", "wave_drift", "tow", "wind_scale", "thrust_loss of port"}
    asked = tuple(hypothesis for hypothesis in problem().hypotheses if hypothesis.label in names)
    return prepared(IdentificationProblem(record, model, asked, NOISE, first_motion(record)))


def test_a_log_that_cannot_tell_drift_from_current_can_after_the_prescribed_manoeuvre():
    drift = {"water.drift_east": -1500.0}
    one = logged(drift)
    before = judge(explain(one), lambda fit: {"": 0.0})
    assert before.verdict == "ambiguous"
    assert {"current", "wave_drift"} <= {candidate.cause for candidate in before.indistinguishable}
    told = design_experiment(one, before.fit, before.rivals)
    sent = next(m for m in library(one.model) if m.name == told.manoeuvre)
    after = judge(explain(logged(drift, sent)), lambda fit: {"": 0.0})
    assert after.verdict == "named"
    assert [finding.cause for finding in after.findings] == ["wave_drift"]
