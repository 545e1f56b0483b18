"""Thrusters against recorded unit data and curves, and the balance of forces, torque and power."""

from dataclasses import replace
from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest
from ships import parameters, unit_on_centreline

from shipcosim.models.propulsion.azimuth import (
    AzimuthParameters,
    azimuth_loads,
    azimuth_replay,
    azimuth_step,
    turned,
)
from shipcosim.models.propulsion.drive import at_rest, powers
from shipcosim.models.propulsion.failures import SOUND, Failures
from shipcosim.models.propulsion.propeller import propeller_loads
from shipcosim.models.propulsion.tunnel import (
    TunnelParameters,
    tunnel_loads,
    tunnel_replay,
    tunnel_step,
)

UNIT = unit_on_centreline(x=0.0)
THESIS = parameters(AzimuthParameters, "thesis", "port")
TUNNEL = parameters(TunnelParameters)
H = 0.05


def run(commands, *, unit=UNIT, u=0.0, h=H, failed=None, state=None):
    """States of an azimuth at angle 0 in a straight inflow, one per command."""
    state, states = state or at_rest(0.0), []
    for k, command in enumerate(commands):
        lost = Failures(bool(failed and failed(k * h)))
        state = azimuth_step(state, command, 0.0, u, 0.0, 0.0, lost, h, unit=unit)
        states.append(state)
    return states


def thrust_of(state, u=0.0, unit=UNIT):
    return azimuth_loads(state, u, 0.0, 0.0, unit=unit).thrust


def curve(shared, name):
    return np.genfromtxt(shared / "reference/data" / name, delimiter=",", skip_header=2)


def test_forces_are_those_of_the_units_own_model(shared):
    """1260 points: side force to 3.75 kN rms of 36 kN, thrust to 3.7 kN rms of 60 kN (0.25 kN on the axis)."""
    u, v, _, angle, rpm, X, Y = curve(shared, "gunnerus_azimuth_fmu_dataset.csv").T
    angle, still = np.radians(angle), 0.0 * u
    loads = azimuth_loads(
        azimuth_replay(rpm / 60.0, angle, u, v, still, unit=UNIT), u, v, still, unit=UNIT
    )
    c, s = np.cos(angle), np.sin(angle)
    off_thrust, off_side = loads.thrust - (c * X + s * Y), loads.side_force - (c * Y - s * X)
    on_axis = (angle == 0.0) & (v == 0.0)
    assert len(u) == 1260
    assert np.sqrt(np.mean(off_side**2)) < 3.75e3
    assert np.sqrt(np.mean(off_thrust**2)) < 3.7e3
    assert np.sqrt(np.mean(off_thrust[on_axis] ** 2)) < 0.25e3


FORCES = """
   0.0  0.0  2.0                  43856.665487999984       -0.0
   0.0  0.3 -1.5                 -12562.749850055128    -2797.388999999999
   0.5  0.2  1.0                   8663.174027958721    -1443.699297241591
   3.5  0.0  1.8333333333333333   10510.496128276232       -0.0
   5.5 -0.5  2.8333333333333335   24118.223940691492    16141.991087436098
   6.2  0.1  3.25                 33086.33236732543     -3663.486210282599
   6.5  1.0  1.5                 -11894.399554779458   -27904.246022833333
   4.0  0.5  0.4                 -12637.272409323676    -7091.349846628341
   2.0 -1.0  0.0                  -3803.9871731822773    6619.208426994877
   1.0  0.4 -0.7                  -3862.4228135225258   -2850.119588966365
  -1.0  0.2  1.2                  13462.99393981664     -1953.6159025654943
  -0.5  0.3 -2.5                 -34831.46989858466     -4736.108513973631
  -3.0 -0.3 -0.5                   6960.331938757731     3521.124763227785
  -2.0  0.7  0.3                   7222.496251778691    -5571.9057394878255
"""


@pytest.mark.parametrize("row", FORCES.split("\n")[1:-1])
def test_forces_on_the_ship_are_those_that_were_calibrated(row):
    """In all quadrants, as before the torque came from another series: the trials were fitted with these."""
    u_a, u_s, n, thrust, side = map(float, row.split())
    loads = azimuth_loads(
        azimuth_replay(n, 0.0, u_a, u_s, 0.0, unit=UNIT), u_a, u_s, 0.0, unit=UNIT
    )
    assert (loads.thrust, loads.side_force) == pytest.approx((thrust, side), rel=1e-13)


def test_thesis_set_has_the_curves_of_the_thesis(shared):
    """From 100 rpm on, where its coefficients are constant within 1 %; power within 1.5 %."""
    rpm, thrust, power = curve(shared, "gunnerus_azimuth_nominal_curve.csv").T
    strong = np.abs(rpm) >= 100.0
    n = rpm[strong] / 60.0
    found, torque = propeller_loads(0.0 * n + 5.0, n, propeller=THESIS)
    np.testing.assert_allclose(found, thrust[strong], rtol=0.011)
    np.testing.assert_allclose(2.0 * pi * n * torque, power[strong], rtol=0.015)


@pytest.mark.parametrize("n", [-2.0, 0.0, 2.0])
def test_side_force_astern_has_its_factor_on_what_goes_with_shaft_speed(n):
    """-c rho D² (V + factor abs(n) D) u_s: continuous through n = 0."""
    unit, u, v = replace(UNIT, side_force_astern=0.71), 0.3, -0.4
    side = azimuth_loads(
        azimuth_replay(n, 0.0, u, v, 0.0, unit=unit), u, v, 0.0, unit=unit
    ).side_force
    wash = (0.71 if n < 0.0 else 1.0) * abs(n) * 1.9
    assert side == pytest.approx(-0.80 * 1025.0 * 1.9**2 * (0.5 + wash) * v, rel=1e-9)


def test_thesis_set_has_no_side_force():
    assert (
        azimuth_loads(
            azimuth_replay(2.0, 0.0, 0.0, 1.0, 0.0, unit=THESIS), 0.0, 1.0, 0.0, unit=THESIS
        ).tau_Y
        == 0.0
    )


def test_tunnel_has_the_nominal_curve(shared):
    """Within 1 % of the largest thrust: the parabola is 1 % above at full speed, where the curve is flatter."""
    rpm, thrust = curve(shared, "gunnerus_tunnel_nominal_curve.csv").T
    found = tunnel_loads(tunnel_replay(rpm / 60.0, tunnel=TUNNEL), 0.0 * rpm, tunnel=TUNNEL).thrust
    np.testing.assert_allclose(found, thrust, atol=220.0)


def test_load_is_along_the_azimuth_and_turns_the_ship_about_the_origin():
    unit = unit_on_centreline(x=-14.02, y=2.0)
    loads = azimuth_loads(
        azimuth_replay(2.0, 0.6, 0.0, 0.0, 0.0, unit=unit), 0.0, 0.0, 0.0, unit=unit
    )
    assert (loads.tau_X, loads.tau_Y) == pytest.approx(
        (loads.thrust * cos(0.6), loads.thrust * sin(0.6))
    )
    assert loads.tau_N == pytest.approx(loads.thrust * (-14.02 * sin(0.6) - 2.0 * cos(0.6)))


def test_a_stopped_unit_takes_energy_from_any_motion():
    """Side force and propeller oppose the flow, whatever its direction; the unit stands across."""
    unit = unit_on_centreline(x=-14.02, y=2.0)
    u, v, r = np.random.default_rng(3).uniform(-1.0, 1.0, (3, 500)) * [[3.0], [2.0], [0.1]]
    loads = azimuth_loads(at_rest(np.full(500, 0.7)), u, v, r, unit=unit)
    assert np.all(loads.tau_X * u + loads.tau_Y * v + loads.tau_N * r <= 0.0)


def test_port_unit_mirrors_starboard_unit():
    port, starboard = (
        parameters(AzimuthParameters, "gunnerus-33m9", side) for side in ("port", "starboard")
    )
    left = azimuth_loads(
        azimuth_replay(2.0, 0.5, 1.0, 0.3, 0.05, unit=port), 1.0, 0.3, 0.05, unit=port
    )
    right = azimuth_replay(2.0, -0.5, 1.0, -0.3, -0.05, unit=starboard)
    right = azimuth_loads(right, 1.0, -0.3, -0.05, unit=starboard)
    assert (right.tau_X, -right.tau_Y, -right.tau_N) == pytest.approx(left[2:])


@pytest.mark.parametrize("u", [-0.5, 0.0, 0.5, 2.0])
def test_motor_torque_carries_propeller_and_friction_and_the_thrust_is_what_was_asked(u):
    state = run([8e3] * 600, u=u)[-1]
    thrust, torque = propeller_loads(u, state.n, propeller=UNIT)
    assert thrust == pytest.approx(8e3, rel=1e-6)
    assert state.torque == pytest.approx(torque + UNIT.friction * 2.0 * pi * state.n, rel=1e-6)


def test_power_in_a_replay_is_that_of_propeller_and_friction():
    n = 2.5
    state = azimuth_replay(n, 0.0, 1.0, 0.0, 0.0, unit=UNIT)
    _, torque = propeller_loads(1.0, n, propeller=UNIT)
    omega = 2.0 * pi * n
    assert omega * state.torque == pytest.approx(omega * torque + UNIT.friction * omega**2)


@pytest.mark.parametrize("u", [-0.5, 0.0, 0.5])
def test_thrust_follows_its_limited_command_through_zero(u):
    """From 10 kN to -10 kN: rate limit, then within 2 s; in between never more than 600 N off."""
    commands = [10e3] * 400 + [-10e3] * 600
    states = run(commands, u=u)
    thrust = np.array([thrust_of(state, u) for state in states])
    limited = np.array([state.thrust_cmd for state in states])
    assert np.max(np.abs(np.diff(limited))) <= 1000.0 * H + 1e-9
    assert np.max(np.abs(thrust - limited)[40:]) < 600.0
    assert np.max(np.abs(thrust - limited)[400 + 400 + 40 :]) < 20.0


def test_a_small_step_of_command_is_there_within_two_seconds():
    """Half a second at the rate limit, an overshoot below a fifth of the step, then 4 % of it."""
    states = run([5e3] * 400 + [5.5e3] * 60)
    thrust = [thrust_of(state) for state in states[400:]]
    assert max(thrust) < 5.6e3
    assert thrust[20] > 5.45e3
    assert thrust[40] == pytest.approx(5.5e3, abs=20.0)


def test_commands_are_held_within_the_limits_of_force():
    assert run([1e6] * 1400)[-1].thrust_cmd == UNIT.thrust_max
    assert run([-1e6] * 800)[-1].thrust_cmd == UNIT.thrust_min


def test_saturation_is_told_while_a_limit_acts_and_not_after():
    states = run([5e3] * 300)
    assert states[20].saturated and not states[-1].saturated
    assert run([90e3] * 1400)[-1].saturated


def test_motor_keeps_to_torque_power_and_speed():
    """60 kN at 6 m/s are out of reach: the shaft settles at its largest speed; a weak motor at its power or torque."""
    fast = run([60e3] * 2400, u=6.0)[-1]
    assert 60.0 * fast.n == pytest.approx(203.0, rel=0.01) and fast.saturated
    weak = replace(UNIT, power_max=100e3, friction=0.0)
    state = run([60e3] * 2400, unit=weak)[-1]
    assert 2.0 * pi * state.n * state.torque == pytest.approx(100e3, rel=1e-3)
    state = run([60e3] * 2400, unit=replace(UNIT, torque_max=5e3))[-1]
    assert state.torque == pytest.approx(5e3)


@pytest.mark.parametrize(
    ("u", "asked", "rpm", "torque"),
    [
        (0.0, 200e3, 187.0, 23.5e3),
        (2.0, 200e3, 200.5, 23.5e3),
        (6.26, 200e3, 203.0, 15.5e3),
        (0.0, -200e3, -184.0, -23.5e3),
    ],
)
def test_motor_gives_its_torque_at_bollard_and_its_speed_at_service_speed(u, asked, rpm, torque):
    """Beyond the limits of thrust. Torque is short up to some 2 m/s; 12.2 kn take 330 kW, the sheet says 355 kW."""
    unit = replace(UNIT, thrust_min=-200e3, thrust_max=200e3, thrust_rate=20e3)
    state = run([asked] * 1200, unit=unit, u=u)[-1]
    assert 60.0 * state.n == pytest.approx(rpm, rel=0.005) and state.torque == pytest.approx(
        torque, rel=0.005
    )
    assert state.saturated and abs(2.0 * pi * state.n * state.torque) <= 500e3


def test_limits_of_thrust_are_within_what_the_motor_can():
    """60 kN ahead and 30 kN astern take 200 kW each at bollard."""
    for asked in (60e3, -30e3):
        state = run([asked] * 1600)[-1]
        assert not state.saturated and 2.0 * pi * state.n * state.torque == pytest.approx(
            195.5e3, rel=0.01
        )


def test_speed_limit_is_never_passed():
    assert max(60.0 * state.n for state in run([60e3] * 2400, u=6.0)) <= 203.0


def reversal(unit, u):
    """States of a unit that pushes ahead with 20 kN in an inflow, then as much astern."""
    return run([20e3] * 600 + [-20e3] * 1200, unit=unit, u=u)


@pytest.mark.parametrize("u", [0.0, 4.0, -2.0])
def test_no_power_flows_back_into_the_grid_and_the_brake_resistor_takes_what_the_shaft_gives(u):
    drawn, heat = np.transpose([powers(state, UNIT) for state in reversal(UNIT, u)])
    shaft = np.array([2.0 * pi * state.n * state.torque for state in reversal(UNIT, u)])
    assert np.min(drawn) >= 0.0 and np.min(heat) >= 0.0 and np.max(heat) > 1e3
    np.testing.assert_allclose(drawn - heat, shaft)
    assert np.all(drawn * heat == 0.0)


@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_energy_goes_into_water_bearings_shaft_and_resistor(share):
    """Over a reversal in an inflow, by sums over steps of 5 ms: within 0.2 % of what went through the shaft."""
    unit, u, h = replace(UNIT, regeneration=share, thrust_rate=20e3), 4.0, 0.005
    states = run([20e3] * 4000 + [-20e3] * 4000, unit=unit, u=u, h=h)
    n = np.array([state.n for state in states])
    omega, (drawn, heat) = 2.0 * pi * n, np.transpose([powers(state, unit) for state in states])
    water = omega * propeller_loads(u + 0.0 * n, n, propeller=unit)[1]
    lost = np.trapezoid(water + unit.friction * omega**2 + heat, dx=h)
    kinetic = 0.5 * unit.inertia * (omega[-1] ** 2 - omega[0] ** 2)
    assert np.trapezoid(drawn, dx=h) == pytest.approx(
        lost + kinetic, abs=2e-3 * np.trapezoid(np.abs(water), dx=h)
    )
    assert (np.min(drawn) < -1e3) == (share > 0.0)


def test_regeneration_changes_no_motion_of_the_shaft():
    with_it, without = (
        reversal(replace(UNIT, regeneration=share), 3.0)[-1] for share in (1.0, 0.0)
    )
    assert with_it == without


def test_windup_is_gone_two_seconds_after_the_limit():
    weak = replace(UNIT, torque_max=3e3)
    state = run([20e3] * 2000, unit=weak)[-1]
    states = run([5e3] * 340, unit=weak, state=state)
    assert thrust_of(states[-1], unit=weak) == pytest.approx(5e3, abs=20.0)


def test_a_failed_unit_runs_down_keeps_its_direction_and_comes_back_from_nothing():
    start = run([20e3] * 800)[-1]
    state = start
    for _ in range(600):
        state = azimuth_step(state, 20e3, 1.0, 0.0, 0.0, 0.0, Failures(True), H, unit=UNIT)
        assert state.torque == 0.0 and state.azimuth == 0.0 and not state.saturated
    assert 0.0 < thrust_of(state) < 0.01 * 20e3
    back = azimuth_step(state, 20e3, 0.0, 0.0, 0.0, 0.0, SOUND, H, unit=UNIT)
    assert back.thrust_cmd == pytest.approx(UNIT.thrust_rate * H)


def test_a_failed_unit_still_has_its_side_force():
    state = at_rest(0.0)
    loads = azimuth_loads(state, 0.0, 1.0, 0.0, unit=UNIT)
    assert loads.tau_Y == pytest.approx(-0.80 * 1025.0 * 1.9**2, rel=1e-9)


def test_halving_the_step_changes_thrust_by_less_than_a_hundredth_of_its_range():
    def thrusts(h):
        commands = [5e3 * sin(0.15 * h * k) for k in range(1, round(80.0 / h) + 1)]
        return np.array([thrust_of(state, 0.5) for state in run(commands, u=0.5, h=h)])

    assert np.max(np.abs(thrusts(0.05) - thrusts(0.025)[1::2])) < 100.0


def test_azimuth_turns_the_shortest_way_at_its_rate():
    angle, way = radians(170.0), 0.0
    for _ in range(40):
        before, angle = angle, turned(angle, radians(-170.0), UNIT.azimuth_rate * H)
        way += abs(np.angle(np.exp(1j * (angle - before))))
    assert degrees(angle) == pytest.approx(-170.0) and degrees(way) == pytest.approx(20.0)
    state = azimuth_step(at_rest(0.0), 0.0, 3.0, 0.0, 0.0, 0.0, SOUND, H, unit=UNIT)
    assert degrees(state.azimuth) == pytest.approx(0.5)


def tunnel_run(commands, failures=SOUND, state=None):
    state = state or at_rest(0.5 * pi)
    for command in commands:
        state = tunnel_step(state, command, 0.0, failures, H, tunnel=TUNNEL)
    return state


@pytest.mark.parametrize("command", [-21.6e3, -2e3, 15e3, 21.6e3])
def test_tunnel_gives_what_is_asked_with_balanced_torque(command):
    state = tunnel_run([command] * 700)
    loads = tunnel_loads(state, 0.0, tunnel=TUNNEL)
    assert loads.thrust == pytest.approx(command, rel=1e-4)
    assert (loads.tau_X, loads.tau_Y, loads.tau_N) == (0.0, loads.thrust, 14.48 * loads.thrust)
    assert abs(state.torque) == pytest.approx(1073.0 * (60.0 * state.n / 1780.0) ** 2, rel=1e-3)


def test_tunnel_at_its_limit_takes_its_rated_power():
    state = tunnel_run([30e3] * 700)
    assert 60.0 * state.n == pytest.approx(1778.0, abs=1.0)
    assert 2.0 * pi * state.n * state.torque == pytest.approx(200e3, rel=0.01)


def test_tunnel_of_the_thesis_reaches_its_thirty_kilonewton():
    tunnel, state = parameters(TunnelParameters, "thesis", "tunnel"), at_rest(0.5 * pi)
    for _ in range(800):
        state = tunnel_step(state, 30e3, 0.0, SOUND, H, tunnel=tunnel)
    assert tunnel_loads(state, 0.0, tunnel=tunnel).thrust == pytest.approx(30e3, rel=1e-3)


def test_failed_tunnel_runs_down():
    state = tunnel_run([0.0] * 600, failures=Failures(True), state=tunnel_run([10e3] * 400))
    assert state.torque == 0.0 and 0.0 < tunnel_loads(state, 0.0, tunnel=TUNNEL).thrust < 100.0


def test_loss_under_way_is_neutral_by_default_and_as_stated_otherwise():
    state = tunnel_replay(20.0, tunnel=TUNNEL)
    full = tunnel_loads(state, 2.2, tunnel=TUNNEL).thrust
    assert full == tunnel_loads(state, 0.0, tunnel=TUNNEL).thrust
    lossy = replace(TUNNEL, speed_loss=1.0 / 2.2**2)
    assert tunnel_loads(state, 2.2, tunnel=lossy).thrust == pytest.approx(full / np.e)


PAIR = dict(x=-14.02, y=-2.0, neighbour_x=-14.02, neighbour_y=2.0)
FLOW = (1.0, -0.2, 0.02)


def replayed(rpm, azimuth=0.3, *, unit, neighbour=(0.0, 0.0), flow=FLOW):
    state = azimuth_replay(rpm / 60.0, azimuth, *flow, unit=unit)
    return state, azimuth_loads(state, *flow, *neighbour, unit=unit)


@pytest.mark.parametrize("rpm", [-90.0, 0.0, 120.0])
def test_lost_thrust_is_missing_along_the_axis_and_the_torque_stays(rpm):
    (state, whole), (same, left) = (
        replayed(rpm, unit=replace(UNIT, thrust_loss=loss)) for loss in (0.0, 0.25)
    )
    assert left.thrust == pytest.approx(0.75 * whole.thrust)
    assert left.side_force == whole.side_force and same.torque == state.torque
    axis = np.array([cos(0.3), sin(0.3)])
    np.testing.assert_allclose(
        [left.tau_X - whole.tau_X, left.tau_Y - whole.tau_Y], -0.25 * whole.thrust * axis
    )


def test_loss_in_reverse_acts_at_negative_speed_only_and_on_what_the_other_loss_leaves():
    unit = replace(UNIT, thrust_loss=0.1, reverse_loss=0.4)
    for rpm, kept in ((120.0, 0.9), (-120.0, 0.9 * 0.6)):
        assert replayed(rpm, unit=unit)[1].thrust == pytest.approx(
            kept * replayed(rpm, unit=UNIT)[1].thrust
        )


def test_loss_at_the_hull_is_none_ahead_and_whole_athwartships():
    unit = replace(UNIT, angle_loss=0.3)
    for angle, kept in ((0.0, 1.0), (pi / 6.0, 1.0 - 0.3 * 0.25), (-pi / 2.0, 0.7), (pi, 1.0)):
        thrust = replayed(120.0, angle, unit=unit)[1].thrust
        assert thrust == pytest.approx(kept * replayed(120.0, angle, unit=UNIT)[1].thrust)


def test_the_drive_knows_nothing_of_lost_thrust():
    """Shaft and torque follow the command as without; the ship gets a fifth less."""
    lossy = replace(UNIT, thrust_loss=0.2)
    whole, left = run([8e3] * 400)[-1], run([8e3] * 400, unit=lossy)[-1]
    assert (left.n, left.torque) == (whole.n, whole.torque)
    assert thrust_of(left, unit=lossy) == pytest.approx(0.8 * 8e3, rel=1e-6)


def test_azimuth_offset_turns_the_loads_and_not_what_is_reported():
    """Offset = real minus given."""
    offset = replace(UNIT, azimuth_offset=radians(7.0))
    (state, found), (real, expected) = (
        replayed(100.0, 0.3, unit=offset),
        replayed(100.0, 0.3 + radians(7.0), unit=UNIT),
    )
    assert found == pytest.approx(expected) and state.torque == pytest.approx(real.torque)
    assert state.azimuth == 0.3
    driven = azimuth_step(at_rest(0.3), 5e3, 0.3, *FLOW, SOUND, H, unit=offset)
    assert driven.azimuth == pytest.approx(0.3)


def test_rpm_offset_is_given_minus_real_and_acts_in_replays_only():
    unit, tunnel = replace(UNIT, rpm_offset=9.0), replace(TUNNEL, rpm_offset=60.0)
    assert replayed(109.0, unit=unit)[1] == pytest.approx(replayed(100.0, unit=UNIT)[1])
    assert run([5e3] * 50, unit=unit)[-1] == run([5e3] * 50)[-1]
    found = tunnel_replay(660.0 / 60.0, tunnel=tunnel)
    assert found.n == pytest.approx(10.0)
    assert tunnel_loads(found, 0.0, tunnel=tunnel).thrust == pytest.approx(6.83e-3 * 600.0**2)
    assert found.torque == pytest.approx(tunnel_replay(10.0, tunnel=TUNNEL).torque)


def test_lost_thrust_of_a_tunnel_leaves_its_torque():
    lossy = replace(TUNNEL, thrust_loss=0.3)
    state, whole = tunnel_replay(-15.0, tunnel=lossy), tunnel_replay(-15.0, tunnel=TUNNEL)
    assert state == whole
    ratio = (
        tunnel_loads(state, 0.4, tunnel=lossy).thrust
        / tunnel_loads(whole, 0.4, tunnel=TUNNEL).thrust
    )
    assert ratio == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("azimuth", "rpm", "kept"),
    [
        (90.0, 80.0, 0.6),
        (110.0, 80.0, 1.0 - 0.4 / np.e),
        (-90.0, 80.0, 1.0),
        (-90.0, -80.0, 0.6),
        (90.0, 0.0, 1.0),
    ],
)
def test_the_unit_that_a_slipstream_hits_loses_thrust(azimuth, rpm, kept):
    """Port, with starboard 4 m beside it: starboard pushing to starboard throws its water at port."""
    unit = unit_on_centreline(**PAIR, interaction_loss=0.4)
    hit = replayed(100.0, unit=unit, neighbour=(radians(azimuth), rpm))[1]
    assert hit.thrust == pytest.approx(
        kept * replayed(100.0, unit=replace(unit, interaction_loss=0.0))[1].thrust
    )


def test_both_units_of_the_ship_know_where_the_other_one_is():
    for ship in ("gunnerus-33m9", "gunnerus-28m9", "thesis"):
        port, starboard = (
            parameters(AzimuthParameters, ship, side) for side in ("port", "starboard")
        )
        assert (port.neighbour_x, port.neighbour_y) == (starboard.x, starboard.y)
        assert (starboard.neighbour_x, starboard.neighbour_y) == (port.x, port.y)


EFFECTS = dict(
    thrust_loss=0.2,
    reverse_loss=0.3,
    angle_loss=0.3,
    azimuth_offset=0.1,
    rpm_offset=8.0,
    interaction_loss=0.4,
    interaction_width=0.5,
)


@pytest.mark.parametrize("name", EFFECTS)
@pytest.mark.parametrize("rpm", [-80.0, 100.0])
def test_effects_as_an_array_are_as_many_units(name, rpm):
    unit = unit_on_centreline(
        **PAIR, **({"interaction_loss": 0.3} if name == "interaction_width" else {})
    )
    values = np.array([getattr(unit, name), EFFECTS[name]])
    neighbour = (radians(80.0), 60.0)
    each = [
        replayed(rpm, unit=replace(unit, **{name: float(value)}), neighbour=neighbour)[1]
        for value in values
    ]
    together = replayed(rpm, unit=replace(unit, **{name: values}), neighbour=neighbour)[1]
    np.testing.assert_allclose(
        np.broadcast_arrays(*together, values)[:-1], np.transpose(each), rtol=1e-12
    )
    assert each[0] == replayed(rpm, unit=unit, neighbour=neighbour)[1]
