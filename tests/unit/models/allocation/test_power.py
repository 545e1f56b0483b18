"""Power of the buses: what is granted, and what it leaves of the thrust."""

import math

import numpy as np
import pytest
from ships import GUNNERUS, parameters

from shipcosim.models.allocation import pseudo_inverse as allocation
from shipcosim.models.allocation.power import PowerParameters, granted_power, thrust_shares
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters, at_rest, design
from shipcosim.models.allocation.units import used_shares
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.propeller import bollard_speed, bollard_torque
from shipcosim.models.propulsion.tunnel import TunnelParameters

POWER, UNITS = parameters(PowerParameters), parameters(AllocationParameters)


@pytest.mark.parametrize("ship", GUNNERUS)
def test_full_power_is_that_of_the_thrusters_at_the_allocators_limits(ship):
    """Within 2 %."""
    power, units = parameters(PowerParameters, ship), parameters(AllocationParameters, ship)
    azimuth = parameters(AzimuthParameters, ship, "port")
    for thrust in (units.azimuth_thrust_min, units.azimuth_thrust_max):
        n = bollard_speed(thrust, propeller=azimuth)
        assert 2.0 * math.pi * n * bollard_torque(n, propeller=azimuth) == pytest.approx(
            power.azimuth_full_power, rel=0.02
        )
    tunnel = parameters(TunnelParameters, ship)
    rpm = math.sqrt(units.tunnel_thrust_max / tunnel.thrust_coefficient)
    taken = 2.0 * math.pi * rpm / 60.0 * tunnel.torque_coefficient * rpm**2
    assert taken == pytest.approx(power.tunnel_full_power, rel=0.02)


def test_what_is_granted_on_a_bus_is_what_it_has():
    rng = np.random.default_rng(5)
    for _ in range(50):
        a, b = rng.uniform(0.0, 4e5, 2)
        port, starboard, tunnel = granted_power(
            tuple(rng.uniform(0.0, 1.0, 3)), (a, b), parameters=POWER
        )
        assert port + tunnel == pytest.approx(a) and starboard == pytest.approx(b)
        assert min(port, starboard, tunnel) > 0.0


def test_a_quarter_of_the_power_leaves_two_fifths_of_the_thrust():
    """abs(T)^1.5: 0.25^(2/3) = 0.397."""
    shares = thrust_shares((0.25 * POWER.azimuth_full_power, 1e9, 0.0), parameters=POWER)
    assert shares == pytest.approx((0.25 ** (2.0 / 3.0), 1.0, 0.0), abs=1e-6)


def held(tau, buses, seconds=120.0, h=0.1):
    """Commands after some time of a constant request with little power."""
    made, state = design(UNITS), at_rest((0.0, 0.0, 0.0), parameters=UNITS)
    for _ in range(round(seconds / h)):
        granted = granted_power(shares_of(state), buses, parameters=POWER)
        shares = thrust_shares(granted, parameters=POWER)
        state = allocation.step(
            state, tau, (True,) * 3, h, parameters=UNITS, design=made, shares=shares
        )
    return state


def shares_of(state):
    low, high, most = UNITS.azimuth_thrust_min, UNITS.azimuth_thrust_max, UNITS.tunnel_thrust_max
    return used_shares(state.thrusts, (low, low, -most), (high, high, most))


def power_of(state):
    used = shares_of(state)
    return [most * share**1.5 for most, share in zip(POWER.largest, used, strict=True)]


def test_commands_use_the_power_of_their_bus_and_no_more():
    request = (40e3, 5e3, 50e3)
    plenty, little = held(request, (1e9, 1e9)), held(request, (40e3, 1e9))
    assert sum(power_of(plenty)[::2]) > 60e3
    assert 35e3 < sum(power_of(little)[::2]) <= 40e3 * (1.0 + 1e-9)
    assert little.saturated and not plenty.saturated


def test_power_that_is_lost_is_taken_back_at_once():
    state = held((40e3, 5e3, 50e3), (1e9, 1e9))
    shares = thrust_shares(
        granted_power(shares_of(state), (40e3, 1e9), parameters=POWER), parameters=POWER
    )
    after = allocation.step(
        state,
        (40e3, 5e3, 50e3),
        (True,) * 3,
        0.05,
        parameters=UNITS,
        design=design(UNITS),
        shares=shares,
    )
    assert sum(power_of(after)[::2]) <= 40e3 * (1.0 + 1e-9)
