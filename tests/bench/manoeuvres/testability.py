"""What manoeuvres show of each cause, before they are sailed: for the page of the library."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.design import keeps_track
from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre, planned, rows_of, sized, step_for
from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.innovations import Noise, innovations
from shipcosim.diagnose.inference.linearisation import linearise, rows_first
from shipcosim.diagnose.inference.regressors import screening_regressors
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.track_keeping import DpController, kept_on_track


def testability(
    model: ShipModel,
    hypotheses: Sequence[Hypothesis],
    noise: Noise,
    manoeuvres: Sequence[Manoeuvre],
    wind: tuple[float, float] | None = None,
) -> dict[str, np.ndarray]:
    """What each cause of typical size would gain in manoeuvres of a healthy ship.

    Parameters
    ----------
    model : ShipModel
    hypotheses : sequence of Hypothesis
    noise : Noise
        Of a log with a row a second.
    manoeuvres : sequence of Manoeuvre
    wind : tuple of two floats, optional
        Speed, and direction over ground that it comes from. [m/s, rad]

    Returns
    -------
    dict of str to (c,) array
        By the hypothesis's label, in the direction that shows least; NaN where the ship does not get through. [nats]
    """
    longest = 60.0 * max(one.minutes for one in manoeuvres)
    model, noise = (
        replace(model, wind_is_true=True, span=(0.0, longest)),
        sized(noise, step_for(model)),
    )
    dp = DpController(model, step_for(model))
    track, record, held = planned(manoeuvres, dp, (0.0, 0.0, 0.0, 0.0), wind)
    motion, units = kept_on_track(model, len(manoeuvres), track, record, dp, held=held)
    measured = np.moveaxis(rows_first(readings(motion, model)), 0, -2)
    record = replace(record, units=units, measured=measured)
    known = IdentificationProblem(record, model, tuple(hypotheses), noise, motion).ship_columns(())
    groups = [
        (hypothesis, group)
        for hypothesis in hypotheses
        for group in screening_regressors(hypothesis)
    ]
    columns = known + [column for _, group in groups for column in group]
    with threadpool_limits(1):
        white = innovations(linearise(motion, record, model, columns), noise, record).white
    found = {hypothesis.label: np.full(len(manoeuvres), np.inf) for hypothesis in hypotheses}
    through = keeps_track(motion, track, manoeuvres, dp)
    for i, one in enumerate(manoeuvres):
        rows = white[: rows_of(one, record.step), i].reshape(-1, white.shape[-1])
        products = rows.T @ rows
        place = len(known)
        for hypothesis, group in groups:
            seen = _shows(products, columns, range(place, place + len(group)), len(known))
            found[hypothesis.label][i] = np.minimum(
                found[hypothesis.label][i], seen if through[i] else np.nan
            )
            place += len(group)
    return found


def _shows(products, columns, places, known):
    """Gain of one cause of typical size, known numbers within their tolerance; of its least visible parameter."""
    places = list(places)
    taken = {path for place in places for path in columns[place].changes}
    prior = np.zeros(len(columns))
    prior[:known] = [0.0 if column.gives_way(taken) else column.prior for column in columns[:known]]
    prior[places] = 1.0
    blank = products.copy()
    blank[0, :] = blank[:, 0] = 0.0
    spread = np.diag(evidence(blank, prior)[2])[places]
    gain = float(np.min(1.0 / spread - 1.0))
    return 0.5 * (gain - np.log1p(gain))
