"""Open-loop predictions of a ship from many rows of a log at once, and what an observer knew when they began."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.inference.innovations import Noise, innovations, smoothed
from shipcosim.diagnose.inference.linearisation import Linear, advanced, rows_first, runge_kutta
from shipcosim.diagnose.inference.thresholds import FASTEST, FASTEST_TURN, REFERENCE_JOLTS
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.instruments import LAGS
from shipcosim.diagnose.ship.measured_motion import at_rows, readings, true_motion, wind_over_ground
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion

_FORCE = slice(6, 9)


@dataclass(frozen=True)
class Known:
    """What an observer knew at each row of a log from the rows until then.

    Attributes
    ----------
    motion : Motion
        (..., n) arrays.
    force : (..., n, 3) array
        Load that nobody explains, in body axes. [N, N, N.m]
    """

    motion: Any
    force: Any

    def of(self, which: Any) -> Known:
        """What some of the observers knew, those on the first axis."""
        return Known(at_rows(self.motion, which), self.force[which])


def replayable(record: Record, model: ShipModel, seen: Motion) -> tuple[Record, ShipModel]:
    """A log as replays need it: no channel late, and the wind over ground, as one ship model understands the log.

    Parameters
    ----------
    record : Record
    model : ShipModel
    seen : Motion
        What the instruments show, without their noise, (n,) arrays.

    Returns
    -------
    tuple of Record and ShipModel
        Times are those of the navigation's channels.
    """
    # Inputs with their delays removed; the last row is repeated, as inputs belong to steps.
    inputs = record.inputs(model)
    units = {name: tuple(map(_one_more, pair)) for name, pair in inputs.units.items()}
    wind = None
    if record.wind is not None:
        wind = _one_more(inputs.wind_speed), _one_more(inputs.wind_from)
        # Replays sail another track than the log: relative wind must become wind over ground.
        wind = wind if model.wind_is_true else _true_wind(*wind, true_motion(seen, model))
    # Delays are in the inputs now, so the model must not apply them again.
    model = replace(model.with_values(dict.fromkeys(LAGS, 0.0)), wind_is_true=wind is not None)
    return replace(record, units=units, wind=wind), model


def _one_more(series):
    return np.concatenate([series, series[-1:]])


def _true_wind(speed, direction, motion):
    """Speed and direction over ground of the wind that meets the moving ship so."""
    # The direction is again where it comes from.
    north, east = wind_over_ground(speed, direction, motion)
    return np.hypot(north, east), np.unwrap(np.arctan2(-east, -north))


def earth_fixed(linear: Linear, motion: Motion, model: ShipModel) -> Linear:
    """The problem with an unexplained load that walks in the earth's frame, as the bias of a DP observer does.

    Parameters
    ----------
    linear : Linear
        Of one log.
    motion : Motion
        That it was linearised about.
    model : ShipModel

    Returns
    -------
    Linear
    """
    # The unexplained force keeps its direction over ground, so it turns in body axes against the
    # heading.
    turn = np.diff(motion.psi)
    back = np.zeros((turn.size, 3, 3))
    back[:, 0, 0] = back[:, 1, 1] = np.cos(turn)
    back[:, 0, 1], back[:, 1, 0], back[:, 2, 2] = np.sin(turn), -np.sin(turn), 1.0
    # The filter's state is an acceleration: to force, turn, and back.
    mass = model.mass_matrix
    transition = linear.transition.copy()
    transition[:, _FORCE, _FORCE] = np.linalg.inv(mass) @ back @ mass
    return linear._replace(transition=transition)


def restarted(linear: Linear, motion: Motion, record: Record, model: ShipModel) -> Linear:
    """The problem of a ship model that differs little from the one that was linearised, about the same motion."""
    # Transition and output are kept; only the defect of the model and the residuals are evaluated
    # anew.
    ahead = advanced(at_rows(motion, slice(-1)), record, model)
    driven = np.zeros((*linear.driven.shape[:-1], 1))
    driven[:, :6, 0] = rows_first(ahead) - rows_first(at_rows(motion, slice(1, None)))
    # Steps with unknown inputs drive nothing.
    driven *= record.usable[:-1, None, None]
    seen = np.where(linear.whole, record.measured - rows_first(readings(motion, model)), 0.0)
    return linear._replace(driven=driven, seen=seen[..., None])


def reference(
    linear: Linear, motion: Motion, noise: Noise, record: Record, model: ShipModel
) -> Motion:
    """What the instruments show without their noise, whatever the model: smoothed with a force that is free to change.

    Parameters
    ----------
    linear : Linear
        Of one log.
    motion : Motion
        That it was linearised about.
    noise : Noise
    record : Record
    model : ShipModel

    Returns
    -------
    Motion
        (n,) arrays.
    """
    # Large process noise: the smoothed motion follows the measurements rather than the model.
    jolt = REFERENCE_JOLTS * noise.jolt
    weak = replace(noise, jolt=jolt, walk=jolt / REFERENCE_JOLTS)
    return readings(smoothed(linear, weak, record, motion)[0], model)


def stacked(problems: Sequence[Linear]) -> Linear:
    """Problems of one log, each with its first column alone, side by side on a new axis after the rows."""
    return Linear(
        np.stack([p.transition for p in problems], axis=1),
        np.stack([p.driven[..., :1] for p in problems], axis=1),
        np.stack([p.output for p in problems], axis=1),
        np.stack([p.seen[..., :1] for p in problems], axis=1),
        np.stack([p.whole for p in problems], axis=1),
    )


def observed(
    problems: Sequence[Linear],
    noise: Noise,
    record: Record,
    motions: Sequence[Motion],
    models: Sequence[ShipModel],
) -> Known:
    """What observers knew, one for each problem.

    Parameters
    ----------
    problems : list of k Linear
    noise : Noise
        Of (k, ...) arrays.
    record : Record
    motions : list of k Motion
        That the problems were linearised about.
    models : list of k ShipModel

    Returns
    -------
    Known
        Of (k, n, ...) arrays.
    """
    # Filtered deviations of all observers in one pass.
    filtered = np.moveaxis(innovations(stacked(problems), noise, record).filtered, 0, 1)
    # Add them to the motions they deviate from; unexplained acceleration times mass is force.
    about = np.stack([np.stack(motion, axis=-1) for motion in motions])
    force = np.stack(
        [
            state[:, _FORCE] @ model.mass_matrix.T
            for state, model in zip(filtered, models, strict=True)
        ]
    )
    return Known(Motion(*np.moveaxis(about + filtered[..., :6], -1, 0)), force)


def predicted(
    motion: Motion,
    rows: np.ndarray,
    record: Record,
    model: ShipModel,
    horizons: Sequence[int],
    force: np.ndarray | None = None,
    *,
    earth: bool | np.ndarray = True,
    fades: float | np.ndarray = 0.0,
) -> Motion:
    """Predicted positions from some rows on, by the logged inputs.

    Parameters
    ----------
    motion : Motion
        At the start, (..., s) arrays.
    rows : (s,) array of int
        Where the predictions start.
    record : Record
        As from `replayable`.
    model : ShipModel
    horizons : sequence of int
        After how many rows, increasing.
    force : (..., s, 3) array, optional
        A load besides, in body axes at the start, that is held. [N, N, N.m]
    earth : bool or array that can be broadcast
        Whether it is held in the earth's frame, else in the ship's.
    fades : float or array that can be broadcast
        Rate at which it fades, 0 where it lasts. [1/s]

    Returns
    -------
    Motion
        Of (len(horizons), ..., s) arrays.
    """
    # Inputs at the ends and the middle of each Runge-Kutta step.
    parts = record.substeps(model)
    inputs = [record.inputs(model, 0.5 * i / parts) for i in range(2 * parts + 1)]
    load = _held(motion, force, earth, fades)
    h = record.step / parts
    kept = []
    # All predictions go on together, one row after the other; only the wanted horizons are stored.
    for k in range(horizons[-1]):
        for i in range(parts):
            during = [series.at(rows + k) for series in inputs[2 * i : 2 * i + 3]]
            loads = [load(k * record.step + (i + share) * h) for share in (0.0, 0.5, 1.0)]
            motion = _bounded(runge_kutta(motion, h, during, model, loads))
        if k + 1 in horizons:
            kept.append(motion)
    return Motion(*(np.stack(channel) for channel in zip(*kept, strict=True)))


def _held(motion, force, earth, fades):
    """Function from a time to the function from a heading to the load that is held."""
    if force is None:
        return lambda time: lambda psi: (0.0, 0.0, 0.0)
    # Held in the earth's frame, the load turns in body axes by the change of heading.
    axes = np.moveaxis(force, -1, 0)
    start = motion.psi

    def load(time):
        X, Y, N = np.exp(-fades * time) * axes
        return lambda psi: (*to_body(np.where(earth, psi - start, 0.0), X, Y), N)

    return load


def _bounded(motion):
    """A motion no faster than any ship, so that a prediction that runs away stays a number."""
    u = np.clip(motion.u, -FASTEST, FASTEST)
    v = np.clip(motion.v, -FASTEST, FASTEST)
    return motion._replace(u=u, v=v, r=np.clip(motion.r, -FASTEST_TURN, FASTEST_TURN))


def missing(predicted_motion: Motion, seen: Motion, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Errors of predictions.

    Parameters
    ----------
    predicted_motion : Motion
        Predicted, as instruments show it; arrays to which the shape of rows can be broadcast.
    seen : Motion
        What they showed, (n,) arrays.
    rows : array of int

    Returns
    -------
    dict of str to array
        ``position`` [m], ``heading`` [deg], ``surge``, ``sway`` [m/s], ``yaw_rate`` [deg/s].
    """
    # Prediction less what the instruments showed; the heading's difference is wrapped to a half
    # turn.
    off = Motion(
        *(value - series[rows] for value, series in zip(predicted_motion, seen, strict=True))
    )
    return {
        "position": np.hypot(off.x, off.y),
        "heading": np.degrees(np.angle(np.exp(1j * off.psi))),
        "surge": off.u,
        "sway": off.v,
        "yaw_rate": np.degrees(off.r),
    }
