"""Linearisation of a log: what a small change of each number of the ship does to her motion and her measurements.

About a motion near the measured one the ship is a linear system that varies in time. Everything vectorises over the
rows of a log and over several logs; only the filter goes from row to row.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from shipcosim.diagnose.ship.dynamics import loads, motion_rates, rate_difference
from shipcosim.diagnose.ship.inputs import Inputs, Record
from shipcosim.diagnose.ship.measured_motion import at_rows, readings
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.integrate import rk4
from shipcosim.models.core.motion import Motion

STATES = 18
"""x, y, psi, u, v, r, an acceleration that nobody explains (3), slow errors of position and heading (3), what waves add
to position and heading (3) and to velocity (3), in the ship's axes."""
MOVED = 9
"""The first of them: those whose transition differs from row to row."""
_SHARE = 0.2  # of a regressor's size, for differences
SLOW_STD = np.array([0.1, 0.1, np.radians(0.1)])
SLOW_TIME = np.array([240.0, 240.0, 60.0])
"""Slow errors of position and heading, stationary standard deviation [m, m, rad] and correlation time [s]."""


@dataclass(frozen=True)
class Regressor:
    """Numbers of the ship that one θ changes, and the size that θ may have.

    Attributes
    ----------
    changes : dict of str to float
        By how much each number of the ship is changed at θ = 1.
    prior : float
        Standard deviation of θ.
    vector : tuple of str
        Numbers that are a vector together whose direction matters: one that is short is not turned round by the
        differences that are taken for its slope.
    beside : bool
        Whether it stays where a cause changes the same numbers: what a reference leaves uncertain of them.
    """

    changes: dict[str, float]
    prior: float = 1.0
    vector: tuple[str, ...] = ()
    beside: bool = False

    @property
    def key(self) -> tuple[tuple[str, float], ...]:
        """What tells it apart from other regressors: its changes in order."""
        return tuple(sorted(self.changes.items()))

    @property
    def is_of_day(self) -> bool:
        """Whether it changes a number that is another on each day."""
        return any(ShipModel.is_of_day(path) for path in self.changes)

    def gives_way(self, taken: Collection[str]) -> bool:
        """True if a cause on these numbers replaces this regressor."""
        return not self.beside and not self.changes.keys().isdisjoint(taken)


def moved(
    columns: Iterable[Regressor], shares: Iterable[float], get: Callable[[str], float]
) -> dict[str, float]:
    """Numbers of the ship where columns move them to, each by its share of its changes."""
    numbers: dict[str, float] = {}
    for column, share in zip(columns, shares, strict=True):
        for path, size in column.changes.items():
            numbers[path] = numbers.get(path, get(path)) + float(share) * size
    return numbers


class Linear(NamedTuple):
    """Deviations from a motion, by row: δ' = A δ + b - B θ, z = H δ + C θ; columns: b and z, then B and C of each θ.

    Attributes
    ----------
    transition : (n-1, ..., 9, 9) array
        Of motion and unexplained acceleration. That of slow errors and waves is the same at all rows.
    driven : (n-1, ..., 6, 1 + p) array
        Of the motion alone. First column: by how much the model misses the next row of the motion.
    output : (n, ..., 6, 18) array
    seen : (n, ..., 6, 1 + p) array
        First column: measured minus shown, 0 where nothing was measured.
    whole : (n, ..., 6) bool array
        Whether the channel was measured.
    """

    transition: np.ndarray
    driven: np.ndarray
    output: np.ndarray
    seen: np.ndarray
    whole: np.ndarray


_FASTEST = {
    "u": 100.0,
    "v": 100.0,
    "r": 10.0,
}  # m/s, rad/s: what runs away under a wrong label stays a number


def advanced(
    motion: Motion, record: Record, model: ShipModel, steps: slice = slice(None)
) -> Motion:
    """The motion one row later, from each row but the last, by a Runge-Kutta step or, for a small ship, several.

    Parameters
    ----------
    motion : Motion
        (..., k) arrays, where the steps begin.
    record : Record
    model : ShipModel
    steps : slice
        Which of the record's n-1 steps.

    Returns
    -------
    Motion
    """
    # A small ship is faster than the log's step: the step is divided.
    parts = record.substeps(model)
    for i in range(parts):
        inputs = [record.inputs(model, (i + share) / parts, steps) for share in (0.0, 0.5, 1.0)]
        motion = runge_kutta(motion, record.step / parts, inputs, model)
        # Bounded velocities keep a diverging model finite.
        fast = {
            name: np.clip(getattr(motion, name), -most, most) for name, most in _FASTEST.items()
        }
        motion = motion._replace(**fast)
    return motion


def runge_kutta(
    motion: Motion,
    h: float,
    inputs: Sequence[Inputs],
    model: ShipModel,
    load: Any = lambda psi: (0.0, 0.0, 0.0),
) -> Motion:
    """The motion a step of h later.

    Parameters
    ----------
    motion : Motion
    h : float
        [s]
    inputs : sequence of three Inputs
        At the beginning, the middle and the end.
    model : ShipModel
    load : callable or sequence of three callables, optional
        Further load by the heading. [N, N, N.m]

    Returns
    -------
    Motion
    """
    loads_at = load if isinstance(load, (list, tuple)) else (load, load, load)

    def rates(x, y, psi, u, v, r, i):
        return motion_rates(Motion(x, y, psi, u, v, r), inputs[i], model, loads_at[i](psi))

    return Motion(*rk4(rates, motion, h, ((0,), (1,), (2,))))


def linearise(
    motion: Motion,
    record: Record,
    model: ShipModel,
    regressors: Sequence[Regressor],
    rows: slice | None = None,
) -> Linear:
    """The linear problem about a motion.

    Parameters
    ----------
    motion : Motion
        (..., n) arrays near what was measured.
    record : Record
    model : ShipModel
    regressors : sequence of Regressor
    rows : slice, optional
        Only these rows, and the steps from each of them to the next.

    Returns
    -------
    Linear
    """
    # Rows of this part, and steps from each row but the log's last.
    lead = record.measured.shape[:-2]
    p = len(regressors)
    last = record.time.size - 1
    rows = slice(0, last + 1) if rows is None else rows
    steps = slice(rows.start, min(rows.stop, last))
    # The model's next row against the motion's own: its defect drives the deviations.
    start = at_rows(motion, (..., steps))
    after = at_rows(motion, (..., slice(steps.start + 1, steps.stop + 1)))
    base = advanced(start, record, model, steps)
    seen = readings(at_rows(motion, (..., rows)), model)
    driven = np.empty((steps.stop - steps.start, *lead, 6, 1 + p))
    out = np.zeros((rows.stop - rows.start, *lead, 6, 1 + p))
    driven[..., 0] = rows_first(base) - rows_first(after)
    # Measured less shown; missing measurements count 0 and are marked.
    missed = np.moveaxis(record.measured[..., rows, :], -2, 0) - rows_first(seen)
    whole = np.isfinite(missed)
    out[..., 0] = np.where(whole, missed, 0.0)
    # Transition and slopes are taken at the middle of each step, which is of second order.
    middle = Motion(*(0.5 * (a + b) for a, b in zip(start, after, strict=True)))
    inputs = record.inputs(model, 0.5, steps)
    like = model, loads(middle, inputs, model)
    transition = _transition(middle, inputs, like, record)
    # Central differences about the ship: twice the share of the regressor's size apart.
    shares = np.array([_step_share(regressor, model) for regressor in regressors]).reshape(p)
    slopes = np.zeros((p, 3, *lead, len(driven)))
    for j, changes in enumerate(regressor.changes for regressor in regressors):
        pair = [
            model.with_values(
                {path: model.get(path) + share * size for path, size in changes.items()}
            )
            for share in (shares[j], -shares[j])
        ]
        # Numbers of the ship, and delays of inputs, change accelerations; those of instruments only
        # change what is shown.
        if any(not path.startswith("instruments.") or path.endswith("_lag") for path in changes):
            for slope, apart in zip(
                slopes[j], _slopes(pair, middle, (record, steps), inputs, like), strict=True
            ):
                slope[...] = apart
        else:
            up, down = (readings(at_rows(motion, (..., rows)), ship) for ship in pair)
            out[..., 1 + j] = rows_first(_apart(up, down)) / (2.0 * shares[j])
    # A constant acceleration over the step moves the state as the unexplained acceleration does:
    # reuse those columns of the transition. The sign is that of δ' = A δ + b - B θ.
    driven[..., 1:] = (
        transition[..., :6, 6:9] @ np.moveaxis(slopes, (-1, 1, 0), (0, -2, -1)) / (2.0 * shares)
    )
    # Where inputs are unknown the equations say nothing of the step.
    driven[~record.usable[steps]] = 0.0
    out *= whole[..., None]
    return Linear(
        transition, driven, _output(at_rows(motion, (..., rows)), seen, model), out, whole
    )


def _slopes(pair, middle, where, inputs, like):
    """Accelerations of the first ship of a pair minus those of the second; one with another lag has other inputs."""
    # Difference of loads where both ships have the same inputs; other terms cancel.
    up, down = pair
    if up.parts["instruments"] is down.parts["instruments"]:
        return rate_difference(down, up, middle, inputs, like)
    # Another delay shifts the inputs, so both accelerations are evaluated in full.
    record, steps = where
    late = (motion_rates(middle, record.inputs(ship, 0.5, steps), ship) for ship in (down, up))
    return _apart(*late)[3:]


def _step_share(regressor: Regressor, model: ShipModel) -> float:
    """Share of a regressor's size for differences; they must not turn round a vector that is short."""
    length = (
        float(np.hypot(*(model.get(path) for path in regressor.vector)))
        if regressor.vector
        else 0.0
    )
    # Without a vector, or with one of zero length, the normal share; else a share of the vector's
    # length.
    if not length:
        return _SHARE
    size = max(abs(size) for size in regressor.changes.values())
    return min(_SHARE, max(_SHARE * length / size, 1e-4))


def _apart(first: Motion, other: Motion) -> Motion:
    """One motion minus another."""
    return Motion(*(a - b for a, b in zip(first, other, strict=True)))


def rows_first(motion: Motion) -> np.ndarray:
    """(..., n) arrays of a motion as (n, ..., 6)."""
    shape = np.broadcast_shapes(*(np.shape(value) for value in motion))
    stacked = np.stack([np.broadcast_to(value, shape) for value in motion], axis=-1)
    return np.moveaxis(stacked, -2, 0)


_SMALL = {"psi": 1e-4, "u": 1e-3, "v": 1e-3, "r": 1e-5}


def _transition(
    middle: Motion, inputs: Inputs, like: tuple[ShipModel, Any], record: Record
) -> np.ndarray:
    """Transition over a step, of second order about its middle, where `like` has the ship and her loads.

    For a small ship that of a part of the step, doubled until it is whole.
    """
    # Jacobian of the accelerations by forward differences; they do not depend on x and y.
    model, _ = like
    here = rows_first(motion_rates(middle, inputs, model, like=like))
    J = np.zeros((*here.shape[:-1], 6, 6))
    for name, small in _SMALL.items():
        moved = middle._replace(**{name: getattr(middle, name) + small})
        J[..., Motion._fields.index(name)] = (
            rows_first(motion_rates(moved, inputs, model)) - here
        ) / small
    # Taylor series of the matrix exponential to second order, over one substep.
    parts = record.substeps(model)
    h = record.step / parts
    moves = np.eye(6) + h * J + 0.5 * h * h * (J @ J)
    # Effect of a constant input over the substep, by the trapezoidal rule.
    pushed = 0.5 * h * (moves + np.eye(6))
    # Doubling: two substeps in a row make one of twice the length.
    for _ in range(round(np.log2(parts))):
        moves, pushed = moves @ moves, pushed + moves @ pushed
    # Unexplained acceleration enters the velocities and keeps its value.
    A = np.zeros((*here.shape[:-1], MOVED, MOVED))
    A[..., :6, :6], A[..., :6, 6:9] = moves, pushed[..., 3:]
    A[..., range(6, 9), range(6, 9)] = 1.0
    return A


def _output(motion: Motion, seen: Motion, model: ShipModel) -> np.ndarray:
    # Measurements follow position directly, heading and velocities by forward differences.
    rows = rows_first(seen)
    H = np.zeros((*rows.shape, STATES))
    H[..., 0, 0] = H[..., 1, 1] = 1.0
    for name, small in _SMALL.items():
        i = Motion._fields.index(name)
        other = readings(motion._replace(**{name: getattr(motion, name) + small}), model)
        H[..., i] = (rows_first(other) - rows) / small
    # Slow errors add to measured position and heading.
    H[..., range(3), range(9, 12)] = 1.0
    # Wave motion is in ship's axes: turned into north and east for position, added to heading and
    # velocities.
    c = np.cos(rows[..., 2])
    s = np.sin(rows[..., 2])
    H[..., 0, 12], H[..., 0, 13], H[..., 1, 12], H[..., 1, 13] = c, -s, s, c
    H[..., 2, 14] = H[..., 3, 15] = H[..., 4, 16] = H[..., 5, 17] = 1.0
    return H
