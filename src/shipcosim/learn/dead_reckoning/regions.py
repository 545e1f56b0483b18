"""Position regions by time since the loss of GNSS, calibrated in worlds of their own."""

import numpy as np

from shipcosim.learn.regions import conformal

TIMES = tuple(range(0, 61, 5))  # s
SEA_SHARES = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0)  # s/m, tried


def calibrated(lost_for: np.ndarray, sea: np.ndarray, error: np.ndarray) -> dict[str, np.ndarray]:
    """Calibrate a region that contains the true position in nine of ten cases at each time.

    Parameters
    ----------
    lost_for, sea, error : (n,) array
        Time since the loss, variance of the sea, distance of the reckoned from the true place. [s, m2/s2, m]

    Returns
    -------
    dict of str to array
        ``region.times``, ``region.radii``, ``region.sea_share``. [s, m, s/m]

    Notes
    -----
    Split conformal prediction at each time, over errors divided by 1 + share times the root of the sea's variance; the
    share is the one with the smallest mean radius. Radii never fall with time.
    """
    # Choose how much the sea widens the region: the share with the smallest mean radius.
    tried = []
    for share in SEA_SHARES:
        # Radii never fall with time, though their samples scatter.
        radii = np.maximum.accumulate(_radii(lost_for, sea, error, share))
        sizes = np.interp(lost_for, TIMES, radii) * (1.0 + share * np.sqrt(sea))
        tried.append((float(np.mean(sizes)), share, radii))
    _, share, radii = min(tried, key=lambda attempt: attempt[:2])
    return {
        "region.times": np.array(TIMES, dtype=float),
        "region.radii": radii,
        "region.sea_share": np.array(share),
    }


def _radii(lost_for, sea, error, share):
    """Quantile of the scaled errors within 2.5 s of each time."""
    # Scaled errors: the sea widens all radii by the same factor.
    scaled = error / (1.0 + share * np.sqrt(sea))
    radii = []
    for time in TIMES:
        # Conformal quantile, rank ceil(0.9 (n + 1)): it covers 90 % of new cases.
        radii.append(conformal(scaled[abs(lost_for - time) < 2.5], more=1))
    return np.array(radii)
