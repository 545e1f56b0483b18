"""Our motion filter: the ship's equations of motion, learned through outages in her records.

The cost is the position error in each second of an outage. The records are drills: GNSS is
masked for a minute, DP uses dead reckoning, and a second receiver is logged. Records with GNSS
are unsuitable: there DP answers each disturbance, so thrust follows loads that the filter does
not know, and the estimated thrust is too small.
The gradient also passes the filter before the loss, so observer and model are learned together.
There are few parameters: Levenberg-Marquardt with finite differences, all changes in one call,
needs no torch.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from shipcosim.learn.dead_reckoning.worlds import Record
from shipcosim.learn.training import Epochs, Progress
from shipcosim.models.prediction import motion_filter
from shipcosim.models.prediction.motion_filter import FilterNumbers
from shipcosim.models.prediction.outage import Measured

MASS_SURGE, MASS_SWAY = (
    10.18e6 + 1.857e6,
    10.18e6 + 7.068e6,
)  # kg, with added mass
KNOWN = {
    "bow": 176e3 / 204.0**2 / MASS_SWAY,
    "stern": 124e3 / 276.0**2 / MASS_SWAY,
    "ahead": 378e3 / 28.7**2 / MASS_SURGE,
    "astern": 245.7e3 / 21.5**2 / MASS_SURGE,
    "surge_time": MASS_SURGE / 3.0e5,
    "sway_time": MASS_SWAY / 5.5e5,
    "wind_surge_1": -169.0 / MASS_SURGE,
    "wind_surge_3": 9.8 / MASS_SURGE,
    "wind_sway_1": -581.0 / MASS_SWAY,
    "wind_sway_3": -31.0 / MASS_SWAY,
}
"""The model of ssp/ships/osv (a test holds that): numbers of a filter without learning."""
GAINS = {
    "position_by_position": 0.06,
    "position_by_velocity": 0.2,
    "velocity_by_position": 0.002,
    "velocity_by_velocity": 0.06,
    "load_by_position": 1e-5,
    "load_by_velocity": 5e-4,
    "position_in_sea": 1.0,
    "velocity_in_sea": 1.0,
    "load_in_sea": 1.0,
    "load_time": 100.0,
    "mean_time": 200.0,
}
"""Gains at the start: chosen by hand, for poles at some 5 to 60 s."""
SIGNED = ("wind_surge_1", "wind_surge_3", "wind_sway_1", "wind_sway_3")
"""Numbers that may change their sign; the others are learned as logarithms."""
WEIGHT = {**dict.fromkeys(KNOWN, 0.3), **dict.fromkeys(GAINS, 1.5)}
"""Standard deviation of a number's logarithm about its start value. Assumed."""


def measured_at(record: Record, k: int, valid: np.ndarray) -> Measured:
    """Measurements aboard at one sample.

    Parameters
    ----------
    record : Record
        Of (worlds, n) arrays.
    k : int
        Sample. [1]
    valid : (worlds, n) array
        1 where GNSS works. [1]

    Returns
    -------
    Measured
        Of (worlds,) arrays.
    """
    now = {name: values[:, k] for name, values in record.measured.items()}
    return Measured(
        x=now["x"],
        y=now["y"],
        u=now["u"],
        v=now["v"],
        valid=valid[:, k],
        psi=now["psi"],
        wind_speed=now["wind_speed"],
        wind_from=now["wind_from"],
        commands=tuple(now[f"command_{number}"] for number in range(1, 7)),
    )


def reckoned(record: Record, law: Any, design: Any, valid: np.ndarray | None = None) -> list:
    """States of a predictor over records, sample by sample.

    Parameters
    ----------
    record : Record
        Of (worlds, n) arrays.
    law : module
        With `start` and `step`: `motion_filter` or `velocity_network`.
    design : FilterNumbers
        Of that law; of the filter also with (m, 1) arrays for m designs at once.
    valid : (worlds, n) array, optional
        1 where GNSS works, else as recorded. [1]

    Returns
    -------
    list of State
        Of (worlds,) or (m, worlds) arrays.
    """
    valid = record.measured["valid"] if valid is None else valid
    states = [law.start(measured_at(record, 0, valid), design=design)]
    for k in range(1, record.x.shape[1]):
        states.append(law.step(states[-1], measured_at(record, k, valid), 1.0, design=design))
    return states


def design_of(change: np.ndarray) -> FilterNumbers:
    """Parameters of the filter from their changes since the start.

    Parameters
    ----------
    change : (..., n) array
        Logarithms of factors, or shares to be added of those in `SIGNED`. [1]

    Returns
    -------
    FilterNumbers
        Of (...) arrays.
    """
    numbers = {}
    for position, name in enumerate(FilterNumbers._fields):
        # Parameters that may change sign move linearly; all others by
        # a factor exp(change), so they stay positive.
        moved = change[..., position]
        at_start = (KNOWN | GAINS)[name]
        numbers[name] = (
            at_start + moved * abs(at_start) if name in SIGNED else at_start * np.exp(moved)
        )
    return FilterNumbers(**numbers)


def residuals(record: Record, change: np.ndarray) -> np.ndarray:
    """Position errors in the outages, and changes of the parameters, as residuals.

    Parameters
    ----------
    record : Record
        To learn from: drills, in all worlds at the same times.
    change : (m, n) array
        As `design_of`, several at once. [1]

    Returns
    -------
    (m, k) array
        Errors north and east, compressed beyond some metres, over the root of how many there are, then the changes
        over their standard deviations. [m, 1]
    """
    # Run the filter for all sets of parameters at once.
    design = design_of(change[..., None, :])
    m = record.measured
    errors = []
    for k, state in enumerate(reckoned(record, motion_filter, design)):
        # Only seconds without GNSS count, measured by the second receiver, which DP does not see.
        if m["valid"][0, k] < 0.5:
            north = state.x - m["second_x"][:, k]
            east = state.y - m["second_y"][:, k]
            # Weight so that the squared residual grows as the
            # distance: large errors do not dominate.
            shrunk = (
                1.0 + (north * north + east * east) / ROBUST**2
            ) ** -0.25  # the cost grows as the distance
            errors += [shrunk * north, shrunk * east]
    # Prior: each parameter stays near its start by its assumed standard deviation.
    position_errors = np.concatenate(errors, axis=1)
    spread = np.array([WEIGHT[name] for name in FilterNumbers._fields])
    return np.concatenate(
        [position_errors / np.sqrt(position_errors.shape[1] / 2), PRIOR * change / spread], axis=1
    )


ROBUST = 1.0  # m; 1, assumed: 400 outages worth of metres against one prior
PRIOR = 0.05


def fitted(
    record: Record, progress: Progress, iterations: int = 20
) -> tuple[FilterNumbers, Epochs]:
    """Numbers of the filter learned from records.

    Parameters
    ----------
    record : Record
        To learn from.
    progress : callable
        Called with how many iterations are done, and of how many.
    iterations : int
        At most.

    Returns
    -------
    tuple of FilterNumbers and list of dict
        The numbers, and the cost at each iteration.

    References
    ----------
    Marquardt, An algorithm for least-squares estimation of nonlinear parameters, J. SIAM 11, 1963.
    """
    return _descended(
        lambda change: residuals(record, change), len(FilterNumbers._fields), progress, iterations
    )


def _descended(
    of: Callable[[np.ndarray], np.ndarray], size: int, progress: Progress, iterations: int
) -> tuple[FilterNumbers, Epochs]:
    """Levenberg-Marquardt with finite differences, all in one call."""
    change = np.zeros(size)
    damping = 1e-2
    history = []
    for number in range(1, iterations + 1):
        # Residuals at the present point and at one small change of each parameter: the Jacobian.
        values = of(np.concatenate([change[None], change + 1e-4 * np.eye(size)]))
        now = values[0]
        slopes = (values[1:] - values[0]) / 1e-4
        # Cost and normal equations of Gauss-Newton: J^T J and J^T r.
        cost = float(now @ now)
        gradient = slopes @ now
        normal = slopes @ slopes.T
        history.append({"cost": cost})
        # Try five dampings at once, scaled by the diagonal as Marquardt does.
        dampings = damping * np.array([0.1, 1.0, 10.0, 100.0, 1000.0])
        steps = [
            np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient)
            for damping in dampings
        ]
        # Limit a change to a factor e^4: beyond that the filter is far from any ship.
        tried = np.clip(change - np.array(steps), -4.0, 4.0)
        costs = (of(tried) ** 2).sum(axis=1)
        # Keep the best trial; stop when it lowers the cost by less than 1e-4.
        best = int(np.argmin(costs))
        progress(number, iterations)
        if not costs[best] < cost * (1.0 - 1e-4):
            break
        change = tried[best]
        damping = float(np.clip(dampings[best], 1e-6, 1e3))
    progress(iterations, iterations)
    return design_of(change), history
