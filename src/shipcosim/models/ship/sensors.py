"""Sensors: true values with Gauss-Markov error, white noise and failures, each channel with its period and latency.

All channels count the samples of one clock, that of the compasses: tick k is taken at the first step that starts at
k * period or later, of the truth at that time. A channel takes a sample every so many ticks and gives it out so many
ticks later. Random numbers depend on the seed and the number of the sample alone. So a finer step gives the same
measurements.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper II, Table I,
read as the nominal model says under sensors. Periods and latencies: assumed, typical of DP messages.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import (
    Arithmetic,
    atan2,
    choose,
    exp,
    hypot,
    maximum,
    minimum,
    repeat,
    row_of,
    sqrt,
    where,
)
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.core.sampling import normals, samples_due
from shipcosim.models.ship.mast import MastParameters, wind_at_mast
from shipcosim.models.ship.sensor_messages import Fix, Heading, Telegrams, Wind


@dataclass(frozen=True, kw_only=True)
class SensorParameters:
    """Periods, latencies and errors of three position references, two compasses, a rate gyro and an anemometer."""

    period: float = required(
        "s", "sample period of compasses and rate gyro, the clock of all sensors", minimum=1e-3
    )
    heading_latency: float = required(
        "s", "age of headings and yaw rate when they are given out, whole periods", minimum=0.0
    )
    position_period: float = required(
        "s", "sample period of the position references, whole periods", minimum=1e-3
    )
    position_latency: float = required(
        "s", "age of positions and velocities when they are given out, whole periods", minimum=0.0
    )
    wind_period: float = required(
        "s", "period at which the anemometer gives a mean, whole periods", minimum=1e-3
    )
    wind_latency: float = required(
        "s", "age of that mean when it is given out, whole periods", minimum=0.0
    )
    position_drift_std: float = required(
        "m",
        "stationary standard deviation of the Gauss-Markov error, north and east each",
        minimum=0.0,
    )
    position_drift_time: float = required("s", "its correlation time", minimum=1e-3)
    position_noise_std: float = required("m", "white noise of north and east each", minimum=0.0)
    velocity_noise_std: float = required("m/s", "white noise of surge and sway each", minimum=0.0)
    heading_drift_std: float = required(
        "rad", "stationary standard deviation of the Gauss-Markov error of the heading", minimum=0.0
    )
    heading_drift_time: float = required("s", "its correlation time", minimum=1e-3)
    heading_noise_std: float = required("rad", "white noise of the heading", minimum=0.0)
    yaw_rate_noise_std: float = required("rad/s", "white noise of the yaw rate", minimum=0.0)
    wind_average_time: float = required(
        "s", "span of the mean that the anemometer gives", minimum=0.0
    )
    wind_speed_noise: float = required(
        "1", "white noise of the wind speed, over the wind speed", minimum=0.0
    )
    wind_from_noise_std: float = required("rad", "white noise of the wind direction", minimum=0.0)
    seed: int = quantity(1, "1", "seed of all errors", "any", minimum=0)

    @cached_property
    def clocks(self):
        """Ticks between samples and ticks of latency, of positions, headings and wind."""
        periods = self.position_period, self.period, self.wind_period
        latencies = self.position_latency, self.heading_latency, self.wind_latency
        return tuple(
            (max(1, round(period / self.period)), round(latency / self.period))
            for period, latency in zip(periods, latencies, strict=True)
        )

    @cached_property
    def position_wander(self):
        """Factors of the Gauss-Markov error and of a random number, per sample."""
        return _wander(self.position_period, self.position_drift_std, self.position_drift_time)

    @cached_property
    def heading_wander(self):
        """Slow deviation of the heading."""
        return _wander(self.period, self.heading_drift_std, self.heading_drift_time)


class Truth(NamedTuple):
    """True values to be measured: total motion (low-frequency plus waves), apparent wind.

    Parameters
    ----------
    x, y, psi : float or (m,) array or tensor
        Position and heading. [m, m, rad]
    u, v, r : like x
        Velocity over ground in body axes. [m/s, m/s, rad/s]
    apparent_wind_speed, apparent_wind_from : like x
        Wind at 10 m above the origin relative to the ship, from the bow. [m/s, rad]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    u: Arithmetic
    v: Arithmetic
    r: Arithmetic
    apparent_wind_speed: Arithmetic
    apparent_wind_from: Arithmetic


class ReferenceFailure(NamedTuple):
    """Failure of a position reference.

    Parameters
    ----------
    lost, frozen : bool or (m,) array of bool
        It drops out; it repeats its last value. [1]
    north, east : float or (m,) array
        Offset of its position. [m]
    north_rate, east_rate : float or (m,) array
        Rate of a drift of its position that starts where this becomes other than 0, and ends at 0. [m/s]
    """

    lost: Arithmetic = False
    frozen: Arithmetic = False
    north: Arithmetic = 0.0
    east: Arithmetic = 0.0
    north_rate: Arithmetic = 0.0
    east_rate: Arithmetic = 0.0


class CompassFailure(NamedTuple):
    """Failure of a compass.

    Parameters
    ----------
    lost, frozen : bool or (m,) array of bool
        It drops out; it repeats its last value. [1]
    offset : float or (m,) array
        Offset of its heading. [rad]
    rate : float or (m,) array
        Rate at which it runs off, from where this becomes other than 0 until it is 0 again. [rad/s]
    """

    lost: Arithmetic = False
    frozen: Arithmetic = False
    offset: Arithmetic = 0.0
    rate: Arithmetic = 0.0


class WindFailure(NamedTuple):
    """Failure of the anemometer.

    Parameters
    ----------
    lost, frozen : bool or (m,) array of bool
        It drops out; it sticks to its last value. [1]
    scale : float or (m,) array
        Factor on its speed. [1]
    offset : float or (m,) array
        Offset of its direction. [rad]
    """

    lost: Arithmetic = False
    frozen: Arithmetic = False
    scale: Arithmetic = 1.0
    offset: Arithmetic = 0.0


class SensorFailures(NamedTuple):
    """Failures of the sensors; none by default.

    Parameters
    ----------
    positions : tuple of three ReferenceFailure
        Of the position references.
    compasses : tuple of two CompassFailure
        Of the compasses.
    wind : WindFailure
        Of the anemometer.
    """

    positions: tuple[ReferenceFailure, ...] = (ReferenceFailure(),) * 3
    compasses: tuple[CompassFailure, ...] = (CompassFailure(),) * 2
    wind: WindFailure = WindFailure()


class Channel(NamedTuple):
    """State of position references, or of compasses and rate gyro, between samples.

    Parameters
    ----------
    wander : tuple
        Gauss-Markov errors. [m, rad]
    drift : tuple
        Drifts by failure so far. [m, rad]
    history : tuple
        Latest samples, of all like sensors each, the newest last: as many as latency and period ask for. [m, m/s, rad]
    """

    wander: tuple
    drift: tuple
    history: tuple


class Anemometer(NamedTuple):
    """State of the anemometer between samples.

    Parameters
    ----------
    components : tuple
        Latest samples of the wind's components from ahead and from starboard, zeros before them until there are as many
        as the mean is of. [m/s]
    count : float
        How many of them are samples. [1]
    history : tuple
        Latest means, the newest last: as many as latency and period ask for. [m/s, rad]
    """

    components: tuple
    count: float
    history: tuple


class SensorState(NamedTuple):
    """State of the sensors between ticks.

    Parameters
    ----------
    taken : int
        Ticks so far, counted from t = 0. [1]
    positions, headings : Channel
        Of position references; of compasses and rate gyro.
    wind : Anemometer
        Of the anemometer.
    telegrams : Telegrams
        Messages of the sensors until the next tick.
    """

    taken: int
    positions: Channel
    headings: Channel
    wind: Anemometer
    telegrams: Telegrams


def start(
    t: float,
    truth: Truth,
    failures: SensorFailures,
    *,
    parameters: SensorParameters,
    mast: MastParameters,
) -> SensorState:
    """First sample of each channel, given out at once, with stationary Gauss-Markov errors.

    Parameters
    ----------
    t : float
        Time of the start. [s]
    truth : Truth
        True values at t.
    failures : SensorFailures
        Failures of the sensors at t.
    parameters : SensorParameters
        Errors and sample periods.
    mast : MastParameters
        Where the anemometer stands.

    Returns
    -------
    SensorState
        State after the first tick.
    """
    p = parameters
    # Number of the present tick: random numbers depend on it, not on the step.
    k = samples_due(t, parameters.period) - 1
    clocks = parameters.clocks
    numbers = [_numbers(p, k, channel) for channel in range(3)]
    # Perfect values stand in for the last sample, in case a sensor starts frozen or lost.
    fixes = (Fix(truth.x, truth.y, truth.u, truth.v, 1.0),) * 3
    headings = ((Heading(truth.psi, 1.0),) * 2, truth.r)
    # Gauss-Markov errors start in their stationary distribution, so there is no transient.
    wander = tuple(p.position_drift_std * number for number in numbers[0][:6])
    positions = Channel(wander, (0.0,) * 6, (fixes,))
    # Fill the history with the first sample, so that a message exists before the first latency is
    # over.
    positions = positions._replace(
        history=(_fixes(positions, numbers[0], truth, failures, p),) * _length(clocks[0])
    )
    wander = tuple(p.heading_drift_std * number for number in numbers[1][:2])
    compasses = Channel(wander, (0.0,) * 2, (headings,))
    compasses = compasses._replace(
        history=(_headings(compasses, numbers[1], truth, failures, p),) * _length(clocks[1])
    )
    air = _air(truth, mast)
    # Samples of the wind in its mean.
    spans = max(1, round(p.wind_average_time / p.period))
    wind = Anemometer((*((0.0, 0.0),) * (spans - 1), air), 1.0, (Wind(*air, 1.0),))
    wind = wind._replace(history=(_wind(wind, numbers[2], failures, p),) * _length(clocks[2]))
    return SensorState(
        k + 1, positions, compasses, wind, _telegrams(k, positions, compasses, wind, p)
    )


def step(
    t: float,
    state: SensorState,
    truth: Truth,
    failures: SensorFailures,
    *,
    parameters: SensorParameters,
    mast: MastParameters,
) -> SensorState:
    """State after all ticks that are due by t.

    Parameters
    ----------
    t : float
        Time at the start of a step. [s]
    state : SensorState
        State after the ticks before.
    truth : Truth
        True values at t.
    failures : SensorFailures
        Failures of the sensors at t.
    parameters : SensorParameters
        Errors and sample periods.
    mast : MastParameters
        Where the anemometer stands.

    Returns
    -------
    SensorState
        State after the ticks.
    """
    # Several ticks may be due if the step is longer than the period.
    due = samples_due(t, parameters.period)
    return repeat(
        lambda state: state.taken < due,
        lambda state: _ticked(state, truth, failures, parameters, mast),
        state,
    )


def _ticked(state, truth, failures, p, mast):
    """State after one more tick; each channel whose turn it is takes a sample."""
    k = state.taken
    headings = state.headings
    wind = state.wind

    # Positions: every so many ticks. Errors and drifts move on by one sample period.
    def with_positions():
        numbers = _numbers(p, k, 0)
        rates = [rate for failure in failures.positions for rate in failure[4:]]
        moved = _moved(state.positions, numbers, p.position_wander, rates, p.position_period)
        return _noted(moved, _fixes(moved, numbers, truth, failures, p))

    positions = choose(k % p.clocks[0][0] == 0, with_positions, lambda: state.positions)
    # Headings and yaw rate: at every tick, since theirs is the clock.
    numbers = _numbers(p, k, 1)
    rates = [failure.rate for failure in failures.compasses]
    headings = _moved(headings, numbers, p.heading_wander, rates, p.period)
    headings = _noted(headings, _headings(headings, numbers, truth, failures, p))
    # The anemometer measures at every tick: the oldest sample of its mean gives way to the newest.
    count = minimum(wind.count + 1.0, float(len(wind.components)))
    averaged = Anemometer((*wind.components[1:], _air(truth, mast)), count, wind.history)
    wind = choose(
        k % p.clocks[2][0] == 0,
        lambda: _noted(averaged, _wind(averaged, _numbers(p, k, 2), failures, p)),
        lambda: averaged,
    )
    return SensorState(
        k + 1, positions, headings, wind, _telegrams(k, positions, headings, wind, p)
    )


def _length(clock):
    """Length of a history, so that a sample as old as the latency is in it at any tick."""
    return clock[1] // clock[0] + 2


_DRAWS = ("positions", 18), ("headings", 5), ("anemometer", 2)


def _numbers(p, k, channel):
    """Random numbers of a channel's sample at tick k."""
    name, width = _DRAWS[channel]
    return normals(name, p.seed, k // p.clocks[channel][0], width)


def _wander(period, std, time):
    """Exact Gauss-Markov step: b ← φ b + σ √(1 - φ²) w, with φ = exp(-period / T)."""
    phi = exp(-period / time)
    return phi, std * sqrt(1.0 - phi * phi)


def _moved(channel, numbers, wander, rates, period):
    """Gauss-Markov errors and failure drifts one period later; drifts end with their rates."""
    phi, kick = wander
    errors = tuple([phi * b + kick * w for b, w in zip(channel.wander, numbers, strict=False)])
    drift = tuple(
        [
            where(rate == 0.0, 0.0, d + period * rate)
            for d, rate in zip(channel.drift, rates, strict=True)
        ]
    )
    return Channel(errors, drift, channel.history)


def _noted(channel, sample):
    """History with a new sample."""
    return channel._replace(history=(*channel.history[1:], sample))


def _fixes(channel, numbers, truth, failures, p):
    """Sample of all position references; numbers: six Gauss-Markov errors, then four for each."""
    (fixes, wander, drift) = _last(channel)
    p_std = p.position_noise_std
    v_std = p.velocity_noise_std
    samples = []
    # Measured = true + wander (correlated) + drift (failure) + white noise + offset (failure).
    for i, (failure, last) in enumerate(zip(failures.positions, fixes, strict=True)):
        n = 2 * i
        e = 2 * i + 1
        a, b, c, d = numbers[6 + 4 * i : 10 + 4 * i]
        fresh = (
            truth.x + wander[n] + drift[n] + p_std * a + failure.north,
            truth.y + wander[e] + drift[e] + p_std * b + failure.east,
            truth.u + v_std * c,
            truth.v + v_std * d,
        )
        samples.append(Fix._make(_held(failure, fresh, last)))
    return tuple(samples)


def _headings(channel, numbers, truth, failures, p):
    """Sample of both compasses and the gyro; numbers: two Gauss-Markov errors, compasses, gyro."""
    (headings, _), wander, drift = _last(channel)
    samples = []
    for i, (failure, last) in enumerate(zip(failures.compasses, headings, strict=True)):
        # Measured = true + wander + drift + white noise + offset, wrapped.
        fresh = wrap(
            truth.psi + wander[i] + drift[i] + p.heading_noise_std * numbers[2 + i] + failure.offset
        )
        samples.append(Heading._make(_held(failure, (fresh,), last)))
    return tuple(samples), truth.r + p.yaw_rate_noise_std * numbers[4]


def _wind(anemometer, numbers, failures, p):
    """Mean over the averaging window, with noise and failure."""
    failure = failures.wind
    last = anemometer.history[-1]
    # Mean of the components, not of speed and direction, which has no mean across the bow.
    samples = zip(*anemometer.components, strict=True)
    ahead, starboard = (sum(component) / anemometer.count for component in samples)
    # Noise of speed is relative; scale and offset are failures.
    fresh = (
        hypot(ahead, starboard) * (1.0 + p.wind_speed_noise * numbers[0]) * failure.scale,
        wrap(atan2(starboard, ahead) + p.wind_from_noise_std * numbers[1] + failure.offset),
    )
    return Wind._make(_held(failure, fresh, last))


def _last(channel):
    """Newest sample, Gauss-Markov errors and drifts of a channel."""
    return channel.history[-1], channel.wander, channel.drift


def _held(failure, fresh, last):
    """Fresh values, or the last ones if a sensor is frozen or lost; then its validity."""
    # A frozen sensor still reports that it works; a lost one does not.
    lost = failure.lost
    held = failure.frozen | failure.lost
    return [
        *[where(held, old, new) for new, old in zip(fresh, last, strict=False)],
        where(lost, 0.0, 1.0),
    ]


def _air(truth, mast):
    """Components of the apparent wind at the mast from ahead and from starboard."""
    wind = truth.apparent_wind_speed, truth.apparent_wind_from
    return wind_at_mast(*wind, truth.u, truth.v, truth.r, mast=mast)


def _telegrams(k, positions, headings, wind, p):
    """Messages at tick k: of each channel the newest sample as old as the latency, or the first."""
    for_positions, for_headings, for_wind = p.clocks
    fixes, position_time = _given_out(k, positions, for_positions, p.period)
    (compasses, r), heading_time = _given_out(k, headings, for_headings, p.period)
    air, wind_time = _given_out(k, wind, for_wind, p.period)
    return Telegrams(fixes, compasses, r, air, position_time, heading_time, wind_time)


def _given_out(k, channel, clock, period):
    """The sample of a channel that is given out at tick k, and its time."""
    every, delay = clock
    # The newest sample at least `delay` ticks old, counted back from the end of the history.
    sample = maximum(0, (k - delay) // every)
    return row_of(channel.history, sample - k // every - 1), sample * every * period
