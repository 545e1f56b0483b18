"""First-order wave motion of a ship, added to her low-frequency motion."""

import numpy as np

from shipcosim.models.core.maths import Arithmetic, exp, is_single, sin, sincos, where
from shipcosim.models.core.memoize import kept
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.environment.sinusoids import column, total
from shipcosim.models.environment.wave_loads import DriftTable, drift_at
from shipcosim.models.environment.waves import Waves, phase_angle, waves_like

_ALMOST_ZERO = 1e-6


def wave_response(
    t: Arithmetic,
    x: Arithmetic,
    y: Arithmetic,
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    waves: Waves,
    table: DriftTable,
    *,
    length: Arithmetic,
    breadth: Arithmetic,
    draught: Arithmetic,
) -> tuple[Load, Motion]:
    """Drift load and first-order wave motion together, from the same phase angles.

    The motion is the water's, averaged over waterplane and half the draught. With q = k L cos(beta)/2,
    p = k B sin(beta)/2, A = a exp(-k T/2) sin(q)/q sin(p)/p the ship is displaced along the direction of the waves by
    sum A sin(theta), and turned by

        psi_wave = -sum a exp(-k T/2) sin(beta) (6/L) (sin q - q cos q)/q^2 cos(theta)

    which is the slope of the straight line that fits the sideways displacement of the water along the length best
    (least squares). Rates use the frequency of encounter; the yaw rate of the ship is neglected in them.

    Parameters
    ----------
    t : float or (m,) array
        Time. [s]
    x, y, psi : float or (m,) array or tensor
        Position and heading of the (low-frequency) ship. [m, m, rad]
    u, v : like x
        Velocity over ground in body axes, from which the frequency of encounter follows. [m/s]
    waves : Waves
        The sea. [m, rad/s, rad/m, rad]
    table : DriftTable
        Drift coefficients. [N/m2, N/m2, N.m/m2]
    length, breadth, draught : float or (m,) array
        Waterline length and breadth, draught. [m]

    Returns
    -------
    load : tuple of three, like x
        Drift load as `wave_loads.drift` gives it. [N, N, N.m]
    motion : Motion, like x
        x_wave, y_wave (north, east), psi_wave, and their rates in body axes u_wave, v_wave, r_wave.
        [m, m, rad, m/s, m/s, rad/s]

    References
    ----------
    Load: as `wave_loads.drift`. Motion: assumed, grade D: no motion transfer functions are at hand (nominal model, waves).
    """
    if waves.calm:
        zero = x - x
        return (zero, zero, zero), Motion(*(zero,) * 6)
    waves = waves_like(waves, x, y, psi)
    s, c = sincos(phase_angle(t, x, y, waves))
    return drift_at(c, s, psi, waves, table), _motion(
        c, s, psi, u, v, waves, length, breadth, draught
    )


def _motion(c, s, psi, u, v, waves, length, breadth, draught):
    """First-order motion from the cosine c and sine s of the phase angles."""
    # Sine and cosine of the relative wave direction β, kept off zero for the divisions below.
    across, ahead = sincos(waves.direction - psi)
    some_across = _not_zero(across)
    some_ahead = _not_zero(ahead)
    half_length, half_breadth, spread, turned = _hull_in(waves, length, breadth, draught)
    # q = k L cos β / 2 and p = k B sin β / 2: waves short against the hull average out, as sin(q)/q
    # sin(p)/p.
    q = half_length * column(some_ahead)
    sin_q, cos_q = sincos(q)
    shift = spread * sin_q * sin(half_breadth * column(some_across))
    # (sin q - q cos q) / q²: the best straight line through the sideways displacement.
    turn = turned * (sin_q - q * cos_q)
    # Frequency of encounter: ω_e = ω - k (velocity in the direction of the waves).
    encounter = waves.omega - waves.wavenumber * column(u * ahead + v * across)
    # The divisions by cos β and sin β are common to all components.
    per_shift = 1.0 / (some_ahead * some_across)
    per_turn = 6.0 / length * across / (some_ahead * some_ahead)
    # Displacement with sin θ, its rate with ω_e cos θ; the turn a quarter period apart.
    along = per_shift * total(shift, s)
    along_dot = per_shift * total(shift, encounter * c)
    psi_wave = -per_turn * total(turn, c)
    r_wave = per_turn * total(turn, encounter * s)
    # Displacement along the waves' direction, its rate in body axes.
    east, north = sincos(waves.direction)
    return Motion(
        along * north, along * east, psi_wave, along_dot * ahead, along_dot * across, r_wave
    )


def _hull_in(waves, length, breadth, draught):
    """Per component: k L/2, k B/2, and a exp(-k T/2) over their product and over (k L/2)².

    They depend on hull and sea alone, so they are computed once for both.
    """
    if isinstance(waves.omega, np.ndarray) and is_single(length):
        return _kept_hull(waves, length, breadth, draught)
    return _hull(waves, length, breadth, draught)


def _hull(waves, length, breadth, draught):
    """As `_hull_in`."""
    k = waves.wavenumber
    half_length = k * column(0.5 * length)
    half_breadth = k * column(0.5 * breadth)
    # Mean depth: the motion decays with exp(-k z), taken at half the draught.
    amplitude = waves.amplitude * exp(k * column(-0.5 * draught))
    return (
        half_length,
        half_breadth,
        amplitude / (half_length * half_breadth),
        amplitude / half_length**2,
    )


_kept_hull = kept(8)(_hull)


def _not_zero(x):
    """x kept off 0, where sin(x)/x has a limit; small enough for it, large enough to divide by."""
    return where(abs(x) < _ALMOST_ZERO, _ALMOST_ZERO, x)
