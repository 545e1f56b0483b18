"""A long-crested irregular sea after the JONSWAP spectrum: components, elevation, phase angles.

The sea is a sum of components that travel towards `direction`. With the phase angle

    theta_i = omega_i t - k_i (x cos(direction) + y sin(direction)) + phase_i

the elevation, positive upwards, is sum a_i cos(theta_i); the water's horizontal displacement at the surface, positive
towards `direction`, is sum a_i sin(theta_i): below a crest the water moves with the wave. Drift loads (`wave_loads`)
and first-order motion (`wave_motion`) of a ship use the same angle, so that they are in phase with the elevation at
the ship.

Components have the last axis. States of m variations at once have shape (m,); the components are then common to all,
(n,), or each variation has its own, (m, n).
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.maths import Arithmetic, cos, is_single, library_of, pi, sincos
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.sampling import generator
from shipcosim.models.environment.sinusoids import column, tensors_if_any, total

COMPONENTS = 40

_RATIO = np.linspace(
    0.4, 5.0, 4601
)  # omega over omega_peak; 0.2 % of the energy lies above, none below


@dataclass(frozen=True, eq=False)
class Waves:
    """Components of a long-crested irregular sea.

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
        Direction the waves travel to, clockwise from north. [rad]
    calm : bool
        True where the significant wave height is 0: all loads and motions are then 0 without being computed. [1]
    """

    amplitude: Arithmetic
    omega: Arithmetic
    wavenumber: Arithmetic
    phase: Arithmetic
    direction: Arithmetic
    calm: bool = False


def jonswap(omega: Arithmetic, height: float, period: float, peak_enhancement: float) -> Arithmetic:
    """JONSWAP spectrum of the surface elevation.

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
    # JONSWAP: Pierson-Moskowitz times γ^exp(-(ω/ω_p - 1)² / 2σ²), narrower below the peak.
    peak = 2.0 * pi / period
    width = np.where(omega <= peak, 0.07, 0.09)
    enhancement = peak_enhancement ** np.exp(-0.5 * ((omega / peak - 1.0) / width) ** 2)
    # Normalised by 1 - 0.287 ln γ, so that Hs stays the same for any γ.
    scale = 5.0 / 16.0 * height**2 * peak**4 * (1.0 - 0.287 * np.log(peak_enhancement))
    return scale * omega**-5.0 * np.exp(-1.25 * (peak / omega) ** 4) * enhancement


def components(
    height: Arithmetic,
    period: Arithmetic,
    wave_from: Arithmetic,
    peak_enhancement: Arithmetic,
    seed: int | np.ndarray,
) -> Waves:
    """Components of a JONSWAP sea; the same arguments give the same components.

    The spectrum up to 5 times the peak frequency is cut into `COMPONENTS` bins of equal energy. Each component has the
    energy of its bin and a frequency drawn at random inside it, so that the record does not repeat itself and
    4 sqrt(m0) equals the significant wave height exactly.

    Parameters
    ----------
    height : float or (m,) array or tensor
        Significant wave height Hs, not negative. [m]
    period : float or (m,) array or tensor
        Peak period Tp, above 0 where there is height. [s]
    wave_from : float or (m,) array or tensor
        Direction the waves come from, clockwise from north. [rad]
    peak_enhancement : float or (m,) array
        gamma of the JONSWAP spectrum, 1 to 7. [1]
    seed : int or (m,) array
        Seed of frequencies and phases, not negative. [1]

    Returns
    -------
    Waves
        Its arrays are (n,) for scalar arguments, which give the identical object each time. [m, rad/s, rad/m, rad]

    Raises
    ------
    ValueError
        Height, period, peak enhancement or seed are out of their range.

    References
    ----------
    Nominal model, waves: equal-energy bins with random frequencies and phases.

    Examples
    --------
    >>> sea = components(0.5, 6.0, 0.0, 3.3, 1)
    >>> round(float(4.0 * np.sqrt(np.sum(sea.amplitude**2 / 2.0))), 12)
    0.5
    """
    # Scalar seas are cached; the same arguments give the identical object.
    arguments: Any = (height, period, wave_from, peak_enhancement, seed)
    if all(map(is_single, arguments)):
        return _scalar_components(*arguments)
    return _components(*arguments)


def elevation(t: Arithmetic, x: Arithmetic, y: Arithmetic, waves: Waves) -> Arithmetic:
    """Elevation of the sea surface at a point, positive upwards.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y : float or (m,) array or tensor
        Position north and east. [m]
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]

    Returns
    -------
    like x
        Elevation. [m]

    References
    ----------
    Definition of the sum of components, see the module.
    """
    # In calm water zero in the arithmetic of x.
    if waves.calm:
        return x - x
    waves = waves_like(waves, x, y)
    return total(waves.amplitude, cos(phase_angle(t, x, y, waves)))


def phase_angle(t: Arithmetic, x: Arithmetic, y: Arithmetic, waves: Waves) -> Arithmetic:
    """Phase angle theta of each component at a point.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y : float or (m,) array or tensor
        Position north and east. [m]
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]

    Returns
    -------
    (n,) or (m, n) array or tensor
        Phase angles. [rad]

    References
    ----------
    Deep water dispersion: DNV-RP-C205, Environmental conditions and environmental loads.
    """
    # θ = ω t - k (distance travelled along the direction) + phase.
    east, north = sincos(waves.direction)
    travelled = x * north + y * east
    return waves.phase + waves.omega * column(t) - waves.wavenumber * column(travelled)


def waves_like(waves: Waves, *values: Arithmetic) -> Waves:
    """The sea in the arithmetic of some values: as tensors if one of them is a tensor.

    Parameters
    ----------
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]
    values : float or (m,) array or tensor
        Values that the sea will be combined with. [any units]

    Returns
    -------
    Waves
        The same sea. [m, rad/s, rad/m, rad]

    References
    ----------
    Definition.
    """
    if not isinstance(waves.omega, np.ndarray) or not hasattr(library_of(*values), "Tensor"):
        return waves
    arrays = (
        waves.amplitude,
        waves.omega,
        waves.wavenumber,
        waves.phase,
        np.asarray(waves.direction),
    )
    return Waves(*tensors_if_any(arrays, *values))


def _components(height, period, wave_from, peak_enhancement, seed):
    _refuse_impossible(height, period, peak_enhancement)
    # One draw per variation; equal pairs of γ and seed are drawn once.
    peak_enhancement, seed = np.broadcast_arrays(
        np.asarray(peak_enhancement, float), np.asarray(seed)
    )
    pairs = [
        _ratio_and_phase(*pair)
        for pair in zip(peak_enhancement.ravel().tolist(), seed.ravel().tolist(), strict=True)
    ]
    ratio, phase = (
        np.array(part).reshape(*seed.shape, COMPONENTS) for part in zip(*pairs, strict=True)
    )
    ratio, phase = tensors_if_any((ratio, phase), height, period, wave_from)
    # Frequencies scale with the peak, so the draw holds for any period.
    omega = column(2.0 * pi / period) * ratio
    # Equal energy per component: n a² / 2 = Hs² / 16, hence a = Hs √(2/n) / 4.
    amplitude = column(height) * ((2.0 / COMPONENTS) ** 0.5 / 4.0) + 0.0 * ratio
    # Deep water: k = ω² / g. The sea travels opposite to where it comes from.
    return Waves(amplitude, omega, omega**2 / GRAVITY, phase, wave_from + pi)


@kept(32)
def _scalar_components(height, period, wave_from, peak_enhancement, seed):
    if height == 0.0:
        none = np.zeros(COMPONENTS)
        return Waves(none, none, none, none, wave_from + pi, calm=True)
    return _components(float(height), float(period), float(wave_from), peak_enhancement, seed)


def _refuse_impossible(height, period, peak_enhancement):
    """Raise where a parameter of the sea is out of its range."""
    for name, value, low, high in (
        ("significant wave height", height, 0.0, None),
        ("peak period of the waves", period, 1e-3, None),
        ("peak enhancement of the waves", peak_enhancement, 1.0, 7.0),
    ):
        value = np.asarray(value.detach() if hasattr(value, "detach") else value)
        if not (np.all(value >= low) and (high is None or np.all(value <= high))):
            raise ValueError(
                f"{name} is {value}; must be from {low}" + ("" if high is None else f" to {high}")
            )


@lru_cache(maxsize=1024)
def _ratio_and_phase(peak_enhancement, seed):
    """Frequencies over the peak frequency, and phases: (n,) each."""
    random = generator("waves", seed)
    # A random place within each bin of equal energy, then the inverse of the cumulative spectrum.
    share = (np.arange(COMPONENTS) + random.random(COMPONENTS)) / COMPONENTS
    return np.interp(share, _cumulative_energy(peak_enhancement), _RATIO), random.uniform(
        0.0, 2.0 * pi, COMPONENTS
    )


@lru_cache(maxsize=32)
def _cumulative_energy(peak_enhancement):
    """Share of the energy below each of `_RATIO`, from 0 to 1."""
    # Trapezoidal rule; the constant width of the intervals cancels.
    density = jonswap(_RATIO, 1.0, 2.0 * pi, peak_enhancement)
    energy = np.concatenate(([0.0], np.cumsum(density[1:] + density[:-1])))
    return energy / energy[-1]
