"""A helmsman who berths a ship by hand, with two azimuths at the stern and a tunnel at the bow.

He follows the fairway, slows, stops off the berth, turns parallel to the quay and lets her go sideways to it. He looks
every few seconds, thinks of the velocity that he wants and of the force that it takes, and moves the levers some time
later, in steps, where they are far enough from where they stand. His manner is a set of numbers. No contact with the
quay: he stops her there.

References
----------
Assumed. How a docking goes: Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU,
2021, paper III. Looking now and then, with dead bands and a reaction time: intermittent control of human operators,
Gawthrop et al., Intermittent control, Biological Cybernetics 104, 2011.
"""

from dataclasses import dataclass
from math import atan2, copysign, cos, hypot, pi, sin, sqrt
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control.fairway import FairwayParameters, Progress, progress
from shipcosim.models.core.maths import clip
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.core.sampling import normals

UNDER_WAY, CLOSING, SIDEWAYS, MOORED = range(4)
"""Stages of a docking."""
_MANNER = "assumed, of one helmsman; drawn for each docking"


@dataclass(frozen=True, kw_only=True)
class ShipInHand:
    """His model of the ship."""

    mass_surge: float = required("kg", "mass with added mass in surge", minimum=1.0)
    mass_sway: float = required("kg", "mass with added mass in sway", minimum=1.0)
    mass_yaw: float = required("kg.m2", "moment of inertia with the added one", minimum=1.0)
    resistance: float = required("N.s2/m2", "resistance over squared speed", minimum=0.0)
    side_wind: float = required(
        "N.s2/m2", "side force of beam wind over its squared speed", minimum=0.0
    )
    stern_x: float = required("m", "place of the azimuths forward", maximum=0.0)
    stern_y: float = required("m", "distance of the azimuths from the centreline", minimum=0.0)
    bow_x: float = required("m", "place of the tunnel forward", minimum=0.0)
    ahead_max: float = required("N", "largest thrust of an azimuth ahead", minimum=1.0)
    astern_max: float = required("N", "largest thrust of an azimuth astern", minimum=1.0)
    tunnel_max: float = required("N", "largest thrust of the tunnel to either side", minimum=1.0)


@dataclass(frozen=True, kw_only=True)
class MannerParameters:
    """His manner of steering."""

    transit_speed: float = quantity(5.0, "m/s", "speed under way", _MANNER, minimum=0.5)
    closing_speed: float = quantity(1.2, "m/s", "speed off the berth", _MANNER, minimum=0.1)
    sideways_speed: float = quantity(0.25, "m/s", "speed to the quay", _MANNER, minimum=0.02)
    slowing_distance: float = quantity(900.0, "m", "way over which he slows", _MANNER, minimum=1.0)
    closing_distance: float = quantity(
        50.0, "m", "way left at which he heads for the berth", _MANNER, minimum=1.0
    )
    stand_off: float = quantity(
        15.0, "m", "distance off the quay from which he goes sideways", _MANNER, minimum=0.0
    )
    speed_time: float = quantity(
        25.0, "s", "time in which he wants another speed", _MANNER, minimum=1.0
    )
    place_time: float = quantity(
        60.0, "s", "time in which he wants to be at a near place", _MANNER, minimum=1.0
    )
    heading_time: float = quantity(
        12.0, "s", "time in which he wants another heading", _MANNER, minimum=1.0
    )
    yaw_time: float = quantity(
        5.0, "s", "time in which he wants another yaw rate", _MANNER, minimum=0.5
    )
    yaw_rate: float = quantity(0.02, "rad/s", "yaw rate of a turn", _MANNER, minimum=1e-3)
    trim_time: float = quantity(
        45.0, "s", "time in which he learns what wind and current take", _MANNER, minimum=1.0
    )
    wind_feel: float = quantity(
        0.7, "1", "share of the wind's side force that he meets in advance", _MANNER
    )
    look_interval: float = quantity(4.0, "s", "time between two looks", _MANNER, minimum=0.1)
    reaction_time: float = quantity(
        1.5, "s", "time from a look to the levers", _MANNER, minimum=0.0
    )
    lever_step: float = quantity(
        0.05,
        "1",
        "step of a lever, which is proportional to the root of thrust",
        _MANNER,
        minimum=1e-3,
    )
    angle_step: float = quantity(
        5.0 * pi / 180.0, "rad", "step of a unit's direction", _MANNER, minimum=1e-3
    )
    lurch: float = quantity(
        0.15,
        "1",
        "how much the speed that he wants varies near the berth, one standard deviation",
        _MANNER,
        minimum=0.0,
    )
    lurch_time: float = quantity(25.0, "s", "time for which it stays", _MANNER, minimum=1.0)
    seed: int = quantity(1, "1", "seed of how he varies", "any", minimum=0)


class Levers(NamedTuple):
    """Positions of the levers.

    Parameters
    ----------
    port, starboard, tunnel : float
        Thrust that they ask for, of the tunnel to starboard. [N]
    port_azimuth, starboard_azimuth : float
        Directions of the azimuths, clockwise from the bow. [rad]
    """

    port: float
    starboard: float
    tunnel: float
    port_azimuth: float
    starboard_azimuth: float


NEUTRAL = Levers(0.0, 0.0, 0.0, 0.0, 0.0)


class Mind(NamedTuple):
    """State of the helmsman.

    Parameters
    ----------
    stage : int
        `UNDER_WAY`, `CLOSING`, `SIDEWAYS` or `MOORED`. [1]
    way : Progress
        On the fairway.
    looks : int
        How often he has looked. [1]
    looks_at, acts_at : float
        When he looks next, and when he moves the levers to `meant`. [s]
    meant, levers : Levers
        Where he wants the levers, and where they stand.
    trim : tuple of three floats
        Load that wind and current take, as he has learned. [N, N, N.m]
    astern : bool
        Under way: the azimuths push astern. [1]
    """

    stage: int
    way: Progress
    looks: int
    looks_at: float
    acts_at: float
    meant: Levers
    levers: Levers
    trim: tuple[float, float, float]
    astern: bool


class Seen(NamedTuple):
    """The view from the bridge: measured motion and wind.

    Parameters
    ----------
    ship : Motion
        Measured place, heading, velocity.
    wind_speed, wind_from : float
        At the mast, clockwise from the bow. [m/s, rad]
    """

    ship: Motion
    wind_speed: float
    wind_from: float


@dataclass(frozen=True)
class Helmsman:
    """A helmsman: his model of the ship, the fairway, and his manner.

    Parameters
    ----------
    ship : ShipInHand
        The ship in his hands.
    fairway : FairwayParameters
        The way.
    manner : MannerParameters
        His manner of steering.
    """

    ship: ShipInHand
    fairway: FairwayParameters
    manner: MannerParameters


def begin(t: float) -> Mind:
    """State at the start: under way, levers neutral.

    Parameters
    ----------
    t : float
        Time. [s]

    Returns
    -------
    Mind
    """
    return Mind(
        UNDER_WAY, Progress(0, 0.0, 0.0, 0.0), 0, t, t, NEUTRAL, NEUTRAL, (0.0, 0.0, 0.0), False
    )


def follow(t: float, mind: Mind, seen: Seen, *, helmsman: Helmsman) -> Mind:
    """State at time t: moves the levers when due, and looks when it is time.

    Parameters
    ----------
    t : float
        Time. [s]
    mind : Mind
        Before.
    seen : Seen
        Measured motion and wind now.
    helmsman : Helmsman
        His ship, fairway and manner.

    Returns
    -------
    Mind
        After.
    """
    # The levers follow a reaction time after the look (intermittent control).
    if t >= mind.acts_at:
        mind = mind._replace(levers=mind.meant)
    return _look(t, mind, seen, helmsman) if t >= mind.looks_at - 1e-6 else mind


def _look(t, mind, seen, who):
    """Look at the ship, decide on a velocity and a force, and plan the lever movement."""
    manner = who.manner
    ship = seen.ship
    way = progress(
        ship.x, ship.y, ship.u, mind.way.leg, fairway=who.fairway, yaw_rate=manner.yaw_rate
    )
    mind = mind._replace(way=way, stage=_stage(mind.stage, way, ship, who))
    # Time since the last look, from which the trim is integrated. The first look integrates
    # nothing.
    since = t - mind.looks_at + manner.look_interval if mind.looks else 0.0
    # Random pauses between looks, and a slow random variation of the wanted speed. Both follow from
    # the seed.
    mood = normals("helmsman", manner.seed, mind.looks, 1)[0]
    pause = manner.look_interval
    mood_of_now = normals("mood of the helmsman", manner.seed, int(t / manner.lurch_time), 1)[0]
    wanted = _wanted(mind, ship, 1.0 + manner.lurch * clip(mood_of_now, -2.0, 2.0), who)
    mind = _force(mind, seen, wanted, since, who)
    return mind._replace(
        looks=mind.looks + 1,
        looks_at=t + pause * clip(1.0 + 0.3 * mood, 0.3, 2.0),
        acts_at=t + manner.reaction_time,
    )


def _off_berth(ship, fairway):
    """Distance ahead of berth and off quay, heading relative to the berth. [m, m, rad]"""
    # Positions rotated into the axes of the berth, which is the origin.
    c = cos(fairway.berth_heading)
    s = sin(fairway.berth_heading)
    ahead = ship.x * c + ship.y * s
    off_line = ship.y * c - ship.x * s
    return ahead, -fairway.berth_side * off_line, wrap(ship.psi - fairway.berth_heading)


def _stage(stage, way, ship, who):
    """The present stage of the docking."""
    ahead, off, turned = _off_berth(ship, who.fairway)
    # Stages only go forward. Off the berth she must lie close, parallel and near the stand-off
    # before she goes sideways.
    if stage == UNDER_WAY and way.to_go < who.manner.closing_distance:
        return CLOSING
    if (
        stage == CLOSING
        and abs(ahead) < 4.0
        and off < who.manner.stand_off + 6.0
        and abs(turned) < 0.14
    ):
        return SIDEWAYS
    # Moored: at the berth, parallel, and almost at rest.
    lies = hypot(ahead, off) < 2.0 and abs(turned) < 0.08 and hypot(ship.u, ship.v) < 0.08
    return MOORED if stage == SIDEWAYS and lies else stage


def _wanted(mind, ship, mood, who):
    """Wanted velocity forward and to starboard, and wanted yaw rate. [m/s, m/s, rad/s]"""
    manner = who.manner
    if mind.stage == UNDER_WAY:
        u, v, heading = _under_way(mind.way, ship, mood, manner)
    else:
        u, v, heading = _near(mind.stage, ship, mood, who)
    # The heading error is to vanish in `heading_time`, with at most the yaw rate of a normal turn.
    r = clip(wrap(heading - ship.psi) / manner.heading_time, -manner.yaw_rate, manner.yaw_rate)
    return u, v, r


def _under_way(way, ship, mood, manner):
    """Speed by distance left, heading that keeps her on the leg; sway free. [m/s, m/s, rad]"""
    # Constant deceleration: u² is linear in the distance, from transit speed to closing speed.
    left = clip((way.to_go - manner.closing_distance) / manner.slowing_distance, 0.0, 1.0)
    slow = manner.closing_speed
    fast = manner.transit_speed
    u = sqrt(slow * slow + left * (fast * fast - slow * slow))
    # Line-of-sight steering: aim at a point ahead on the leg; the distance grows with speed. The
    # drift angle is compensated.
    course = way.course - atan2(way.beside, 60.0 + 12.0 * ship.u)
    drift = atan2(ship.v, max(ship.u, 0.5))
    return u * (1.0 + (mood - 1.0) * (1.0 - left)), ship.v, course - clip(drift, -0.5, 0.5)


def _near(stage, ship, mood, who):
    """Velocity towards the place off the berth, then the berth; heading. [m/s, m/s, rad]"""
    manner = who.manner
    fairway = who.fairway
    ahead, off, turned = _off_berth(ship, fairway)
    # First to the place at the stand-off distance, then sideways to the quay, more slowly.
    if stage == CLOSING:
        off = off - manner.stand_off
        most = manner.closing_speed
    else:
        most = manner.sideways_speed
    distance = hypot(ahead, off)
    # Speed proportional to the distance near the place, limited far from it.
    speed = min(most * mood, distance / manner.place_time) / max(distance, 1e-3)
    along = -speed * ahead
    lateral = speed * off * fairway.berth_side
    # From the axes of the berth into those of the ship.
    c = cos(turned)
    s = sin(turned)
    return c * along + s * lateral, c * lateral - s * along, fairway.berth_heading


def _force(mind, seen, wanted, since, who):
    """Force that he thinks is needed, with his trim for wind and current, and the levers for it."""
    hand = who.ship
    manner = who.manner
    ship = seen.ship
    # Force for the wanted acceleration: F = m (wanted - present) / time, axis by axis.
    lacking = wanted[0] - ship.u, wanted[1] - ship.v, wanted[2] - ship.r
    times = manner.speed_time, manner.speed_time, manner.yaw_time
    masses = hand.mass_surge, hand.mass_sway, hand.mass_yaw
    push = [mass * lack / time for mass, lack, time in zip(masses, lacking, times, strict=True)]
    # Trim: an integral of this force, limited, learns the mean load of wind and current.
    most = 0.3 * hand.ahead_max, 0.6 * hand.tunnel_max, 0.4 * hand.tunnel_max * hand.bow_x
    trim = tuple(
        clip(trim + more * since / manner.trim_time, -limit, limit)
        for trim, more, limit in zip(mind.trim, push, most, strict=True)
    )
    # Resistance at the wanted speed, quadratic.
    X = push[0] + trim[0] + hand.resistance * wanted[0] * abs(wanted[0])
    if mind.stage == UNDER_WAY:
        # Hysteresis: a short lack of thrust does not turn the azimuths' thrust astern.
        astern = X < (0.0 if mind.astern else -0.1 * hand.ahead_max)
        meant = _together(X, push[2] + trim[2], ship.u, astern, hand)
    else:
        astern = False
        # Near the quay he meets part of the wind's side force before it moves the ship.
        side = manner.wind_feel * hand.side_wind * seen.wind_speed**2 * sin(seen.wind_from)
        meant = _apart(X, push[1] + trim[1] + side, push[2] + trim[2], who.fairway.berth_side, hand)
    return mind._replace(trim=trim, astern=astern, meant=_moved(mind.meant, meant, who))


def _together(X, N, u, astern, hand):
    """Both azimuths act as one rudder; at low speed the tunnel helps."""
    # The tunnel helps at low speed, when the rudder effect is weak.
    helps = clip(2.2 - u, 0.0, 1.0)
    tunnel = clip(0.6 * helps * N / hand.bow_x, -hand.tunnel_max, hand.tunnel_max)
    # Side force at the stern for the rest of the moment: N = x Y, with x negative at the stern.
    Y = (N - tunnel * hand.bow_x) / hand.stern_x
    limit = 0.6 + 0.6 * helps
    if astern:
        angle = clip(-atan2(Y, -X), -limit, limit)
        thrust = max(0.5 * X / cos(angle), -hand.astern_max)
    else:
        X = max(X, 0.04 * hand.ahead_max)  # she steers only with some thrust
        angle = clip(atan2(Y, X), -limit, limit)
        thrust = min(0.5 * X / cos(angle), hand.ahead_max)
    return Levers(thrust, thrust, tunnel, angle, angle)


def _apart(X, Y, N, side, hand):
    """The azimuth at the quay pushes along, the other one across, together with the tunnel."""
    X = clip(X, -hand.astern_max, hand.ahead_max)
    N = N + side * hand.stern_y * X  # of the azimuth at the quay
    # Two transverse forces, tunnel and azimuth, give Y and N: Y = T + A, N = x_b T + x_s A.
    tunnel = clip(
        (N - hand.stern_x * Y) / (hand.bow_x - hand.stern_x), -hand.tunnel_max, hand.tunnel_max
    )
    across = clip(side * (Y - tunnel), -hand.astern_max, hand.ahead_max)
    # Which azimuth is at the quay depends on the side.
    if side > 0.0:
        return Levers(across, X, tunnel, 0.5 * pi, 0.0)
    return Levers(X, across, tunnel, 0.0, -0.5 * pi)


def _moved(before, wanted, who):
    """Levers moved in notches, only if they are off by most of a notch."""
    hand = who.ship
    step = who.manner.lever_step
    turn = who.manner.angle_step
    return Levers(
        _notch(before.port, wanted.port, hand.ahead_max, step),
        _notch(before.starboard, wanted.starboard, hand.ahead_max, step),
        _notch(before.tunnel, wanted.tunnel, hand.tunnel_max, step),
        _angle(before.port_azimuth, wanted.port_azimuth, turn),
        _angle(before.starboard_azimuth, wanted.starboard_azimuth, turn),
    )


def _notch(before, wanted, scale, step):
    """Thrust of a lever in notches; its position is proportional to the root of thrust. [N]"""
    then, now = (copysign(sqrt(abs(force) / scale), force) for force in (before, wanted))
    if abs(now - then) < 0.8 * step:
        return before
    notch = step * round(now / step)
    return notch * abs(notch) * scale


def _angle(before, wanted, step):
    """Direction of a thruster in steps; small changes are not made. [rad]"""
    return before if abs(wrap(wanted - before)) < 0.8 * step else step * round(wanted / step)
