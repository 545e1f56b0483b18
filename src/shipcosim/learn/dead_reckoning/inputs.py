"""Mutual information of measurements with a velocity, by distances to nearest neighbours."""

import numpy as np

from shipcosim.learn.dead_reckoning.worlds import Record
from shipcosim.models.prediction.velocity_network import FEATURES, HISTORY, UNITS

NEIGHBOURS = 3
MOST = 1500
"""Neighbours that count, and the most samples that are taken, evenly spaced."""
OF_AXIS = {
    "surge": ("heading", "wind angle", "wind speed", "main power", "main command", "main action"),
    "sway": ("heading", "wind angle", "wind speed")
    + tuple(
        f"{place} {what}" for place in ("bow", "stern") for what in ("power", "command", "action")
    ),
}
"""What paper II considers of each velocity, Table III."""


def mutual_information(x: np.ndarray, y: np.ndarray) -> float:
    """Mutual information of two signals.

    Parameters
    ----------
    x, y : (n,) array
        Signals, of any units.

    Returns
    -------
    float
        In nats, 0 or more. [1]

    References
    ----------
    Kraskov, Stögbauer, Grassberger, Estimating mutual information, Physical Review E 69, 2004, first estimator. Paper
    II uses another one, by density ratios.
    """
    # At most MOST samples, evenly spaced: the distance
    # matrices grow with the square of their number.
    rng = np.random.default_rng(1)
    taken = slice(None, None, max(1, -(-len(x) // MOST)))
    spread = [signal[taken] / (signal.std() or 1.0) for signal in (x, y)]
    # Distances within each signal. Tiny noise separates equal values, which the estimator excludes.
    apart = [
        abs(signal[:, None] - signal[None])
        for signal in (v + 1e-8 * rng.normal(size=v.shape) for v in spread)
    ]
    # Distance to the k-th neighbour in the joint space, in the maximum norm (Kraskov et al.).
    farther = np.maximum(*apart)
    np.fill_diagonal(farther, np.inf)
    radius = np.partition(farther, NEIGHBOURS - 1, axis=1)[:, NEIGHBOURS - 1]
    # Number of samples closer than that in each signal alone, n_x + 1 and n_y + 1.
    near = [(distances < radius[:, None]).sum(axis=1) for distances in apart]  # itself among them
    # I = psi(k) + psi(n) - <psi(n_x + 1) + psi(n_y + 1)>; noise may make it slightly negative.
    n = len(radius)
    return max(
        0.0, float(_digamma(NEIGHBOURS) + _digamma(n) - sum(np.mean(_digamma(k)) for k in near))
    )


def _digamma(n):
    """Digamma function of whole numbers: psi(n) = H(n-1) - gamma."""
    sums = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, MOST + 1))])
    return sums[np.asarray(n) - 1] - np.euler_gamma


def table(record: Record, features: np.ndarray) -> dict[str, dict[str, float]]:
    """Table III: mutual information of each input with each velocity a second later, scaled to 0 to 1.

    Parameters
    ----------
    record : Record
        Of (worlds, n) arrays.
    features : (worlds, n, 9) array
        Of `velocity_network.FEATURES`.

    Returns
    -------
    dict of str to dict of str to float
        By velocity and input: the mean over the history, less the least of all inputs, over the largest. [1]
    """
    # All signals that Table III names: features of the networks, and requests to the thrusters.
    m = record.measured
    signals = {name: features[..., number] for number, name in enumerate(FEATURES)}
    for place, unit in zip(("bow", "stern", "main"), UNITS, strict=True):
        signals[f"{place} command"] = m[f"asked_{unit + 1}"]
    scaled = {}
    # Mean information over the shortest, middle and longest lag that a network sees.
    for axis, velocity in (("surge", m["u"]), ("sway", m["v"])):
        later = velocity[:, HISTORY:].ravel()
        lagged = {
            name: np.mean(
                [
                    mutual_information(signals[name][:, HISTORY - lag : -lag].ravel(), later)
                    for lag in (1, HISTORY // 2, HISTORY)
                ]
            )
            for name in OF_AXIS[axis]
        }
        # Scale to 0 to 1 over the inputs of this axis, as the table has it.
        least = min(lagged.values())
        most = max(lagged.values())
        scaled[axis] = {
            name: float((information - least) / (most - least))
            for name, information in lagged.items()
        }
    return scaled
