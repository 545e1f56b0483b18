"""Loads of constant direction over the earth: a line's pull, and the mean drift of waves."""

from dataclasses import dataclass

from shipcosim.models.core.kinematics import load_at, to_body
from shipcosim.models.core.maths import Arithmetic, clip, hypot
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity, required

_SURGE_SHARE = 1.0 / 3.0
_SWAY_POWER = 2.0
_TINY = 1e-30  # N
_SOON = 1e-6  # s, so that the time of an onset belongs to it, however a master adds up its steps
_VERES = "fitted to the drift table of a research vessel of 34 m, Tp 4 to 7 s"


@dataclass(frozen=True)
class OnsetParameters:
    """Time from which a load acts, and time over which it grows."""

    onset_time: float = quantity(0.0, "s", "time from which on it acts", "set by the system")
    ramp_time: float = quantity(
        0.0, "s", "time that it takes to grow after that", "0: at once", minimum=0.0
    )


@dataclass(frozen=True, kw_only=True)
class EarthForceParameters:
    """A force of constant direction over the earth, and where it pulls at the ship."""

    north: float = quantity(0.0, "N", "force towards north", "neutral")
    east: float = quantity(0.0, "N", "force towards east", "neutral")
    x: float = required("m", "point of attack forward of the origin")
    y: float = quantity(0.0, "m", "point of attack to starboard of the origin", "on the centreline")


@dataclass(frozen=True, kw_only=True)
class DriftForceParameters:
    """Mean drift of waves that travel in one direction."""

    north: float = quantity(
        0.0, "N", "force on the beam, towards north where the waves travel", "neutral"
    )
    east: float = quantity(
        0.0, "N", "force on the beam, towards east where the waves travel", "neutral"
    )
    surge_share: float = quantity(
        _SURGE_SHARE, "1", "force in following waves over that on the beam", _VERES
    )
    sway_power: float = quantity(
        _SWAY_POWER,
        "1",
        "power of the sine of the waves' direction from the bow in sway",
        "waves much shorter than the ship (Faltinsen 1990, ch. 5)",
        minimum=1.0,
    )
    yaw_arm: float = required(
        "m", "yaw moment in waves from 45 deg to port of the stern, over the force on the beam"
    )


def onset(t: Arithmetic, *, onset_time: Arithmetic, ramp_time: Arithmetic) -> Arithmetic:
    """Share of an effect at a time: 0 before its onset, then linear to 1 over the ramp.

    Parameters
    ----------
    t : float or (...) array or tensor
        Time. [s]
    onset_time, ramp_time : like t
        Time of the onset, and duration of the ramp; 0: a step. [s]

    Returns
    -------
    like t
        In [0, 1]. [1]

    References
    ----------
    Definition.

    Examples
    --------
    >>> [round(onset(t, onset_time=100.0, ramp_time=20.0), 6) for t in (99.0, 105.0, 130.0)]
    [0.0, 0.25, 1.0]
    >>> [onset(t, onset_time=100.0, ramp_time=0.0) for t in (99.0, 100.0)]
    [0.0, 1.0]
    """
    return clip((t - onset_time + _SOON) / (ramp_time + _SOON), 0.0, 1.0)


def earth_force(
    psi: Arithmetic, north: Arithmetic, east: Arithmetic, *, x: Arithmetic, y: Arithmetic = 0.0
) -> Load:
    """Load of a force of constant direction over the earth that attacks at a point of the ship.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    north, east : like psi
        The force. [N]
    x, y : float
        Point of attack, forward and to starboard of the origin. [m]

    Returns
    -------
    tuple of three, like psi
        X, Y, N about the origin. [N, N, N.m]

    References
    ----------
    Definition.

    Examples
    --------
    A line that pulls the stern of a ship heading north to the east turns her bow to the west:

    >>> earth_force(0.0, 0.0, 1000.0, x=-17.0)
    (0.0, 1000.0, -17000.0)
    """
    return load_at(x, y, *to_body(psi, north, east))


def drift_force(
    psi: Arithmetic,
    north: Arithmetic,
    east: Arithmetic,
    *,
    surge_share: Arithmetic = _SURGE_SHARE,
    sway_power: Arithmetic = _SWAY_POWER,
    yaw_arm: Arithmetic,
) -> Load:
    """Mean drift load of waves that travel in a fixed direction over the earth.

    With A the force on the beam and γ the direction the waves travel, seen from the bow,

        X = c A cos γ,  Y = A sin γ abs(sin γ)**(p - 1),  N = d A sin 2γ.

    Fitted to the drift table of a research vessel of 34 m over all γ, in JONSWAP seas with peak periods of 4 to 7 s,
    c is 0.19 to 0.33, d -1.60 to -1.38 m and the factor of Y 1.00 to 1.01. What the fits leave is 9 to 21 % of X, 11 %
    of Y and 10 to 27 % of N (rms over rms). c = 1/3 belongs to the longer waves, d = -1.5 m to the middle. That is with
    p = 2, of waves much shorter than the ship; a power that is fitted too is 1.67 to 1.75.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    north, east : like psi
        A as a vector in the direction the waves travel. [N]
    surge_share : float
        c. [1]
    sway_power : float
        p, at least 1. [1]
    yaw_arm : float
        d. [m]

    Returns
    -------
    tuple of three, like psi
        X, Y, N. [N, N, N.m]

    References
    ----------
    Faltinsen, Sea Loads on Ships and Offshore Structures, Cambridge, 1990, ch. 5, for p = 2; the rest is fitted.

    Examples
    --------
    Waves from the west on the beam of a ship that heads north, then from right astern:

    >>> [round(load) for load in drift_force(0.0, 0.0, 3000.0, yaw_arm=-1.5)]
    [0, 3000, 0]
    >>> [round(load) for load in drift_force(0.0, 3000.0, 0.0, yaw_arm=-1.5)]
    [1000, 0, 0]
    """
    # Components of A in body axes: A cos γ forward, A sin γ to starboard.
    forward, starboard = to_body(psi, north, east)
    A = hypot(north, east) + _TINY
    # Y = A sin γ |sin γ|^(p-1). N = d A sin 2γ = 2 d Y_A X_A / A.
    sway = starboard * (abs(starboard) / A) ** (sway_power - 1.0)
    return surge_share * forward, sway, 2.0 * yaw_arm * starboard * forward / A
