"""What a log alone was read as is put right as the ship's answer says."""

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of
from shipcosim.diagnose.log_faults import corrections
from shipcosim.diagnose.log_faults.corrections import with_right_wind
from shipcosim.diagnose.log_faults.input_labels import with_label

FROM_NORTH, OVER_GROUND_FROM_NORTH = WIND_LABELS[1], WIND_LABELS[3]
KNOTS = next(label for label in WIND_LABELS if "in kn," in label.sentence)


def counted_from_north(log):
    """A log with the direction of the wind counted from north."""
    return log.assign(
        wind_from=log["wind_from"].copy(data=np.mod(log["wind_from"] + log["heading"], 360.0))
    )


def over_ground_from_north(log):
    """A log with the wind over ground, counted from north."""
    speed, angle = log["wind_speed"].values, np.radians(log["wind_from"].values)
    ahead, aside = (
        speed * np.cos(angle) - log["surge"].values,
        speed * np.sin(angle) - log["sway"].values,
    )
    angle = log["wind_from"].copy(data=np.degrees(np.arctan2(aside, ahead)))
    return counted_from_north(
        log.assign(wind_speed=log["wind_speed"].copy(data=np.hypot(ahead, aside)), wind_from=angle)
    )


@pytest.mark.parametrize(
    "hidden, label",
    [(counted_from_north, FROM_NORTH), (over_ground_from_north, OVER_GROUND_FROM_NORTH)],
    ids=["from north", "over ground, from north"],
)
def test_a_wind_told_to_be_counted_from_north_is_over_ground_too_where_the_ship_says_so(
    hidden, label
):
    log = hidden(twin.logs()["healthy"])
    told = finding_of(FROM_NORTH, 0.99)
    clean = with_label(log, FROM_NORTH)
    given = Identification(log, twin.model(), read_catalogue(), (told,), clean, twin.ready(clean))
    right = with_right_wind(given)
    (found,) = right.faults
    assert (found.note, found.channels, found.segments) == (label.sentence, label.channels, ())
    healthy = twin.logs()["healthy"]
    np.testing.assert_allclose(right.repaired["wind_speed"], healthy["wind_speed"], atol=1e-9)


def test_a_unit_of_the_wind_that_the_ship_answers_nowhere_is_no_fault():
    """Told throughout a log that is right, it was settled to the last minute of the log, and named there."""
    log = twin.logs()["healthy"]
    told = finding_of(KNOTS, 0.97)
    clean = with_label(log, KNOTS)
    right = with_right_wind(
        Identification(log, twin.model(), read_catalogue(), (told,), clean, twin.ready(clean))
    )
    assert right.faults == ()
    np.testing.assert_array_equal(right.repaired["wind_speed"], log["wind_speed"])


@pytest.mark.parametrize(
    ("part", "is_elsewhere"),
    [((), False), ((110.0, 290.0), False), ((250.0, 450.0), True), ((400.0, 500.0), True)],
)
def test_a_part_that_log_and_ship_see_elsewhere_is_none(part, is_elsewhere):
    by_log = finding_of(KNOTS, 0.9, (100.0, 300.0))
    by_ship = finding_of(KNOTS, 0.9, part or None)
    assert corrections._is_elsewhere(by_ship, by_log) is is_elsewhere
