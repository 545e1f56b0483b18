"""What holds between channels of a whole log: position against velocity, heading against rate.

With position p and velocity w as complex numbers and E = exp(i heading), the change of position is the integral of w E.
Any mistake of a sign, a frame or a unit makes it c times the integral of another *form*, such as conj(w) E or w alone,
with a complex factor c: its size is a matter of units and of the time base, its angle of frames. So a few forms, each
with c and with how likely it is, hold all that a log says about such mistakes.
"""

import cmath
from dataclasses import dataclass

import numpy as np

from shipcosim.angles import wrap_series
from shipcosim.diagnose.log.checks.kinematics import complete_rows, logged_position
from shipcosim.diagnose.log.readings.changes import LogInterpretation
from shipcosim.diagnose.log.readings.fit import fitted
from shipcosim.diagnose.log.thresholds import (
    ALONGSIDE,
    FEWEST_INCREMENTS,
    LARGEST_TURN,
    TURNED_TOO_FAR,
)
from shipcosim.diagnose.numerics import running_sums, spline_integral

FORMS = {
    ("as is", "body"): lambda w, e: w * e,
    ("mirrored", "body"): lambda w, e: np.conj(w) * e,
    ("as is", "mirrored"): lambda w, e: w * np.conj(e),
    ("mirrored", "mirrored"): lambda w, e: np.conj(w) * np.conj(e),
    ("as is", "earth"): lambda w, e: w,
    ("mirrored", "earth"): lambda w, e: np.conj(w),
}
"""Forms of the velocity over ground, by how surge and sway are taken and by what turns them."""
RATE = ("as is", "rate")
"""The form of the yaw rate."""


@dataclass(frozen=True)
class RowsOfRelation:
    """One relation of a log as labelled, row by row.

    Attributes
    ----------
    rows : (n,) array of int
        Rows of the log in which all its channels have values.
    seen : (n,) complex array
        Position [m] or heading [deg].
    reported : dict of (n,) complex arrays
        What each form of the rate adds up to.
    axes : int
        2 of positions, 1 of headings.
    """

    rows: np.ndarray
    seen: np.ndarray
    reported: dict[tuple[str, str], np.ndarray]
    axes: int

    def predicted(self, reading: LogInterpretation) -> tuple[tuple[str, str], complex]:
        """The form of the reported change that is proportional to the observed one, and the factor, by a reading."""
        if self.axes == 1:
            return RATE, reading.rate_factor
        return reading.form, cmath.exp(reading.factor)


def rows_of_relations(log: dict) -> list[RowsOfRelation]:
    """Position against velocity, and heading against yaw rate; without those that cannot be compared.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used.
    """
    relations = []
    rows = complete_rows(log, ("heading", "yaw_rate"))
    if len(rows) and _can_be_followed(change := wrap_series(np.diff(log["heading"][rows]))):
        integral = spline_integral(log["time"][rows], log["yaw_rate"][rows]).astype(complex)
        relations.append(
            RowsOfRelation(rows, running_sums(change).astype(complex), {RATE: integral}, 1)
        )
    logged = logged_position(log)
    rows = logged.rows
    if len(rows) and _can_be_followed(wrap_series(np.diff(log["heading"][rows]))):
        ways = _ways(logged.time, logged.velocity, logged.turn)
        relations.append(RowsOfRelation(rows, logged.seen[:, 0] + 1j * logged.seen[:, 1], ways, 2))
    return relations


def _ways(time, velocity, turn):
    """What each form of the velocity adds up to."""
    # By a spline: the trapezium loses a tenth of a motion with six rows a period.
    return {form: spline_integral(time, change(velocity, turn)) for form, change in FORMS.items()}


def position_relations(log: dict, headings: dict, positions: dict) -> dict:
    """Position against velocity in each of the forms; empty where there is too little of them.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units as logged.
    headings : dict of (n,) arrays
        By how they are read. [deg]
    positions : dict of (n,) complex arrays
        North and i times east, by how they are read. [m]

    Returns
    -------
    dict of (heading, position) to dict of form to Relation
    """
    # Rows in which velocity, heading and position have values; other readings of them have them there too.
    logged = logged_position(log)
    rows = logged.rows
    if len(rows) < 2 * FEWEST_INCREMENTS:
        return {}
    known_positions = {position: seen[rows] for position, seen in positions.items()}
    # Integrate the velocity of each form, for each reading of the heading that can be followed.
    pairs: dict = {}
    for heading, values in headings.items():
        if not _can_be_followed(wrap_series(np.diff(values[rows]))):
            continue
        turn = np.exp(1j * np.radians(values[rows]))
        ways = _ways(logged.time, logged.velocity, turn)
        for position, seen in known_positions.items():
            pairs |= {(heading, position, form): (seen, way) for form, way in ways.items()}
    # Fit all pairs at once, since they share thinning
    # and whitening, and sort the results by reading.
    relations: dict = {}
    labelled = (1.0, False, ("as is", "body"))
    for (heading, position, form), relation in fitted(logged.time, pairs, labelled).items():
        relations.setdefault((heading, position), {})[form] = relation
    return relations


def rate_relations(log: dict, headings: dict) -> dict:
    """Heading against yaw rate; nothing where there is too little, or rows are too far apart to count turns.

    Parameters
    ----------
    log : dict of (n,) arrays
        As of `position_relations`.
    headings : dict of (n,) arrays
        By how they are read. [deg]

    Returns
    -------
    dict of heading to Relation
    """
    rows = complete_rows(log, ("heading", "yaw_rate"))
    if len(rows) < 2 * FEWEST_INCREMENTS:
        return {}
    # The change of heading that the yaw rate predicts.
    time = log["time"][rows]
    integral = spline_integral(time, log["yaw_rate"][rows])
    pairs = {}
    # Unwrap the heading between rows, which needs turns of less than half a revolution.
    for name, heading in headings.items():
        change = wrap_series(np.diff(heading[rows]))
        if _can_be_followed(change):
            difference = wrap_series(
                np.diff(heading[rows] - integral)
            )  # she can turn by more than half a turn between rows
            # If the predicted turns are too large for that, and the heading
            # follows them, unwrap the difference to the prediction instead.
            if (
                not _can_be_followed(np.diff(integral))
                and np.quantile(np.abs(difference), 0.9) < ALONGSIDE
            ):
                change = np.diff(integral) + difference
            pairs[name] = running_sums(change).astype(complex), integral.astype(complex)
    return fitted(time, pairs, 1.0, axes=1)


def _can_be_followed(turns):
    return len(turns) and np.quantile(np.abs(turns), 1.0 - TURNED_TOO_FAR) <= LARGEST_TURN
