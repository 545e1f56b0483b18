"""Gusts: the longitudinal turbulence of the wind at 10 m as a function of time, after the NORSOK spectrum.

Assumed: the gust acts along the mean wind and at once on the whole ship; no lateral or vertical turbulence, so that the
wind direction has no turbulence. The frequencies go from 1/600 to 0.5 Hz, the range for which the spectrum is meant;
slower changes belong to the mean wind, which the scenario sets.
"""

from functools import lru_cache

import numpy as np

from shipcosim.models.core.maths import Arithmetic, cos, is_single, maximum, pi, sqrt
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.sampling import generator
from shipcosim.models.environment.sinusoids import column, per_seed, tensors_if_any, total

COMPONENTS = 60
FREQUENCY_MIN = 1.0 / 600.0  # Hz
FREQUENCY_MAX = 0.5

_EDGES = np.geomspace(FREQUENCY_MIN, FREQUENCY_MAX, COMPONENTS + 1)
_ALMOST_CALM = 1e-6  # m/s
_MIDDLES = np.sqrt(_EDGES[1:] * _EDGES[:-1])


def norsok(frequency: Arithmetic, mean_speed: Arithmetic) -> Arithmetic:
    """NORSOK (Froya) spectrum of the longitudinal wind speed at 10 m.

    Parameters
    ----------
    frequency : (...) array
        Frequency, not negative. [Hz]
    mean_speed : float or array
        Mean over one hour at 10 m, not negative. [m/s]

    Returns
    -------
    like frequency
        S(f) = 320 (U/10)^2 / (1 + F^n)^(5/(3n)), F = 172 f (U/10)^(-3/4), n = 0.468. [m2/s]

    References
    ----------
    NORSOK N-003, Actions and action effects; ISO 19901-1, annex A. Constants from memory (grade D), equal to those of
    an independent implementation (the crate ndspec 0.1.1, wind::froya_1hr) and to the turbulence intensities of the
    parameter sheet, section 7.
    """
    return (mean_speed / 10.0) ** 2 * _shape(frequency, mean_speed)


def gust(t: Arithmetic, mean_speed: Arithmetic, seed: int | np.ndarray) -> Arithmetic:
    """Deviation of the wind speed from its mean: a sum of sinusoids, so that no step size enters.

    The band is cut into `COMPONENTS` bins of equal ratio, with one sinusoid of the variance of the bin at a frequency
    drawn inside it. While the mean wind changes, the amplitudes follow it and the phases go on.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    mean_speed : float or (m,) array or tensor
        Present mean at 10 m, not negative. [m/s]
    seed : int or (m,) array of int
        Seed of frequencies and phases, not negative. [1]

    Returns
    -------
    like mean_speed
        Gust along the mean wind. [m/s]

    References
    ----------
    Spectrum as `norsok`; the band and the gust along the mean wind are assumed.
    """
    # Frequencies and phases depend on the seed only, so the phases go on while the mean wind
    # changes.
    omega, phase = per_seed(_frequencies_and_phases, seed)
    (wave,) = tensors_if_any((cos(omega * column(t) + phase),), mean_speed)
    return total(_amplitudes(mean_speed), wave)


def gust_std(mean_speed: Arithmetic) -> Arithmetic:
    """Standard deviation of `gust`: root of the integral of the spectrum over the band.

    Parameters
    ----------
    mean_speed : float or (m,) array or tensor
        Mean at 10 m, above 0 for a tensor with gradients. [m/s]

    Returns
    -------
    like mean_speed
        Standard deviation. [m/s]

    References
    ----------
    As `gust`.

    Examples
    --------
    Of the 10.2 % turbulence that the whole spectrum has at 10 m/s, the band holds

    >>> round(100.0 * gust_std(10.0) / 10.0, 1)
    8.7
    """
    amplitudes = _amplitudes(mean_speed)
    # A sinusoid of amplitude a has the variance a² / 2.
    return sqrt(0.5 * total(amplitudes, amplitudes))


def _amplitudes(mean_speed):
    """Amplitudes of the components, cached for floats and arrays while the mean stays."""
    if is_single(mean_speed):
        return _float_amplitudes(mean_speed)
    if isinstance(mean_speed, np.ndarray):
        return _array_amplitudes(mean_speed.astype(float).tobytes(), mean_speed.shape)
    return _any_amplitudes(mean_speed)


def _any_amplitudes(mean_speed):
    """Amplitudes of the components, a = √(2 S(f) Δf) of each bin."""
    middles, widths = tensors_if_any((_MIDDLES, _EDGES[1:] - _EDGES[:-1]), mean_speed)
    speed = column(mean_speed)
    return speed / 10.0 * sqrt(2.0 * _shape(middles, speed) * widths)


_float_amplitudes = kept(64)(_any_amplitudes)


@lru_cache(maxsize=4)
def _array_amplitudes(content, shape):
    """Amplitudes for an array, given as bytes and shape, which can be kept."""
    return _any_amplitudes(np.frombuffer(content).reshape(shape))


def _shape(frequency, mean_speed):
    """The spectrum over (U/10)^2; in calm air that of `_ALMOST_CALM`."""
    n = 0.468
    # F = 172 f (U/10)^(-3/4), the reduced frequency of the NORSOK spectrum.
    ratio = 172.0 * frequency * (maximum(mean_speed, _ALMOST_CALM) / 10.0) ** -0.75
    return 320.0 / (1.0 + ratio**n) ** (5.0 / (3.0 * n))


@kept(64)
def _frequencies_and_phases(seed):
    """Circular frequencies and phases of a seed, (n,) each."""
    # A random frequency within each bin: an even spacing would repeat the record after a while.
    random = generator("gusts", seed)
    frequency = _EDGES[:-1] * (_EDGES[1:] / _EDGES[:-1]) ** random.random(COMPONENTS)
    return 2.0 * pi * frequency, random.uniform(0.0, 2.0 * pi, COMPONENTS)
