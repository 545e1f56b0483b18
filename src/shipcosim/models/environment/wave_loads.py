"""Mean and slowly varying wave drift loads on a ship.

beta = direction - psi is the heading of the waves relative to the ship: 0 following, 90 deg towards starboard, 180 deg
head waves. Loads are sums over the components of the sea of `waves`, at its phase angles.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.interpolation import interp
from shipcosim.models.core.maths import (
    Arithmetic,
    floor,
    library_of,
    minimum,
    pi,
    row_of,
    sincos,
    where,
)
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.motion import Load
from shipcosim.models.core.tables import parse
from shipcosim.models.environment.sinusoids import column, total
from shipcosim.models.environment.waves import Waves, phase_angle, waves_like

OMEGA_DRIFT_MAX = 2.6  # rad/s; above it the drift coefficients of the panel code have not converged (nominal model)


@dataclass(frozen=True, eq=False)
class DriftTable:
    """Coefficients of mean wave drift: load per squared amplitude by heading and frequency.

    Parameters
    ----------
    omega : (n,) tuple of float, increasing
        Frequencies. [rad/s]
    heading : (n,) tuple of float, increasing from -pi to pi
        Heading beta of the waves relative to the ship. [rad]
    loads : (headings, 3, frequencies) nested tuples
        X, Y, N per amplitude squared. [N/m2, N/m2, N.m/m2]
    """

    omega: tuple[float, ...]
    heading: tuple[float, ...]
    loads: tuple


@lru_cache(maxsize=8)
def drift_table(text: str) -> DriftTable:
    """Drift coefficients of a parameter set, parsed once per text.

    Parameters
    ----------
    text : str
        Rows "omega heading X Y N" separated by ";": rad/s; degrees from 0 (following) by 90 (towards starboard) to 180
        (head); load per squared amplitude. A complete grid, in any order. Headings beyond 180 deg follow from the
        symmetry of the ship: sway and yaw change sign. Frequencies above `OMEGA_DRIFT_MAX` are discarded.
        [rad/s, deg, N/m2, N/m2, N.m/m2]

    Returns
    -------
    DriftTable
        Coefficients, the identical object for the same text. [rad/s, rad, N/m2, N/m2, N.m/m2]

    Raises
    ------
    ValueError
        The table is no complete grid of headings from 0 to 180 deg.

    References
    ----------
    Nominal model, waves: sense of the headings, symmetry, omitted frequencies.
    """
    # Frequencies beyond the converged range are left out.
    rows = [row for row in parse(text) if row[0] <= OMEGA_DRIFT_MAX]
    loads = {row[:2]: row[2:] for row in rows if len(row) == 5}
    omegas, headings = (tuple(sorted({key[i] for key in loads})) for i in (0, 1))
    # Interpolation needs a complete grid.
    if not rows or not len(rows) == len(loads) == len(omegas) * len(headings):
        raise ValueError(
            "drift table: rows 'omega heading X Y N' must hold every heading at every frequency once"
        )
    if (headings[0], headings[-1]) != (0.0, 180.0):
        raise ValueError(
            f"drift table: headings from {headings[0]} to {headings[-1]}; must go from 0 to 180 deg"
        )
    # Measured headings are on the starboard side; those to port follow by symmetry: X equal, Y and
    # N with the other sign.
    starboard = [
        tuple(zip(*(loads[omega, heading] for omega in omegas), strict=True))
        for heading in headings
    ]
    port = [(X, tuple(-Yi for Yi in Y), tuple(-Ni for Ni in N)) for X, Y, N in starboard[:0:-1]]
    # Headings from -180 to 180 degrees; 0 and 180 exist once.
    circle = [-heading for heading in headings[:0:-1]] + list(headings)
    return DriftTable(
        omegas, tuple(heading * pi / 180.0 for heading in circle), tuple(port + starboard)
    )


def drift(
    t: Arithmetic, x: Arithmetic, y: Arithmetic, psi: Arithmetic, waves: Waves, table: DriftTable
) -> Load:
    """Mean and slowly varying wave drift load on a ship.

    Newman's approximation with D_ij = (D_ii + D_jj)/2. The double sum over components then separates into single sums:

        X = sum_ij a_i a_j D_ij cos(theta_i - theta_j) = sum_i a_i D_i (cos(theta_i) C + sin(theta_i) S)
        C = sum_j a_j cos(theta_j),  S = sum_j a_j sin(theta_j)

    The arithmetic mean is used because the geometric one fails where a coefficient changes sign with frequency.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y, psi : float or (m,) array or tensor
        Position and heading of the ship. [m, m, rad]
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]
    table : DriftTable
        Coefficients, interpolated linearly over frequency and heading. [N/m2, N/m2, N.m/m2]

    Returns
    -------
    tuple of three, like x
        X, Y, N. [N, N, N.m]

    References
    ----------
    Newman, Second order, slowly varying forces on vessels in irregular waves, 1974; Faltinsen, Sea Loads on Ships and
    Offshore Structures, Cambridge, 1990, ch. 5.
    """
    # In calm water zero in the arithmetic of x.
    if waves.calm:
        return (x - x,) * 3
    waves = waves_like(waves, x, y, psi)
    # Cosine and sine of the phase angles serve both loads and motions.
    s, c = sincos(phase_angle(t, x, y, waves))
    return drift_at(c, s, psi, waves, table)


def drift_at(
    c: Arithmetic, s: Arithmetic, psi: Arithmetic, waves: Waves, table: DriftTable
) -> Load:
    """`drift` at known phase angles.

    Parameters
    ----------
    c, s : (n,) or (m, n) array or tensor
        Cosine and sine of the phase angles. [1]
    psi : float or (m,) array or tensor
        Heading of the ship. [rad]
    waves : Waves
        The sea, in the arithmetic of the others. [m, rad/s, rad/m, rad]
    table : DriftTable
        Coefficients. [N/m2, N/m2, N.m/m2]

    Returns
    -------
    tuple of three, like psi
        X, Y, N. [N, N, N.m]

    References
    ----------
    As `drift`.
    """
    # Newman's double sum as single sums: cos θ_i C + sin θ_i S, see `drift`.
    beating = c * column(total(waves.amplitude, c)) + s * column(total(waves.amplitude, s))
    return _weighted_drift(beating, psi, waves, table)


def mean_drift(psi: Arithmetic, waves: Waves, table: DriftTable) -> Load:
    """Time mean of `drift` on a ship at rest: 2 ∫ S D dω = Σ a_i² D_i.

    Parameters
    ----------
    psi : float or (m,) array or tensor
        Heading of the ship. [rad]
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]
    table : DriftTable
        Coefficients. [N/m2, N/m2, N.m/m2]

    Returns
    -------
    tuple of three, like psi
        X, Y, N. [N, N, N.m]

    References
    ----------
    Faltinsen, Sea Loads on Ships and Offshore Structures, Cambridge, 1990, ch. 5.
    """
    # The mean keeps only i = j of the double sum: the weight is the amplitude itself.
    waves = waves_like(waves, psi)
    return _weighted_drift(waves.amplitude, psi, waves, table)


def _weighted_drift(weights, psi, waves, table):
    """X, Y, N = Σ a_i D_i w_i at this heading of the ship."""
    # a_i D_i at all headings depends on sea and table only, so it is cached.
    grid = _kept_grid(waves, table) if isinstance(waves.omega, np.ndarray) else _grid(waves, table)
    # Position between the table's headings, at the relative wave direction.
    position = interp(wrap(waves.direction - psi), table.heading, _counted(len(table.heading)))
    below = minimum(floor(position), len(table.heading) - 2.0)
    row = _whole(below)
    share = position - below
    # One ship in floats: two rows and a product, without overhead.
    if isinstance(row, int) and weights.ndim == 1:
        pair = (grid[row : row + 2] @ weights).tolist()
        return tuple([lower + share * (upper - lower) for lower, upper in zip(*pair, strict=True)])
    # Many variations: interpolate between the rows of each.
    lower, upper = (_summed(_row(grid, number), weights) for number in (row, row + 1))
    loads = lower + column(share) * (upper - lower)
    return loads[..., 0], loads[..., 1], loads[..., 2]


def _summed(rows, weights):
    """Sum of (..., 3, n) rows times (..., n) weights over the components."""
    if isinstance(rows, np.ndarray):
        return np.einsum("...kn,...n->...k", rows, weights)
    return (rows @ weights[..., None])[..., 0]


def _grid(waves, table):
    """a_i D_i at each heading of the table, (headings, ..., 3, n)."""
    stack = library_of(waves.omega).stack
    # Components above the converged range give no drift.
    amplitude = where(waves.omega > OMEGA_DRIFT_MAX, 0.0, waves.amplitude)
    return stack(
        [
            stack([amplitude * interp(waves.omega, table.omega, D) for D in XYN], -2)
            for XYN in table.loads
        ],
        0,
    )


_kept_grid = kept(8)(_grid)


@lru_cache(maxsize=8)
def _counted(number):
    """0.0, 1.0, ... as abscissae of a table's rows."""
    return tuple(map(float, range(number)))


def _row(grid, row):
    """Row of a grid, which may differ between variations."""
    if grid.ndim == 3 or isinstance(row, int):
        return row_of(grid, row)
    return grid[row, np.arange(grid.shape[1])]


def _whole(x):
    """A whole number as index."""
    if isinstance(x, float):
        return int(x)
    return x.astype(int) if hasattr(x, "astype") else x.long()
