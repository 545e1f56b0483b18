"""A log as the simulation can use it: faults that were found undone or cut out, rows evenly spaced."""

from collections.abc import Sequence

import numpy as np
import xarray

from shipcosim.angles import wrap_series
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.samples import outliers
from shipcosim.diagnose.log.mislabels import undone
from shipcosim.diagnose.log.roles import role_of
from shipcosim.diagnose.log.rows import inside, usable_rows, usual_distance, usual_step
from shipcosim.diagnose.log.thresholds import HOLE, LONGEST_SPAN
from shipcosim.diagnose.numerics import running_sums
from shipcosim.errors import error_at
from shipcosim.series import make_table

CUT_OUT = ("gap", "heading_wrap")


def repaired(log: xarray.Dataset, findings: Sequence[Finding] = ()) -> xarray.Dataset:
    """The log on an even grid, with the faults that were found corrected or cut out.

    Rows are sorted; of rows with the same time the first is kept; rows without a time are left out. Time runs as the
    findings on the clock say, mislabelled channels are corrected, and what was interpolated over, held or turned
    through south is cut out.

    Parameters
    ----------
    log : xarray.Dataset
        As from `read_log`.
    findings : list of Finding
        As from `examine`.

    Returns
    -------
    xarray.Dataset
        At the median step of the log, from its first time on. NaN where there is no data; headings in [0, 360).
        The coordinate `logged_time` says where in the log a row stands. [s]

    Raises
    ------
    ShipcosimError
        If the times span fifty times what the rows can fill.
    """
    attributes = log.attrs | {key: log.encoding[key] for key in ("source",) if key in log.encoding}
    # Sort the rows, and read the time base as the findings on the whole log say.
    log = log.isel(time=usable_rows(log["time"].values))
    logged = log["time"].values
    base = read_anew({"time": logged}, findings)["time"]
    # Segments of wrong clock are stretched to true time, at the usual step.
    step = usual_step(base)
    time = _true_time(logged, base, findings, step)
    channels = {
        str(name): np.array(variable.values, float) for name, variable in log.data_vars.items()
    }
    # Correct labels and cut out what is no measurement,
    # in logged time: the segments are given in it.
    channels = _put_right(logged, channels, findings)
    # Even grid over the true time; no value across a hole.
    _check_span(time, step)
    grid = time[0] + step * np.arange(int(np.floor((time[-1] - time[0]) / step + 1e-6)) + 1)
    place = _Place(time, grid, np.diff(base) > HOLE * usual_distance(base))
    even = {name: place(values, _is_angle(name)) for name, values in channels.items()}
    # Headings are interpolated by the shorter way round, which can leave [0, 360).
    if "heading" in even:
        even["heading"] = np.mod(even["heading"], 360.0)
    columns = [
        (name, values, log[name].attrs["units"], log[name].attrs["long_name"])
        for name, values in even.items()
    ]
    table = make_table(grid, columns, attributes)
    origin = {"units": "s", "long_name": "time as logged"}
    # Keep the logged time of each row, so that results can be shown in it.
    return table.assign_coords(logged_time=("time", np.interp(grid, time, logged), origin))


def _check_span(time, step):
    """A stamp far off all others would make a log of years."""
    if time[-1] - time[0] > LONGEST_SPAN * step * len(time):
        row = int(np.argmax(np.diff(time)))
        message = (
            f"{time[row]:g} s is followed by {time[row + 1]:g} s, with a usual step of {step:g} s."
        )
        raise error_at(
            "time", message, "Leave out the rows whose times are wrong, or cut the log there."
        )


def rate_of(findings: Sequence[Finding]) -> float:
    """True seconds per logged second throughout a log, by findings on its clock."""
    rates = [
        f.parameters["rate"].estimate
        for f in findings
        if f.cause == "clock" and f.parameters and not f.segments
    ]
    return float(np.prod(rates))


def read_anew(log: dict, findings: Sequence[Finding]) -> dict:
    """A log, a dict of arrays with `time`, with what findings say of all of it corrected: time base, then labels."""
    time = log["time"]
    log = log | {"time": time[0] + rate_of(findings) * (time - time[0])}
    for mislabel in _labels_throughout(findings):
        if set(mislabel.channels) <= set(log):
            log = undone(log, mislabel, ())
    return log


def _labels_throughout(findings):
    """The heading first: velocities are turned by it."""
    labels = [f.mislabel for f in findings if f.mislabel is not None and not f.segments]
    return sorted(labels, key=lambda mislabel: mislabel.channels != ("heading",))


def _true_time(logged, base, findings, step):
    """Times of the rows by a clock that runs right, from the same start; `base`: as the time base is, in true seconds.

    A segment of wrong clock lasts a whole number of steps, less than its rate is sure to; so the rows after it need no
    interpolation, which would smooth their noise.
    """
    # True seconds per second of the time base, for each interval between rows.
    rates = np.ones(len(base) - 1)
    for finding in findings:
        for segment in finding.segments if finding.cause == "clock" else ():
            here = inside(logged[1:], [segment]) & inside(logged[:-1], [segment])
            # True duration of the segment, rounded to whole
            # steps, so that later rows fall on the grid.
            lasts = finding.parameters["rate"].estimate * np.diff(base)[here].sum()
            rates[here] *= (
                finding.parameters["rate"].estimate
                * max(round(lasts / step), 1)
                * step
                / max(lasts, step)
            )
    # True time is the integral of the rate.
    return base[0] + running_sums(rates * np.diff(base))


def _put_right(time, channels, findings):
    """Channels with corrected labels, without outliers and without samples that are not measured."""
    # Mistakes of the whole log first, then those of segments.
    channels = read_anew({"time": time, **channels}, findings) | {"time": time}
    for finding in findings:
        if finding.mislabel is not None and finding.segments:
            channels = undone(channels, finding.mislabel, finding.segments)
    # Gaps, wraps and outliers become NaN; the other faults are corrected, not removed.
    cut_out = [finding for finding in findings if finding.cause in CUT_OUT]
    channels = without_findings(channels, cut_out)
    channels.pop("time")
    return channels


def without_findings(log: dict, findings: Sequence[Finding]) -> dict:
    """A log without outliers, and without what findings say of their segments and channels."""
    # Outliers are found anew, as the caller may have corrected units.
    bad_rows = list(outliers(log).items())
    for finding in findings:
        here = inside(log["time"], finding.segments)
        bad_rows += [(role, here) for role in finding.channels if role in log]
    for role, bad in bad_rows:
        log = log | {role: np.where(bad, np.nan, log[role])}
    return log


def _is_angle(name):
    role = role_of(name)
    return role is not None and role.is_angle


class _Place:
    """Values at the times of a grid: those of the row there, else between the rows on both sides."""

    def __init__(self, time, grid, is_hole):
        # Row before each time of the grid, and the share of the way to the next row.
        self.before = np.clip(np.searchsorted(time, grid, side="right") - 1, 0, len(time) - 2)
        span = np.diff(time)[self.before]
        share = (grid - time[self.before]) / span
        # A time within rounding of a row takes its value unchanged, without interpolation.
        near = 1e-6 * np.median(span) / span
        self.share = np.where(
            np.abs(share) < near, 0.0, np.where(np.abs(share - 1.0) < near, 1.0, share)
        )
        # Times strictly inside a hole get no value.
        self.empty = is_hole[self.before] & (self.share > 0.0) & (self.share < 1.0)

    def __call__(self, values, is_angle):
        first = values[self.before]
        second = values[self.before + 1]
        # Angles change by the shorter way round.
        change = wrap_series(second - first) if is_angle else second - first
        between = first + self.share * change
        exact = np.where(self.share == 0.0, first, np.where(self.share == 1.0, second, between))
        return np.where(self.empty, np.nan, exact)
