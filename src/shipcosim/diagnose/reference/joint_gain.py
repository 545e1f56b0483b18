"""The entries `baseline` and `gain` of a joint diagnosis: over all logs, each by what the other logs say."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from shipcosim.diagnose.reference.log_errors import LogErrors
from shipcosim.diagnose.validation.gain import gain_entry, resampled_sums, roots, share_explained


def joint_baseline(errors: Mapping[str, LogErrors]) -> dict[str, list[float]] | None:
    """Errors of the system as it is: root mean square over the logs, each log alike.

    Parameters
    ----------
    errors : dict of str to LogErrors
        By log, all over the same times.

    Returns
    -------
    dict or None
        Horizons [s] with the errors after each, position [m] and heading [deg]; None without errors.
    """
    if not errors:
        return None
    each = list(errors.values())
    return {
        "horizon_s": list(each[0].horizon),
        "position_error_m": _over_logs([log.position["before"] for log in each]),
        "heading_error_deg": _over_logs([log.heading["before"] for log in each]),
    }


def _over_logs(values: list[tuple[float, ...]]) -> list[float]:
    return [float(value) for value in np.sqrt(np.nanmean(np.square(values), axis=0))]


def joint_gain(errors: Mapping[str, LogErrors]) -> dict[str, Any] | None:
    """Position errors at the longest horizon, before and after: root mean square over the logs, each log alike.

    Only logs count whose causes are sized by other logs. The noise floor is that of the ship whose every number is
    fitted to all logs, in array form. The interval is of draws of the predictions within each log.

    Parameters
    ----------
    errors : dict of str to LogErrors
        By log, all over the same times.

    Returns
    -------
    dict or None
        As the gain of one log, `logs` besides; ``bias_observer_m`` is None: these predictions have no observer. None
        where nothing in the ship is named, or no other log says how large it is.
    """
    judged = {
        name: error
        for name, error in errors.items()
        if error.fitted_on and error.misses is not None
    }
    # Predictions at whose end the log has a position.
    squares = {
        name: log.misses[:, np.isfinite(log.misses).all(axis=0)] ** 2
        for name, log in judged.items()
        if log.misses is not None
    }
    squares = {name: of for name, of in squares.items() if of.size}
    if not squares:
        return None
    # Mean squares with equal weight for each log.
    before, after, floor = roots(np.mean([of.mean(axis=1) for of in squares.values()], axis=0))
    # Bootstrap: draw predictions within each log with replacement, for the interval of the share.
    rng = np.random.default_rng(1)
    drawn = roots(
        np.mean([resampled_sums(of, rng) / of.shape[1] for of in squares.values()], axis=0)
    )
    horizon = float(next(iter(judged.values())).horizon[-1])
    entry = gain_entry(horizon, (before, after, floor), share_explained(*drawn))
    return entry | {"logs": list(squares)}
