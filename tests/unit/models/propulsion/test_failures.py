"""Failures of thrusters: what each does to the unit, and what the unit reports of itself."""

from math import degrees, pi, radians

import pytest
from ships import parameters, unit_on_centreline

from shipcosim.models.propulsion.azimuth import azimuth_loads, azimuth_step
from shipcosim.models.propulsion.drive import at_rest
from shipcosim.models.propulsion.failures import SOUND, Failures
from shipcosim.models.propulsion.tunnel import TunnelParameters, tunnel_step

UNIT = unit_on_centreline(x=0.0)
TUNNEL = parameters(TunnelParameters)
H = 0.05
AT_10_KN = 600
"""Steps after which the thrust has settled at 10 kN."""


def run(failures, seconds, thrust=10e3, angle=0.0, state=None, u=0.0):
    """State of an azimuth after some seconds of constant commands."""
    state = state or at_rest(0.0)
    for _ in range(round(seconds / H)):
        state = azimuth_step(state, thrust, angle, u, 0.0, 0.0, failures, H, unit=UNIT)
    return state


def thrust_of(state):
    return azimuth_loads(state, 0.0, 0.0, 0.0, unit=UNIT).thrust


SETTLED = run(SOUND, 30.0)


def test_a_sound_unit_reports_the_thrust_it_gives():
    assert SETTLED.reported == pytest.approx(thrust_of(SETTLED), rel=1e-12)
    assert run(SOUND, 30.0, thrust=-8e3).reported == pytest.approx(-8e3, rel=1e-3)


def test_full_thrust_comes_as_fast_as_the_motor_can_whatever_is_commanded():
    state = run(Failures(full_thrust=True), 10.0, thrust=-5e3, state=SETTLED)
    assert thrust_of(state) == pytest.approx(60e3, rel=0.01) and state.reported == pytest.approx(
        60e3, rel=0.01
    )


def test_a_frozen_drive_keeps_its_speed():
    frozen = run(Failures(rpm_frozen=True), 60.0, thrust=-20e3, angle=1.0, state=SETTLED)
    assert frozen.n == pytest.approx(SETTLED.n, rel=1e-4)
    assert frozen.azimuth == pytest.approx(1.0)
    met = run(Failures(rpm_frozen=True), 60.0, state=SETTLED, u=0.5)
    assert met.n == pytest.approx(SETTLED.n, rel=0.15), (
        "the drive holds the thrust, so water of 0.5 m/s changes the speed"
    )


def test_a_frozen_steering_keeps_its_direction_and_the_thrust_follows():
    state = run(Failures(azimuth_frozen=True), 20.0, thrust=5e3, angle=1.0, state=SETTLED)
    assert state.azimuth == 0.0 and thrust_of(state) == pytest.approx(5e3, rel=1e-3)


def test_a_slow_unit_takes_its_share_of_the_rates():
    state = run(Failures(rate_share=0.1), 5.0, thrust=60e3, angle=radians(90.0), state=SETTLED)
    assert state.thrust_cmd == pytest.approx(10e3 + 0.1 * UNIT.thrust_rate * 5.0)
    assert degrees(state.azimuth) == pytest.approx(5.0)


def test_with_reversed_speed_feedback_the_shaft_runs_off_to_its_limit_and_the_unit_reports_the_opposite():
    """Positive feedback: the drive takes the speed for too low, the more the faster it turns."""
    state = run(Failures(rpm_reversed=True), 20.0, state=SETTLED)
    assert 60.0 * state.n > 180.0 and thrust_of(state) > 60e3
    assert state.reported == pytest.approx(-thrust_of(state))


def test_with_reversed_angle_feedback_the_unit_ends_where_its_reading_is_opposite_to_the_command():
    """It turns on as long as it reads an error: reading -azimuth, it stops half a turn from the command."""
    aside = run(SOUND, 10.0, angle=radians(-45.0))
    state = run(Failures(azimuth_reversed=True), 30.0, angle=radians(-45.0), state=aside)
    assert degrees(state.azimuth) == pytest.approx(-135.0, abs=1.0)


def test_the_granted_power_is_not_exceeded():
    state = SETTLED
    for _ in range(400):
        state = azimuth_step(
            state, 60e3, 0.0, 0.0, 0.0, 0.0, Failures(power_limit=60e3), H, unit=UNIT
        )
        assert 2.0 * pi * state.n * state.torque <= 60e3 * (1.0 + 1e-2)
    assert 20e3 < thrust_of(state) < 40e3 and state.saturated


def test_the_tunnel_fails_in_the_same_ways():
    def after(failures, thrust=10e3, state=None, seconds=20.0):
        state = state or at_rest(0.5 * pi)
        for _ in range(round(seconds / H)):
            state = tunnel_step(state, thrust, 0.0, failures, H, tunnel=TUNNEL)
        return state

    settled = after(SOUND)
    assert settled.reported == pytest.approx(10e3, rel=1e-3)
    assert after(Failures(full_thrust=True), -5e3, settled).reported == pytest.approx(
        21.6e3, rel=0.01
    )
    assert after(Failures(rpm_frozen=True), -5e3, settled).n == pytest.approx(settled.n, rel=1e-4)
    assert after(Failures(rate_share=0.1), -5e3, settled, 5.0).thrust_cmd == pytest.approx(
        10e3 - 500.0
    )
    reversed_ = after(Failures(rpm_reversed=True), 10e3, settled)
    assert 60.0 * reversed_.n > 1700.0 and reversed_.reported < -19e3
    assert after(Failures(True), 10e3, settled).torque == 0.0
