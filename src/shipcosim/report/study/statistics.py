"""Statistics of the page: distributions, explained variance, Pareto fronts."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pandas import DataFrame

from shipcosim.report.theme.numbers import finite

LEVEL = 0.95
BINS = 10


def distribution(values: ArrayLike) -> tuple[NDArray, NDArray, float]:
    """Empirical distribution: sorted values, share up to each, half width of its 95 % band.

    Parameters
    ----------
    values : (n,) array
        What is infinite or not a number is never reached: it counts below the share, and is left out of the values.

    Returns
    -------
    (array, array, float)

    References
    ----------
    Massart, The tight constant in the Dvoretzky-Kiefer-Wolfowitz inequality, Ann. Probab. 18, 1990.

    Examples
    --------
    >>> reached, share, half = distribution([3.0, 1.0, np.nan, 2.0])
    >>> reached.tolist(), share.tolist(), round(half, 2)
    ([1.0, 2.0, 3.0], [0.25, 0.5, 0.75], 0.68)
    """
    # Dvoretzky-Kiefer-Wolfowitz with Massart's constant: sqrt(ln(2/alpha) / 2n).
    numbers = np.asarray(values, float)
    reached = np.sort(finite(numbers))
    half = float(np.sqrt(np.log(2 / (1 - LEVEL)) / (2 * len(numbers)))) if len(numbers) else 1.0
    return reached, np.arange(1, len(reached) + 1) / max(len(numbers), 1), half


def explained(values: ArrayLike, by: ArrayLike, are_levels: bool) -> float:
    """Share of the variance of one column that another column explains.

    Parameters
    ----------
    values : (n,) array
        Of a quantity.
    by : (n,) array
        Of a factor; ten groups of equal size where it has no levels.
    are_levels : bool

    Returns
    -------
    float
        Epsilon squared, the correlation ratio without its bias. 0 where it is not above two standard deviations of what
        chance alone gives; NaN with too few runs.

    References
    ----------
    Kelley, An unbiased correlation ratio measure, Proc. Natl. Acad. Sci. 21, 1935.

    Examples
    --------
    >>> round(explained(4 * [1.0, 1.1, 5.0, 5.1], 4 * [0.0, 0.0, 1.0, 1.0], True), 3)
    0.999
    """
    # Rows where both are known.
    table = DataFrame({"value": np.asarray(values, float), "cause": np.asarray(by, float)})
    table = table.loc[np.isfinite(table.to_numpy()).all(axis=1)]
    value = table["value"]
    # Groups: levels, or bins by rank, which have equal size whatever the distribution.
    groups = table["cause"]
    if not are_levels:
        bins = min(BINS, max(len(table) // 3, 1))
        groups = (groups.rank(method="first") - 1) * bins // len(table)
    count = groups.nunique()
    left = len(table) - count
    # Too few runs or groups: no statement.
    if count < 2 or left < 2 or not np.ptp(value.to_numpy()):
        return float("nan")
    # Variance within groups over total variance, both with their degrees of freedom.
    within = np.square(value - value.groupby(groups).transform("mean")).sum() / left
    share = 1.0 - within / value.var()
    # Less than two standard deviations of chance counts as nothing.
    by_chance = 2.0 * np.sqrt(2.0 * (count - 1)) / (len(table) - 1)
    return float(share) if share > by_chance else 0.0


def pareto_front(quantities: Sequence[ArrayLike]) -> NDArray:
    """True for points on the Pareto front: no other is as low in all quantities and lower in one.

    Parameters
    ----------
    quantities : sequence of (n,) array
        Less is better.

    Returns
    -------
    (n,) array of bool
        False where a quantity is not known.

    Examples
    --------
    >>> pareto_front([[1.0, 2.0, 2.0, 3.0], [3.0, 2.0, 3.0, 1.0]]).tolist()
    [True, True, False, True]
    """
    # Points with an unknown quantity cannot be compared.
    points = np.column_stack([np.asarray(quantity, float) for quantity in quantities])
    front = np.zeros(len(points), bool)
    rows = np.flatnonzero(np.isfinite(points).all(axis=1))
    best = np.empty((0, points.shape[1]))
    # In lexicographic order a point can only be beaten by earlier ones.
    for row in rows[np.lexsort(points[rows].T[::-1])]:
        beaten = ((best <= points[row]).all(axis=1) & (best < points[row]).any(axis=1)).any()
        if not beaten:
            front[row] = True
            best = np.vstack([best, points[row]])
    return front
