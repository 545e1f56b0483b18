"""A helmsman: the way he goes, when he moves the levers, and that they push where he wants to."""

from dataclasses import replace
from math import cos, pi, radians, sin

import pytest
from ships import parameters

from shipcosim.models.control import helmsman
from shipcosim.models.control.fairway import FairwayParameters, progress
from shipcosim.models.core.motion import Motion

SHIP = parameters(helmsman.ShipInHand, "gunnerus-28m9", "helmsman")
WAY = FairwayParameters(waypoints="-1000 500; -400 0; 0 0", berth_heading=0.0, berth_side=1.0)
CALM = helmsman.MannerParameters(lurch=0.0, lever_step=0.001, angle_step=0.001)
WHO = helmsman.Helmsman(SHIP, WAY, CALM)


def seen(x=0.0, y=0.0, psi=0.0, u=0.0, v=0.0, r=0.0):
    return helmsman.Seen(Motion(x, y, psi, u, v, r), 0.0, 0.0)


def meant(stage, sight, who=WHO):
    """Force of the levers that he means to set at first sight, in a stage. [N, N, N.m]"""
    before = helmsman.begin(0.0)._replace(
        stage=stage, way=progress(-200.0, 0.0, 0.0, 1, fairway=WAY, yaw_rate=0.02)
    )
    levers = helmsman.follow(0.0, before, sight, helmsman=who).meant
    units = (
        (levers.port, levers.port_azimuth, -SHIP.stern_y),
        (levers.starboard, levers.starboard_azimuth, SHIP.stern_y),
    )
    X = sum(thrust * cos(angle) for thrust, angle, _ in units)
    Y = sum(thrust * sin(angle) for thrust, angle, _ in units)
    N = SHIP.stern_x * Y - sum(y * thrust * cos(angle) for thrust, angle, y in units)
    return X, Y + levers.tunnel, N + SHIP.bow_x * levers.tunnel


def test_she_leaves_a_leg_before_the_waypoint_the_earlier_the_faster():
    slow, fast = (progress(-460.0, 50.0, u, 0, fairway=WAY, yaw_rate=0.02) for u in (0.5, 5.0))
    assert (slow.leg, fast.leg) == (0, 1)
    assert slow.to_go == pytest.approx(400.0 + 78.1, abs=0.1)


def test_beside_is_positive_to_starboard_of_the_leg():
    assert progress(-200.0, 3.0, 0.0, 1, fairway=WAY, yaw_rate=0.02).beside == 3.0


@pytest.mark.parametrize("astern", [0.0, 10.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_levers_off_the_berth_give_the_force_that_he_wants(astern, side):
    """Mass times lacking velocity over his time, whichever side is to the quay, astern of the berth and at it."""
    who = replace(WHO, fairway=replace(WAY, berth_side=side))
    stage, off = (helmsman.CLOSING, CALM.stand_off) if astern else (helmsman.SIDEWAYS, 0.0)
    X, Y, N = meant(stage, seen(u=0.1, v=-0.05, r=0.002, x=-astern, y=-side * off), who)
    wanted = astern / CALM.place_time
    ahead = SHIP.mass_surge * (wanted - 0.1) / CALM.speed_time + SHIP.resistance * wanted**2
    assert X == pytest.approx(ahead, rel=0.02)
    assert Y == pytest.approx(SHIP.mass_sway * 0.05 / CALM.speed_time, rel=0.02)
    assert N == pytest.approx(-SHIP.mass_yaw * 0.002 / CALM.yaw_time, rel=0.02)


def test_under_way_he_turns_back_to_the_leg_and_to_its_course():
    assert meant(helmsman.UNDER_WAY, seen(x=-200.0, y=20.0, u=3.0))[2] < 0.0
    assert meant(helmsman.UNDER_WAY, seen(x=-200.0, psi=radians(-10.0), u=3.0))[2] > 0.0


def test_levers_move_after_the_reaction_time_and_not_before():
    mind = helmsman.follow(0.0, helmsman.begin(0.0), seen(-900.0, 400.0, u=1.0), helmsman=WHO)
    assert mind.levers == helmsman.NEUTRAL != mind.meant
    early = helmsman.follow(
        CALM.reaction_time - 0.1, mind, seen(-899.0, 400.0, u=1.0), helmsman=WHO
    )
    late = helmsman.follow(CALM.reaction_time, early, seen(-899.0, 400.0, u=1.0), helmsman=WHO)
    assert (early.levers, late.levers) == (helmsman.NEUTRAL, mind.meant)


def test_levers_stand_on_their_steps():
    who = replace(WHO, manner=replace(CALM, lever_step=0.1, angle_step=pi / 36.0))
    mind = helmsman.follow(0.0, helmsman.begin(0.0), seen(-900.0, 400.0, 0.3, u=1.0), helmsman=who)
    notches = (mind.meant.port / SHIP.ahead_max) ** 0.5 / 0.1
    assert notches == pytest.approx(round(notches)) and notches > 0.0
    assert mind.meant.port_azimuth / (pi / 36.0) == pytest.approx(
        round(mind.meant.port_azimuth / (pi / 36.0))
    )


def test_she_is_moored_only_where_she_lies_still_parallel_at_the_berth():
    mind = helmsman.begin(0.0)._replace(stage=helmsman.SIDEWAYS)
    for sight, stage in (
        (seen(x=0.5), helmsman.MOORED),
        (seen(x=3.0), helmsman.SIDEWAYS),
        (seen(psi=0.2), helmsman.SIDEWAYS),
        (seen(v=0.2), helmsman.SIDEWAYS),
    ):
        assert helmsman.follow(0.0, mind, sight, helmsman=WHO).stage == stage
