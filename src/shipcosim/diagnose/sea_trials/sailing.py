"""The ship model sails the orders of sea trials, open loop: all manoeuvres and many changed ships at once."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from shipcosim.diagnose.numerics import places
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs, ThrusterSeries
from shipcosim.diagnose.ship.measured_motion import readings, true_motion
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.integrate import rk4
from shipcosim.models.core.motion import Motion
from shipcosim.models.propulsion.azimuth import AzimuthParameters, turned


def sailed(
    trials: Sequence[SeaTrial],
    model: ShipModel,
    changes: Sequence[Mapping[str, float]],
) -> list[np.ndarray]:
    """What instruments would show of ships that sail the orders of trials from where these began.

    Calm: without wind and waves. A straight run is sailed on with its mean orders until the speed has settled.

    Parameters
    ----------
    trials : sequence of SeaTrial
        All of orders, or none.
    model : ShipModel
    changes : sequence of p mappings of str to float
        By ship: numbers and what is added to them.

    Returns
    -------
    list of (p, n, 6) arrays
        By trial: position, heading, surge, sway, yaw rate at its times; of a straight run at as many as it needs.
    """
    # Ships along the first axis, trials along the second: one simulation for all.
    ships = _side_by_side(model, changes)
    lengths, driven = zip(*(_driven(trial, model) for trial in trials), strict=True)
    most = max(lengths)
    units = {
        name: tuple(_padded([d[name][i] for d in driven], most) for i in (0, 1))
        for name in model.thrusters
    }
    # Trials begin as measured, but without sway.
    seen = Motion(*np.array([trial.measured[0] for trial in trials]).T)
    state = true_motion(seen, ships)._replace(v=0.0 * seen.v)
    h = float(trials[0].time[1])
    many = (len(changes), len(trials))
    state = Motion(*(np.broadcast_to(value, many).copy() for value in state))
    way = _way(state, units, ships, most, h, trials[0].orders)
    table = np.stack([_shown(now, ships) for now in way], axis=-2)
    return [table[:, i, :n] for i, n in enumerate(lengths)]  # ships, trials, rows, channels


def _way(state, units, ships, rows, h, follows):
    """Motions row by row, of units that do or follow what the series say; these may be written while it runs."""
    actual = _at(units, 0)
    yield state
    for k in range(1, rows):
        after = _followed(actual, units, k, ships, h) if follows else _at(units, k)
        state = _stepped(state, actual, after, ships, h)
        actual = after
        yield state


def settled(
    orders: Sequence[Mapping[str, tuple[float, float]]],
    model: ShipModel,
    changes: Mapping[str, float],
    h: float,
) -> list[float]:
    """Speed straight ahead at constant orders.

    Parameters
    ----------
    orders : sequence of mappings of str to tuple of two floats
        Speed or thrust and direction of each thruster. [rev/s or N, rad]
    model : ShipModel
    changes : mapping of str to float
        What is added to her numbers.
    h : float
        Step. [s]

    Returns
    -------
    list of float
        [m/s]
    """
    length = model.length
    ships = _side_by_side(model, [changes])
    zero = np.zeros((1, len(orders)))
    speed = thresholds.FROUDE * np.sqrt(GRAVITY * length)
    rows = int(thresholds.RUN * length / speed / h) + 2
    units = {
        name: tuple(np.tile([order[name][i] for order in orders], (rows, 1)) for i in (0, 1))
        for name in model.thrusters
    }
    state = Motion(zero, zero, zero, zero + speed, zero, zero)
    *_, last = _way(state, units, ships, rows, h, False)
    return [float(u) for u in last.u[0]]


def steered(
    pilots: Sequence[Callable[[float, float, float], Mapping[str, tuple[float, float]]]],
    start: Sequence[tuple[float, float, float, float]],
    rows: int,
    model: ShipModel,
    changes: Mapping[str, float],
    h: float,
) -> tuple[np.ndarray, ThrusterSeries]:
    """Runs of a ship whose units follow what pilots order.

    Parameters
    ----------
    pilots : sequence of callable
        By run: orders of all thrusters from time [s], heading [rad] and rate of turn [rad/s].
    start : sequence of (float, float, float, float)
        North, east, heading and speed ahead. [m, m, rad, m/s]
    rows : int
    model : ShipModel
    changes : mapping of str to float
        What is added to her numbers.
    h : float
        Step. [s]

    Returns
    -------
    (r, n, 6) array, dict of str to tuple of two (n, r) arrays
        What her instruments show, and the orders of each thruster.
    """
    ships = _side_by_side(model, [changes])
    x, y, psi, u = (np.array([values]) for values in np.array(start).T)
    state = Motion(x, y, psi, u, 0.0 * u, 0.0 * u)
    units = {
        name: (np.zeros((rows, len(pilots))), np.zeros((rows, len(pilots))))
        for name in model.thrusters
    }

    # An order holds until the next one. Units that answer early (a lag below 0) take it from later rows.
    late = np.min(ships.parts["instruments"].order_lag)
    held = 2 + max(0, int(np.ceil(-late / h)))

    def order(k, motion):
        for i, pilot in enumerate(pilots):
            for name, pair in pilot(k * h, float(motion.psi[0, i]), float(motion.r[0, i])).items():
                units[name][0][k : k + held, i], units[name][1][k : k + held, i] = pair

    order(0, state)
    shown = []
    for k, now in enumerate(_way(state, units, ships, rows, h, True)):
        shown.append(_shown(now, ships)[0])
        if k + 1 < rows:
            order(k + 1, now)
    return np.stack(shown, axis=1), units


def _shown(state, ships):
    many = np.shape(state.x)
    return np.stack([np.broadcast_to(value, many) for value in readings(state, ships)], axis=-1)


def _side_by_side(model, changes):
    """One ship model with the numbers of all as arrays over the first axis."""
    paths = {path for change in changes for path in change}
    return model.with_values(
        {
            path: np.array([[model.get(path) + change.get(path, 0.0)] for change in changes])
            for path in paths
        }
    )


def _driven(trial, model):
    """Number of rows to sail, and speed and direction of each thruster there."""
    if trial.kind != "straight run":
        return trial.time.size, trial.units
    speed = np.median(np.hypot(trial.measured[:, 3], trial.measured[:, 4]))
    rows = int(thresholds.RUN * model.length / speed / trial.time[1]) + 2
    return rows, {
        name: tuple(np.full(rows, np.mean(s)) for s in pair) for name, pair in trial.units.items()
    }


def _padded(series, rows):
    """(rows, trials) array of series, each held after its end."""
    return np.stack(
        [
            np.concatenate((of_trial, np.full(rows - of_trial.size, of_trial[-1])))
            for of_trial in series
        ],
        axis=1,
    )


def _at(units, k):
    return {name: (speed[k], direction[k]) for name, (speed, direction) in units.items()}


def _followed(actual, units, k, ships, h):
    """Speed and direction of each unit a step later, which follow their orders. [rev/s or N, rad]"""
    followed = {}
    (count, trials) = next(iter(units.values()))[0].shape
    # Row and share of a row at which orders act after the delay; by ship where this is an array.
    low, share = places(k - ships.parts["instruments"].order_lag / h, count)
    trial = np.arange(trials)

    def late(series):
        return (1.0 - share) * series[low, trial] + share * series[low + 1, trial]

    for name, (speed, direction) in units.items():
        unit = ships.parts[name]
        # Orders after the delay, within the limit of speed.
        wanted = late(speed)
        angle = late(direction)
        if hasattr(unit, "rpm_max"):
            wanted = np.clip(wanted, -unit.rpm_max / 60.0, unit.rpm_max / 60.0)
        # Shaft speed follows with a first-order lag; azimuths turn at their rate.
        n = wanted + (actual[name][0] - wanted) * np.exp(-h / thresholds.RPM_LAG)
        if isinstance(unit, AzimuthParameters) and name not in ships.fixed:
            angle = turned(actual[name][1], angle, unit.azimuth_rate * h)
        followed[name] = (n, angle)
    return followed


def _stepped(state, before, after, ships, h):
    """A Runge-Kutta step of fourth order."""

    def rates(*motion_and_share):
        *motion, share = motion_and_share
        units = {
            name: tuple(
                (1.0 - share) * a + share * b for a, b in zip(pair, after[name], strict=True)
            )
            for name, pair in before.items()
        }
        return motion_rates(Motion(*motion), Inputs(0.0, units, None, None), ships)

    return Motion(*rk4(rates, state, h, ((0.0,), (0.5,), (1.0,))))
