"""A long-crested irregular sea: its elevation, and what it does to a ship (mean and slow drift, first-order motion).

The sea is a sum of components that travel towards `direction`. With the phase angle

    theta_i = omega_i t - k_i (x cos(direction) + y sin(direction)) + phase_i

the elevation, positive upwards, is sum a_i cos(theta_i); the water's horizontal displacement at the surface, positive
towards `direction`, is sum a_i sin(theta_i): below a crest the water moves with the wave. All functions here share this
angle, so that drift and motion of a ship are in phase with the elevation where she is.

beta = direction - psi is the heading relative to the ship: 0 following, 90 deg towards starboard, 180 deg head waves.

Components have the last axis. States of m variations at once have shape (m,); the components are then common to all,
(n,), or each variation has its own, (m, n).
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.interpolation import interp
from shipcosim.models.core.maths import cos, exp, floor, library_of, minimum, pi, sin, sincos, where
from shipcosim.models.core.sampling import generator
from shipcosim.models.core.tables import parse
from shipcosim.models.environment.sinusoids import column, tensors_if_any, total

GRAVITY = 9.81  # m/s2
COMPONENTS = 40
OMEGA_DRIFT_MAX = 2.6  # rad/s; above it the drift coefficients of the panel code have not converged (nominal model)

_RATIO = np.linspace(0.4, 5.0, 4601)  # omega over omega_peak; 0.2 % of the energy lies above, none below
_ALMOST_ZERO = 1e-6


@dataclass(frozen=True, eq=False)
class Waves:
    """Components of a long-crested sea.

    Parameters
    ----------
    amplitude : (n,) or (m, n) array
        Amplitudes a. [m]
    omega : like amplitude
        Circular frequencies seen from a fixed point. [rad/s]
    wavenumber : like amplitude
        k = omega^2 / g (deep water). [rad/m]
    phase : like amplitude
        Phase angle at the origin at t = 0. [rad]
    direction : float or (m,) array
        Where the waves travel to, clockwise from north. [rad]
    calm : bool
        Known to have no height: nothing needs to be computed.
    """

    amplitude: Any
    omega: Any
    wavenumber: Any
    phase: Any
    direction: Any
    calm: bool = False


@dataclass(frozen=True, eq=False)
class DriftTable:
    """Mean drift load per amplitude squared on a grid of heading and frequency.

    Parameters
    ----------
    omega : tuple of float, increasing
        Frequencies. [rad/s]
    heading : tuple of float, increasing from -pi to pi
        Heading beta of the waves relative to the ship. [rad]
    loads : (headings, 3, frequencies) nested tuples
        X, Y, N per amplitude squared. [N/m2, N/m2, N.m/m2]
    """

    omega: tuple
    heading: tuple
    loads: tuple


def jonswap(omega, height, period, peak_enhancement):
    """JONSWAP spectrum of the elevation.

    Parameters
    ----------
    omega : (...) array
        Circular frequency, above 0. [rad/s]
    height : float
        Significant wave height Hs. [m]
    period : float
        Peak period Tp. [s]
    peak_enhancement : float
        gamma; 1 gives the Pierson-Moskowitz (ITTC) spectrum. [1]

    Returns
    -------
    like omega
        S(omega), whose integral is Hs^2/16. [m2.s/rad]

    References
    ----------
    DNV-RP-C205, Environmental conditions and environmental loads, sec. 3.5.5; alpha written with Hs.
    """
    peak = 2.0 * pi / period
    width = np.where(omega <= peak, 0.07, 0.09)
    enhancement = peak_enhancement ** np.exp(-0.5 * ((omega / peak - 1.0) / width) ** 2)
    scale = 5.0 / 16.0 * height**2 * peak**4 * (1.0 - 0.287 * np.log(peak_enhancement))
    return scale * omega**-5.0 * np.exp(-1.25 * (peak / omega) ** 4) * enhancement


def components(height, period, wave_from, peak_enhancement, seed):
    """Components of a JONSWAP sea, the same for the same arguments.

    All have the same energy: the spectrum is cut into `COMPONENTS` bins of equal energy, each component's frequency is
    drawn inside its bin, so that the record does not repeat and 4 sqrt(m0) equals the height exactly. Up to 5 times
    the peak frequency.

    Parameters
    ----------
    height : float or (m,) array or tensor
        Significant wave height Hs, not negative. [m]
    period : float or (m,) array or tensor
        Peak period Tp, above 0 where there is height. [s]
    wave_from : float or (m,) array or tensor
        Where the waves come from, clockwise from north. [rad]
    peak_enhancement : float or (m,) array
        JONSWAP's gamma, 1 to 7. [1]
    seed : int or (m,) array
        Seed of frequencies and phases.

    Returns
    -------
    Waves
        With scalar arguments the arrays are (n,), and the very same object is returned each time.

    Raises
    ------
    ValueError
        For arguments out of their ranges.

    Examples
    --------
    >>> sea = components(0.5, 6.0, 0.0, 3.3, 1)
    >>> round(float(4.0 * np.sqrt(np.sum(sea.amplitude**2 / 2.0))), 12)
    0.5
    """
    arguments = height, period, wave_from, peak_enhancement, seed
    if all(isinstance(argument, (float, int)) for argument in arguments):
        return _scalar_components(*arguments)
    return _components(*arguments)


def elevation(t, x, y, waves):
    """Elevation of the surface, positive upwards.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y : float or (m,) array or tensor
        North and east. [m]
    waves : Waves
        The sea.

    Returns
    -------
    like x
        Elevation. [m]
    """
    if waves.calm:
        return x - x
    waves = _like(waves, x, y)
    return total(waves.amplitude, cos(_angle(t, x, y, waves)))


def wave_response(t, x, y, psi, u, v, waves, table, *, length, breadth, draught):
    """Drift load and first-order motion together, as `drift` and `motion` give them, at the price of one.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y, psi : float or (m,) array or tensor
        Position and heading of the (low-frequency) ship. [m, m, rad]
    u, v : like x
        Her velocity over ground in body axes; it sets the frequency of encounter. [m/s]
    waves : Waves
        The sea.
    table : DriftTable
        Drift coefficients.
    length, breadth, draught : float
        Waterline length and breadth, draught. [m]

    Returns
    -------
    tuple of tuples
        ``(X, Y, N), (x_wave, y_wave, psi_wave, u_wave, v_wave, r_wave)``.
    """
    if waves.calm:
        zero = x - x
        return (zero,) * 3, (zero,) * 6
    waves = _like(waves, x, y, psi)
    s, c = sincos(_angle(t, x, y, waves))
    return (
        _drift(c, s, psi, waves, table),
        _motion(c, s, psi, u, v, waves, length, breadth, draught),
    )


def drift(t, x, y, psi, waves, table):
    """Mean and slowly varying drift load on a ship.

    Newman's approximation with D_ij = (D_ii + D_jj)/2. Then the double sum over components splits into single ones:

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
        The sea.
    table : DriftTable
        Coefficients, interpolated linearly over frequency and heading.

    Returns
    -------
    tuple of three, like x
        X, Y, N. [N, N, N.m]

    References
    ----------
    Newman, Second order, slowly varying forces on vessels in irregular waves, 1974; Faltinsen, Sea Loads on Ships and
    Offshore Structures, Cambridge, 1990, ch. 5.
    """
    if waves.calm:
        return (x - x,) * 3
    waves = _like(waves, x, y, psi)
    s, c = sincos(_angle(t, x, y, waves))
    return _drift(c, s, psi, waves, table)


def mean_drift(psi, waves, table):
    """Mean over time of `drift` on a ship at rest: 2 int S D d(omega), which is sum a_i^2 D_i.

    Parameters
    ----------
    psi : float or (m,) array or tensor
        Heading of the ship. [rad]
    waves : Waves
        The sea.
    table : DriftTable
        Coefficients.

    Returns
    -------
    tuple of three, like psi
        X, Y, N. [N, N, N.m]
    """
    waves = _like(waves, psi)
    return _weighted_drift(waves.amplitude, psi, waves, table)


def motion(t, x, y, psi, waves, *, length, breadth, draught, u=0.0, v=0.0):
    """First-order motion of a ship: the water's horizontal motion averaged over her waterplane and half her draught.

    With q = k L cos(beta)/2, p = k B sin(beta)/2, A = a exp(-k T/2) sin(q)/q sin(p)/p she is displaced along the
    waves' direction by sum A sin(theta), and turned by

        psi_wave = -sum a exp(-k T/2) sin(beta) (6/L) (sin q - q cos q)/q^2 cos(theta)

    which is the line that fits the water's sideways displacement along her length best (least squares). Assumed, grade
    D: no motion transfer functions are at hand. Rates use the frequency of encounter; the ship's rate of turn adds
    nothing to them.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y, psi : float or (m,) array or tensor
        Position and heading of the low-frequency ship. [m, m, rad]
    waves : Waves
        The sea.
    length, breadth, draught : float
        Waterline length L and breadth B, draught T. [m]
    u, v : like x
        Velocity of the low-frequency ship over ground in body axes. [m/s]

    Returns
    -------
    tuple of six, like x
        x_wave, y_wave (north, east), psi_wave, and their rates in body axes u_wave, v_wave, r_wave.
        [m, m, rad, m/s, m/s, rad/s]
    """
    if waves.calm:
        return (x - x,) * 6
    waves = _like(waves, x, y, psi)
    s, c = sincos(_angle(t, x, y, waves))
    return _motion(c, s, psi, u, v, waves, length, breadth, draught)


@lru_cache(maxsize=8)
def drift_table(text):
    """Drift coefficients from their string form.

    Parameters
    ----------
    text : str
        Rows "omega heading X Y N" separated by ";": rad/s; degrees from 0 (following) by 90 (towards starboard) to 180
        (head); force per amplitude squared. A complete grid, in any order. Beyond 180 deg the ship's symmetry rules:
        sway and yaw change sign. Frequencies above `OMEGA_DRIFT_MAX` are discarded.

    Returns
    -------
    DriftTable
        The very same object for the same text.

    Raises
    ------
    ValueError
        Where the table is no complete grid from 0 to 180 deg.
    """
    rows = [row for row in parse(text) if row[0] <= OMEGA_DRIFT_MAX]
    loads = {row[:2]: row[2:] for row in rows if len(row) == 5}
    omegas, headings = (tuple(sorted({key[i] for key in loads})) for i in (0, 1))
    if not rows or not len(rows) == len(loads) == len(omegas) * len(headings):
        raise ValueError("drift table: rows 'omega heading X Y N' must hold every heading at every frequency once")
    if (headings[0], headings[-1]) != (0.0, 180.0):
        raise ValueError(f"drift table: headings from {headings[0]} to {headings[-1]}; must go from 0 to 180 deg")
    starboard = [tuple(zip(*(loads[omega, heading] for omega in omegas), strict=True)) for heading in headings]
    port = [(X, tuple(-Yi for Yi in Y), tuple(-Ni for Ni in N)) for X, Y, N in starboard[:0:-1]]
    circle = [-heading for heading in headings[:0:-1]] + list(headings)
    return DriftTable(omegas, tuple(heading * pi / 180.0 for heading in circle), tuple(port + starboard))


def _components(height, period, wave_from, peak_enhancement, seed):
    _refuse_impossible(height, period, peak_enhancement)
    peak_enhancement, seed = np.broadcast_arrays(np.asarray(peak_enhancement, float), np.asarray(seed))
    pairs = [
        _ratio_and_phase(*pair) for pair in zip(peak_enhancement.ravel().tolist(), seed.ravel().tolist(), strict=True)
    ]
    ratio, phase = (np.array(part).reshape(*seed.shape, COMPONENTS) for part in zip(*pairs, strict=True))
    ratio, phase = tensors_if_any((ratio, phase), height, period, wave_from)
    omega = column(2.0 * pi / period) * ratio
    amplitude = column(height) * ((2.0 / COMPONENTS) ** 0.5 / 4.0) + 0.0 * ratio
    return Waves(amplitude, omega, omega**2 / GRAVITY, phase, wave_from + pi)


@lru_cache(maxsize=32)
def _scalar_components(height, period, wave_from, peak_enhancement, seed):
    if height == 0.0:
        none = np.zeros(COMPONENTS)
        return Waves(none, none, none, none, wave_from + pi, calm=True)
    return _components(float(height), float(period), float(wave_from), peak_enhancement, seed)


def _refuse_impossible(height, period, peak_enhancement):
    for name, value, low, high in (
        ("significant wave height", height, 0.0, None),
        ("peak period of the waves", period, 1e-3, None),
        ("peak enhancement of the waves", peak_enhancement, 1.0, 7.0),
    ):
        value = np.asarray(value.detach() if hasattr(value, "detach") else value)
        if not (np.all(value >= low) and (high is None or np.all(value <= high))):
            raise ValueError(f"{name} is {value}; must be from {low}" + ("" if high is None else f" to {high}"))


@lru_cache(maxsize=1024)
def _ratio_and_phase(peak_enhancement, seed):
    """Frequencies over the peak frequency, and phases: (n,) each."""
    random = generator("waves", seed)
    share = (np.arange(COMPONENTS) + random.random(COMPONENTS)) / COMPONENTS
    return np.interp(share, _cumulative_energy(peak_enhancement), _RATIO), random.uniform(0.0, 2.0 * pi, COMPONENTS)


@lru_cache(maxsize=32)
def _cumulative_energy(peak_enhancement):
    """Share of the energy below each of `_RATIO`, from 0 to 1."""
    density = jonswap(_RATIO, 1.0, 2.0 * pi, peak_enhancement)
    energy = np.concatenate(([0.0], np.cumsum(density[1:] + density[:-1])))
    return energy / energy[-1]


def _angle(t, x, y, waves):
    """Phase angle theta of each component, (..., n)."""
    east, north = sincos(waves.direction)
    travelled = x * north + y * east
    return waves.phase + waves.omega * column(t) - waves.wavenumber * column(travelled)


def _drift(c, s, psi, waves, table):
    beating = c * column(total(waves.amplitude, c)) + s * column(total(waves.amplitude, s))
    return _weighted_drift(beating, psi, waves, table)


def _motion(c, s, psi, u, v, waves, length, breadth, draught):
    across, ahead = sincos(waves.direction - psi)
    some_across, some_ahead = _not_zero(across), _not_zero(ahead)
    half_length, half_breadth, spread, turned = _hull_in(waves, length, breadth, draught)
    q = half_length * column(some_ahead)
    sin_q, cos_q = sincos(q)
    shift, turn = spread * sin_q * sin(half_breadth * column(some_across)), turned * (sin_q - q * cos_q)
    encounter = waves.omega - waves.wavenumber * column(u * ahead + v * across)
    per_shift, per_turn = 1.0 / (some_ahead * some_across), 6.0 / length * across / (some_ahead * some_ahead)
    along, along_dot = per_shift * total(shift, s), per_shift * total(shift, encounter * c)
    psi_wave, r_wave = -per_turn * total(turn, c), per_turn * total(turn, encounter * s)
    east, north = sincos(waves.direction)
    return along * north, along * east, psi_wave, along_dot * ahead, along_dot * across, r_wave


def _hull_in(waves, length, breadth, draught):
    """What stays the same for a hull in a sea: k L/2 and k B/2, and a exp(-k T/2) over their product and over the
    square of the first."""
    if isinstance(waves.omega, np.ndarray) and isinstance(length, float):
        return _cached_hull(waves, length, breadth, draught)
    return _hull(waves, length, breadth, draught)


def _hull(waves, length, breadth, draught):
    k = waves.wavenumber
    half_length, half_breadth = k * column(0.5 * length), k * column(0.5 * breadth)
    amplitude = waves.amplitude * exp(k * column(-0.5 * draught))
    return half_length, half_breadth, amplitude / (half_length * half_breadth), amplitude / half_length**2


_cached_hull = lru_cache(maxsize=8)(_hull)


def _weighted_drift(weights, psi, waves, table):
    """X, Y, N = sum a_i D_i weights_i at this heading."""
    grid = _cached_grid(waves, table) if isinstance(waves.omega, np.ndarray) else _grid(waves, table)
    position = interp(wrap(waves.direction - psi), table.heading, _counted(len(table.heading)))
    below = minimum(floor(position), len(table.heading) - 2.0)
    row, share = _whole(below), position - below
    if isinstance(row, int) and weights.ndim == 1:
        pair = (grid[row : row + 2] @ weights).tolist()
        return tuple([lower + share * (upper - lower) for lower, upper in zip(*pair, strict=True)])
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
    amplitude = where(waves.omega > OMEGA_DRIFT_MAX, 0.0, waves.amplitude)
    return stack([stack([amplitude * interp(waves.omega, table.omega, D) for D in XYN], -2) for XYN in table.loads], 0)


_cached_grid = lru_cache(maxsize=8)(_grid)


@lru_cache(maxsize=8)
def _counted(number):
    return tuple(map(float, range(number)))


def _row(grid, row):
    if grid.ndim == 3 or isinstance(row, int):
        return grid[row]
    return grid[row, np.arange(grid.shape[1])]


def _whole(x):
    if isinstance(x, float):
        return int(x)
    return x.astype(int) if isinstance(x, np.ndarray) else x.long()


def _not_zero(x):
    """x kept away from 0, where sin(x)/x and its like have limits; small enough for them, large enough to divide by."""
    return where(abs(x) < _ALMOST_ZERO, _ALMOST_ZERO, x)


def _like(waves, *values):
    """The same waves as tensors, where one of the values is a tensor."""
    if not isinstance(waves.omega, np.ndarray) or library_of(*values) is np:
        return waves
    arrays = (waves.amplitude, waves.omega, waves.wavenumber, waves.phase, np.asarray(waves.direction))
    return Waves(*tensors_if_any(arrays, *values))
