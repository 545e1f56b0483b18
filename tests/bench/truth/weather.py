"""Wind, first-order waves and slow noise as filtered white noise, never as sums of sinusoids."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from truth.ship import BREADTH, DRAUGHT, GRAVITY, LENGTH


@dataclass(frozen=True)
class Weather:
    """Weather of one log; directions are where wind and waves go, from north. [m/s, m, s, rad]"""

    wind_speed: float
    wind_to: float
    turbulence: float  # standard deviation of the gusts over the mean speed
    wave_height: float
    wave_period: float
    waves_to: float


def draw_weather(rng):
    """Weather in which the ship can hold its position."""
    wind_to = rng.uniform(-np.pi, np.pi)
    return Weather(
        wind_speed=rng.uniform(3.0, 9.0),
        wind_to=wind_to,
        turbulence=rng.uniform(0.08, 0.15),
        wave_height=rng.uniform(0.05, 0.3),
        wave_period=rng.uniform(3.0, 6.0),
        waves_to=wind_to + rng.normal(0.0, np.radians(25.0)),
    )


def windier(weather, least):
    """The same weather with at least this mean wind speed."""
    return replace(weather, wind_speed=max(weather.wind_speed, least))


def gauss_markov(rng, n, h, time_constant, dtype=float):
    """Stationary first-order noise of unit variance, n samples h apart; complex has two independent parts."""
    white = rng.standard_normal(n)
    if dtype is complex:
        white = white + 1j * rng.standard_normal(n)
    keep = np.exp(-h / time_constant)
    white[1:] *= np.sqrt(1 - keep**2)
    return lfilter([1.0], [1.0, -keep], white)


def wind_series(weather, rng, n, h):
    """Wind at the mast and, its short gusts averaged, over the ship: each (2, n) north and east. [m/s]"""
    gust = 0.8 * gauss_markov(rng, n, h, 15.0) + 0.6 * gauss_markov(rng, n, h, 180.0)
    side = 0.6 * gauss_markov(rng, n, h, 10.0)
    veer = np.radians(5.0) * gauss_markov(rng, n, h, 400.0)
    along = weather.wind_speed * (1 + weather.turbulence * gust)
    across = weather.wind_speed * weather.turbulence * side
    c, s = np.cos(weather.wind_to + veer), np.sin(weather.wind_to + veer)
    mast = np.array([c * along - s * across, s * along + c * across])
    keep = np.exp(-h / 1.5)
    over_ship, _ = lfilter([1 - keep], [1.0, -keep], mast, zi=keep * mast[:, :1])
    return mast, over_ship


def elevation(weather, rng, n, h):
    """Narrow-band elevation of the sea, complex: the real part, and a quarter period on the imaginary. [m]"""
    envelope = gauss_markov(rng, n, h, 3 * weather.wave_period, complex)
    return (
        0.25
        * weather.wave_height
        * envelope
        * np.exp(2j * np.pi / weather.wave_period * h * np.arange(n))
    )


def wave_motion(psi, sea, period, waves_to):
    """First-order motion that the sea gives a ship, and its rates.

    The water's motion averaged over hull and draught; the averages are Gaussian in wave number times size.

    Returns
    -------
    tuple of six, like psi
        Ahead, to starboard, yaw; their rates. [m, m, rad, m/s, m/s, rad/s]
    """
    omega = 2 * np.pi / period
    k = omega**2 / GRAVITY
    c, s = np.cos(waves_to - psi), np.sin(waves_to - psi)
    size = np.exp(-k * DRAUGHT / 2 - ((k * LENGTH * c) ** 2 + (k * BREADTH * s) ** 2) / 24)
    turning = size * 0.6 * k * s * c
    return (
        size * c * sea.imag,
        size * s * sea.imag,
        turning * sea.real,
        size * c * omega * sea.real,
        size * s * omega * sea.real,
        -turning * omega * sea.imag,
    )
