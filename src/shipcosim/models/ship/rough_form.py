"""Loads on a ship whose form differs from the hull model: the differences, neutral by default.

The hull's law stands in `hull`. Here cross-flow drag changes along the hull and, like the resistance, follows another
power of speed; wind loads have factors by direction; and a force remembers the motion of some seconds.

References
----------
Assumed forms: a ship that differs from her model by its shape and not by its numbers alone.
"""

from dataclasses import dataclass
from functools import cached_property

from shipcosim.models.core.interpolation import interp, interp_columns
from shipcosim.models.core.maths import Arithmetic, exp, maximum, pi, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import acts, quantity
from shipcosim.models.core.tables import columns, columns_by_angle
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.ship.hull import HullParameters

DRAG_SPEED = 1.2
CROSS_SPEED = 0.3
"""Speeds at which resistance and cross flow by another power are those of the hull's law. [m/s]"""
STRIPS = 15
_SLOW = 1e-3  # m/s, below which a power below 2 grows no more
_NO_STRIPS = "-1 1; 1 1"
_NO_WIND = "0 1 1 1; 360 1 1 1"


@dataclass(frozen=True, kw_only=True)
class RoughFormParameters:
    """Differences between a ship's form and the hull model; none by default."""

    strip_factors: str = quantity(
        _NO_STRIPS,
        "1",
        "rows 'place factor': factor on the cross-flow drag along the hull, place over half the length from -1 aft to "
        "1 forward",
        "neutral",
    )
    cross_flow_power: float = quantity(
        2.0,
        "1",
        "power of speed of the cross-flow drag, equal at 0.3 m/s",
        "neutral",
        minimum=1.0,
        maximum=3.0,
    )
    drag_power: float = quantity(
        2.0,
        "1",
        "power of speed of the resistance, equal at 1.2 m/s",
        "neutral",
        minimum=1.0,
        maximum=3.0,
    )
    wind_factors: str = quantity(
        _NO_WIND,
        "1",
        "rows 'angle X Y N': factors on the wind loads by the angle the wind comes from, 0 to 360 deg, clockwise from "
        "the bow",
        "neutral",
    )
    memory_surge: float = quantity(
        0.0,
        "1",
        "share of A11 that the force with a memory adds in slow motion",
        "neutral",
        minimum=0.0,
    )
    memory_sway: float = quantity(
        0.0,
        "1",
        "share of A22 that the force with a memory adds in slow motion",
        "neutral",
        minimum=0.0,
    )
    memory_yaw: float = quantity(
        0.0,
        "1",
        "share of A66 that the moment with a memory adds in slow motion",
        "neutral",
        minimum=0.0,
    )
    memory_time: float = quantity(
        6.0, "s", "time over which the force remembers", "neutral", minimum=0.1
    )

    @cached_property
    def strips(self):
        """Place over half length and factor of each strip; empty if as in the hull model."""
        if self.strip_factors == _NO_STRIPS and not acts(self.cross_flow_power, 2.0):
            return ()
        table = columns(self.strip_factors, 2)
        # Middles of strips of equal width, from -1 (stern) to 1 (bow).
        places = [(2 * i + 1) / STRIPS - 1.0 for i in range(STRIPS)]
        return tuple((place, interp(place, *table)) for place in places)

    @cached_property
    def memory(self):
        """Shares of the added mass in surge, sway and yaw; empty if there is no memory."""
        shares = self.memory_surge, self.memory_sway, self.memory_yaw
        return shares if any(map(acts, shares)) else ()


def form_loads(
    u: Arithmetic, v: Arithmetic, r: Arithmetic, *, hull: HullParameters, form: RoughFormParameters
) -> Load:
    """Loads on a hull of this form minus those of the hull model.

    Parameters
    ----------
    u, v, r : float or (...) array or tensor
        Velocity relative to the water and yaw rate. [m/s, m/s, rad/s]
    hull : HullParameters
        Its quadratic damping in surge and its cross-flow drag are those that differ.
    form : RoughFormParameters
        The form.

    Returns
    -------
    tuple of three, like u
        X, Y, N. [N, N, N.m]

    Notes
    -----
    A quadratic drag d abs(w) w becomes d abs(w) w (abs(w)/w_0)^(p - 2), the resistance with p = `drag_power` and
    w = u, a strip's drag with p = `cross_flow_power` and w = v + x r, times the strip's factor.
    """
    # Differences only: at neutral parameters nothing is computed.
    X = Y = N = 0.0 * u
    if acts(form.drag_power, 2.0):
        # Resistance with another power, equal at the reference speed: factor (|u| / u_0)^(p - 2).
        X = hull.quadratic[0] * u * abs(u) * (_power(u, DRAG_SPEED, form.drag_power) - 1.0)
    half, k = hull.strips
    # Cross flow strip by strip, minus the drag that the hull model already has.
    for place, factor in form.strips:
        w = v + place * half * r
        drag = (
            -2.0
            * k
            / STRIPS
            * w
            * abs(w)
            * (factor * _power(w, CROSS_SPEED, form.cross_flow_power) - 1.0)
        )
        Y = Y + drag
        N = N + place * half * drag
    return X, Y, N


def _power(w, reference, power):
    return (maximum(abs(w), _SLOW) / reference) ** (power - 2.0)


def memory_loads(
    velocity: Load, remembered: Load, h: float, *, hull: HullParameters, form: RoughFormParameters
) -> tuple[Load, Load]:
    """Load of a force with memory, and its memory a step later.

    The load is -m_k (ν_r - z) / T with ż = (ν_r - z) / T: in slow motion an added mass m_k, in quick motion a damping.

    Parameters
    ----------
    velocity : tuple of three floats, (...) arrays or tensors
        Velocity relative to the water and yaw rate. [m/s, m/s, rad/s]
    remembered : tuple of three, like velocity
        z, the motion that is remembered. [m/s, m/s, rad/s]
    h : float
        Step, over which the velocity is held. [s]
    hull : HullParameters
        Whose added mass the shares are of.
    form : RoughFormParameters
        Shares and time.

    Returns
    -------
    tuple of three, like velocity
        X, Y, N. [N, N, N.m]
    tuple of three, like velocity
        z at the end. [m/s, m/s, rad/s]

    References
    ----------
    Cummins' retardation force with one exponential: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control,
    2nd ed., Wiley, 2021, ch. 5.
    """
    # One exponential as the retardation function (Cummins): m_k (ν - z) / T.
    added = hull.A11, hull.A22, hull.A66
    # z follows ν with a lag of first order, exact for a held velocity.
    share = 1.0 - exp(-h / form.memory_time)
    newer = [now - then for now, then in zip(velocity, remembered, strict=True)]
    X, Y, N = (
        -part * mass / form.memory_time * new
        for part, mass, new in zip(form.memory or (0.0,) * 3, added, newer, strict=True)
    )
    u, v, r = (then + share * new for then, new in zip(remembered, newer, strict=True))
    return (X, Y, N), (u, v, r)


def rough_wind_loads(
    speed: Arithmetic, wind_from: Arithmetic, *, wind: WindParameters, form: RoughFormParameters
) -> Load:
    """Loads of the apparent wind with factors by direction; port and starboard differ.

    Parameters
    ----------
    speed : float or (...) array or tensor
        Apparent wind speed. [m/s]
    wind_from : like speed
        Direction it comes from, clockwise from the bow, in [-π, π]. [rad]
    wind : WindParameters
        The loads without factors.
    form : RoughFormParameters
        The factors.

    Returns
    -------
    tuple of three, like speed
        X, Y, N. [N, N, N.m]

    Raises
    ------
    ValueError
        The factors are not a table of four columns whose angles go from 0 to 360 deg.
    """
    X, Y, N = wind_loads(speed, wind_from, wind=wind)
    if form.wind_factors == _NO_WIND:
        return X, Y, N
    angles, *factors = columns_by_angle(form.wind_factors, "wind factors", 360.0)
    # The table goes once around; angles from port count from 180 to 360 degrees.
    x, y, n = interp_columns(
        where(wind_from < 0.0, wind_from + 2.0 * pi, wind_from), angles, *factors
    )
    return x * X, y * Y, n * N
